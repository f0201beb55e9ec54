//! Rigid motions of the plane: which of them nothing resists, and their names.

use nalgebra::DMatrix;

use super::model::Parts;
use super::point;
use super::rows::ContactRow;
use crate::error::Error;

/// A motion is held where the singular value that belongs to it exceeds this times the largest; exact geometry gives
/// zero to rounding, 1e-16, and any support or normal that a scene means is far above.
const HELD: f64 = 1e-10;

/// A part of a motion below this, relative to the whole, does not enter its name.
const NAMED: f64 = 1e-6;

/// Translation along x, translation along y, rotation about the centre, as multiples of unit motions: the rotation is
/// measured by the displacement that it gives at the distance `size` from the centre.
type Amplitudes = [f64; 3];

/// The centre and the size of a body: they make its three rigid motions comparable.
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidMotions {
    centre: [f64; 2],
    size: f64,
}

impl RigidMotions {
    pub fn of(parts: &Parts) -> Self {
        let (low, high) = parts.body.mesh().extent();
        let centre = [0, 1].map(|axis| low[axis] + (high[axis] - low[axis]) / 2.0);
        RigidMotions { centre, size: parts.body.mesh().size() / 2.0 }
    }

    /// The displacement [x, y] of each unit motion at a point.
    fn at(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 3] {
        let (x, y) = ((x - self.centre[0]) / self.size, (y - self.centre[1]) / self.size);
        [[1.0, 0.0], [0.0, 1.0], [-y, x]]
    }

    /// Refuses a body with a rigid motion that neither supports nor contact rows resist.
    ///
    /// # Errors
    /// [`Error::UnderHeld`] that names every such motion.
    pub fn check_held(&self, parts: &Parts, rows: &[ContactRow]) -> Result<(), Error> {
        let free = self.free(parts, rows);
        let Some(first) = free.first() else { return Ok(()) };
        let names: Vec<String> = free.iter().map(|motion| self.name(motion, false)).collect();
        let nodal = |dof: &usize| {
            let modes = self.at(parts.body.mesh().nodes()[dof / 2]);
            modes.iter().zip(first).map(|(mode, amplitude)| amplitude * mode[dof % 2]).sum()
        };
        let direction = parts.dofs.free().iter().map(nodal).collect();
        Err(Error::UnderHeld { motion: format!("{}: {}", names.join(", "), advice(!rows.is_empty())), direction })
    }

    /// A basis of the motions that nothing resists: translations along the axes first.
    fn free(&self, parts: &Parts, rows: &[ContactRow]) -> Vec<Amplitudes> {
        let nodes = parts.body.mesh().nodes();
        let supported = (0..2 * nodes.len()).filter(|&dof| parts.dofs.number(dof).is_none());
        let of_supports = supported.map(|dof| self.at(nodes[dof / 2]).map(|mode| mode[dof % 2]));
        let of_rows =
            rows.iter().map(|row| self.at(nodes[row.node]).map(|m| m[0] * row.normal[0] + m[1] * row.normal[1]));
        let mut resisted: Vec<Amplitudes> = of_supports.chain(of_rows).collect();
        // Three rows at least, or the decomposition leaves out what they do not span.
        resisted.resize(resisted.len().max(3), [0.0; 3]);
        let matrix = DMatrix::from_fn(resisted.len(), 3, |row, column| resisted[row][column]);
        let svd = matrix.svd(false, true);
        let Some(modes) = svd.v_t else { return Vec::new() };
        let largest = svd.singular_values.max();
        let mut null: Vec<Amplitudes> = (0..3)
            .filter(|&mode| svd.singular_values[mode] <= HELD * largest)
            .map(|mode| [0, 1, 2].map(|part| modes[(mode, part)]))
            .collect();
        // Rotate the basis towards the axes: a translation along x, along y, then what is left.
        let mut basis: Vec<Amplitudes> = Vec::new();
        for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
            let inside: f64 = null.iter().map(|mode| dot(mode, &axis).powi(2)).sum();
            if inside > 1.0 - NAMED {
                basis.push(axis);
            }
        }
        for mode in &mut null {
            for known in &basis {
                let part = dot(mode, known);
                [0, 1, 2].iter().for_each(|&i| mode[i] -= part * known[i]);
            }
            let length = dot(mode, mode).sqrt();
            if length > NAMED {
                basis.push(mode.map(|part| part / length));
            }
        }
        basis
    }

    /// The name of the rigid motion next to a nodal motion (length `2 * n_nodes`), if the motion is rigid.
    pub fn name_of(&self, nodes: &[[f64; 2]], motion: &[f64]) -> Option<String> {
        if !motion.iter().all(|value| value.is_finite()) {
            return None;
        }
        // Least squares on three modes.
        let design = DMatrix::from_fn(motion.len(), 3, |dof, mode| self.at(nodes[dof / 2])[mode][dof % 2]);
        let target = DMatrix::from_column_slice(motion.len(), 1, motion);
        let fitted = design.clone().svd(true, true).solve(&target, f64::EPSILON).ok()?;
        let rest = (design * &fitted - &target).norm();
        if !(rest <= NAMED * target.norm() && target.norm() > 0.0) {
            return None;
        }
        Some(self.name(&[fitted[(0, 0)], fitted[(1, 0)], fitted[(2, 0)]], true))
    }

    /// `signed` where the sense of the motion matters.
    fn name(&self, &[x, y, turn]: &Amplitudes, signed: bool) -> String {
        let whole = x.hypot(y).hypot(turn);
        let small = |part: f64| part.abs() <= NAMED * whole;
        if small(turn) {
            let sign = |part: f64| if signed && part < 0.0 { "-" } else { "" };
            return match (small(x), small(y)) {
                (_, true) => format!("translation along {}x", sign(x)),
                (true, _) => format!("translation along {}y", sign(y)),
                _ => format!("translation along ({:.3}, {:.3})", x / whole, y / whole),
            };
        }
        // Where translation and rotation cancel.
        let pole = [self.centre[0] - y / turn * self.size, self.centre[1] + x / turn * self.size];
        let tidy = pole.map(|at| if at.abs() <= NAMED * self.size { 0.0 } else { at });
        format!("rotation about z through {}", point(tidy.map(six_digits)))
    }
}

/// What to do about a free motion.
pub(super) fn advice(has_rows: bool) -> &'static str {
    if has_rows { "a frictionless obstacle does not hold it, add a guide" } else { "add a support" }
}

fn dot(a: &Amplitudes, b: &Amplitudes) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Rounded to six significant digits: a pole is a computed place.
fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
