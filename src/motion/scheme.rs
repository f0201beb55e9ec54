//! The schemes, and what is known of them.

use crate::error::Error;
use crate::fem::assembly::MassForm;

/// A scheme of time integration.
///
/// | scheme | energy at a blow | pressure | penetration |
/// |---|---|---|---|
/// | midpoint, redistributed mass | kept to about 1e-5 a step | smooth | none |
/// | trapezoidal | **gained**, more the smaller the step | chatters | none |
/// | contact-stabilised | lost a little, never gained | smooth after some steps | none |
/// | HHT-alpha | **gained**, less than by the trapezoidal rule | chatters, damped | none |
/// | penalty | **gained** where the springs are stiff | chatters | force over penalty |
/// | central differences | lost a little: the mass of the contact nodes stops | smooth on lumped mass | none |
///
/// Alone the midpoint rule takes the force of the middle of a step, where a node that closes in its second half does not
/// touch yet. A bar of length L and cells h that hits a wall flatly would gain or lose up to `(c dt/h)^2 h/(4 L)` of its
/// energy. A step that is off by more than 1e-5 therefore takes a force between those of its middle and of its ends that
/// does the right work, at the cost of a few steps; bodies whose nodes close one after the other hardly need it, and with
/// damping it is left out.
///
/// Implicit steps slow short waves, a consistent mass quickens them: along a uniform mesh of linear elements the wave number
/// k travels with `c (1 + (1/12 - (c dt/h)^2/6) (k h)^2/2)`. The front that comes back is smeared over some cells, and what
/// trails behind it stays in the body: the rebound is slow by a share that falls with h^(2/3).
///
/// `tools/impact` prints the figures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Scheme {
    /// The midpoint rule: contact at the middle of each step; massless dofs follow in equilibrium at its end.
    #[default]
    Midpoint,
    /// Newmark's trapezoidal rule, beta = 1/4 and gamma = 1/2, with the constraint at the end of each step.
    ///
    /// **Gains energy**: the acceleration that stops a node in one step returns in the next. Kept to show it.
    Trapezoidal,
    /// Newmark's rule with a prediction that is projected onto the admissible displacements in the norm of the mass,
    /// contact forces implicit.
    ContactStabilised,
    /// HHT-alpha with beta = (1 - alpha)^2/4, gamma = 1/2 - alpha, and the constraint at the end of each step.
    ///
    /// **Gains energy** at a blow as the trapezoidal rule does, and damps it afterwards.
    Hht {
        /// From -1/3 (most damping) to 0 (the trapezoidal rule).
        alpha: f64,
    },
    /// The trapezoidal rule with closed rows as springs in every step: `(K_eff + eps C) u = f_eff + eps C g` until C
    /// repeats.
    ///
    /// **Gains energy** where the springs are stiff, and penetrates where they are soft.
    Penalty {
        /// Stiffness of the springs eps in multiples of the local stiffness of a step, positive.
        penalty: f64,
    },
    /// Central differences: explicit; a node that would cross the obstacle gets an impulse, by Moreau's law.
    CentralDifference {
        /// Velocity after over before the blow of a node, from 0 to 1.
        restitution: f64,
    },
}

impl Scheme {
    /// The name in scenes and reports.
    pub fn name(self) -> &'static str {
        match self {
            Scheme::Midpoint => "midpoint",
            Scheme::Trapezoidal => "trapezoidal",
            Scheme::ContactStabilised => "contact-stabilised",
            Scheme::Hht { .. } => "hht",
            Scheme::Penalty { .. } => "penalty",
            Scheme::CentralDifference { .. } => "central-difference",
        }
    }

    /// Can it gain energy at a blow?
    pub fn gains_energy(self) -> bool {
        matches!(self, Scheme::Trapezoidal | Scheme::Hht { .. } | Scheme::Penalty { .. })
    }

    /// The form of the mass that suits it.
    pub fn mass_form(self) -> MassForm {
        match self {
            Scheme::Midpoint => MassForm::Redistributed,
            Scheme::CentralDifference { .. } => MassForm::Lumped,
            _ => MassForm::Consistent,
        }
    }

    /// Can it use a mass of this form? Only the midpoint rule knows dofs without mass, and the explicit scheme needs a
    /// diagonal.
    pub fn allows(self, form: MassForm) -> bool {
        match self {
            Scheme::Midpoint => true,
            Scheme::CentralDifference { .. } => form == MassForm::Lumped,
            _ => form != MassForm::Redistributed,
        }
    }

    /// Is it limited in its step?
    pub fn is_explicit(self) -> bool {
        matches!(self, Scheme::CentralDifference { .. })
    }

    /// Are its parameters in their ranges?
    ///
    /// # Errors
    /// [`Error::Setting`] for one that is not.
    pub fn check(self) -> Result<(), Error> {
        let (name, value, is_right, allowed) = match self {
            Scheme::Hht { alpha } => ("alpha", alpha, (-1.0 / 3.0..=0.0).contains(&alpha), "from -1/3 to 0"),
            Scheme::Penalty { penalty } => {
                ("penalty", penalty, penalty.is_finite() && penalty > 0.0, "positive and finite")
            }
            Scheme::CentralDifference { restitution } => {
                ("restitution", restitution, (0.0..=1.0).contains(&restitution), "from 0 to 1")
            }
            Scheme::Midpoint | Scheme::Trapezoidal | Scheme::ContactStabilised => return Ok(()),
        };
        if is_right { Ok(()) } else { Err(Error::Setting { name, value, allowed }) }
    }
}
