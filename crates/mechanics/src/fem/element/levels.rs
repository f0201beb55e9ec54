//! Quadrature of functions with kinks: a cell of up to two dimensions, cut along the levels of a linear function.

use super::quadrature::fine;
use super::{Part, QuadraturePoint, ReferenceElement, Shape};
use crate::fem::geometry::minus;

/// A corner of a piece: reference coordinates, and the value of the function.
type Corner = ([f64; 3], f64);

/// Five points in each direction of every piece of a cell between `levels` of a function with the values `at_corners`,
/// linear between them along the sides of the cell and along the cuts.
///
/// If the cell in place is an affine image of its reference, these are the pieces of a function that is linear in the
/// coordinates.
pub fn between_levels(reference: &ReferenceElement, at_corners: &[f64], levels: &[f64]) -> Vec<QuadraturePoint> {
    let whole: Vec<Corner> = reference.nodes.iter().copied().zip(at_corners.iter().copied()).collect();
    let mut pieces = vec![whole];
    for &level in levels {
        let halves = |piece: Vec<Corner>| {
            [clipped(&piece, level, |value| value <= level), clipped(&piece, level, |value| value >= level)]
        };
        pieces = pieces.into_iter().flat_map(halves).filter(|piece| piece.len() > reference.dimension).collect();
    }
    pieces.iter().flat_map(|piece| points(reference.dimension, piece)).collect()
}

/// The part of a line or of a polygon on the kept side of the level.
fn clipped(piece: &[Corner], level: f64, keeps: impl Fn(f64) -> bool) -> Vec<Corner> {
    // A polygon is closed; a line has one side.
    let sides = if piece.len() == 2 { 1 } else { piece.len() };
    let mut kept = Vec::with_capacity(piece.len() + 1);
    for (index, &(at, value)) in piece.iter().enumerate() {
        if keeps(value) {
            kept.push((at, value));
        }
        let (next, beyond) = piece[(index + 1) % piece.len()];
        if index < sides && (value < level && beyond > level || value > level && beyond < level) {
            let share = (level - value) / (beyond - value);
            kept.push(([0, 1, 2].map(|axis| at[axis] + share * (next[axis] - at[axis])), level));
        }
    }
    kept
}

/// The points of a piece: a line, or a polygon that is cut into triangles around its first corner.
fn points(dimension: usize, piece: &[Corner]) -> Vec<QuadraturePoint> {
    match (dimension, piece) {
        (1, &[(from, _), (to, _)]) => {
            let way = minus(to, from);
            let place = |point: QuadraturePoint| QuadraturePoint {
                at: [0, 1, 2].map(|axis| from[axis] + (1.0 + point.at[0]) / 2.0 * way[axis]),
                weight: point.weight * way[0].abs() / 2.0,
            };
            fine(Shape::Product, 1, Part::WHOLE).into_iter().map(place).collect()
        }
        (2, &[(first, _), ref others @ ..]) => {
            let triangle = |pair: &[Corner]| {
                let (u, v) = (minus(pair[0].0, first), minus(pair[1].0, first));
                let twice = (u[0] * v[1] - u[1] * v[0]).abs();
                fine(Shape::Simplex, 2, Part::WHOLE).into_iter().map(move |point| QuadraturePoint {
                    at: [0, 1, 2].map(|axis| first[axis] + point.at[0] * u[axis] + point.at[1] * v[axis]),
                    weight: point.weight * twice,
                })
            };
            others.windows(2).flat_map(triangle).collect()
        }
        _ => fine(Shape::Product, 0, Part::WHOLE),
    }
}

#[cfg(test)]
mod tests {
    use super::super::FacetKind;
    use super::*;

    /// The integral of max(0, s - level) over a cell, s linear, against a fine cut of the cell into many.
    #[test]
    fn a_function_with_a_kink_is_integrated_exactly() {
        // Over a line from 1 to 3 on [-1, 1], above 2.5: (1/2) (1/2)^2, over a slope of 1.
        let line = between_levels(FacetKind::Line2.reference(), &[1.0, 3.0], &[2.5]);
        let above = |at: [f64; 3]| (2.0 + at[0] - 2.5).max(0.0);
        let sum: f64 = line.iter().map(|point| point.weight * above(point.at)).sum();
        assert!((sum - 0.125).abs() < 1e-15, "{sum}");
        // xi + eta - 1/2 on the triangle, positive beyond 1/2: the whole less what is negative, plus that again.
        let triangle = between_levels(FacetKind::T3.reference(), &[0.0, 1.0, 1.0], &[0.5]);
        let sum: f64 = triangle.iter().map(|point| point.weight * (point.at[0] + point.at[1] - 0.5).max(0.0)).sum();
        let (whole, below) = (1.0 / 3.0 - 0.25, 0.125 * 1.0 / 3.0 - 0.5 * 0.125);
        assert!((sum - (whole - below)).abs() < 1e-15, "{sum}");
        // xi + eta on the square, above 1: a triangle of legs 1 and height 1 at its corner.
        let square = between_levels(FacetKind::Q4.reference(), &[-2.0, 0.0, 2.0, 0.0], &[-3.0, 1.0]);
        let sum: f64 = square.iter().map(|point| point.weight * (point.at[0] + point.at[1] - 1.0).max(0.0)).sum();
        assert!((sum - 1.0 / 6.0).abs() < 1e-15, "{sum}");
        assert!((square.iter().map(|point| point.weight).sum::<f64>() - 4.0).abs() < 1e-14);
    }
}
