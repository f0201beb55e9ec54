//! The facets of two surfaces, and the points at which the integrals over what both share are taken.

use crate::element::{Cell, FacetKind, MAX_NODES, PerNode, ReferenceElement};
use crate::geometry::{cross, distance, dot, length, midpoint, minus, plus, unit};
use crate::mesh::Boundary;

/// Two facets face each other if the angle between one normal and the opposite of the other is below 60 degrees.
const FACING: f64 = 0.5;

/// A mid-side node farther from the middle of its edge than this share of the facet's size makes the facet curved.
pub(super) const STRAIGHT: f64 = 1e-12;

/// A surface of a body: its facets, and the nodes that these name.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceMesh<'a> {
    pub(super) nodes: &'a [[f64; 3]],
    pub(super) kind: FacetKind,
    pub(super) facets: &'a [usize],
}

impl<'a> SurfaceMesh<'a> {
    pub fn of((nodes, boundary): (&'a [[f64; 3]], &'a Boundary)) -> Self {
        SurfaceMesh { nodes, kind: boundary.kind, facets: &boundary.connectivity }
    }
}

/// A facet in place.
#[derive(Clone, Debug)]
pub(super) struct PlacedFacet<'a> {
    pub kind: FacetKind,
    pub nodes: &'a [usize],
    pub corners: PerNode<[f64; 3]>,
    /// Its mean outward unit normal.
    pub normal: [f64; 3],
    /// The ball around it.
    pub middle: [f64; 3],
    pub radius: f64,
    /// All mid-side nodes lie in the middle of straight edges.
    pub is_straight: bool,
    /// The straight pieces of which it consists: its corners, or more pieces if it is curved.
    pub pieces: Vec<Vec<[f64; 3]>>,
}

/// A point that both surfaces share, in the reference coordinates of both facets.
#[derive(Clone, Copy, Debug)]
pub(super) struct SharedPoint {
    pub slave: [f64; 3],
    pub master: [f64; 3],
    /// The area of the slave surface that it stands for, without thickness or circumference.
    pub weight: f64,
}

impl<'a> PlacedFacet<'a> {
    pub fn new(surface: &SurfaceMesh<'a>, nodes: &'a [usize]) -> Self {
        let mut places = [[0.0; 3]; MAX_NODES];
        places.iter_mut().zip(nodes).for_each(|(place, &node)| *place = surface.nodes[node]);
        let own = &places[..nodes.len()];
        let middle = [0, 1, 2].map(|axis| own.iter().map(|place| place[axis]).sum::<f64>() / own.len() as f64);
        let radius = own.iter().fold(0.0, |radius: f64, &place| radius.max(distance(place, middle)));
        let (kind, normal) = (surface.kind, [0.0; 3]);
        let mut facet = PlacedFacet {
            kind,
            nodes,
            corners: places,
            normal,
            middle,
            radius,
            is_straight: false,
            pieces: Vec::new(),
        };
        facet.is_straight = facet.is_straight();
        facet.pieces = facet.pieces();
        facet.normal = unit(facet.pieces.iter().fold([0.0; 3], |sum, piece| {
            let vector = area_vector(piece);
            plus(sum, vector)
        }));
        facet
    }

    pub fn reference(&self) -> &'static ReferenceElement {
        self.kind.reference()
    }

    pub fn places(&self) -> &[[f64; 3]] {
        &self.corners[..self.nodes.len()]
    }

    /// Returns `true` if all its points lie in one plane, and all mid-side nodes in the middle of straight edges.
    pub fn is_flat(&self) -> bool {
        let from_middle = |place: &[f64; 3]| dot(minus(*place, self.middle), self.normal).abs();
        self.is_straight && self.places().iter().all(|place| from_middle(place) <= STRAIGHT * self.radius)
    }

    fn is_straight(&self) -> bool {
        let (reference, places) = (self.reference(), self.places());
        reference.mid_sides.iter().zip(&places[reference.corners..]).all(|(&[a, b], &place)| {
            let middle = midpoint(places[a], places[b]);
            distance(place, middle) <= STRAIGHT * self.radius
        })
    }

    fn pieces(&self) -> Vec<Vec<[f64; 3]>> {
        let places = self.places();
        if self.is_straight {
            return vec![places[..self.reference().corners].to_vec()];
        }
        let locals: Vec<usize> = (0..places.len()).collect();
        let cells = self.kind.straight_cells(&locals).into_iter();
        cells.map(|cell| cell.into_iter().map(|local| places[local]).collect()).collect()
    }

    pub fn faces(&self, other: &PlacedFacet) -> bool {
        dot(self.normal, other.normal) < -FACING
    }

    /// Returns `true` if the angle between both normals is below 60 degrees.
    pub fn is_alike(&self, other: &PlacedFacet) -> bool {
        dot(self.normal, other.normal) > FACING
    }

    /// The place with these values of its shape functions.
    pub fn at(&self, shape: &PerNode<f64>) -> [f64; 3] {
        let parts = || self.places().iter().zip(shape);
        [0, 1, 2].map(|axis| parts().map(|(place, share)| share * place[axis]).sum())
    }

    /// Adds its part to the normals of its nodes, with weights that leave no error on circles and spheres, however much
    /// the facets around a node differ: `|a x b| / (a.a b.b)` at a corner with the edges a and b.
    pub fn add_normals(&self, sums: &mut [[f64; 3]]) {
        let (reference, cell) = (self.reference(), Cell::at(self.reference(), |local| self.corners[local]));
        for (local, &node) in self.nodes.iter().enumerate() {
            let normal = unit(cell.area_vector(&(reference.derivative)(reference.nodes[local])));
            let weight = self.weight(local);
            sums[node].iter_mut().zip(normal).for_each(|(sum, part)| *sum += weight * part);
        }
    }

    /// The weight of its normal at a node.
    fn weight(&self, local: usize) -> f64 {
        let (places, corners) = (self.places(), self.reference().corners);
        let edge = |step: usize| minus(places[(local + step) % corners], places[local]);
        let (turn, size) = match corners {
            _ if local >= corners => (1.0, 1.0),
            2 => (1.0, length(edge(1))),
            _ => {
                let (a, b) = (edge(1), edge(corners - 1));
                (length(cross(unit(a), unit(b))), length(a) * length(b))
            }
        };
        if size > 0.0 { turn / size } else { 0.0 }
    }
}

/// The largest `h angle / 8` of facets that stand for a curve: `h` is the length of an edge, and the angle that between
/// the normals at its ends. An edge between normals that turn more than 40 degrees is a corner, and curved facets
/// follow the curve.
pub(super) fn sag(facets: &[PlacedFacet], normals: &[[f64; 3]]) -> f64 {
    const CORNER: f64 = 40.0 * std::f64::consts::PI / 180.0;
    const ROUNDING: f64 = 1e-7;
    let mut largest: f64 = 0.0;
    for facet in facets.iter().filter(|facet| facet.reference().mid_sides.is_empty()) {
        let count = facet.nodes.len();
        for (a, b) in (0..count).map(|at| (at, (at + 1) % count)) {
            let angle = 2.0 * (distance(normals[facet.nodes[a]], normals[facet.nodes[b]]) / 2.0).min(1.0).asin();
            if (ROUNDING..CORNER).contains(&angle) {
                largest = largest.max(distance(facet.places()[a], facet.places()[b]) * angle / 8.0);
            }
        }
    }
    largest
}

/// The area of a straight piece as a vector along its outward normal: half the sum over its corners; of an edge its
/// length.
pub(super) fn area_vector(piece: &[[f64; 3]]) -> [f64; 3] {
    match *piece {
        [a, b] => {
            let [x, y, _] = minus(b, a);
            [y, -x, 0.0]
        }
        _ => (0..piece.len()).fold([0.0; 3], |sum, corner| {
            let (a, b) = (minus(piece[corner], piece[0]), minus(piece[(corner + 1) % piece.len()], piece[0]));
            let part = cross(a, b);
            [0, 1, 2].map(|axis| sum[axis] + part[axis] / 2.0)
        }),
    }
}
