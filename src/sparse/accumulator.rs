//! Sums of products with about twice the working precision.

/// Splits a double into two halves of 26 bits: 2^27 + 1.
const SPLITTER: f64 = 134_217_729.0;

/// Sums that keep what rounding takes off them.
///
/// # Source
/// T. Ogita, S. M. Rump, S. Oishi, 2005, "Accurate sum and dot product", SIAM J. Sci. Comput. 26.
#[derive(Clone, Debug)]
pub struct Accumulator {
    sums: Vec<f64>,
    rest: Vec<f64>,
}

impl Accumulator {
    /// Sums that start from `values`.
    pub fn new(values: &[f64]) -> Self {
        Accumulator { sums: values.to_vec(), rest: vec![0.0; values.len()] }
    }

    /// Adds `a * b` to sum `index`.
    #[inline]
    pub fn add_product(&mut self, index: usize, a: f64, b: f64) {
        let product = a * b;
        let (a_high, b_high) = (high(a), high(b));
        let (a_low, b_low) = (a - a_high, b - b_high);
        let of_product = a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low);
        let before = self.sums[index];
        let sum = before + product;
        let part = sum - before;
        self.rest[index] += ((before - (sum - part)) + (product - part)) + of_product;
        self.sums[index] = sum;
    }

    /// The sums, each rounded once; not finite where a term is beyond 1e300.
    pub fn into_sums(self) -> Vec<f64> {
        self.sums.iter().zip(&self.rest).map(|(sum, rest)| sum + rest).collect()
    }
}

#[inline]
fn high(value: f64) -> f64 {
    let scaled = SPLITTER * value;
    scaled - (scaled - value)
}
