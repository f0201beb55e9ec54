//! A closed surface: every edge joins two triangles that run along it in opposite directions.

use super::facets::Facets;
use super::tree::{Limits, NOWHERE, Tree, joined};
use super::triangle::Triangle;
use crate::error::Error;
use crate::fem::geometry::{Around, distance, dot, length, minus};

/// A volume below this times area and extent is rounding: a sheet folded onto itself encloses no volume.
const NO_VOLUME: f64 = 1e-13;

/// The boundary of one solid or of several, made of triangles that leave no gap, so that each place is inside or
/// outside.
#[derive(Debug)]
pub struct ClosedSurface {
    vertices: Vec<[f64; 3]>,
    /// Counterclockwise seen from outside.
    corners: Vec<[u32; 3]>,
    /// The triangles around each vertex.
    around: Around,
    pub(super) tree: Tree,
}

impl ClosedSurface {
    /// Checks that the triangles form closed surfaces, reverses them if all run clockwise, and builds the tree.
    pub(super) fn new(mut facets: Facets) -> Result<Self, Error> {
        let of_triangles = facets.corners.iter().map(|corners| corners.map(|vertex| vertex as usize));
        let around = Around::new(facets.vertices.len(), of_triangles);
        check_edges(&facets, &around)?;
        let place = |corners: &[u32; 3]| Triangle(corners.map(|vertex| facets.vertices[vertex as usize]));
        let has_area = |&triangle: &u32| place(&facets.corners[triangle as usize]).area_normal() != [0.0; 3];
        let numbers: Vec<u32> = (0..facets.corners.len() as u32).filter(has_area).collect();
        if numbers.is_empty() {
            return Err(facets.fault(0, "it has no triangle with a positive area"));
        }
        let tree = Tree::new(&numbers, |triangle| limits(place(&facets.corners[triangle as usize])));
        let [low, high] = tree.limits();
        let (mut volume, mut area) = (0.0, 0.0);
        for triangle in numbers.iter().map(|&triangle| place(&facets.corners[triangle as usize])) {
            let normal = triangle.area_normal();
            volume += dot(normal, minus(triangle.0[0], low)) / 6.0;
            area += length(normal) / 2.0;
        }
        if volume.abs() <= NO_VOLUME * area * distance(low, high) {
            return Err(facets.fault(0, format!("it encloses no volume: {volume:.1e}, for an area of {area:.1e}")));
        }
        if volume < 0.0 {
            facets.corners.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        Ok(ClosedSurface { vertices: facets.vertices, corners: facets.corners, around, tree })
    }

    pub(super) fn triangle(&self, number: u32) -> Triangle {
        Triangle(self.corners_of(number).map(|vertex| self.vertices[vertex as usize]))
    }

    pub(super) fn corners_of(&self, number: u32) -> [u32; 3] {
        self.corners[number as usize]
    }

    pub(super) fn around(&self, vertex: u32) -> &[u32] {
        self.around.at(vertex as usize)
    }
}

fn limits(triangle: Triangle) -> Limits {
    triangle.0.into_iter().fold(NOWHERE, |sum, corner| joined(sum, [corner; 2]))
}

/// Edges with one kind of fault.
#[derive(Clone, Copy, Debug)]
struct Faulty {
    count: usize,
    first: Along,
}

/// A triangle along an edge: its number, and the corner at which its edge begins.
type Along = (u32, usize);

/// Every edge must join two triangles, in opposite directions.
fn check_edges(facets: &Facets, around: &Around) -> Result<(), Error> {
    let [mut open, mut crowded, mut alike]: [Option<Faulty>; 3] = [None; 3];
    let mut edges: Vec<(u32, Along)> = Vec::new();
    for vertex in 0..facets.vertices.len() as u32 {
        // An edge is counted at its end with the lower number, as the other end and a triangle along it. They are
        // sorted: the tip of a cone and copies of one triangle have very many.
        edges.clear();
        for &triangle in around.at(vertex as usize) {
            let corners = facets.corners[triangle as usize];
            for (corner, from) in corners.into_iter().enumerate() {
                let to = corners[(corner + 1) % 3];
                if from.min(to) == vertex {
                    edges.push((from.max(to), (triangle, corner)));
                }
            }
        }
        edges.sort_unstable();
        for of_edge in edges.chunk_by(|one, next| one.0 == next.0) {
            let begins = |&(_, (triangle, corner)): &(u32, Along)| facets.corners[triangle as usize][corner] == vertex;
            let away = of_edge.iter().filter(|&along| begins(along)).count();
            let kind = match (away, of_edge.len() - away) {
                (1, 1) => continue,
                (1, 0) | (0, 1) => &mut open,
                (2, 0) | (0, 2) => &mut alike,
                _ => &mut crowded,
            };
            let first = of_edge[0].1;
            let known = kind.get_or_insert(Faulty { count: 0, first });
            (known.count, known.first) = (known.count + 1, known.first.min(first));
        }
    }
    let edges = |count: usize| if count == 1 { "1 edge".into() } else { format!("{count} edges") };
    let (found, message) = match (open, crowded, alike) {
        (Some(found), _, _) => {
            let many = if found.count == 1 { "belongs" } else { "belong" };
            let message = format!(
                "the surface is not closed after vertices of equal coordinates are merged: {} {many} to one \
                 triangle only, but an obstacle needs an inside",
                edges(found.count)
            );
            (found, message)
        }
        (None, Some(found), _) => (
            found,
            "more than two triangles meet at an edge, so that inside and outside cannot be distinguished".into(),
        ),
        (None, None, Some(found)) => {
            let message = format!(
                "triangles on both sides of {} run along them in the same direction, so that one triangle faces \
                 inwards; orient all triangles alike",
                edges(found.count)
            );
            (found, message)
        }
        (None, None, None) => return Ok(()),
    };
    let (triangle, corner) = (found.first.0 as usize, found.first.1);
    let corners = facets.corners[triangle];
    let [from, to] = [corners[corner], corners[(corner + 1) % 3]].map(|vertex| facets.vertices[vertex as usize]);
    let message = format!("{message}; the first runs from {from:?} to {to:?} at the triangle that begins here");
    Err(facets.fault(facets.place(triangle), message))
}
