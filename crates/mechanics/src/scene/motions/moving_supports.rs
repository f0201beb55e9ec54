//! Reactions of supports in a motion: the forces at their nodes that the balance of a step requires.

use super::loads_in_time::NodalLoads;
use crate::error::Error;
use crate::fem::assembly::{mass_columns, stiffness_columns};
use crate::fem::geometry::along_axis;
use crate::motion::Balance;
use crate::scene::Model;
use signorini_qp::SparseMatrix;

/// Stiffness, mass and loads of the nodes with supported dofs, and the unknowns coupled to them: all data that a step
/// needs.
///
/// Prescribed displacements are constant: supported dofs have neither velocity nor acceleration.
#[derive(Clone, Debug)]
pub(crate) struct MovingSupports {
    /// The nodes, increasing; empty if the scene has no support.
    nodes: Vec<usize>,
    /// The unknowns that share an element or a spring with them, increasing: those whose motion
    /// [`reactions`](Self::reactions) needs.
    pub around: Vec<usize>,
    /// Force on the nodes per displacement of these dofs, transposed: `around.len() x (dim * nodes.len())`.
    stiffness: SparseMatrix,
    /// Force on the nodes per acceleration of these dofs, transposed.
    mass: SparseMatrix,
    /// c_m and c_k, as in the motion of the free dofs.
    damping: [f64; 2],
    /// Forces on the nodes from the prescribed displacements only, length `dim * nodes.len()`.
    holding: Vec<f64>,
    /// The loads on the nodes, length `dim * nodes.len()` each.
    loads: NodalLoads,
}

/// The effect of each unknown on a force: entries (unknown, force, coefficient).
type Effects = Vec<(usize, usize, f64)>;

impl MovingSupports {
    /// The data of `model` with a nodal mass (the lower triangle, `n_nodes x n_nodes`), the damping c_m and c_k, and
    /// the loads on all nodes.
    pub fn new(model: &Model, mass: &SparseMatrix, damping: [f64; 2], loads: &NodalLoads) -> Result<Self, Error> {
        let (body, dofs, parts) = (model.body(), model.dofs(), &model.parts);
        let dimension = body.dimension();
        // The displacement of a node along an axis, times a value, in the unknowns.
        let along = |node: usize, axis: usize, value: f64| {
            parts.unknowns.along(dofs, node, &along_axis(axis, value)[..dimension])
        };
        let is_held = |node: usize| (dimension * node..dimension * (node + 1)).any(|dof| dofs.number(dof).is_none());
        let count = if model.parts.supports > 0 { model.mesh().nodes().len() } else { 0 };
        let nodes: Vec<usize> = (0..count).filter(|&node| is_held(node)).collect();
        let mut holding = vec![0.0; dimension * nodes.len()];
        let (mut elastic, mut inertia): (Effects, Effects) = (Vec::new(), Vec::new());
        let of_body = stiffness_columns(body, &nodes)?;
        let of_springs =
            parts.springs.iter().flat_map(|one| one.columns(|node| nodes.binary_search(&node).ok(), dimension));
        for (row, force, value) in of_body.triplets().chain(of_springs) {
            let (free, prescribed) = along(row / dimension, row % dimension, value);
            holding[force] += prescribed;
            elastic.extend(free.into_iter().map(|(unknown, coefficient)| (unknown, force, coefficient)));
        }
        for (node, place, value) in mass_columns(body, &nodes, mass)?.triplets() {
            for axis in 0..dimension {
                let force = dimension * place + axis;
                let free = along(node, axis, value).0;
                inertia.extend(free.into_iter().map(|(unknown, coefficient)| (unknown, force, coefficient)));
            }
        }
        let mut around: Vec<usize> = elastic.iter().chain(&inertia).map(|entry| entry.0).collect();
        around.sort_unstable();
        around.dedup();
        let matrix = |mut effects: Effects| {
            effects.iter_mut().for_each(|entry| entry.0 = around.partition_point(|&dof| dof < entry.0));
            SparseMatrix::from_triplets(around.len(), holding.len(), &effects)
        };
        let (stiffness, mass) = (matrix(elastic)?, matrix(inertia)?);
        let loads = loads.at_nodes(&nodes, dimension);
        Ok(MovingSupports { nodes, around, stiffness, mass, damping, holding, loads })
    }

    /// The forces of supports on their nodes, by number of the node, in force; zero at other nodes:
    ///
    /// ```text
    /// R = M a + C v + K u - f - B' lambda,   C = c_m M + c_k K
    /// ```
    ///
    /// with u, v, a (one entry for each dof of `around`) and f of the balance that the scheme solved, and its contact
    /// forces, one multiplier per contact row. Along free dofs R is the residual of the solve.
    pub fn reactions(&self, model: &Model, balance: Balance, multiplier: &[f64]) -> impl Fn(usize) -> [f64; 3] {
        let dimension = model.body().dimension();
        let Balance { mut displacement, velocity, mut acceleration, loads } = balance;
        for (coefficient, vector) in self.damping.into_iter().zip([&mut acceleration, &mut displacement]) {
            vector.iter_mut().zip(&velocity).for_each(|(entry, v)| *entry += coefficient * v);
        }
        let mut forces = self.stiffness.mul_transposed(&displacement);
        let parts = self.mass.mul_transposed(&acceleration).into_iter().zip(&self.holding).zip(self.loads.mean(&loads));
        forces.iter_mut().zip(parts).for_each(|(force, ((inertia, held), load))| *force += inertia + held - load);
        for (row, lambda) in model.rows().iter().zip(multiplier) {
            for &(node, share) in &row.ends {
                let Ok(place) = self.nodes.binary_search(&node) else { continue };
                let of_node = &mut forces[dimension * place..dimension * (place + 1)];
                of_node.iter_mut().zip(row.normal).for_each(|(force, normal)| *force -= share * lambda * normal);
            }
        }
        move |node| {
            let place = self.nodes.binary_search(&node);
            let part =
                |axis: usize| place.ok().filter(|_| axis < dimension).map(|place| forces[dimension * place + axis]);
            [0, 1, 2].map(|axis| part(axis).unwrap_or(0.0))
        }
    }
}
