//! The start of an iteration.

use crate::error::{Error, LinearError};
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, Solution};

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
/// let stiffness = SymmetricMatrix::from_lower(one(2.0)?)?;
/// let problem = ContactProblem::new(stiffness, vec![3.0], one(1.0)?, vec![1.0])?;
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
    /// Returns `true` if nothing is known.
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
    pub(crate) fn check(&self, dofs: usize, rows: usize) -> Result<(), Error> {
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
