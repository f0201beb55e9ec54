//! The engine with a factor, on the contact boundary: an answer there, and the exact way from one to the next.

use std::sync::Arc;

use super::boundary::{BoundarySolution, Inside};
use super::case::Case;
use super::factored::Factored;
use super::found::Found;
use super::walk::{Expansion, Walk};
use crate::error::Error;
use crate::qp::linear::ldexp;
use crate::qp::method::parametric::Compliance;
use crate::qp::settings::Settings;
use crate::solution::{Certificate, ContactSet, Solution};

/// The result on the boundary, from which the whole answer can be made.
#[derive(Debug)]
struct Reduced {
    engine: Arc<Factored>,
    found: Found,
    settings: Settings,
}

impl Inside for Reduced {
    fn displacement(&self) -> Vec<f64> {
        self.engine.displacement(&self.found)
    }

    fn solution(&self) -> Result<Solution, Error> {
        self.engine.best(self.found.clone(), &self.settings).map(|best| best.1)
    }
}

/// The way back from the rows that the methods work on, at this exponent of the reference displacement.
#[derive(Debug)]
struct ToRows {
    engine: Arc<Factored>,
    unit: i32,
}

impl Expansion for ToRows {
    fn multiplier(&self, reduced: &[f64]) -> Vec<f64> {
        self.engine.expand_multiplier(reduced, self.unit)
    }

    fn contact_set(&self, reduced: &ContactSet) -> ContactSet {
        self.engine.expand_set(reduced)
    }
}

impl Factored {
    /// The result of the method with the certificate of the condensed problem: its conditions recomputed there, and its error
    /// bound if the case asks for one.
    pub fn on_boundary(&self, case: &Case) -> Result<(Found, Certificate), Error> {
        let (settings, bounded, found) = (case.settings, case.is_bounded, self.find(case)?);
        let on_boundary = |found: &Found| -> Result<Certificate, Error> {
            let Found { problem, outcome, .. } = found;
            match if bounded { self.condensed_norm(problem) } else { None } {
                None if bounded => problem.certify(&outcome.displacement, &outcome.multiplier),
                norm => problem.certify_in(norm.as_ref(), &outcome.displacement, &outcome.multiplier),
            }
        };
        if self.is_single() {
            // The condensed problem then belongs to the last step only.
            let (found, solution) = self.best(found, settings)?;
            return Ok((found, solution.certificate));
        }
        let certificate = on_boundary(&found)?;
        let is_met = match bounded {
            true => settings.goal().is_met_by(&certificate),
            false => certificate.conditions_hold(settings.goal().tolerance),
        };
        if is_met {
            return Ok((found, certificate));
        }
        // The certificate of the whole answer shows what is wrong, unless the answer meets its goal.
        let found = self.best(found, settings)?.0;
        let certificate = on_boundary(&found)?;
        Ok((found, certificate))
    }

    /// The answer on the boundary.
    ///
    /// # Errors
    /// As [`Prepared::boundary`](super::Prepared::boundary).
    pub fn boundary_at(self: Arc<Self>, case: &Case) -> Result<BoundarySolution, Error> {
        let (found, condensed_certificate) = self.on_boundary(case)?;
        Ok(BoundarySolution {
            multiplier: self.expand_multiplier(&found.outcome.multiplier, found.unit),
            contact_set: self.expand_set(&found.outcome.contact_set),
            iterations: found.outcome.iterations,
            condensed_certificate,
            inside: Arc::new(Reduced { engine: self, found, settings: case.given.clone() }),
        })
    }

    /// The way from the answer at the gaps of `from` to the answer at the gaps `to`.
    ///
    /// # Errors
    /// As [`Prepared::path`](super::Prepared::path).
    pub fn walk_to(self: Arc<Self>, from: &Case, to: &[f64]) -> Result<Walk, Error> {
        let reduction = &self.reduction;
        let is_walkable = reduction.is_definite() && !self.is_single();
        let Some(condensed) = reduction.condensation.as_ref().filter(|_| is_walkable) else {
            return Err(Error::NotCondensed { step: "the exact path" });
        };
        self.check_gap(to)?;
        let (found, _) = self.on_boundary(from)?;
        let Found { loading, unit, problem, outcome, .. } = &found;
        let free = condensed.contact().mul(&condensed.free_displacement(&loading.sweep));
        let at_end = reduction.scaling.gap(&reduction.selection.gap(to), *unit);
        let constant =
            free.iter().zip(problem.gap()).map(|(&free, gap)| ldexp(free, loading.unit - unit) - gap).collect();
        let slope = problem.gap().iter().zip(&at_end).map(|(first, last)| first - last).collect();
        let compliance = Compliance::new(condensed.compliance(), constant, slope);
        let (pieces, mut events) = compliance.walk(&outcome.contact_set, &from.settings.watch)?;
        events.iter_mut().for_each(|event| event.row = reduction.selection.kept()[event.row]);
        Ok(Walk { pieces, events, to_rows: Arc::new(ToRows { unit: *unit, engine: self.clone() }) })
    }
}
