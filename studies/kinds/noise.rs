//! Data that look random and are the same in each run.

use support::oracles::Draws;

/// Returns a pseudorandom number in [0, 1) that depends only on `index`.
pub fn noise(index: usize) -> f64 {
    Draws::new((index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)).uniform()
}
