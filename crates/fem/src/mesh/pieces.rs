//! The elements of a mesh cut into straight triangles or tetrahedra.

use std::collections::{HashMap, HashSet};

use super::{Mesh, fail};
use crate::error::Error;
use crate::geometry::{cross, distance, dot, midpoint, minus, sorted};

/// A mid-edge node that lies off the chord by less than this, relative to the chord, is rounding.
const STRAIGHT: f64 = 1e-9;

/// A hexahedron cut into tetrahedra around its diagonal from corner 0 to corner 6. Opposite faces are cut in the same
/// direction, from their lowest to their highest corner, so that those of a lattice match.
pub const OF_HEXAHEDRON: [[usize; 4]; 6] =
    [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];

/// Straight triangles or tetrahedra that make up the elements of a mesh: of the corners alone if all edges are
/// straight, else in the plane of all nodes.
#[derive(Clone, Debug)]
pub struct Pieces {
    /// The nodes of pieces, in the order of the mesh.
    pub nodes: Vec<[f64; 3]>,
    pub cells: Vec<Vec<usize>>,
    pub elements: Vec<usize>,
    /// The number of each node of the mesh; `None` for a mid-edge node of a straight edge.
    numbers: Vec<Option<usize>>,
}

impl Pieces {
    /// The pieces of a mesh in the plane or in space.
    pub fn of(mesh: &Mesh) -> Result<Self, Error> {
        let straight = is_straight(mesh);
        if !straight && mesh.dimension() == 3 {
            return fail("the mesh has curved edges, which are no edges of a polyhedron".into());
        }
        let mut used = vec![!straight; mesh.nodes().len()];
        for element in 0..mesh.element_count() {
            parts(mesh, element).0.iter().for_each(|&node| used[node] = true);
        }
        let mut nodes = Vec::new();
        let number = |(used, &at): (bool, &[f64; 3])| {
            used.then(|| {
                nodes.push(at);
                nodes.len() - 1
            })
        };
        let numbers: Vec<Option<usize>> = used.into_iter().zip(mesh.nodes()).map(number).collect();
        let (mut cells, mut elements) = (Vec::new(), Vec::new());
        for index in 0..mesh.element_count() {
            for piece in cut(mesh, index, straight) {
                let Some(cell) = piece.iter().map(|&node| numbers[node]).collect::<Option<Vec<usize>>>() else {
                    continue;
                };
                if oriented_size(&cell.iter().map(|&node| nodes[node]).collect::<Vec<_>>()) <= 0.0 {
                    return fail(format!(
                        "the edges of element {index} are so curved that its straight pieces fold; take smaller cells there"
                    ));
                }
                cells.push(cell);
                elements.push(index);
            }
        }
        Ok(Pieces { nodes, cells, elements, numbers })
    }

    /// The facets of pieces, each by its nodes, increasing.
    pub fn facets(&self) -> impl Iterator<Item = Vec<usize>> + '_ {
        let without = |cell: &[usize], opposite: usize| sorted([&cell[..opposite], &cell[opposite + 1..]].concat());
        self.cells.iter().flat_map(move |cell| (0..cell.len()).map(move |opposite| without(cell, opposite)))
    }

    /// Returns `true` if the pieces meet in whole facets: all that belong to one piece only lie on the surface of the
    /// mesh.
    ///
    /// Two hexahedra can cut their common face along different diagonals.
    pub fn meet(&self, mesh: &Mesh) -> bool {
        if mesh.dimension() < 3 {
            return true;
        }
        let mut faces: HashMap<Vec<usize>, usize> = HashMap::new();
        for element in 0..mesh.element_count() {
            for face in mesh.kind_of(element).reference().faces {
                let corners = face.iter().filter_map(|&local| self.numbers[mesh.element(element)[local]]);
                *faces.entry(sorted(corners)).or_default() += 1;
            }
        }
        let outer = faces.into_iter().filter(|face| face.1 == 1);
        let on_surface: HashSet<Vec<usize>> = outer.flat_map(|(face, _)| without_one(&face)).collect();
        let mut of_pieces: HashMap<Vec<usize>, usize> = HashMap::new();
        self.facets().for_each(|facet| *of_pieces.entry(facet).or_default() += 1);
        of_pieces.into_iter().all(|(facet, count)| count == 2 || on_surface.contains(&facet))
    }

    /// The facets of pieces that may form a boundary, each by its nodes in the order of the boundary. A quadrilateral
    /// gives those of both diagonals, of which pieces have one.
    pub fn facets_of(&self, mesh: &Mesh, boundary: &str) -> Vec<Vec<usize>> {
        let of_facet = |facet: &[usize]| -> Vec<Vec<usize>> {
            let numbers: Vec<usize> = facet.iter().filter_map(|&node| self.numbers[node]).collect();
            match (mesh.dimension(), &numbers[..]) {
                (2, &[a, b, middle]) => vec![vec![a, middle], vec![middle, b]],
                (_, &[a, b, c, d]) => vec![vec![a, b, c], vec![a, c, d], vec![a, b, d], vec![b, c, d]],
                _ => vec![numbers],
            }
        };
        let facets = mesh.boundary(boundary).into_iter().flat_map(|boundary| boundary.facets());
        facets.flat_map(of_facet).collect()
    }
}

/// A triangle itself, or the triangles of three corners of a quadrilateral.
fn without_one(face: &[usize]) -> Vec<Vec<usize>> {
    match face.len() {
        4 => (0..4)
            .map(|left_out| (0..4).filter(|&corner| corner != left_out).map(|corner| face[corner]).collect())
            .collect(),
        _ => vec![face.to_vec()],
    }
}

/// The area of a triangle or the volume of a tetrahedron, times two or six; positive if its corners stand in the order
/// of their kind.
fn oriented_size(corners: &[[f64; 3]]) -> f64 {
    let edges: Vec<[f64; 3]> = corners.iter().skip(1).map(|&corner| minus(corner, corners[0])).collect();
    let third = edges.get(2).copied().unwrap_or([0.0, 0.0, 1.0]);
    dot(cross(edges[0], edges[1]), third)
}

/// The corners of an element, and the nodes in the middle of its edges.
fn parts(mesh: &Mesh, element: usize) -> (&[usize], &[usize]) {
    mesh.element(element).split_at(mesh.kind_of(element).corners())
}

/// The pieces of an element, by nodes of the mesh.
fn cut(mesh: &Mesh, element: usize, straight: bool) -> Vec<Vec<usize>> {
    let (corners, middles) = parts(mesh, element);
    if mesh.dimension() == 3 {
        return match corners.len() {
            8 => OF_HEXAHEDRON.iter().map(|piece| piece.iter().map(|&local| corners[local]).collect()).collect(),
            _ => vec![corners.to_vec()],
        };
    }
    let (mut pieces, mut inner) = (Vec::new(), corners);
    if !straight && !middles.is_empty() {
        let before = |k: usize| middles[(k + corners.len() - 1) % corners.len()];
        pieces.extend((0..corners.len()).map(|k| vec![corners[k], middles[k], before(k)]));
        inner = middles;
    }
    match *inner {
        [a, b, c] => pieces.push(vec![a, b, c]),
        [a, b, c, d] => {
            let length = |a: usize, b: usize| distance(mesh.nodes()[a], mesh.nodes()[b]);
            // Cut along the shorter diagonal: its triangles are less flat.
            let halves = if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            pieces.extend(halves.map(|half| half.to_vec()));
        }
        _ => {}
    }
    pieces
}

/// Returns `true` if all mid-edge nodes lie in the middle of their chords.
fn is_straight(mesh: &Mesh) -> bool {
    let nodes = mesh.nodes();
    (0..mesh.element_count()).all(|element| {
        let (corners, middles) = parts(mesh, element);
        middles.iter().zip(mesh.kind_of(element).reference().mid_sides).all(|(&middle, ends)| {
            let [from, to] = ends.map(|corner| nodes[corners[corner]]);
            let half = midpoint(from, to);
            distance(nodes[middle], half) <= STRAIGHT * distance(from, to)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Boundary, ElementKind, FacetKind};
    use super::*;

    /// One triangle of six nodes with its mid-edge nodes numbered first; the middle node of one side is moved out by
    /// `bulge`.
    fn triangle(bulge: f64) -> Mesh {
        let nodes = [[0.5, 0.0], [0.5 + bulge, 0.5 + bulge], [0.0, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let nodes = nodes.map(|[x, y]| [x, y, 0.0]).to_vec();
        let side = Boundary::new("side", FacetKind::Line3, vec![4, 5, 1]);
        Mesh::new(nodes, ElementKind::T6, vec![3, 4, 5, 0, 1, 2], vec![side]).unwrap()
    }

    /// Two cubes side by side; the second one begins at another corner, so that it cuts the common face along the other
    /// diagonal.
    #[test]
    fn cubes_meet_in_whole_facets_only_if_they_are_cut_alike() {
        let nodes: Vec<[f64; 3]> = (0..12).map(|node| [node / 4, node / 2 % 2, node % 2].map(f64::from)).collect();
        let cube = |first: usize| [0, 4, 6, 2, 1, 5, 7, 3].map(|node| first + node);
        let turned = [6, 10, 11, 7, 4, 8, 9, 5];
        for (second, expected) in [(cube(4), true), (turned, false)] {
            let elements = [cube(0), second].concat();
            let mesh = Mesh::new(nodes.clone(), ElementKind::Hex8, elements, Vec::new()).unwrap();
            assert_eq!(Pieces::of(&mesh).unwrap().meet(&mesh), expected, "{second:?}");
        }
    }

    #[test]
    fn straight_sides_need_the_corners_alone() {
        let mesh = triangle(0.0);
        let pieces = Pieces::of(&mesh).unwrap();
        assert_eq!(pieces.facets_of(&mesh, "side"), [[1, 2]]);
        assert_eq!(
            (pieces.cells, pieces.nodes),
            (vec![vec![0, 1, 2]], vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        );
    }

    #[test]
    fn a_curved_side_goes_through_its_middle_node() {
        let mesh = triangle(0.0625);
        let pieces = Pieces::of(&mesh).unwrap();
        assert_eq!((pieces.cells.len(), pieces.nodes.len()), (4, 6));
        assert_eq!(pieces.facets_of(&mesh, "side"), [[4, 1], [1, 5]]);
        // The triangle, and another one on its side of length sqrt 2, as high as the bulge.
        assert_eq!(twice_size(&pieces), 2.0 * (0.5 + 0.0625));
        assert_eq!(pieces.elements, [0; 4]);
    }

    /// The sum of the sizes of all pieces, times two or six.
    fn twice_size(pieces: &Pieces) -> f64 {
        let corners = |cell: &Vec<usize>| cell.iter().map(|&node| pieces.nodes[node]).collect::<Vec<_>>();
        pieces.cells.iter().map(|cell| oriented_size(&corners(cell))).sum()
    }

    /// A bar of two bricks, the top of which is a boundary.
    #[test]
    fn bricks_are_cut_into_tetrahedra_that_meet_in_whole_facets() {
        let nodes: Vec<[f64; 3]> =
            (0..12).map(|node| [f64::from(node % 3), f64::from(node / 3 % 2), f64::from(node / 6)]).collect();
        let bricks = [0, 1].map(|left| [0, 1, 4, 3, 6, 7, 10, 9].map(|corner| corner + left)).concat();
        let top = Boundary::new("top", FacetKind::Q4, vec![6, 7, 10, 9, 7, 8, 11, 10]);
        let mesh = Mesh::new(nodes, ElementKind::Hex8, bricks, vec![top]).unwrap();
        let pieces = Pieces::of(&mesh).unwrap();
        assert_eq!((pieces.cells.len(), twice_size(&pieces)), (12, 6.0 * 2.0));
        let mut all: Vec<Vec<usize>> = pieces.facets().collect();
        let on_top = pieces.facets_of(&mesh, "top").into_iter().map(sorted);
        let on_top = on_top.filter(|facet| all.contains(facet)).count();
        assert_eq!(on_top, 4);
        all.sort_unstable();
        let outer =
            all.chunk_by(|a, b| a == b).inspect(|facet| assert!(facet.len() <= 2)).filter(|facet| facet.len() == 1);
        // Ten squares on the surface, of two triangles each.
        assert_eq!(outer.count(), 20);
    }
}
