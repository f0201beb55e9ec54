//! The floating-point numbers in which a multigrid hierarchy is stored; vectors without symmetry, alike in every run,
//! from which iterations start; the power iteration; loops compiled for the processor.

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

/// The golden section: its multiples, less whole numbers, are spread evenly.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// A vector of numbers between -1/2 and 1/2 that look random, different for each number.
pub fn generic(length: usize, number: usize) -> Vec<f64> {
    let first = (number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) << 20;
    let of = |index: usize| (scramble((index as u64).wrapping_add(first)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
    (0..length).map(of).collect()
}

/// The mixing of splitmix64.
pub fn scramble(index: u64) -> u64 {
    let mut bits = index.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// The vector that `map` makes of a vector without symmetry in `steps` applications, fewer if one returns `None`; the
/// largest entry is one after each. The entries of the first vector are spread evenly from `least` to `least + 1`.
pub fn power_iteration<T: Real>(
    dim: usize,
    least: f64,
    steps: usize,
    mut map: impl FnMut(&[T]) -> Option<Vec<T>>,
) -> Vec<T> {
    let mut x: Vec<T> = (0..dim).map(|index| T::of((index as f64 * GOLDEN).fract() + least)).collect();
    for _ in 0..steps {
        let Some(next) = map(&x) else { break };
        x = next;
        let size = x.iter().fold(0.0_f64, |size, value| size.max(value.double().abs()));
        let shrink = T::of(1.0 / size);
        x.iter_mut().for_each(|value| *value = *value * shrink);
    }
    x
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
