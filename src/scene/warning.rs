//! Warnings: what can be solved but may mislead, and what to do next.

use crate::fem::ElementKind;

/// Something about a scene that a reader of its answer should know.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// Elements lock when the material keeps its volume.
    #[error(
        "Poisson's ratio {poisson} locks {element} elements: pressures can come out several times too large; take \
         `\"integration\": \"mean-dilatation\"` with {} elements, a smaller ratio, or compare with a finer mesh \
         before using them",
        ElementKind::of_mean_dilatation("or").to_lowercase()
    )]
    NearlyIncompressible {
        /// The ratio.
        poisson: f64,
        /// The element, as `Q4`.
        element: &'static str,
    },
    /// No node of the candidate boundary faces the obstacle.
    #[error(
        "obstacles[{obstacle}] faces no node of its boundary: the body is solved without it; check its place, \
         its approach direction and its radius"
    )]
    NoContactRow {
        /// Which obstacle, from 0.
        obstacle: usize,
    },
    /// The scheme can gain energy.
    #[error(
        "the scheme `{scheme}` can gain energy at every blow: it is there for comparison; take `midpoint` or \
         `contact-stabilised` for answers"
    )]
    GainsEnergy {
        /// The scheme, as `trapezoidal`.
        scheme: &'static str,
    },
}
