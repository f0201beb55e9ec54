//! Planes of symmetry as they are written in a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A plane of symmetry, given by the axis normal to it. It lies at the flat end of the body, at zero if the body has a
/// flat end there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SymmetryPlane {
    /// Normal to x.
    X,
    /// Normal to y.
    Y,
    /// Normal to z.
    Z,
}

impl SymmetryPlane {
    /// The axis normal to the plane, 0 to 2.
    pub fn axis(self) -> usize {
        self as usize
    }

    /// The axis normal to the plane, as a scene writes it.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self.axis()]
    }
}
