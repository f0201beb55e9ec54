//! Sums of products with about twice the working precision.

use pulp::{Arch, Simd, WithSimd};

/// Sums that keep the rounding errors of their terms.
///
/// A fused multiply-add of two factors and their negative product gives the rounding error of the product. The loop
/// over a matrix is compiled for processors with that instruction and for those without; the sums are the same, bit by
/// bit.
///
/// # Source
/// T. Ogita, S. M. Rump, S. Oishi, 2005, "Accurate sum and dot product", SIAM J. Sci. Comput. 26.
#[derive(Clone, Debug)]
pub struct Accumulator {
    sums: Vec<CompensatedSum>,
}

/// A sum and its accumulated rounding error.
#[derive(Clone, Copy, Debug)]
struct CompensatedSum {
    value: f64,
    rest: f64,
}

impl CompensatedSum {
    #[inline(always)]
    fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        let of_product = a.mul_add(b, -product);
        let sum = self.value + product;
        let part = sum - self.value;
        self.rest += ((self.value - (sum - part)) + (product - part)) + of_product;
        self.value = sum;
    }
}

/// The product of a symmetric matrix with x, added to `sums`, and that of their magnitudes, added to `terms`.
struct SymmetricProduct<'a, C> {
    /// The entries `(row, value)` of a column of the lower triangle.
    column: C,
    x: &'a [f64],
    sums: &'a mut [CompensatedSum],
    terms: &'a mut [f64],
}

impl<I: Iterator<Item = (usize, f64)>, C: Fn(usize) -> I> WithSimd for SymmetricProduct<'_, C> {
    type Output = ();

    // A plain closure would be a call to code that is not compiled for the processor.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let SymmetricProduct { column, x, sums, terms } = self;
        // One length for all: an index is then checked once.
        let (sums, terms) = (&mut sums[..x.len()], &mut terms[..x.len()]);
        for (index, &at_column) in x.iter().enumerate() {
            let (mut own, mut own_terms) = (sums[index], terms[index]);
            for (row, value) in column(index) {
                own.add_product(value, x[row]);
                own_terms += (value * x[row]).abs();
                if row != index {
                    sums[row].add_product(value, at_column);
                    terms[row] += (value * at_column).abs();
                }
            }
            (sums[index], terms[index]) = (own, own_terms);
        }
    }
}

/// The product of a matrix with x, or of the transposed matrix, added to `sums`.
struct ColumnProduct<'a, C> {
    /// The entries `(row, value)` of a column.
    column: C,
    x: &'a [f64],
    sums: &'a mut [CompensatedSum],
    is_transposed: bool,
}

impl<I: Iterator<Item = (usize, f64)>, C: Fn(usize) -> I> WithSimd for ColumnProduct<'_, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let ColumnProduct { column, x, sums, is_transposed } = self;
        if is_transposed {
            for (index, own) in sums.iter_mut().enumerate() {
                for (row, value) in column(index) {
                    if x[row] != 0.0 {
                        own.add_product(value, x[row]);
                    }
                }
            }
            return;
        }
        for (index, &at_column) in x.iter().enumerate().filter(|entry| *entry.1 != 0.0) {
            for (row, value) in column(index) {
                sums[row].add_product(value, at_column);
            }
        }
    }
}

impl Accumulator {
    /// Sums that start from `values`.
    pub fn new(values: &[f64]) -> Self {
        Accumulator { sums: values.iter().map(|&value| CompensatedSum { value, rest: 0.0 }).collect() }
    }

    /// Adds `a * b` to sum `index`.
    #[inline]
    pub fn add_product(&mut self, index: usize, a: f64, b: f64) {
        self.sums[index].add_product(a, b);
    }

    /// Adds `A x` to as many sums as A has rows. A is symmetric; `column` gives the entries `(row, value)` of its lower
    /// triangle. Returns `|A| |x|`, the scale of rounding in `A x`, from the same pass over A.
    pub fn add_matrix_product<I: Iterator<Item = (usize, f64)>>(
        &mut self,
        column: impl Fn(usize) -> I,
        x: &[f64],
    ) -> Vec<f64> {
        let mut terms = vec![0.0; x.len()];
        Arch::new().dispatch(SymmetricProduct { column, x, sums: &mut self.sums, terms: &mut terms });
        terms
    }

    /// Adds `A x` to as many sums as A has rows; `column` gives the entries `(row, value)` of its columns.
    pub fn add_columns<I: Iterator<Item = (usize, f64)>>(&mut self, column: impl Fn(usize) -> I, x: &[f64]) {
        Arch::new().dispatch(ColumnProduct { column, x, sums: &mut self.sums, is_transposed: false });
    }

    /// Adds `A' x` to as many sums as A has columns, without the terms of entries of x that are zero.
    pub fn add_transposed<I: Iterator<Item = (usize, f64)>>(&mut self, column: impl Fn(usize) -> I, x: &[f64]) {
        Arch::new().dispatch(ColumnProduct { column, x, sums: &mut self.sums, is_transposed: true });
    }

    /// The sums, each rounded once; not finite if a term overflows.
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

#[cfg(test)]
mod tests {
    use super::Accumulator;

    /// (1 + e)(1 - e) - 1 = -e^2, which a sum of rounded products would lose.
    #[test]
    fn a_matrix_product_keeps_what_rounding_takes_off_its_terms() {
        let e = 2.0_f64.powi(-30);
        let columns = [vec![(0, 1.0 + e), (1, -1.0)], vec![(1, 0.0)]];
        let mut sums = Accumulator::new(&[0.0, 1.0]);
        let terms = sums.add_matrix_product(|column| columns[column].iter().copied(), &[1.0 - e, 1.0]);
        assert_eq!(sums.into_sums(), [-e * e, e]);
        assert_eq!(terms, [2.0, 1.0 - e]);
    }
}
