//! The equilibrium of a problem whose rows are left out.

use crate::cost::{Kept, check_memory};
use crate::error::Error;
use crate::linear::Analysis;
use crate::problem::ContactProblem;
use crate::settings::Settings;

impl ContactProblem {
    /// The displacement `K^-1 f`, one entry per dof, in length: rows and equality rows are left out. It takes one
    /// factorisation and one step of refinement, and has no certificate. Of the settings the memory and the
    /// interruption count.
    ///
    /// # Errors
    /// [`Error::NotConvex`] for a stiffness that is not positive definite, [`Error::TooLarge`] if the factor does not
    /// fit into the memory, [`Error::Interrupted`], [`Error::Numerical`] if memory is not enough all the same.
    pub fn linear_displacement(&self, settings: &Settings) -> Result<Vec<f64>, Error> {
        let (stiffness, load) = (self.stiffness(), self.load());
        let analysis = Analysis::of(stiffness)?;
        check_memory(self, Kept::OneFactor { values: analysis.factor_entries() }, settings.memory)?;
        if settings.watch.is_over() {
            return Err(Error::Interrupted);
        }
        let factor = analysis.factor(stiffness)?;
        let mut displacement = factor.solve(load);
        let left: Vec<f64> = load.iter().zip(stiffness.mul(&displacement)).map(|(load, force)| load - force).collect();
        displacement.iter_mut().zip(factor.solve(&left)).for_each(|(value, step)| *value += step);
        Ok(displacement)
    }
}
