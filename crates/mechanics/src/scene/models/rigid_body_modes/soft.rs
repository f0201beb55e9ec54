//! Rigid motions of bodies that contact without friction hardly resists.

use std::collections::BTreeMap;

use super::unit::{Sense, Sum};
use super::{RigidBodyModes, loads, resisted_firmly};
use crate::error::Error;
use crate::fem::dense::DenseMatrix;
use crate::fem::geometry::length;
use crate::scene::models::parts::Parts;
use crate::scene::models::rows::ContactRow;
use signorini_qp::{Forest, dot};

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
pub(crate) struct SoftMotion {
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
    ///
    /// # Errors
    /// None for the dofs of the body.
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
