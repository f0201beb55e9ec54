//! Refinement of marked tetrahedra by bisection.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::pieces::Pieces;
use super::{Boundary, ElementKind, Mesh};
use crate::error::Error;
use crate::geometry::{cross, distance, dot, key, midpoint, minus};

/// A mesh of tetrahedra with the data that bisection needs of each.
///
/// Every face has a marked edge, which is halved before its other two, and tetrahedra that share a face agree on it: so
/// halves always meet in whole faces, for any first mesh. Shapes repeat after a few generations, so that no angle tends
/// to zero.
///
/// # Source
/// D. N. Arnold, A. Mukherjee, L. Pouly, "Locally adapted tetrahedral meshes using bisection", SIAM J. Sci. Comput. 22
/// (2000) 431-448.
#[derive(Clone, Debug)]
pub struct Tetrahedra {
    nodes: Vec<[f64; 3]>,
    cells: Vec<Marked>,
    /// The facets of boundaries by their nodes, increasing: the number of the boundary and the nodes in their order.
    facets: BTreeMap<[usize; 3], Vec<(usize, [usize; 3])>>,
    names: Vec<String>,
}

/// A tetrahedron; the edge of its first two nodes is halved next.
#[derive(Clone, Copy, Debug)]
struct Marked {
    nodes: [usize; 4],
    /// The marked edges of the faces opposite to the first and to the second node; that of the other two faces is the
    /// edge to be halved.
    opposite: [[usize; 2]; 2],
    /// `true` if bisection made it from a tetrahedron whose marked edges lie in one face.
    is_second: bool,
    /// The element of the first mesh that it is a part of.
    parent: usize,
}

impl Tetrahedra {
    /// From the elements of a mesh in space, each cut into tetrahedra, with the longest edge of each face marked;
    /// `None` if edges are curved, or if the tetrahedra do not meet in whole faces.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let pieces = Pieces::of(mesh).ok().filter(|pieces| mesh.dimension() == 3 && pieces.meet(mesh))?;
        let exists: HashSet<Vec<usize>> = pieces.facets().collect();
        let mut facets = BTreeMap::<_, Vec<_>>::new();
        for (number, boundary) in mesh.boundaries().iter().enumerate() {
            for facet in pieces.facets_of(mesh, &boundary.name) {
                let Ok(own) = <[usize; 3]>::try_from(facet) else { continue };
                // A quadrilateral has the facets of both diagonals, and one diagonal exists.
                if exists.contains(&sorted(own)[..]) {
                    facets.entry(sorted(own)).or_default().push((number, own));
                }
            }
        }
        let names = mesh.boundaries().iter().map(|boundary| boundary.name.clone()).collect();
        let cells = pieces.cells.iter().map(Vec::as_slice).zip(pieces.elements.iter().copied());
        Some(Tetrahedra { names, ..Self::new(pieces.nodes.clone(), cells, facets) })
    }

    /// From tetrahedra by their nodes, each with the cell that it is a part of, and from the facets of boundaries by
    /// their nodes, increasing: numbers of boundaries with the nodes in any order. The boundaries have no names.
    pub fn new<'a>(
        nodes: Vec<[f64; 3]>,
        cells: impl Iterator<Item = (&'a [usize], usize)>,
        facets: BTreeMap<[usize; 3], Vec<(usize, [usize; 3])>>,
    ) -> Self {
        let cells = cells.map(|(element, parent)| Marked::of(&nodes, element, parent)).collect();
        Tetrahedra { nodes, cells, facets, names: Vec::new() }
    }

    /// Coordinates of the corners of all tetrahedra, in length.
    pub fn nodes(&self) -> &[[f64; 3]] {
        &self.nodes
    }

    /// The nodes of each tetrahedron, in any order.
    pub fn cells(&self) -> impl Iterator<Item = [usize; 4]> + '_ {
        self.cells.iter().map(|cell| cell.nodes)
    }

    /// The facets of boundaries by their nodes, increasing, each with the number of its boundary.
    pub fn facets(&self) -> impl Iterator<Item = ([usize; 3], usize)> + '_ {
        self.facets.iter().flat_map(|(&facet, of)| of.iter().map(move |entry| (facet, entry.0)))
    }

    /// For each tetrahedron, the element of the first mesh that it is a part of.
    pub fn parents(&self) -> Vec<usize> {
        self.cells.iter().map(|cell| cell.parent).collect()
    }

    /// The same tetrahedra, each a part of itself.
    pub fn numbered(mut self) -> Self {
        self.cells.iter_mut().enumerate().for_each(|(number, cell)| cell.parent = number);
        self
    }

    /// The mesh of quadratic tetrahedra with straight edges, in the order of the cells; its boundaries keep their
    /// names.
    pub fn mesh(&self) -> Result<Mesh, Error> {
        let connectivity = self.cells.iter().flat_map(|cell| turned(&self.nodes, cell.nodes)).collect();
        let of_boundary = |number: usize| {
            let own = self.facets.values().flatten().filter(|facet| facet.0 == number);
            own.flat_map(|facet| facet.1).collect()
        };
        let kind = ElementKind::LINEAR_TETRAHEDRON;
        let boundary = |(number, name): (usize, &String)| Boundary::new(name, kind.facet(), of_boundary(number));
        let boundaries = self.names.iter().enumerate().map(boundary).collect();
        Mesh::new(self.nodes.clone(), kind, connectivity, boundaries)?.elevated(ElementKind::QUADRATIC_TETRAHEDRON)
    }

    /// Halves each marked tetrahedron and its halves `generations` times, and further tetrahedra with a hanging node.
    /// The pieces replace the whole in the order. Returns the ends of the edge that each new node halves.
    pub fn refine(&mut self, marked: &[bool], generations: usize) -> Vec<[usize; 2]> {
        let (mut middles, before) = (HashMap::new(), self.nodes.len());
        let mut left: Vec<usize> = marked.iter().map(|&marked| if marked { generations } else { 0 }).collect();
        while left.iter().any(|&left| left > 0) {
            let (mut cells, mut still) = (Vec::with_capacity(2 * self.cells.len()), Vec::new());
            for (cell, left) in std::mem::take(&mut self.cells).into_iter().zip(left) {
                if left == 0 {
                    cells.push(cell);
                    still.push(0);
                } else {
                    cells.extend(self.halves(cell, &mut middles));
                    still.extend([left - 1; 2]);
                }
            }
            // A tetrahedron with a halved edge is halved too.
            let hangs = |cell: &Marked| cell.edges().iter().any(|edge| middles.contains_key(edge));
            for (cell, left) in cells.iter().zip(&mut still) {
                *left = (*left).max(usize::from(hangs(cell)));
            }
            (self.cells, left) = (cells, still);
        }
        let mut ends = vec![[0; 2]; self.nodes.len() - before];
        middles.into_iter().for_each(|(edge, middle)| ends[middle - before] = edge);
        ends
    }

    /// Both halves of a tetrahedron; its facets on boundaries are halved too.
    fn halves(&mut self, cell: Marked, middles: &mut HashMap<[usize; 2], usize>) -> [Marked; 2] {
        let [a, b, c, d] = cell.nodes;
        let nodes = &mut self.nodes;
        let middle = *middles.entry(key(a, b)).or_insert_with(|| {
            nodes.push(midpoint(nodes[a], nodes[b]));
            nodes.len() - 1
        });
        for third in [c, d] {
            for (boundary, facet) in self.facets.remove(&sorted([a, b, third])).unwrap_or_default() {
                for replaced in [a, b] {
                    let half = facet.map(|node| if node == replaced { middle } else { node });
                    self.facets.entry(sorted(half)).or_default().push((boundary, half));
                }
            }
        }
        let flat_at = cell.flat_at();
        // The face between the halves.
        let between = match flat_at {
            Some(shared) if cell.is_second => key(shared, middle),
            _ => key(c, d),
        };
        [(a, cell.opposite[1]), (b, cell.opposite[0])].map(|(kept, [p, q])| {
            let [s] = [kept, c, d].into_iter().filter(|&node| node != p && node != q).collect::<Vec<_>>()[..] else {
                return cell;
            };
            // In a face with the new node the edge opposite to it is marked, except in the face between the halves.
            let face = |x: usize, y: usize| if key(x, y) == key(c, d) { between } else { key(x, y) };
            Marked {
                nodes: [p, q, s, middle],
                opposite: [face(q, s), face(p, s)],
                is_second: flat_at.is_some() && !cell.is_second,
                parent: cell.parent,
            }
        })
    }
}

impl Marked {
    /// A tetrahedron of the first mesh, the longest edge of each face marked; of edges of one length that of the larger
    /// numbers.
    fn of(places: &[[f64; 3]], element: &[usize], parent: usize) -> Self {
        let longest = |face: &[usize]| {
            let edges = face.iter().enumerate().flat_map(|(k, &a)| face[k + 1..].iter().map(move |&b| key(a, b)));
            let length = |edge: &[usize; 2]| distance(places[edge[0]], places[edge[1]]);
            edges.max_by(|one, other| length(one).total_cmp(&length(other)).then(one.cmp(other))).unwrap_or_default()
        };
        let [a, b] = longest(element);
        let others: Vec<usize> = element.iter().copied().filter(|&node| node != a && node != b).collect();
        let [c, d] = [others[0], others[1]];
        Marked { nodes: [a, b, c, d], opposite: [longest(&[b, c, d]), longest(&[a, c, d])], is_second: false, parent }
    }

    fn edges(&self) -> [[usize; 2]; 6] {
        let [a, b, c, d] = self.nodes;
        [key(a, b), key(a, c), key(a, d), key(b, c), key(b, d), key(c, d)]
    }

    /// The third node of the face in which all marked edges lie.
    fn flat_at(&self) -> Option<usize> {
        let [a, b, c, d] = self.nodes;
        [c, d].into_iter().find(|&shared| self.opposite == [key(b, shared), key(a, shared)])
    }
}

fn sorted(mut nodes: [usize; 3]) -> [usize; 3] {
    nodes.sort_unstable();
    nodes
}

/// The nodes in an order of positive volume.
fn turned(places: &[[f64; 3]], nodes: [usize; 4]) -> [usize; 4] {
    let [a, b, c, d] = nodes;
    if volume(nodes.map(|node| places[node])) < 0.0 { [b, a, c, d] } else { [a, b, c, d] }
}

/// The volume of a tetrahedron, positive if its corners stand in the order of its kind.
fn volume([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
    dot(minus(b, a), cross(minus(c, a), minus(d, a))) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{length, plus};
    use crate::mesh::gmsh::GmshFile;

    /// The ratio of the radii of inscribed and circumscribed sphere, times three: 1 for the regular tetrahedron, 0 for
    /// a flat one.
    fn quality(corners: [[f64; 3]; 4]) -> f64 {
        let area = |[a, b, c]: [[f64; 3]; 3]| length(cross(minus(b, a), minus(c, a))) / 2.0;
        let [a, b, c, d] = corners;
        let faces = area([b, c, d]) + area([a, c, d]) + area([a, b, d]) + area([a, b, c]);
        let volume = volume(corners).abs();
        let longest = [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)].map(|(p, q)| distance(p, q));
        // The inner radius over the longest edge, 1 if all edges are equal.
        3.0 * volume / faces / longest.into_iter().fold(0.0, f64::max) * 24.0_f64.sqrt()
    }

    fn file(name: &str) -> Mesh {
        let path = format!("{}/../../tests/meshes/{name}", env!("CARGO_MANIFEST_DIR"));
        GmshFile::read(path).unwrap().mesh(&[], 1.0).unwrap()
    }

    /// Every inner face lies between two tetrahedra, and every other face on the surface.
    fn faces_of_one(cells: &[Marked]) -> usize {
        let mut faces: HashMap<[usize; 3], usize> = HashMap::new();
        for [a, b, c, d] in cells.iter().map(|cell| cell.nodes) {
            for face in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
                *faces.entry(sorted(face)).or_default() += 1;
            }
        }
        assert!(faces.values().all(|&count| count <= 2));
        faces.values().filter(|&&count| count == 1).count()
    }

    #[test]
    fn bisection_keeps_volume_surface_and_shape() {
        let first = file("box-tet4.msh");
        let mut mesh = Tetrahedra::of(&first).unwrap();
        let whole = |mesh: &Tetrahedra| -> [f64; 2] {
            let volumes = mesh.cells.iter().map(|cell| volume(cell.nodes.map(|node| mesh.nodes[node])).abs());
            let worst = mesh.cells.iter().map(|cell| quality(cell.nodes.map(|node| mesh.nodes[node])));
            [volumes.sum(), worst.fold(1.0, f64::min)]
        };
        let [volume, worst] = whole(&mesh);
        assert_eq!(faces_of_one(&mesh.cells), mesh.facets.values().map(|_| 1).sum::<usize>());
        for step in 0..7 {
            // The tetrahedra around a corner, and some others.
            let marked: Vec<bool> =
                mesh.cells.iter().enumerate().map(|(k, cell)| cell.nodes.contains(&0) || k % 41 == step).collect();
            mesh.refine(&marked, 2);
            let [now, shape] = whole(&mesh);
            assert!((now / volume - 1.0).abs() < 1e-12, "{now} {volume}");
            assert!(shape > 0.25 * worst, "{shape} {worst}");
            // The boundaries are the whole surface before and after.
            assert_eq!(faces_of_one(&mesh.cells), mesh.facets.len());
        }
        let refined = mesh.mesh().unwrap();
        assert_eq!(refined.element_count(), mesh.cells.len());
        assert!(mesh.cells.len() > 5 * first.element_count(), "{}", mesh.cells.len());
        for (before, after) in first.boundaries().iter().zip(refined.boundaries()) {
            assert_eq!(before.name, after.name);
            let on = |mesh: &Mesh, boundary: &Boundary| {
                let corner = |node: usize| mesh.nodes()[node];
                let side = |f: &[usize], to: usize| minus(corner(f[to]), corner(f[0]));
                boundary.facets().map(|f| cross(side(f, 1), side(f, 2))).fold([0.0; 3], plus)
            };
            // The vector of area: size and side of the facets.
            let (one, two) = (on(&first, before), on(&refined, after));
            (0..3).for_each(|k| assert!((one[k] - two[k]).abs() < 1e-12 * volume, "{one:?} {two:?}"));
        }
    }

    /// Bricks become six tetrahedra each, whose faces are the boundaries of the bricks and nothing else.
    #[test]
    fn bricks_are_bisected_as_tetrahedra_with_the_same_boundaries() {
        let first = file("box-hex8.msh");
        let mut mesh = Tetrahedra::of(&first).unwrap();
        assert_eq!(mesh.parents(), (0..6 * first.element_count()).map(|cell| cell / 6).collect::<Vec<_>>());
        mesh.refine(&(0..mesh.cells.len()).map(|cell| cell % 3 == 0).collect::<Vec<_>>(), 2);
        let refined = mesh.mesh().unwrap();
        assert!(refined.kinds().eq([ElementKind::QUADRATIC_TETRAHEDRON]));
        for (before, after) in first.boundaries().iter().zip(refined.boundaries()) {
            assert_eq!(before.name, after.name);
            let of_nodes = |mesh: &Mesh, boundary: &Boundary| {
                let at: Vec<[f64; 3]> = boundary.nodes().into_iter().map(|node| mesh.nodes()[node]).collect();
                crate::mesh::extent(&at)
            };
            assert_eq!(of_nodes(&first, before), of_nodes(&refined, after));
        }
    }

    #[test]
    fn plane_elements_are_not_bisected() {
        assert!(Tetrahedra::of(&file("half-disc-t6.msh")).is_none());
    }
}
