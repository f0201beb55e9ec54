//! Vectors that look random, the same in every run.

/// A vector of numbers between -1/2 and 1/2 that look random, the same in every run, different for each `number`.
pub(super) fn random(length: usize, number: usize) -> Vec<f64> {
    // The mixing of splitmix64.
    let mixed = |index: usize| {
        let mut bits = (index as u64).wrapping_add((number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) << 20);
        bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..length).map(mixed).collect()
}
