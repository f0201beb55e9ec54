//! Errors of the solvers in the words of the scene: rigid-body modes by name, rows by node and obstacle.

use super::rigid_body_modes::RigidBodyModes;
use super::rigid_body_modes::soft::SoftMotion;
use super::rows::ContactRow;
use crate::error::Error;
use crate::scene::Model;
use crate::scene::input::entry::{COORDINATE_ROUNDING, number, point, six_digits};
use signorini_qp as qp;

/// More nodes than this are counted, not listed.
const LISTED_NODES: usize = 3;

impl Model {
    /// Rewrites an error of a solver into the words of this scene; other errors are returned unchanged.
    ///
    /// [`qp::Error::Unbounded`] and [`qp::Error::UnderHeld`] name the rigid-body mode; [`qp::Error::Infeasible`] names
    /// nodes, coordinates and obstacles.
    pub fn explain(&self, error: impl Into<Error>) -> Error {
        match error.into() {
            Error::Qp(qp::Error::Unbounded { mode, direction }) => {
                let mode = self.named(&direction).map_or(mode, |(name, _)| name);
                qp::Error::Unbounded { mode, direction }.into()
            }
            Error::Qp(qp::Error::UnderHeld { mode, direction }) => {
                let mode = self.named(&direction).map_or(mode, |(name, advice)| format!("{name}: {advice}"));
                qp::Error::UnderHeld { mode, direction }.into()
            }
            Error::Qp(qp::Error::Infeasible { reason, rows, weights, overlap }) => {
                let length = &self.units().length;
                let by =
                    if overlap > 0.0 { format!("; they overlap by {overlap:.3e} {length}") } else { String::new() };
                let reason = self.describe_rows(&rows).map_or(reason, |rows| format!("{rows}{}", by.trim_end()));
                qp::Error::Infeasible { reason, rows, weights, overlap }.into()
            }
            other => other,
        }
    }

    /// The rigid motions of an answer that contact without friction hardly resists, from its nodal displacement and its
    /// closed rows with their forces.
    ///
    /// # Errors
    /// None for the dofs of the body.
    pub(crate) fn soft_motions(
        &self,
        displacement: &[f64],
        closed: &[(&ContactRow, f64)],
    ) -> Result<Vec<SoftMotion>, Error> {
        RigidBodyModes::of_parts(&self.parts).soft_motions(&self.parts, closed, displacement)
    }

    /// A node with its coordinates, as `node 5 at (0.25, 1)`.
    pub(crate) fn node_in_words(&self, node: usize) -> String {
        format!("node {node}{} at {}", self.of_part(), self.place_in_words(node))
    }

    /// The words behind numbers of the meshed part; empty without planes of symmetry.
    pub fn of_part(&self) -> &'static str {
        if self.parts_of_whole() > 1.0 { " of the meshed part" } else { "" }
    }

    /// The coordinates of a node to six digits; those of rounding are 0.
    pub(crate) fn place_in_words(&self, node: usize) -> String {
        let rounding = COORDINATE_ROUNDING * self.mesh().size();
        let at = self.mesh().nodes()[node].map(|value| if value.abs() <= rounding { 0.0 } else { six_digits(value) });
        point(&at[..self.mesh().dimension()])
    }

    /// The name of a rigid-body motion, and the advice against it.
    fn named(&self, direction: &[f64]) -> Option<(String, String)> {
        let parts = &self.parts;
        let motion = parts.dofs.expand_motion(&parts.unknowns.motion(direction).ok()?).ok()?;
        let modes = RigidBodyModes::of(&parts.body);
        let amplitudes = modes.closest(parts.body.mesh().nodes(), &motion)?;
        Some((modes.name_of(&amplitudes), modes.advice(parts, self.rows(), &[amplitudes])))
    }

    fn describe_rows(&self, rows: &[usize]) -> Option<String> {
        let mut by_node: Vec<(usize, Vec<usize>)> = Vec::new();
        for &row in rows {
            let node = self.rows().get(row)?.node;
            match by_node.iter_mut().find(|entry| entry.0 == node) {
                Some(entry) => entry.1.push(row),
                None => by_node.push((node, vec![row])),
            }
        }
        let mut parts: Vec<String> =
            by_node.iter().take(LISTED_NODES).map(|(node, rows)| self.describe_node(*node, rows)).collect();
        if by_node.len() > LISTED_NODES {
            parts.push(format!("{} more nodes", by_node.len() - LISTED_NODES));
        }
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    fn describe_node(&self, node: usize, rows: &[usize]) -> String {
        let obstacle = |row: &usize| {
            let row = &self.rows()[*row];
            format!("obstacles[{}] (gap {})", row.obstacle, number(row.gap))
        };
        let dimension = self.mesh().dimension();
        let node_at = self.node_in_words(node);
        let names: Vec<String> = rows.iter().map(obstacle).collect();
        let supported = (0..dimension).all(|axis| self.parts.dofs.number(dimension * node + axis).is_none());
        match names.as_slice() {
            [one] if supported => format!("{node_at} is supported inside {one}"),
            [one] => format!("{node_at} cannot leave {one}"),
            _ => format!("{node_at} has no room between {}", names.join(" and ")),
        }
    }
}
