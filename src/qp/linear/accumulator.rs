//! Sums of products with about twice the working precision.

use super::SymmetricMatrix;

/// Splits a double into two halves of 26 bits: 2^27 + 1.
const SPLITTER: f64 = 134_217_729.0;

/// Sums that keep what rounding takes off them.
///
/// # Source
/// T. Ogita, S. M. Rump, S. Oishi, 2005, "Accurate sum and dot product", SIAM J. Sci. Comput. 26.
#[derive(Clone, Debug)]
pub struct Accumulator {
    sums: Vec<Sum>,
}

/// A sum and what rounding has taken off it.
#[derive(Clone, Copy, Debug)]
struct Sum {
    value: f64,
    rest: f64,
}

impl Sum {
    #[inline]
    fn add_product(&mut self, a: Halves, b: Halves) {
        let product = a.value * b.value;
        let of_product = a.low * b.low - (((product - a.high * b.high) - a.low * b.high) - a.high * b.low);
        let sum = self.value + product;
        let part = sum - self.value;
        self.rest += ((self.value - (sum - part)) + (product - part)) + of_product;
        self.value = sum;
    }
}

/// A double and the two halves of 26 bits that it is the sum of.
#[derive(Clone, Copy, Debug)]
struct Halves {
    value: f64,
    high: f64,
    low: f64,
}

impl Halves {
    #[inline]
    fn of(value: f64) -> Self {
        let scaled = SPLITTER * value;
        let high = scaled - (scaled - value);
        Halves { value, high, low: value - high }
    }

    #[inline]
    fn negative(self) -> Self {
        Halves { value: -self.value, high: -self.high, low: -self.low }
    }
}

impl Accumulator {
    /// Sums that start from `values`.
    pub fn new(values: &[f64]) -> Self {
        Accumulator { sums: values.iter().map(|&value| Sum { value, rest: 0.0 }).collect() }
    }

    /// Adds `a * b` to sum `index`.
    #[inline]
    pub fn add_product(&mut self, index: usize, a: f64, b: f64) {
        self.sums[index].add_product(Halves::of(a), Halves::of(b));
    }

    /// Subtracts `A x`, for as many sums as A has rows; returns `|A| |x|`, the scale of rounding in it, which the same pass
    /// over A gives.
    pub fn subtract_product(&mut self, matrix: &SymmetricMatrix, x: &[f64]) -> Vec<f64> {
        let mut terms = vec![0.0; x.len()];
        for (column, &at_column) in x.iter().enumerate() {
            let negative = Halves::of(at_column).negative();
            let (mut own, mut own_terms) = (self.sums[column], 0.0);
            for (row, value) in matrix.lower().column(column) {
                let value = Halves::of(value);
                if row == column {
                    own.add_product(value, negative);
                    own_terms += value.value.abs() * at_column.abs();
                    continue;
                }
                let at_row = x[row];
                own.add_product(value, Halves::of(at_row).negative());
                own_terms += value.value.abs() * at_row.abs();
                self.sums[row].add_product(value, negative);
                terms[row] += value.value.abs() * at_column.abs();
            }
            self.sums[column] = own;
            terms[column] += own_terms;
        }
        terms
    }

    /// The sums, each rounded once; not finite where a term is beyond 1e300.
    pub fn into_sums(self) -> Vec<f64> {
        self.sums().collect()
    }

    /// The sums of `x_i` times sum i over each of `count` parts, rounded once.
    pub fn products_by(&self, x: &[f64], part_of: impl Fn(usize) -> usize, count: usize) -> Vec<f64> {
        let mut products = Accumulator::new(&vec![0.0; count]);
        for (index, (sum, &x)) in self.sums.iter().zip(x).enumerate() {
            products.add_product(part_of(index), sum.value, x);
            products.add_product(part_of(index), sum.rest, x);
        }
        products.into_sums()
    }

    /// The sums so far, each rounded once.
    pub fn sums(&self) -> impl Iterator<Item = f64> {
        self.sums.iter().map(|sum| sum.value + sum.rest)
    }
}
