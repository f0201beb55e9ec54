//! The power iteration.

use super::real::Real;

/// The vector that `map` makes of a vector without symmetry, the same in every run, in `steps` applications, fewer if
/// one gives `None`; the largest entry is one after each. The entries of the first vector are spread evenly from
/// `least` to `least + 1`.
pub fn power_iteration<T: Real>(
    dim: usize,
    least: f64,
    steps: usize,
    mut map: impl FnMut(&[T]) -> Option<Vec<T>>,
) -> Vec<T> {
    let golden = 0.618_033_988_749_895;
    let mut x: Vec<T> = (0..dim).map(|i| T::of((i as f64 * golden).fract() + least)).collect();
    for _ in 0..steps {
        let Some(next) = map(&x) else { break };
        let size = next.iter().fold(0.0_f64, |size, value| size.max(value.double().abs()));
        let shrink = T::of(1.0 / size);
        x = next.into_iter().map(|value| value * shrink).collect();
    }
    x
}
