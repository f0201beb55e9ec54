//! The state at a generic edge of a contact: the pressure is proportional to the square root of the distance from the
//! edge.

use super::complex::Complex;
use super::stress_function::StressFunction;
use super::{ContactSolution, PlaneElasticity};

/// Contact with the plane y = 0 up to x = x0: `p = 1.5 p0 sqrt(x0 - x)`, without body force.
///
/// `Zbar = -p0 zeta^1.5` with `zeta = (x0 - x) + i y`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GenericEdge {
    /// The elastic constants of the body with this edge.
    pub elasticity: PlaneElasticity,
    /// The coordinate x0 at which the contact ends.
    pub edge: f64,
    /// The factor p0 of the pressure, in force per area per square root of length.
    pub pressure: f64,
}

impl GenericEdge {
    fn stress_function(&self, [x, y]: [f64; 2]) -> StressFunction {
        let zeta = Complex { re: self.edge - x, im: y };
        StressFunction {
            integral: zeta.power(1.5).scaled(-self.pressure),
            value: zeta.power(0.5).scaled(-1.5 * self.pressure),
            slope: zeta.power(-0.5).scaled(-0.75 * self.pressure),
        }
    }
}

impl ContactSolution for GenericEdge {
    fn elasticity(&self) -> PlaneElasticity {
        self.elasticity
    }

    fn displacement(&self, at: [f64; 2]) -> [f64; 2] {
        // The stress function lives in the mirrored coordinate x0 - x.
        let [along, across] = self.stress_function(at).displacement(&self.elasticity, at[1]);
        [-along, across]
    }

    fn gradient(&self, at: [f64; 2]) -> [[f64; 2]; 2] {
        let [[xx, xy], [yx, yy]] = self.stress_function(at).gradient(&self.elasticity, at[1]);
        [[xx, -xy], [-yx, yy]]
    }

    fn body_force(&self, _: [f64; 2]) -> [f64; 2] {
        [0.0, 0.0]
    }

    fn pressure(&self, x: f64) -> f64 {
        1.5 * self.pressure * (self.edge - x).max(0.0).sqrt()
    }

    fn gap(&self, _: f64) -> f64 {
        0.0
    }
}
