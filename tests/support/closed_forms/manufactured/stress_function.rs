//! The state of a stress function, without shear stress on y = 0:
//! `2 mu u_x = (kappa-1)/2 Re Zbar - y Im Z`, `2 mu u_y = (kappa+1)/2 Im Zbar - y Re Z`, `Z = Zbar'`.
//!
//! # Source
//! H. M. Westergaard, *Bearing pressures and cracks*, Journal of Applied Mechanics 6 (1939) A49-A53.

use super::PlaneElasticity;
use super::complex::Complex;

/// A stress function and its derivatives at one point.
pub(super) struct StressFunction {
    /// Zbar.
    pub integral: Complex,
    /// Z = Zbar'; `sigma_yy = Re Z` on y = 0.
    pub value: Complex,
    /// Z'.
    pub slope: Complex,
}

impl StressFunction {
    /// The displacement [u_x, u_y] at the height y.
    pub fn displacement(&self, elastic: &PlaneElasticity, y: f64) -> [f64; 2] {
        let (kappa, double) = (elastic.kolosov(), 2.0 * elastic.mu);
        let along = (kappa - 1.0) / 2.0 * self.integral.re - y * self.value.im;
        let across = (kappa + 1.0) / 2.0 * self.integral.im - y * self.value.re;
        [along / double, across / double]
    }

    /// The displacement gradient `[[du_x/dx, du_x/dy], [du_y/dx, du_y/dy]]` at the height y.
    pub fn gradient(&self, elastic: &PlaneElasticity, y: f64) -> [[f64; 2]; 2] {
        let (kappa, double) = (elastic.kolosov(), 2.0 * elastic.mu);
        let (value, slope) = (self.value, self.slope);
        // At the end of the contact Z' is infinite, but y Z' goes to zero.
        let [re, im] = if y == 0.0 { [0.0, 0.0] } else { [y * slope.re, y * slope.im] };
        let (less, more) = ((kappa - 1.0) / 2.0, (kappa + 1.0) / 2.0);
        [
            [(less * value.re - im) / double, (-more * value.im - re) / double],
            [(more * value.im - re) / double, (less * value.re + im) / double],
        ]
    }
}
