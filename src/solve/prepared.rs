//! A problem with everything done that does not depend on load and gap: factor once, contact many.

use std::time::Instant;

use super::{Condense, Path, Settings, run};
use crate::error::Error;
use crate::method::parametric::Compliance;
use crate::method::{ScaledProblem, active_set, interior_point};
use crate::problem::{ContactProblem, EnergyNorm};
use crate::solution::{ContactSet, Iteration, Seconds, Solution};
use crate::sparse::{AugmentedMatrix, Cholesky, FactorError, exponent, largest, ldexp};
use crate::transform::{Condensation, RowSelection, Scaling};

/// A contact problem, scaled, condensed where that pays, factorised.
#[derive(Clone, Debug)]
pub struct Prepared {
    problem: ContactProblem,
    selection: RowSelection,
    scaling: Scaling,
    norm: Option<EnergyNorm>,
    condensation: Option<Condensation>,
    augmented: AugmentedMatrix,
    seconds: Seconds,
}

/// Load and gap of one solve in scaled quantities, condensed where the body is.
struct Scaled {
    problem: ContactProblem,
    /// Exponent of the reference displacement.
    unit: i32,
    /// Forward sweep of the load, where the body is condensed.
    sweep: Vec<f64>,
}

impl Prepared {
    /// Scales, condenses and factorises `problem`.
    ///
    /// # Errors
    /// [`Error::Infeasible`] for rows that contradict each other at the gaps of `problem`, [`Error::NotConvex`],
    /// [`Error::Numerical`] where memory does not suffice.
    pub fn new(problem: &ContactProblem, condense: Condense) -> Result<Self, Error> {
        let clock = Instant::now();
        let selection = RowSelection::of(problem.contact(), problem.gap())?;
        let scaling = Scaling::of(problem.stiffness(), &selection.contact(problem.contact()))?;
        let has_empty_diagonal = problem.stiffness().diagonal().contains(&0.0);
        let factor_clock = Instant::now();
        let contact_dofs = Condensation::contact_dofs(scaling.contact());
        let analysis = match condense {
            Condense::Auto => Condensation::analyse(scaling.stiffness(), &contact_dofs)?,
            Condense::Never => None,
        };
        let definite = |factor: Result<Cholesky, FactorError>| match factor {
            Ok(cholesky) if cholesky.is_definite(scaling.stiffness()) => Ok(Some(cholesky)),
            Ok(_) | Err(FactorError::NotPositiveDefinite) => Ok(None),
            Err(error) => Err(Error::from(error)),
        };
        let cholesky = match &analysis {
            _ if has_empty_diagonal => None,
            Some(analysis) => definite(analysis.factor(scaling.stiffness()))?,
            None => definite(Cholesky::of(scaling.stiffness()))?,
        };
        let mut condensation = None;
        if analysis.is_some() {
            let shifted = cholesky.is_none();
            let factor = match &cholesky {
                Some(cholesky) => Some(cholesky.clone()),
                None => factor_with_rows(&scaling, &contact_dofs)?,
            };
            // Where even all rows together do not hold the body, the full problem tells why.
            if let Some(factor) = factor {
                condensation = Some(Condensation::new(factor, contact_dofs, scaling.contact(), shifted)?);
            }
        }
        let augmented = match &condensation {
            Some(condensed) => AugmentedMatrix::new(condensed.stiffness(), condensed.contact())?,
            None => AugmentedMatrix::new(scaling.stiffness(), scaling.contact())?,
        };
        let norm = cholesky.map(|cholesky| EnergyNorm::new(cholesky, scaling.equilibration().clone()));
        let factor = factor_clock.elapsed().as_secs_f64();
        let seconds = Seconds { factor, solve: clock.elapsed().as_secs_f64() };
        Ok(Prepared { problem: problem.clone(), selection, scaling, norm, condensation, augmented, seconds })
    }

    /// Number of unknowns that the methods work on.
    pub fn condensed_dofs(&self) -> usize {
        self.condensation.as_ref().map_or(self.problem.dofs(), |condensed| condensed.stiffness().dim())
    }

    /// Number of values of the factor of the stiffness; zero where the methods factorise by themselves.
    pub fn factor_entries(&self) -> usize {
        self.condensation.as_ref().map_or(0, Condensation::factor_entries)
    }

    /// What the preparation cost.
    pub fn seconds(&self) -> Seconds {
        self.seconds
    }

    /// Solves with the load and the gaps of the problem that was prepared.
    ///
    /// # Errors
    /// As [`solve`](super::solve).
    pub fn solve(&self, settings: &Settings) -> Result<Solution, Error> {
        self.solve_from(&self.problem, None, settings)
    }

    /// Solves with other gaps, the active-set steps starting from `start` where it is given.
    ///
    /// # Errors
    /// As [`solve`](super::solve); [`Error::Length`] and [`Error::NotFinite`] for gaps that do not fit, or that are
    /// infinite in other rows than those of the problem that was prepared.
    pub fn solve_gap(&self, gap: Vec<f64>, start: Option<&ContactSet>, settings: &Settings) -> Result<Solution, Error> {
        self.solve_from(&self.problem.with_gap(gap)?, start, settings)
    }

    /// Solves with another load, the active-set steps starting from `start` where it is given.
    ///
    /// # Errors
    /// As [`Prepared::solve_gap`], for the load.
    pub fn solve_load(
        &self,
        load: Vec<f64>,
        start: Option<&ContactSet>,
        settings: &Settings,
    ) -> Result<Solution, Error> {
        self.solve_from(&self.problem.with_load(load)?, start, settings)
    }

    /// The exact path of the answer while the gaps move from `from` to `to` (length m each) on a straight line.
    ///
    /// # Errors
    /// As [`Prepared::solve_gap`] for both ends; [`Error::NotCondensed`] for a problem that was not condensed or whose
    /// stiffness is not definite by itself.
    pub fn path(&self, from: &[f64], to: &[f64], settings: &Settings) -> Result<Path<'_>, Error> {
        let Some(condensed) = self.condensation.as_ref().filter(|_| self.norm.is_some()) else {
            return Err(Error::NotCondensed { step: "the exact path" });
        };
        let (first, last) = (self.problem.with_gap(from.to_vec())?, self.problem.with_gap(to.to_vec())?);
        self.check_rows(&last)?;
        let start = self.solve_from(&first, None, settings)?;
        let scaled = self.scale(&first)?;
        let free = condensed.contact().mul(&condensed.free_displacement(&scaled.sweep));
        let at_end = self.scaling.gap(&self.selection.gap(to), scaled.unit);
        let constant = free.iter().zip(scaled.problem.gap()).map(|(free, gap)| free - gap).collect();
        let slope = scaled.problem.gap().iter().zip(&at_end).map(|(first, last)| first - last).collect();
        let compliance = Compliance::new(condensed.compliance(), constant, slope);
        let (pieces, mut events) = compliance.walk(&self.selection.restrict_set(&start.contact_set))?;
        events.iter_mut().for_each(|event| event.row = self.selection.kept()[event.row]);
        Ok(Path { prepared: self, from: from.to_vec(), to: to.to_vec(), unit: scaled.unit, pieces, events })
    }

    pub(super) fn expand_multiplier(&self, multiplier: &[f64], unit: i32) -> Vec<f64> {
        self.selection.expand_multiplier(&self.scaling.expand_multiplier(multiplier, unit))
    }

    pub(super) fn expand_set(&self, set: &ContactSet) -> ContactSet {
        self.selection.expand_set(set)
    }

    fn solve_from(
        &self,
        problem: &ContactProblem,
        start: Option<&ContactSet>,
        settings: &Settings,
    ) -> Result<Solution, Error> {
        settings.check()?;
        let clock = Instant::now();
        self.check_rows(problem)?;
        let scaled = self.scale(problem)?;
        let task = ScaledProblem::new(&scaled.problem, &self.augmented, self.norm.is_some());
        let start = start.map(|set| self.selection.restrict_set(set));
        let outcome = run(&task, start, settings).map_err(|error| self.expand_error(error, &scaled))?;

        let displacement = self.expand(&scaled, &outcome.displacement);
        let multiplier = self.expand_multiplier(&outcome.multiplier, scaled.unit);
        let certificate = problem.certify_in(self.norm.as_ref(), &displacement, &multiplier)?;
        let expand_iteration = |step: Iteration| Iteration {
            contact_set: self.selection.expand_set(&step.contact_set),
            penalty: step.penalty,
        };
        let solution = Solution {
            displacement,
            multiplier,
            contact_set: self.selection.expand_set(&outcome.contact_set),
            method: format!("{}{}", settings.method.name(), outcome.variant),
            iterations: outcome.iterations,
            history: outcome.history.into_iter().map(expand_iteration).collect(),
            certificate,
            condensed_dofs: self.condensed_dofs(),
            seconds: Seconds { factor: task.factor_seconds(), solve: clock.elapsed().as_secs_f64() },
        };
        if solution.certificate.meets(settings.tolerance) {
            return Ok(solution);
        }
        interior_point::check_feasible(&task, settings.interior_point_tolerance)
            .map_err(|error| self.expand_error(error, &scaled))?;
        let (condition, value) = solution.certificate.worst();
        Err(Error::NotCertified { solution: Box::new(solution), condition, value, tolerance: settings.tolerance })
    }

    /// Displacement and multiplier with the rows of `closed` held at their gaps.
    pub(super) fn with_contact_set(&self, closed: &ContactSet) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let scaled = self.scale(&self.problem)?;
        let task = ScaledProblem::new(&scaled.problem, &self.augmented, self.norm.is_some());
        let held = active_set::with_contact_set(&task, &self.selection.restrict_set(closed))
            .map_err(|error| self.expand_error(error, &scaled))?;
        let multiplier = self.expand_multiplier(&held.multiplier, scaled.unit);
        Ok((self.expand(&scaled, &held.displacement), multiplier))
    }

    /// Rows that were left out when the problem was prepared must still be no constraints, and no others.
    fn check_rows(&self, problem: &ContactProblem) -> Result<(), Error> {
        if RowSelection::of(problem.contact(), problem.gap())? == self.selection {
            return Ok(());
        }
        let (row, &value) = (problem.gap().iter().enumerate())
            .find(|(row, gap)| gap.is_finite() != self.problem.gap()[*row].is_finite())
            .unwrap_or((0, &f64::NAN));
        let allowed = "infinite in the same rows as when the problem was prepared";
        Err(Error::NotFinite { name: "gap vector", at: format!("entry {row}"), value, allowed })
    }

    /// Scales load and gap, and condenses the load.
    ///
    /// The reference displacement is what the load alone does or the obstacle enforces, where the stiffness is definite,
    /// but no more than the gaps and the load over the stiffness, where a soft support would let the free body run away.
    fn scale(&self, problem: &ContactProblem) -> Result<Scaled, Error> {
        let gap = self.selection.gap(problem.gap());
        let stiffness = largest(&problem.stiffness().diagonal());
        let static_reach = if stiffness > 0.0 { largest(problem.load()) / stiffness } else { 0.0 };
        let local = largest(&gap).max(static_reach);
        let mut unit = exponent(local);

        let mut load = self.scaling.load(problem.load(), unit);
        let mut sweep = self.condensation.as_ref().map_or_else(Vec::new, |condensed| condensed.sweep(&load));
        if let Some(norm) = &self.norm {
            let free = match &self.condensation {
                Some(condensed) => largest(&condensed.free_displacement(&sweep)),
                None => largest(&norm.scaled_displacement(&load)),
            };
            let enforced = gap.iter().fold(0.0, |enforced: f64, gap| enforced.max(-gap));
            let reach = ldexp(free, unit).max(enforced);
            if reach > 0.0 && reach < local {
                let finer = exponent(reach);
                load.iter_mut().chain(&mut sweep).for_each(|value| *value = ldexp(*value, unit - finer));
                unit = finer;
            }
        }
        let gap = self.scaling.gap(&gap, unit);
        let problem = match &self.condensation {
            Some(condensed) => {
                let load = condensed.load(&sweep);
                ContactProblem::new(condensed.stiffness().clone(), load, condensed.contact().clone(), gap)
            }
            None => ContactProblem::new(self.scaling.stiffness().clone(), load, self.scaling.contact().clone(), gap),
        }?;
        Ok(Scaled { problem, unit, sweep })
    }

    /// The displacement of the whole body, in its own unit.
    fn expand(&self, scaled: &Scaled, displacement: &[f64]) -> Vec<f64> {
        match &self.condensation {
            Some(condensed) => {
                self.scaling.expand_displacement(&condensed.expand(&scaled.sweep, displacement), scaled.unit)
            }
            None => self.scaling.expand_displacement(displacement, scaled.unit),
        }
    }

    /// Rows and directions of an error in the terms of the original problem.
    fn expand_error(&self, error: Error, scaled: &Scaled) -> Error {
        let normalised = |direction: Vec<f64>| {
            let whole = match &self.condensation {
                // A free motion moves the interior along without force.
                Some(condensed) => condensed.expand(&vec![0.0; scaled.sweep.len()], &direction),
                None => direction,
            };
            let mut direction = self.scaling.expand_displacement(&whole, 0);
            let size = largest(&direction);
            direction.iter_mut().for_each(|value| *value /= size);
            direction
        };
        match error {
            Error::Unbounded { motion, direction } => Error::Unbounded { motion, direction: normalised(direction) },
            Error::UnderHeld { motion, direction } => Error::UnderHeld { motion, direction: normalised(direction) },
            Error::Infeasible { rows, .. } => {
                let rows: Vec<usize> = rows.into_iter().map(|row| self.selection.kept()[row]).collect();
                let reason = format!("no displacement satisfies the contact rows {rows:?} together (indices from 0)");
                Error::Infeasible { reason, rows }
            }
            other => other,
        }
    }
}

/// The factor of `K + B'B` with the contact dofs last, or `None` where it is not safely definite.
fn factor_with_rows(scaling: &Scaling, contact_dofs: &[usize]) -> Result<Option<Cholesky>, Error> {
    let augmented = AugmentedMatrix::with_last(scaling.stiffness(), scaling.contact(), contact_dofs)?;
    let matrix = augmented.matrix(|_| 1.0, 0.0);
    match augmented.factor(&matrix) {
        Ok(cholesky) if cholesky.is_definite(&matrix) => Ok(Some(cholesky)),
        Ok(_) | Err(FactorError::NotPositiveDefinite) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
