//! Numbers with twice the working precision, and sums that keep the rounding errors of their terms: about as precise,
//! or exact.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::for_processor;

/// Products below this magnitude may lose their last bits to underflow.
const LEAST_PRODUCT: f64 = f64::MIN_POSITIVE / f64::EPSILON / f64::EPSILON;

/// The unrounded sum of two doubles; the second is below half a unit in the last place of the first.
///
/// # Source
/// T. J. Dekker, *A floating-point technique for extending the available precision*, Numer. Math. 18 (1971) 224-242.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twice {
    head: f64,
    tail: f64,
}

impl Twice {
    /// Zero.
    pub const ZERO: Twice = Twice { head: 0.0, tail: 0.0 };

    /// The nearest double.
    pub fn rounded(self) -> f64 {
        self.head
    }

    /// The absolute value.
    pub fn abs(self) -> Self {
        if self.head < 0.0 { -self } else { self }
    }

    /// The sum of two doubles; the first is the larger in magnitude.
    fn of_sorted(head: f64, tail: f64) -> Self {
        let sum = head + tail;
        Twice { head: sum, tail: tail - (sum - head) }
    }

    /// The sum of any two doubles.
    #[inline(always)]
    fn of_sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let part = sum - a;
        Twice { head: sum, tail: (a - (sum - part)) + (b - part) }
    }

    /// The product of two doubles: a fused multiply-add of them and their negative product gives its rounding error.
    #[inline(always)]
    fn of_product(a: f64, b: f64) -> Self {
        let product = a * b;
        Twice { head: product, tail: a.mul_add(b, -product) }
    }

    /// Adds `a b` to a sum whose tail collects all rounding errors, and may be of any size.
    #[inline(always)]
    fn add_product(&mut self, a: f64, b: f64) {
        let product = Self::of_product(a, b);
        let sum = Self::of_sum(self.head, product.head);
        self.head = sum.head;
        self.tail += sum.tail + product.tail;
    }
}

impl From<f64> for Twice {
    fn from(value: f64) -> Self {
        Twice { head: value, tail: 0.0 }
    }
}

impl Neg for Twice {
    type Output = Self;

    fn neg(self) -> Self {
        Twice { head: -self.head, tail: -self.tail }
    }
}

impl Add for Twice {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (heads, tails) = (Self::of_sum(self.head, other.head), Self::of_sum(self.tail, other.tail));
        let sum = Self::of_sorted(heads.head, heads.tail + tails.head);
        Self::of_sorted(sum.head, sum.tail + tails.tail)
    }
}

impl Sub for Twice {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twice {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self::of_product(self.head, other.head);
        Self::of_sorted(product.head, product.tail + (self.head * other.tail + self.tail * other.head))
    }
}

impl Div for Twice {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = Self::from(self.head / other.head);
        let rest = self - first * other;
        let second = Self::from(rest.head / other.head);
        let rest = rest - second * other;
        first + second + Self::from(rest.head / other.head)
    }
}

/// A sum below this share of its terms is zero: far above the rounding of twice the working precision.
const CANCELLED: f64 = 1e-26;

/// A sum with the magnitudes of its terms.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    /// The sum so far.
    pub value: Twice,
    /// The sum of the sizes of its terms.
    pub terms: f64,
}

impl Sum {
    /// Adds a term.
    pub fn add(&mut self, term: Twice) {
        self.value = self.value + term;
        self.terms += term.rounded().abs();
    }

    /// Adds a multiple of another sum, with the terms of that.
    pub fn add_share(&mut self, share: Twice, of: Sum) {
        self.value = self.value + share * of.value;
        self.terms += share.rounded().abs() * of.terms;
    }

    /// Zero if the terms cancel.
    pub fn settled(self) -> Twice {
        self.beyond(CANCELLED)
    }

    /// Zero if at most this share of the terms is left.
    pub fn beyond(self, share: f64) -> Twice {
        if self.value.rounded().abs() > share * self.terms { self.value } else { Twice::ZERO }
    }
}

impl FromIterator<Twice> for Sum {
    fn from_iter<I: IntoIterator<Item = Twice>>(terms: I) -> Self {
        let mut sum = Sum::default();
        terms.into_iter().for_each(|term| sum.add(term));
        sum
    }
}

/// Sums that keep the rounding errors of their terms.
///
/// The loop over a matrix is compiled for processors with a fused multiply-add and for those without; the sums are the
/// same, bit by bit.
///
/// # Source
/// T. Ogita, S. M. Rump, S. Oishi, 2005, "Accurate sum and dot product", SIAM J. Sci. Comput. 26.
#[derive(Clone, Debug)]
pub struct Accumulator {
    sums: Vec<Twice>,
}

for_processor! {
    /// Adds the product of a symmetric matrix with x to `sums`, and that of their magnitudes to `terms`; `column` gives
    /// the entries `(row, value)` of a column of the lower triangle.
    fn add_symmetric['a, I: Iterator<Item = (usize, f64)>, C: Fn(usize) -> I](
        column: C, x: &'a [f64], sums: &'a mut [Twice], terms: &'a mut [f64]
    ) -> () {
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

for_processor! {
    /// Adds the product of a matrix with x, or of the transposed matrix, to `sums`; `column` gives the entries
    /// `(row, value)` of a column.
    fn add_columns['a, I: Iterator<Item = (usize, f64)>, C: Fn(usize) -> I](
        column: C, x: &'a [f64], sums: &'a mut [Twice], is_transposed: bool
    ) -> () {
        if is_transposed {
            for (index, own) in sums.iter_mut().enumerate() {
                for (row, value) in column(index).filter(|entry| x[entry.0] != 0.0) {
                    own.add_product(value, x[row]);
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
    /// Sums that start from `values`, in their order.
    pub fn new(values: &[f64]) -> Self {
        Accumulator { sums: values.iter().map(|&value| value.into()).collect() }
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
        add_symmetric(column, x, &mut self.sums, &mut terms);
        terms
    }

    /// Adds `A x` to as many sums as A has rows; `column` gives the entries `(row, value)` of its columns.
    pub fn add_columns<I: Iterator<Item = (usize, f64)>>(&mut self, column: impl Fn(usize) -> I, x: &[f64]) {
        add_columns(column, x, &mut self.sums, false);
    }

    /// Adds `A' x` to as many sums as A has columns, without the terms of entries of x that are zero.
    pub fn add_transposed<I: Iterator<Item = (usize, f64)>>(&mut self, column: impl Fn(usize) -> I, x: &[f64]) {
        add_columns(column, x, &mut self.sums, true);
    }

    /// The sums, each rounded once; not finite if a term overflows.
    pub fn into_sums(self) -> Vec<f64> {
        self.sums().collect()
    }

    /// The sums of `x_i` times sum i over each of `count` parts, rounded once.
    pub fn products_by(&self, x: &[f64], part_of: impl Fn(usize) -> usize, count: usize) -> Vec<f64> {
        let mut products = Accumulator::new(&vec![0.0; count]);
        for (index, (sum, &x)) in self.sums.iter().zip(x).enumerate() {
            products.add_product(part_of(index), sum.head, x);
            products.add_product(part_of(index), sum.tail, x);
        }
        products.into_sums()
    }

    /// The sums so far, each rounded once.
    pub fn sums(&self) -> impl Iterator<Item = f64> {
        self.sums.iter().map(|sum| sum.head + sum.tail)
    }
}

/// An exact sum: parts that do not overlap, in increasing order.
///
/// # Source
/// J. R. Shewchuk, *Adaptive precision floating-point arithmetic and fast robust geometric predicates*, Discrete
/// Comput. Geom. 18 (1997) 305-363, section 2.4.
#[derive(Clone, Debug, Default)]
pub struct ExactSum {
    parts: Vec<f64>,
    is_inexact: bool,
}

impl ExactSum {
    /// Adds `a * b`.
    pub fn add_product(&mut self, a: f64, b: f64) {
        let Twice { head, tail } = Twice::of_product(a, b);
        self.is_inexact |= !head.is_finite() || (head.abs() < LEAST_PRODUCT && a != 0.0 && b != 0.0);
        self.add(tail);
        self.add(head);
    }

    /// Adds a double.
    pub fn add(&mut self, value: f64) {
        let mut sum = value;
        let mut kept = 0;
        for index in 0..self.parts.len() {
            let next = Twice::of_sum(sum, self.parts[index]);
            if next.tail != 0.0 {
                self.parts[kept] = next.tail;
                kept += 1;
            }
            sum = next.head;
        }
        self.parts.truncate(kept);
        self.is_inexact |= !sum.is_finite();
        if sum != 0.0 {
            self.parts.push(sum);
        }
    }

    /// The sign of the sum, -1, 0 or 1; `None` if a product left the range in which it is exact.
    pub fn sign(&self) -> Option<i32> {
        let largest = self.parts.last().copied().unwrap_or(0.0);
        (!self.is_inexact).then(|| i32::from(largest > 0.0) - i32::from(largest < 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_is_held_to_twice_the_digits() {
        let third = Twice::from(1.0) / Twice::from(3.0);
        let left = third * Twice::from(3.0) - Twice::from(1.0);
        assert!(left.rounded().abs() < 1e-31 && third.tail != 0.0, "{third:?}: {left:?}");
    }

    #[test]
    fn a_small_term_survives_beside_large_ones_that_cancel() {
        let sum: Sum = [1e8, 3e-17, -1e8].map(Twice::from).into_iter().collect();
        assert_eq!(sum.beyond(1e-26).rounded(), 3e-17);
        assert_eq!(sum.beyond(1e-24), Twice::ZERO);
    }

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

    fn sign(products: &[(f64, f64)]) -> Option<i32> {
        let mut sum = ExactSum::default();
        products.iter().for_each(|&(a, b)| sum.add_product(a, b));
        sum.sign()
    }

    #[test]
    fn a_sum_that_cancels_to_the_last_of_three_hundred_bits_keeps_its_sign() {
        let (large, small) = (2.0_f64.powi(150), 2.0_f64.powi(-150));
        assert_eq!(sign(&[(large, 3.0), (0.1, 0.3), (small, -1.0), (large, -3.0), (-0.1, 0.3)]), Some(-1));
        assert_eq!(sign(&[(large, 3.0), (0.1, 0.3), (large, -3.0), (-0.3, 0.1)]), Some(0));
        // 0.1 times 3 is not 0.3.
        assert_eq!(sign(&[(0.1, 3.0), (-0.3, 1.0)]), Some(1));
        assert_eq!(sign(&[(1e-200, 1e-200)]), None);
        assert_eq!(sign(&[(0.0, 1e-200), (1e-310, 1.0)]), None);
    }
}
