//! Derivatives of an answer with respect to all data of its problem, and a verdict on whether they exist.
//!
//! With the closed rows C of the exact answer, and as long as every closed row presses and every open row has a gap,
//! the answer is smooth in the data: it is that of a linear system. For a change of the data along a parameter,
//!
//! ```text
//! K du - B_C' dl = r,   B_C du = d,     r = df - dK u + dB_C' lambda_C,   d = dg_C - dB_C u        (tangent)
//! ```
//!
//! and for an output phi(u, lambda) one system with the same matrix serves all parameters,
//!
//! ```text
//! K w - B_C' nu = dphi/du,   B_C w = -dphi/dlambda_C,     dphi = w'r - nu'd                        (adjoint)
//! ```
//!
//! Rows that are *proven* closed press and are independent, rows that are proven open have a gap: then the derivative
//! exists. A row whose gap and force are exactly zero makes a kink, with a derivative on each side. A row that is
//! neither proven nor exactly zero may be either.
//!
//! # Source
//! J. F. Bonnans, A. Shapiro, *Perturbation Analysis of Optimization Problems*, Springer (2000), section 5.2. B. Amos,
//! J. Z. Kolter, *OptNet: differentiable optimization as a layer in neural networks*, ICML (2017), for the adjoint.

mod change;
mod verdict;

pub use change::{Adjoint, Change, Tangent};

use std::sync::Arc;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::certificate::Examination;
use crate::engine::{Engine, factored};
use crate::error::{Error, Result};
use crate::linear::watch::Watch;
use crate::linear::{check_finite, largest};
use crate::method::Start;
use crate::prepared::Prepared;
use crate::problem::ContactProblem;
use crate::run::solved;
use crate::settings::{Method, Settings};
use crate::solution::{ContactSet, Solution};
use verdict::{RowStates, rows_of};

/// A derivative together with the verdict of the proven rows: whether the exact answer is smooth there.
#[derive(Clone, Debug, PartialEq)]
pub enum Derivative<T> {
    /// The derivative: it exists, because every row is proven to be closed and pressing, or open.
    Proven(T),
    /// The derivatives to both sides of a kink: gap and force of some rows are exactly zero in the given doubles.
    OneSided {
        /// The derivative for a falling parameter.
        left: T,
        /// The derivative for a growing parameter.
        right: T,
    },
    /// The proof leaves some rows undecided, or a kink belongs to more than one parameter.
    Undecided {
        /// The derivatives with all of these rows open, and with all of them closed, if both exist. If there are
        /// several rows, the true derivative may belong to another combination of them.
        between: Vec<T>,
        /// Indices of these contact rows, from 0, in increasing order.
        rows: Vec<usize>,
    },
    /// The derivative is not known.
    Unknown {
        /// The reason, in words.
        why: String,
    },
}

impl<T> Derivative<T> {
    /// The same verdict about something that follows from the derivative.
    pub fn map<U>(&self, of: impl Fn(&T) -> U) -> Derivative<U> {
        match self {
            Derivative::Proven(value) => Derivative::Proven(of(value)),
            Derivative::OneSided { left, right } => Derivative::OneSided { left: of(left), right: of(right) },
            Derivative::Undecided { between, rows } => {
                Derivative::Undecided { between: between.iter().map(of).collect(), rows: rows.clone() }
            }
            Derivative::Unknown { why } => Derivative::Unknown { why: why.clone() },
        }
    }

    /// Its value, if the exact answer is known to be smooth; otherwise `None`.
    pub fn proven(&self) -> Option<&T> {
        if let Derivative::Proven(value) = self { Some(value) } else { None }
    }

    /// `proven`, `one-sided`, `undecided` or `unknown`.
    pub fn verdict(&self) -> &'static str {
        match self {
            Derivative::Proven(_) => "proven",
            Derivative::OneSided { .. } => "one-sided",
            Derivative::Undecided { .. } => "undecided",
            Derivative::Unknown { .. } => "unknown",
        }
    }
}

impl<T> Derivative<Result<T, String>> {
    /// The same, unknown for the first reason that there is.
    pub fn transposed(self) -> Derivative<T> {
        let found = match self {
            Derivative::Proven(value) => value.map(Derivative::Proven),
            Derivative::OneSided { left, right } => {
                left.and_then(|left| Ok(Derivative::OneSided { left, right: right? }))
            }
            Derivative::Undecided { between, rows } => {
                let between = between.into_iter().collect::<Result<_, _>>();
                between.map(|between| Derivative::Undecided { between, rows })
            }
            Derivative::Unknown { why } => Err(why),
        };
        found.unwrap_or_else(|why| Derivative::Unknown { why })
    }
}

/// An object with its `verdict`, and `value`; `left` and `right`; `between` and `rows`; or `why`.
impl<T: Serialize> Serialize for Derivative<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_map(None)?;
        object.serialize_entry("verdict", self.verdict())?;
        match self {
            Derivative::Proven(value) => object.serialize_entry("value", value)?,
            Derivative::OneSided { left, right } => {
                object.serialize_entry("left", left)?;
                object.serialize_entry("right", right)?;
            }
            Derivative::Undecided { between, rows } => {
                object.serialize_entry("between", between)?;
                object.serialize_entry("rows", rows)?;
            }
            Derivative::Unknown { why } => object.serialize_entry("why", why)?,
        }
        object.end()
    }
}

/// The derivatives of an answer: each costs one solve with the factor, or the hierarchy, that the answer had.
///
/// ```
/// use signorini_qp::{Change, ContactProblem, Derivative, Prepared, Settings, SparseMatrix, SymmetricMatrix};
///
/// // A spring of stiffness 2, pushed with force 3 towards a wall at 1: the wall takes 3 - 2 x 1 = 1.
/// let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
/// let problem = ContactProblem::new(SymmetricMatrix::of_diagonal(vec![2.0]), vec![3.0], one(1.0)?, vec![1.0])?;
/// let prepared = Prepared::new(&problem, &Settings::default())?;
///
/// // The force on the wall, -lambda, falls by 2 for each unit of gap, grows with the load, and falls with the stiffness.
/// let derivatives = prepared.derivatives(&prepared.solve(&[1.0])?)?;
/// let force = derivatives.adjoint(&[0.0], &[-1.0])?;
/// let Derivative::Proven(force) = force else { panic!() };
/// assert_eq!((force.of_gap(), force.of_load()), (vec![-2.0], &[1.0][..]));
/// assert_eq!(force.of_stiffness(&problem)?.triplets().collect::<Vec<_>>(), [(0, 0, -1.0)]);
///
/// // Under a force of 2 the spring just touches: a kink. The wall takes any more force, and the spring any less.
/// let touching = prepared.with_load(vec![2.0])?;
/// let derivatives = touching.derivatives(&touching.solve(&[1.0])?)?;
/// let Derivative::OneSided { left, right } = derivatives.tangent(&Change::of_load(vec![1.0], 1))? else { panic!() };
/// assert_eq!((left.displacement, left.multiplier), (vec![0.5], vec![0.0]));
/// assert_eq!((right.displacement, right.multiplier), (vec![0.0], vec![-1.0]));
/// # Ok::<(), signorini_qp::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Derivatives {
    problem: ContactProblem,
    engine: Engine,
    settings: Settings,
    /// The displacement u of the answer, length n, and its multipliers, of the rows of B and of the equality rows.
    answer: [Vec<f64>; 2],
    /// The rows of the exact answer, or why nothing is known.
    rows: Result<RowStates, &'static str>,
}

impl Derivatives {
    /// The rows that are proven, or known exactly, to press; `None` if nothing is known.
    pub fn closed(&self) -> Option<ContactSet> {
        self.rows.as_ref().ok().map(|rows| self.problem.of_inequalities(&rows.closed))
    }

    /// The rows that are at a kink, or undecided, from 0; empty if every row is decided, or nothing is known.
    pub fn at_kink(&self) -> &[usize] {
        self.rows.as_ref().map_or(&[], |rows| &rows.weak)
    }

    /// The reason, in words, if nothing is known about the rows.
    pub fn why_unknown(&self) -> Option<&str> {
        self.rows.as_ref().err().copied()
    }

    /// The same under a watch that can stop the solves of its derivatives.
    pub fn watched(&self, watch: &Watch) -> Self {
        Derivatives { settings: self.settings.clone().watched(watch), ..self.clone() }
    }

    /// The adjoint solution of an output with these derivatives with respect to the displacement u (length n) and to
    /// the multiplier lambda (length m, then one for each equality row), in the unit of the output over that of length,
    /// and of force. At a kink the gradient does not exist: it is undecided between both sides, and only
    /// [`tangent`](Self::tangent) tells them apart.
    ///
    /// # Errors
    /// `LinearError::Length` and `LinearError::NotFinite` for vectors that do not fit; `LinearError::Numerical`
    /// and [`Error::Interrupted`] of the solve.
    pub fn adjoint(&self, by_displacement: &[f64], by_multiplier: &[f64]) -> Result<Derivative<Adjoint>, Error> {
        let (problem, rows) = (&self.problem, self.given_rows());
        check_finite("derivative by displacement", by_displacement, (problem.dofs(), "dofs"))?;
        check_finite("derivative by multiplier", by_multiplier, (rows, "contact and equality rows"))?;
        let distances: Vec<f64> = self.on_first_rows(by_multiplier).iter().map(|value| 0.0 - value).collect();
        let of = |closed: &ContactSet| {
            let found = self.held(closed, by_displacement, &distances)?;
            Ok(found.map(|Tangent { displacement, multiplier, error }| Adjoint {
                displacement,
                multiplier,
                answer: self.answer.clone(),
                inequalities: problem.inequalities(),
                error,
            }))
        };
        self.by_linear_system(of)
    }

    /// The derivatives of displacement and multipliers along a change of the data.
    ///
    /// # Errors
    /// As [`Derivatives::adjoint`], and those of [`solve`](crate::solve()) for the small contact problem at a kink.
    pub fn tangent(&self, change: &Change) -> Result<Derivative<Tangent>, Error> {
        change.check(self.problem.dofs(), self.given_rows())?;
        let distances = self.on_first_rows(&change.distance);
        if let Ok(rows) = &self.rows
            && rows.is_kink
        {
            let side = |sign: f64| self.one_sided(rows, &change.times(sign));
            if let (Some(left), Some(right)) = (side(-1.0)?, side(1.0)?) {
                return Ok(Derivative::OneSided { left: left.times(-1.0), right });
            }
        }
        self.by_linear_system(|closed| self.held(closed, &change.load, &distances))
    }

    /// What one linear system gives: at a kink, and for undecided rows, with all of them open, and with all closed.
    fn by_linear_system<T>(&self, of: impl Fn(&ContactSet) -> Result<Option<T>>) -> Result<Derivative<T>> {
        let RowStates { closed, weak, .. } = match &self.rows {
            Ok(rows) => rows,
            Err(why) => return Ok(Derivative::Unknown { why: why.to_string() }),
        };
        let mut all = closed.clone();
        weak.iter().for_each(|&row| all.insert(row));
        let sets = if weak.is_empty() { vec![closed] } else { vec![closed, &all] };
        let mut found = sets.into_iter().filter_map(|set| of(set).transpose()).collect::<Result<Vec<T>>>()?;
        Ok(match found.pop() {
            None => Derivative::Unknown { why: NOT_HELD.to_string() },
            Some(only) if weak.is_empty() => Derivative::Proven(only),
            Some(last) => {
                found.push(last);
                Derivative::Undecided { between: found, rows: weak.clone() }
            }
        })
    }

    /// The tangent at a kink: a contact problem of the weak rows, others held. `None` if its set is not confirmed.
    fn one_sided(&self, rows: &RowStates, change: &Change) -> Result<Option<Tangent>> {
        let (problem, RowStates { closed, weak, .. }) = (&self.problem, rows);
        let distances = self.on_first_rows(&change.distance);
        let held: Vec<usize> = closed.iter().collect();
        let small = problem.with_held(change.load.clone(), [weak, &held], &distances)?;
        let Settings { watch, memory, threads, .. } = self.settings.clone();
        let settings = Settings { watch, memory, threads, ..Settings::default() };
        let found = solved(&small, &Start::default(), &settings)?;
        // The linear system of the set that was found gives the digits; the signs of its answer confirm the set.
        let mut set = closed.clone();
        found.contact_set.iter().for_each(|place| set.insert(weak[place]));
        let Some(exact) = self.held(&set, &change.load, &distances)? else { return Ok(None) };
        let (moved, forces) = (problem.contact().mul(&exact.displacement), largest(&exact.multiplier));
        let lengths = largest(&moved).max(largest(&distances));
        let is_met = |&row: &usize| match set.contains(row) {
            true => exact.multiplier[row] <= SIGN_TOLERANCE * forces,
            false => moved[row] - distances[row] <= SIGN_TOLERANCE * lengths,
        };
        Ok(weak.iter().all(is_met).then_some(exact))
    }

    /// `K x - B_C' y = force`, `B_C x = distances` on the rows of `closed`: with a factor, corrected by residuals in
    /// twice the precision. `None` if the rows do not hold the body, or follow from each other.
    fn held(&self, closed: &ContactSet, force: &[f64], distances: &[f64]) -> Result<Option<Tangent>> {
        let watch = &self.settings.watch;
        let is_exact = self.engine.hierarchy().is_none();
        // Open rows have no part in the system; their distances only must fit the pattern of infinite gaps.
        let distance = |row: usize| if closed.contains(row) { distances[row] } else { 0.0 };
        let gap: Vec<f64> = (0..self.problem.rows()).map(distance).collect();
        let linear = self.problem.with(force.to_vec(), gap)?;
        let Some([mut x, mut y]) = self.engine.held(closed, linear.load(), linear.gap(), watch)? else {
            return Ok(None);
        };
        let mut error = f64::INFINITY;
        for _ in 0..if is_exact { MOST_CORRECTIONS } else { 0 } {
            if watch.is_over() {
                return Err(Error::Interrupted);
            }
            let rest = linear.accurate_residual(&x, &y);
            let missing: Vec<f64> = linear.accurate_violation(&x).iter().map(|violation| -violation).collect();
            let Some([dx, dy]) = self.engine.held(closed, &rest, &missing, watch)? else { return Ok(None) };
            let step = relative(&dx, &x).max(relative(&dy, &y));
            if step > 0.5 * error {
                break;
            }
            x.iter_mut().zip(dx).for_each(|(x, dx)| *x += dx);
            y.iter_mut().zip(dy).for_each(|(y, dy)| *y += dy);
            error = step;
            if step <= ENOUGH {
                break;
            }
        }
        if !is_exact {
            // The relative bound on the error in the energy norm by the hierarchy.
            let rows: Vec<usize> = closed.iter().collect();
            let on_rows: Vec<f64> = rows.iter().map(|&row| y[row]).collect();
            let linear = self.problem.with_held(force.to_vec(), [&[], &rows], distances)?;
            let by = self.engine.bounding(watch);
            let examined = Examination::of(&linear, [&x, &on_rows], &by)?.certificate()?;
            error = examined.certificate.energy_error_bound;
        }
        Ok(Some(Tangent { displacement: x, multiplier: self.problem.split(y).concat(), error }))
    }

    fn given_rows(&self) -> usize {
        self.problem.inequalities() + self.problem.equality_rows()
    }

    /// Values of the rows as given, for all rows of the problem: an equality is held by the first of its two rows.
    fn on_first_rows(&self, given: &[f64]) -> Vec<f64> {
        let mut values = given.to_vec();
        values.resize(self.problem.rows(), 0.0);
        values
    }
}

fn relative(step: &[f64], of: &[f64]) -> f64 {
    let (step, size) = (largest(step), largest(of));
    if step == 0.0 { 0.0 } else { step / size }
}

/// Corrections of a solution by its own residual, at most.
const MOST_CORRECTIONS: usize = 8;

/// A correction below this, relative, is the last: the next one would be about its square.
const ENOUGH: f64 = 1e-9;

/// Signs that are wrong by less than this, relative to the largest force or length, are rounding.
const SIGN_TOLERANCE: f64 = 1e-10;

/// The reason if the rows that press do not determine a linear system.
const NOT_HELD: &str = "the rows that press do not hold the body, or follow from each other";

impl Prepared {
    /// The derivatives of an answer of this problem, under the current load, and at the gaps of the problem that was
    /// prepared or of [`with_gap`](Self::with_gap). If the answer brings no proof of its rows, they are proven here.
    ///
    /// # Errors
    /// `LinearError::Length` for an answer that does not fit, and those of the proof.
    pub fn derivatives(&self, solution: &Solution) -> Result<Derivatives, Error> {
        let (problem, settings) = (&self.problem, self.settings.started()?);
        let engine = match &self.bench {
            Some(bench) => bench.engine.clone(),
            None => Engine::Factor(Arc::new(factored(problem, &settings.clone().by_rules())?)),
        };
        let given = [solution.multiplier.as_slice(), &solution.equality_multiplier].concat();
        let (displacement, multiplier) = (solution.displacement.clone(), problem.of_all_rows(&given).into_owned());
        let rows = rows_of(problem, &engine, solution, [&displacement, &multiplier], &settings.watch)?;
        let answer = [displacement, problem.split(multiplier).concat()];
        Ok(Derivatives { problem: problem.clone(), engine, settings, answer, rows })
    }
}

pub fn derivatives(problem: &ContactProblem, solution: &Solution, settings: &Settings) -> Result<Derivatives> {
    // A derivative takes the method of its answer.
    let method = if solution.method.starts_with("mprgp") { Method::Mprgp } else { Method::ActiveSet };
    Prepared::new(problem, &settings.clone().by(method))?.derivatives(solution)
}
