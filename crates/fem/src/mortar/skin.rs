//! The skin of a body, and which places of two skins can touch each other: those with nothing solid between them.

use std::collections::HashMap;

use super::facet::{PlacedFacet, SurfaceMesh, area_vector};
use crate::element::PerNode;
use crate::geometry::{cross, dot, key, length, minus, shifted, unit};
use crate::mesh::{Boundary, extent};
use crate::surface::{Tree, distance_from};

/// Two bodies that overlap can touch up to this share of the thickness of the thinner one: behind its middle the other
/// side of its skin is nearer.
const OVERLAP: f64 = 0.5;

/// A side of a body turns away from a way if the angle between its normal and the way is above 60 degrees.
const SIDEWAYS: f64 = 0.5;

/// Two overlapping bodies touch along the shortest way out of each other: no side that turns away from the way is
/// nearer to its middle than this share of it, as its ends are.
const BESIDE: f64 = 0.5;

/// A crossing nearer to an end of a way than this share of it is at the end, which the skin itself forms.
const AT_END: f64 = 1e-9;

/// A line at an angle below this to a piece runs along it, in radians.
const ALONG: f64 = 1e-9;

/// A point beside a piece by less than this share of it is on its edge.
const ON_EDGE: f64 = 1e-9;

/// All facets of a body, cut into edges or triangles, with a tree of boxes around these.
#[derive(Debug)]
pub struct Skin {
    pub surface: Boundary,
    pieces: Vec<Piece>,
    tree: Tree,
    /// The size of the body, in length.
    size: f64,
}

/// An edge, the second end twice, or a triangle of a facet, seen from outside.
#[derive(Clone, Copy, Debug)]
struct Piece {
    facet: usize,
    corners: [[f64; 3]; 3],
}

/// The sense in which a line crosses a skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CrossingSense {
    Into,
    OutOf,
}

impl Skin {
    /// The skin of a surface that is seen from outside, at these places of the nodes.
    pub fn new(surface: Boundary, nodes: &[[f64; 3]]) -> Self {
        let mut pieces = Vec::with_capacity(surface.connectivity.len());
        for (facet, named) in surface.facets().enumerate() {
            for cell in surface.kind.straight_cells(named) {
                let last = cell.len() - 1;
                let fan = (1..last.max(2)).map(|at| [cell[0], cell[at], cell[(at + 1).min(last)]]);
                pieces.extend(fan.map(|corners| Piece { facet, corners: corners.map(|node| nodes[node]) }));
            }
        }
        let numbers: Vec<u32> = (0..pieces.len() as u32).collect();
        let tree = Tree::new(&numbers, |number| {
            let (low, high) = extent(&pieces[number as usize].corners);
            [low, high]
        });
        let (low, high) = extent(&pieces.iter().flat_map(|piece| piece.corners).collect::<Vec<_>>());
        Skin { surface, pieces, tree, size: length(minus(high, low)) }
    }

    /// The distance of a point, in length, and the number of the nearest facet.
    pub fn nearest(&self, at: [f64; 3]) -> (f64, usize) {
        let (mut least, mut nearest) = (f64::INFINITY, 0);
        self.tree.near(at, |number| {
            let piece = &self.pieces[number as usize];
            let far = distance_from(&piece.corners, at);
            if far < least {
                (least, nearest) = (far, piece.facet);
            }
            least * least
        });
        (least, nearest)
    }

    /// Returns `true` if a line from a point along a unit vector crosses the skin in this sense at a distance between
    /// two.
    fn is_crossed(&self, from: [f64; 3], way: [f64; 3], [low, high]: [f64; 2], sense: CrossingSense) -> bool {
        let mut is_crossed = false;
        self.tree.around_line(from, way, [AT_END * high, 0.0, high], |number| {
            let found = || self.pieces[number as usize].crossing(from, way);
            is_crossed = is_crossed || found().is_some_and(|(at, of)| of == sense && low < at && at < high);
        });
        is_crossed
    }

    /// Returns `true` if a piece that turns away from a unit vector is nearer to a point than `limit`, in length.
    fn has_side_near(&self, at: [f64; 3], way: [f64; 3], limit: f64) -> bool {
        let mut has_side = false;
        self.tree.near(at, |number| {
            let piece = &self.pieces[number as usize];
            let turns_away = || dot(unit(piece.normal()), way).abs() < SIDEWAYS;
            has_side = has_side || (distance_from(&piece.corners, at) < limit && turns_away());
            limit * limit
        });
        has_side
    }

    /// Returns `true` for a point inside the body, by the next crossing of a line along a unit vector.
    fn contains(&self, at: [f64; 3], way: [f64; 3]) -> bool {
        self.next_crossing(at, way, 0.0).is_some_and(|(_, sense)| sense == CrossingSense::OutOf)
    }

    /// The length of a line from a point of the skin along a unit vector into the body, up to where it leaves the body.
    pub fn thickness(&self, at: [f64; 3], inward: [f64; 3]) -> Option<f64> {
        let rounding = AT_END * self.size;
        self.next_crossing(at, inward, rounding).filter(|(_, sense)| *sense == CrossingSense::OutOf).map(|(far, _)| far)
    }

    /// The next crossing of a line along a unit vector that is farther than `beyond`, with its distance.
    fn next_crossing(&self, at: [f64; 3], way: [f64; 3], beyond: f64) -> Option<(f64, CrossingSense)> {
        let mut next: Option<(f64, CrossingSense)> = None;
        self.tree.around_line(at, way, [0.0, 0.0, f64::INFINITY], |number| {
            let found = self.pieces[number as usize].crossing(at, way).filter(|found| found.0 > beyond);
            next = match (next, found) {
                (Some(one), Some(other)) => Some(if other.0 < one.0 { other } else { one }),
                (one, other) => one.or(other),
            };
        });
        next
    }
}

impl Piece {
    /// A vector out of the body: as long as an edge, or twice the area of a triangle.
    fn normal(&self) -> [f64; 3] {
        let [a, b, c] = self.corners;
        if b == c { area_vector(&[a, b]) } else { cross(minus(b, a), minus(c, a)) }
    }

    /// The distance at which a line from a point along a unit vector crosses it, negative behind the point, and the
    /// sense.
    fn crossing(&self, from: [f64; 3], way: [f64; 3]) -> Option<(f64, CrossingSense)> {
        let ([a, b, c], normal) = (self.corners, self.normal());
        let turned = dot(normal, way);
        if turned.abs() <= ALONG * length(normal) {
            return None;
        }
        let at = dot(normal, minus(a, from)) / turned;
        let place = shifted(from, at, way);
        let is_inside = if b == c {
            let along = minus(b, a);
            let share = dot(minus(place, a), along) / dot(along, along);
            (-ON_EDGE..=1.0 + ON_EDGE).contains(&share)
        } else {
            let least = -ON_EDGE * dot(normal, normal);
            [(a, b), (b, c), (c, a)].iter().all(|&(p, q)| dot(cross(minus(q, p), minus(place, p)), normal) >= least)
        };
        is_inside.then_some((at, if turned > 0.0 { CrossingSense::OutOf } else { CrossingSense::Into }))
    }
}

/// The skins of all bodies, and the numbers of two of them.
#[derive(Clone, Copy, Debug)]
pub struct TwoSkins<'a> {
    pub skins: &'a [Skin],
    pub own: usize,
    pub other: usize,
}

impl TwoSkins<'_> {
    /// Returns `true` if nothing solid lies between `from` on the skin of the own body, with a vector out of it, and
    /// `to` on that of the other.
    ///
    /// Bodies that are apart touch if the way meets no body, a third one included. Bodies that overlap touch if the way
    /// is short against the thickness of both: it would lead out of the own body soon after `to`, or out of the other
    /// soon after `from`, if the two places stood back to back.
    pub fn is_clear(&self, from: [f64; 3], to: [f64; 3], outward: [f64; 3]) -> bool {
        let way = minus(to, from);
        let far = length(way);
        // Between places that differ by rounding alone there is nothing, and no way.
        let sizes = [self.own, self.other].into_iter().filter_map(|body| self.skins.get(body)).map(|skin| skin.size);
        if far <= AT_END * sizes.fold(f64::INFINITY, f64::min) {
            return true;
        }
        let (way, back) = (unit(way), unit(minus(from, to)));
        if dot(way, outward) > 0.0 {
            let between = [AT_END * far, (1.0 - AT_END) * far];
            let middle = [0, 1, 2].map(|axis| f64::midpoint(from[axis], to[axis]));
            let blocks = |(body, skin): (usize, &Skin)| {
                let is_crossed = |sense: CrossingSense| skin.is_crossed(from, way, between, sense);
                let is_third = body != self.own && body != self.other;
                (body != self.other && is_crossed(CrossingSense::Into))
                    || (body != self.own && is_crossed(CrossingSense::OutOf))
                    || (is_third && skin.contains(middle, way))
            };
            return !self.skins.iter().enumerate().any(blocks);
        }
        let thin = [AT_END * far, far / OVERLAP];
        let is_thin = |body: usize, at: [f64; 3], inward: [f64; 3]| {
            self.skins.get(body).is_some_and(|skin| skin.is_crossed(at, inward, thin, CrossingSense::OutOf))
        };
        !is_thin(self.own, from, way) && !is_thin(self.other, to, back)
    }

    /// The same for the middles of parts of two facets, which are not at an edge of a body, with a unit vector out of
    /// the own one: bodies that overlap do not touch along a way if they part sooner to a side of it.
    pub fn can_touch(&self, from: [f64; 3], to: [f64; 3], outward: [f64; 3]) -> bool {
        let way = minus(to, from);
        let middle = [0, 1, 2].map(|axis| f64::midpoint(from[axis], to[axis]));
        let is_beside = |body: usize| {
            self.skins.get(body).is_some_and(|skin| skin.has_side_near(middle, outward, BESIDE * length(way)))
        };
        let parts_sideways = dot(way, outward) < 0.0 && [self.own, self.other].into_iter().any(is_beside);
        !parts_sideways && self.is_clear(from, to, outward)
    }
}

// The curves for which straight facets stand: cubic, through the nodes, along the normals there.
//
// # Source
// A. Vlachos, J. Peters, C. Boyd, J. L. Mitchell, *Curved PN triangles*, Symposium on Interactive 3D Graphics (2001)
// 159-166; here the control points are those with which an edge between two points of a circle meets the circle in its
// middle.

/// A facet whose normal turns from that at a node by more than this many degrees has a corner there.
const CORNER: f64 = 20.0;

pub(super) struct Curve<'a> {
    normals: &'a [[f64; 3]],
    /// The nodes at the rim: normals there are those of one side alone.
    is_rim: Vec<bool>,
}

impl<'a> Curve<'a> {
    /// Through the nodes of a surface, with its `normals` at the nodes.
    pub fn of(surface: &SurfaceMesh, facets: &[PlacedFacet], normals: &'a [[f64; 3]]) -> Self {
        let mut is_rim = vec![false; surface.nodes.len()];
        let mut sides: HashMap<[usize; 2], usize> = HashMap::new();
        for facet in facets {
            let corners = &facet.nodes[..facet.reference().corners];
            // An edge in the plane has its ends as sides.
            let sides_of = (0..corners.len()).map(|at| match corners.len() {
                2 => [corners[at]; 2],
                count => key(corners[at], corners[(at + 1) % count]),
            });
            sides_of.for_each(|side| *sides.entry(side).or_default() += 1);
        }
        let single = sides.into_iter().filter(|entry| entry.1 == 1).map(|entry| entry.0);
        single.flatten().for_each(|node| is_rim[node] = true);
        Curve { normals, is_rim }
    }

    /// How far the curve lies beyond a point of a straight facet, along the normal of the facet, in length; the point
    /// is given by the `shape` functions there. Zero at nodes, and for a curved facet, which is its own curve.
    pub fn beyond(&self, facet: &PlacedFacet, shape: &PerNode<f64>) -> f64 {
        if !facet.reference().mid_sides.is_empty() {
            return 0.0;
        }
        let count = facet.nodes.len();
        let along = |i: usize, j: usize, [a, b]: [f64; 2]| {
            a * a * b * self.control(facet, i, j) + b * b * a * self.control(facet, j, i)
        };
        let next = |at: usize| (at + 1) % count;
        match count {
            2 => 3.0 * along(0, 1, [shape[0], shape[1]]),
            3 => {
                let edges = (0..3).map(|i| along(i, next(i), [shape[i], shape[next(i)]])).sum::<f64>();
                let all =
                    (0..3).map(|i| self.control(facet, i, next(i)) + self.control(facet, next(i), i)).sum::<f64>();
                3.0 * edges + 1.5 * shape[0] * shape[1] * shape[2] * all
            }
            _ => {
                // Each side with its weight, which falls to zero at the opposite side.
                let side = |i: usize| {
                    let (j, before, after) = (next(i), (i + count - 1) % count, next(next(i)));
                    (shape[i] + shape[j]) * along(i, j, [shape[i] + shape[before], shape[j] + shape[after]])
                };
                3.0 * (0..count).map(side).sum::<f64>()
            }
        }
    }

    /// The control point beside node i on the way to node j, beyond the facet. At a corner or at a rim, where the
    /// normal is not that of the curve, the curve turns as at the other end.
    fn control(&self, facet: &PlacedFacet, i: usize, j: usize) -> f64 {
        let is_corner = |at: usize| dot(self.normals[facet.nodes[at]], facet.normal) < CORNER.to_radians().cos();
        let is_rim = |at: usize| self.is_rim[facet.nodes[at]];
        let (from, to) = match (is_corner(i), is_corner(j)) {
            (true, true) => return 0.0,
            (true, false) => (j, i),
            (false, false) if is_rim(i) && !is_rim(j) => (j, i),
            _ => (i, j),
        };
        let normal = self.normals[facet.nodes[from]];
        let way = minus(facet.places()[to], facet.places()[from]);
        // The arc of a circle with this tangent lies as far beyond the middle of the edge.
        -dot(way, normal) * 2.0 / (3.0 * (1.0 + dot(normal, facet.normal)))
    }
}
