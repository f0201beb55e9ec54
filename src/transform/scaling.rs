//! Scaling to dimensionless data of order one, by powers of two.
//!
//! With a reference displacement u0 and the equilibration `c D K D` of the stiffness:
//!
//! ```text
//! u = u0 D v,   K~ = c D K D,   f~ = c D f / u0,   B~ = R B D,   g~ = R g / u0,   lambda = (u0 / c) R mu
//! ```
//!
//! D levels a stiffness contrast inside the body, R gives every contact row a largest entry near one. All factors are
//! powers of two: the scaled problem is the same problem in other units, bit by bit.

use crate::error::Error;
use crate::problem::ContactProblem;
use crate::sparse::{Equilibration, SparseMatrix, exponent, ldexp};

/// A scaling of a contact problem, with its way back.
#[derive(Clone, Debug)]
pub struct Scaling {
    equilibration: Equilibration,
    /// Exponent of each entry of R.
    rows: Vec<i32>,
    /// Exponent of u0.
    displacement: i32,
    problem: ContactProblem,
}

impl Scaling {
    /// Scales `problem`, whose displacements are expected to be of the order of `reference` (any positive number in the
    /// problem's unit of length; zero counts as one).
    ///
    /// # Errors
    /// Those of [`ContactProblem::new`], should the data leave the range of double precision.
    pub fn of(problem: &ContactProblem, reference: f64) -> Result<Self, Error> {
        let equilibration = Equilibration::of(problem.stiffness());
        let (d, c) = (&equilibration.diagonal, equilibration.factor);
        let u0 = exponent(reference);

        let contact = problem.contact();
        let mut largest = vec![i32::MIN; problem.rows()];
        for (row, dof, value) in contact.triplets().filter(|entry| entry.2 != 0.0) {
            largest[row] = largest[row].max(exponent(value) + d[dof]);
        }
        let rows: Vec<i32> = largest.iter().map(|&e| if e == i32::MIN { 0 } else { -e }).collect();
        let entries: Vec<_> =
            contact.triplets().map(|(row, dof, value)| (row, dof, ldexp(value, rows[row] + d[dof]))).collect();

        let load = problem.load().iter().zip(d).map(|(&f, &d)| ldexp(f, c + d - u0)).collect();
        let gap = problem.gap().iter().zip(&rows).map(|(&g, &r)| ldexp(g, r - u0)).collect();
        let stiffness = equilibration.apply(problem.stiffness());
        let contact = SparseMatrix::from_triplets(problem.rows(), problem.dofs(), &entries)?;
        let problem = ContactProblem::new(stiffness, load, contact, gap)?;
        Ok(Scaling { equilibration, rows, displacement: u0, problem })
    }

    /// The scaled problem.
    pub fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// The displacement u of a scaled displacement v.
    pub fn expand_displacement(&self, scaled: &[f64]) -> Vec<f64> {
        scaled.iter().zip(&self.equilibration.diagonal).map(|(&v, &d)| ldexp(v, d + self.displacement)).collect()
    }

    /// The multiplier lambda of a scaled multiplier mu.
    pub fn expand_multiplier(&self, scaled: &[f64]) -> Vec<f64> {
        let exponent = self.displacement - self.equilibration.factor;
        scaled.iter().zip(&self.rows).map(|(&mu, &r)| ldexp(mu, r + exponent)).collect()
    }
}
