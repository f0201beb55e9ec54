//! What methods hand over.

use crate::answer::Place;

/// The end of a method.
pub enum Found {
    /// A point, in units of z, perhaps a rough one; if the method ends with a basis, with the places in it.
    Point { z: Vec<f64>, places: Option<Vec<Place>>, iterations: usize },
    /// A ray in scaled units that may show that there is no solution.
    Ray(Vec<f64>),
    /// Nothing, for this reason.
    Nothing(String),
}
