//! What is done once for all loads and gaps: rows selected, data scaled, the stiffness ordered and factorised.

use std::cell::Cell;
use std::sync::OnceLock;
use std::time::Instant;

use super::estimate::{Kept, check_memory};
use super::rules::{Way, factor_seconds};
use super::{Condense, Precision, Prepared, Settings};
use crate::error::Error;
use crate::problem::{ContactProblem, EnergyNorm};
use crate::solution::Seconds;
use crate::sparse::{Analysis, AugmentedMatrix, Cholesky, FactorError, largest};
use crate::transform::{Condensation, RowSelection, Scaling};

/// A pivot of the equilibrated stiffness below this is too uncertain in single precision.
const SINGLE_PIVOT: f64 = 1e-4;

/// A pivot below this share of a diagonal of order one leaves fewer than four digits of a double.
pub(super) const LOST_PIVOT: f64 = 1e-12;

impl Prepared {
    /// As [`Prepared::new`], with the threads and the precision of `settings`.
    ///
    /// # Errors
    /// As [`Prepared::new`], [`Error::Setting`], and instead of a factorisation [`Error::OutOfTime`],
    /// [`Error::Interrupted`] or [`Error::TooLarge`], where time or memory is not left for it.
    pub fn with_settings(problem: &ContactProblem, settings: &Settings) -> Result<Self, Error> {
        let settings = &settings.started()?;
        let Settings { condense, threads, watch, .. } = settings;
        let clock = Instant::now();
        watch.step("ordering", 0);
        let selection = RowSelection::of(problem.contact(), problem.gap())?;
        let scaling = Scaling::of(problem.stiffness(), &selection.contact(problem.contact()))?;
        let diagonal = problem.stiffness().diagonal();
        let (has_empty_diagonal, stiffest) = (diagonal.contains(&0.0), largest(&diagonal));
        let factor_clock = Instant::now();
        let contact_dofs = Condensation::contact_dofs(scaling.contact());
        let analysis = match condense {
            Condense::Auto => Condensation::analyse(problem.stiffness(), &contact_dofs)?,
            Condense::Never => None,
        }
        .map(|analysis| analysis.with_threads(*threads));
        let last = match &analysis {
            Some(_) => contact_dofs.clone(),
            None => EnergyNorm::last_dofs(scaling.contact()),
        };
        let of_all = match analysis {
            Some(_) => None,
            None => Some(Analysis::with_last(problem.stiffness(), &last)?.with_threads(*threads)),
        };
        let work = analysis.as_ref().or(of_all.as_ref()).map_or(0.0, Analysis::multiplications);
        let mut way = Way::chosen(settings, analysis.is_some(), work, problem.rows());
        if watch.is_stopped() {
            return Err(Error::Interrupted);
        }
        watch.step("factorisation", 0);
        if let Some(left) = watch.time_left() {
            let values = analysis.as_ref().or(of_all.as_ref()).map_or(0, Analysis::factor_entries);
            let [double, single] = factor_seconds(work, values);
            let may_be_single = settings.precision != Precision::Double && analysis.is_some();
            match way {
                Some(_) if double > left && single <= left && may_be_single => way = Some(Way::ActiveSetMixed),
                _ if double.min(if may_be_single { single } else { double }) > left => {
                    return Err(Error::OutOfTime { needed: double, time: left });
                }
                _ => {}
            }
        }
        let precision = way.map_or(settings.precision, |way| way.settings(settings).precision);
        let single = precision == Precision::Mixed && analysis.is_some();
        let kept = match (&analysis, &of_all) {
            (Some(analysis), _) => {
                let (values, contact_dofs) = (analysis.factor_entries(), contact_dofs.len());
                Kept::Condensed { values, is_single: single, contact_dofs }
            }
            (None, of_all) => Kept::Factors { values: of_all.as_ref().map_or(0, Analysis::factor_entries) },
        };
        check_memory(problem, kept, settings)?;
        let least_pivot = Cell::new(None);
        let factor = |analysis: &Analysis, single| match analysis
            .factor_equilibrated(problem.stiffness(), scaling.equilibration(), single)
            .inspect(|cholesky| least_pivot.set(Some(cholesky.smallest_pivot())))
        {
            Ok(cholesky) if single && cholesky.smallest_pivot() <= SINGLE_PIVOT => Ok(None),
            Ok(cholesky) if cholesky.is_safely_definite() || cholesky.is_definite(scaling.stiffness()) => {
                Ok(Some(cholesky))
            }
            Ok(_) => Ok(None),
            Err(FactorError::NotPositiveDefinite) => {
                least_pivot.set(Some(0.0));
                Ok(None)
            }
            Err(error) => Err(Error::from(error)),
        };
        let definite = |analysis: &Analysis| match single.then(|| factor(analysis, true)).transpose()?.flatten() {
            Some(cholesky) => Ok(Some(cholesky)),
            None => factor(analysis, false),
        };
        let cholesky = match analysis.as_ref().or(of_all.as_ref()) {
            Some(analysis) if !has_empty_diagonal => definite(analysis)?,
            _ => None,
        };
        drop(of_all);
        if cholesky.is_none() {
            // Without a bound no accuracy can be held: what is exact is left.
            let exact = Settings { accuracy: None, ..settings.clone() };
            way = Way::chosen(&exact, analysis.is_some(), work, problem.rows());
        }
        let mut condensation = None;
        if analysis.is_some() {
            let shifted = cholesky.is_none();
            let factor = match &cholesky {
                Some(cholesky) => Some(cholesky.clone()),
                None => factor_with_rows(&scaling, &contact_dofs, *threads)?,
            };
            // Where even all rows together do not hold the body, the full problem tells why.
            if let Some(factor) = factor {
                condensation = Some(Condensation::new(factor, contact_dofs, scaling.contact(), shifted)?);
            }
        }
        let augmented = match &condensation {
            Some(condensed) => {
                // Dense: the order is of no matter to the factor, and its last block is all of it.
                let all: Vec<usize> = (0..condensed.stiffness().dim()).collect();
                AugmentedMatrix::with_last(condensed.stiffness(), condensed.contact(), &all)?
            }
            None => AugmentedMatrix::new(scaling.stiffness(), scaling.contact())?.with_threads(*threads),
        };
        let norm = cholesky.map(|cholesky| EnergyNorm::new(cholesky, scaling.equilibration().clone(), last));
        let factor = factor_clock.elapsed().as_secs_f64();
        Ok(Prepared {
            problem: problem.clone(),
            selection,
            scaling,
            stiffest,
            norm,
            lost_pivot: least_pivot.get().filter(|&pivot| pivot < LOST_PIVOT),
            condensation,
            augmented,
            way,
            multiplications: work,
            condensed_norm: OnceLock::new(),
            loading: OnceLock::new(),
            seconds: Seconds { factor, solve: clock.elapsed().as_secs_f64() },
        })
    }
}

/// The factor of `K + B'B` with the contact dofs last, or `None` where it is not safely definite.
fn factor_with_rows(scaling: &Scaling, contact_dofs: &[usize], threads: usize) -> Result<Option<Cholesky>, Error> {
    let augmented =
        AugmentedMatrix::with_last(scaling.stiffness(), scaling.contact(), contact_dofs)?.with_threads(threads);
    let matrix = augmented.matrix(|_| 1.0, 0.0);
    match augmented.factor(&matrix) {
        Ok(cholesky) if cholesky.is_definite(&matrix) => Ok(Some(cholesky)),
        Ok(_) | Err(FactorError::NotPositiveDefinite) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
