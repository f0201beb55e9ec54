//! Changes of the data, and what follows from them.

use crate::error::{Error, LinearError};
use crate::linear::{SparseMatrix, SymmetricMatrix, check_finite, dot};
use crate::problem::ContactProblem;

/// A change of the data per unit of a parameter p, as it acts on an answer (u, lambda): out of balance by `load`, and
/// off the gaps by `distance`. Changes of several data add up.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// `df - dK u + dB' lambda`, length n, in force per unit of p.
    pub load: Vec<f64>,
    /// `dg - dB u`, one entry for each row of B, then for each equality row, in length per unit of p.
    pub distance: Vec<f64>,
}

impl Change {
    /// A change of the load, df (length n, in force per unit of the parameter), of a problem with this number of
    /// contact and equality rows.
    pub fn of_load(load: Vec<f64>, rows: usize) -> Self {
        Change { load, distance: vec![0.0; rows] }
    }

    /// A change of the gaps, dg, in length per unit of the parameter, positive if the obstacle moves away: one entry
    /// for each row of B, then for each equality row, of a problem with this number of dofs.
    pub fn of_gap(gap: Vec<f64>, dofs: usize) -> Self {
        Change { load: vec![0.0; dofs], distance: gap }
    }

    /// The same with a change of the stiffness, dK (n x n), at the displacement u of the answer, length n, in
    /// length.
    ///
    /// # Errors
    /// [`LinearError::Shape`] and [`LinearError::Length`] for numbers that do not fit.
    pub fn with_stiffness(mut self, change: &SymmetricMatrix, displacement: &[f64]) -> Result<Self, Error> {
        let dofs = self.load.len();
        if change.dim() != dofs {
            let (found, expected) = ((change.dim(), change.dim()), (dofs, dofs));
            return Err(LinearError::Shape { name: "change of the stiffness", found, expected }.into());
        }
        LinearError::check_length("displacement", displacement.len(), dofs, "dofs")?;
        self.load.iter_mut().zip(change.mul(displacement)).for_each(|(load, force)| *load -= force);
        Ok(self)
    }

    /// The same with a change of the rows, dB (rows x n), at the displacement u (length n, in length) and the
    /// multiplier lambda (in force, `<= 0`) of the answer; equality rows follow those of B.
    ///
    /// # Errors
    /// [`LinearError::Shape`] and [`LinearError::Length`] for numbers that do not fit.
    pub fn with_rows(mut self, change: &SparseMatrix, displacement: &[f64], multiplier: &[f64]) -> Result<Self, Error> {
        let expected = (self.distance.len(), self.load.len());
        let found = (change.rows(), change.columns());
        if found != expected {
            return Err(LinearError::Shape { name: "change of the rows", found, expected }.into());
        }
        LinearError::check_length("displacement", displacement.len(), expected.1, "dofs")?;
        LinearError::check_length("multiplier", multiplier.len(), expected.0, "contact and equality rows")?;
        self.load.iter_mut().zip(change.mul_transposed(multiplier)).for_each(|(load, force)| *load += force);
        self.distance.iter_mut().zip(change.mul(displacement)).for_each(|(distance, moved)| *distance -= moved);
        Ok(self)
    }

    /// The change for another unit of the parameter.
    pub(super) fn times(&self, factor: f64) -> Self {
        let times = |values: &[f64]| values.iter().map(|value| factor * value).collect();
        Change { load: times(&self.load), distance: times(&self.distance) }
    }

    pub(super) fn check(&self, dofs: usize, rows: usize) -> Result<(), LinearError> {
        check_finite("change of the load", &self.load, (dofs, "dofs"))?;
        check_finite("change of the gaps", &self.distance, (rows, "contact and equality rows"))
    }
}

/// The derivatives of displacement and multipliers along one change of load, gaps, stiffness and rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Tangent {
    /// du, length n, in length per unit of the parameter.
    pub displacement: Vec<f64>,
    /// dlambda, one entry for each row of B, then for each equality row, in force per unit of the parameter: negative
    /// if the pressure grows, zero on open rows.
    pub multiplier: Vec<f64>,
    /// The relative accuracy of the linear solve, as in [`Adjoint::error`].
    pub error: f64,
}

impl Tangent {
    pub(super) fn times(self, factor: f64) -> Self {
        let times = |values: Vec<f64>| values.into_iter().map(|value| 0.0 + factor * value).collect();
        Tangent { displacement: times(self.displacement), multiplier: times(self.multiplier), ..self }
    }
}

/// The adjoint solution of an output: its derivatives with respect to all data of the problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjoint {
    /// w, length n: the derivative with respect to the load, in the unit of the output over force.
    pub displacement: Vec<f64>,
    /// nu, one entry for each row of B, then for each equality row, in the unit of the output over length; zero on open
    /// rows, of either sign elsewhere. The derivative with respect to a gap is `-nu`.
    pub multiplier: Vec<f64>,
    pub(super) answer: [Vec<f64>; 2],
    pub(super) inequalities: usize,
    /// The error of this solution of the linear system. With a factor: the last correction, relative to the largest
    /// entry. With a hierarchy, and at a kink: the relative error bound of its energy, as that of a certificate.
    pub error: f64,
}

impl Adjoint {
    /// The derivative of the output along a change of the data, without what the output itself depends on them.
    pub fn along(&self, change: &Change) -> f64 {
        dot(&self.displacement, &change.load) - dot(&self.multiplier, &change.distance)
    }

    /// The derivatives with respect to the load f, length n, in the unit of the output over force.
    pub fn of_load(&self) -> &[f64] {
        &self.displacement
    }

    /// The derivatives with respect to the gaps g, length m, in the unit of the output over length: positive if the
    /// output grows as the obstacle moves away.
    pub fn of_gap(&self) -> Vec<f64> {
        // Adding zero removes the sign of a zero.
        self.multiplier[..self.inequalities].iter().map(|nu| 0.0 - nu).collect()
    }

    /// The derivatives with respect to the values e of the equality rows, length p, in the unit of the output over
    /// length.
    pub fn of_equality_values(&self) -> Vec<f64> {
        self.multiplier[self.inequalities..].iter().map(|nu| 0.0 - nu).collect()
    }

    /// The derivatives with respect to the entries of K, on the pattern of its lower triangle (n x n): an entry off the
    /// diagonal stands for both of its places.
    ///
    /// # Errors
    /// [`LinearError::Length`] for a problem of another size.
    pub fn of_stiffness(&self, problem: &ContactProblem) -> Result<SparseMatrix, Error> {
        LinearError::check_length("adjoint", self.displacement.len(), problem.dofs(), "dofs")?;
        let ([u, _], w) = (&self.answer, &self.displacement);
        let lower = problem.stiffness().lower();
        let of = |(i, j, _): (usize, usize, f64)| {
            if i == j { -w[i] * u[i] } else { -(w[i] * u[j] + w[j] * u[i]) }
        };
        Ok(lower.with_values(lower.triplets().map(of).collect()))
    }

    /// The derivatives with respect to the entries of the rows B (m x n), on their pattern.
    ///
    /// # Errors
    /// [`LinearError::Length`] for a problem of another size.
    pub fn of_rows(&self, problem: &ContactProblem) -> Result<SparseMatrix, Error> {
        LinearError::check_length("adjoint", self.displacement.len(), problem.dofs(), "dofs")?;
        let (contact, _) = problem.inequalities_given();
        let ([u, lambda], w, nu) = (&self.answer, &self.displacement, &self.multiplier);
        let of = |(row, dof, _): (usize, usize, f64)| lambda[row] * w[dof] + nu[row] * u[dof];
        Ok(contact.with_values(contact.triplets().map(of).collect()))
    }
}
