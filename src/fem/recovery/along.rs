//! Displacement and stress along a straight line, element by element.

use super::{Stress, finished};
use crate::error::Error;
use crate::fem::body::{BodyElement, ElasticBody};
use crate::fem::element::{Cell, ElementKind, FacetKind, PerNode, ReferenceElement, TabulatedPoint};
use crate::fem::geometry::{cross, dot, length, minus};

/// Points of a piece in an element whose stress is not constant.
const POINTS: usize = 5;
/// Reference coordinates that differ by less are equal.
const SAME: f64 = 1e-9;
/// The box of the nodes of an element grows by this share of its size: curved sides may leave it.
const BULGE: f64 = 0.25;
/// Newton's method ends when the reference coordinates move by less than this.
const CONVERGED: f64 = 1e-13;
/// Steps of Newton's method to the point at which the line meets a face.
const STEPS: usize = 30;

/// The part of a line in one element.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// The element, an index from 0.
    pub element: usize,
    /// Points from its beginning to its end, both included.
    pub points: Vec<PathPoint>,
    /// The nodes of the face in which the whole piece lies; `None` inside the element.
    pub face: Option<Vec<usize>>,
}

/// A point of a line in an element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathPoint {
    /// Its position on the line: 0 at the first end, 1 at the other.
    pub share: f64,
    /// [x, y, z], in length.
    pub place: [f64; 3],
    /// The shape functions of the element there: weights of its nodes.
    pub weights: PerNode<f64>,
    /// The stress of the element there, which is not averaged with that of its neighbours.
    pub stress: Stress,
}

impl Piece {
    /// The middle of its positions.
    fn middle(&self) -> f64 {
        0.5 * (self.start() + self.end())
    }

    /// Its first position on the line.
    pub fn start(&self) -> f64 {
        self.points[0].share
    }

    /// Its last position on the line.
    pub fn end(&self) -> f64 {
        self.points[self.points.len() - 1].share
    }
}

/// The pieces of a line in the elements of a body under the nodal displacement `displacement` (`dim` a node): region by region, in the
/// order of the line. Along a common side of several elements of one region, the piece of the first of these elements alone.
///
/// # Errors
/// [`Error::Length`] if the displacement does not have `dim` entries per node.
pub(crate) fn along(body: &ElasticBody, displacement: &[f64], ends: [[f64; 3]; 2]) -> Result<Vec<Piece>, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let line = Line::new(ends);
    let table = body.tabulated();
    let kind = body.mesh().kind();
    let is_constant = kind.nodes() == kind.dimension() + 1 && !body.formulation().is_axisymmetric();
    let mut elements = body.elements().enumerate();
    let mut all = Vec::new();
    for region in body.regions() {
        let mut pieces: Vec<Piece> = Vec::new();
        for (index, element) in elements.by_ref().take(region.elements().len()) {
            if !line.is_near(element.nodes.iter().map(|&node| body.mesh().nodes()[node])) {
                continue;
            }
            let strained = body.strained(&table, displacement, &element);
            for [start, end] in line.inside(kind, body, &element) {
                let points = if is_constant { 2 } else { POINTS };
                let at = |point: usize| {
                    let share = start + (end - start) * point as f64 / (points - 1) as f64;
                    let at = element.cell.reference_coordinates(line.at(share));
                    let point = TabulatedPoint::new(kind.reference(), at, 0.0);
                    let stress = finished(body, strained.at(&point).1);
                    PathPoint { share, place: line.at(share), weights: point.shape, stress }
                };
                let points: Vec<PathPoint> = (0..points).map(at).collect();
                let face =
                    face_of(kind.reference(), &points).map(|face| face.iter().map(|&at| element.nodes[at]).collect());
                pieces.push(Piece { element: index, points, face });
            }
        }
        pieces.sort_by(|a, b| a.start().total_cmp(&b.start()).then(a.element.cmp(&b.element)));
        let mut covered = f64::NEG_INFINITY;
        pieces.retain(|piece| {
            let is_new = piece.middle() > covered;
            covered = covered.max(piece.end());
            is_new
        });
        all.append(&mut pieces);
    }
    Ok(all)
}

/// The local nodes of the face on which all points lie: the shape functions of the other nodes vanish there.
fn face_of(reference: &'static ReferenceElement, points: &[PathPoint]) -> Option<&'static [usize]> {
    let is_on = |face: &&&[usize]| {
        let others = (0..reference.nodes.len()).filter(|node| !face.contains(node));
        others.into_iter().all(|node| points.iter().all(|point| point.weights[node].abs() <= SAME))
    };
    reference.faces.iter().find(is_on).copied()
}

/// A straight line between two points.
struct Line {
    from: [f64; 3],
    way: [f64; 3],
    /// Two unit vectors across it.
    across: [[f64; 3]; 2],
}

impl Line {
    fn new([from, to]: [[f64; 3]; 2]) -> Self {
        let way = minus(to, from);
        let unit = |v: [f64; 3]| v.map(|part| part / length(v));
        // In the plane the first vector lies in the plane, too.
        let first = if way[0] == 0.0 && way[1] == 0.0 { [1.0, 0.0, 0.0] } else { unit([-way[1], way[0], 0.0]) };
        Line { from, way, across: [first, unit(cross(way, first))] }
    }

    fn at(&self, share: f64) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.from[axis] + share * self.way[axis])
    }

    fn share(&self, place: [f64; 3]) -> f64 {
        dot(minus(place, self.from), self.way) / dot(self.way, self.way)
    }

    /// Returns `true` if the line passes through the box around nodes, which is a little larger than they need.
    fn is_near(&self, nodes: impl Iterator<Item = [f64; 3]> + Clone) -> bool {
        let ends = [0, 1, 2].map(|axis| {
            let start = (f64::INFINITY, f64::NEG_INFINITY);
            nodes.clone().fold(start, |(low, high), node| (low.min(node[axis]), high.max(node[axis])))
        });
        let room = BULGE * ends.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (axis, (low, high)) in ends.into_iter().enumerate() {
            let [a, b] = [low - room, high + room].map(|side| (side - self.from[axis]) / self.way[axis]);
            match self.way[axis] == 0.0 {
                true if self.from[axis] < low - room || self.from[axis] > high + room => return false,
                true => {}
                false => (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b))),
            }
        }
        enter <= leave
    }

    /// The parts of the line in an element.
    fn inside(&self, kind: ElementKind, body: &ElasticBody, element: &BodyElement) -> Vec<[f64; 2]> {
        let faces = kind.reference().faces.iter();
        let mut met: Vec<f64> = faces
            .flat_map(|face| {
                let nodes: Vec<usize> = face.iter().map(|&at| element.nodes[at]).collect();
                self.meets(kind.facet(), &body.coordinates(&nodes))
            })
            .map(|share| share.clamp(0.0, 1.0))
            .chain([0.0, 1.0])
            .collect();
        met.sort_by(f64::total_cmp);
        let is_inside = |&[start, end]: &[f64; 2]| {
            let is_long = (end - start) * length(self.way) > SAME * element.cell.unit();
            is_long && element.cell.weights_at(self.at(0.5 * (start + end)), SAME).is_some()
        };
        let mut parts: Vec<[f64; 2]> = Vec::new();
        for part in met.windows(2).map(|ends| [ends[0], ends[1]]).filter(is_inside) {
            match parts.last_mut() {
                Some(last) if last[1] == part[0] => last[1] = part[1],
                _ => parts.push(part),
            }
        }
        parts
    }

    /// The positions at which the line meets a face, by Newton's method from each of its nodes and from its middle.
    fn meets(&self, kind: FacetKind, nodes: &PerNode<[f64; 3]>) -> Vec<f64> {
        let (reference, cell) = (kind.reference(), Cell::new(kind.reference(), nodes));
        let starts = reference.nodes.iter().copied().chain([reference.centroid()]);
        starts.filter_map(|start| self.meets_near(reference, &cell, start)).collect()
    }

    /// The position at which the line meets a face, in reference coordinates near `at`; `None` outside the face, and if the line lies in
    /// it.
    fn meets_near(&self, reference: &ReferenceElement, cell: &Cell, mut at: [f64; 3]) -> Option<f64> {
        for _ in 0..STEPS {
            let place = cell.place(&(reference.shape)(at));
            let tangents = cell.jacobian(&(reference.derivative)(at));
            let away = minus(place, self.from);
            let change = match reference.dimension {
                0 => [0.0; 2],
                1 => [-dot(self.across[0], away) / (cell.unit() * dot(self.across[0], tangents[0])), 0.0],
                _ => {
                    let [first, second] = self.across.map(|v| [dot(v, tangents[0]), dot(v, tangents[1]), dot(v, away)]);
                    let determinant = cell.unit() * (first[0] * second[1] - first[1] * second[0]);
                    [
                        (first[1] * second[2] - first[2] * second[1]) / determinant,
                        (first[2] * second[0] - first[0] * second[2]) / determinant,
                    ]
                }
            };
            if !change.iter().all(|step| step.is_finite()) {
                return None;
            }
            (at[0], at[1]) = (at[0] + change[0], at[1] + change[1]);
            if change.iter().all(|step| step.abs() <= CONVERGED) {
                let place = cell.place(&(reference.shape)(at));
                return reference.contains(at, SAME).then(|| self.share(place));
            }
        }
        None
    }
}
