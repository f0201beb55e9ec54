//! An elastic bar against a wall.

/// An elastic bar on [0, L] that is fixed at x = 0, with a wall at the distance `gap` beyond x = L.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Length L of the bar.
    pub length: f64,
    /// Axial stiffness EA of the bar, in force.
    pub axial_stiffness: f64,
    /// Distance from the end of the bar to the wall; negative if the wall starts inside the bar.
    pub gap: f64,
}

impl Bar {
    /// The force of the wall on the bar, `>= 0`, under an end force F: `R = max(0, F - EA g/L)`.
    pub fn reaction_to_end_force(&self, force: f64) -> f64 {
        (force - self.axial_stiffness * self.gap / self.length).max(0.0)
    }

    /// The displacement at x under an end force F: `u = (F - R) x / EA`, so that `u(L) = min(F L/EA, g)`.
    pub fn displacement_under_end_force(&self, force: f64, x: f64) -> f64 {
        (force - self.reaction_to_end_force(force)) * x / self.axial_stiffness
    }

    /// The force of the wall on the bar, `>= 0`, under a distributed load q (force per length):
    /// `R = max(0, q L/2 - EA g/L)`. At `q = 2 EA g/L^2` the bar just touches the wall.
    pub fn reaction_to_distributed_load(&self, load: f64) -> f64 {
        (load * self.length / 2.0 - self.axial_stiffness * self.gap / self.length).max(0.0)
    }

    /// The displacement at x under a distributed load q: `u = q (2 L x - x^2)/(2 EA) - R x/EA`.
    ///
    /// Linear elements are exact at their nodes.
    pub fn displacement_under_distributed_load(&self, load: f64, x: f64) -> f64 {
        let free = load * (2.0 * self.length - x) * x / (2.0 * self.axial_stiffness);
        free - self.reaction_to_distributed_load(load) * x / self.axial_stiffness
    }
}
