//! Planes of symmetry as they are written in a scene.

use serde::{Deserialize, Serialize};

/// A plane of symmetry, by the axis across it: where the body ends flat, at zero if it does there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SymmetryPlane {
    /// Across x.
    X,
    /// Across y.
    Y,
    /// Across z.
    Z,
}

impl SymmetryPlane {
    /// The axis across the plane, 0 to 2.
    pub fn axis(self) -> usize {
        match self {
            SymmetryPlane::X => 0,
            SymmetryPlane::Y => 1,
            SymmetryPlane::Z => 2,
        }
    }

    /// As it is written.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self.axis()]
    }
}
