//! The part of a bracket that is kept: the displacement and the stresses for a picture or a file.

use super::bound::Bracket;
use super::johnson_mercier::at;
use super::problem::Tensor;
use super::triangulation::{CENTRE, Point};
use crate::error::Error;
use crate::fem::{Boundary, ElementKind, Mesh};

/// The answer on a mesh of triangles of six nodes: the corners, then the middles of the edges.
#[derive(Clone, Debug)]
pub struct PlaneAnswer {
    /// The corners of the mesh, then the middles of its edges.
    pub nodes: Vec<Point>,
    /// The nodes of each triangle: three corners, then the middles of the sides between the first two, the next two and the last and
    /// the first.
    pub triangles: Vec<[usize; 6]>,
    /// The named parts of the outline, and the edges of each: two ends, then the middle.
    pub boundaries: Vec<(String, Vec<[usize; 3]>)>,
    /// The displacement of the nodes of the last mesh, `[u_x, u_y]` each, in length.
    pub displacement: Vec<Point>,
    /// The mean over each triangle of the stress of the displacement and of the stress in balance.
    pub stress: Vec<Tensor>,
    /// The contribution of each triangle to half the square of the bound, in force times length.
    pub shares: Vec<f64>,
}

impl PlaneAnswer {
    /// The mesh of the displacement: triangles of six nodes with straight sides.
    ///
    /// # Errors
    /// [`Error::Mesh`] for triangles that form no mesh.
    pub fn mesh(&self) -> Result<Mesh, Error> {
        let kind = ElementKind::QUADRATIC_TRIANGLE;
        // As a part of itself, a boundary has its edges in the order in which they follow each other.
        let boundary = |(name, edges): &(String, Vec<[usize; 3]>)| {
            Boundary::new(name, kind.facet(), edges.concat()).part(name, |_| true)
        };
        let nodes = self.nodes.iter().map(|&[x, y]| [x, y, 0.0]).collect();
        Mesh::new(nodes, kind, self.triangles.concat(), self.boundaries.iter().map(boundary).collect())
    }
}

impl Bracket<'_> {
    /// The displacement and the stresses for a picture or a file.
    pub fn answer(&self) -> PlaneAnswer {
        let mesh = self.mesh;
        let middle = |&[a, b]: &[usize; 2]| [0, 1].map(|axis| (mesh.nodes[a][axis] + mesh.nodes[b][axis]) / 2.0);
        let values = &self.primal.values;
        let of = |function: usize| [values[2 * function], values[2 * function + 1]];
        let corners = (0..mesh.nodes.len()).map(of);
        let middles = mesh.edges.iter().enumerate().map(|(edge, &[a, b])| {
            let [first, own, last] = [of(a), of(mesh.nodes.len() + edge), of(b)];
            [0, 1].map(|axis| (first[axis] + 2.0 * own[axis] + last[axis]) / 4.0)
        });
        let triangles =
            mesh.triangles.iter().zip(&mesh.sides).map(|(&[a, b, c], &[opposite_a, opposite_b, opposite_c])| {
                let middle = |edge: usize| mesh.nodes.len() + edge;
                [a, b, c, middle(opposite_c), middle(opposite_a), middle(opposite_b)]
            });
        let mut boundaries: Vec<_> = self.problem.boundaries.iter().map(|name| (name.clone(), Vec::new())).collect();
        for (triangle, local, edge, condition) in mesh.outline() {
            let [from, to] = [1, 2].map(|next| mesh.triangles[triangle][(local + next) % 3]);
            for &boundary in &self.problem.conditions[condition].boundaries {
                boundaries[boundary].1.push([from, to, mesh.nodes.len() + edge]);
            }
        }
        PlaneAnswer {
            boundaries,
            nodes: mesh.nodes.iter().copied().chain(mesh.edges.iter().map(middle)).collect(),
            displacement: corners.chain(middles).collect(),
            triangles: triangles.collect(),
            stress: (0..mesh.triangles.len()).map(|triangle| self.mean_stress(triangle)).collect(),
            shares: self.shares.clone(),
        }
    }

    /// The mean over a triangle of both stresses.
    fn mean_stress(&self, triangle: usize) -> Tensor {
        let mut mean = [0.0; 3];
        for k in 0..3 {
            let of_displacement = self.problem.stress(self.strain(&self.primal.values, triangle, k, CENTRE));
            let in_balance = at(&self.stress[triangle], k, CENTRE);
            (0..3).for_each(|entry| mean[entry] += (of_displacement[entry] + in_balance[entry]) / 6.0);
        }
        mean
    }
}
