//! Points of integration.

use super::simplex::{Point, Weights};
use crate::fem::element::gauss_legendre;

/// A point of integration on a simplex or on a facet.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Its barycentric coordinates.
    pub weights: Weights,
    pub place: Point,
    /// Its volume, or its area.
    pub weight: f64,
    /// What counts in addition, because a polynomial P stands for a power of a radius r: about an axis, for squares of
    /// a hoop strain or of a stress, its volume times `r P(r) - 1`; where axes turn, for squares of any strain or
    /// stress, its volume times `r^4 P(r^2)^2 - 1`.
    pub extra: f64,
}

/// `x P(x) - 1 >= 0` for the polynomial `P(x) >= 1/x` between a and b with
/// `1 - x P = (x - a) (x - b) prod (x - c)^2 / a b prod c^2`. `places` are those of the c, -1 at the smaller end and 1
/// at the larger one.
pub fn beyond(x: f64, [one, other]: [f64; 2], places: &[f64]) -> f64 {
    let (low, high) = (one.min(other), one.max(other));
    let ends = (x - low) / low * ((high - x) / high);
    let middle = [low + high, high - low].map(|sum| sum / 2.0);
    let zeros = places.iter().map(|place| middle[0] + middle[1] * place);
    zeros.fold(ends.max(0.0), |product, zero| product * (x / zero - 1.0).powi(2))
}

/// The given number of Gauss points between 0 and 1, with their weights.
pub fn line(points: usize) -> impl Iterator<Item = (f64, f64)> {
    gauss_legendre(points).map(|(x, weight)| ((x + 1.0) / 2.0, weight / 2.0))
}

/// The given number of Gauss points along each side of the unit square, with their weights.
pub fn square(points: usize) -> Vec<([f64; 2], f64)> {
    line(points).flat_map(|(t, of_t)| line(points).map(move |(y, of_y)| ([t, y], of_t * of_y))).collect()
}
