//! The power iteration.

use super::real::Real;

/// The vector that `map` makes of a vector without symmetry, the same in every run, in `steps` applications, fewer if
/// one returns `false`; the largest entry is one after each. The entries of the first vector are spread evenly from
/// `least` to `least + 1`.
pub fn power_iteration<T: Real>(
    dim: usize,
    least: f64,
    steps: usize,
    mut map: impl FnMut(&mut Vec<T>) -> bool,
) -> Vec<T> {
    let golden = 0.618_033_988_749_895;
    let mut x: Vec<T> = (0..dim).map(|i| T::of((i as f64 * golden).fract() + least)).collect();
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
