//! Contact problems without a mesh.

use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix};

/// An entry of a matrix: its row, its column and its value.
pub type Entry = (usize, usize, f64);

/// The problem of these entries of K on and below the diagonal, the load, the entries of B, and the gaps.
#[track_caller]
pub fn of_entries(stiffness: &[Entry], load: Vec<f64>, contact: &[Entry], gap: Vec<f64>) -> ContactProblem {
    let (dofs, rows) = (load.len(), gap.len());
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, stiffness).unwrap()).unwrap();
    let contact = SparseMatrix::from_triplets(rows, dofs, contact).unwrap();
    ContactProblem::new(stiffness, load, contact, gap).unwrap()
}
