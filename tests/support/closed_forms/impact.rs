//! Elastic bars in impact: closed forms of the waves that travel along a bar.

/// A free elastic bar on [0, L] that flies with `speed` towards a wall at the distance `gap` beyond x = L.
///
/// The end that touches stops, and a compression wave travels to the free end, which reflects it as a release wave: the
/// force of the wall is the constant `rho c v0 A` for exactly `2 L/c`, then the bar flies back with v0 and without a
/// wave.
///
/// # Source
/// K. F. Graff, *Wave Motion in Elastic Solids*, Oxford, 1975, section 2.4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactingBar {
    /// Length L of the flying bar.
    pub length: f64,
    /// Axial stiffness EA of the flying bar, in force.
    pub axial_stiffness: f64,
    /// Mass per length, rho A.
    pub line_density: f64,
    /// Speed v0 towards the wall, positive.
    pub speed: f64,
    /// Distance from the end of the bar to the wall at t = 0, zero or positive.
    pub gap: f64,
}

impl ImpactingBar {
    /// The speed of waves, `c = sqrt(EA / (rho A))`.
    pub fn wave_speed(&self) -> f64 {
        (self.axial_stiffness / self.line_density).sqrt()
    }

    /// Start and end of the contact: `g/v0` and `g/v0 + 2 L/c`.
    pub fn contact(&self) -> [f64; 2] {
        let begin = self.gap / self.speed;
        [begin, begin + 2.0 * self.length / self.wave_speed()]
    }

    /// The force of the wall on the bar during contact, `rho c v0 A`, `>= 0`.
    pub fn force(&self) -> f64 {
        self.line_density * self.wave_speed() * self.speed
    }

    /// Force times time of the whole contact: twice the momentum of the bar.
    pub fn impulse(&self) -> f64 {
        2.0 * self.line_density * self.length * self.speed
    }

    /// The energy of the bar, constant in time.
    pub fn energy(&self) -> f64 {
        self.line_density * self.length * self.speed * self.speed / 2.0
    }

    /// The displacement at x in [0, L] at time t: the point flies on until compression reaches it, rests until the
    /// release reaches it, and flies back.
    pub fn displacement(&self, x: f64, t: f64) -> f64 {
        let begin = self.contact()[0];
        let compressed = begin + (self.length - x) / self.wave_speed();
        let released = begin + (self.length + x) / self.wave_speed();
        self.speed * (t.min(compressed) - (t - released).max(0.0))
    }
}

/// The bar of length, stiffness and density 1 on [0, 1], held at x = 1, with a wall that demands `u(0) >= 0`, released
/// at rest from `u = (1 - x)/2`: its motion has the period 3, and the pressure of the wall is 1/2 during one third of
/// the period.
///
/// # Source
/// F. Dabaghi, A. Petrov, J. Pousin, Y. Renard, *Convergence of mass redistribution method for the one-dimensional wave
/// equation with a unilateral constraint at the boundary*, ESAIM: M2AN 48 (2014) 1147-1169.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BouncingBar;

impl BouncingBar {
    /// The period.
    pub const PERIOD: f64 = 3.0;
    /// The energy, constant in time.
    pub const ENERGY: f64 = 0.125;

    /// The pressure of the wall at time t, `>= 0`.
    pub fn pressure(self, t: f64) -> f64 {
        if (1.0..2.0).contains(&t.rem_euclid(Self::PERIOD)) { 0.5 } else { 0.0 }
    }

    /// The displacement at x in [0, 1] at time t.
    pub fn displacement(self, x: f64, t: f64) -> f64 {
        let t = t.rem_euclid(Self::PERIOD);
        if t < 1.0 {
            (1.0 - x.max(t)) / 2.0
        } else if t < 2.0 {
            let t = t - 1.0;
            ((t - x.max(1.0 - x)).max(0.0) - t.min(x).min(1.0 - x)) / 2.0
        } else {
            (t - 2.0).min(1.0 - x) / 2.0
        }
    }
}
