//! Exact solutions of Signorini's problem in a body y > 0 over a rigid obstacle that starts at y = 0: displacement, its
//! gradient, body force and contact pressure at every point.
//!
//! With the exact displacement prescribed on its other sides, a block `[0, 1]^2` has this solution, and the errors of a
//! discretisation can be measured in norms.

mod complex;
mod edge;
mod hertz;
mod smooth;
mod stress_function;

pub use edge::GenericEdge;
pub use hertz::HertzBlock;
pub use smooth::Smooth;

/// The constants of an isotropic elastic body in the plane, in force per area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneElasticity {
    /// lambda, for the trace of the strains in the plane.
    pub lambda: f64,
    /// mu, the shear modulus.
    pub mu: f64,
}

impl PlaneElasticity {
    /// The constants in plane strain of Young's modulus E and Poisson's ratio nu.
    pub fn plane_strain(young: f64, poisson: f64) -> Self {
        let mu = young / (1.0 + poisson) / 2.0;
        PlaneElasticity { lambda: 2.0 * mu * poisson / (1.0 - 2.0 * poisson), mu }
    }

    /// The modulus of confined compression, `M = lambda + 2 mu`.
    pub fn confined_modulus(&self) -> f64 {
        self.lambda + 2.0 * self.mu
    }

    /// Kolosov's constant, `kappa = (lambda + 3 mu)/(lambda + mu)`: 3 - 4 nu in plane strain.
    pub fn kolosov(&self) -> f64 {
        (self.lambda + 3.0 * self.mu) / (self.lambda + self.mu)
    }

    /// The contact modulus `E* = 4 mu (lambda + mu)/(lambda + 2 mu)`: E/(1-nu^2) in plane strain.
    pub fn contact_modulus(&self) -> f64 {
        4.0 * self.mu * (self.lambda + self.mu) / self.confined_modulus()
    }
}

/// A body y > 0 over a rigid, frictionless obstacle, with its exact state.
pub trait ContactSolution {
    /// The elastic constants of the body.
    fn elasticity(&self) -> PlaneElasticity;

    /// The displacement [u_x, u_y] at [x, y], y >= 0, in length.
    fn displacement(&self, at: [f64; 2]) -> [f64; 2];

    /// The displacement gradient `[[du_x/dx, du_x/dy], [du_y/dx, du_y/dy]]` at [x, y], y >= 0.
    fn gradient(&self, at: [f64; 2]) -> [[f64; 2]; 2];

    /// The body force [f_x, f_y] at [x, y], in force per volume.
    fn body_force(&self, at: [f64; 2]) -> [f64; 2];

    /// The contact pressure at x on y = 0, `>= 0`, in force per area.
    fn pressure(&self, x: f64) -> f64;

    /// The distance of the obstacle below y = 0 at x: `-u_y <= gap`, in length.
    fn gap(&self, x: f64) -> f64;

    /// The stress [sigma_xx, sigma_yy, sigma_xy] at [x, y], y >= 0, in force per area.
    fn stress(&self, at: [f64; 2]) -> [f64; 3] {
        let PlaneElasticity { lambda, mu } = self.elasticity();
        let [[xx, xy], [yx, yy]] = self.gradient(at);
        [lambda * (xx + yy) + 2.0 * mu * xx, lambda * (xx + yy) + 2.0 * mu * yy, mu * (xy + yx)]
    }
}
