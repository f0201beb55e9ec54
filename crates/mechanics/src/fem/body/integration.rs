//! How the stiffness of an element is integrated.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The integration of the stiffness of an element: in full, or with a dilatation that cannot lock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "IntegrationSpec")]
#[serde(rename_all = "kebab-case")]
pub enum Integration {
    /// The full strain at all quadrature points.
    #[default]
    Standard,
    /// The dilatation is replaced by its mean over the element: for `q4` and `hex8`, which then do not lock if
    /// Poisson's ratio is near 0.5.
    MeanDilatation,
}
