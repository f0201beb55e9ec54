//! A problem in dense doubles, as it is given to the program.

use nalgebra::DMatrix;
use signorini::qp::Error;
use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix};

/// QP solvers take gaps from this value on as infinite; any smaller finite gap is a length, however large.
const UNBOUNDED: [f64; 2] = [1e20, 1e30];

/// Returns `true` if a gap is a length, that is, if it bounds its row.
pub fn is_length(gap: f64) -> bool {
    gap.is_finite() && !UNBOUNDED.contains(&gap)
}

/// K (n x n, symmetric), f (n), B (m x n), g (m).
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    pub stiffness: Vec<Vec<f64>>,
    pub load: Vec<f64>,
    pub contact: Vec<Vec<f64>>,
    pub gap: Vec<f64>,
}

impl Case {
    pub fn dofs(&self) -> usize {
        self.load.len()
    }

    pub fn rows(&self) -> usize {
        self.gap.len()
    }

    pub fn is_bounded(&self, row: usize) -> bool {
        is_length(self.gap[row])
    }

    pub fn problem(&self) -> Result<ContactProblem, Error> {
        let (n, m) = (self.dofs(), self.rows());
        let entries = |lines: &[Vec<f64>], only_lower: bool| {
            let mut triplets = Vec::new();
            for (i, line) in lines.iter().enumerate() {
                let kept = line.iter().enumerate().filter(|&(j, &value)| value != 0.0 && (!only_lower || j <= i));
                triplets.extend(kept.map(|(j, &value)| (i, j, value)));
            }
            triplets
        };
        let stiffness = SparseMatrix::from_triplets(n, n, &entries(&self.stiffness, true))?;
        let contact = SparseMatrix::from_triplets(m, n, &entries(&self.contact, false))?;
        ContactProblem::new(SymmetricMatrix::from_lower(stiffness)?, self.load.clone(), contact, self.gap.clone())
    }

    pub fn of(problem: &ContactProblem) -> Self {
        let (n, m) = (problem.dofs(), problem.rows());
        let (mut stiffness, mut contact) = (vec![vec![0.0; n]; n], vec![vec![0.0; n]; m]);
        for column in 0..n {
            for (row, value) in problem.stiffness().lower().column(column) {
                stiffness[row][column] = value;
                stiffness[column][row] = value;
            }
            problem.contact().column(column).for_each(|(row, b)| contact[row][column] = b);
        }
        Case { stiffness, load: problem.load().to_vec(), contact, gap: problem.gap().to_vec() }
    }

    /// Smallest and largest eigenvalue of `D K D` with a unit diagonal; dofs with a zero diagonal keep their scale.
    pub fn equilibrated_spectrum(&self) -> (f64, f64) {
        let n = self.dofs();
        let unit = |dof: usize| match self.stiffness[dof][dof] {
            own if own > 0.0 => 1.0 / own.sqrt(),
            _ => 1.0,
        };
        let equilibrated = DMatrix::from_fn(n, n, |i, j| self.stiffness[i][j] * unit(i) * unit(j));
        let values = equilibrated.symmetric_eigenvalues();
        (values.min(), values.max())
    }
}
