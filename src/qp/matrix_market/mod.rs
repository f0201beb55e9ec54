//! Matrix Market files: the raw form in which problems and answers are exchanged.
//!
//! A problem directory holds `K.mtx` (symmetric), `f.mtx`, `B.mtx` and `g.mtx`; an answer adds `u.mtx` and `lambda.mtx`.
//! Indices are the free dofs. A gap may be `inf`: a row without obstacle. Multigrid reads `near_null.mtx` (one column for
//! each displacement that costs next to no energy, as the rigid-body modes) or `coordinates.mtx` (one row for each node).
//! A sweep goes to other gaps, `g1.mtx`, another load, `f1.mtx`, or both.
//!
//! # Source
//! R. F. Boisvert, R. Pozo, K. A. Remington, *The Matrix Market Exchange Formats: Initial Design*, NISTIR 5935 (1996).

mod directory;
mod parse;

#[cfg(feature = "cli")]
pub use directory::{near_null_file, read_other_end};
pub use directory::{problem_files, read_problem, read_vector, solution_files};

use std::fmt::Write;

use crate::qp::linear::{SparseMatrix, SymmetricMatrix};

/// The text of a general sparse matrix.
pub fn format_matrix(matrix: &SparseMatrix) -> String {
    format_entries(matrix, "general")
}

/// The text of a symmetric matrix: its lower triangle.
pub fn format_symmetric(matrix: &SymmetricMatrix) -> String {
    format_entries(matrix.lower(), "symmetric")
}

fn format_entries(matrix: &SparseMatrix, symmetry: &str) -> String {
    let mut text = format!("%%MatrixMarket matrix coordinate real {symmetry}\n");
    // Writing into a String cannot fail.
    let _ = writeln!(text, "{} {} {}", matrix.rows(), matrix.columns(), matrix.entries());
    for (row, column, value) in matrix.triplets() {
        let _ = writeln!(text, "{} {} {value:e}", row + 1, column + 1);
    }
    text
}

/// The text of a vector, as an array of one column.
pub fn format_vector(vector: &[f64]) -> String {
    let mut text = format!("%%MatrixMarket matrix array real general\n{} 1\n", vector.len());
    for value in vector {
        let _ = writeln!(text, "{value:e}");
    }
    text
}
