//! Natural frequencies by dense eigensolvers: all of them, with rows held by an orthonormal basis of their null space.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use signorini::{SparseMatrix, SymmetricMatrix};

/// A row of which less than this share is left beside those before it follows from them.
const DEPENDENT: f64 = 1e-9;

fn full(matrix: &SymmetricMatrix) -> DMatrix<f64> {
    let mut full = DMatrix::zeros(matrix.dim(), matrix.dim());
    for (i, j, value) in matrix.lower().triplets() {
        (full[(i, j)], full[(j, i)]) = (value, value);
    }
    full
}

/// An orthonormal basis of the vectors on which the rows `held` vanish.
fn null_basis(rows: &SparseMatrix, held: &[usize]) -> DMatrix<f64> {
    let dim = rows.columns();
    let by_row = rows.transposed();
    let mut independent: Vec<DVector<f64>> = Vec::new();
    for &row in held {
        let mut vector = DVector::zeros(dim);
        by_row.column(row).for_each(|(unknown, value)| vector[unknown] = value);
        vector /= vector.norm();
        for other in independent.iter().chain(&independent) {
            let part = other.dot(&vector);
            vector.axpy(-part, other, 1.0);
        }
        if vector.norm() > DEPENDENT {
            independent.push(vector.normalize());
        }
    }
    // Reflections turn these vectors into the first axes, and the other axes into their complement.
    let mut padded = DMatrix::zeros(dim, dim);
    independent.iter().enumerate().for_each(|(column, vector)| padded.set_column(column, vector));
    padded.qr().q().columns(independent.len(), dim - independent.len()).into_owned()
}

/// The eigenvalues of `K x = w M x` with the rows `held` at zero, increasing, those without mass left out, and the
/// largest. The sum `K + s M` is definite if no motion lacks both; s is the `place`-th eigenvalue that a first pass
/// finds.
pub fn eigenvalues(
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
    (rows, held): (&SparseMatrix, &[usize]),
    place: usize,
) -> Vec<f64> {
    // A diagonal of one, because units may differ by many digits; a travel moves as far as the others.
    let diagonal = stiffness.diagonal();
    let most = diagonal.iter().fold(0.0, |most: f64, &k| most.max(k));
    let scale: Vec<f64> = diagonal.iter().map(|&k| 1.0 / if k > 0.0 { k } else { most }.sqrt()).collect();
    let scaled = |matrix: &SymmetricMatrix| {
        let mut matrix = full(matrix);
        for i in 0..scale.len() {
            for j in 0..scale.len() {
                matrix[(i, j)] *= scale[i] * scale[j];
            }
        }
        matrix
    };
    let basis = null_basis(&rows.scaled(&vec![1.0; rows.rows()], &scale), held);
    let [k, m] = [stiffness, mass].map(|matrix| basis.transpose() * scaled(matrix) * &basis);
    let pass = |shift: f64| -> Vec<f64> {
        let lower = (&k + &m * shift).cholesky().expect("no motion lacks stiffness and mass").l();
        let half = lower.solve_lower_triangular(&m).expect("a factor");
        let operator = lower.solve_lower_triangular(&half.transpose()).expect("a factor");
        let found = SymmetricEigen::new((&operator + operator.transpose()) / 2.0).eigenvalues;
        let largest: f64 = found.amax();
        let mut values: Vec<f64> =
            found.iter().filter(|value| **value > 1e-15 * largest).map(|value| 1.0 / value - shift).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let first = pass(1e-4 * k.trace() / m.trace());
    let shift = first[place.min(first.len() - 1)];
    pass(shift)
}
