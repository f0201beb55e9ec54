//! A load on a factorised body, swept through its factor once for all gaps.

use std::sync::{Arc, OnceLock};

use super::factored::Factored;
use crate::linear::{exponent, largest, ldexp};

/// A load, and its sweep through a factor once that has been used.
#[derive(Debug)]
pub(crate) struct Load {
    force: Vec<f64>,
    swept: OnceLock<Arc<Loading>>,
}

impl Load {
    /// The load f, length n.
    pub fn new(force: Vec<f64>) -> Self {
        Load { force, swept: OnceLock::new() }
    }

    /// The load swept through the factor of an `engine`; the first call does this in a unit that fits `gap`, the gaps
    /// of the selected rows.
    pub(super) fn swept(&self, engine: &Factored, gap: &[f64]) -> Arc<Loading> {
        self.swept.get_or_init(|| Arc::new(Loading::of(engine, &self.force, gap))).clone()
    }
}

/// A load in all the forms in which a solve needs it.
#[derive(Clone, Debug)]
pub(super) struct Loading {
    /// Exponent of the reference displacement of the fields below.
    pub unit: i32,
    /// Forward sweep of the scaled load, if the body is condensed.
    pub sweep: Vec<f64>,
    /// The scaled load on the dofs that the methods work on.
    scaled: Vec<f64>,
    /// The largest displacement that the load alone causes, once it has been asked for.
    free: OnceLock<Option<f64>>,
    /// The load over the stiffness.
    statics: f64,
}

impl Loading {
    /// Scales `load` (length n) in a unit that fits it and `gap`, the gaps of the selected rows, and sweeps it.
    pub fn of(engine: &Factored, load: &[f64], gap: &[f64]) -> Self {
        let stiffness = engine.stiffest;
        let statics = if stiffness > 0.0 { largest(load) / stiffness } else { 0.0 };
        let unit = exponent(largest(gap).max(statics));
        let scaled = engine.scaling.load(load, unit);
        let (sweep, scaled) = match &engine.condensation {
            Some(condensed) => {
                let sweep = condensed.sweep(&scaled);
                let condensed = condensed.load(&sweep);
                (sweep, condensed)
            }
            None => (Vec::new(), scaled),
        };
        Loading { unit, sweep, scaled, free: OnceLock::new(), statics }
    }

    /// The largest displacement that the load alone causes, if the stiffness is definite and its factor is at hand.
    fn free(&self, engine: &Factored) -> Option<f64> {
        *self.free.get_or_init(|| {
            let moved = match &engine.condensation {
                Some(condensed) => engine.is_definite().then(|| condensed.free_displacement(&self.sweep)),
                None if engine.is_norm_at_hand() => {
                    engine.norm().map(|norm| norm.equilibrated().displacement(&self.scaled))
                }
                None => None,
            };
            moved.map(|moved| ldexp(largest(&moved), self.unit))
        })
    }

    /// The load together with a force (length n) on contact dofs alone, which needs no sweep.
    pub fn with_contact_force(mut self, engine: &Factored, force: &[f64]) -> Self {
        if let Some(condensed) = &engine.condensation {
            let scaled = engine.scaling.load(force, self.unit);
            self.scaled.iter_mut().zip(&condensed.contact_dofs).for_each(|(entry, &dof)| *entry += scaled[dof]);
        }
        self
    }

    /// The exponent of the reference displacement with the gaps of the selected rows.
    ///
    /// If the stiffness is definite, the reference displacement is the larger of what the load alone causes and what
    /// the obstacle enforces. It is at most the larger of the gaps and the load over the stiffness, because on a soft
    /// support the free body would move far. The load over the stiffness moves the body about as far at least, so that
    /// smaller gaps need no solve.
    pub fn unit_with(&self, engine: &Factored, gap: &[f64]) -> i32 {
        let local = largest(gap).max(self.statics);
        let enforced = gap.iter().fold(0.0, |enforced: f64, gap| enforced.max(-gap));
        let free = if local > self.statics { self.free(engine) } else { None };
        match free.map(|free| free.max(enforced)) {
            Some(reach) if reach > 0.0 && reach < local => exponent(reach),
            _ => exponent(local),
        }
    }

    /// The load on the dofs that the methods work on, for u0 = `2^unit`.
    pub fn scaled(&self, unit: i32) -> Vec<f64> {
        self.scaled.iter().map(|&value| ldexp(value, self.unit - unit)).collect()
    }

    /// The displacement of the whole body, in its own unit.
    pub fn expand(&self, engine: &Factored, unit: i32, displacement: &[f64]) -> Vec<f64> {
        match &engine.condensation {
            Some(condensed) => {
                // In the unit of the sweep.
                let moved: Vec<f64> = displacement.iter().map(|&v| ldexp(v, unit - self.unit)).collect();
                engine.scaling.expand_displacement(&condensed.expand(&self.sweep, &moved), self.unit)
            }
            None => engine.scaling.expand_displacement(displacement, unit),
        }
    }

    /// The ratio of the energy norm of a displacement of the condensed problem, of the square `on_boundary`, to that of
    /// the whole body.
    pub fn share_of_boundary(&self, engine: &Factored, unit: i32, on_boundary: f64) -> f64 {
        let Some(condensed) = &engine.condensation else { return 1.0 };
        let interior = ldexp(condensed.interior_energy(&self.sweep), 2 * (self.unit - unit));
        if interior > 0.0 { (on_boundary / (on_boundary + interior)).max(0.0).sqrt() } else { 1.0 }
    }
}
