//! The problem that every method works on, and the outcome that it returns.

use std::cell::{Cell, OnceCell};
use std::time::Instant;

use crate::error::Error;
use crate::linear::watch::Watch;
use crate::linear::{Augmented, Cholesky, Compliance, SymmetricMatrix, if_definite};
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, Iteration};

/// Differences below this, relative to the largest displacement or multiplier, are rounding. Without this tolerance on
/// signs a weakly active row would close and open without end.
pub(crate) const SIGN_TOLERANCE: f64 = 1e-12;

/// A scaled problem with its pattern analysed: the input of every method.
#[derive(Debug)]
pub struct ScaledProblem<'a> {
    /// The data, dimensionless and of order one.
    pub problem: &'a ContactProblem,
    /// `true` if the stiffness is definite by itself: it has no modes without energy.
    pub is_definite: bool,
    augmented: &'a Augmented,
    /// The compliance of the rows, by which a method balances forces; `None` if factors of the augmented matrix cost
    /// less.
    pub compliance: Option<&'a Compliance>,
    swept_load: OnceCell<Vec<f64>>,
    /// Seconds spent in factorisations so far.
    pub factor_seconds: Cell<f64>,
    /// The watch that the loops check, and to which they report their iterations: they end with the answer so far when
    /// it says so.
    pub watch: Watch,
}

impl<'a> ScaledProblem<'a> {
    /// The problem with the pattern of its K + B'B.
    pub fn new(
        problem: &'a ContactProblem,
        augmented: &'a Augmented,
        is_definite: bool,
        compliance: Option<&'a Compliance>,
        watch: Watch,
    ) -> Self {
        let (swept_load, factor_seconds) = (OnceCell::new(), Cell::new(0.0));
        ScaledProblem { problem, is_definite, augmented, compliance, swept_load, factor_seconds, watch }
    }

    /// The load, swept through the factor of a compliance once for all sets.
    pub(super) fn swept_load(&self, compliance: &Compliance) -> Vec<f64> {
        self.swept_load.get_or_init(|| compliance.swept(self.problem.load())).clone()
    }

    /// The matrix K + shift I + weight B_C' B_C of the closed rows C.
    pub(super) fn matrix(&self, closed: &ContactSet, weight: f64, shift: f64) -> Result<SymmetricMatrix, Error> {
        Ok(self.augmented.matrix()?.matrix(|row| if closed.contains(row) { weight } else { 0.0 }, shift))
    }

    /// The factor of such a matrix; `None` if it is not positive definite.
    pub(super) fn factor(&self, matrix: SymmetricMatrix) -> Result<Option<Cholesky>, Error> {
        let clock = Instant::now();
        let factor = if_definite(self.augmented.matrix()?.factor(matrix));
        self.factor_seconds.set(self.factor_seconds.get() + clock.elapsed().as_secs_f64());
        Ok(factor?)
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
