//! The floating-point numbers in which a multigrid hierarchy is stored, and loops compiled for the processor.

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

/// A function whose loops are compiled for the processor that runs them. A plain function would not be, and a closure
/// would be a call to code that is not.
macro_rules! for_processor {
    ($(#[$doc:meta])* fn $name:ident[$($generics:tt)*]($($argument:ident: $type:ty),*) -> $result:ty $body:block) => {
        $(#[$doc])*
        fn $name<$($generics)*>($($argument: $type),*) -> $result {
            struct Work<A>(A);
            impl<$($generics)*> pulp::WithSimd for Work<($($type,)*)> {
                type Output = $result;
                #[inline(always)]
                fn with_simd<S: pulp::Simd>(self, _: S) -> $result {
                    let Work(($($argument,)*)) = self;
                    $body
                }
            }
            pulp::Arch::new().dispatch(Work(($($argument,)*)))
        }
    };
}

pub(crate) use for_processor;
