//! Vectors without symmetry, the same in every run, from which iterations start, and the power iteration.

use super::real::Real;

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

/// The vector that `map` makes of a vector without symmetry in `steps` applications, fewer if one returns `false`; the
/// largest entry is one after each. The entries of the first vector are spread evenly from `least` to `least + 1`.
pub fn power_iteration<T: Real>(
    dim: usize,
    least: f64,
    steps: usize,
    mut map: impl FnMut(&mut Vec<T>) -> bool,
) -> Vec<T> {
    let mut x: Vec<T> = (0..dim).map(|index| T::of((index as f64 * GOLDEN).fract() + least)).collect();
    for _ in 0..steps {
        if !map(&mut x) {
            break;
        }
        let size = x.iter().fold(0.0_f64, |size, value| size.max(value.double().abs()));
        let shrink = T::of(1.0 / size);
        x.iter_mut().for_each(|value| *value = *value * shrink);
    }
    x
}
