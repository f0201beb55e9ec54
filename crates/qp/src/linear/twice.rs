//! Numbers with twice the working precision.

use std::ops::{Add, Div, Mul, Neg, Sub};

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
    pub const ZERO: Twice = Twice { head: 0.0, tail: 0.0 };

    /// The nearest double.
    pub fn rounded(self) -> f64 {
        self.head
    }

    pub fn abs(self) -> Self {
        if self.head < 0.0 { -self } else { self }
    }

    /// The sum of two doubles; the first is the larger in magnitude.
    fn of_sorted(head: f64, tail: f64) -> Self {
        let sum = head + tail;
        Twice { head: sum, tail: tail - (sum - head) }
    }

    /// The sum of any two doubles.
    fn of_sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let part = sum - a;
        Twice { head: sum, tail: (a - (sum - part)) + (b - part) }
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
        let product = self.head * other.head;
        let rest = self.head.mul_add(other.head, -product);
        Self::of_sorted(product, rest + (self.head * other.tail + self.tail * other.head))
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
    pub value: Twice,
    pub terms: f64,
}

impl Sum {
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
}
