//! All decisions of a solve.
//!
//! [`Method::Auto`] decides in this order:
//!
//! 0. **Pieces** ([`pieces_of`]): uncoupled parts are solved separately, several small ones together.
//! 1. **Factor or multigrid** (`Estimate::choose`; for many gaps [`method_for`]): multigrid if the direct path is estimated to take
//!    [`CLEARLY`] times as long, or does not fit into the memory; else the direct path. If that turns out to be too large or
//!    too slow, multigrid; if multigrid falls short, or takes as long as a factor would, the direct path if it fits.
//! 2. **The layout of the factor** ([`Layout::within`]): condensed onto the contact dofs if that pays; else all dofs with the
//!    contact boundary last, which makes bounds and proofs cheap; else all dofs. The first that fits into memory and time.
//! 3. **The way on that layout** ([`Way::chosen`]): method and precision, by rules that were fitted to measured times.
//! 4. **The first contact set** ([`starts_by_multigrid`]): from a few cycles of multigrid if contact is everywhere, else none.
//! 5. **The retry after an answer that falls short** ([`safer`]): a shortcut is replaced by the active set in double precision, a
//!    condensed problem by all dofs.
//!
//! Within a method the fallbacks are fixed and do not depend on cost: sets that do not settle within [`PATIENCE`] continue from a
//! penalty ladder, then by the dual active-set method ([`takes_last_resort`]); an answer with a factor that falls short is corrected
//! and repaired (`engine/answer`).

use super::certificate::EnergyNorm;
pub(super) use super::cost::fitted::Way;
use super::cost::fitted::{STEPS, Step};
use super::cost::{Estimate, FACTORS, Kept, Smooth, bytes, check_memory, check_time, seconds, starts_near};
use super::linear::{Analysis, Width};
use super::method::Start;
use super::method::interior_point::InteriorPoint;
use super::method::penalty::Penalty;
use super::problem::ContactProblem;
use super::settings::{Condense, Method, Precision, Settings};
use super::transform::{Condensation, Pieces, Scaling};
use crate::error::{Error, memory as written};
use crate::solution::{Certificate, Expected, Why};

/// The direct path is exact and its bound proven: multigrid replaces it only if the direct path takes this many times as long.
const CLEARLY: f64 = 1.15;

/// The name of the methods with a factor in the comparison with multigrid.
const WITH_FACTOR: &str = "factor";

/// Cycles allowed beyond those that take the time of a factorisation: the answer may be near.
const MARGIN: usize = 10;

/// An estimate may be too large by this factor.
const UNSURE: f64 = 2.0;

/// The chosen path, with the reason.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Choice {
    /// The direct path.
    Factor { reason: String },
    /// Multigrid: it is much faster, unless it takes more cycles than this.
    Speed { reason: String, most_cycles: usize },
    /// Multigrid: nothing else fits into the memory.
    Room { reason: String },
}

impl Estimate {
    /// Returns `true` if multigrid is chosen: much faster, or the only path within `most_bytes`.
    pub fn prefers_multigrid(&self, most_bytes: f64) -> bool {
        !matches!(self.choose(most_bytes), Ok(Choice::Factor { .. }) | Err(_))
    }

    /// The path to take within `most_bytes`. If a factor is not clearly too large, only its analysis decides whether it fits.
    ///
    /// # Errors
    /// [`Error::NoRoom`] if neither fits.
    pub(super) fn choose(&self, most_bytes: f64) -> Result<Choice, Error> {
        let ratio = self.direct_seconds / self.multigrid_seconds;
        let fits = self.direct_bytes <= most_bytes;
        // For a body, constants alone give a poor hierarchy.
        if ratio > CLEARLY && self.smooth != Smooth::Unknown && self.multigrid_bytes <= most_bytes {
            let reason = format!("by multigrid: a factorisation would take about {ratio:.0} times as long");
            // After this number of cycles a factorisation would have been as fast.
            let most_cycles = if fits { MARGIN + (self.cycles * ratio) as usize } else { usize::MAX };
            return Ok(Choice::Speed { reason, most_cycles });
        }
        if self.direct_bytes > UNSURE * most_bytes {
            return self.without_factor(self.direct_bytes, most_bytes).map(|reason| Choice::Room { reason });
        }
        let slower = 1.0 / ratio;
        let reason = match self.smooth {
            Smooth::Unknown => {
                "with a factor: multigrid has no near-null space, which names the motions of almost no energy"
                    .to_string()
            }
            _ if self.multigrid_bytes > most_bytes => {
                let [of_multigrid, allowed] = [self.multigrid_bytes, most_bytes].map(written);
                format!("with a factor: multigrid would take about {of_multigrid}, {allowed} are allowed")
            }
            _ if slower > 1.0 => format!("with a factor: multigrid would take about {slower:.1} times as long"),
            _ => format!("with a factor: its bound is proven, and multigrid is not {CLEARLY} times as fast"),
        };
        Ok(Choice::Factor { reason })
    }

    /// The estimates behind a choice, and its reason.
    pub(super) fn why(&self, choice: &Choice) -> Why {
        let mprgp = Method::Mprgp.name();
        let (chosen, reason) = match choice {
            Choice::Factor { reason } => (WITH_FACTOR, reason),
            Choice::Speed { reason, .. } | Choice::Room { reason } => (mprgp, reason),
        };
        let expected = |method: &str, seconds, bytes| Expected { method: method.to_string(), seconds, bytes };
        let considered = vec![
            expected(WITH_FACTOR, self.direct_seconds, self.direct_bytes),
            expected(mprgp, self.multigrid_seconds, self.multigrid_bytes),
        ];
        Why { chosen: chosen.to_string(), reason: reason.clone(), considered }
    }

    /// The same for each of many gaps; all gaps share the first factor, and the hierarchy.
    fn of_many(self, gaps: usize) -> Self {
        let rest = 1.0 - 1.0 / gaps.max(1) as f64;
        Estimate {
            direct_seconds: self.direct_seconds - rest * self.shared_seconds,
            multigrid_seconds: self.multigrid_seconds - rest * self.hierarchy_seconds,
            ..self
        }
    }

    /// The reason for multigrid if a solve with a factor takes `factor` bytes, which is too much.
    ///
    /// # Errors
    /// [`Error::NoRoom`] if multigrid takes too much as well.
    pub(super) fn without_factor(&self, factor: f64, most_bytes: f64) -> Result<String, Error> {
        let multigrid = self.multigrid_bytes;
        if multigrid > most_bytes {
            return Err(Error::NoRoom { factor, multigrid, allowed: most_bytes, ended: None });
        }
        let [of_multigrid, of_factor, allowed] = [multigrid, factor, most_bytes].map(written);
        Ok(format!(
            "by multigrid, of about {of_multigrid}: with a factor it would take about {of_factor}, {allowed} are allowed"
        ))
    }
}

/// The method for this number of gaps of `problem`, if the choice is left to the program, and the reason.
pub(super) fn method_for(problem: &ContactProblem, gaps: usize, settings: &Settings) -> (Method, Option<Why>) {
    if settings.method != Method::Auto {
        return (settings.method, Some(by_name(settings.method)));
    }
    let estimate = Estimate::of(problem).of_many(gaps);
    // If neither path fits, the preparation says so.
    let Ok(choice) = estimate.choose(settings.memory.unwrap_or(f64::INFINITY)) else { return (Method::Auto, None) };
    let why = Some(estimate.why(&choice));
    match choice {
        Choice::Speed { .. } | Choice::Room { .. } => (Method::Mprgp, why),
        Choice::Factor { .. } => (Method::Auto, why),
    }
}

/// Returns `true` if the energy bound of an answer from elsewhere comes from a factor of the stiffness, `false` if from multigrid. A
/// factor gives a proven bound; it is taken if it fits into the memory and is estimated to take at most this number of seconds.
///
/// # Errors
/// [`Error::NoRoom`] if neither fits into the memory.
#[cfg(feature = "cli")]
pub(super) fn is_bounded_by_factor(problem: &ContactProblem, seconds: f64, settings: &Settings) -> Result<bool, Error> {
    let (estimate, memory) = (Estimate::of(problem), settings.memory.unwrap_or(f64::INFINITY));
    if estimate.direct_bytes > memory {
        return estimate.without_factor(estimate.direct_bytes, memory).map(|_| false);
    }
    Ok(estimate.shared_seconds <= seconds || estimate.multigrid_bytes > memory)
}

/// The reason for a method that the user chose.
pub(super) fn by_name(method: Method) -> Why {
    let reason = format!("by {}: it was requested", method.name());
    Why { chosen: method.name().to_string(), reason, considered: Vec::new() }
}

/// A piece has at least this number of unknowns, if all parts together have twice as many: smaller parts are solved faster together.
const PIECE: usize = 2000;

/// The pieces to solve separately; `None` if the problem is solved as one.
pub(super) fn pieces_of(problem: &ContactProblem, settings: &Settings) -> Option<Pieces> {
    let is_free = matches!(settings.method, Method::Auto | Method::ActiveSet);
    let parts = problem.parts();
    if !is_free || parts.count() == 1 || problem.dofs() < 2 * PIECE || !parts.are_apart(problem.stiffness()) {
        return None;
    }
    let (mut of_part, mut count, mut dofs) = (Vec::with_capacity(parts.count()), 0, 0);
    let mut left = problem.dofs();
    for of_this in parts.sums(|_| 1.0) {
        of_part.push(count);
        (dofs, left) = (dofs + of_this as usize, left - of_this as usize);
        if dofs >= PIECE && left >= PIECE {
            (count, dofs) = (count + 1, 0);
        }
    }
    let of_dof = parts.of_dofs().iter().map(|&part| of_part[part]).collect();
    (count > 0).then(|| Pieces::of(problem, of_dof, count + 1))
}

/// Returns `true` if the direct path starts from a few cycles of multigrid.
pub(super) fn starts_by_multigrid(problem: &ContactProblem, settings: &Settings) -> bool {
    matches!(settings.method, Method::Auto | Method::ActiveSet) && starts_near(problem)
}

/// The interior point aims at this share of the requested accuracy.
const INTERIOR_POINT_SHARE: f64 = 0.1;

/// A factor with fewer multiplications for each row belongs to a chain. Along a chain of more than [`LONG`] rows a front of closed
/// rows takes hundreds of sets; the interior point takes some twenty steps.
const CHAIN: f64 = 200.0;

/// Rows of a long chain.
const LONG: usize = 1000;

/// The penalty of the single rung that should reach an accuracy: this number divided by the accuracy.
const PENALTY_OVER_ACCURACY: f64 = 100.0;

impl Way {
    /// The way for the method, accuracy and precision of `settings`; `None` if these leave no choice.
    pub fn chosen(settings: &Settings, unknowns: Unknowns, multiplications: f64, rows: usize) -> Option<Way> {
        if settings.method != Method::Auto {
            return None;
        }
        let accuracy = settings.accuracy.unwrap_or(0.0);
        let condensed = unknowns == Unknowns::ContactDofs;
        let size = if condensed { multiplications } else { multiplications / rows.max(1) as f64 };
        let covers = |step: &&Step| step.condensed == condensed && step.accuracy <= accuracy && size <= step.up_to;
        let nearest = |a: &&Step, b: &&Step| b.accuracy.total_cmp(&a.accuracy).then(a.up_to.total_cmp(&b.up_to));
        let step = STEPS.iter().filter(covers).min_by(nearest);
        let is_long_chain = !condensed && rows > LONG && size < CHAIN;
        let way = match step.map_or(Way::ActiveSet, |step| step.way) {
            Way::ActiveSet if is_long_chain => Way::Qp,
            way => way,
        };
        Some(match (way, settings.precision) {
            (Way::ActiveSetMixed, Precision::Double) => Way::ActiveSet,
            (Way::ActiveSet, Precision::Mixed) => Way::ActiveSetMixed,
            _ => way,
        })
    }

    /// `settings` with this way.
    pub fn settings(self, settings: &Settings) -> Settings {
        let (method, precision) = match (self, settings.accuracy) {
            (Way::ActiveSet, _) => (Method::ActiveSet, Precision::Double),
            (Way::ActiveSetMixed, _) => (Method::ActiveSet, Precision::Mixed),
            (Way::QpUnpolished, Some(accuracy)) => {
                let loose = InteriorPoint { polish: false, tolerance: INTERIOR_POINT_SHARE * accuracy };
                (Method::Qp(loose), settings.precision)
            }
            (Way::Qp | Way::QpUnpolished, _) => (Method::qp(), settings.precision),
            (Way::PenaltyRung, Some(accuracy)) => {
                let rung = PENALTY_OVER_ACCURACY / accuracy;
                let one = Penalty { first: rung, last: rung, ..Penalty::default() };
                (Method::Penalty(one), settings.precision)
            }
            (Way::Penalty | Way::PenaltyRung, _) => (Method::penalty(), settings.precision),
        };
        Settings { method, precision, ..settings.clone() }
    }
}

/// The unknowns of the methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unknowns {
    /// The stiffness is condensed onto the contact dofs.
    ContactDofs,
    AllDofs,
}

/// An order of elimination with its structure, and its kept parts.
pub(super) struct Layout {
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

/// Iterations of the active-set loop after which its start counts as poor.
pub(super) const PATIENCE: usize = 16;

/// Returns `true` if a method that has not settled is followed by the last resort.
pub(super) fn takes_last_resort(settings: &Settings) -> bool {
    settings.allows_last_resort(f64::INFINITY)
}

/// A tried method, with its number of unknowns if they were fewer than all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tried {
    pub method: Method,
    pub condensed_dofs: Option<usize>,
    /// `true` if the answer may fall short of a goal that a slower way would reach.
    pub is_shortcut: bool,
}

impl Tried {
    /// The chosen method with a factor, in words, if the choice was left to the program.
    pub fn in_words(&self, multiplications: f64) -> String {
        let on = match self.condensed_dofs {
            Some(dofs) => format!("condensed to {dofs} dofs"),
            None => "on all dofs".to_string(),
        };
        let method = self.method.name();
        format!(
            "of such methods {method}, {on}: by rules fitted to measured times, for {multiplications:.1e} multiplications of a factor"
        )
    }

    /// A method on all dofs that is not a shortcut.
    pub fn on_all_dofs(method: Method) -> Self {
        Tried { method, condensed_dofs: None, is_shortcut: false }
    }
}

/// Settings and start that may reach the goal after `tried` fell short. First a shortcut is given up, then the condensation, which
/// loses digits if the contact boundary feels little of the stiffness of the body.
pub(super) fn safer(tried: &Tried, settings: &Settings, fell_short: &Error) -> Option<(Settings, Start)> {
    if settings.watch.is_over() {
        return None;
    }
    let method = if settings.method == Method::Auto { Method::ActiveSet } else { settings.method };
    let safe = Settings { method, precision: Precision::Double, ..settings.clone() };
    if tried.is_shortcut {
        return Some((safe, Start::default()));
    }
    let (miss, start) = match fell_short {
        // An error explained by rounding of the displacement is not a loss of the condensation.
        Error::NotCertified { solution, .. } if is_exact(&solution.certificate, settings) => return None,
        Error::NotCertified { solution, value, .. } if !value.is_nan() => (*value, Start::from(&solution.contact_set)),
        _ => (f64::INFINITY, Start::default()),
    };
    // A choice of the user without a last resort, as a small penalty, falls short on all dofs too.
    let may_gain = tried.condensed_dofs.is_some() && safe.condense == Condense::Auto && safe.allows_last_resort(miss);
    may_gain.then(|| (Settings { condense: Condense::Never, ..safe }, start))
}

/// Returns `true` if the conditions hold and no error bound exceeds the effect of rounding the displacement: the answer can only miss
/// an accuracy beyond that.
fn is_exact(certificate: &Certificate, settings: &Settings) -> bool {
    certificate.conditions_hold(settings.goal().tolerance) && certificate.energy_error_excess == 0.0
}

#[cfg(test)]
mod tests {
    use super::{PIECE, pieces_of};
    use crate::qp::linear::{SparseMatrix, SymmetricMatrix};
    use crate::qp::problem::ContactProblem;
    use crate::qp::settings::{Method, Settings};

    /// Chains of springs, of these lengths.
    fn chains(lengths: &[usize]) -> ContactProblem {
        let dofs = lengths.iter().sum();
        let mut entries = Vec::new();
        let mut first = 0;
        for length in lengths {
            entries.extend((first..first + length).map(|dof| (dof, dof, 2.0)));
            entries.extend((first + 1..first + length).map(|dof| (dof, dof - 1, -1.0)));
            first += length;
        }
        let stiffness = SparseMatrix::from_triplets(dofs, dofs, &entries).and_then(SymmetricMatrix::from_lower);
        let contact = SparseMatrix::from_triplets(1, dofs, &[(0, 0, 1.0)]).unwrap();
        ContactProblem::new(stiffness.unwrap(), vec![1.0; dofs], contact, vec![1.0]).unwrap()
    }

    #[test]
    fn small_parts_make_a_piece_together_and_no_part_is_cut() {
        let count = |lengths: &[usize], method| {
            let pieces = pieces_of(&chains(lengths), &Settings::with_method(method));
            pieces.map_or(1, |pieces| pieces.count())
        };
        assert_eq!(count(&[PIECE, PIECE, 1], Method::Auto), 2, "the last is too small for itself");
        assert_eq!(count(&[10 * PIECE], Method::Auto), 1);
        assert_eq!(count(&[3 * PIECE, 10], Method::Auto), 1);
        assert_eq!(count(&[10; 1000], Method::ActiveSet), 10_000 / PIECE);
        assert_eq!(count(&[PIECE, PIECE], Method::Mprgp), 1, "a hierarchy keeps parts apart by itself");
    }
}
