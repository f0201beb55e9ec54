//! The floating-point numbers in which a multigrid hierarchy is stored.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// `f64` or `f32`: the precisions in which a hierarchy may be stored.
pub trait Real:
    Add<Output = Self>
    + AddAssign
    + Div<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + Sub<Output = Self>
    + SubAssign
    + Copy
    + Default
    + Into<f64>
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + std::fmt::Debug
    + 'static
{
    /// A unit in the last place of one.
    const EPSILON: f64;

    /// The nearest value.
    fn of(value: f64) -> Self;

    fn double(self) -> f64 {
        self.into()
    }
}

impl Real for f64 {
    const EPSILON: f64 = f64::EPSILON;

    fn of(value: f64) -> Self {
        value
    }
}

impl Real for f32 {
    const EPSILON: f64 = f32::EPSILON as f64;

    fn of(value: f64) -> Self {
        value as f32
    }
}
