//! The degree of a smoother on patches, from the measured convergence of the cycle.
//!
//! The stiffer the volume is, the slower are the motions without change of volume that no aggregate can make. The
//! slowest parts of an error are left after a few cycles: what the next one takes of their energy says how much more
//! smoothing a cycle needs.

use std::sync::Arc;

use super::hierarchy::Hierarchy;
use super::operator::Operator;
use crate::linear::power_iteration::power_iteration;
use crate::linear::real::Real;

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
        let product = |x: &[T], y: &[T]| x.iter().zip(y).map(|(x, y)| x.double() * y.double()).sum::<f64>();
        let mut force = vec![T::default(); operator.dim()];
        let mut share = 1.0;
        power_iteration(operator.dim(), -0.5, cycles, |error| {
            operator.mul_into(error, &mut force);
            let taken = self.descend(0, self.spare.copy(&force), None);
            let (energy, of_taken) = (product(error, &force), product(&taken, &force));
            if energy.is_nan() || energy <= 0.0 || !of_taken.is_finite() {
                return false;
            }
            share = of_taken / energy;
            error.iter_mut().zip(&taken).for_each(|(error, &taken)| *error -= taken);
            true
        });
        share
    }
}
