//! Rigid motions of bodies that contact without friction hardly resists, or that a load drives and nothing stops; the
//! supports that would hold them.

use std::collections::{BTreeMap, HashSet};

use super::unit::{AXES, NAMED, Sense, Sum};
use super::{RigidBodyModes, component, loads, resisted_firmly};
use crate::error::Error;
use crate::fem::dense::DenseMatrix;
use crate::fem::geometry::{COORDINATES, length};
use crate::scene::input::entry::number;
use crate::scene::models::parts::{Origin, Parts};
use crate::scene::models::rows::ContactRow;
use signorini_qp as qp;
use signorini_qp::{ContactProblem, Forest, Settings, SparseMatrix, SymmetricMatrix, dot, largest};

/// A motion is held softly if the closed rows of each obstacle resist it less, on the mean, than a surface that leans
/// towards it by this sine.
const SOFT: f64 = 0.1;

/// A force drives a motion if its work on it is above this share of the contact forces on the bodies.
const DRIVEN: f64 = 1e-3;

/// Works of loads that cancel to this share of their magnitudes drive nothing: files have places with some digits.
const CANCELS: f64 = 1e-6;

/// A component of a motion below this share of the largest is left out of its name.
const NAMED_SOFT: f64 = 0.1;

/// The motions of more bodies that touch or tie each other are not looked at.
const MOST_BODIES: usize = 20;

/// A rigid motion of bodies that only contact without friction resists, and hardly, in an answer.
#[derive(Clone, Debug)]
pub struct SoftMotion {
    /// The motion and its bodies in words.
    pub name: String,
    /// The largest displacement of a node by it, in length.
    pub moved: f64,
    /// The support to add.
    pub advice: String,
    /// `true` if the loads work on it.
    pub is_driven: bool,
}

impl RigidBodyModes {
    /// The motions of an answer with this nodal displacement that closed rows, given with their forces, hold softly and
    /// no force drives; a moment may.
    pub fn soft_motions(
        &self,
        parts: &Parts,
        closed: &[(&ContactRow, f64)],
        displacement: &[f64],
    ) -> Result<Vec<SoftMotion>, Error> {
        let (nodes, bodies) = (parts.body.mesh().nodes(), self.bodies.len() - self.obstacles.len());
        let loads = loads(parts)?;
        let mut count = BTreeMap::<usize, f64>::new();
        closed.iter().for_each(|(row, _)| *count.entry(row.obstacle).or_default() += 1.0);
        let firm = resisted_firmly(parts).into_iter().map(|sum| Held { sum, weight: 1.0, force: 0.0 });
        let of_row = |(row, force): &(&ContactRow, f64)| {
            let of_end = |&(node, share): &(usize, f64)| (node, nodes[node], row.normal.map(|part| share * part));
            Held { sum: row.ends.iter().map(of_end).collect(), weight: 1.0 / count[&row.obstacle], force: force.abs() }
        };
        let held: Vec<Held> = firm.chain(closed.iter().map(of_row)).collect();
        let body_of = |node: usize| self.bodies[..bodies].partition_point(|body| body.nodes.end <= node);
        let mut forest = Forest::new(bodies);
        for Held { sum, .. } in &held {
            sum.windows(2).for_each(|pair| forest.join(body_of(pair[0].0), body_of(pair[1].0)));
        }
        let (group_of, groups) = forest.into_trees();
        let mut of_group: Vec<Vec<&Held>> = vec![Vec::new(); groups];
        for held in &held {
            held.sum.first().into_iter().for_each(|&(node, ..)| of_group[group_of[body_of(node)]].push(held));
        }
        let soft_motion = |(group, held): (usize, &Vec<&Held>)| {
            let force: f64 = held.iter().map(|held| held.force).sum();
            let members: Vec<usize> = (0..bodies).filter(|&body| group_of[body] == group).collect();
            if force == 0.0 || members.len() > MOST_BODIES {
                return None;
            }
            let motion = self.soft_motion(parts, &members, held, (displacement, &loads))?;
            let in_body = |body: usize| {
                let places = &nodes[self.bodies[body].nodes.clone()];
                let of_body = [0, 1, 2, 3, 4, 5].map(|mode| motion[6 * body + mode]);
                self.bodies[body].nodal(places, &of_body).map(length).fold(0.0, f64::max)
            };
            let works =
                loads.iter().filter(|(node, ..)| members.contains(&body_of(*node))).map(|&(node, at, force)| {
                    let body = body_of(node);
                    dot(&self.bodies[body].along(at, force), &motion[6 * body..6 * (body + 1)])
                });
            let (work, size) = works.fold((0.0, 0.0), |(sum, size): (f64, f64), part| (sum + part, size + part.abs()));
            let largest = motion.iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
            let named: Vec<f64> =
                motion.iter().map(|&part| if part.abs() < NAMED_SOFT * largest { 0.0 } else { part }).collect();
            let rows: Vec<ContactRow> = closed.iter().map(|(row, _)| (*row).clone()).collect();
            Some(SoftMotion {
                name: self.describe(&named, Sense::Either),
                moved: members.iter().map(|&body| in_body(body)).fold(0.0, f64::max),
                advice: self.advice(parts, &rows, &[named]),
                is_driven: work.abs() > CANCELS * size,
            })
        };
        Ok(of_group.iter().enumerate().filter_map(soft_motion).collect())
    }

    /// The part of a displacement in those rigid motions of some bodies, `members`, that are held softly and that no
    /// load drives, as amplitudes; `None` if there is no such motion.
    fn soft_motion(
        &self,
        parts: &Parts,
        members: &[usize],
        held: &[&Held],
        (displacement, loads): (&[f64], &Sum),
    ) -> Option<Vec<f64>> {
        let (nodes, dimension) = (parts.body.mesh().nodes(), self.dimension);
        let of_member = |&body: &usize| self.bodies[body].modes.iter().map(move |&mode| (body, mode));
        let modes: Vec<(usize, usize)> = members.iter().flat_map(of_member).collect();
        let mut gram = DenseMatrix::zeros(modes.len(), modes.len());
        for Held { sum, weight, .. } in held {
            let of_body = |&body: &usize| {
                let (body, all) = (&self.bodies[body], self.bodies[body].in_sum(sum));
                body.modes.iter().map(move |&mode| all[mode])
            };
            let in_sum: Vec<f64> = members.iter().flat_map(of_body).collect();
            let touched: Vec<usize> = (0..modes.len()).filter(|&mode| in_sum[mode] != 0.0).collect();
            for (row, column) in touched.iter().flat_map(|&row| touched.iter().map(move |&column| (row, column))) {
                gram[(row, column)] += weight * in_sum[row] * in_sum[column];
            }
        }
        let resistance = gram.singular_values();
        let is_soft = |value: f64| value * (members.len() as f64) < SOFT * SOFT;
        let soft: Vec<&[f64]> = resistance
            .right
            .columns()
            .zip(&resistance.values)
            .filter(|(_, value)| is_soft(**value))
            .map(|(motion, _)| motion)
            .collect();
        if soft.is_empty() {
            return None;
        }
        let force: f64 = held.iter().map(|held| held.force).sum();
        let (mut fitted, mut works) = (Vec::new(), Vec::new());
        for &body in members {
            let (body, own) = (&self.bodies[body], &self.bodies[body].nodes);
            let (moved, _) = body.fit(&nodes[own.clone()], &displacement[dimension * own.start..dimension * own.end]);
            fitted.extend(body.modes.iter().map(|&mode| moved[mode]));
            let loaded = body.in_sum(loads);
            works.extend(body.modes.iter().map(|&mode| if mode < 3 { loaded[mode] } else { 0.0 }));
        }
        // A force drives bodies that slide. That a body tilts under the force that presses it is no drive.
        let turning =
            |motion: &[f64]| modes.iter().zip(motion).filter(|one| one.0.1 > 2).map(|one| one.1 * one.1).sum::<f64>();
        let mut amounts: Vec<f64> = soft.iter().map(|motion| dot(motion, &fitted)).collect();
        let work = |motion: &&[f64]| if turning(motion) > 0.5 { 0.0 } else { dot(motion, &works) };
        let works: Vec<f64> = soft.iter().map(work).collect();
        let work = dot(&works, &works);
        if work > (DRIVEN * force).powi(2) {
            let share = dot(&amounts, &works) / work;
            amounts.iter_mut().zip(&works).for_each(|(amount, work)| *amount -= share * work);
        }
        let mut motion = vec![0.0; 6 * self.bodies.len()];
        for (amount, soft) in amounts.iter().zip(soft) {
            modes.iter().zip(soft).for_each(|(&(body, mode), part)| motion[6 * body + mode] += amount * part);
        }
        Some(motion)
    }
}

/// A sum of displacements that is held, with the share of its square in the resistance, and the force of a closed row.
struct Held {
    sum: Sum,
    weight: f64,
    force: f64,
}

/// A place where a motion is below this share of its largest component does not hold it.
const MOVES: f64 = 1e-3;

impl RigidBodyModes {
    /// The advice for bodies with these free motions.
    pub fn advice(&self, parts: &Parts, rows: &[ContactRow], free: &[Vec<f64>]) -> String {
        let advice = match (rows.is_empty(), parts.body.regions().len()) {
            (true, _) => "add a support",
            (false, 1) => "a frictionless obstacle does not hold it, add a guide",
            (false, _) => "contact without friction does not hold it, add a guide",
        };
        let supports = self.supports_against(parts, rows, free);
        let (advice, of) = match parts.origin() {
            Origin::Deck => (format!("{advice} by `*BOUNDARY`"), "deck has no `*BOUNDARY`"),
            _ if supports.is_empty() => (advice.to_string(), "scene has no supports"),
            _ => (format!("{advice}, such as {} in `supports`", supports.join(", ")), "scene has no supports"),
        };
        let is_free = parts.scene.supports.is_empty() && parts.conditions.springs.is_empty();
        let first = format!(". The {of}: first hold the side where the body is fixed");
        if is_free { advice + &first } else { advice }
    }

    /// Supports against free motions, as a scene writes them. A motion of several bodies is held at the first.
    fn supports_against(&self, parts: &Parts, rows: &[ContactRow], free: &[Vec<f64>]) -> Vec<String> {
        let touched: HashSet<usize> = rows.iter().flat_map(|row| row.ends.iter().map(|end| end.0)).collect();
        let mut of_bodies: BTreeMap<usize, Vec<&Vec<f64>>> = BTreeMap::new();
        for motion in free {
            let moves = |place: &usize| motion[6 * place..6 * (place + 1)].iter().any(|part| part.abs() > NAMED);
            if let Some(place) = (0..self.bodies.len()).find(moves) {
                of_bodies.entry(place).or_default().push(motion);
            }
        }
        let of_body = |(place, motions): (usize, Vec<&Vec<f64>>)| {
            let on_boundary = self.boundary_against(parts, &touched, (place, &motions));
            on_boundary.map_or_else(|| self.points_against(parts, &touched, (place, motions)), |support| vec![support])
        };
        of_bodies.into_iter().flat_map(of_body).collect()
    }

    /// A support on a boundary of a body that nothing can touch; `None` without such a boundary.
    fn boundary_against(
        &self,
        parts: &Parts,
        touched: &HashSet<usize>,
        (place, motions): (usize, &[&Vec<f64>]),
    ) -> Option<String> {
        let is_free = |axis: usize| {
            // A translation along the axis, or a rotation about one of the two others.
            let moving = [axis, 3 + (axis + 1) % 3, 3 + (axis + 2) % 3];
            motions.iter().any(|motion| moving.iter().any(|part| motion[6 * place + part].abs() > NAMED))
        };
        let own = &self.bodies[place].nodes;
        let is_touched = |name: &str| parts.obstacles.iter().any(|obstacle| obstacle.boundary() == name);
        // With a single body the obstacles alone decide: a boundary beside them shares the nodes of an edge.
        let alone = parts.body.regions().len() == 1;
        let fits = |nodes: Vec<usize>| {
            !nodes.is_empty() && nodes.iter().all(|node| own.contains(node) && (alone || !touched.contains(node)))
        };
        let mut boundaries = parts.body.mesh().boundaries().iter().filter(|boundary| fits(boundary.nodes()));
        let boundary = boundaries.find(|boundary| !is_touched(&boundary.name))?;
        let held: Vec<String> =
            (0..self.dimension).filter(|&axis| is_free(axis)).map(|axis| format!("\"{}\": 0", AXES[axis])).collect();
        let name = serde_json::Value::from(boundary.name.as_str());
        Some(format!("{{\"on\": {{\"boundary\": {name}}}, {}}}", held.join(", ")))
    }

    /// Supports at nodes of a body, as few as hold its motions; nodes that nothing can touch first.
    fn points_against(
        &self,
        parts: &Parts,
        touched: &HashSet<usize>,
        (place, motions): (usize, Vec<&Vec<f64>>),
    ) -> Vec<String> {
        let nodes = parts.body.mesh().nodes();
        let own = || self.bodies[place].nodes.clone();
        let untouched: Vec<usize> = own().filter(|node| !touched.contains(node)).collect();
        let candidates = if untouched.is_empty() { own().collect() } else { untouched };
        let mut left: Vec<Vec<f64>> = motions.into_iter().cloned().collect();
        let mut held: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        while let Some((node, axis, of_motions)) = self.strongest(nodes, &candidates, &left) {
            held.entry(node).or_default().push(axis);
            left = without(left, &of_motions);
        }
        let support = |(node, axes): (usize, Vec<usize>)| {
            let at: Vec<String> = nodes[node][..self.dimension].iter().map(|&value| number(value + 0.0)).collect();
            let held = |axis: usize| axes.contains(&axis).then(|| format!("\"{}\": 0", AXES[axis]));
            let held: Vec<String> = (0..self.dimension).filter_map(held).collect();
            format!("{{\"on\": {{\"point\": [{}]}}, {}}}", at.join(", "), held.join(", "))
        };
        held.into_iter().map(support).collect()
    }

    /// The node and the axis along which some motions have the largest components, and these; `None` if they have none.
    fn strongest(
        &self,
        nodes: &[[f64; 3]],
        candidates: &[usize],
        motions: &[Vec<f64>],
    ) -> Option<(usize, usize, Vec<f64>)> {
        let mut best = None;
        let mut largest = MOVES;
        for &node in candidates {
            for (axis, direction) in COORDINATES.into_iter().enumerate().take(self.dimension) {
                let unit = self.along(node, nodes[node], direction);
                let components: Vec<f64> = motions.iter().map(|motion| component(&unit, motion)).collect();
                let size = dot(&components, &components).sqrt();
                // Of nodes as good, the first: several directions are then held at one node.
                if size > (1.0 + MOVES) * largest {
                    (best, largest) = (Some((node, axis, components)), size);
                }
            }
        }
        best
    }
}

/// The motions that have no component where the given ones have these: one fewer.
fn without(mut motions: Vec<Vec<f64>>, components: &[f64]) -> Vec<Vec<f64>> {
    let largest = (0..components.len()).max_by(|&a, &b| components[a].abs().total_cmp(&components[b].abs()));
    let Some(pivot) = largest else { return motions };
    let removed = motions.remove(pivot);
    let others = components.iter().enumerate().filter(|(place, _)| *place != pivot).map(|(_, component)| component);
    for (motion, component) in motions.iter_mut().zip(others) {
        let share = component / components[pivot];
        motion.iter_mut().zip(&removed).for_each(|(value, part)| *value -= share * part);
    }
    motions
}

/// More motions that supports and ties leave free are left to the solver.
const MOST_MOTIONS: usize = 60;

/// Work and approach below this share of the sum of their terms are rounding.
const ROUNDING: f64 = 1e-9;

/// Rows stop a motion if they leave less than this share of the drive.
const STOPPED: f64 = 1e-6;

impl RigidBodyModes {
    /// Refuses a load that drives bodies along a motion that neither supports nor ties nor contact rows stop. The
    /// motion of bodies that ties join is none of one body alone, so that a solver hardly tells it from a soft one.
    ///
    /// Of all motions that supports and ties leave free, the one nearest to the drive of the load that closes no row is
    /// itself the answer to a contact problem, with K = I.
    pub fn check_bounded(&self, parts: &Parts, problem: &ContactProblem) -> Result<(), Error> {
        let mut free = self.free(parts, &[]);
        if free.len() > MOST_MOTIONS {
            free.clear();
        }
        let motions: Vec<Vec<f64>> = free.iter().map(|motion| self.in_unknowns(parts, motion)).collect();
        let work = |motion: &Vec<f64>| {
            let terms: f64 = problem.load().iter().zip(motion).map(|(force, part)| (force * part).abs()).sum();
            let work = dot(problem.load(), motion);
            if work.abs() > ROUNDING * terms { work } else { 0.0 }
        };
        let drive: Vec<f64> = motions.iter().map(work).collect();
        let strength = largest(&drive);
        if strength == 0.0 {
            return Ok(());
        }
        let drive = drive.into_iter().map(|work| work / strength).collect();
        let Some(amounts) = nearest_that_closes_nothing(problem, &motions, drive) else { return Ok(()) };
        let sum = |vectors: &[Vec<f64>]| -> Vec<f64> {
            let part = |place: usize| vectors.iter().zip(&amounts).map(|(vector, amount)| amount * vector[place]).sum();
            (0..vectors[0].len()).map(part).collect()
        };
        let (motion, direction) = (sum(&free), sum(&motions));
        let size = largest(&direction);
        let approach = problem.contact().mul(&direction).into_iter().zip(sizes(problem)).zip(problem.gap());
        let closes = |((speed, row), gap): ((f64, f64), &f64)| gap.is_finite() && speed > ROUNDING * row * size;
        if work(&direction) <= 0.0 || approach.take(problem.inequalities()).any(closes) {
            return Ok(());
        }
        let direction = direction.into_iter().map(|part| part / size).collect();
        Err(qp::Error::Unbounded { mode: self.name_of(&motion), direction }.into())
    }
}

/// The sum of the magnitudes of the entries of each row.
fn sizes(problem: &ContactProblem) -> Vec<f64> {
    problem.contact().mul_abs(&vec![1.0; problem.dofs()])
}

/// The amounts of some motions, together nearest to a drive, that close no row with a bound; `None` if the rows leave
/// none.
fn nearest_that_closes_nothing(problem: &ContactProblem, motions: &[Vec<f64>], drive: Vec<f64>) -> Option<Vec<f64>> {
    let (count, rows) = (motions.len(), problem.inequalities());
    let (mut entries, sizes) = (Vec::new(), sizes(problem));
    for (number, motion) in motions.iter().enumerate() {
        let (speeds, size) = (problem.contact().mul(motion), largest(motion));
        let counts = |&row: &usize| problem.gap()[row].is_finite() && speeds[row].abs() > ROUNDING * sizes[row] * size;
        entries.extend((0..rows).filter(counts).map(|row| (row, number, speeds[row])));
    }
    let ones: Vec<(usize, usize, f64)> = (0..count).map(|number| (number, number, 1.0)).collect();
    let identity = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(count, count, &ones).ok()?).ok()?;
    let contact = SparseMatrix::from_triplets(rows, count, &entries).ok()?;
    let nearest = ContactProblem::new(identity, drive, contact, vec![0.0; rows]).ok()?;
    let amounts = qp::solve(&nearest, &Settings::default()).ok()?.displacement;
    (largest(&amounts) > STOPPED).then_some(amounts)
}
