//! How a problem is factorised: condensed, or on all dofs with the contact boundary last, or without, whichever fits first.

use super::estimate::{Estimate, Kept, check_memory, check_time};
use super::rules::Way;
use super::{Condense, Method, Precision, Settings, pace};
use crate::error::Error;
use crate::qp::linear::Analysis;
use crate::qp::problem::{ContactProblem, EnergyNorm};
use crate::qp::transform::{Condensation, Scaling};

/// An order of elimination with its structure, and what is kept of it.
pub(super) struct Layout {
    pub analysis: Analysis,
    /// The dofs that are eliminated last.
    pub last: Vec<usize>,
    /// Are they those of a condensation?
    pub is_condensed: bool,
    pub multiplications: f64,
    /// What was chosen, where the choice was left to the program.
    pub way: Option<Way>,
    /// Is the factor in single precision?
    pub is_single: bool,
}

impl Layout {
    /// The first layout that fits into the memory of `settings`.
    ///
    /// # Errors
    /// [`Error::TooLarge`] with the least that one needs, [`Error::OutOfTime`], [`Error::Interrupted`].
    pub fn within(problem: &ContactProblem, scaling: &Scaling, settings: &Settings) -> Result<Self, Error> {
        check_room_to_order(problem, settings)?;
        let contact_dofs = Condensation::contact_dofs(scaling.contact());
        let mut refused: Option<Error> = None;
        for number in 0.. {
            check_time(&settings.watch, pace::ordering(problem))?;
            if settings.watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            let analysed = match number {
                0 if settings.condense == Condense::Never => None,
                0 => Condensation::analyse(problem.stiffness(), &contact_dofs)?
                    .map(|found| (found, contact_dofs.clone())),
                1 => {
                    let last = EnergyNorm::last_dofs(scaling.contact());
                    match last.is_empty() {
                        true => None,
                        false => Some((Analysis::with_last(problem.stiffness(), &last)?, last)),
                    }
                }
                2 => Some((Analysis::of(problem.stiffness())?, Vec::new())),
                _ => break,
            };
            let Some((analysis, last)) = analysed else { continue };
            match Self::of(problem, settings, (analysis, last), number == 0) {
                Err(error @ Error::TooLarge { .. }) => {
                    refused = Some(match refused {
                        None => error,
                        Some(before) => lesser(before, error),
                    });
                }
                decided => return decided,
            }
        }
        Err(refused.unwrap_or(Error::Interrupted))
    }

    /// The layout with the way and the precision that fit into memory and time.
    fn of(
        problem: &ContactProblem,
        settings: &Settings,
        (analysis, last): (Analysis, Vec<usize>),
        is_condensed: bool,
    ) -> Result<Self, Error> {
        let analysis = analysis.with_threads(settings.threads);
        let multiplications = analysis.multiplications();
        let way = Way::chosen(settings, is_condensed, multiplications, problem.rows());
        let is_single = is_condensed && precision(way, settings) == Precision::Mixed;
        let mut layout = Layout { analysis, last, is_condensed, multiplications, way, is_single };
        let fits = |layout: &Layout| {
            check_memory(problem, layout.kept(settings), settings)?;
            check_time(&settings.watch, layout.seconds(settings))
        };
        let Err(mut refused) = fits(&layout) else { return Ok(layout) };
        if way.is_none() {
            return Err(refused);
        }
        // What the rules choose for its speed may take more memory, or time before its first step, than there is.
        layout.way = Some(Way::ActiveSet);
        layout.is_single = false;
        match fits(&layout) {
            Ok(()) => return Ok(layout),
            Err(error) => refused = lesser(refused, error),
        }
        if is_condensed && settings.precision != Precision::Double {
            layout.way = Some(Way::ActiveSetMixed);
            layout.is_single = true;
            match fits(&layout) {
                Ok(()) => return Ok(layout),
                Err(error) => refused = lesser(refused, error),
            }
        }
        Err(refused)
    }

    fn kept(&self, settings: &Settings) -> Kept {
        let (values, last) = (self.analysis.factor_entries(), self.last.len());
        let by_interior_point = self.by_interior_point(settings);
        match self.is_condensed {
            true => Kept::Condensed { values, is_single: self.is_single, contact_dofs: last, by_interior_point },
            false => Kept::Factors { values, last, by_interior_point },
        }
    }

    fn by_interior_point(&self, settings: &Settings) -> bool {
        self.way.map_or(settings.method, |way| way.settings(settings).method) == Method::Qp
    }

    /// Seconds until the first set of contact rows is settled, or the first step of the interior point is done.
    fn seconds(&self, settings: &Settings) -> f64 {
        let [double, single] = super::rules::factor_seconds(self.multiplications, self.analysis.factor_entries());
        let first = if self.is_single { single } else { double };
        match (self.is_condensed, self.by_interior_point(settings)) {
            (true, _) => first + pace::dense(self.last.len()),
            (false, false) => first + double,
            (false, true) => first + 2.0 * pace::interior_point(&self.analysis),
        }
    }
}

/// The precision of `settings` with a way.
pub(super) fn precision(way: Option<Way>, settings: &Settings) -> Precision {
    way.map_or(settings.precision, |way| way.settings(settings).precision)
}

/// Refuses a problem that is too large to be ordered, with what its factor would take, roughly.
fn check_room_to_order(problem: &ContactProblem, settings: &Settings) -> Result<(), Error> {
    match check_memory(problem, Kept::Nothing, settings) {
        Err(Error::TooLarge { dofs, stiffness_entries, bytes, allowed, .. }) => {
            let estimate = Estimate::of(problem);
            let factors = if settings.condense == Condense::Never { super::estimate::FACTORS } else { 1.0 };
            let bytes = bytes + factors * crate::qp::memory::of_factor(estimate.factor_entries, size_of::<f64>());
            Err(Error::TooLarge { dofs, stiffness_entries, factor_entries: estimate.factor_entries, bytes, allowed })
        }
        checked => checked,
    }
}

/// Of two refusals the one that asks for less memory.
fn lesser(one: Error, other: Error) -> Error {
    match (&one, &other) {
        (Error::TooLarge { bytes: few, .. }, Error::TooLarge { bytes: many, .. }) if few > many => other,
        _ => one,
    }
}
