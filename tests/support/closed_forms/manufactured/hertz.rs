//! Hertz's line contact inside a half plane, at every point.

use super::complex::{Complex, I};
use super::stress_function::StressFunction;
use super::{ContactSolution, PlaneElasticity};

/// A rigid parabola below the half plane y > 0: `p = p0 sqrt(1 - x^2/a^2)`, without body force.
///
/// `Z = -(p0/a)(s + i z)` and `Zbar = -(p0/a)(z s/2 + (a^2/2) asin(z/a) + i z^2/2)` with `z = x + i y`,
/// `s = sqrt(a - z) sqrt(a + z)`. The obstacle is `u_y >= -x^2/(2R)`, `R = a E*/(2 p0)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzBlock {
    /// The elastic constants of the half plane.
    pub elasticity: PlaneElasticity,
    /// Half the width of the contact, a.
    pub half_width: f64,
    /// The largest pressure p0, at x = 0, in force per area.
    pub peak_pressure: f64,
}

impl HertzBlock {
    /// The radius of the obstacle at x = 0, `R = a E*/(2 p0)`.
    pub fn radius(&self) -> f64 {
        self.half_width * self.elasticity.contact_modulus() / (2.0 * self.peak_pressure)
    }

    fn stress_function(&self, [x, y]: [f64; 2]) -> StressFunction {
        let a = self.half_width;
        let z = Complex { re: x, im: y };
        // -y, not 0 - y: beyond the contact the sign of zero puts a - z on the lower side of the cut.
        let (left, right) = (Complex { re: a - x, im: -y }, Complex { re: a + x, im: y });
        let s = left.power(0.5) * right.power(0.5);
        let s_slope = (z * left.power(-0.5) * right.power(-0.5)).scaled(-1.0);
        let arcsine = I.scaled(-1.0) * (I * z + s).scaled(1.0 / a).ln();
        let factor = -self.peak_pressure / a;
        let integral = (z * s).scaled(0.5) + arcsine.scaled(a * a / 2.0) + (I * z * z).scaled(0.5);
        StressFunction {
            integral: integral.scaled(factor),
            value: (s + I * z).scaled(factor),
            slope: (s_slope + I).scaled(factor),
        }
    }
}

impl ContactSolution for HertzBlock {
    fn elasticity(&self) -> PlaneElasticity {
        self.elasticity
    }

    fn displacement(&self, at: [f64; 2]) -> [f64; 2] {
        self.stress_function(at).displacement(&self.elasticity, at[1])
    }

    fn gradient(&self, at: [f64; 2]) -> [[f64; 2]; 2] {
        self.stress_function(at).gradient(&self.elasticity, at[1])
    }

    fn body_force(&self, _: [f64; 2]) -> [f64; 2] {
        [0.0, 0.0]
    }

    fn pressure(&self, x: f64) -> f64 {
        self.peak_pressure * (1.0 - (x / self.half_width).powi(2)).max(0.0).sqrt()
    }

    fn gap(&self, x: f64) -> f64 {
        x * x / (2.0 * self.radius())
    }
}
