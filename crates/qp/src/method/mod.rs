//! The methods: each takes a scaled problem and returns displacement, multiplier, contact set and history.
//!
//! No module here uses the notion of a body: the terms are those of the QP.

pub mod active_set;
mod bounds;
pub mod dual_active_set;
pub mod interior_point;
pub mod mprgp;
pub mod parametric;
pub mod penalty;

use std::cell::{Cell, OnceCell};
use std::time::Instant;

use crate::error::{LinearError, Result};
use crate::linear::watch::Watch;
use crate::linear::{Augmented, Cholesky, Compliance, SymmetricMatrix, if_definite, largest};
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, Iteration, Solution};

/// Earlier knowledge of the answer: nothing, a contact set, a displacement, or both.
///
/// It changes the number of iterations, not the answer. The active-set and the penalty loop start from the contact set,
/// MPRGP from either; the interior-point method of Clarabel has no warm start, but its polish starts from the set.
///
/// ```
/// use signorini_qp::{ContactProblem, Prepared, Settings, SparseMatrix, Start, SymmetricMatrix};
///
/// // A spring of stiffness 2, pushed with force 3 towards a wall at distance 1, then at distance 0.5.
/// let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
/// let problem = ContactProblem::new(SymmetricMatrix::of_diagonal(vec![2.0]), vec![3.0], one(1.0)?, vec![1.0])?;
/// let prepared = Prepared::new(&problem, &Settings::default())?;
/// let first = prepared.solve(&[1.0])?;
///
/// // The contact set of the first answer starts the second solve, in which the wall takes 3 - 2 x 0.5.
/// let start = Start::from(&first.contact_set);
/// assert_eq!(prepared.starting_from(start).solve(&[0.5])?.multiplier, [-2.0]);
/// # Ok::<(), signorini_qp::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Start {
    /// A displacement near the answer, one entry per dof.
    pub(crate) displacement: Option<Vec<f64>>,
    pub(crate) contact_set: Option<ContactSet>,
}

impl Start {
    pub(crate) fn is_unknown(&self) -> bool {
        self.displacement.is_none() && self.contact_set.is_none()
    }

    /// An answer that was found earlier, one entry per dof, in length, and one per row, in force: the rows that press
    /// are closed.
    pub fn earlier(displacement: Vec<f64>, multiplier: &[f64]) -> Self {
        let closed = multiplier.iter().map(|&force| force < 0.0).collect();
        Start { displacement: Some(displacement), contact_set: Some(closed) }
    }

    /// The same for all rows of a problem, from a set of the rows of B.
    pub(crate) fn of_all_rows(&self, problem: &ContactProblem) -> Self {
        let of_all = |set: &ContactSet| match set.rows() == problem.inequalities() {
            true => ContactSet::from_fn(problem.rows(), |row| set.contains(row)),
            false => set.clone(),
        };
        Start { contact_set: self.contact_set.as_ref().map(of_all), ..self.clone() }
    }

    /// Refuses a start that does not fit a problem with this number of dofs and rows, or is not finite.
    pub(crate) fn check(&self, dofs: usize, rows: usize) -> Result<()> {
        let lengths = [
            ("the displacement to start from", self.displacement.as_ref().map(Vec::len), dofs, "dofs"),
            ("the multiplier to start from", self.contact_set.as_ref().map(ContactSet::rows), rows, "contact rows"),
        ];
        for (name, found, expected, of) in lengths {
            if let Some(found) = found.filter(|&found| found != expected) {
                return Err(LinearError::Length { name, found, expected, of }.into());
            }
        }
        let values = self.displacement.iter().flatten();
        if let Some((dof, &value)) = values.enumerate().find(|entry| !entry.1.is_finite()) {
            let (name, at) = ("the displacement to start from", format!("entry {dof}"));
            return Err(LinearError::NotFinite { name, at, value, allowed: "finite" }.into());
        }
        Ok(())
    }

    /// A displacement near the answer, one entry per dof, in the problem's unit of length, along the positive axes.
    pub fn near(displacement: Vec<f64>) -> Self {
        Start { displacement: Some(displacement), contact_set: None }
    }
}

impl From<ContactSet> for Start {
    fn from(contact_set: ContactSet) -> Self {
        Start { displacement: None, contact_set: Some(contact_set) }
    }
}

impl From<&ContactSet> for Start {
    fn from(contact_set: &ContactSet) -> Self {
        contact_set.clone().into()
    }
}

impl From<&Solution> for Start {
    fn from(solution: &Solution) -> Self {
        Start { displacement: Some(solution.displacement.clone()), contact_set: Some(solution.contact_set.clone()) }
    }
}

/// Differences below this, relative to the largest, are rounding: else weakly active rows close and open without end.
pub const SIGN_TOLERANCE: f64 = 1e-12;

/// A scaled problem with its pattern analysed: the input of every method.
#[derive(Debug)]
pub struct ScaledProblem<'a> {
    /// The data, dimensionless and of order one.
    pub problem: &'a ContactProblem,
    /// `true` if the stiffness is definite by itself: it has no modes without energy.
    pub is_definite: bool,
    /// The pattern of its K + B'B.
    pub augmented: &'a Augmented,
    /// The compliance of the rows, to balance forces by; `None` if factors of the augmented matrix cost less.
    pub compliance: Option<&'a Compliance>,
    pub swept_load: OnceCell<Vec<f64>>,
    /// Seconds spent in factorisations so far.
    pub factor_seconds: Cell<f64>,
    /// The watch to which the loops report: they end with the answer so far when it says so.
    pub watch: Watch,
}

impl ScaledProblem<'_> {
    /// The load, swept through the factor of a compliance once for all sets.
    pub fn swept_load(&self, compliance: &Compliance) -> Vec<f64> {
        self.swept_load.get_or_init(|| compliance.swept(self.problem.load())).clone()
    }

    /// The matrix K + shift I + weight B_C' B_C of the closed rows C.
    pub fn matrix(&self, closed: &ContactSet, weight: f64, shift: f64) -> Result<SymmetricMatrix> {
        Ok(self.augmented.matrix()?.matrix(|row| if closed.contains(row) { weight } else { 0.0 }, shift))
    }

    /// The factor of such a matrix; `None` if it is not positive definite.
    pub fn factor(&self, matrix: SymmetricMatrix) -> Result<Option<Cholesky>> {
        let clock = Instant::now();
        let factor = if_definite(self.augmented.matrix()?.factor(matrix));
        self.factor_seconds.set(self.factor_seconds.get() + clock.elapsed().as_secs_f64());
        Ok(factor?)
    }

    /// The start of a loop: C = 0 if K is definite; otherwise all rows are replaced by springs, which hold the body,
    /// and those in compression are closed. `None` if not even all rows together hold the body, or if K is not positive
    /// semidefinite to the largest of the shifts.
    pub fn start(&self) -> Result<Option<ContactSet>> {
        let (rows, nothing_closed) = (self.problem.rows(), ContactSet::open(self.problem.rows()));
        if self.is_definite {
            return Ok(Some(nothing_closed));
        }
        if self.factor(self.matrix(&nothing_closed, 0.0, SHIFTS[SHIFTS.len() - 1])?)?.is_none() {
            return Ok(None);
        }
        let Some(cholesky) = self.hold(&ContactSet::closed(rows), 1.0)? else { return Ok(None) };
        let pull = self.problem.contact().mul_transposed(self.problem.gap());
        let force: Vec<f64> = self.problem.load().iter().zip(&pull).map(|(f, g)| f + g).collect();
        let violation = self.problem.violation(&cholesky.solve(&force));
        Ok(Some(ContactSet::from_fn(rows, |row| violation[row] > 0.0)))
    }

    /// The factor of K + weight B_C'B_C; `None` if the rows of C do not hold the body.
    pub fn hold(&self, closed: &ContactSet, weight: f64) -> Result<Option<Cholesky>> {
        let matrix = self.matrix(closed, weight, 0.0)?;
        // If K is definite by itself, this is not checked again.
        let looked_at = (!self.is_definite).then(|| matrix.clone());
        let holds = |cholesky: &Cholesky| looked_at.is_none_or(|matrix| cholesky.is_definite(&matrix));
        Ok(self.factor(matrix)?.filter(holds))
    }

    /// The same, once those rows have joined C that stop its free modes from `displacement`. The ending of a loop if
    /// there is no factor: no row stops a mode, the energy is negative along some direction, or time is over.
    pub fn hold_with_more(
        &self,
        closed: &mut ContactSet,
        weight: f64,
        displacement: &[f64],
    ) -> Result<Result<Cholesky, Ending>> {
        loop {
            if let Some(cholesky) = self.hold(closed, weight)? {
                return Ok(Ok(cholesky));
            }
            let mode = self.free_mode(closed, weight)?;
            if !mode.is_some_and(|(mode, is_driven)| self.stop(&mode, is_driven, displacement, closed)) {
                return Ok(Err(Ending::Unheld));
            }
            if self.watch.is_over() {
                return Ok(Err(Ending::Unsettled));
            }
        }
    }

    /// A direction d with K d = 0 and B_C d = 0, largest entry one, and whether the load does work on it, `f'd > 0`:
    /// the projection of the load onto the null space or, if the load does no work there, any null vector. `None` if no
    /// shift makes the matrix definite.
    fn free_mode(&self, closed: &ContactSet, weight: f64) -> Result<Option<(Vec<f64>, bool)>> {
        // A weight does not change the null vectors, and a large one hides the shift in its rounding.
        let weight = weight.min(1.0);
        for shift in SHIFTS {
            let Some(cholesky) = self.factor(self.matrix(closed, weight, shift)?)? else { continue };
            let mut projected = self.problem.load().to_vec();
            for _ in 0..STEPS {
                projected = cholesky.solve(&projected);
                projected.iter_mut().for_each(|value| *value *= shift);
            }
            let projected = normalised(projected);
            let still = self.matrix(closed, weight, 0.0)?.mul(&projected);
            let is_driven = largest(&still) <= NOISE && self.problem.share_of_work(&projected) > WORK_TOLERANCE;
            let direction = if is_driven { projected } else { normalised(cholesky.softest_vector()) };
            return Ok(Some((direction, is_driven)));
        }
        Ok(None)
    }

    /// Closes the open rows that stop a mode first; undriven ones go either way. `false` if no row stops it.
    fn stop(&self, mode: &[f64], is_driven: bool, displacement: &[f64], closed: &mut ContactSet) -> bool {
        let (contact, violation) = (self.problem.contact(), self.problem.violation(displacement));
        let (speed, terms) = (contact.mul(mode), contact.mul_abs(mode));
        for way in if is_driven { &[1.0][..] } else { &[1.0, -1.0] } {
            // A speed within the rounding of its own terms is zero.
            let is_stopped_by =
                |row: &usize| speed[*row] * way > WORK_TOLERANCE * terms[*row] && !closed.contains(*row);
            let time = |row: usize| (row, (-violation[row]).max(0.0) / speed[row].abs());
            let times: Vec<(usize, f64)> = (0..violation.len()).filter(is_stopped_by).map(time).collect();
            let first = times.iter().fold(f64::INFINITY, |first, entry| entry.1.min(first));
            if first.is_finite() {
                let is_first = |entry: &&(usize, f64)| entry.1 <= first * (1.0 + WORK_TOLERANCE);
                times.iter().filter(is_first).for_each(|entry| closed.insert(entry.0));
                return true;
            }
        }
        false
    }
}

/// The way in which a method ended. Whether a problem has an answer at all is not for a method to say.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// The contact set is settled.
    Settled,
    /// A limit ended the loop, or it came no further.
    Unsettled,
    /// No row stops a motion without energy, or the energy is negative along one: there may be no answer, or more than
    /// one.
    Unheld,
    /// No displacement meets these rows together, as verified weights of Farkas show.
    Infeasible {
        /// The rows that contradict each other, from 0.
        rows: Vec<usize>,
        /// The weight of each of them, in their order, `>= 0`, dimensionless.
        weights: Vec<f64>,
    },
}

impl Ending {
    /// The ending of a loop that may have settled.
    pub(super) fn of(is_settled: bool) -> Self {
        if is_settled { Ending::Settled } else { Ending::Unsettled }
    }
}

/// The result of one method alone, in the units of the problem that it was given: the scaled ones inside a solve.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Displacement v, one entry per dof, in the unit of length of that problem.
    pub displacement: Vec<f64>,
    /// Multiplier, one entry per row, in the unit of force of that problem, `<= 0`.
    pub multiplier: Vec<f64>,
    /// The rows that the method closed last.
    pub contact_set: ContactSet,
    /// Number of sets or steps that were tried.
    pub iterations: usize,
    /// The sets on the way to the result, in order.
    pub history: Vec<Iteration>,
    /// Settled, or the reason for which it is not.
    pub ending: Ending,
    /// Empty, or the variant that ended the loop, to be appended to the method's name.
    pub variant: &'static str,
}

impl Outcome {
    /// Returns `true` if the contact set is settled.
    pub fn is_settled(&self) -> bool {
        self.ending == Ending::Settled
    }

    /// Nothing moves, and no row is closed.
    pub(crate) fn at_rest(problem: &ContactProblem, ending: Ending) -> Self {
        let (displacement, multiplier) = (vec![0.0; problem.dofs()], vec![0.0; problem.rows()]);
        let (contact_set, history) = (ContactSet::open(problem.rows()), Vec::new());
        Outcome { displacement, multiplier, contact_set, iterations: 0, history, ending, variant: "" }
    }

    /// This outcome, found after another that fell short.
    pub fn after(self, before: Outcome) -> Self {
        let history = [before.history, self.history].concat();
        Outcome { iterations: before.iterations + self.iterations, history, ..self }
    }
}

/// Shifts that make a singular matrix definite, smallest first.
const SHIFTS: [f64; 3] = [1e-12, 1e-10, 1e-8];

/// Projections of the load: each gains several digits, since eigenvalues differ by many orders of magnitude.
const STEPS: usize = 5;

/// Work of the load on a free mode, and other sums over a mode, are rounding below this share of their own terms.
const WORK_TOLERANCE: f64 = 1e-9;

/// Entries of a null vector with largest entry one, and forces on a diagonal of order one, below this are rounding.
const NOISE: f64 = 1e-13;

/// The vector with largest entry one and without the entries that are rounding.
fn normalised(mut direction: Vec<f64>) -> Vec<f64> {
    let size = largest(&direction);
    direction.iter_mut().for_each(|value| *value = if value.abs() > NOISE * size { *value / size } else { 0.0 });
    direction
}
