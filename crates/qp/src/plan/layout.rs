//! The layout of a factor: its arrangement, the method on it, and the parts that are kept, within memory and time; and
//! programs that are nearly linear, with a stiffness of low rank and an answer in a corner of their rows.

use super::attempt::Arrangement;
use super::history::unknowns;
use crate::certificate::EnergyNorm;
use crate::cost::{Estimate, FACTORS, Kept, bytes, check_memory, check_time, seconds};
use crate::error::{Error, Result};
use crate::linear::Analysis;
use crate::problem::ContactProblem;
use crate::settings::{Condense, Method, Settings};
use crate::transform::{Condensation, Scaling};

/// A factor with fewer multiplications for each row belongs to a chain. Along a chain of more than [`LONG`] rows a
/// front of closed rows takes hundreds of sets; the interior point takes some twenty steps.
const CHAIN: f64 = 200.0;

/// Rows of a long chain.
const LONG: usize = 1000;

/// Rows with more entries than this in the mean are no rows of contact, which join a node to the few that face it.
const LONG_ROWS: usize = 8;

/// An order of elimination with its structure, and its kept parts.
pub struct Layout {
    pub analysis: Analysis,
    /// The dofs that are eliminated last.
    pub last: Vec<usize>,
    /// `true` if the stiffness is condensed onto the contact dofs.
    pub is_condensed: bool,
    pub method: Method,
    /// `true` if the factor of the stiffness is kept beside those of sets; if not, the certificate makes it again.
    pub keeps_norm: bool,
}

impl Layout {
    /// The first layout that fits into the memory of `settings`, with the first arrangement that does.
    ///
    /// # Errors
    /// [`Error::TooLarge`] with the least memory that a layout needs, [`Error::OutOfTime`], [`Error::Interrupted`].
    pub fn within(problem: &ContactProblem, scaling: &Scaling, settings: &Settings) -> Result<Self> {
        check_room_to_order(problem, settings)?;
        let mut refused: Option<Error> = None;
        for arrangement in Arrangement::under(settings.condense) {
            check_time(&settings.watch, seconds::ordering(problem))?;
            if settings.watch.acknowledge() {
                return Err(Error::Interrupted);
            }
            let last = match arrangement {
                Arrangement::Condensed => scaling.contact.columns_with_entries(),
                Arrangement::RowsLast => EnergyNorm::last_dofs(problem.stiffness(), &scaling.contact),
                Arrangement::AnyOrder => Vec::new(),
            };
            let (values, count, by_interior_point) = (0, last.len(), false);
            let least = match arrangement {
                Arrangement::Condensed => Kept::Condensed { values, contact_dofs: count, by_interior_point },
                Arrangement::RowsLast if last.is_empty() => continue,
                Arrangement::RowsLast => Kept::Factors { values, last: count, by_interior_point },
                Arrangement::AnyOrder => Kept::Nothing,
            };
            // The dense matrices on the boundary alone may be too large: the analysis would then waste memory.
            if let Err(error) = check_memory(problem, least, settings.memory) {
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
            let method = match settings.method {
                Method::Auto => by_rules(problem, analysis.multiplications(), is_condensed),
                given => given,
            };
            let layout = Layout { analysis, last, is_condensed, method, keeps_norm: true };
            match layout.fitting(problem, settings) {
                Err(error @ Error::TooLarge { .. }) => keep_least(&mut refused, error),
                decided => return decided,
            }
        }
        Err(refused.unwrap_or(Error::Interrupted))
    }

    /// The layout with the method and the parts that fit into memory and time.
    fn fitting(mut self, problem: &ContactProblem, settings: &Settings) -> Result<Self> {
        let mut choices = vec![(self.method, true)];
        // The chosen method may take more memory than available, or too much time before its first step.
        if settings.method == Method::Auto && self.method != Method::ActiveSet {
            choices.push((Method::ActiveSet, true));
        }
        if !self.is_condensed && self.last.is_empty() && settings.method == Method::ActiveSet {
            choices.push((Method::ActiveSet, false));
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
        match (self.is_condensed, self.keeps_norm) {
            (true, _) => Kept::Condensed { values, contact_dofs: last, by_interior_point },
            (false, true) => Kept::Factors { values, last, by_interior_point },
            (false, false) => Kept::OneFactor { values },
        }
    }

    fn is_by_interior_point(&self) -> bool {
        matches!(self.method, Method::Qp(_))
    }

    pub fn in_words(&self) -> String {
        let method = self.method.name();
        let (multiplications, entries) = (self.analysis.multiplications(), self.analysis.factor_entries());
        let on = unknowns(self.is_condensed.then_some(self.last.len()));
        format!("{method}, {on}; about {multiplications:.1e} multiplications and {entries:.1e} values")
    }

    /// Seconds until the first set of contact rows is settled, or the first step of the interior point is done.
    fn seconds(&self) -> f64 {
        let first = seconds::factorisation(&self.analysis);
        match (self.is_condensed, self.is_by_interior_point()) {
            (true, _) => first + seconds::dense(self.last.len()),
            (false, false) => 2.0 * first,
            (false, true) => first + 2.0 * seconds::interior_point(&self.analysis),
        }
    }
}

/// Refuses a problem that is too large to be ordered, with a rough estimate of its factor.
fn check_room_to_order(problem: &ContactProblem, settings: &Settings) -> Result<()> {
    match check_memory(problem, Kept::Nothing, settings.memory) {
        Err(Error::TooLarge { dofs, stiffness_entries, bytes, allowed, .. }) => {
            let factor_entries = Estimate::of(problem).factor_entries;
            let factor = bytes::of_factor(factor_entries);
            let contact_dofs = problem.contact().columns_with_entries().len() as f64;
            let factors = match settings.condense {
                // Instead of large dense matrices one factor after the other is made.
                Condense::Auto => (factor + bytes::of_dense(contact_dofs)).min(bytes::of_next_factor(factor_entries)),
                Condense::Never => FACTORS * factor,
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

/// Returns `true` if most sets of rows that may be closed are dependent, so that the loop of the active set wanders: if
/// a problem has more long rows than dofs in them, or if most of its dofs have no stiffness, as in a linear program.
/// Equalities are closed in every answer, and do not count.
fn is_crowded(problem: &ContactProblem) -> bool {
    let mut bounded: Vec<bool> = problem.gap().iter().map(|gap| gap.is_finite()).collect();
    problem.equalities().iter().flat_map(|pair| [pair.row, pair.opposed]).for_each(|row| bounded[row] = false);
    let of_dof = |dof: usize| problem.contact().column(dof).filter(|&(row, b)| b != 0.0 && bounded[row]);
    let dofs = (0..problem.dofs()).filter(|&dof| of_dof(dof).next().is_some()).count();
    let rows = bounded.iter().filter(|bounded| **bounded).count();
    let has_long_rows = rows > dofs && (0..problem.dofs()).flat_map(of_dof).count() > LONG_ROWS * rows;
    has_long_rows || (rows > 0 && 2 * problem.without_stiffness().len() > problem.dofs())
}

/// The method for a factor of this size: the active set, but where its sets are many.
fn by_rules(problem: &ContactProblem, multiplications: f64, is_condensed: bool) -> Method {
    let rows = problem.rows();
    let is_long_chain = !is_condensed && rows > LONG && multiplications < CHAIN * rows as f64;
    if is_long_chain || is_crowded(problem) { Method::qp() } else { Method::ActiveSet }
}

/// Fewer motions without energy than this are found one by one, and cost little.
const FEW_MOTIONS: usize = 256;

/// A program is nearly linear if the stiffness holds less than one of this many directions.
const ONE_OF: usize = 4;

/// Most unknowns of a program that is looked at: its factor of low rank is dense.
const MOST_UNKNOWNS: usize = 20_000;

/// A pivot below this share of its diagonal entry is rounding.
const NO_PIVOT: f64 = 1e-10;

/// Refuses a nearly linear program: each of its motions without energy would have to be stopped by a row of its own.
pub fn check_rank(problem: &ContactProblem) -> Result<()> {
    // An equality takes a direction away.
    let unknowns = problem.dofs().saturating_sub(problem.equalities().len());
    let most = unknowns.saturating_sub(FEW_MOTIONS).min(unknowns / ONE_OF);
    if most == 0 || unknowns <= FEW_MOTIONS || unknowns > MOST_UNKNOWNS || !is_crowded(problem) {
        return Ok(());
    }
    match rank_within(problem, most) {
        None => Ok(()),
        Some(rank) => Err(Error::NearlyLinear { rank, unknowns }),
    }
}

/// The rank of the stiffness, by a Cholesky factor with the largest pivots; `None` if it is above `most`.
///
/// # Source
/// N. J. Higham, *Analysis of the Cholesky decomposition of a semi-definite matrix*, in *Reliable Numerical
/// Computation*, Oxford University Press (1990) 161-185.
fn rank_within(problem: &ContactProblem, most: usize) -> Option<usize> {
    let (lower, diagonal) = (problem.stiffness().lower(), &problem.diagonal().values);
    let upper = lower.transposed();
    let mut left = diagonal.clone();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    loop {
        let is_pivot = |dof: &usize| left[*dof] > NO_PIVOT * diagonal[*dof];
        let share = |dof: usize| left[dof] / diagonal[dof];
        let Some(pivot) = (0..left.len()).filter(is_pivot).max_by(|&a, &b| share(a).total_cmp(&share(b))) else {
            return Some(columns.len());
        };
        if columns.len() == most {
            return None;
        }
        let mut column = vec![0.0; left.len()];
        lower.column(pivot).chain(upper.column(pivot)).for_each(|(dof, value)| column[dof] = value);
        for earlier in &columns {
            let share = earlier[pivot];
            column.iter_mut().zip(earlier).for_each(|(value, of_earlier)| *value -= share * of_earlier);
        }
        let root = left[pivot].sqrt();
        column.iter_mut().for_each(|value| *value /= root);
        left.iter_mut().zip(&column).for_each(|(left, value)| *left -= value * value);
        left[pivot] = 0.0;
        columns.push(column);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `K = F'F` with F of `rank` rows, and twice as many rows as unknowns, of ten entries each.
    fn program(unknowns: usize, rank: usize) -> ContactProblem {
        let entry = |row: usize, dof: usize| (((row + 1) * (dof + 3) * 7919) % 1009) as f64 / 504.0 - 1.0;
        let of = |i: usize, j: usize| (0..rank).map(|row| entry(row, i) * entry(row, j)).sum::<f64>();
        let stiffness: Vec<_> =
            (0..unknowns).flat_map(|j| (j..unknowns).map(move |i| (i, j))).map(|(i, j)| (i, j, of(i, j))).collect();
        let rows: Vec<_> = (0..2 * unknowns)
            .flat_map(|row| (0..10).map(move |at| (row, (row + 37 * at) % unknowns, 1.0 + at as f64)))
            .collect();
        ContactProblem::of_entries(&stiffness, &vec![1.0; unknowns], &rows, &vec![1.0; 2 * unknowns])
    }

    #[test]
    fn the_rank_of_a_stiffness_is_counted_up_to_a_limit() {
        assert_eq!(rank_within(&program(40, 5), 10), Some(5));
        assert_eq!(rank_within(&program(40, 10), 10), Some(10));
        assert_eq!(rank_within(&program(40, 11), 10), None);
        assert_eq!(rank_within(&ContactProblem::of_entries(&[], &[0.0; 4], &[], &[]), 10), Some(0));
    }

    #[test]
    fn a_large_program_of_low_rank_is_refused_and_a_small_one_and_a_stiff_one_are_not() {
        assert!(check_rank(&program(FEW_MOTIONS, 3)).is_ok());
        assert!(check_rank(&program(400, 3)).unwrap_err().to_string().contains("holds 3 of 400 directions"));
        assert!(check_rank(&program(400, 101)).is_ok());
        // A body of any size with one row for each node.
        let rows: Vec<_> = (0..400).map(|row| (row, row, 1.0)).collect();
        let chain: Vec<_> = (0..400).map(|dof| (dof, dof, 2.0)).collect();
        assert!(check_rank(&ContactProblem::of_entries(&chain, &[0.0; 400], &rows, &[1.0; 400])).is_ok());
    }
}
