//! What a motion asks of a prepared problem in every step, and what it can do without.

use super::boundary::BoundarySolution;
use super::factored::Prepared;
use crate::error::Error;
use crate::qp::settings::Settings;
use crate::solution::ContactSet;

impl Prepared {
    /// As [`Prepared::boundary_at`], for one of many steps: held against its conditions alone, which cost no triangular
    /// solve, unless `settings` name an accuracy.
    ///
    /// # Errors
    /// As [`Prepared::boundary_at`].
    pub(crate) fn step_at(
        &self,
        load: Vec<f64>,
        gap: Vec<f64>,
        start: &ContactSet,
        settings: &Settings,
    ) -> Result<BoundarySolution<'_>, Error> {
        let loading = self.other_load(load, &gap)?;
        let found = self.find(loading, gap, Some(start), settings)?;
        self.judged(found, settings, settings.accuracy.is_some())
    }

    /// The displacement with another load and other gaps, without a certificate; `None` where the method did not settle on
    /// a set.
    ///
    /// # Errors
    /// As [`Prepared::boundary_at`].
    pub(crate) fn settled_at(
        &self,
        load: Vec<f64>,
        gap: Vec<f64>,
        start: &ContactSet,
        settings: &Settings,
    ) -> Result<Option<Vec<f64>>, Error> {
        let loading = self.other_load(load, &gap)?;
        let found = self.find(loading, gap, Some(start), settings)?;
        Ok(found.outcome.settled.then(|| self.displacement(&found)))
    }

    /// The displacement that a force (length n) causes where no row is closed, in the precision of the factor; `None` without
    /// one.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::NotFinite`] for a force that does not fit.
    pub(crate) fn response(&self, force: Vec<f64>) -> Result<Option<Vec<f64>>, Error> {
        let Some(norm) = self.norm()? else { return Ok(None) };
        let loading = self.other_load(force, &vec![0.0; self.problem.rows()])?;
        let moved = match &self.reduction.condensation {
            Some(condensed) => condensed.free_displacement(&loading.sweep),
            None => norm.scaled_displacement(&loading.scaled(loading.unit)),
        };
        Ok(Some(self.expand(&loading, loading.unit, &moved)))
    }
}
