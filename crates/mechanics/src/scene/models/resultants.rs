//! Resultants: the force, moment and centre of each obstacle, pair of bodies, support, and of the loads.

use std::collections::BTreeMap;
use std::ops::Range;

use super::held::{Holder, may_be_part};
use super::model::{check_multiplier, place};
use super::points::{ForcesAt, ReferencePoint};
use super::rigid_face::Motion;
use crate::error::Error;
use crate::fem::assembly::Springs;
use crate::fem::formulation::Formulation;
use crate::fem::geometry::{COORDINATES, cross, dot, length, minus, plus, shifted};
use crate::scene::Model;
use crate::scene::input::obstacle::PlacedObstacle;
use crate::scene::input::schema::model::Rule;
use serde::Serialize;

/// Forces that cancel to this share of the sum of their magnitudes leave only rounding, which has no line of action.
const CANCELS: f64 = 1e-10;

/// The basis of the forces if a sliding support may be a plane of symmetry.
const MESHED_PART: &str = "of the meshed part: a plane of symmetry at a sliding support doubles it";

/// The resultant of all forces of one kind on the body: force, moment, and a point on the line of action.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Resultant {
    /// The source of the forces: `obstacles[0]`; `pair[0]` for the first obstacle that is another body; `supports[0]`;
    /// `loads`.
    pub of: String,
    /// The body on which the forces act, if there are several; the first one is called `body`. Of a reference point its
    /// name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
    /// The rule for the rows of the obstacle; `None` for a user-defined obstacle, and for supports and loads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rule: Option<Rule>,
    /// Number of nodes on which the forces act.
    pub nodes: usize,
    /// The force on the body, one component for each coordinate, in force, along the positive axes. In an axisymmetric
    /// model the radial component is summed around the circle and cancels.
    pub force: Vec<f64>,
    /// The moment about the origin, in force times length, counterclockwise positive, of the undeformed body: about z
    /// in the plane, three components in space, empty on a line and in an axisymmetric model.
    pub moment: Vec<f64>,
    /// A point on the line of action, one coordinate for each axis, in length: the force at this point gives the moment
    /// above, except its part along the force. For parallel forces it is their centre. `None` if the forces cancel.
    pub centre: Option<Vec<f64>>,
    /// Displacement of an obstacle that a force presses, against its approach direction, in length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub travel: Option<f64>,
    /// The motion of the rigid face or the reference point that the resultant acts on; `None` for other forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<FaceMotion>,
    /// The shortening of a bolt by its preload, in length: positive if its parts are drawn together, whatever its
    /// direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shortening: Option<f64>,
    /// The tension of a bolt, in force; negative if its parts press on each other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tension: Option<f64>,
}

/// Displacement and rotation of a rigid face or a reference point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaceMotion {
    /// Displacement of its centre, or of the point, in length, a component for each coordinate.
    pub displacement: Vec<f64>,
    /// Its rotation, in radians: about z in the plane, three components in space, otherwise empty.
    pub rotation: Vec<f64>,
}

/// The sum of forces at points.
#[derive(Clone, Debug, Default)]
pub struct Sum {
    /// Each force with its point.
    forces: Vec<([f64; 3], [f64; 3])>,
}

impl Sum {
    pub fn add(&mut self, at: [f64; 3], force: [f64; 3]) {
        if force != [0.0; 3] {
            self.forces.push((at, force));
        }
    }

    pub fn force(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.forces.iter().fold(0.0, |sum, (_, force)| sum + force[axis]))
    }

    fn moment(&self) -> [f64; 3] {
        let moments = || self.forces.iter().map(|&(at, force)| cross(at, force));
        [0, 1, 2].map(|axis| moments().fold(0.0, |sum, moment| sum + moment[axis]))
    }

    /// The centre of the forces along their resultant, moved perpendicular to it onto the line of action if the forces
    /// have moments; in an axisymmetric model they have no moments.
    pub fn centre(&self, formulation: &Formulation) -> Option<[f64; 3]> {
        let (force, moment) = (self.force(), self.moment());
        let magnitudes = self.forces.iter().fold(0.0, |sum, &(_, force)| sum + length(force));
        let square = dot(force, force);
        if square.sqrt() <= CANCELS * magnitudes {
            return None;
        }
        // Relative to the first point, so that a body far from the origin loses no digits.
        let &(first, _) = self.forces.first()?;
        let weighted = self.forces.iter().fold([0.0; 3], |sum, &(at, of)| {
            let (away, weight) = (minus(at, first), dot(of, force) / square);
            shifted(sum, weight, away)
        });
        let centre = plus(first, weighted);
        if formulation.is_axisymmetric() {
            return Some(centre);
        }
        let left = minus(moment, cross(centre, force));
        let across = cross(force, left);
        Some([0, 1, 2].map(|axis| centre[axis] + across[axis] / square))
    }

    fn resultant(&self, model: &Model, of: String) -> Resultant {
        let dimension = model.body().dimension();
        let formulation = model.body().formulation();
        let moment = self.moment();
        Resultant {
            of,
            on: None,
            rule: None,
            nodes: self.forces.len(),
            force: self.force()[..dimension].to_vec(),
            moment: match dimension {
                2 if !formulation.is_axisymmetric() => vec![moment[2]],
                3 => moment.to_vec(),
                _ => Vec::new(),
            },
            centre: self.centre(formulation).map(|centre| centre[..dimension].to_vec()),
            travel: None,
            motion: None,
            shortening: None,
            tension: None,
        }
    }
}

/// Removes the centre of each force that is rounding relative to the largest one: its position would be arbitrary.
pub(crate) fn without_rounding(all: &mut [Resultant]) {
    let size = |resultant: &Resultant| resultant.force.iter().fold(0.0, |size: f64, part| size.hypot(*part));
    let largest = all.iter().map(size).fold(0.0, f64::max);
    all.iter_mut()
        .filter(|resultant| size(resultant) <= CANCELS * largest)
        .for_each(|resultant| resultant.centre = None);
}

pub(crate) fn contact_resultants(model: &Model, multiplier: &[f64]) -> Result<Vec<Resultant>, Error> {
    check_multiplier(model, multiplier)?;
    let mut sums = vec![Sum::default(); model.obstacles().len()];
    for (row, &lambda) in model.rows().iter().zip(multiplier) {
        let force = row.normal.map(|component| 0.0 + lambda * component);
        // A plane of symmetry normal to its approach direction gives an obstacle a mirror image, whose force does
        // not count here.
        let approach = model.obstacles()[row.obstacle].approach();
        add_images(model, &mut sums[row.obstacle], place(model, row.node), force, |axis| approach[axis] == 0.0);
    }
    let names = model.obstacle_names();
    let resultant = |(index, sum): (usize, &Sum)| {
        let (obstacle, of) = (&model.obstacles()[index], names[index].clone());
        let first = obstacle.candidates().first().map(|&(node, _)| node);
        Resultant { on: name_of_body(model, first), rule: obstacle.rule(), ..sum.resultant(model, of) }
    };
    Ok(sums.iter().enumerate().map(resultant).collect())
}

/// The moment about the origin of the contact forces on the other body of an obstacle, as [`Resultant::moment`],
/// from the multipliers of all rows.
pub fn moment_on_other(model: &Model, obstacle: usize, multiplier: &[f64]) -> Vec<f64> {
    let mut sum = Sum::default();
    for (row, &lambda) in model.rows().iter().zip(multiplier).filter(|(row, _)| row.obstacle == obstacle) {
        let own = model.body().region_at(row.node);
        for &(node, share) in &row.ends {
            if model.body().region_at(node) != own {
                sum.add(place(model, node), row.normal.map(|component| 0.0 + share * lambda * component));
            }
        }
    }
    sum.resultant(model, String::new()).moment
}

/// The moment that the contact forces of an obstacle have on both bodies together, over the sum of these forces
/// and the size of the mesh, in the meshed part: 0 if the forces of each row lie on one line. Means over curved
/// surfaces are not exactly so. `None` for rows that are no means, and about an axis of revolution, where forces
/// have no moment.
pub fn moment_defect(model: &Model, obstacle: usize, multiplier: &[f64]) -> Option<f64> {
    model.obstacles()[obstacle].other_body()?.1.filter(|_| !model.body().formulation().is_axisymmetric())?;
    let (mut moment, mut force, nodes) = ([0.0; 3], 0.0, model.mesh().nodes());
    for (row, &lambda) in model.rows().iter().zip(multiplier).filter(|(row, _)| row.obstacle == obstacle) {
        force -= lambda;
        for &(node, share) in &row.ends {
            let lever = minus(model.parts.conditions.dofs.basis.place(nodes, node), nodes[row.node]);
            let of_end = cross(lever, row.normal.map(|part| share * lambda * part));
            moment = plus(moment, of_end);
        }
    }
    Some(if force > 0.0 { length(moment) / (force * model.mesh().size()) } else { 0.0 })
}

pub(crate) fn obstacle_names(model: &Model) -> Vec<String> {
    let mut pairs = 0..;
    let name = |(index, obstacle): (usize, &PlacedObstacle)| match obstacle.rigid() {
        Some(_) => format!("obstacles[{index}]"),
        None => format!("pair[{}]", pairs.next().unwrap_or_default()),
    };
    model.obstacles().iter().enumerate().map(name).collect()
}

/// The resultants of the support reactions, support by support, from the force on each held node; its part along
/// free dofs is left out.
pub(crate) fn support_resultants(model: &Model, reaction: impl Fn(usize) -> [f64; 3]) -> Vec<Resultant> {
    let nodes = model.mesh().nodes();
    let mut supports = vec![Sum::default(); model.parts.scene.supports.len()];
    let mut held: Vec<Option<usize>> = vec![None; supports.len()];
    for (node, shares) in model.parts.conditions.held.shares(reaction) {
        // A support may hold a node in several directions.
        let mut of_node = BTreeMap::<usize, [f64; 3]>::new();
        for (by, force) in shares {
            if let Holder::Support { index, .. } = by {
                let sum = of_node.entry(index).or_default();
                *sum = plus(*sum, force);
            }
        }
        for (index, force) in of_node {
            held[index] = held[index].or(Some(node));
            add_images(model, &mut supports[index], nodes[node], force, |_| true);
        }
    }
    let of_support = |((sum, held), name): ((&Sum, Option<usize>), String)| Resultant {
        on: name_of_body(model, held),
        ..sum.resultant(model, name)
    };
    supports.iter().zip(held).zip(model.support_names()).map(of_support).collect()
}

/// Adds a force on the modelled part with its mirror images in those planes of symmetry for whose axis `across` is
/// `true`.
fn add_images(model: &Model, sum: &mut Sum, at: [f64; 3], force: [f64; 3], across: impl Fn(usize) -> bool) {
    model.parts.conditions.symmetry.images(at, force, across).into_iter().for_each(|(at, force)| sum.add(at, force));
}

/// The sum of nodal forces on the whole body.
fn sum_of(model: &Model, forces: impl IntoIterator<Item = (usize, [f64; 3])>) -> Sum {
    let mut sum = Sum::default();
    for (node, force) in forces {
        add_images(model, &mut sum, model.mesh().nodes()[node], force, |_| true);
    }
    sum
}

/// Forces on all nodes (length `dim * n_nodes`), node by node.
fn by_node(model: &Model, forces: &[f64]) -> impl Iterator<Item = (usize, [f64; 3])> {
    (0..model.mesh().nodes().len()).map(|node| (node, at_node(model, forces, node)))
}

/// The resultants of the springs on the body, in the order of the scene, at a nodal displacement.
pub(crate) fn spring_resultants(model: &Model, displacement: &[f64]) -> Vec<Resultant> {
    let at_points = model.parts.conditions.points.forces_of_springs(|node| at_node(model, displacement, node));
    let of_springs = |((index, springs), name): ((usize, &Springs), String)| match at_points.get(&index) {
        Some(forces) => resultant_at(model, forces, name),
        None => sum_of(model, springs.forces(displacement, model.body().dimension())).resultant(model, name),
    };
    model.parts.conditions.springs.iter().enumerate().zip(model.spring_names()).map(of_springs).collect()
}

/// The resultant of forces and moments on nodes and reference points.
fn resultant_at(model: &Model, forces: &ForcesAt, of: String) -> Resultant {
    let (mut sum, mut nodes, size) = (Sum::default(), 0, model.mesh().size());
    for (&place, force) in forces {
        let at = model.parts.conditions.points.at(place).map_or_else(|| model.mesh().nodes()[place], |point| point.at);
        let before = sum.forces.len();
        add_images(model, &mut sum, at, [force[0], force[1], force[2]], |_| true);
        nodes += sum.forces.len() - before;
        // A moment is a pair of forces.
        for axis in (0..3).filter(|&axis| force[3 + axis] != 0.0) {
            let [arm, across] = [COORDINATES[(axis + 1) % 3], COORDINATES[(axis + 2) % 3]];
            let pair = across.map(|part| force[3 + axis] / size * part);
            let beside = shifted(at, size, arm);
            add_images(model, &mut sum, beside, pair, |_| true);
            add_images(model, &mut sum, at, pair.map(|part| 0.0 - part), |_| true);
        }
    }
    Resultant { nodes, ..sum.resultant(model, of) }
}

/// The forces on the nodes of those rigid faces for which `keeps` returns `true`, among all forces that hold the
/// body.
pub(crate) fn force_of_faces(model: &Model, forces: &[f64], keeps: impl Fn(usize) -> bool) -> Result<Vec<f64>, Error> {
    let faces = model.parts.conditions.rigid_faces.iter().enumerate().filter(|(index, _)| keeps(*index));
    let mut on_face = vec![false; model.mesh().nodes().len()];
    faces.flat_map(|(_, face)| &face.nodes).for_each(|&node| on_face[node] = true);
    let dimension = model.body().dimension();
    Ok(model.dofs().part(forces, |dof| on_face[dof / dimension])?)
}

/// The resultants of the rigid faces on the body, in the order of the scene, with their motions.
pub(crate) fn face_resultants(model: &Model, forces: &[f64], unknowns: &[f64]) -> Result<Vec<Resultant>, Error> {
    let mut all = Vec::with_capacity(model.parts.conditions.rigid_faces.len());
    for (index, face) in model.parts.conditions.rigid_faces.iter().enumerate() {
        let sum = sum_of(model, by_node(model, &force_of_faces(model, forces, |other| other == index)?));
        let mut free = unknowns[model.dofs().motions(index)].iter();
        let amount = |motion: &Motion| {
            let unknown = || free.next().map(|unknown| unknown * face.unit(motion));
            (motion.kind, motion.prescribed.or_else(unknown).unwrap_or(0.0))
        };
        let moved: Vec<(usize, f64)> = face.motions.iter().map(amount).collect();
        let of = |kinds: Range<usize>| {
            moved.iter().filter(|entry| kinds.contains(&entry.0)).map(|entry| entry.1).collect::<Vec<f64>>()
        };
        let motion = FaceMotion { displacement: of(0..3), rotation: of(3..6) };
        let on = name_of_body(model, face.nodes.first().copied());
        all.push(Resultant { on, motion: Some(motion), ..sum.resultant(model, format!("rigid-faces[{index}]")) });
    }
    Ok(all)
}

/// The resultants of the ties on their first sides, in the order of the scene, from the nodal displacement, the
/// multipliers of all equations, and the values of the unknowns.
pub(crate) fn tie_resultants(model: &Model, displacement: &[f64], of_ties: &[f64], unknowns: &[f64]) -> Vec<Resultant> {
    let (ties, points) = (&model.parts.ties, &model.parts.conditions.points);
    let at_points = points.forces_of_ties(|node| at_node(model, displacement, node), &ties.rows, of_ties);
    let of_tie = |(index, rows): (usize, &Range<usize>)| {
        let of = format!("ties[{index}]");
        if let Some(forces) = at_points.get(&index) {
            let first = forces.keys().next().copied();
            let point = first.and_then(|place| points.at(place)).map(|point| format!("`{}`", point.name));
            return Resultant { on: point.or_else(|| name_of_body(model, first)), ..resultant_at(model, forces, of) };
        }
        let first = ties.rows[rows.clone()].first().and_then(|row| Some(row.form.terms.first()?.0));
        let sum = sum_of(model, model.parts.forces_of_ties(of_ties, Some(index)));
        let on = name_of_body(model, first);
        let shortening = ties.shortenings.iter().find(|one| one.tie == index);
        let tension = shortening.map(|one| one.sense * dot(sum.force(), one.towards()));
        let shortening =
            shortening.map(|one| one.sense * model.dofs().through(&one.form, model.body().dimension()).value(unknowns));
        Resultant { on, shortening, tension, ..sum.resultant(model, of) }
    };
    ties.of_tie.iter().enumerate().map(of_tie).collect()
}

/// The value and the force along the direction of the scene of a bolt, of the modelled part: positive if it draws
/// the parts together along this direction.
pub(crate) fn of_bolt(model: &Model, tie: usize, of_ties: &[f64], unknowns: &[f64]) -> [f64; 2] {
    let ties = &model.parts.ties;
    let Some(one) = ties.shortenings.iter().find(|one| one.tie == tie) else { return [0.0; 2] };
    let (forces, towards) = (model.parts.forces_of_ties(of_ties, Some(tie)), one.towards());
    let force = forces.into_values().map(|force| dot(force, towards)).sum();
    [model.dofs().through(&one.form, model.body().dimension()).value(unknowns), force]
}

/// The forces from outside on the reference points, with their motions, in the order of the scene; of a point that
/// stands for a bolt the tension of its tie among `ties`, without a moment.
pub(crate) fn point_resultants(model: &Model, values: &[[[f64; 6]; 2]], ties: &[Resultant]) -> Vec<Resultant> {
    let (first, dimension, turns) = (model.mesh().nodes().len(), model.body().dimension(), model.body().turns());
    let of_point = |(index, (point, [moved, force])): (usize, (&ReferencePoint, &[[f64; 6]; 2]))| {
        let forces = ForcesAt::from([(first + index, *force)]);
        let rotation = turns.iter().map(|&axis| moved[3 + axis]).collect();
        let motion = Some(FaceMotion { displacement: moved[..dimension].to_vec(), rotation });
        let on = Some(format!("`{}`", point.name));
        let of = format!("points[{index}]");
        let mut found = Resultant { on, nodes: 1, motion, ..resultant_at(model, &forces, of) };
        if let Some(tension) = point.bolt.and_then(|tie| ties[tie].tension) {
            found.force[0] = tension.abs().copysign(force[0]);
            found.moment.fill(0.0);
            found.centre = None;
        }
        found
    };
    model.parts.conditions.points.all.iter().zip(values).enumerate().map(of_point).collect()
}

/// The resultant of the loads but those on reference points, if there are any.
pub(crate) fn load_resultant(model: &Model) -> Option<Resultant> {
    let mut on_points = vec![0.0; model.nodal_load().len()];
    model.parts.conditions.points.add_load(&mut on_points, model.body().dimension());
    let loads: Vec<f64> = model.nodal_load().iter().zip(on_points).map(|(load, on_point)| load - on_point).collect();
    let loads = sum_of(model, by_node(model, &loads));
    (!loads.forces.is_empty()).then(|| loads.resultant(model, "loads".into()))
}

/// The force or the displacement of a node among those of all nodes (length `dim * n_nodes`).
pub fn at_node(model: &Model, forces: &[f64], node: usize) -> [f64; 3] {
    let dimension = model.body().dimension();
    let of_node = &forces[dimension * node..dimension * (node + 1)];
    [0, 1, 2].map(|axis| of_node.get(axis).copied().unwrap_or(0.0))
}

/// The body of a node, if there are several.
fn name_of_body(model: &Model, node: Option<usize>) -> Option<String> {
    let regions = model.body().regions();
    let region = &regions[model.body().region_at(node?)?];
    (regions.len() > 1).then(|| if region.name().is_empty() { "body".into() } else { region.name().into() })
}

pub(crate) fn basis_of_forces(model: &Model) -> String {
    let unit = match model.units().length.as_str() {
        "m" => "metre",
        "mm" => "millimetre",
        "" => "unit of length",
        other => other,
    };
    let across = match *model.body().formulation() {
        Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness } => match thickness == 1.0 {
            true => Some(format!("per {unit}")),
            false => Some(format!("of a thickness of {thickness} {}", model.units().length).trim_end().to_string()),
        },
        Formulation::Axisymmetric => Some("per full circle".to_string()),
        Formulation::Bar { .. } | Formulation::Space => None,
    };
    // The supports were read when the model was built.
    let is_part = || may_be_part(&model.parts.conditions.held, model.body());
    let part = match model.parts_of_whole() {
        1.0 => is_part().then(|| MESHED_PART.to_string()),
        parts => Some(format!("of the whole body, {parts} times the meshed part")),
    };
    across.into_iter().chain(part).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLANE: Formulation = Formulation::PlaneStrain { thickness: 1.0 };

    /// Parallel forces 1 and 3 at the ends of a rod of length 4: the centre is at three quarters.
    #[test]
    fn the_centre_of_parallel_forces_is_their_weighted_mean() {
        let mut sum = Sum::default();
        sum.add([1.0, 2.0, 0.0], [0.0, -1.0, 0.0]);
        sum.add([5.0, 2.0, 0.0], [0.0, -3.0, 0.0]);
        assert_eq!(sum.force(), [0.0, -4.0, 0.0]);
        assert_eq!(sum.moment(), [0.0, 0.0, -16.0]);
        assert_eq!(sum.centre(&PLANE), Some([4.0, 2.0, 0.0]));
    }

    /// Forces that are not parallel: the moment of the resultant at its centre is that of the forces.
    #[test]
    fn the_resultant_at_its_centre_has_the_moment() {
        let mut sum = Sum::default();
        for (at, force) in [([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]), ([2.0, 0.0, 0.0], [0.0, 3.0, 0.0])] {
            sum.add(at, force);
        }
        let centre = sum.centre(&PLANE).unwrap();
        assert!(length(minus(cross(centre, sum.force()), sum.moment())) < 1e-14, "{centre:?}");
    }

    #[test]
    fn a_couple_has_no_centre() {
        let mut sum = Sum::default();
        sum.add([0.0, 0.0, 0.0], [0.0, 0.1, 0.0]);
        sum.add([1.0, 0.0, 0.0], [0.0, -0.1, 0.0]);
        assert_eq!((sum.force(), sum.centre(&PLANE)), ([0.0; 3], None));
    }
}
