//! Numbers m 2^e with an integer m of any size. Doubles are such numbers, and so are their sums and products.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::{BigInt, Sign};

/// m 2^e.
#[derive(Clone, Debug)]
pub struct Dyadic {
    mantissa: BigInt,
    exponent: i64,
}

impl Dyadic {
    pub const ZERO: Dyadic = Dyadic { mantissa: BigInt::ZERO, exponent: 0 };

    pub fn new(mantissa: BigInt, exponent: i64) -> Self {
        if mantissa.sign() == Sign::NoSign { Dyadic::ZERO } else { Dyadic { mantissa, exponent } }
    }

    pub fn integer(value: i64) -> Self {
        Dyadic::new(value.into(), 0)
    }

    /// The number times 2^shift.
    pub fn ldexp(&self, shift: i64) -> Self {
        Dyadic::new(self.mantissa.clone(), self.exponent + shift)
    }

    pub fn exponent(&self) -> i64 {
        self.exponent
    }

    /// The exponent of the power of two just above the number, which is not zero.
    pub fn size(&self) -> i64 {
        self.exponent + self.mantissa.bits() as i64
    }

    pub fn is_zero(&self) -> bool {
        self.mantissa.sign() == Sign::NoSign
    }

    pub fn sign(&self) -> i32 {
        sign(&self.mantissa)
    }

    pub fn abs(&self) -> Self {
        Dyadic { mantissa: self.mantissa.magnitude().clone().into(), exponent: self.exponent }
    }

    /// The integer `self / 2^exponent`; the exponent must be low enough for an integer.
    pub fn over(&self, exponent: i64) -> BigInt {
        if self.is_zero() {
            return BigInt::ZERO;
        }
        assert!(self.exponent >= exponent, "2^{} over 2^{exponent} is not an integer", self.exponent);
        &self.mantissa << (self.exponent - exponent)
    }

    /// The double nearest to the exact value.
    pub fn to_f64(&self) -> f64 {
        quotient(self, &Dyadic::integer(1)).map_or(0.0, |(m, e)| scaled(m, e))
    }
}

impl From<f64> for Dyadic {
    /// Converts a finite double without rounding.
    fn from(value: f64) -> Self {
        assert!(value.is_finite(), "{value} is not finite");
        let bits = value.to_bits();
        let (biased, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
        let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
        if mantissa == 0 {
            return Dyadic::ZERO;
        }
        let zeros = mantissa.trailing_zeros();
        let mantissa = BigInt::from(mantissa >> zeros);
        Dyadic::new(if value < 0.0 { -mantissa } else { mantissa }, exponent + i64::from(zeros))
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: &Dyadic) -> Dyadic {
        if self.is_zero() || other.is_zero() {
            return if self.is_zero() { other.clone() } else { self.clone() };
        }
        let exponent = self.exponent.min(other.exponent);
        Dyadic::new(self.over(exponent) + other.over(exponent), exponent)
    }
}

impl Neg for &Dyadic {
    type Output = Dyadic;
    fn neg(self) -> Dyadic {
        Dyadic { mantissa: -&self.mantissa, exponent: self.exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: &Dyadic) -> Dyadic {
        self + &-other
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: &Dyadic) -> Dyadic {
        Dyadic::new(&self.mantissa * &other.mantissa, self.exponent + other.exponent)
    }
}

impl PartialEq for Dyadic {
    fn eq(&self, other: &Self) -> bool {
        (self - other).is_zero()
    }
}

impl PartialOrd for Dyadic {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some((self - other).sign().cmp(&0))
    }
}

pub fn sign(value: &BigInt) -> i32 {
    match value.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

/// The sum of products, without rounding.
pub fn dot<'a>(a: impl IntoIterator<Item = &'a Dyadic>, b: impl IntoIterator<Item = &'a Dyadic>) -> Dyadic {
    a.into_iter().zip(b).filter(|(a, b)| !a.is_zero() && !b.is_zero()).fold(Dyadic::ZERO, |sum, (a, b)| &sum + &(a * b))
}

/// `m 2^e`, even if 2^e itself is not a double.
fn scaled(m: f64, e: i64) -> f64 {
    let e = e.clamp(-2400, 2400) as i32;
    let (first, second) = (e / 3, e / 3);
    m * 2.0_f64.powi(first) * 2.0_f64.powi(second) * 2.0_f64.powi(e - first - second)
}

/// `a / b` as m 2^e with an even e and m of about 2^70; `None` for zero.
fn quotient(a: &Dyadic, b: &Dyadic) -> Option<(f64, i64)> {
    assert!(!b.is_zero(), "the divisor is not zero");
    if a.is_zero() {
        return None;
    }
    let mut shift = 70 + b.mantissa.bits() as i64 - a.mantissa.bits() as i64;
    let exponent = a.exponent - b.exponent;
    shift += (exponent - shift) & 1;
    let (a, b) = if shift >= 0 {
        (&a.mantissa << shift, b.mantissa.clone())
    } else {
        (a.mantissa.clone(), &b.mantissa << -shift)
    };
    let whole = &a / &b;
    let digits = whole.magnitude().iter_u64_digits().rev().fold(0, |sum, digit| sum << 64 | u128::from(digit));
    // What is cut off counts as half of the last of about 70 bits, so that a double is rounded once.
    let is_cut = &whole * &b != a;
    let size = (digits << 1 | u128::from(is_cut)) as f64;
    Some((f64::from(sign(&whole)) * size / 2.0, exponent - shift))
}

/// The double that is nearest to `a / b`.
pub fn ratio(a: &Dyadic, b: &Dyadic) -> f64 {
    quotient(a, b).map_or(0.0, |(m, e)| scaled(m, e))
}

/// `sqrt(a / b)`, to a few units in the last place, even if a / b itself is not a double.
pub fn root_of_ratio(a: &Dyadic, b: &Dyadic) -> f64 {
    quotient(a, b).map_or(0.0, |(m, e)| scaled(m.sqrt(), e / 2))
}
