//! The rows of an exact answer: pressing, with a gap, or neither.

use crate::certificate::{Bounding, Examination, norm_on_equalities};
use crate::engine::Engine;
use crate::error::Result;
use crate::linear::watch::Watch;
use crate::linear::{Dependence, ExactSum, largest};
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, ProvenSet, Solution};

/// Corrections on the way to an answer that is exact in doubles.
const MOST_CORRECTIONS: usize = 4;

/// Forces that are left in an answer that is exact in doubles: rounding of their sums in twice the precision, relative.
const NEARLY: f64 = 1e-25;

/// Values of an answer that may be a zero, relative to the largest. Whether they are is decided exactly.
const DUST: f64 = 1e-20;

/// The rows of the exact answer. Sets are those of all rows of the problem, one row of each equality included.
#[derive(Clone, Debug)]
pub struct RowStates {
    pub closed: ContactSet,
    /// The rows that may be open or closed; all others that do not press have a gap.
    pub weak: Vec<usize>,
    /// `true` if gap and force of the weak rows are exactly zero; closed and weak rows are then independent.
    pub is_kink: bool,
}

/// The rows of the exact answer, from one in doubles with these multipliers of all rows; or why nothing is known.
pub fn rows_of(
    problem: &ContactProblem,
    engine: &Engine,
    solution: &Solution,
    answer: [&Vec<f64>; 2],
    watch: &Watch,
) -> Result<Result<RowStates, &'static str>> {
    problem.check_answer(answer[0], answer[1])?;
    let proven = match &solution.proven {
        Some(proven) => Some(proven.clone()),
        None => proven(problem, engine, answer.map(Vec::as_slice), watch)?,
    };
    let Some(ProvenSet { open, closed }) = proven else {
        return Ok(Err(match problem.free_motions() > 0 {
            true => "contact alone holds the body: no row is proven",
            false => "no bound on the error of the answer is known: no row is proven",
        }));
    };
    let is_undecided = |row: &usize| !open.contains(*row) && !closed.contains(*row);
    let weak: Vec<usize> = (0..problem.inequalities()).filter(is_undecided).collect();
    let closed = problem.with_equality_rows(&closed);
    if weak.is_empty() {
        return Ok(Ok(RowStates { closed, weak, is_kink: false }));
    }
    let sets = [problem.with_equality_rows(&solution.contact_set), closed.clone()];
    let exact = sets.iter().find_map(|set| exact_answer(problem, engine, set, answer, watch));
    let exact = exact.filter(|RowStates { closed, weak, .. }| {
        let active: Vec<usize> = closed.iter().chain(weak.iter().copied()).collect();
        let found = Dependence::of(problem.contact(), &active, || watch.is_over());
        found.is_some_and(|found| found.independent.iter().all(|&is_independent| is_independent))
    });
    Ok(Ok(exact.unwrap_or(RowStates { closed, weak, is_kink: false })))
}

/// The proof by the data of the engine, or by a factor of the certificate.
fn proven(problem: &ContactProblem, engine: &Engine, answer: [&[f64]; 2], watch: &Watch) -> Result<Option<ProvenSet>> {
    // Travels have no bound by the data of an engine.
    if engine.hierarchy().is_none() && !problem.without_stiffness().is_empty() {
        return Examination::of(problem, answer, &Bounding::OwnFactor)?.proof(None);
    }
    let by = engine.bounding(watch);
    let (two_sided, of_rows) = problem.two_sided(answer[1]);
    let evidence = Examination::of(&two_sided, [answer[0], &of_rows], &by)?.certificate()?.evidence;
    // Without a norm at hand there is no factor of the stiffness alone.
    let by_engine = !matches!(by, Bounding::OwnFactor);
    let proven = if by_engine { Examination::of(problem, answer, &by)?.proof(evidence)? } else { None };
    if proven.is_some() || engine.hierarchy().is_some() {
        return Ok(proven);
    }
    // Equalities may hold what the stiffness does not.
    let Some(norm) = norm_on_equalities(problem)? else { return Ok(None) };
    Examination::of(problem, answer, &Bounding::Factor(norm))?.proof(None)
}

/// The closed and the weak rows, if the answer with the rows of `set` held is exact in doubles: all conditions hold
/// without any rounding. The answer is unique, because its error has a bound.
fn exact_answer(
    problem: &ContactProblem,
    engine: &Engine,
    set: &ContactSet,
    answer: [&Vec<f64>; 2],
    watch: &Watch,
) -> Option<RowStates> {
    if engine.hierarchy().is_some() {
        return None;
    }
    // An equality has one row here.
    let (mut u, mut lambda) = (answer[0].clone(), problem.split(answer[1].clone()).concat());
    lambda.resize(problem.rows(), 0.0);
    ((0..problem.rows()).filter(|&row| !set.contains(row))).for_each(|row| lambda[row] = 0.0);
    let size = largest(&problem.contact().mul_transposed(&lambda)).max(largest(problem.load()));
    for _ in 0..MOST_CORRECTIONS {
        let rest = problem.accurate_residual(&u, &lambda);
        if largest(&rest) <= NEARLY * size {
            // A zero of the exact answer is approached, but never met.
            let found = exact_rows(problem, &u, &lambda);
            return found.or_else(|| exact_rows(problem, &without_dust(&u), &without_dust(&lambda)));
        }
        let missing: Vec<f64> = problem.accurate_violation(&u).iter().map(|violation| -violation).collect();
        let [du, dl] = engine.held(set, &rest, &missing, watch).ok()??;
        u.iter_mut().zip(du).for_each(|(u, du)| *u += du);
        lambda.iter_mut().zip(dl).for_each(|(lambda, dl)| *lambda += dl);
    }
    None
}

/// The values with zeros for those that are rounding beside the largest.
fn without_dust(values: &[f64]) -> Vec<f64> {
    let least = DUST * largest(values);
    values.iter().map(|&value| if value.abs() <= least { 0.0 } else { value }).collect()
}

/// The closed and the weak rows of an answer, an equality as its first row of either sign; `None` if it is not exact.
fn exact_rows(problem: &ContactProblem, u: &[f64], lambda: &[f64]) -> Option<RowStates> {
    let mut sums = vec![ExactSum::default(); problem.dofs()];
    for (i, j, stiffness) in problem.stiffness().lower().triplets() {
        sums[i].add_product(stiffness, u[j]);
        if i != j {
            sums[j].add_product(stiffness, u[i]);
        }
    }
    let mut distances = vec![ExactSum::default(); problem.rows()];
    for (row, dof, b) in problem.contact().triplets() {
        sums[dof].add_product(-b, lambda[row]);
        distances[row].add_product(-b, u[dof]);
    }
    for (sum, &load) in sums.iter_mut().zip(problem.load()) {
        sum.add(-load);
        if sum.sign()? != 0 {
            return None;
        }
    }
    let equalities = problem.inequalities()..problem.rows();
    let mut closed = problem.with_equality_rows(&ContactSet::default());
    let mut weak = Vec::new();
    for (row, distance) in distances.iter_mut().enumerate() {
        let gap = problem.gap()[row];
        let sign = match gap.is_finite() {
            true => {
                distance.add(gap);
                distance.sign()?
            }
            false => 1,
        };
        let is_equality = equalities.contains(&row);
        match (sign, lambda[row]) {
            (0, _) if is_equality => {}
            (0, 0.0) => weak.push(row),
            (0, force) if force < 0.0 => closed.insert(row),
            (1, 0.0) if !is_equality => {}
            _ => return None,
        }
    }
    Some(RowStates { closed, is_kink: !weak.is_empty(), weak })
}
