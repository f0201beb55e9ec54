//! Closed-form contact solutions: a bar against a wall, and the contact patch test.

/// An elastic bar on [0, L] that is held at x = 0; a wall stands at the distance `gap` beyond x = L.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Length L.
    pub length: f64,
    /// Axial stiffness EA, in force.
    pub axial_stiffness: f64,
    /// Distance from the end of the bar to the wall; negative where the wall starts inside the bar.
    pub gap: f64,
}

impl Bar {
    /// The force of the wall on the bar, `>= 0`, under an end force F: `R = max(0, F - EA g/L)`.
    ///
    /// ```
    /// let bar = signorini::analytical::Bar { length: 2.0, axial_stiffness: 10.0, gap: 0.1 };
    /// assert_eq!(bar.reaction_to_end_force(1.5), 1.0);
    /// ```
    pub fn reaction_to_end_force(&self, force: f64) -> f64 {
        (force - self.axial_stiffness * self.gap / self.length).max(0.0)
    }

    /// The displacement at x under an end force F: `u = (F - R) x / EA`, so that `u(L) = min(F L/EA, g)`.
    pub fn displacement_under_end_force(&self, force: f64, x: f64) -> f64 {
        (force - self.reaction_to_end_force(force)) * x / self.axial_stiffness
    }

    /// The force of the wall on the bar, `>= 0`, under a distributed load q (force per length):
    /// `R = max(0, q L/2 - EA g/L)`; `q = 2 EA g/L^2` just touches.
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

/// How the sides of the block of the contact patch test are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Free sides, no strain across the plane.
    PlaneStrain,
    /// Free sides, no stress across the plane.
    PlaneStress,
    /// Sides that cannot move outwards: no strain but the vertical one.
    Confined,
}

/// The contact patch test: a block on a frictionless plane below, uniformly compressed from above along y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPatch {
    /// Young's modulus E.
    pub young: f64,
    /// Poisson's ratio nu.
    pub poisson: f64,
    /// How the sides are held.
    pub sides: Sides,
}

impl ContactPatch {
    /// The modulus E' in `eps_yy = -p/E'`: E/(1-nu^2), E, or E(1-nu)/((1+nu)(1-2nu)).
    ///
    /// ```
    /// use signorini::analytical::{ContactPatch, Sides};
    /// let patch = ContactPatch { young: 3.0, poisson: 0.5, sides: Sides::PlaneStrain };
    /// assert_eq!(patch.modulus(), 4.0);
    /// ```
    pub fn modulus(&self) -> f64 {
        let (e, nu) = (self.young, self.poisson);
        match self.sides {
            Sides::PlaneStrain => e / (1.0 - nu * nu),
            Sides::PlaneStress => e,
            Sides::Confined => e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        }
    }

    /// The strains (eps_xx, eps_yy) under a pressure p `>= 0`.
    pub fn strains(&self, pressure: f64) -> (f64, f64) {
        let (e, nu) = (self.young, self.poisson);
        let across = match self.sides {
            Sides::PlaneStrain => nu * (1.0 + nu) * pressure / e,
            Sides::PlaneStress => nu * pressure / e,
            Sides::Confined => 0.0,
        };
        (across, -pressure / self.modulus())
    }

    /// The pressure when the top of a block of `height` is pressed down by `displacement` and the plane starts at the
    /// distance `gap` below it: `p = max(0, E' (d - g)/H)`.
    pub fn pressure(&self, height: f64, displacement: f64, gap: f64) -> f64 {
        (self.modulus() * (displacement - gap) / height).max(0.0)
    }
}

/// A string on (0, 1) with fixed ends, `-u'' = -q`, over an obstacle at `u >= -g`.
/// A parabola up to the contact, tangent to the obstacle there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleString {
    /// Load q per length, downwards, `>= 0`.
    pub load: f64,
    /// Distance g of the obstacle below the string at rest, `>= 0`.
    pub gap: f64,
}

impl ObstacleString {
    /// The edge b of the contact [b, 1 - b]: `sqrt(2 g / q)`, at most 1/2.
    pub fn edge(&self) -> f64 {
        (2.0 * self.gap / self.load).sqrt().min(0.5)
    }

    /// The force on the obstacle, `q (1 - 2 b)`.
    ///
    /// ```
    /// let string = signorini::analytical::ObstacleString { load: 1.0, gap: 0.08 };
    /// assert!((string.force() - 0.2).abs() < 1e-15);
    /// ```
    pub fn force(&self) -> f64 {
        self.load * (1.0 - 2.0 * self.edge())
    }

    /// The deflection at x.
    pub fn displacement(&self, x: f64) -> f64 {
        let b = self.edge();
        let from_end = x.min(1.0 - x).min(b);
        self.load * from_end * (from_end / 2.0 - b)
    }
}

/// A membrane over the unit disc with fixed rim, `-Laplace u = -q`, over an obstacle at `u >= -g`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscMembrane {
    /// Load q per area, downwards, `>= 0`.
    pub load: f64,
    /// Distance g of the obstacle below the membrane at rest, `>= 0`.
    pub gap: f64,
}

impl DiscMembrane {
    /// The radius b of the contact: `q (1 - b^2)/4 + (q b^2/2) ln b = g`; 0 where the obstacle is not reached.
    ///
    /// ```
    /// let membrane = signorini::analytical::DiscMembrane { load: 8.0, gap: 0.25 };
    /// assert!((membrane.radius() - 0.737351524416).abs() < 1e-12);
    /// assert!((membrane.force() - 13.6643514803).abs() < 1e-10);
    /// ```
    pub fn radius(&self) -> f64 {
        // The deflection at the edge of a contact of radius b falls from q/4 at b = 0 to 0 at b = 1.
        let deflection = |b: f64| self.load * ((1.0 - b * b) / 4.0 + b * b / 2.0 * b.ln());
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        if self.load / 4.0 <= self.gap {
            return 0.0;
        }
        for _ in 0..f64::MANTISSA_DIGITS + 10 {
            let middle = (low + high) / 2.0;
            if deflection(middle) > self.gap { low = middle } else { high = middle }
        }
        (low + high) / 2.0
    }

    /// The force on the obstacle, `q pi b^2`.
    pub fn force(&self) -> f64 {
        self.load * std::f64::consts::PI * self.radius() * self.radius()
    }
}
