//! Sums of products of doubles without any rounding.

/// Products below this magnitude may lose their last bits to underflow.
const LEAST_PRODUCT: f64 = f64::MIN_POSITIVE / f64::EPSILON / f64::EPSILON;

/// An exact sum: parts that do not overlap, in increasing order.
///
/// # Source
/// J. R. Shewchuk, *Adaptive precision floating-point arithmetic and fast robust geometric predicates*, Discrete
/// Comput. Geom. 18 (1997) 305-363, section 2.4.
#[derive(Clone, Debug, Default)]
pub struct ExactSum {
    parts: Vec<f64>,
    is_inexact: bool,
}

impl ExactSum {
    /// Adds `a * b`.
    pub fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.is_inexact |= !product.is_finite() || (product.abs() < LEAST_PRODUCT && a != 0.0 && b != 0.0);
        self.add(a.mul_add(b, -product));
        self.add(product);
    }

    /// Adds a double.
    pub fn add(&mut self, value: f64) {
        let mut sum = value;
        let mut kept = 0;
        for index in 0..self.parts.len() {
            let part = self.parts[index];
            let next = sum + part;
            let virtually = next - sum;
            let rest = (sum - (next - virtually)) + (part - virtually);
            if rest != 0.0 {
                self.parts[kept] = rest;
                kept += 1;
            }
            sum = next;
        }
        self.parts.truncate(kept);
        self.is_inexact |= !sum.is_finite();
        if sum != 0.0 {
            self.parts.push(sum);
        }
    }

    /// The sign of the sum, -1, 0 or 1; `None` if a product left the range in which it is exact.
    pub fn sign(&self) -> Option<i32> {
        let largest = self.parts.last().copied().unwrap_or(0.0);
        (!self.is_inexact).then(|| i32::from(largest > 0.0) - i32::from(largest < 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::ExactSum;

    fn sign(products: &[(f64, f64)]) -> Option<i32> {
        let mut sum = ExactSum::default();
        products.iter().for_each(|&(a, b)| sum.add_product(a, b));
        sum.sign()
    }

    #[test]
    fn a_sum_that_cancels_to_the_last_of_three_hundred_bits_keeps_its_sign() {
        let (large, small) = (2.0_f64.powi(150), 2.0_f64.powi(-150));
        assert_eq!(sign(&[(large, 3.0), (0.1, 0.3), (small, -1.0), (large, -3.0), (-0.1, 0.3)]), Some(-1));
        assert_eq!(sign(&[(large, 3.0), (0.1, 0.3), (large, -3.0), (-0.3, 0.1)]), Some(0));
        // 0.1 times 3 is not 0.3.
        assert_eq!(sign(&[(0.1, 3.0), (-0.3, 1.0)]), Some(1));
        assert_eq!(sign(&[(1e-200, 1e-200)]), None);
        assert_eq!(sign(&[(0.0, 1e-200), (1e-310, 1.0)]), None);
    }
}
