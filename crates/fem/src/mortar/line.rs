//! What two edges in the plane share: the part of one that the other covers along a field of directions.

use super::facet::{PlacedFacet, SharedPoint};
use crate::element::{ReferenceElement, gauss_legendre};
use crate::geometry::{dot, minus};

/// Ends that lie closer than this, in reference coordinates, are one point.
const SAME_END: f64 = 1e-9;

/// Gauss points of a segment.
const POINTS: usize = 5;

/// Steps of Newton's method to the place where a line meets an edge.
const STEPS: usize = 30;

/// Newton's method ends when the reference coordinate moves by less.
const FOUND: f64 = 1e-15;

/// An edge relative to a point near it.
struct Edge<'a> {
    reference: &'static ReferenceElement,
    places: &'a [[f64; 3]],
    origin: [f64; 3],
}

impl Edge<'_> {
    fn of<'a>(facet: &'a PlacedFacet, origin: [f64; 3]) -> Edge<'a> {
        Edge { reference: facet.reference(), places: facet.places(), origin }
    }

    /// The sum of the values of its nodes with the shape functions, and its slope.
    fn sum(&self, xi: f64, value: impl Fn(usize) -> [f64; 3]) -> [[f64; 3]; 2] {
        let (shape, slope) = ((self.reference.shape)([xi, 0.0, 0.0]), (self.reference.derivative)([xi, 0.0, 0.0]));
        let mut sums = [[0.0; 3]; 2];
        for node in 0..self.places.len() {
            let value = value(node);
            for axis in 0..2 {
                sums[0][axis] += shape[node] * value[axis];
                sums[1][axis] += slope[node][0] * value[axis];
            }
        }
        sums
    }

    /// The place from which the directions at the nodes lead through a point.
    fn foot(&self, directions: &[[f64; 3]], to: [f64; 3]) -> Option<f64> {
        zero(|xi| {
            let ([place, tangent], [way, bend]) = (self.at(xi), self.sum(xi, |node| directions[node]));
            [turned(minus(to, place), way), turned(minus(to, place), bend) - turned(tangent, way)]
        })
    }

    /// The place at `xi`, and the tangent.
    fn at(&self, xi: f64) -> [[f64; 3]; 2] {
        self.sum(xi, |node| minus(self.places[node], self.origin))
    }
}

/// The reference coordinates of the place on an edge from which its directions lead through a point.
pub(super) fn foot(slave: &PlacedFacet, directions: &[[f64; 3]], at: [f64; 3]) -> Option<[f64; 3]> {
    let xi = Edge::of(slave, slave.middle).foot(directions, minus(at, slave.middle))?;
    Some([xi, 0.0, 0.0])
}

fn turned(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The zero of a function with its slope, from the middle of the edge; `None` without one near the edge.
fn zero(function: impl Fn(f64) -> [f64; 2]) -> Option<f64> {
    let sense = function(0.0)[1];
    let mut xi = 0.0;
    for _ in 0..STEPS {
        let [value, slope] = function(xi);
        let step = -value / slope;
        xi += step;
        // Where the slope has turned, another branch of a curved edge lies.
        if !xi.is_finite() || xi.abs() > 1e3 || slope * sense <= 0.0 {
            return None;
        }
        if step.abs() <= FOUND {
            break;
        }
    }
    Some(xi)
}

/// Calls `visit` for every integration point of the part of `slave` that `master` covers along the `directions` at the
/// nodes of `slave`, if it is within `reach`.
pub(super) fn for_each_point(
    slave: &PlacedFacet,
    directions: &[[f64; 3]],
    master: &PlacedFacet,
    reach: f64,
    visit: &mut dyn FnMut(SharedPoint),
) {
    let (own, other) = (Edge::of(slave, slave.middle), Edge::of(master, slave.middle));
    let direction = |xi: f64| own.sum(xi, |node| directions[node]);
    let on_master = |xi: f64| {
        let ([from, _], [way, _]) = (own.at(xi), direction(xi));
        zero(|eta| {
            let [place, tangent] = other.at(eta);
            [turned(minus(place, from), way), turned(tangent, way)]
        })
    };
    let on_slave = |eta: f64| own.foot(directions, other.at(eta)[0]);
    let is_inside = |xi: &f64| xi.abs() <= 1.0 + SAME_END;
    let snapped = |xi: f64| if (xi.abs() - 1.0).abs() <= SAME_END { xi.signum() } else { xi };
    let own_ends = [-1.0, 1.0].into_iter().filter(|&end| on_master(end).is_some_and(|eta| is_inside(&eta)));
    let other_ends = [-1.0, 1.0].into_iter().filter_map(on_slave).filter(is_inside).map(snapped);
    let (low, high) = own_ends
        .chain(other_ends)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), end| (low.min(end), high.max(end)));
    if high - low <= SAME_END {
        return;
    }
    let half = (high - low) / 2.0;
    let middle = low + half;
    let away = |xi: f64, eta: f64| minus(other.at(eta)[0], own.at(xi)[0]);
    let is_far = |eta: f64| {
        let way = away(middle, eta);
        dot(way, way).sqrt() > reach
    };
    if on_master(middle).is_none_or(is_far) {
        return;
    }
    for (at, weight) in gauss_legendre(POINTS) {
        let xi = middle + half * at;
        let Some(eta) = on_master(xi) else { continue };
        let [_, tangent] = own.at(xi);
        let weight = weight * half * tangent[0].hypot(tangent[1]);
        visit(SharedPoint { slave: [xi, 0.0, 0.0], master: [eta, 0.0, 0.0], weight });
    }
}

/// Calls `visit` for the integration points of a whole edge: reference coordinates, and the length that each stands
/// for.
pub(super) fn for_each_of_whole(slave: &PlacedFacet, visit: &mut dyn FnMut([f64; 3], f64)) {
    let own = Edge::of(slave, slave.middle);
    for (xi, weight) in gauss_legendre(POINTS) {
        let [_, tangent] = own.at(xi);
        visit([xi, 0.0, 0.0], weight * tangent[0].hypot(tangent[1]));
    }
}
