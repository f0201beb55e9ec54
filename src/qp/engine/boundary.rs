//! The answer on the contact boundary alone: contact set, multipliers and forces, without the displacement of the body.

use super::factored::Prepared;
use super::found::Found;
use crate::error::Error;
use crate::qp::settings::Settings;
use crate::solution::{Certificate, ContactSet, Solution};

/// What a prepared problem says of its contact boundary at some gap and load.
///
/// The multipliers are those of the whole answer. Nothing in it costs a sweep through the factor of the body, unless it
/// is asked for: [`displacement`](Self::displacement) takes one, [`solution`](Self::solution) two.
#[derive(Clone, Debug)]
pub struct BoundarySolution<'a> {
    /// Contact multiplier lambda, one entry per contact row, in the problem's unit of force, `<= 0` in compression.
    pub multiplier: Vec<f64>,
    /// The closed rows.
    pub contact_set: ContactSet,
    /// Iterations of the method.
    pub iterations: usize,
    /// The certificate of the *condensed* problem, in its dimensionless units: its conditions are recomputed from the
    /// condensed stiffness, load and rows, not from the problem itself. That takes the displacement of the body.
    pub condensed_certificate: Certificate,
    pub(super) prepared: &'a Prepared,
    pub(super) found: Found,
}

impl BoundarySolution<'_> {
    /// Total contact force `-sum(lambda)`, `>= 0`, in the problem's unit of force.
    pub fn contact_force(&self) -> f64 {
        -self.multiplier.iter().sum::<f64>()
    }

    /// The displacement u of the whole body, one entry per dof, in the problem's unit of length; not certified.
    pub fn displacement(&self) -> Vec<f64> {
        self.prepared.displacement(&self.found)
    }

    /// The whole answer, with the certificate of the problem itself.
    ///
    /// # Errors
    /// [`Error::NotCertified`] and [`Error::Infeasible`], as [`solve`](crate::solve).
    pub fn solution(self, settings: &Settings) -> Result<Solution, Error> {
        self.prepared.complete(self.found, settings)
    }
}

impl Prepared {
    /// Contact set, multipliers and forces with other gaps, the active-set steps starting from `start` where it is given.
    ///
    /// The displacement of the body is not computed, so that a condensed problem costs what its contact boundary costs.
    ///
    /// # Errors
    /// As [`Prepared::solve_gap`]; the tolerance is held against the certificate of the condensed problem.
    pub fn boundary_at_gap(
        &self,
        gap: Vec<f64>,
        start: Option<&ContactSet>,
        settings: &Settings,
    ) -> Result<BoundarySolution<'_>, Error> {
        let settings = &settings.started()?;
        self.on_boundary(self.find(self.own_load(), gap, start, settings)?, settings)
    }

    /// As [`Prepared::boundary_at_gap`], with another load, which costs one sweep through the factor of the body.
    ///
    /// # Errors
    /// As [`Prepared::boundary_at_gap`], for the load.
    pub fn boundary_at_load(
        &self,
        load: Vec<f64>,
        start: Option<&ContactSet>,
        settings: &Settings,
    ) -> Result<BoundarySolution<'_>, Error> {
        self.boundary_at(load, self.problem.gap().to_vec(), start, settings)
    }

    /// As [`Prepared::boundary_at_load`], with other gaps too.
    ///
    /// # Errors
    /// As [`Prepared::boundary_at_gap`], for load and gaps.
    pub fn boundary_at(
        &self,
        load: Vec<f64>,
        gap: Vec<f64>,
        start: Option<&ContactSet>,
        settings: &Settings,
    ) -> Result<BoundarySolution<'_>, Error> {
        let settings = &settings.started()?;
        let loading = self.other_load(load, &gap)?;
        self.on_boundary(self.find(loading, gap, start, settings)?, settings)
    }

    /// The answer on the boundary, certified there.
    pub(super) fn on_boundary(&self, found: Found, settings: &Settings) -> Result<BoundarySolution<'_>, Error> {
        self.judged(found, settings, true)
    }

    /// The answer on the boundary, its conditions recomputed there, and its error bound where it is `bounded`.
    pub(super) fn judged(
        &self,
        found: Found,
        settings: &Settings,
        bounded: bool,
    ) -> Result<BoundarySolution<'_>, Error> {
        let on_boundary = |found: &Found| -> Result<Certificate, Error> {
            let Found { problem, outcome, .. } = found;
            match if bounded { self.condensed_norm(problem)? } else { None } {
                None if bounded => problem.certify(&outcome.displacement, &outcome.multiplier),
                norm => problem.certify_in(norm.as_ref(), &outcome.displacement, &outcome.multiplier),
            }
        };
        let is_met = |certificate: &Certificate| match bounded {
            true => settings.goal().is_met_by(certificate),
            false => certificate.conditions_hold(settings.tolerance),
        };
        let (found, condensed_certificate) = if self.is_single() {
            // The condensed problem is that of the last step only.
            let (found, solution) = self.best(found, settings)?;
            (found, solution.certificate)
        } else {
            let certificate = on_boundary(&found)?;
            match is_met(&certificate) {
                true => (found, certificate),
                false => {
                    // The certificate of the whole answer tells what is wrong, unless it knows better.
                    let found = self.best(found, settings)?.0;
                    let certificate = on_boundary(&found)?;
                    (found, certificate)
                }
            }
        };
        let Found { unit, outcome, .. } = &found;
        Ok(BoundarySolution {
            multiplier: self.expand_multiplier(&outcome.multiplier, *unit),
            contact_set: self.reduction.selection.expand_set(&outcome.contact_set),
            iterations: outcome.iterations,
            condensed_certificate,
            prepared: self,
            found,
        })
    }
}
