//! Rigid-body modes: those that nothing resists, and their names.

pub mod soft;
mod unit;

use super::facing::TieRow;
use super::parts::Parts;
use super::rigid_face::{Motion, RigidFace};
use super::rows::ContactRow;
use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::fem::dense::DenseMatrix;
use crate::fem::geometry::COORDINATES;
use signorini_qp as qp;
use signorini_qp::{Forest, dot};
use unit::{NAMED, Sense, Sum, UnitMotions};

/// A motion is held if its singular value exceeds this times the largest. A free motion has zero up to rounding, 1e-16,
/// and any intended support or normal gives a value far above.
const HELD: f64 = 1e-10;

/// Components of unit motions other than zero, each with its place among all amplitudes, which increases.
type Components = Vec<(usize, f64)>;

/// The component of a motion, given by its amplitudes.
fn component(of_units: &Components, motion: &[f64]) -> f64 {
    of_units.iter().map(|&(place, part)| part * motion[place]).sum()
}

/// The rigid-body modes of the bodies of a model; each body moves independently.
///
/// Amplitudes are multiples of the unit motions, six for each body in turn.
#[derive(Clone, Debug)]
pub struct RigidBodyModes {
    /// The elastic bodies, followed by the pressed obstacles.
    bodies: Vec<UnitMotions>,
    dimension: usize,
    /// The obstacles that follow the bodies.
    obstacles: Vec<usize>,
}

impl RigidBodyModes {
    pub fn of(body: &ElasticBody) -> Self {
        let bodies = body.regions().iter().map(|region| UnitMotions::of(body, region)).collect();
        RigidBodyModes { bodies, dimension: body.dimension(), obstacles: Vec::new() }
    }

    /// The same with the pressed obstacles: each moves along its approach direction.
    pub fn of_parts(parts: &Parts) -> Self {
        let mut modes = Self::of(&parts.body);
        let size = parts.body.mesh().size();
        modes.obstacles = parts.pressed.clone();
        let of_obstacle = |&index: &usize| UnitMotions::of_obstacle(index, parts.obstacles[index].approach(), size);
        modes.bodies.extend(parts.pressed.iter().map(of_obstacle));
        modes
    }

    /// The indices of those amplitudes whose motions have no strain energy.
    fn modes(&self) -> Vec<usize> {
        let of_body = |(body, motions): (usize, &UnitMotions)| motions.modes.iter().map(move |mode| 6 * body + mode);
        self.bodies.iter().enumerate().flat_map(|entry| of_body(entry).collect::<Vec<_>>()).collect()
    }

    /// The components of unit motions along `direction` at a place that moves with a node.
    fn along(&self, node: usize, at: [f64; 3], direction: [f64; 3]) -> Components {
        self.in_sum(&vec![(node, at, direction)])
    }

    /// The components of unit motions along a contact row, positive towards closing.
    fn in_row(&self, nodes: &[[f64; 3]], row: &ContactRow) -> Components {
        let of_end = |&(node, share): &(usize, f64)| (node, nodes[node], row.normal.map(|part| share * part));
        let mut components = self.in_sum(&row.ends.iter().map(of_end).collect());
        if let Some(place) = self.obstacles.iter().position(|&obstacle| obstacle == row.obstacle) {
            let body = self.bodies.len() - self.obstacles.len() + place;
            let of_obstacle = self.bodies[body].along([0.0; 3], row.normal).into_iter().enumerate();
            components.extend(of_obstacle.filter(|of| of.1 != 0.0).map(|(mode, part)| (6 * body + mode, -part)));
        }
        components
    }

    /// The components of unit motions in a sum.
    fn in_sum(&self, sum: &Sum) -> Components {
        let elastic = &self.bodies[..self.bodies.len() - self.obstacles.len()];
        let body_of = |node: usize| elastic.partition_point(|body| body.nodes.end <= node);
        let mut bodies: Vec<usize> = sum.iter().map(|term| body_of(term.0)).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let of_body =
            |body: usize| self.bodies[body].in_sum(sum).into_iter().enumerate().map(move |(m, c)| (6 * body + m, c));
        bodies.into_iter().flat_map(of_body).filter(|component| component.1 != 0.0).collect()
    }

    /// The travel of each pressed obstacle in a motion, against its approach direction.
    fn travels(&self, parts: &Parts, amplitudes: &[f64]) -> Vec<f64> {
        let first = self.bodies.len() - self.obstacles.len();
        let travel = |(place, &obstacle): (usize, &usize)| {
            let along = self.bodies[first + place].along([0.0; 3], parts.obstacles[obstacle].approach());
            -dot(&along, &amplitudes[6 * (first + place)..6 * (first + place + 1)])
        };
        self.obstacles.iter().enumerate().map(travel).collect()
    }

    /// Refuses bodies with a rigid-body mode that neither supports nor contact rows resist.
    pub fn check_held(&self, parts: &Parts, rows: &[ContactRow]) -> Result<(), Error> {
        let free = self.free(parts, rows);
        let Some(first) = free.first() else { return Ok(()) };
        let (names, direction) = (self.names(&free), self.in_unknowns(parts, first));
        let advice = self.advice(parts, rows, &free);
        Err(qp::Error::UnderHeld { mode: format!("{}: {advice}", names.join(", ")), direction }.into())
    }

    /// A motion in the unknowns of the model.
    fn in_unknowns(&self, parts: &Parts, motion: &[f64]) -> Vec<f64> {
        let place = |node: usize| parts.conditions.dofs.basis.place(parts.body.mesh().nodes(), node);
        let along = |node: usize, axis: [f64; 3]| component(&self.along(node, place(node), axis), motion);
        let at = |node: usize| COORDINATES.map(|axis| along(node, axis));
        let travels = self.travels(parts, motion);
        let travel = |obstacle: usize| {
            self.obstacles.iter().position(|&other| other == obstacle).map_or(0.0, |place| travels[place])
        };
        parts.nearest(at, travel)
    }

    pub fn names(&self, motions: &[Vec<f64>]) -> Vec<String> {
        motions.iter().map(|motion| self.describe(motion, Sense::Either)).collect()
    }

    /// A basis of the motions that nothing resists: unit motions first. Bodies that nothing joins are looked at one by
    /// one.
    pub fn free(&self, parts: &Parts, rows: &[ContactRow]) -> Vec<Vec<f64>> {
        let nodes = parts.body.mesh().nodes();
        let firm = resisted_firmly(parts);
        let of_rows = rows.iter().map(|row| self.in_row(nodes, row));
        let resisted: Vec<Components> = firm.iter().map(|sum| self.in_sum(sum)).chain(of_rows).collect();
        let mut forest = Forest::new(self.bodies.len());
        for row in &resisted {
            row.windows(2).for_each(|pair| forest.join(pair[0].0 / 6, pair[1].0 / 6));
        }
        let (group_of, groups) = forest.into_trees();
        let (mut rows_of, mut modes_of) = (vec![Vec::new(); groups], vec![Vec::new(); groups]);
        resisted.iter().for_each(|row| row.iter().take(1).for_each(|(mode, _)| rows_of[group_of[mode / 6]].push(row)));
        self.modes().into_iter().for_each(|mode| modes_of[group_of[mode / 6]].push(mode));
        let (mut units, mut others) = (Vec::new(), Vec::new());
        for (rows, modes) in rows_of.iter().zip(&modes_of) {
            let of_group = self.free_of(rows, modes);
            units.extend(of_group.0);
            others.extend(of_group.1);
        }
        units.extend(others);
        units
    }

    /// A basis of the motions in some modes that none of the rows resists: the unit motions, and the others.
    fn free_of(&self, rows: &[&Components], modes: &[usize]) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let mut matrix = DenseMatrix::zeros(rows.len(), modes.len());
        for (row, entries) in rows.iter().enumerate() {
            for &(mode, value) in *entries {
                matrix[(row, modes.partition_point(|&other| other < mode))] = value;
            }
        }
        let svd = matrix.triangle().singular_values();
        let largest = svd.values.first().copied().unwrap_or(0.0);
        let mut null: Vec<Vec<f64>> = Vec::new();
        for (of_modes, _) in svd.right.columns().zip(&svd.values).filter(|(_, value)| **value <= HELD * largest) {
            let mut motion = vec![0.0; 6 * self.bodies.len()];
            modes.iter().zip(of_modes).for_each(|(&mode, &amount)| motion[mode] = amount);
            null.push(motion);
        }
        // Rotate the basis towards the unit motions, then add the rest.
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for &mode in modes {
            if null.iter().map(|motion| motion[mode].powi(2)).sum::<f64>() > 1.0 - NAMED {
                let mut unit = vec![0.0; 6 * self.bodies.len()];
                unit[mode] = 1.0;
                basis.push(unit);
            }
        }
        let units = basis.len();
        for motion in &mut null {
            for known in &basis {
                let part = dot(motion, known);
                motion.iter_mut().zip(known).for_each(|(value, known)| *value -= part * known);
            }
            let length = dot(motion, motion).sqrt();
            if length > NAMED {
                basis.push(motion.iter().map(|part| part / length).collect());
            }
        }
        let rest = basis.split_off(units);
        (basis, translations_first(&rest))
    }

    /// The rigid-body mode closest to a nodal motion (length `dim * n_nodes`), if every body moves rigidly.
    pub fn closest(&self, nodes: &[[f64; 3]], motion: &[f64]) -> Option<Vec<f64>> {
        if !motion.iter().all(|value| value.is_finite()) {
            return None;
        }
        let (mut amplitudes, mut rest) = (Vec::new(), 0.0_f64);
        for body in &self.bodies {
            let target = &motion[self.dimension * body.nodes.start..self.dimension * body.nodes.end];
            let (fitted, away) = body.fit(&nodes[body.nodes.clone()], target);
            amplitudes.extend(fitted);
            rest = rest.hypot(away);
        }
        let whole = dot(motion, motion).sqrt();
        (rest <= NAMED * whole && whole > 0.0).then_some(amplitudes)
    }

    /// The name of a motion with its sense.
    pub fn name_of(&self, amplitudes: &[f64]) -> String {
        self.describe(amplitudes, Sense::Signed)
    }

    /// The name of a motion, body by body if there are several.
    fn describe(&self, amplitudes: &[f64], sense: Sense) -> String {
        let whole = dot(amplitudes, amplitudes).sqrt();
        let mut names = Vec::new();
        for (body, part) in self.bodies.iter().zip(amplitudes.as_chunks::<6>().0) {
            if dot(part, part).sqrt() <= NAMED * whole {
                continue;
            }
            let motion = body.describe(part, sense);
            names.push(match body.name.as_str() {
                _ if self.bodies.len() == 1 => motion,
                "" => format!("{motion} of the first body"),
                name => format!("{motion} of `{name}`"),
            });
        }
        names.join(" with ")
    }

    /// The largest virtual work of the nodal `forces` (each of length `dim * n_nodes`) on the unit motions of the
    /// bodies, relative to the sum of the magnitudes of all forces; works on motions that a body does not have are left
    /// out.
    pub fn imbalance(&self, nodes: &[[f64; 3]], forces: &[&[f64]]) -> f64 {
        let (mut largest, mut magnitude) = (0.0_f64, 0.0);
        for body in &self.bodies {
            let mut works = [0.0; 6];
            for node in body.nodes.clone() {
                for of_node in forces.iter().map(|forces| &forces[self.dimension * node..self.dimension * (node + 1)]) {
                    let mut force = [0.0; 3];
                    for (axis, component) in of_node.iter().enumerate().filter(|entry| body.modes.contains(&entry.0)) {
                        force[axis] = *component;
                    }
                    if force == [0.0; 3] {
                        continue;
                    }
                    for (work, part) in works.iter_mut().zip(body.along(nodes[node], force)) {
                        *work += part;
                    }
                    magnitude += force[0].hypot(force[1]).hypot(force[2]);
                }
            }
            largest = works.iter().fold(largest, |largest, work| largest.max(work.abs()));
        }
        if magnitude == 0.0 { 0.0 } else { largest / magnitude }
    }
}

/// Everything that resists rigid motions but contact rows: supports, springs, rigid faces and ties, which join
/// surfaces at one place whatever their distance.
fn resisted_firmly(parts: &Parts) -> Vec<Sum> {
    let (nodes, dimension) = (parts.body.mesh().nodes(), parts.body.dimension());
    let supported = (0..parts.conditions.dofs.nodal_count()).filter(|&dof| parts.conditions.dofs.is_supported(dof));
    let of_support = |dof: usize| {
        let (node, axis) = (dof / dimension, dof % dimension);
        vec![(node, nodes[node], parts.conditions.dofs.axes(node)[axis])]
    };
    let springs = parts.conditions.springs.iter().flat_map(|springs| springs.resisted());
    let of_spring = |terms: Vec<(usize, [f64; 3])>| terms.into_iter().map(|(node, vector)| (node, nodes[node], vector));
    // Relative to its largest coefficient, whatever its scale is.
    let of_tie = |row: &TieRow| {
        let place = |node: usize| row.at.unwrap_or_else(|| parts.conditions.dofs.basis.place(nodes, node));
        let coefficients = row.form.terms.iter().flat_map(|term| term.1);
        let largest = coefficients.fold(0.0, |largest: f64, part| largest.max(part.abs()));
        let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
        row.form.terms.iter().map(|&(node, vector)| (node, place(node), vector.map(|part| scale * part))).collect()
    };
    let firm = supported.map(of_support).chain(springs.map(|terms| of_spring(terms).collect()));
    firm.chain(parts.conditions.rigid_faces.iter().flat_map(prescribed))
        .chain(parts.ties.rows.iter().map(of_tie))
        .collect()
}

/// The motions that a rigid face prescribes.
fn prescribed(face: &RigidFace) -> Vec<Sum> {
    face.motions.iter().filter(|motion| motion.prescribed.is_some()).map(|motion| of_motion(face, motion)).collect()
}

/// The amount of a motion of a rigid face, in its unit; nothing of a face without nodes.
fn of_motion(face: &RigidFace, motion: &Motion) -> Sum {
    let Some(&node) = face.nodes.first() else { return Vec::new() };
    let (one, two) = ((motion.kind + 1) % 3, (motion.kind + 2) % 3);
    if motion.kind < 3 {
        return vec![(node, face.centre, COORDINATES[motion.kind])];
    }
    // A rotation is the difference along the second next axis between the motions of the centre and of a place one step
    // along the next axis.
    let mut beside = face.centre;
    beside[one] += 1.0 / face.unit(motion);
    vec![(node, beside, COORDINATES[two]), (node, face.centre, COORDINATES[two].map(|part| -part))]
}

/// The loads on the bodies, each as its work in a motion: forces on nodes, forces and moments on rigid faces.
fn loads(parts: &Parts) -> Result<Sum, Error> {
    let (nodes, dimension) = (parts.body.mesh().nodes(), parts.body.dimension());
    let of_dof = |(dof, force): (usize, f64)| {
        let node = dof / dimension;
        (node, nodes[node], COORDINATES[dof % dimension].map(|part| force * part))
    };
    let mut loads: Sum =
        parts.acting_load()?.into_iter().enumerate().filter(|(_, force)| *force != 0.0).map(of_dof).collect();
    for face in &parts.conditions.rigid_faces {
        for motion in &face.motions {
            let work = |(node, at, vector): (usize, [f64; 3], [f64; 3])| {
                (node, at, vector.map(|part| motion.force * face.unit(motion) * part))
            };
            loads.extend(of_motion(face, motion).into_iter().map(work));
        }
    }
    Ok(loads)
}

/// A basis of the same space of motions with translations before rotations: orthonormal before and after.
fn translations_first(motions: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let amplitudes = motions.first().map_or(0, Vec::len);
    let turning = |part: usize, motion: usize| if part % 6 < 3 { 0.0 } else { motions[motion][part] };
    let mix = DenseMatrix::from_fn(amplitudes, motions.len(), turning).singular_values().right;
    let all = DenseMatrix::from_fn(amplitudes, motions.len(), |part, motion| motions[motion][part]);
    // Singular values decrease: the motion with the least rotation comes last.
    (0..motions.len()).rev().map(|column| all.mul(mix.column(column))).collect()
}
