//! A string and a membrane over flat obstacles.

/// A string on (0, 1) with fixed ends, `-u'' = -q`, over an obstacle at `u >= -g`. Its deflection is a parabola up to
/// the contact, and tangent to the obstacle there.
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
    /// The radius b of the contact: `q (1 - b^2)/4 + (q b^2/2) ln b = g`; 0 if the membrane does not reach the
    /// obstacle.
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
