//! A triangulation of a polygon: its edges, and its refinement by bisection.

use std::collections::HashMap;

use crate::fem::geometry::key;
use crate::fem::mesh::lattice::Lattice;

/// Coordinates or components `[x, y]`.
pub type Point = [f64; 2];

/// Triangles that meet in whole edges.
#[derive(Clone, Debug)]
pub struct Triangulation {
    /// The vertices.
    pub nodes: Vec<Point>,
    /// The nodes of each triangle, counterclockwise; the edge opposite to the first one is bisected first.
    pub triangles: Vec<[usize; 3]>,
    /// The two nodes of each edge, increasing.
    pub edges: Vec<[usize; 2]>,
    /// The edges of each triangle; edge k lies opposite to its node k.
    pub sides: Vec<[usize; 3]>,
    /// The element of the first mesh that contains each triangle.
    pub origins: Vec<usize>,
    /// The number of the condition of each edge of the outline. `None` inside.
    pub conditions: Vec<Option<usize>>,
    /// The ends of the edge that each new node halves, for the last nodes; empty in a first mesh.
    parents: Vec<[usize; 2]>,
}

/// The mid-sides of a triangle: the mean of a quadratic function at these points is its mean over the triangle.
pub const MIDDLES: [[f64; 3]; 3] = [[0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];

/// The barycentric coordinates of the centroid.
pub const CENTRE: [f64; 3] = [1.0 / 3.0; 3];

/// If moved nodes leave a triangle less than this share of its area, it is nearly flat or folded.
const FOLDED: f64 = 0.1;

impl Triangulation {
    /// The triangulation of these triangles (counterclockwise), pieces of the elements `origins`, with corners rotated so that the
    /// longest edge of each is bisected first, with the condition of each edge of the outline. `None` if an edge of the outline has no
    /// condition, or one inside has one.
    pub fn new(
        nodes: Vec<Point>,
        mut triangles: Vec<[usize; 3]>,
        origins: Vec<usize>,
        outline: &HashMap<[usize; 2], usize>,
    ) -> Option<Self> {
        for triangle in &mut triangles {
            let length = |k: usize| distance(nodes[triangle[(k + 1) % 3]], nodes[triangle[(k + 2) % 3]]);
            let longest = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0);
            triangle.rotate_left(longest);
        }
        let mesh = Self::of(nodes, triangles, origins, outline);
        let mut triangles_at = vec![0_u8; mesh.edges.len()];
        mesh.sides.iter().flatten().for_each(|&edge| triangles_at[edge] += 1);
        let fits = |(at, condition): (&u8, &Option<usize>)| (*at == 1) == condition.is_some();
        triangles_at.iter().zip(&mesh.conditions).all(fits).then_some(mesh)
    }

    /// Numbers the edges.
    fn of(
        nodes: Vec<Point>,
        triangles: Vec<[usize; 3]>,
        origins: Vec<usize>,
        outline: &HashMap<[usize; 2], usize>,
    ) -> Self {
        let mut numbered = Lattice::new();
        let mut side = |a: usize, b: usize| numbered.node(key(a, b));
        let sides = triangles.iter().map(|&[a, b, c]| [side(b, c), side(c, a), side(a, b)]).collect();
        let edges = numbered.keys;
        let conditions = edges.iter().map(|edge| outline.get(edge).copied()).collect();
        Triangulation { nodes, triangles, edges, sides, origins, conditions, parents: Vec::new() }
    }

    /// Returns `true` if a triangle has lost most of its area in a mesh of the same triangles with other node positions.
    pub fn is_folded_beside(&self, other: &Triangulation) -> bool {
        let area = |mesh: &Triangulation, triangle: usize| twice_area(mesh.corners(triangle));
        (0..self.triangles.len()).any(|triangle| area(self, triangle) <= FOLDED * area(other, triangle))
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Point; 3] {
        self.triangles[triangle].map(|node| self.nodes[node])
    }

    /// The end, 0 or 1, of the edge of a side at which the corner stands that follows `next` corners after the one opposite to the side.
    pub fn end_at(&self, triangle: usize, local: usize, next: usize) -> usize {
        let node = self.triangles[triangle][(local + next) % 3];
        usize::from(self.edges[self.sides[triangle][local]][0] != node)
    }

    /// The sides of the outline: triangle, local number of the side, edge and condition.
    pub fn outline(&self) -> impl Iterator<Item = (usize, usize, usize, usize)> + '_ {
        let of_triangle = move |triangle: usize| {
            (0..3).filter_map(move |local| {
                let edge = self.sides[triangle][local];
                Some((triangle, local, edge, self.conditions[edge]?))
            })
        };
        (0..self.triangles.len()).flat_map(of_triangle)
    }

    /// The mesh in which every edge of the marked triangles is halved, with the further bisections that this needs. The outline keeps its
    /// conditions, and no angle becomes smaller than after four bisections of the first mesh. `placed` moves the middle of a side of the
    /// outline, given the number of its condition.
    pub fn refined(&self, marked: &[bool], placed: impl Fn(usize, Point) -> Point) -> Self {
        let mut halved = vec![false; self.edges.len()];
        for (sides, _) in self.sides.iter().zip(marked).filter(|entry| *entry.1) {
            sides.iter().for_each(|&edge| halved[edge] = true);
        }
        // A triangle with a halved edge halves its first edge too.
        let mut waiting = true;
        while waiting {
            waiting = false;
            for sides in &self.sides {
                if !halved[sides[0]] && (halved[sides[1]] || halved[sides[2]]) {
                    halved[sides[0]] = true;
                    waiting = true;
                }
            }
        }
        let (mut nodes, mut outline, mut middle) = (self.nodes.clone(), HashMap::new(), HashMap::new());
        let mut parents = Vec::new();
        for (edge, &[a, b]) in self.edges.iter().enumerate() {
            let ends: &[[usize; 2]] = if halved[edge] {
                let [from, to] = [self.nodes[a], self.nodes[b]];
                let half = [0, 1].map(|axis| (from[axis] + to[axis]) / 2.0);
                nodes.push(self.conditions[edge].map_or(half, |condition| placed(condition, half)));
                parents.push([a, b]);
                middle.insert([a, b], nodes.len() - 1);
                &[key(a, nodes.len() - 1), key(b, nodes.len() - 1)]
            } else {
                &[[a, b]]
            };
            if let Some(condition) = self.conditions[edge] {
                outline.extend(ends.iter().map(|&end| (end, condition)));
            }
        }
        let (mut triangles, mut origins) = (Vec::with_capacity(2 * self.triangles.len()), Vec::new());
        let mut left: Vec<([usize; 3], usize)> =
            self.triangles.iter().copied().zip(self.origins.iter().copied()).rev().collect();
        while let Some(([newest, a, b], origin)) = left.pop() {
            if let Some(&middle) = middle.get(&key(a, b)) {
                left.extend([([middle, b, newest], origin), ([middle, newest, a], origin)]);
            } else {
                triangles.push([newest, a, b]);
                origins.push(origin);
            }
        }
        Triangulation { parents, ..Self::of(nodes, triangles, origins, &outline) }
    }

    /// A property of nodes of the previous mesh, carried to this one: a new node has it if both ends of its edge have it.
    pub fn carried(&self, mut of_nodes: Vec<bool>) -> Vec<bool> {
        let of_new: Vec<bool> = self.parents.iter().map(|ends| ends.iter().all(|&end| of_nodes[end])).collect();
        of_nodes.extend(of_new);
        of_nodes
    }
}

/// The distance of two points.
pub fn distance(a: Point, b: Point) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Twice the area of a triangle; positive if its corners stand counterclockwise.
pub fn twice_area([a, b, c]: [Point; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The gradients of the barycentric coordinates.
pub fn slopes(corners: [Point; 3]) -> [Point; 3] {
    let area = twice_area(corners);
    [0, 1, 2].map(|local| {
        let [from, to] = [corners[(local + 1) % 3], corners[(local + 2) % 3]];
        [(from[1] - to[1]) / area, (to[0] - from[0]) / area]
    })
}

/// The outward unit normal of the side opposite to corner `local`, and its length.
pub fn outward(corners: [Point; 3], local: usize) -> (Point, f64) {
    let [from, to] = [corners[(local + 1) % 3], corners[(local + 2) % 3]];
    let length = distance(from, to);
    ([(to[1] - from[1]) / length, (from[0] - to[0]) / length], length)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit square in two triangles, its four sides with the conditions 0 to 3.
    fn square() -> Triangulation {
        let nodes = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let outline = HashMap::from([([0, 1], 0), ([1, 2], 1), ([2, 3], 2), ([0, 3], 3)]);
        Triangulation::new(nodes, vec![[0, 1, 2], [0, 2, 3]], vec![0, 1], &outline).unwrap()
    }

    #[test]
    fn bisection_keeps_the_area_the_outline_and_whole_edges() {
        let mut mesh = square();
        for step in 0..6 {
            let marked: Vec<bool> = (0..mesh.triangles.len()).map(|index| index % 3 == step % 3).collect();
            mesh = mesh.refined(&marked, |_, middle| middle);
            let area: f64 = (0..mesh.triangles.len()).map(|index| twice_area(mesh.corners(index)) / 2.0).sum();
            // Every coordinate is a short binary fraction: there is no rounding.
            assert_eq!(area, 1.0);
            let mut triangles_at = vec![0; mesh.edges.len()];
            mesh.sides.iter().flatten().for_each(|&edge| triangles_at[edge] += 1);
            for (edge, count) in triangles_at.into_iter().enumerate() {
                assert_eq!(count, if mesh.conditions[edge].is_some() { 1 } else { 2 }, "edge {edge} of step {step}");
            }
            let mut lengths = [0.0; 4];
            for (triangle, local, _, condition) in mesh.outline() {
                lengths[condition] += outward(mesh.corners(triangle), local).1;
            }
            assert_eq!(lengths, [1.0; 4]);
            for (triangle, origin) in mesh.origins.iter().enumerate() {
                // The diagonal separates the two triangles of the square.
                let [x, y] = mesh.corners(triangle).iter().fold([0.0; 2], |sum, at| [sum[0] + at[0], sum[1] + at[1]]);
                assert_eq!(*origin, usize::from(y > x));
            }
        }
        assert!(mesh.triangles.len() > 40, "{}", mesh.triangles.len());
    }

    /// Halves of right-angled triangles with two equal sides are such triangles: the smallest angle stays at 45 degrees.
    #[test]
    fn bisection_keeps_the_angles() {
        let mut mesh = square();
        for _ in 0..8 {
            let marked: Vec<bool> = mesh.triangles.iter().map(|nodes| nodes.contains(&0)).collect();
            mesh = mesh.refined(&marked, |_, middle| middle);
        }
        for index in 0..mesh.triangles.len() {
            let corners = mesh.corners(index);
            let longest = (0..3).map(|local| outward(corners, local).1).fold(0.0, f64::max);
            assert!((twice_area(corners) / longest.powi(2) - 0.5).abs() < 1e-15, "{corners:?}");
        }
    }
}
