//! Displacement and stress along a straight line, element by element.

use super::{Stress, finished};
use crate::body::{BodyElement, ElasticBody};
use crate::element::{Cell, PerNode, ReferenceElement, TabulatedPoint};
use crate::error::Error;
use crate::geometry::{cross, dot, length, minus, shifted};

/// Points of a piece in an element whose stress is not constant.
const POINTS: usize = 5;
/// Reference coordinates, and places in the size of an element, that differ by less are equal.
const SAME: f64 = 1e-9;
/// The box of the nodes of an element grows by this share of its size: curved sides may leave it.
const BULGE: f64 = 0.25;
/// On the axis of revolution u_r/r is 0/0: the stress is taken so far from there towards the centroid, in reference
/// coordinates.
const OFF_AXIS: f64 = 1e-6;
/// Newton's method ends when the reference coordinates move by less than this.
const CONVERGED: f64 = 1e-13;
/// Steps of Newton's method to the point at which the line meets a face.
const STEPS: usize = 30;

/// The part of a straight line that lies in one element: the points at which the answer is given on it.
#[derive(Clone, Debug)]
pub struct PathPiece {
    /// The element, an index from 0.
    pub element: usize,
    /// Points from its beginning to its end, both included.
    pub points: Vec<PathPoint>,
}

/// A point of a straight line inside an element, with what the answer is there.
#[derive(Clone, Copy, Debug)]
pub struct PathPoint {
    /// Its distance from the first end of the line, in length.
    pub distance: f64,
    /// [x, y, z], in length.
    pub place: [f64; 3],
    /// The shape functions of the element there: weights of its nodes.
    pub weights: PerNode<f64>,
    /// The stress of the element there, which is not averaged with that of its neighbours.
    pub stress: Stress,
}

impl PathPiece {
    /// Its first distance from the first end of the line.
    pub fn start(&self) -> f64 {
        self.points[0].distance
    }

    /// Its last distance from the first end of the line.
    pub fn end(&self) -> f64 {
        self.points[self.points.len() - 1].distance
    }

    /// The local nodes on which the piece depends: those of the smallest side of the element that contains it.
    pub fn side(&self) -> impl Iterator<Item = usize> + '_ {
        let depends = |node: &usize| self.points.iter().any(|point| point.weights[*node].abs() > SAME);
        (0..self.points[0].weights.len()).filter(depends)
    }
}

impl ElasticBody {
    /// The pieces of a line between two points, in length, in the elements of the body under the nodal displacement
    /// `displacement` (`dim` a node): region by region, in the order of the line. Along a common side of several
    /// elements of one region, the piece of one of them alone.
    pub fn along(&self, displacement: &[f64], ends: [[f64; 3]; 2]) -> Result<Vec<PathPiece>, Error> {
        self.check_nodal("nodal displacement", displacement.len())?;
        let Some(line) = PathLine::within(ends, self.mesh().extent(), self.mesh().size()) else {
            return Ok(Vec::new());
        };
        let tables = self.tabulated();
        let is_about_axis = self.formulation().is_axisymmetric();
        let mut elements = self.elements().enumerate();
        let mut all = Vec::new();
        for region in self.regions() {
            let mut pieces: Vec<PathPiece> = Vec::new();
            for (index, element) in elements.by_ref().take(region.elements().len()) {
                if !line.is_near(element.nodes.iter().map(|&node| self.mesh().nodes()[node])) {
                    continue;
                }
                let reference = element.kind.reference();
                // The stress of such an element is constant.
                let is_constant =
                    reference.nodes.len() == reference.dimension + 1 && !is_about_axis && !self.has_own_stress();
                let points = if is_constant { 2 } else { POINTS };
                let strained = self.strained(&tables, displacement, &element);
                let at = |from_start: f64| {
                    let place = line.at(from_start);
                    let at = element.cell.reference_coordinates(place);
                    let on_axis = is_about_axis && place[0].abs() <= SAME * element.cell.unit();
                    let share = if on_axis { OFF_AXIS } else { 0.0 };
                    let inside = [0, 1, 2].map(|axis| at[axis] + share * (reference.centroid()[axis] - at[axis]));
                    let stress = finished(self, strained.at(&TabulatedPoint::new(reference, inside, 0.0)).1);
                    PathPoint { distance: line.offset + from_start, place, weights: (reference.shape)(at), stress }
                };
                for [start, end] in line.inside(self, &element) {
                    let share = |point: usize| point as f64 / (points - 1) as f64;
                    let points = (0..points).map(|point| at(start + (end - start) * share(point))).collect();
                    pieces.push(PathPiece { element: index, points });
                }
            }
            pieces.sort_by(|a, b| a.start().total_cmp(&b.start()).then(a.element.cmp(&b.element)));
            let mut covered = f64::NEG_INFINITY;
            pieces.retain(|piece| {
                let is_new = 0.5 * (piece.start() + piece.end()) > covered;
                covered = covered.max(piece.end());
                is_new
            });
            all.append(&mut pieces);
        }
        Ok(all)
    }
}

/// The part of a straight line near a mesh.
struct PathLine {
    from: [f64; 3],
    /// The distance of that point from the first end of the whole line.
    offset: f64,
    length: f64,
    /// The unit vector along it.
    way: [f64; 3],
    /// Two unit vectors across it; in the plane the first lies in the plane.
    across: [[f64; 3]; 2],
}

impl PathLine {
    /// The part of the line between two different points in a box with room of `size` around it; `None` outside.
    fn within(ends: [[f64; 3]; 2], (low, high): ([f64; 3], [f64; 3]), size: f64) -> Option<Self> {
        let whole = minus(ends[1], ends[0]);
        // No square of a component overflows or vanishes.
        let largest = whole.iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
        let scaled = whole.map(|part| part / largest);
        let unit = |v: [f64; 3]| v.map(|part| part / length(v));
        let way = unit(scaled);
        let first = if way[0] == 0.0 && way[1] == 0.0 { [1.0, 0.0, 0.0] } else { unit([-way[1], way[0], 0.0]) };
        let line = PathLine {
            from: ends[0],
            offset: 0.0,
            length: largest * length(scaled),
            way,
            across: [first, unit(cross(way, first))],
        };
        let [start, end] = line.in_box([0, 1, 2].map(|axis| [low[axis] - size, high[axis] + size]))?;
        Some(PathLine { from: line.at(start), offset: start, length: end - start, ..line })
    }

    fn at(&self, distance: f64) -> [f64; 3] {
        shifted(self.from, distance, self.way)
    }

    fn distance(&self, place: [f64; 3]) -> f64 {
        dot(minus(place, self.from), self.way)
    }

    /// The part of the line in a box.
    fn in_box(&self, sides: [[f64; 2]; 3]) -> Option<[f64; 2]> {
        let (mut enter, mut leave) = (0.0_f64, self.length);
        for (axis, [low, high]) in sides.into_iter().enumerate() {
            let [a, b] = [low, high].map(|side| (side - self.from[axis]) / self.way[axis]);
            match self.way[axis] == 0.0 {
                true if self.from[axis] < low || self.from[axis] > high => return None,
                true => {}
                false => (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b))),
            }
        }
        (enter <= leave).then_some([enter, leave])
    }

    /// Returns `true` if the line passes through the box around nodes, which is a little larger than they need.
    fn is_near(&self, nodes: impl Iterator<Item = [f64; 3]> + Clone) -> bool {
        let ends = [0, 1, 2].map(|axis| {
            let start = [f64::INFINITY, f64::NEG_INFINITY];
            nodes.clone().fold(start, |[low, high], node| [low.min(node[axis]), high.max(node[axis])])
        });
        let room = BULGE * ends.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        self.in_box(ends.map(|[low, high]| [low - room, high + room])).is_some()
    }

    fn inside(&self, body: &ElasticBody, element: &BodyElement) -> Vec<[f64; 2]> {
        let kind = element.kind;
        let smallest = SAME * element.cell.unit().min(self.length);
        // Places relative to a point of the line beside the element are as exact as its own coordinates.
        let near = self.distance(body.mesh().nodes()[element.nodes[0]]);
        let mut met: Vec<f64> = vec![0.0, self.length];
        for face in kind.reference().faces {
            let reference = kind.facet().reference();
            let place = |local: usize| minus(body.mesh().nodes()[element.nodes[face[local]]], self.at(near));
            let cell = Cell::at(reference, place);
            let starts = reference.nodes.iter().copied().chain([reference.centroid()]);
            let found = starts.filter_map(|start| self.meets(reference, &cell, start));
            met.extend(found.map(|from_near| (near + from_near).clamp(0.0, self.length)));
        }
        met.sort_by(f64::total_cmp);
        met.dedup_by(|next, last| *next - *last <= smallest);
        let is_inside = |&[start, end]: &[f64; 2]| {
            end - start > smallest && element.cell.weights_at(self.at(0.5 * (start + end)), SAME).is_some()
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

    /// The distance along the line from the origin of the coordinates of a face, which lies on the line, to the point
    /// at which the line meets the face, by Newton's method in reference coordinates from `at`. `None` outside the
    /// face, and if the line lies in it.
    fn meets(&self, reference: &ReferenceElement, cell: &Cell, mut at: [f64; 3]) -> Option<f64> {
        for _ in 0..STEPS {
            let place = cell.place(&(reference.shape)(at));
            let tangents = cell.jacobian(&(reference.derivative)(at));
            let change = match reference.dimension {
                0 => [0.0; 2],
                1 => [-dot(self.across[0], place) / (cell.unit() * dot(self.across[0], tangents[0])), 0.0],
                _ => {
                    let [first, second] =
                        self.across.map(|v| [dot(v, tangents[0]), dot(v, tangents[1]), dot(v, place)]);
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
                return reference.contains(at, SAME).then(|| dot(place, self.way));
            }
        }
        None
    }
}
