//! Exact scaling: exponents of two as integers, so that no intermediate product rounds or overflows.

use super::{SparseMatrix, SymmetricMatrix};

/// `floor(log2 |x|)` for a finite x other than zero; zero for x = 0.
#[inline]
pub fn exponent(x: f64) -> i32 {
    const DENORMAL_SHIFT: i32 = 64;
    let biased = |value: f64| ((value.to_bits() >> 52) & 0x7ff) as i32;
    match biased(x) {
        0 if x == 0.0 => 0,
        0 => biased(x * 2.0_f64.powi(DENORMAL_SHIFT)) - 1023 - DENORMAL_SHIFT,
        0x7ff => 0,
        bits => bits - 1023,
    }
}

/// `x 2^e`, exact unless the result itself leaves the range of double precision.
pub fn ldexp(x: f64, e: i32) -> f64 {
    let step = e.clamp(-STEP, STEP);
    let result = times_power(x, step);
    if step == e { result } else { ldexp(result, (e - step).clamp(-3 * STEP, 3 * STEP)) }
}

/// Exponents up to this size are those of a double.
const STEP: i32 = 1000;

/// `x 2^e` for an exponent of a double, by the bits of the power.
#[inline]
fn times_power(x: f64, e: i32) -> f64 {
    x * f64::from_bits(((1023 + e) as u64) << 52)
}

impl SparseMatrix {
    /// The matrix with every entry multiplied by `2^(r + c)`, with the exponents r of its row and c of its column.
    pub fn times_powers(&self, of_rows: &[i32], of_columns: impl Fn(usize) -> i32) -> Self {
        let most = of_rows.iter().fold(0, |most, e| e.saturating_abs().max(most));
        let mut values = Vec::with_capacity(self.entries());
        for column in 0..self.columns() {
            let ((rows, own), of_column) = (self.column_slices(column), of_columns(column));
            match rows.first().map(|&first| &of_rows[first as usize..]) {
                // A run of rows with exponents of doubles is walked without a branch.
                Some(run) if run.len() == own.len() && most <= STEP - of_column.saturating_abs() => {
                    values.extend(own.iter().zip(run).map(|(&value, r)| times_power(value, r + of_column)));
                }
                _ => values
                    .extend(rows.iter().zip(own).map(|(&row, &value)| ldexp(value, of_rows[row as usize] + of_column))),
            }
        }
        self.with_values(values)
    }
}

/// The exponents of a dimensionless diagonal D and a factor c that give `c D A D` a diagonal between 1 and 4.
///
/// `1 / c` is the size of the largest diagonal entry; D levels the contrast between the entries. Multiplying A by a
/// power of two changes c alone, so that the scaled matrix stays the same bit by bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibration {
    /// Exponent of each diagonal entry of D.
    pub diagonal: Vec<i32>,
    /// Exponent of c.
    pub factor: i32,
}

impl Equilibration {
    /// The equilibration of a matrix that needs none.
    pub fn none(dim: usize) -> Self {
        Equilibration { diagonal: vec![0; dim], factor: 0 }
    }

    /// The equilibration of a matrix with non-negative diagonal; a row with a zero diagonal gets the scale of the
    /// largest.
    pub fn of(matrix: &SymmetricMatrix) -> Self {
        Self::of_diagonal(&matrix.diagonal())
    }

    /// The same from its diagonal entries, in order.
    pub fn of_diagonal(diagonal: &[f64]) -> Self {
        let largest = exponent(diagonal.iter().copied().fold(0.0, f64::max));
        let level = |&value: &f64| if value > 0.0 { -(exponent(value) - largest).div_euclid(2) } else { 0 };
        Equilibration { diagonal: diagonal.iter().map(level).collect(), factor: -largest }
    }

    /// The matrix `c D A D`.
    pub fn apply(&self, matrix: &SymmetricMatrix) -> SymmetricMatrix {
        let lower = matrix.lower().times_powers(&self.diagonal, |column| self.factor + self.diagonal[column]);
        SymmetricMatrix::from_sorted_lower(lower)
    }
}
