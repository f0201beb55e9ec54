//! Points of integration.

use super::simplex::{Point, Weights};
use crate::fem::element::gauss_legendre;

/// A point of integration on a simplex or on a facet.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Its barycentric coordinates.
    pub weights: Weights,
    /// Its place.
    pub place: Point,
    /// Its volume, or its area.
    pub weight: f64,
    /// What counts in addition, because a polynomial stands for a power of a radius: about an axis for squares of a hoop strain or of a
    /// stress, its volume times `r P - 1`; where axes turn for squares of a strain or of a stress.
    pub extra: f64,
}

/// So many points between 0 and 1 with their weights.
pub fn line(points: usize) -> impl Iterator<Item = (f64, f64)> {
    gauss_legendre(points).map(|(x, weight)| ((x + 1.0) / 2.0, weight / 2.0))
}

/// So many points of a square along each side, with their weights.
pub fn square(points: usize) -> Vec<([f64; 2], f64)> {
    line(points).flat_map(|(t, of_t)| line(points).map(move |(y, of_y)| ([t, y], of_t * of_y))).collect()
}
