//! One V-cycle through a hierarchy, and the degree of a smoother on patches, from the measured convergence of cycles.
//!
//! The stiffer the volume is, the slower are the motions without change of volume that no aggregate can make. The
//! slowest parts of an error are left after a few cycles: what the next one takes of their energy says how much more
//! smoothing a cycle needs.

use std::sync::Arc;

use super::face::FaceLevels;
use super::hierarchy::Hierarchy;
use super::operator::Operator;
use crate::Spare;
use crate::power_iteration::power_iteration;
use crate::real::Real;

/// Cycles of a quick measurement, and of the one that gives the degree.
const CYCLES: (usize, usize) = (5, 10);

/// A cycle is good enough if the last one of a quick measurement takes this share of the energy: 0.75 at nu = 0.3,
/// below 0.2 at nu = 0.499.
const GOOD_SHARE: f64 = 0.4;

/// The degree for the share s of the energy that the last cycle takes, at degree 3, is this number over s^(3/2).
/// Measured: s is about 0.09 at nu = 0.499, where half the degree takes half as many cycles more in about the same
/// time, and 0.03 at nu = 0.4999.
const DEGREE: f64 = 0.35;

/// The largest degree: beyond it a cycle costs more than it saves.
const MOST: usize = 32;

impl<T: Real> Hierarchy<T> {
    /// Approximately `A^-1` of a force, by one V-cycle, in the given face; a vector of `work`.
    pub fn cycle(&self, force: &[f64], face: Option<&FaceLevels<T>>, work: &Spare<f64>) -> Vec<f64> {
        let mut rest = self.spare.zeros(self.nodes.size * self.nodes.count);
        let exponent = self.nodes.gather(force, &mut rest);
        if let Some(face) = face {
            face.held.project_force(&mut rest);
        }
        let moved = self.descend(0, rest, face);
        let mut displacement = work.take(force.len());
        self.nodes.scatter(&moved, self.shift - exponent, &mut displacement);
        self.spare.give(moved);
        displacement
    }

    /// The unknowns of a level under the forces `rest`.
    pub(super) fn descend(&self, depth: usize, mut rest: Vec<T>, face: Option<&FaceLevels<T>>) -> Vec<T> {
        let Some(level) = self.levels.get(depth) else {
            let force: Vec<f64> = rest.iter().map(|value| value.double()).collect();
            let coarsest = face.map_or(&*self.coarsest, |face| &face.coarsest);
            let mut x: Vec<T> = coarsest.solve(&force).into_iter().map(T::of).collect();
            if let Some(held) = face.filter(|_| depth == 0).map(|face| &face.held) {
                held.project(&mut x);
            }
            return x;
        };
        let operator = Operator {
            matrix: &level.matrix,
            held: face.filter(|_| depth == 0).map(|face| &face.held),
            change: face.and_then(|face| face.changes.get(depth.wrapping_sub(1))),
            threads: self.threads,
            spare: &self.spare,
        };
        let smoother = face.and_then(|face| face.smoothers.get(depth)?.as_ref()).unwrap_or(&level.smoother);
        let mut x = self.spare.zeros(rest.len());
        let step = smoother.smooth(&operator, &mut x, &mut rest);
        operator.add_product(-1.0, &step, &mut rest);
        self.spare.give(step);
        let restricted = level.prolongator.transposed_mul(&rest, self.threads, &self.spare);
        let correction = self.descend(depth + 1, restricted, face);
        let mut moved = self.spare.zeros(rest.len());
        level.prolongator.add_product(1.0, &correction, &mut moved, self.threads);
        self.spare.give(correction);
        operator.project(&mut moved);
        operator.add(&moved, &mut x);
        operator.add_product(-1.0, &moved, &mut rest);
        let step = smoother.smooth(&operator, &mut x, &mut rest);
        [moved, rest, step].into_iter().for_each(|vector| self.spare.give(vector));
        x
    }

    /// Returns `true` if the finest smoother works on patches and its cycle is not good enough nevertheless.
    pub(super) fn is_slow(&self) -> bool {
        self.levels.first().is_some_and(|level| level.smoother.has_patches()) && self.share_taken(CYCLES.0) < GOOD_SHARE
    }

    /// Raises the degree of the finest smoother as far as the cycle needs.
    pub(super) fn suit_degree(&mut self) {
        let degree = (DEGREE * self.share_taken(CYCLES.1).powf(-1.5)).ceil().min(MOST as f64) as usize;
        if let Some(level) = self.levels.first_mut().and_then(Arc::get_mut) {
            level.smoother.degree = degree.max(level.smoother.degree);
        }
    }

    /// The share of the energy of an error that the last of `cycles` takes.
    fn share_taken(&self, cycles: usize) -> f64 {
        let Some(level) = self.levels.first() else { return 1.0 };
        let operator = Operator::whole(&level.matrix, self.threads, &self.spare);
        let mut share = 1.0;
        power_iteration(operator.dim(), -0.5, cycles, |error| {
            let found = operator.quotient(error, |force| self.descend(0, self.spare.copy(force), None));
            found.is_some_and(|(of_taken, taken)| {
                share = of_taken;
                error.iter_mut().zip(&taken).for_each(|(error, &taken)| *error -= taken);
                true
            })
        });
        share
    }
}
