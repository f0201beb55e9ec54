//! Exact scaling: exponents of two as integers, so that no intermediate product rounds or overflows.

use super::SymmetricMatrix;

/// `floor(log2 |x|)` for a finite x other than zero; zero for x = 0.
pub fn exponent(x: f64) -> i32 {
    const DENORMAL_SHIFT: i32 = 64;
    if x == 0.0 || !x.is_finite() {
        return 0;
    }
    let biased = |value: f64| ((value.to_bits() >> 52) & 0x7ff) as i32;
    match biased(x) {
        0 => biased(x * 2.0_f64.powi(DENORMAL_SHIFT)) - 1023 - DENORMAL_SHIFT,
        bits => bits - 1023,
    }
}

/// `x 2^e`, exact unless the result itself leaves the range of double precision.
pub fn ldexp(x: f64, e: i32) -> f64 {
    const STEP: i32 = 1000;
    let step = e.clamp(-STEP, STEP);
    // The bits of the power of two, because this is called once for each entry of the stiffness.
    let result = x * f64::from_bits(((1023 + step) as u64) << 52);
    if step == e { result } else { ldexp(result, (e - step).clamp(-3 * STEP, 3 * STEP)) }
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
        let diagonal = matrix.diagonal();
        let largest = exponent(diagonal.iter().copied().fold(0.0, f64::max));
        let level = |&value: &f64| if value > 0.0 { -(exponent(value) - largest).div_euclid(2) } else { 0 };
        Equilibration { diagonal: diagonal.iter().map(level).collect(), factor: -largest }
    }

    /// The matrix `c D A D`.
    pub fn apply(&self, matrix: &SymmetricMatrix) -> SymmetricMatrix {
        let scale = &self.diagonal;
        let lower = matrix.lower();
        let mut values = Vec::with_capacity(lower.entries());
        for column in 0..lower.columns() {
            let factor = self.factor + scale[column];
            values.extend(lower.column(column).map(|(row, value)| ldexp(value, factor + scale[row])));
        }
        SymmetricMatrix::from_sorted_lower(lower.with_values(values))
    }
}
