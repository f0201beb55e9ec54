//! A mesh of triangles that fills a polygon, or of tetrahedra that fills a polyhedron: its edges and facets, and its
//! refinement by bisection.

use std::collections::{BTreeMap, HashMap};

use super::simplex::{MOST_CORNERS, Point, Simplex, pairs};
use signorini_fem::geometry::{distance, key, midpoint};
use signorini_fem::mesh::axis::Lattice;
use signorini_fem::mesh::bisection::Tetrahedra;

/// Corners of a facet in space.
const OF_FACET: usize = MOST_CORNERS - 1;

/// Stands for a corner that a simplex in the plane does not have, after all others.
const ABSENT: usize = usize::MAX;

/// If moved nodes leave a simplex less than this share of its size, it is nearly flat or folded.
const FOLDED: f64 = 0.1;

/// Number of times that a marked tetrahedron of the guaranteed bound is halved.
const GENERATIONS: usize = 1;

/// Simplices before they are a mesh.
#[derive(Clone, Debug)]
pub struct Cells {
    pub nodes: Vec<Point>,
    /// The nodes of each simplex.
    pub cells: Vec<Vec<usize>>,
    /// The element of the first mesh that each of these simplices is a part of.
    pub origins: Vec<usize>,
    /// The number of the condition of each facet of the surface and of some inside, by their nodes, increasing.
    pub surface: HashMap<Vec<usize>, usize>,
}

/// Simplices that meet in whole facets. A local number k is that of corner k of a simplex, and of the facet opposite to
/// this corner.
#[derive(Clone, Debug)]
pub struct SimplexMesh {
    /// Number of coordinates of the mesh, 2 or 3.
    pub dimension: usize,
    /// Coordinates of the vertices, in length.
    pub nodes: Vec<Point>,
    cells: Vec<[usize; MOST_CORNERS]>,
    /// The two nodes of each edge, increasing.
    pub edges: Vec<[usize; 2]>,
    edges_of: Vec<usize>,
    facets: Vec<[usize; OF_FACET]>,
    sides: Vec<usize>,
    /// For each simplex, the element of the first mesh that contains it.
    pub origins: Vec<usize>,
    /// For each simplex, that of the mesh before of which it is a piece; in a first mesh itself.
    pub wholes: Vec<usize>,
    /// The number of the condition of each facet; most of those inside have none.
    pub conditions: Vec<Option<usize>>,
    surface: Vec<OuterFacet>,
    /// The ends of the edge that each new node halves, for the last nodes; empty in a first mesh.
    parents: Vec<[usize; 2]>,
    /// The edges of two bodies that lie opposite to each other, in the plane.
    opposites: Vec<EdgePair>,
    /// The same by facet and obstacle.
    partners: HashMap<(usize, usize), Partner>,
    /// How it is refined.
    next: Bisection,
}

/// A facet of the surface, or one inside that has a condition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OuterFacet {
    /// Its simplex; the first one of two.
    pub cell: usize,
    pub local: usize,
    pub facet: usize,
    pub condition: usize,
}

/// Two edges that may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgePair {
    pub obstacle: usize,
    /// The nodes of the edge of the body whose obstacle it is.
    pub own: [usize; 2],
    /// The nodes of the edge of the other body, each opposite to that of the first in the same place.
    pub other: [usize; 2],
}

/// The facet opposite to another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Partner {
    pub on: OuterFacet,
    /// For each corner of the other one the corner opposite to it.
    pub corners: [usize; 2],
}

impl EdgePair {
    /// Both edges by their nodes, increasing.
    pub fn edges(&self) -> [[usize; 2]; 2] {
        [self.own, self.other].map(|[a, b]| key(a, b))
    }

    /// The pieces if both edges are halved at the nodes that `middle` gives, else the edges as they are.
    pub fn halved(&self, middle: impl Fn([usize; 2]) -> Option<usize>) -> Vec<EdgePair> {
        let [own, other] = self.edges().map(middle);
        match own.zip(other) {
            None => vec![*self],
            Some((own, other)) => [0, 1]
                .map(|end| EdgePair { own: [self.own[end], own], other: [self.other[end], other], ..*self })
                .to_vec(),
        }
    }
}

/// What the next bisection needs.
#[derive(Clone, Debug)]
enum Bisection {
    /// The nodes of each triangle; the edge opposite to the first one is bisected first.
    Triangles(Vec<[usize; 3]>),
    Tetrahedra(Tetrahedra),
}

/// The conditions of the facets of the surface, by their nodes.
type Surface = HashMap<[usize; OF_FACET], usize>;

/// Numbers in increasing order; absent ones stand last.
fn filled<const N: usize>(nodes: impl IntoIterator<Item = usize>) -> [usize; N] {
    let mut all = [ABSENT; N];
    all.iter_mut().zip(nodes).for_each(|(place, node)| *place = node);
    all.sort_unstable();
    all
}

impl SimplexMesh {
    /// The mesh of these simplices. `None` if a facet of the surface has no condition.
    pub fn new(dimension: usize, Cells { nodes, cells, origins, surface }: Cells) -> Option<Self> {
        let next = match dimension {
            2 => {
                let corners = cells.iter().map(|cell| [cell[0], cell[1], cell[2]]);
                Bisection::Triangles(corners.map(|triangle| longest_first(&nodes, triangle)).collect())
            }
            _ => {
                let mut facets = BTreeMap::<_, Vec<_>>::new();
                for (facet, &condition) in &surface {
                    let facet: [usize; OF_FACET] = filled(facet.iter().copied());
                    facets.entry(facet).or_default().push((condition, facet));
                }
                let parts = cells.iter().map(Vec::as_slice).zip(0..);
                Bisection::Tetrahedra(Tetrahedra::new(nodes.clone(), parts, facets))
            }
        };
        let surface = surface.iter().map(|(facet, &condition)| (filled(facet.iter().copied()), condition)).collect();
        let mesh =
            Self::of(dimension, nodes, cells.iter().map(|cell| filled(cell.iter().copied())), origins, &surface, next);
        let mut cells_at = vec![0_u8; mesh.facets.len()];
        mesh.sides.iter().for_each(|&facet| cells_at[facet] += 1);
        let fits = |(at, condition): (&u8, &Option<usize>)| *at == 2 || condition.is_some();
        cells_at.iter().zip(&mesh.conditions).all(fits).then_some(mesh)
    }

    /// The mesh with edges of the surface in the plane that lie opposite to each other, and stay so when they are
    /// refined.
    pub fn with_opposites(mut self, opposites: Vec<EdgePair>) -> Self {
        let nodes = |outer: &OuterFacet| -> [usize; 2] { [0, 1].map(|corner| self.facets[outer.facet][corner]) };
        let at: HashMap<[usize; 2], OuterFacet> = self.surface.iter().map(|outer| (nodes(outer), *outer)).collect();
        let partner = |opposite: &EdgePair| {
            let [own, other] = opposite.edges().map(|edge| at.get(&edge));
            let is_reversed = (opposite.own[0] < opposite.own[1]) != (opposite.other[0] < opposite.other[1]);
            let partner = Partner { on: *other?, corners: if is_reversed { [1, 0] } else { [0, 1] } };
            Some(((own?.facet, opposite.obstacle), partner))
        };
        self.partners = opposites.iter().filter_map(partner).collect();
        SimplexMesh { opposites, ..self }
    }

    /// The simplices without their numbers.
    pub fn cells(&self) -> Cells {
        let conditions = self.facets.iter().zip(&self.conditions);
        let of_facet = |(facet, condition): (&[usize; OF_FACET], &Option<usize>)| {
            Some((facet[..self.dimension].to_vec(), (*condition)?))
        };
        Cells {
            nodes: self.nodes.clone(),
            cells: (0..self.count()).map(|cell| self.cell(cell).to_vec()).collect(),
            origins: self.origins.clone(),
            surface: conditions.filter_map(of_facet).collect(),
        }
    }

    /// The facet of another body, an obstacle, that lies opposite to a facet; `None` without one.
    pub fn partner(&self, facet: usize, obstacle: usize) -> Option<&Partner> {
        self.partners.get(&(facet, obstacle))
    }

    /// Numbers edges and facets.
    fn of(
        dimension: usize,
        nodes: Vec<Point>,
        cells: impl Iterator<Item = [usize; MOST_CORNERS]>,
        origins: Vec<usize>,
        surface: &Surface,
        next: Bisection,
    ) -> Self {
        let cells: Vec<_> = cells.collect();
        let (mut edges, mut facets) = (Lattice::default(), Lattice::default());
        let (mut edges_of, mut sides) = (Vec::new(), Vec::new());
        for cell in &cells {
            let corners = &cell[..=dimension];
            let of_pairs = pairs(corners.len()).filter(|[i, j]| i < j);
            edges_of.extend(of_pairs.map(|[i, j]| edges.node([corners[i], corners[j]])));
            let facet = |local: usize| filled(corners.iter().copied().filter(|&node| node != corners[local]));
            sides.extend((0..corners.len()).map(|local| facets.node(facet(local))));
        }
        let (edges, facets) = (edges.keys, facets.keys);
        let conditions: Vec<Option<usize>> = facets.iter().map(|facet| surface.get(facet).copied()).collect();
        let mut left = conditions.clone();
        let outer = sides.iter().enumerate().filter_map(|(place, &facet)| {
            let (cell, local) = (place / (dimension + 1), place % (dimension + 1));
            Some(OuterFacet { cell, local, facet, condition: left[facet].take()? })
        });
        let (surface, parents, wholes) = (outer.collect(), Vec::new(), (0..cells.len()).collect());
        SimplexMesh {
            dimension,
            nodes,
            cells,
            edges,
            edges_of,
            facets,
            sides,
            origins,
            wholes,
            conditions,
            surface,
            parents,
            opposites: Vec::new(),
            partners: HashMap::new(),
            next,
        }
    }

    pub fn count(&self) -> usize {
        self.cells.len()
    }

    /// The nodes of a simplex, increasing.
    pub fn cell(&self, cell: usize) -> &[usize] {
        &self.cells[cell][..=self.dimension]
    }

    /// A simplex with its corners in the order of its nodes.
    pub fn simplex(&self, cell: usize) -> Simplex {
        Simplex::new(self.dimension, self.cell(cell).iter().map(|&node| self.nodes[node]))
    }

    /// The edges of a simplex, in the order of the pairs i < j of its corners.
    pub fn edges_of(&self, cell: usize) -> &[usize] {
        let count = self.dimension * (self.dimension + 1) / 2;
        &self.edges_of[cell * count..(cell + 1) * count]
    }

    /// The facets of a simplex; each lies opposite to the corner with its local number.
    pub fn sides(&self, cell: usize) -> &[usize] {
        &self.sides[cell * (self.dimension + 1)..(cell + 1) * (self.dimension + 1)]
    }

    pub fn facet_count(&self) -> usize {
        self.facets.len()
    }

    /// The nodes of a facet, increasing.
    pub fn facet(&self, facet: usize) -> &[usize] {
        &self.facets[facet][..self.dimension]
    }

    /// The corners of a facet in the order of its nodes.
    pub fn corners_of_facet(&self, facet: usize) -> Vec<Point> {
        self.facet(facet).iter().map(|&node| self.nodes[node]).collect()
    }

    /// The facets with conditions, each once: those of the surface, and some inside.
    pub fn surface(&self) -> impl Iterator<Item = OuterFacet> + '_ {
        self.surface.iter().copied()
    }

    /// The one or two simplices that share each facet, in increasing order; a facet of the surface has only the first.
    pub fn cells_at(&self) -> Vec<[Option<usize>; 2]> {
        let mut cells_at = vec![[None; 2]; self.facet_count()];
        for cell in 0..self.count() {
            for &facet in self.sides(cell) {
                let place = usize::from(cells_at[facet][0].is_some());
                cells_at[facet][place] = Some(cell);
            }
        }
        cells_at
    }

    /// Returns `true` if a simplex has lost most of its size in a mesh of the same simplices with other node positions.
    pub fn is_folded_beside(&self, other: &SimplexMesh) -> bool {
        (0..self.count()).any(|cell| {
            let [own, before] = [self, other].map(|mesh| mesh.simplex(cell).oriented_size());
            own / before <= FOLDED
        })
    }

    /// The mesh in which the marked simplices are refined, with the further bisections that this needs: every edge of a
    /// marked triangle is halved, a marked tetrahedron is halved once. The surface keeps its conditions, and no angle
    /// tends to zero. `placed` moves the middle of a side of a polygon, given the number of its condition.
    pub fn refined(&self, marked: &[bool], placed: impl Fn(usize, Point) -> Point) -> Self {
        match &self.next {
            Bisection::Triangles(triangles) => self.refined_triangles(triangles, marked, placed),
            Bisection::Tetrahedra(cells) => {
                let mut cells = cells.clone();
                let parents = cells.refine(marked, GENERATIONS);
                let (wholes, nodes, surface) = (cells.parents(), cells.nodes().to_vec(), cells.facets().collect());
                let origins = wholes.iter().map(|&whole| self.origins[whole]).collect();
                let corners: Vec<_> = cells.cells().map(filled).collect();
                let next = Bisection::Tetrahedra(cells.numbered());
                let mesh = Self::of(self.dimension, nodes, corners.into_iter(), origins, &surface, next);
                SimplexMesh { wholes, parents, ..mesh }
            }
        }
    }

    fn refined_triangles(
        &self,
        triangles: &[[usize; 3]],
        marked: &[bool],
        placed: impl Fn(usize, Point) -> Point,
    ) -> Self {
        let mut halved: HashMap<[usize; 2], Option<usize>> = HashMap::new();
        let sides = |&[newest, a, b]: &[usize; 3]| [key(a, b), key(b, newest), key(newest, a)];
        for (triangle, _) in triangles.iter().zip(marked).filter(|entry| *entry.1) {
            halved.extend(sides(triangle).map(|edge| (edge, None)));
        }
        // A triangle with a halved edge halves its first edge too, and edges opposite to each other are halved
        // together.
        let mut waiting = true;
        while waiting {
            waiting = false;
            for [first, second, third] in triangles.iter().map(sides) {
                let hangs = halved.contains_key(&second) || halved.contains_key(&third);
                if hangs && !halved.contains_key(&first) {
                    halved.insert(first, None);
                    waiting = true;
                }
            }
            for [own, other] in self.opposites.iter().map(EdgePair::edges) {
                if halved.contains_key(&own) != halved.contains_key(&other) {
                    halved.extend([(own, None), (other, None)]);
                    waiting = true;
                }
            }
        }
        let (mut nodes, mut surface, mut parents) = (self.nodes.clone(), Surface::new(), Vec::new());
        for (facet, &condition) in self.facets.iter().zip(&self.conditions) {
            let [a, b, _] = *facet;
            let mut ends = vec![*facet];
            if let Some(middle) = halved.get_mut(&[a, b]) {
                let half = midpoint(nodes[a], nodes[b]);
                ends = vec![filled([a, nodes.len()]), filled([b, nodes.len()])];
                *middle = Some(nodes.len());
                nodes.push(condition.map_or(half, |condition| placed(condition, half)));
                parents.push([a, b]);
            }
            surface.extend(condition.into_iter().flat_map(|condition| ends.iter().map(move |&end| (end, condition))));
        }
        let (mut pieces, mut wholes) = (Vec::with_capacity(2 * triangles.len()), Vec::new());
        let mut left: Vec<([usize; 3], usize)> = triangles.iter().copied().zip(0..triangles.len()).rev().collect();
        while let Some(([newest, a, b], whole)) = left.pop() {
            match halved.get(&key(a, b)).copied().flatten() {
                Some(middle) => left.extend([([middle, b, newest], whole), ([middle, newest, a], whole)]),
                None => {
                    pieces.push([newest, a, b]);
                    wholes.push(whole);
                }
            }
        }
        let middle = |edge: [usize; 2]| halved.get(&edge).copied().flatten();
        let opposites = self.opposites.iter().flat_map(|opposite| opposite.halved(middle)).collect();
        let cells = pieces.clone().into_iter().map(filled);
        let origins = wholes.iter().map(|&whole| self.origins[whole]).collect();
        let mesh = Self::of(2, nodes, cells, origins, &surface, Bisection::Triangles(pieces));
        let mesh = SimplexMesh { wholes, parents, ..mesh };
        if self.opposites.is_empty() { mesh } else { mesh.with_opposites(opposites) }
    }

    /// A property of nodes of the previous mesh, carried to this one: that of a new node comes of those at both ends of
    /// its edge.
    pub fn carried<T: Copy>(&self, mut of_nodes: Vec<T>, joined: impl Fn(T, T) -> T) -> Vec<T> {
        for &[a, b] in &self.parents {
            of_nodes.push(joined(of_nodes[a], of_nodes[b]));
        }
        of_nodes
    }
}

/// The corners rotated so that the longest edge is bisected first.
fn longest_first(nodes: &[Point], mut triangle: [usize; 3]) -> [usize; 3] {
    let length = |k: usize| distance(nodes[triangle[(k + 1) % 3]], nodes[triangle[(k + 2) % 3]]);
    let longest = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0);
    triangle.rotate_left(longest);
    triangle
}

#[cfg(test)]
mod tests {
    use super::super::bodies::unit;
    use super::*;

    #[test]
    fn bisection_keeps_the_size_the_surface_and_whole_facets() {
        for (dimension, steps, least) in [(2, 6, 40), (3, 9, 100)] {
            let mut mesh = SimplexMesh::new(dimension, unit(dimension)).unwrap();
            let sides = 2 * mesh.dimension;
            for step in 0..steps {
                let marked: Vec<bool> = (0..mesh.count()).map(|index| index % 3 == step % 3).collect();
                mesh = mesh.refined(&marked, |_, middle| middle);
                let size: f64 = (0..mesh.count()).map(|cell| mesh.simplex(cell).size()).sum();
                // Every coordinate is a short binary fraction: there is hardly any rounding.
                assert!((size - 1.0).abs() < 1e-14, "{size}");
                let mut cells_at = vec![0; mesh.facet_count()];
                mesh.sides.iter().for_each(|&facet| cells_at[facet] += 1);
                for (facet, count) in cells_at.into_iter().enumerate() {
                    let expected = if mesh.conditions[facet].is_some() { 1 } else { 2 };
                    assert_eq!(count, expected, "facet {facet} of step {step}");
                }
                let mut sizes = vec![0.0; sides];
                for OuterFacet { cell, local, condition, .. } in mesh.surface() {
                    sizes[condition] += mesh.simplex(cell).outward(local).1;
                }
                assert!(sizes.iter().all(|size| (size - 1.0).abs() < 1e-13), "{sizes:?}");
                for (cell, &origin) in mesh.origins.iter().enumerate().filter(|_| mesh.dimension == 2) {
                    // The diagonal separates the two triangles of the square.
                    let [x, y, _] = mesh.simplex(cell).centre();
                    assert_eq!(origin, usize::from(y > x));
                }
                let at_bottom = vec![true, true, false, false];
                if mesh.dimension == 2 && step == 0 {
                    let carried = mesh.carried(at_bottom, |one, other| one && other);
                    carried.iter().zip(&mesh.nodes).for_each(|(&has, node)| assert_eq!(has, node[1] == 0.0));
                }
            }
            assert!(mesh.count() > least, "{}", mesh.count());
        }
    }

    /// Halves of right-angled triangles with two equal sides are such triangles: the smallest angle stays at 45
    /// degrees.
    #[test]
    fn bisection_keeps_the_angles() {
        let mut mesh = SimplexMesh::new(2, unit(2)).unwrap();
        for _ in 0..8 {
            let marked: Vec<bool> = (0..mesh.count()).map(|cell| mesh.cell(cell).contains(&0)).collect();
            mesh = mesh.refined(&marked, |_, middle| middle);
        }
        for cell in 0..mesh.count() {
            let simplex = mesh.simplex(cell);
            let longest = (0..3).map(|local| simplex.outward(local).1).fold(0.0, f64::max);
            assert!((2.0 * simplex.size() / longest.powi(2) - 0.5).abs() < 1e-15, "{simplex:?}");
        }
    }

    #[test]
    fn the_longest_edge_lies_opposite_to_the_first_corner() {
        let nodes = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 1.0, 0.0]];
        for triangle in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1]] {
            assert_eq!(longest_first(&nodes, triangle)[0], 1);
        }
    }

    #[test]
    fn a_surface_without_a_condition_is_no_mesh() {
        let nodes = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let surface = HashMap::from([(vec![0, 1], 0), (vec![1, 2], 1)]);
        let cells = Cells { nodes, cells: vec![vec![0, 1, 2]], origins: vec![0], surface };
        assert!(SimplexMesh::new(2, cells).is_none());
    }
}
