//! The complex numbers that stress functions need.

use std::ops::{Add, Mul};

/// `re + i im`; the sign of a zero `im` selects the side of a branch cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Complex {
    pub re: f64,
    pub im: f64,
}

/// The imaginary unit.
pub(super) const I: Complex = Complex { re: 0.0, im: 1.0 };

impl Complex {
    /// `factor * self`.
    pub fn scaled(self, factor: f64) -> Self {
        Complex { re: factor * self.re, im: factor * self.im }
    }

    /// The power on the branch that is real on the positive real axis and cut along the negative one.
    pub fn power(self, exponent: f64) -> Self {
        let size = self.re.hypot(self.im).powf(exponent);
        let (sin, cos) = (exponent * self.im.atan2(self.re)).sin_cos();
        Complex { re: size * cos, im: size * sin }
    }

    /// The logarithm on the same branch.
    pub fn ln(self) -> Self {
        Complex { re: self.re.hypot(self.im).ln(), im: self.im.atan2(self.re) }
    }
}

impl Add for Complex {
    type Output = Complex;
    fn add(self, other: Complex) -> Complex {
        Complex { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Mul for Complex {
    type Output = Complex;
    fn mul(self, other: Complex) -> Complex {
        Complex { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}
