//! What is done once for all loads and gaps: rows selected, data scaled, the stiffness ordered and factorised.

use std::cell::Cell;
use std::sync::OnceLock;
use std::time::Instant;

use super::factored::Prepared;
use super::reduction::Reduction;
use crate::error::Error;
use crate::qp::cost::seconds::factor_seconds;
use crate::qp::cost::{Kept, check_memory, check_time, seconds};
use crate::qp::linear::{AugmentedMatrix, Cholesky, FactorError, largest};
use crate::qp::plan::{Layout, Way};
use crate::qp::problem::{ContactProblem, EnergyNorm};
use crate::qp::settings::Settings;
use crate::qp::transform::{Condensation, RowSelection, Scaling};
use crate::solution::Seconds;

/// A pivot of the equilibrated stiffness below this is too uncertain in single precision.
const SINGLE_PIVOT: f64 = 1e-4;

/// A pivot below this share of a diagonal of order one leaves fewer than four digits of a double.
pub(super) const LOST_PIVOT: f64 = 1e-10;

impl Prepared {
    /// As [`Prepared::new`], with the threads and the precision of `settings`.
    ///
    /// # Errors
    /// As [`Prepared::new`], [`Error::Setting`], and instead of a factorisation [`Error::OutOfTime`],
    /// [`Error::Interrupted`] or [`Error::TooLarge`], where time or memory is not left for it.
    pub fn with_settings(problem: &ContactProblem, settings: &Settings) -> Result<Self, Error> {
        let settings = &settings.started()?;
        let Settings { threads, watch, .. } = settings;
        let clock = Instant::now();
        watch.step("ordering", 0);
        seconds::learn(watch);
        let selection = RowSelection::of(problem.contact(), problem.gap())?;
        let scaling = Scaling::of(problem.stiffness(), &selection.contact(problem.contact()))?;
        let diagonal = problem.stiffness().diagonal();
        let (has_empty_diagonal, stiffest) = (diagonal.contains(&0.0), largest(&diagonal));
        let factor_clock = Instant::now();
        let layout = Layout::within(problem, &scaling, settings)?;
        let Layout { analysis, last, is_condensed, multiplications, mut way, is_single: single } = layout;
        if watch.is_stopped() {
            return Err(Error::Interrupted);
        }
        watch.step("factorisation", 0);
        let proof_seconds = match last.len() as f64 {
            0.0 => seconds::sweeps(problem.rows(), analysis.factor_entries() as f64),
            boundary => seconds::sweeps(problem.rows(), boundary * boundary),
        };
        let norm_seconds = seconds::ordering(problem) + seconds::factorisation(&analysis);
        let least_pivot = Cell::new(has_empty_diagonal.then_some(0.0));
        let factor = |single| {
            let estimate = factor_seconds(multiplications, analysis.factor_entries())[usize::from(single)];
            let scaled = scaling.equilibration();
            let factor = || analysis.factor_equilibrated(problem.stiffness(), scaled, single);
            match watch.timed(estimate, factor).inspect(|cholesky| least_pivot.set(Some(cholesky.smallest_pivot()))) {
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
            }
        };
        let definite = || match single.then(|| factor(true)).transpose()?.flatten() {
            Some(cholesky) => Ok(Some(cholesky)),
            None => {
                if single {
                    let values = analysis.factor_entries();
                    let kept = Kept::Condensed {
                        values,
                        is_single: false,
                        contact_dofs: last.len(),
                        by_interior_point: false,
                    };
                    check_memory(problem, kept, settings)?;
                    check_time(watch, factor_seconds(multiplications, values)[0])?;
                }
                factor(false)
            }
        };
        let cholesky = if has_empty_diagonal { None } else { definite()? };
        drop(analysis);
        if cholesky.is_none() {
            // Without a bound no accuracy can be held: what is exact is left.
            let exact = Settings { accuracy: None, ..settings.clone() };
            way = Way::chosen(&exact, is_condensed, multiplications, problem.rows());
        }
        let mut condensation = None;
        if is_condensed {
            let shifted = cholesky.is_none();
            let factor = match &cholesky {
                Some(cholesky) => Some(cholesky.clone()),
                None => factor_with_rows(&scaling, &last, settings)?,
            };
            // Where even all rows together do not hold the body, the full problem tells why.
            if let Some(factor) = factor {
                check_time(watch, seconds::dense(last.len()))?;
                condensation = Some(Condensation::new(factor, last.clone(), scaling.contact(), shifted)?);
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
            reduction: Reduction { selection, scaling, stiffest, norm, condensation },
            lost_pivot: least_pivot.get().filter(|&pivot| pivot < LOST_PIVOT),
            augmented,
            way,
            multiplications,
            proof_seconds,
            norm_seconds,
            condensed_norm: OnceLock::new(),
            loading: OnceLock::new(),
            seconds: Seconds { factor, solve: clock.elapsed().as_secs_f64() },
        })
    }
}

/// The factor of `K + B'B` with the contact dofs last, or `None` where it is not safely definite.
///
/// # Errors
/// [`Error::OutOfTime`] before it is factorised, [`Error::Numerical`].
fn factor_with_rows(scaling: &Scaling, contact_dofs: &[usize], settings: &Settings) -> Result<Option<Cholesky>, Error> {
    let augmented = AugmentedMatrix::with_last(scaling.stiffness(), scaling.contact(), contact_dofs)?;
    let augmented = augmented.with_threads(settings.threads);
    check_time(&settings.watch, seconds::factorisation(augmented.analysis()))?;
    let matrix = augmented.matrix(|_| 1.0, 0.0);
    match augmented.factor(&matrix) {
        Ok(cholesky) if cholesky.is_definite(&matrix) => Ok(Some(cholesky)),
        Ok(_) | Err(FactorError::NotPositiveDefinite) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
