//! The elements of a plane mesh cut into straight triangles.

use super::{Mesh, fail};
use crate::error::Error;
use crate::fem::geometry::{distance, key};

/// A mid-edge node that lies off the chord by less than this, relative to the chord, is rounding.
const STRAIGHT: f64 = 1e-9;

/// Straight triangles that make up the elements of a plane mesh: of the corners alone if all edges are straight, else of all nodes.
#[derive(Clone, Debug)]
pub(crate) struct TrianglePieces {
    /// The nodes of triangles, in the order of the mesh.
    pub nodes: Vec<[f64; 2]>,
    /// The nodes of each triangle, counterclockwise.
    pub triangles: Vec<[usize; 3]>,
    /// The element of each triangle.
    pub elements: Vec<usize>,
    /// The number of each node of the mesh; `None` for a mid-edge node of a straight edge.
    numbers: Vec<Option<usize>>,
}

impl TrianglePieces {
    /// The triangles of a plane mesh.
    ///
    /// # Errors
    /// [`Error::Mesh`] for an element with edges that are so curved that a triangle has no area.
    pub fn of(mesh: &Mesh) -> Result<Self, Error> {
        let straight = is_straight(mesh);
        let mut used = vec![!straight; mesh.nodes().len()];
        for element in 0..mesh.element_count() {
            parts(mesh, element).0.iter().for_each(|&node| used[node] = true);
        }
        let mut nodes = Vec::new();
        let number = |(used, at): (bool, &[f64; 3])| {
            used.then(|| {
                nodes.push([at[0], at[1]]);
                nodes.len() - 1
            })
        };
        let numbers: Vec<Option<usize>> = used.into_iter().zip(mesh.nodes()).map(number).collect();
        let (mut triangles, mut elements) = (Vec::new(), Vec::new());
        for index in 0..mesh.element_count() {
            for piece in cut(mesh, index, straight) {
                let [Some(a), Some(b), Some(c)] = piece.map(|node| numbers[node]) else { continue };
                let [[ax, ay], [bx, by], [cx, cy]] = [a, b, c].map(|node: usize| nodes[node]);
                if (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) <= 0.0 {
                    return fail(format!(
                        "the edges of element {index} are so curved that its straight pieces fold; take smaller cells there"
                    ));
                }
                triangles.push([a, b, c]);
                elements.push(index);
            }
        }
        Ok(TrianglePieces { nodes, triangles, elements, numbers })
    }

    /// The edges of triangles that form a boundary, each by its two nodes, increasing.
    pub fn edges_of(&self, mesh: &Mesh, boundary: &str) -> Vec<[usize; 2]> {
        let of_facet = |facet: &[usize]| {
            let number = |place: usize| facet.get(place).and_then(|&node| self.numbers[node]);
            match (number(0), number(1), number(2)) {
                (Some(a), Some(b), Some(middle)) => [Some(key(a, middle)), Some(key(middle, b))],
                (Some(a), Some(b), None) => [Some(key(a, b)), None],
                _ => [None; 2],
            }
        };
        let facets = mesh.boundary(boundary).into_iter().flat_map(|boundary| boundary.facets());
        facets.flat_map(of_facet).flatten().collect()
    }
}

/// The corners of an element, and the nodes in the middle of its edges.
fn parts(mesh: &Mesh, element: usize) -> (&[usize], &[usize]) {
    mesh.element(element).split_at(mesh.kind_of(element).corners())
}

/// The triangles of an element, by nodes of the mesh.
fn cut(mesh: &Mesh, element: usize, straight: bool) -> Vec<[usize; 3]> {
    let (corners, middles) = parts(mesh, element);
    let (mut pieces, mut inner) = (Vec::new(), corners);
    if !straight && !middles.is_empty() {
        let before = |k: usize| middles[(k + corners.len() - 1) % corners.len()];
        pieces.extend((0..corners.len()).map(|k| [corners[k], middles[k], before(k)]));
        inner = middles;
    }
    match *inner {
        [a, b, c] => pieces.push([a, b, c]),
        [a, b, c, d] => {
            let length = |a: usize, b: usize| distance(mesh.nodes()[a], mesh.nodes()[b]);
            // Cut along the shorter diagonal: its triangles are less flat.
            pieces.extend(if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
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
        middles.iter().enumerate().all(|(side, &middle)| {
            let [from, to] = [corners[side], corners[(side + 1) % corners.len()]].map(|node| nodes[node]);
            let half = [0, 1, 2].map(|axis| (from[axis] + to[axis]) / 2.0);
            distance(nodes[middle], half) <= STRAIGHT * distance(from, to)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Boundary, ElementKind, FacetKind};
    use super::*;

    /// One triangle of six nodes with its mid-edge nodes numbered first; the middle node of one side is moved out by `bulge`.
    fn triangle(bulge: f64) -> Mesh {
        let nodes = [[0.5, 0.0], [0.5 + bulge, 0.5 + bulge], [0.0, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let nodes = nodes.map(|[x, y]| [x, y, 0.0]).to_vec();
        let side = Boundary::new("side", FacetKind::Line3, vec![4, 5, 1]);
        Mesh::new(nodes, ElementKind::ALL[2], vec![3, 4, 5, 0, 1, 2], vec![side]).unwrap()
    }

    #[test]
    fn straight_sides_need_the_corners_alone() {
        let mesh = triangle(0.0);
        let pieces = TrianglePieces::of(&mesh).unwrap();
        assert_eq!((pieces.triangles, pieces.nodes), (vec![[0, 1, 2]], vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]));
        assert_eq!(TrianglePieces::of(&mesh).unwrap().edges_of(&mesh, "side"), [[1, 2]]);
    }

    #[test]
    fn a_curved_side_goes_through_its_middle_node() {
        let mesh = triangle(0.0625);
        let pieces = TrianglePieces::of(&mesh).unwrap();
        assert_eq!((pieces.triangles.len(), pieces.nodes.len()), (4, 6));
        assert_eq!(pieces.edges_of(&mesh, "side"), [[1, 4], [1, 5]]);
        let area = |[a, b, c]: [usize; 3]| {
            let [a, b, c] = [a, b, c].map(|node: usize| pieces.nodes[node]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        };
        // The triangle, and another one on its side of length sqrt 2, as high as the bulge.
        assert_eq!(pieces.triangles.iter().map(|&one| area(one)).sum::<f64>(), 0.5 + 0.0625);
        assert_eq!(pieces.elements, [0; 4]);
    }
}
