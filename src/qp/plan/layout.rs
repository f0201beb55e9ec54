//! The layout of a factor: its unknowns, its order, its precision, and the parts that are kept, within memory and time.

use super::rules::Way;
use crate::error::Error;
use crate::qp::certificate::EnergyNorm;
use crate::qp::cost::{Estimate, FACTORS, Kept, bytes, check_memory, check_time, seconds};
use crate::qp::linear::{Analysis, Width};
use crate::qp::problem::ContactProblem;
use crate::qp::settings::{Condense, Method, Precision, Settings};
use crate::qp::transform::{Condensation, Scaling};

/// The unknowns of the methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::qp) enum Unknowns {
    /// The stiffness is condensed onto the contact dofs.
    ContactDofs,
    AllDofs,
}

/// An order of elimination with its structure, and its kept parts.
pub(in crate::qp) struct Layout {
    pub analysis: Analysis,
    /// The dofs that are eliminated last.
    pub last: Vec<usize>,
    pub unknowns: Unknowns,
    pub multiplications: f64,
    /// The chosen way, if the choice was left to the program.
    pub way: Option<Way>,
    /// The precision of the factor.
    pub width: Width,
    /// `true` if the factor of the stiffness is kept beside those of the contact sets; if not, it is computed again for the
    /// certificate.
    pub keeps_norm: bool,
}

impl Layout {
    /// The first layout that fits into the memory of `settings`.
    ///
    /// # Errors
    /// [`Error::TooLarge`] with the least memory that a layout needs, [`Error::OutOfTime`], [`Error::Interrupted`].
    pub fn within(problem: &ContactProblem, scaling: &Scaling, settings: &Settings) -> Result<Self, Error> {
        check_room_to_order(problem, settings)?;
        let contact_dofs = Condensation::contact_dofs(scaling.contact());
        let mut refused: Option<Error> = None;
        for number in 0.. {
            check_time(&settings.watch, seconds::ordering(problem))?;
            if settings.watch.acknowledge() {
                return Err(Error::Interrupted);
            }
            let (last, dense) = match number {
                0 if settings.condense == Condense::Never => continue,
                0 => (contact_dofs.clone(), Kept::dense(contact_dofs.len())),
                1 => {
                    let last = EnergyNorm::last_dofs(scaling.contact());
                    let boundary = Kept::boundary(last.len());
                    if last.is_empty() { continue } else { (last, boundary) }
                }
                2 => (Vec::new(), Kept::Nothing),
                _ => break,
            };
            // The dense matrices on the boundary alone may be too large: the analysis would then waste memory.
            if let Err(error) = check_memory(problem, dense, settings) {
                keep_least(&mut refused, error);
                continue;
            }
            let analysis = match number {
                0 => Condensation::analyse(problem.stiffness(), &last)?,
                _ => Some(Analysis::with_last(problem.stiffness(), &last)?),
            };
            let Some(analysis) = analysis else { continue };
            let unknowns = if number == 0 { Unknowns::ContactDofs } else { Unknowns::AllDofs };
            match Self::of(problem, settings, (analysis, last), unknowns) {
                Err(error @ Error::TooLarge { .. }) => keep_least(&mut refused, error),
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
        unknowns: Unknowns,
    ) -> Result<Self, Error> {
        let analysis = analysis.with_threads(settings.threads);
        let multiplications = analysis.multiplications();
        let way = Way::chosen(settings, unknowns, multiplications, problem.rows());
        let is_condensed = unknowns == Unknowns::ContactDofs;
        let precision = way.map_or(settings.precision, |way| way.settings(settings).precision);
        let is_mixed = is_condensed && precision == Precision::Mixed;
        let width = if is_mixed { Width::Single } else { Width::Double };
        let is_last_free = last.is_empty();
        let mut layout = Layout { analysis, last, unknowns, multiplications, way, width, keeps_norm: true };
        let mut choices = vec![(way, width, true)];
        // The fastest way by the rules may take more memory than available, or too much time before its first step.
        if way.is_some() {
            choices.push((Some(Way::ActiveSet), Width::Double, true));
        }
        if way.is_some() && is_condensed && settings.precision != Precision::Double {
            choices.push((Some(Way::ActiveSetMixed), Width::Single, true));
        }
        if !is_condensed && is_last_free && settings.method == Method::ActiveSet {
            choices.push((way, Width::Double, false));
        }
        let mut refused: Option<Error> = None;
        for choice in choices {
            (layout.way, layout.width, layout.keeps_norm) = choice;
            let fits = check_memory(problem, layout.kept(settings), settings)
                .and_then(|()| check_time(&settings.watch, layout.seconds(settings)));
            match fits {
                Ok(()) => return Ok(layout),
                Err(error) => keep_least(&mut refused, error),
            }
        }
        Err(refused.unwrap_or(Error::Interrupted))
    }

    fn kept(&self, settings: &Settings) -> Kept {
        let (values, last) = (self.analysis.factor_entries(), self.last.len());
        let by_interior_point = self.by_interior_point(settings);
        match self.unknowns {
            Unknowns::ContactDofs => {
                Kept::Condensed { values, width: self.width, contact_dofs: last, by_interior_point }
            }
            Unknowns::AllDofs if self.keeps_norm => Kept::Factors { values, last, by_interior_point },
            Unknowns::AllDofs => Kept::OneFactor { values },
        }
    }

    fn by_interior_point(&self, settings: &Settings) -> bool {
        matches!(self.way.map_or(settings.method, |way| way.settings(settings).method), Method::Qp(_))
    }

    /// Method and unknowns in words.
    #[cfg(feature = "cli")]
    pub fn in_words(&self, settings: &Settings) -> String {
        let method = self.way.map_or(settings.method, |way| way.settings(settings).method).name();
        let (multiplications, entries) = (self.multiplications, self.analysis.factor_entries());
        let on = match self.unknowns {
            Unknowns::ContactDofs => format!("condensed to {} dofs", self.last.len()),
            Unknowns::AllDofs => "on all dofs".to_string(),
        };
        format!("{method}, {on}; about {multiplications:.1e} multiplications and {entries:.1e} values")
    }

    /// Seconds until the first set of contact rows is settled, or the first step of the interior point is done.
    fn seconds(&self, settings: &Settings) -> f64 {
        let of = |width| seconds::factor_seconds(self.multiplications, self.analysis.factor_entries(), width);
        let first = of(self.width);
        match (self.unknowns, self.by_interior_point(settings)) {
            (Unknowns::ContactDofs, _) => first + seconds::dense(self.last.len()),
            (Unknowns::AllDofs, false) => first + of(Width::Double),
            (Unknowns::AllDofs, true) => first + 2.0 * seconds::interior_point(&self.analysis),
        }
    }
}

/// Refuses a problem that is too large to be ordered, with a rough estimate of its factor.
fn check_room_to_order(problem: &ContactProblem, settings: &Settings) -> Result<(), Error> {
    match check_memory(problem, Kept::Nothing, settings) {
        Err(Error::TooLarge { dofs, stiffness_entries, bytes, allowed, .. }) => {
            let estimate = Estimate::of(problem);
            let factors = if settings.condense == Condense::Never { FACTORS } else { 1.0 };
            let bytes = bytes + factors * bytes::of_factor(estimate.factor_entries, size_of::<f64>());
            Err(Error::TooLarge { dofs, stiffness_entries, factor_entries: estimate.factor_entries, bytes, allowed })
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
