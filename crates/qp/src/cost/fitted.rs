//! The rules and the costs that `cargo run --release --example fit_rules` fits to measured times.

/// A method with its settings and precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    ActiveSet,
    ActiveSetMixed,
    Qp,
    #[allow(dead_code, reason = "the fit may choose it")]
    QpUnpolished,
    Penalty,
    PenaltyRung,
}

/// The way for an accuracy and all lower accuracies, and for sizes up to `up_to` that no other step of that accuracy
/// covers.
///
/// The size of a condensed problem is the multiplications of its factor. That of an uncondensed one, with a
/// factorisation in every iteration, is the multiplications for each row: a measure of the width of the factor relative
/// to its contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub condensed: bool,
    pub accuracy: f64,
    pub up_to: f64,
    pub way: Way,
}

/// Seconds of a factorisation: a constant, and one for each multiplication and each value of the factor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cost {
    constant: f64,
    pub per_multiplication: f64,
    per_value: f64,
}

impl Cost {
    pub const fn seconds(&self, multiplications: f64, values: f64) -> f64 {
        self.constant + self.per_multiplication * multiplications + self.per_value * values
    }

    const fn is_positive(&self) -> bool {
        let grows = self.per_multiplication >= 0.0 && self.per_value >= 0.0;
        grows && self.constant > 0.0 && self.seconds(1.0, 1.0).is_finite()
    }
}

const _: () = assert!(DOUBLE.is_positive() && SINGLE.is_positive());

// Written by the fit.

/// The fitted steps: for each layout, from the lowest accuracy and the smallest size on.
pub(crate) static STEPS: &[Step] = &[
    Step { condensed: true, accuracy: 0.01, up_to: 5505159.319426391, way: Way::PenaltyRung },
    Step { condensed: true, accuracy: 0.01, up_to: f64::INFINITY, way: Way::ActiveSetMixed },
    Step { condensed: true, accuracy: 0.0001, up_to: 3009145.971288116, way: Way::PenaltyRung },
    Step { condensed: true, accuracy: 0.0001, up_to: 5505159.319426391, way: Way::ActiveSet },
    Step { condensed: true, accuracy: 0.0001, up_to: f64::INFINITY, way: Way::ActiveSetMixed },
    Step { condensed: true, accuracy: 1e-8, up_to: 23158229.293324918, way: Way::PenaltyRung },
    Step { condensed: true, accuracy: 1e-8, up_to: f64::INFINITY, way: Way::ActiveSetMixed },
    Step { condensed: true, accuracy: 0.0, up_to: f64::INFINITY, way: Way::ActiveSet },
    Step { condensed: false, accuracy: 0.01, up_to: 51.308321828811444, way: Way::PenaltyRung },
    Step { condensed: false, accuracy: 0.01, up_to: 79.65692651929272, way: Way::Penalty },
    Step { condensed: false, accuracy: 0.01, up_to: f64::INFINITY, way: Way::PenaltyRung },
    Step { condensed: false, accuracy: 0.0001, up_to: 51.308321828811444, way: Way::PenaltyRung },
    Step { condensed: false, accuracy: 0.0001, up_to: 79.65692651929272, way: Way::Penalty },
    Step { condensed: false, accuracy: 0.0001, up_to: f64::INFINITY, way: Way::PenaltyRung },
    Step { condensed: false, accuracy: 1e-8, up_to: 54.080247087083464, way: Way::PenaltyRung },
    Step { condensed: false, accuracy: 1e-8, up_to: 79.65692651929272, way: Way::Penalty },
    Step { condensed: false, accuracy: 1e-8, up_to: f64::INFINITY, way: Way::PenaltyRung },
    Step { condensed: false, accuracy: 0.0, up_to: f64::INFINITY, way: Way::ActiveSet },
];

/// The cost in double precision.
pub(crate) const DOUBLE: Cost =
    Cost { constant: 5.368756525846558e-5, per_multiplication: 8.08092133649479e-12, per_value: 1.4591985906590454e-8 };

/// The cost in single precision.
pub(crate) const SINGLE: Cost =
    Cost { constant: 9.792442995284003e-5, per_multiplication: 0.0, per_value: 1.3863251361012751e-8 };
