//! The schemes: each is named only in its file and here.

mod central_difference;
mod fox_goodwin;
mod midpoint;
mod newmark;

pub use central_difference::{MOST_IN_CONTACT, frequency_bound};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use signorini_qp as qp;

use super::step::{Facts, Parameter};
use signorini_fem::assembly::MassForm;
use signorini_qp::Error;

/// The schemes to choose from, without the values of their parameters: the names that a scene uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SchemeSpec {
    /// Fox and Goodwin's two-step rule, of fourth order; the peak of the force converges, and the energy never grows.
    #[default]
    FoxGoodwin,
    /// Midpoint rule; contact nodes have no mass: preserves energy; the force rings behind wave fronts.
    Midpoint,
    /// Trapezoidal Newmark with the constraint at the end of each step: gains energy at every impact. For comparison.
    Trapezoidal,
    /// Newmark with a contact-stabilised prediction: loses a little energy at every impact, never gains.
    ContactStabilised,
    /// HHT-alpha: damps waves that the mesh does not resolve.
    Hht,
    /// Trapezoidal Newmark with penalty springs: penetrates, and gains energy if the springs are stiff. For comparison.
    Penalty,
    /// Trapezoidal Newmark with the classical loop: the penalty grows by factors of ten until nothing penetrates. For
    /// comparison.
    PenaltyLoop,
    /// Explicit central differences with Moreau's impact law; steps are small and cheap.
    CentralDifference,
}

/// Writes what follows from the list of the schemes: variant, key of its value, description.
macro_rules! schemes {
    ($($scheme:ident $({ $parameter:ident })? => $about:expr,)*) => {
        impl SchemeSpec {
            /// All schemes: the default first, those for comparison after the others, the explicit scheme last.
            pub const ALL: [SchemeSpec; 8] = [$(SchemeSpec::$scheme),*];

            /// The scheme with a value of its parameter, or with the default value.
            pub fn with(self, value: Option<f64>) -> Scheme {
                let value = value.or(self.parameter().map(|parameter| parameter.default)).unwrap_or_default();
                match self {
                    $(SchemeSpec::$scheme => Scheme::$scheme $({ $parameter: value })?,)*
                }
            }

            fn about(self) -> &'static Facts {
                match self {
                    $(SchemeSpec::$scheme => &$about,)*
                }
            }
        }

        impl Scheme {
            /// The scheme without the value of its parameter.
            pub fn spec(self) -> SchemeSpec {
                match self {
                    $(Scheme::$scheme { .. } => SchemeSpec::$scheme,)*
                }
            }

            /// The value of the parameter, dimensionless; 0 if the scheme has none.
            pub fn value(self) -> f64 {
                match self {
                    $($(Scheme::$scheme { $parameter } => $parameter,)?)*
                    _ => 0.0,
                }
            }
        }
    };
}

schemes! {
    FoxGoodwin => fox_goodwin::ABOUT,
    Midpoint => midpoint::ABOUT,
    ContactStabilised => newmark::CONTACT_STABILISED,
    Hht { alpha } => newmark::HHT,
    Trapezoidal => newmark::TRAPEZOIDAL,
    Penalty { penalty } => newmark::PENALTY,
    PenaltyLoop { threshold } => newmark::PENALTY_LOOP,
    CentralDifference { restitution } => central_difference::ABOUT,
}

impl SchemeSpec {
    /// The name by which a scene asks for the scheme.
    pub fn name(self) -> &'static str {
        self.about().name
    }

    /// Name, range and default of the parameter; `None` if the scheme has none.
    pub fn parameter(self) -> Option<Parameter> {
        self.about().parameter
    }

    /// Returns `true` for a scheme that is stable only below a limit of the step.
    pub fn is_explicit(self) -> bool {
        self.about().is_explicit
    }
}

/// A scheme of time integration.
///
/// | scheme | energy at an impact | pressure | penetration |
/// |---|---|---|---|
/// | Fox-Goodwin | lost a little, never gained | smooth | none |
/// | midpoint, redistributed mass | preserved to about 1e-5 per step | rings behind wave fronts | none |
/// | trapezoidal | **gained**, more the smaller the step | chatters | none |
/// | contact-stabilised | lost a little, never gained | smooth after some steps | none |
/// | HHT-alpha | **gained**, less than by the trapezoidal rule | chatters, damped | none |
/// | penalty | **gained** if the springs are stiff | chatters | force over penalty |
/// | penalty-loop | **gained**, as by the trapezoidal rule | chatters | below a threshold |
/// | central differences | lost a little: the mass of the contact nodes stops | smooth on lumped mass | none |
///
/// On its own the midpoint rule uses the force at the middle of a step; a node that closes in the second half does not
/// touch yet at that time. A bar of length L and cells h that hits a wall flatly would gain or lose up to
/// `(c dt/h)^2 h/(4 L)` of its energy. If the energy of a step is wrong by more than 1e-5, the step therefore uses a
/// force between those of its middle and of its ends that does the right work, at the cost of a few solves. Bodies with
/// nodes that close one after the other hardly need it; with damping it is not applied.
///
/// Implicit steps slow down short waves, and a consistent mass speeds them up: along a uniform mesh of linear elements
/// the wave number k travels with `c (1 + (1/12 - (c dt/h)^2/6) (k h)^2/2)`. The returning front is smeared over some
/// cells, and the waves behind it stay in the body: the rebound is too slow by a share that falls with h^(2/3).
///
/// `studies/impact` prints the figures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Scheme {
    /// Fox and Goodwin's two-step rule: of fourth order without contact and damping; a contact node that reaches its
    /// obstacle stops.
    #[default]
    FoxGoodwin,
    /// The midpoint rule: contact at the middle of each step; massless dofs follow in equilibrium at its end.
    Midpoint,
    /// Newmark's trapezoidal rule, beta = 1/4 and gamma = 1/2, with the constraint at the end of each step.
    ///
    /// **Gains energy**: the acceleration that stops a node in one step returns in the next. Kept to show this effect.
    Trapezoidal,
    /// Newmark's rule with a prediction that is projected onto the admissible displacements in the norm of the mass,
    /// contact forces implicit.
    ContactStabilised,
    /// HHT-alpha with beta = (1 - alpha)^2/4, gamma = 1/2 - alpha, and the constraint at the end of each step.
    ///
    /// **Gains energy** at an impact as the trapezoidal rule does, and damps it afterwards.
    Hht {
        /// Dimensionless, from -1/3 (most damping) to 0 (the trapezoidal rule).
        alpha: f64,
    },
    /// The trapezoidal rule with closed rows as springs in every step: `(K_eff + eps C) u = f_eff + eps C g` until C
    /// repeats.
    ///
    /// **Gains energy** if the springs are stiff, and penetrates if they are soft.
    Penalty {
        /// Stiffness of the springs eps in multiples of the local stiffness of a step, positive.
        penalty: f64,
    },
    /// The trapezoidal rule with the classical loop in every step: the penalty of [`Scheme::Penalty`] grows by factors
    /// of ten, and C is found again, until norm\[C (u - g)\] is below a threshold.
    ///
    /// **Gains energy** as the trapezoidal rule does, because the last springs are stiff.
    PenaltyLoop {
        /// Largest norm of the penetration over the largest displacement of the body, positive and at most 0.1.
        threshold: f64,
    },
    /// Central differences: explicit; a node that would cross the obstacle gets an impulse, by Moreau's law.
    CentralDifference {
        /// Velocity of a node after its impact over that before, from 0 to 1.
        restitution: f64,
    },
}

impl Scheme {
    /// The name of the scheme in scenes and reports.
    pub fn name(self) -> &'static str {
        self.spec().name()
    }

    /// Returns `true` if the scheme can gain energy at an impact.
    pub fn gains_energy(self) -> bool {
        self.about().gains_energy
    }

    /// Returns `true` if closed rows are springs, so that no answer of a step is certified.
    pub fn penetrates(self) -> bool {
        self.about().penetrates
    }

    /// The form of the mass that a motion takes if its scene names none.
    pub fn mass_form(self) -> MassForm {
        self.about().masses[0]
    }

    /// Returns `true` if the scheme can use a mass of this form. Only the midpoint rule allows dofs without mass; the
    /// explicit scheme needs a diagonal mass.
    pub fn allows(self, form: MassForm) -> bool {
        self.about().masses.contains(&form)
    }

    /// Returns `true` if the scheme is stable only below a limit of the step.
    pub fn is_explicit(self) -> bool {
        self.spec().is_explicit()
    }

    /// Returns `true` if, with a mass of this form, the energy grows whenever bodies touch.
    pub fn is_unstable_in_contact(self, form: MassForm) -> bool {
        self.about().unstable_in_contact.contains(&form)
    }

    /// Checks the range of the parameter.
    pub fn check(self) -> Result<(), Error> {
        let value = self.value();
        match self.spec().parameter() {
            Some(Parameter { name, allows, range, .. }) if !allows(value) => {
                Err(qp::LinearError::Setting { name, value, allowed: range }.into())
            }
            _ => Ok(()),
        }
    }

    /// What else is known of the scheme, and the function that prepares its steps.
    pub fn about(self) -> &'static Facts {
        self.spec().about()
    }
}
