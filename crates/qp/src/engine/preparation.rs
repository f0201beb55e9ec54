//! The work that is done once for all loads and gaps: rows selected, data scaled, the stiffness ordered and factorised.

use std::sync::OnceLock;
use std::time::Instant;

use super::factored::{Factored, Norm};
use crate::certificate::EnergyNorm;
use crate::cost::{check_time, seconds};
use crate::error::{Error, Result};
use crate::linear::{Analysis, Augmented, AugmentedMatrix, Cholesky, FactorError, largest};
use crate::plan::{Layout, Tried};
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::solution::Seconds;
use crate::transform::{Condensation, RowSelection, Scaling};

/// A pivot below this share of a diagonal of order one leaves fewer than four digits of a double.
const LOST_PIVOT: f64 = 1e-10;

/// Scales, condenses and factorises `problem`, for the method of an attempt.
pub fn factored(problem: &ContactProblem, settings: &Settings) -> Result<Factored> {
    let Settings { threads, watch, .. } = settings;
    let clock = Instant::now();
    watch.step("ordering", 0);
    seconds::learn(watch);
    let selection = RowSelection::of(problem);
    let contact = selection.contact(problem.contact());
    let scaling = Scaling::of(problem.stiffness(), &contact)?;
    let stiffest = largest(&problem.stiffness().diagonal());
    let factor_clock = Instant::now();
    let Layout { analysis, last, is_condensed, method, keeps_norm } = Layout::within(problem, &scaling, settings)?;
    if watch.acknowledge() {
        return Err(Error::Interrupted);
    }
    watch.step("factorisation", 0);
    let of_row = match last.len() as f64 {
        0.0 => analysis.factor_entries() as f64,
        boundary => boundary * boundary,
    };
    let proof_seconds = seconds::sweeps(problem.rows(), of_row).min(seconds::selected_inverse(&analysis));
    let (multiplications, set_seconds) = (analysis.multiplications(), seconds::factorisation(&analysis));
    let norm_seconds = seconds::ordering(problem) + set_seconds;
    let (cholesky, least_pivot) = definite(problem, &scaling, (&analysis, is_condensed), settings)?;
    // A factorisation does not notice a request to stop, and no answer is there yet.
    if watch.acknowledge() {
        return Err(Error::Interrupted);
    }
    // If no columns come last, the contact sets have the order of the stiffness.
    let analysis = last.is_empty().then_some(analysis);
    let condensation = if is_condensed { condensed(cholesky.as_ref(), &scaling, &last, settings)? } else { None };
    let norm = match (cholesky, &analysis) {
        (None, _) => Norm::Missing,
        (Some(_), Some(analysis)) if !keeps_norm => Norm::Again(analysis.clone()),
        (Some(cholesky), _) => {
            let norm = EnergyNorm::new(cholesky, scaling.equilibration.clone(), last);
            Norm::Kept(norm.lending(&contact))
        }
    };
    let augmented = augmented(condensation.as_ref(), &scaling, analysis, threads.unwrap_or(1))?;
    let by_compliance = matches!(&norm, Norm::Kept(norm) if norm.compliance().is_some());
    if !by_compliance {
        augmented.matrix()?;
    }
    let factor = factor_clock.elapsed().as_secs_f64();
    let lost_pivot = (least_pivot < LOST_PIVOT).then_some(least_pivot);
    let tried = Tried {
        method,
        condensed_dofs: condensation.as_ref().map(|condensed| condensed.stiffness.dim()),
        is_shortcut: settings.method == Method::Auto && method != Method::ActiveSet,
        lost_pivot,
        is_singular: lost_pivot.is_some(),
        multiplications,
        set_seconds: if by_compliance || is_condensed { 0.0 } else { set_seconds },
    };
    Ok(Factored {
        problem: problem.clone(),
        selection,
        scaling,
        stiffest,
        norm,
        condensation,
        augmented,
        condensed_norm: OnceLock::new(),
        tried,
        proof_seconds,
        norm_seconds,
        seconds: Seconds { factor, solve: clock.elapsed().as_secs_f64(), ..Seconds::default() },
    })
}

/// The factor of an analysed stiffness, `None` if it is not definite, and its smallest pivot, zero without a factor.
fn definite(
    problem: &ContactProblem,
    scaling: &Scaling,
    (analysis, is_condensed): (&Analysis, bool),
    settings: &Settings,
) -> Result<(Option<Cholesky>, f64)> {
    if problem.stiffness().diagonal().contains(&0.0) {
        return Ok((None, 0.0));
    }
    let factor = || match analysis.is_dense() && !is_condensed {
        // Its method takes the scaled stiffness too.
        true => analysis.factor(scaling.stiffness()),
        false => analysis.factor_equilibrated(problem.stiffness(), &scaling.equilibration),
    };
    match settings.watch.timed(seconds::factorisation(analysis), factor) {
        Ok(cholesky) => {
            let pivot = cholesky.smallest_pivot();
            let is_definite = cholesky.is_safely_definite() || cholesky.is_definite(scaling.stiffness());
            Ok((is_definite.then_some(cholesky), pivot))
        }
        Err(FactorError::NotPositiveDefinite) => Ok((None, 0.0)),
        Err(error) => Err(error.into()),
    }
}

/// The condensation onto `last`, by the factor of K or of K with its rows; `None` if these do not hold the body.
fn condensed(
    cholesky: Option<&Cholesky>,
    scaling: &Scaling,
    last: &[usize],
    settings: &Settings,
) -> Result<Option<Condensation>> {
    let factor = match cholesky {
        Some(cholesky) => Some(cholesky.clone()),
        None => factor_with_rows(scaling, last, settings)?,
    };
    let Some(factor) = factor else { return Ok(None) };
    check_time(&settings.watch, seconds::dense(last.len()))?;
    let last = last.to_vec();
    Condensation::new(factor, cholesky.is_none(), last, &scaling.contact).map(Some)
}

/// The matrices that the methods factorise, analysed; an `analysis` of the stiffness is reused for them.
fn augmented(
    condensation: Option<&Condensation>,
    scaling: &Scaling,
    analysis: Option<Analysis>,
    threads: usize,
) -> Result<Augmented, FactorError> {
    match condensation {
        Some(condensed) => {
            // The condensed matrix is dense: any order gives the same factor, and its last block is the whole factor.
            let all: Vec<usize> = (0..condensed.stiffness.dim()).collect();
            let (stiffness, contact) = (&condensed.stiffness, &condensed.contact);
            let matrix = AugmentedMatrix::with_last(stiffness, contact, &all)?.with_threads(threads);
            Ok(Augmented::of(stiffness, contact, matrix))
        }
        None => Ok(Augmented::new(scaling.stiffness(), &scaling.contact, analysis, threads)),
    }
}

/// The factor of `K + B'B` with the contact dofs last, or `None` if it is not safely definite.
fn factor_with_rows(scaling: &Scaling, contact_dofs: &[usize], settings: &Settings) -> Result<Option<Cholesky>> {
    let augmented = AugmentedMatrix::with_last(scaling.stiffness(), &scaling.contact, contact_dofs)?;
    let augmented = augmented.with_threads(settings.threads.unwrap_or(1));
    check_time(&settings.watch, seconds::factorisation(augmented.analysis()))?;
    let matrix = augmented.matrix(|_| 1.0, 0.0);
    match augmented.factor(matrix.clone()) {
        Ok(cholesky) if cholesky.is_definite(&matrix) => Ok(Some(cholesky)),
        Ok(_) | Err(FactorError::NotPositiveDefinite) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
