//! The change of the contact rows of an obstacle with the places of nodes.

use std::collections::HashMap;

use crate::fem::geometry::dot;
use crate::scene::derivatives::differences::derivative;
use crate::scene::input::entry::point;
use crate::scene::input::obstacle::{ObstacleRow, PlacedObstacle, shortest_edges};
use crate::scene::models::condition::ON_THE_AXIS;
use crate::scene::{Model, Rule};

/// The change of a row with places.
pub(in crate::scene::derivatives) struct Slope {
    /// Nodes, each with the change of the gap along x, y and z, dimensionless.
    pub gap: Vec<(usize, [f64; 3])>,
    /// `[k]`: the change of the normal with the place of its node along axis k, per length.
    pub normal: [[f64; 3]; 3],
}

impl Slope {
    /// The change of `vector . normal` with the place of the node along x, y and z.
    pub fn of_normal(&self, vector: [f64; 3]) -> [f64; 3] {
        self.normal.map(|by_axis| dot(by_axis, vector))
    }
}

/// The rows of an obstacle at their nodes.
pub(in crate::scene::derivatives) struct Slopes<'a> {
    model: &'a Model,
    number: usize,
    obstacle: &'a PlacedObstacle,
    candidate_of: HashMap<usize, usize>,
    /// The shortest edge of the facets at each node of the mesh; infinite where facets are points.
    edges: Vec<f64>,
}

impl<'a> Slopes<'a> {
    /// The rows of obstacle `number`.
    pub fn of(model: &'a Model, number: usize) -> Self {
        let (obstacle, nodes) = (&model.obstacles()[number], model.mesh().nodes());
        let candidates = obstacle.candidates().iter().enumerate();
        let boundary = model.mesh().boundary(obstacle.boundary());
        let edges = boundary.map_or_else(Vec::new, |boundary| shortest_edges(boundary, nodes));
        let candidate_of = candidates.map(|(candidate, &(node, _))| (node, candidate)).collect();
        Slopes { model, number, obstacle, candidate_of, edges }
    }

    /// Returns `true` if the direction of every row is fixed.
    pub fn has_fixed_normals(&self) -> bool {
        self.obstacle.rule() == Some(Rule::Approach)
    }

    /// Returns `true` if the obstacle is met from a node.
    pub fn has_row(&self, node: usize) -> bool {
        self.row(node, self.model.mesh().nodes()[node]).is_some()
    }

    /// The row of a node at another place.
    fn row(&self, node: usize, at: [f64; 3]) -> Option<ObstacleRow> {
        let candidate = *self.candidate_of.get(&node)?;
        self.obstacle.row(candidate, at, self.obstacle.shift(self.model.gap())).ok()?
    }

    /// The change of the row of a node.
    ///
    /// # Errors
    /// Why there is none.
    pub fn at(&self, node: usize) -> Result<Slope, String> {
        match self.candidate_of.get(&node).and_then(|&candidate| self.obstacle.facing(candidate)) {
            Some(facing) if facing.area.is_some() => Err(format!(
                "obstacles[{}]: the rows between meshes that do not match depend on the places of many nodes; their \
                 derivative is not available yet",
                self.number
            )),
            Some(_) if self.obstacle.rule() != Some(Rule::Approach) => Err(format!(
                "obstacles[{}]: the rows between two bodies lie along the normals of both, which depend on the places of \
                 many nodes; their derivative is available for the rule `approach`",
                self.number
            )),
            Some(facing) => {
                let is_fit = self.obstacle.between().is_some_and(|between| between.fit.is_some());
                let ends = facing.ends.iter().filter(|_| !is_fit);
                let gap = ends.map(|&(node, share)| (node, facing.normal.map(|part| 0.0 - share * part))).collect();
                Ok(Slope { gap, normal: [[0.0; 3]; 3] })
            }
            None => self.of_rigid(node),
        }
    }

    /// The change of the row against a rigid obstacle with the place of its node.
    ///
    /// Along the approach direction a gap changes by -1, and the gap along a normal by minus the normal; all else is a
    /// difference.
    fn of_rigid(&self, node: usize) -> Result<Slope, String> {
        let (nodes, rule) = (self.model.mesh().nodes(), self.obstacle.rule());
        let approach = self.obstacle.approach();
        let (mut gap, mut normal) = ([0.0; 3], [[0.0; 3]; 3]);
        let row = self.row(node, nodes[node]).ok_or_else(|| self.without_slope(node))?;
        for axis in 0..self.model.mesh().dimension() {
            if rule == Some(Rule::Approach) && approach[axis] != 0.0 {
                gap[axis] = 0.0 - approach[axis];
                continue;
            }
            let found = match self.difference(node, axis) {
                Some(found) => found,
                None if self.is_symmetric(node, axis) => [0.0; 4],
                None => return Err(self.without_slope(node)),
            };
            let [of_gap, of_normal @ ..] = found;
            (gap[axis], normal[axis]) = (of_gap, of_normal);
        }
        if rule == Some(Rule::ClosestPoint) {
            gap = row.normal.map(|part| 0.0 - part);
        }
        Ok(Slope { gap: vec![(node, gap)], normal })
    }

    /// Returns `true` if a node lies on a plane of symmetry normal to an axis, or on the axis of revolution.
    fn is_symmetric(&self, node: usize, axis: usize) -> bool {
        let (mesh, at) = (self.model.mesh(), self.model.mesh().nodes()[node]);
        let is_on_axis = self.model.body().formulation().is_axisymmetric() && at[0] <= ON_THE_AXIS * mesh.size();
        self.model.axes_of_symmetry(&at)[axis] || (axis == 0 && is_on_axis)
    }

    fn without_slope(&self, node: usize) -> String {
        let mesh = self.model.mesh();
        format!(
            "node {node} at {} meets a corner, an edge or an end of obstacles[{}], where its gap has no derivative with \
             respect to its place",
            point(&mesh.nodes()[node][..mesh.dimension()]),
            self.number
        )
    }

    /// The change of `[gap, normal x, y, z]` with the place of a node along an axis, by differences; `None` at a kink.
    fn difference(&self, node: usize, axis: usize) -> Option<[f64; 4]> {
        let (at, mesh) = (self.model.mesh().nodes()[node], self.model.mesh());
        let edge = self.edges.get(node).copied().filter(|edge| edge.is_finite());
        let moved = |by: f64| {
            let mut at = at;
            at[axis] += by;
            let ObstacleRow { normal: [x, y, z], gap } = self.row(node, at).ok_or(())?;
            Ok::<_, ()>(vec![gap, x, y, z])
        };
        let found = derivative(moved, edge.unwrap_or_else(|| mesh.size())).ok()??;
        Some([found[0], found[1], found[2], found[3]])
    }
}
