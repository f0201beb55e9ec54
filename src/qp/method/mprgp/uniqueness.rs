//! Modes without energy, found by cycles, without a factor: cycles leave such a mode unchanged, and nothing else.

use super::iterate::{At, Iterate};
use crate::error::Error;
use crate::qp::linear::multigrid::Multigrid;
use crate::qp::linear::{dot, largest};
use crate::qp::method::SIGN_TOLERANCE;
use crate::qp::method::bounds::Bound;
use crate::qp::method::holding::{FreeMode, PLAY, WORK_TOLERANCE};

/// Number of cycles in which all modes with energy are damped; if they are not, the body counts as held.
const CYCLES: usize = 60;

/// A mode is gone if less than this share is left: then it had only parts with energy.
const GONE: f64 = 1e-8;

/// If the energy falls by less than this factor in a cycle, it is rounding.
const LAST_FALL: f64 = 0.25;

impl Iterate<'_> {
    /// Checks that K and the rows under pressure hold every mode, or that the open rows stop it both ways without play.
    ///
    /// # Errors
    /// [`Error::UnderHeld`] with a mode that changes neither force nor energy, and those of the face.
    pub fn check_unique(&self, multigrid: &Multigrid) -> Result<(), Error> {
        let strongest = (0..self.at.len()).map(|index| self.held_gradient(index).abs()).fold(0.0, f64::max);
        let is_pressed =
            |index| self.at[index] == At::Fixed || self.held_gradient(index).abs() > SIGN_TOLERANCE * strongest;
        let golden = 0.618_033_988_749_895;
        let every = (0..self.x.len()).map(|i| (i as f64 * golden).fract() - 0.5).collect();
        match self.without_energy(multigrid, every, is_pressed)? {
            Some(mode) if !self.is_stopped_both_ways(&mode) => Err(self.free_mode(mode)),
            _ => Ok(()),
        }
    }

    /// Checks that the load drives no mode without energy that no row stops. The check is done with the closed rows, and with
    /// none, because a displacement that has run away may close any row.
    ///
    /// # Errors
    /// [`Error::Unbounded`] with that mode, and those of the face.
    pub fn check_bounded(&self, multigrid: &Multigrid) -> Result<(), Error> {
        for any_held in [false, true] {
            let is_held = |index: usize| any_held && self.at[index] != At::Free;
            let Some(mode) = self.without_energy(multigrid, self.load.clone(), is_held)? else { continue };
            let way = dot(&self.load, &mode).signum();
            let stops = |bound: &Bound| {
                let speed = way * mode[bound.unknown];
                (speed > WORK_TOLERANCE && bound.upper.is_finite())
                    || (speed < -WORK_TOLERANCE && bound.lower.is_finite())
            };
            let error = self.free_mode(mode.clone());
            if matches!(error, Error::Unbounded { .. }) && !self.bounds.bounds().iter().any(stops) {
                return Err(error);
            }
        }
        Ok(())
    }

    /// The part of `mode` that cycles leave if everything that `is_held` is fixed: a mode without energy, largest entry one;
    /// `None` if they leave nothing. Modes are looked for only if the coarsest matrix is singular to its precision.
    fn without_energy(
        &self,
        multigrid: &Multigrid,
        mut mode: Vec<f64>,
        is_held: impl Fn(usize) -> bool,
    ) -> Result<Option<Vec<f64>>, Error> {
        if !multigrid.is_shifted() {
            return Ok(None);
        }
        let bounds = self.bounds.bounds();
        let held: Vec<usize> = (0..bounds.len()).filter(|&index| is_held(index)).collect();
        let face = multigrid
            .face(&held.iter().map(|&index| self.bounds.direction(&bounds[index])).collect::<Vec<_>>(), None)?;
        if !face.is_shifted() {
            return Ok(None);
        }
        let keep = |values: &mut [f64]| held.iter().for_each(|&index| values[bounds[index].unknown] = 0.0);
        keep(&mut mode);
        // Begins with the smoothest part: the displacement under a load of that form.
        mode = self.cycled(&face, &mode);
        keep(&mut mode);
        let whole = largest(&mode);
        let mut before = f64::INFINITY;
        for _ in 0..CYCLES {
            let mut force = self.product(&mode);
            let energy = dot(&mode, &force).abs();
            if self.is_rounding(&mode, energy) && energy >= LAST_FALL * before {
                let size = largest(&mode);
                mode.iter_mut().for_each(|value| *value /= size);
                return Ok((size > GONE * whole).then_some(mode));
            }
            before = energy;
            keep(&mut force);
            let mut step = self.cycled(&face, &force);
            keep(&mut step);
            mode.iter_mut().zip(&step).for_each(|(mode, step)| *mode -= step);
        }
        Ok(None)
    }

    /// Returns `true` if open rows without play stop the mode both ways.
    fn is_stopped_both_ways(&self, mode: &[f64]) -> bool {
        let play = PLAY * largest(&self.x);
        let stops = |way: f64| {
            self.bounds.bounds().iter().any(|bound| {
                let (value, speed) = (self.x[bound.unknown], way * mode[bound.unknown]);
                let room = if speed > 0.0 { bound.upper - value } else { value - bound.lower };
                speed.abs() > WORK_TOLERANCE && room <= play
            })
        };
        stops(1.0) && stops(-1.0)
    }

    /// The error for a mode without energy, in the direction in which the load drives it.
    pub fn free_mode(&self, mut direction: Vec<f64>) -> Error {
        self.bounds.turn_back(&mut direction);
        let work = dot(self.problem.load(), &direction);
        let size = largest(&direction).copysign(work);
        direction.iter_mut().for_each(|value| *value /= size);
        let driven = work.abs() > WORK_TOLERANCE * size.abs() * largest(self.problem.load());
        FreeMode { direction, driven }.into_error()
    }
}
