//! The layout of a factor: its arrangement, and the parts that are kept, within memory and time.

use super::attempt::{Arrangement, WithFactor};
use super::rules::{Size, is_crowded};
use crate::certificate::EnergyNorm;
use crate::cost::{Estimate, FACTORS, Kept, bytes, check_memory, check_time, seconds};
use crate::error::Error;
use crate::linear::Analysis;
use crate::problem::ContactProblem;
use crate::settings::{ByFactor, Method, Settings};
use crate::transform::{Condensation, Scaling};

/// An order of elimination with its structure, and its kept parts.
pub(crate) struct Layout {
    pub analysis: Analysis,
    /// The dofs that are eliminated last.
    pub last: Vec<usize>,
    pub size: Size,
    pub method: ByFactor,
    /// `true` if the factor of the stiffness is kept beside those of the contact sets; if not, it is computed again for
    /// the certificate.
    pub keeps_norm: bool,
}

impl Layout {
    /// The first layout that fits into the memory of `settings`, with the first arrangement that does.
    ///
    /// # Errors
    /// [`Error::TooLarge`] with the least memory that a layout needs, [`Error::OutOfTime`], [`Error::Interrupted`].
    pub fn within(
        problem: &ContactProblem,
        scaling: &Scaling,
        with: &WithFactor,
        settings: &Settings,
    ) -> Result<Self, Error> {
        check_room_to_order(problem, with, settings)?;
        let mut refused: Option<Error> = None;
        for arrangement in with.arrangements {
            check_time(&settings.watch, seconds::ordering(problem))?;
            if settings.watch.acknowledge() {
                return Err(Error::Interrupted);
            }
            let (last, dense) = match arrangement {
                Arrangement::Condensed => {
                    let last = scaling.contact.columns_with_entries();
                    let dense = Kept::dense(last.len());
                    (last, dense)
                }
                Arrangement::RowsLast => {
                    let last = EnergyNorm::last_dofs(problem.stiffness(), &scaling.contact);
                    let boundary = Kept::boundary(last.len());
                    if last.is_empty() { continue } else { (last, boundary) }
                }
                Arrangement::AnyOrder => (Vec::new(), Kept::Nothing),
            };
            // The dense matrices on the boundary alone may be too large: the analysis would then waste memory.
            if let Err(error) = check_memory(problem, dense, settings.memory) {
                keep_least(&mut refused, error);
                continue;
            }
            let is_condensed = *arrangement == Arrangement::Condensed;
            let analysis = match is_condensed {
                true => Condensation::analyse(problem.stiffness(), &last)?,
                false => Some(Analysis::with_last(problem.stiffness(), &last)?),
            };
            let Some(analysis) = analysis else { continue };
            let analysis = analysis.with_threads(settings.threads.unwrap_or(1));
            let (multiplications, rows) = (analysis.multiplications(), problem.rows());
            let size = Size { is_condensed, multiplications, rows, is_crowded: is_crowded(problem) };
            let layout = Layout { analysis, last, size, method: with.chosen(size), keeps_norm: true };
            match layout.fitting(problem, with, settings) {
                Err(error @ Error::TooLarge { .. }) => keep_least(&mut refused, error),
                decided => return decided,
            }
        }
        Err(refused.unwrap_or(Error::Interrupted))
    }

    /// The layout with the method and the parts that fit into memory and time.
    fn fitting(mut self, problem: &ContactProblem, with: &WithFactor, settings: &Settings) -> Result<Self, Error> {
        let mut choices = vec![(self.method, true)];
        // The chosen method may take more memory than available, or too much time before its first step.
        if with.method.is_none() && self.method != ByFactor::ActiveSet {
            choices.push((ByFactor::ActiveSet, true));
        }
        if !self.size.is_condensed && self.last.is_empty() && with.method == Some(ByFactor::ActiveSet) {
            choices.push((ByFactor::ActiveSet, false));
        }
        let mut refused: Option<Error> = None;
        for choice in choices {
            (self.method, self.keeps_norm) = choice;
            let fits = check_memory(problem, self.kept(), settings.memory)
                .and_then(|()| check_time(&settings.watch, self.seconds()));
            match fits {
                Ok(()) => return Ok(self),
                Err(error) => keep_least(&mut refused, error),
            }
        }
        Err(refused.unwrap_or(Error::Interrupted))
    }

    fn kept(&self) -> Kept {
        let (values, last) = (self.analysis.factor_entries(), self.last.len());
        let by_interior_point = self.is_by_interior_point();
        match (self.size.is_condensed, self.keeps_norm) {
            (true, _) => Kept::Condensed { values, contact_dofs: last, by_interior_point },
            (false, true) => Kept::Factors { values, last, by_interior_point },
            (false, false) => Kept::OneFactor { values },
        }
    }

    fn is_by_interior_point(&self) -> bool {
        matches!(self.method, ByFactor::Qp(_))
    }

    /// Method and unknowns in words.
    pub fn in_words(&self) -> String {
        let method = Method::from(self.method).name();
        let (multiplications, entries) = (self.size.multiplications, self.analysis.factor_entries());
        let on = match self.size.is_condensed {
            true => format!("condensed to {} dofs", self.last.len()),
            false => "on all dofs".to_string(),
        };
        format!("{method}, {on}; about {multiplications:.1e} multiplications and {entries:.1e} values")
    }

    /// Seconds until the first set of contact rows is settled, or the first step of the interior point is done.
    fn seconds(&self) -> f64 {
        let first = seconds::factorisation(&self.analysis);
        match (self.size.is_condensed, self.is_by_interior_point()) {
            (true, _) => first + seconds::dense(self.last.len()),
            (false, false) => 2.0 * first,
            (false, true) => first + 2.0 * seconds::interior_point(&self.analysis),
        }
    }
}

/// Refuses a problem that is too large to be ordered, with a rough estimate of its factor.
fn check_room_to_order(problem: &ContactProblem, with: &WithFactor, settings: &Settings) -> Result<(), Error> {
    match check_memory(problem, Kept::Nothing, settings.memory) {
        Err(Error::TooLarge { dofs, stiffness_entries, bytes, allowed, .. }) => {
            let factor_entries = Estimate::of(problem).factor_entries;
            let factor = bytes::of_factor(factor_entries);
            let contact_dofs = problem.contact().columns_with_entries().len() as f64;
            let factors = match with.arrangements.contains(&Arrangement::Condensed) {
                // Instead of large dense matrices one factor after the other is made.
                true => (factor + bytes::of_dense(contact_dofs)).min(bytes::of_next_factor(factor_entries)),
                false => FACTORS * factor,
            };
            Err(Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes: bytes + factors, allowed })
        }
        checked => checked,
    }
}

/// Keeps the refusal with the least required memory, of the earlier ones and a new one.
fn keep_least(refused: &mut Option<Error>, other: Error) {
    match (refused.as_ref(), &other) {
        (Some(Error::TooLarge { bytes: few, .. }), Error::TooLarge { bytes: many, .. }) if few > many => {}
        (Some(_), _) => return,
        (None, _) => {}
    }
    *refused = Some(other);
}
