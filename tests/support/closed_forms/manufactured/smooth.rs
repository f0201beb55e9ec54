//! A contact whose displacement has as many derivatives as a test chooses.

use super::{ContactSolution, PlaneElasticity};

/// Contact with the plane y = 0 for x <= x0; beyond x0 a gap opens with the power k: `u_x = -y alpha'`,
/// `u_y = alpha - y beta/M`, `alpha = A (x-x0)_+^k`, `beta = B (x0-x)_+^k`.
///
/// The pressure is beta, the opening gap is alpha. With `k >= 3` the body force jumps only in its highest derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smooth {
    /// The elastic constants of the body with this gap.
    pub elasticity: PlaneElasticity,
    /// The factor A of the gap that opens.
    pub opening: f64,
    /// The factor B of the pressure.
    pub pressure: f64,
    /// The coordinate x0 at which the gap begins to open.
    pub edge: f64,
    /// The power k.
    pub power: u8,
}

impl Smooth {
    /// `factor (distance)_+^k` and its first three derivatives with respect to the distance.
    fn powers(&self, factor: f64, distance: f64) -> [f64; 4] {
        let power = f64::from(self.power);
        let (mut derivatives, mut product) = ([0.0; 4], factor);
        for (order, derivative) in derivatives.iter_mut().enumerate() {
            let left = i32::from(self.power) - order as i32;
            if distance > 0.0 && left >= 0 {
                *derivative = product * distance.powi(left);
            }
            product *= power - order as f64;
        }
        derivatives
    }

    fn alpha(&self, x: f64) -> [f64; 4] {
        self.powers(self.opening, x - self.edge)
    }

    fn beta(&self, x: f64) -> [f64; 4] {
        let [value, first, second, third] = self.powers(self.pressure, self.edge - x);
        [value, -first, second, -third]
    }
}

impl ContactSolution for Smooth {
    fn elasticity(&self) -> PlaneElasticity {
        self.elasticity
    }

    fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (alpha, beta) = (self.alpha(x), self.beta(x));
        [-y * alpha[1], alpha[0] - y * beta[0] / self.elasticity.confined_modulus()]
    }

    fn gradient(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        let (alpha, beta, modulus) = (self.alpha(x), self.beta(x), self.elasticity.confined_modulus());
        [[-y * alpha[2], -alpha[1]], [alpha[1] - y * beta[1] / modulus, -beta[0] / modulus]]
    }

    fn body_force(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (alpha, beta, modulus) = (self.alpha(x), self.beta(x), self.elasticity.confined_modulus());
        let PlaneElasticity { lambda, mu } = self.elasticity;
        [modulus * y * alpha[3] + (lambda + mu) * beta[1] / modulus, mu * y * beta[2] / modulus + lambda * alpha[2]]
    }

    fn pressure(&self, x: f64) -> f64 {
        self.beta(x)[0]
    }

    fn gap(&self, _: f64) -> f64 {
        0.0
    }
}
