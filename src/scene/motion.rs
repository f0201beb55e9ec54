//! Rigid motions: which of them nothing resists, and their names.

use nalgebra::DMatrix;

use super::model::Parts;
use super::point;
use super::rows::ContactRow;
use crate::body::ElasticBody;
use crate::error::Error;

/// A motion is held where the singular value that belongs to it exceeds this times the largest; exact geometry gives
/// zero to rounding, 1e-16, and any support or normal that a scene means is far above.
const HELD: f64 = 1e-10;

/// A part of a motion below this, relative to the whole, does not enter its name.
const NAMED: f64 = 1e-6;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Translations along x, y, z, and rotations about axes through the centre along x, y, z, as multiples of unit motions:
/// a rotation is measured by the displacement that it gives at the distance `size` from the axis.
type Amplitudes = [f64; 6];

/// The unit motions of a body; its centre and size make them comparable.
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidMotions {
    centre: [f64; 3],
    size: f64,
    dimension: usize,
    /// Which of the six unit motions cost no energy: one in a bar and in a body of revolution, three in the plane.
    modes: &'static [usize],
}

impl RigidMotions {
    pub fn of(body: &ElasticBody) -> Self {
        let (low, high) = body.mesh().extent();
        let modes: &[usize] = match body.dimension() {
            1 => &[0],
            2 if body.formulation().is_axisymmetric() => &[1],
            2 => &[0, 1, 5],
            _ => &[0, 1, 2, 3, 4, 5],
        };
        RigidMotions {
            centre: [0, 1, 2].map(|axis| low[axis] + (high[axis] - low[axis]) / 2.0),
            size: body.mesh().size() / 2.0,
            dimension: body.dimension(),
            modes,
        }
    }

    /// The displacement of unit motion `mode` at a point.
    fn at(&self, mode: usize, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = [0, 1, 2].map(|axis| (point[axis] - self.centre[axis]) / self.size);
        match mode {
            0 => [1.0, 0.0, 0.0],
            1 => [0.0, 1.0, 0.0],
            2 => [0.0, 0.0, 1.0],
            3 => [0.0, -z, y],
            4 => [z, 0.0, -x],
            _ => [-y, x, 0.0],
        }
    }

    /// The component along `direction` of each unit motion at a point; motions that the body has not give 0.
    fn along(&self, point: [f64; 3], direction: [f64; 3]) -> Amplitudes {
        let mut components = [0.0; 6];
        for &mode in self.modes {
            components[mode] = dot(&self.at(mode, point), &direction);
        }
        components
    }

    /// The component of each unit motion along a coordinate of a node.
    fn at_coordinate(&self, nodes: &[[f64; 3]], index: usize) -> Amplitudes {
        let mut direction = [0.0; 3];
        direction[index % self.dimension] = 1.0;
        self.along(nodes[index / self.dimension], direction)
    }

    /// The component of each unit motion at a nodal dof: along an axis of the node's frame where it has one.
    fn at_dof(&self, parts: &Parts, dof: usize) -> Amplitudes {
        let (nodes, node) = (parts.body.mesh().nodes(), dof / self.dimension);
        match parts.dofs.frame(node) {
            Some(frame) => self.along(nodes[node], frame.axes()[dof % self.dimension]),
            None => self.at_coordinate(nodes, dof),
        }
    }

    /// Refuses a body with a rigid motion that neither supports nor contact rows resist.
    ///
    /// # Errors
    /// [`Error::UnderHeld`] that names every such motion.
    pub fn check_held(&self, parts: &Parts, rows: &[ContactRow]) -> Result<(), Error> {
        let free = self.free(parts, rows);
        let Some(first) = free.first() else { return Ok(()) };
        let names: Vec<String> = free.iter().map(|motion| self.name(motion, false)).collect();
        let direction = parts.dofs.free().iter().map(|&dof| dot(&self.at_dof(parts, dof), first)).collect();
        Err(Error::UnderHeld { motion: format!("{}: {}", names.join(", "), advice(!rows.is_empty())), direction })
    }

    /// A basis of the motions that nothing resists: unit motions first.
    fn free(&self, parts: &Parts, rows: &[ContactRow]) -> Vec<Amplitudes> {
        let nodes = parts.body.mesh().nodes();
        let supported = (0..parts.dofs.nodal_count()).filter(|&dof| parts.dofs.number(dof).is_none());
        let of_supports = supported.map(|dof| self.at_dof(parts, dof));
        let of_rows = rows.iter().map(|row| self.along(nodes[row.node], row.normal));
        let mut resisted: Vec<Amplitudes> = of_supports.chain(of_rows).collect();
        let count = self.modes.len();
        // A row for each motion at least, or the decomposition leaves out what they do not span.
        resisted.resize(resisted.len().max(count), [0.0; 6]);
        let matrix = DMatrix::from_fn(resisted.len(), count, |row, column| resisted[row][self.modes[column]]);
        let svd = matrix.svd(false, true);
        let Some(modes) = svd.v_t else { return Vec::new() };
        let largest = svd.singular_values.max();
        let mut null: Vec<Amplitudes> = Vec::new();
        for mode in (0..count).filter(|&mode| svd.singular_values[mode] <= HELD * largest) {
            let mut amplitudes = [0.0; 6];
            self.modes.iter().enumerate().for_each(|(column, &part)| amplitudes[part] = modes[(mode, column)]);
            null.push(amplitudes);
        }
        // Rotate the basis towards the unit motions, then take what is left.
        let mut basis: Vec<Amplitudes> = Vec::new();
        for &mode in self.modes {
            if null.iter().map(|motion| motion[mode].powi(2)).sum::<f64>() > 1.0 - NAMED {
                let mut unit = [0.0; 6];
                unit[mode] = 1.0;
                basis.push(unit);
            }
        }
        let units = basis.len();
        for mode in &mut null {
            for known in &basis {
                let part = dot(mode, known);
                mode.iter_mut().zip(known).for_each(|(value, known)| *value -= part * known);
            }
            let length = dot(mode, mode).sqrt();
            if length > NAMED {
                basis.push(mode.map(|part| part / length));
            }
        }
        let rest = basis.split_off(units);
        basis.extend(translations_first(&rest));
        basis
    }

    /// The name of the rigid motion next to a nodal motion (length `dim * n_nodes`), if the motion is rigid.
    pub fn name_of(&self, nodes: &[[f64; 3]], motion: &[f64]) -> Option<String> {
        if !motion.iter().all(|value| value.is_finite()) {
            return None;
        }
        // Least squares on the unit motions.
        let parts: Vec<Amplitudes> = (0..motion.len()).map(|index| self.at_coordinate(nodes, index)).collect();
        let design = DMatrix::from_fn(motion.len(), self.modes.len(), |dof, mode| parts[dof][self.modes[mode]]);
        let target = DMatrix::from_column_slice(motion.len(), 1, motion);
        let fitted = design.clone().svd(true, true).solve(&target, f64::EPSILON).ok()?;
        let rest = (design * &fitted - &target).norm();
        if !(rest <= NAMED * target.norm() && target.norm() > 0.0) {
            return None;
        }
        let mut amplitudes = [0.0; 6];
        self.modes.iter().enumerate().for_each(|(row, &mode)| amplitudes[mode] = fitted[(row, 0)]);
        Some(self.name(&amplitudes, true))
    }

    /// `signed` where the sense of the motion matters.
    fn name(&self, &[x, y, z, a, b, c]: &Amplitudes, signed: bool) -> String {
        let (shift, turn) = ([x, y, z], [a, b, c]);
        let (distance, angle) = (dot(&shift, &shift).sqrt(), dot(&turn, &turn).sqrt());
        let sign = |part: f64| if signed && part < 0.0 { "-" } else { "" };
        if angle <= NAMED * distance.hypot(angle) {
            return match along_one_axis(shift) {
                Some(axis) => format!("translation along {}{}", sign(shift[axis]), AXES[axis]),
                None => format!("translation along {}", direction(&shift[..self.dimension])),
            };
        }
        let axis = along_one_axis(turn).map_or_else(|| direction(&turn), |axis| AXES[axis].into());
        // Where translation and rotation cancel, but for what runs along the axis.
        let [u, v, w] = [
            (turn[1] * shift[2] - turn[2] * shift[1]) / (angle * angle),
            (turn[2] * shift[0] - turn[0] * shift[2]) / (angle * angle),
            (turn[0] * shift[1] - turn[1] * shift[0]) / (angle * angle),
        ];
        let pole = [u, v, w].map(|part| part * self.size);
        let tidy = [0, 1, 2].map(|axis| {
            let at = self.centre[axis] + pole[axis];
            if at.abs() <= NAMED * self.size { 0.0 } else { six_digits(at) }
        });
        let pitch = dot(&shift, &turn).abs() > NAMED * angle * distance.hypot(angle);
        let along = if pitch { ", with a translation along it" } else { "" };
        format!("rotation about {axis} through {}{along}", point(&tidy[..self.dimension]))
    }

    /// The largest virtual work of the nodal `forces` (each of length `dim * n_nodes`) on the unit motions, relative to
    /// the sum of the magnitudes of all forces; those along motions that the body has not are left out.
    pub fn imbalance(&self, nodes: &[[f64; 3]], forces: &[&[f64]]) -> f64 {
        let counts = |axis: usize| self.modes.contains(&axis);
        let (mut works, mut magnitude) = ([0.0; 6], 0.0);
        for (node, &at) in nodes.iter().enumerate() {
            for of_node in forces.iter().map(|forces| &forces[self.dimension * node..self.dimension * (node + 1)]) {
                let mut force = [0.0; 3];
                for (axis, component) in of_node.iter().enumerate().filter(|entry| counts(entry.0)) {
                    force[axis] = *component;
                }
                for (work, part) in works.iter_mut().zip(self.along(at, force)) {
                    *work += part;
                }
                magnitude += force[0].hypot(force[1]).hypot(force[2]);
            }
        }
        let largest = works.iter().fold(0.0_f64, |largest, work| largest.max(work.abs()));
        if magnitude == 0.0 { 0.0 } else { largest / magnitude }
    }
}

/// The same space of motions, its translations before what turns: orthonormal before and after.
fn translations_first(motions: &[Amplitudes]) -> Vec<Amplitudes> {
    let turning = DMatrix::from_fn(motions.len(), 6, |row, part| if part < 3 { 0.0 } else { motions[row][part] });
    let mix = if motions.len() > 1 { turning.svd(true, false).u } else { None };
    let Some(mix) = mix else { return motions.to_vec() };
    let mixed = |column: usize| {
        [0, 1, 2, 3, 4, 5].map(|part| (0..motions.len()).map(|row| mix[(row, column)] * motions[row][part]).sum())
    };
    // Singular values decrease: what turns least stands last.
    (0..motions.len()).rev().map(mixed).collect()
}

/// What to do about a free motion.
pub(super) fn advice(has_rows: bool) -> &'static str {
    if has_rows { "a frictionless obstacle does not hold it, add a guide" } else { "add a support" }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The axis along which a vector lies, but for rounding.
fn along_one_axis(vector: [f64; 3]) -> Option<usize> {
    let length = dot(&vector, &vector).sqrt();
    (0..3).find(|&axis| (0..3).all(|other| other == axis || vector[other].abs() <= NAMED * length))
}

/// A direction in words, of length 1.
fn direction(vector: &[f64]) -> String {
    let length = dot(vector, vector).sqrt();
    // Adding zero takes the sign off a part that is rounded to nothing.
    let three_digits = |part: &f64| (part / length * 1e3).round() / 1e3 + 0.0;
    let components: Vec<String> = vector.iter().map(|part| format!("{:.3}", three_digits(part))).collect();
    format!("({})", components.join(", "))
}

/// Rounded to six significant digits: a pole is a computed place.
fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
