//! The side from which an obstacle comes, and the rule for its rows.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A direction along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Approach {
    /// Along x.
    #[serde(rename = "+x")]
    PlusX,
    /// Against x.
    #[serde(rename = "-x")]
    MinusX,
    /// Along y.
    #[serde(rename = "+y")]
    PlusY,
    /// Against y.
    #[serde(rename = "-y")]
    MinusY,
    /// Along z.
    #[serde(rename = "+z")]
    PlusZ,
    /// Against z.
    #[serde(rename = "-z")]
    MinusZ,
}

impl Approach {
    /// The axis, 0 to 2, and the sense along it, 1 or -1.
    pub fn axis(self) -> (usize, f64) {
        match self {
            Approach::PlusX => (0, 1.0),
            Approach::MinusX => (0, -1.0),
            Approach::PlusY => (1, 1.0),
            Approach::MinusY => (1, -1.0),
            Approach::PlusZ => (2, 1.0),
            Approach::MinusZ => (2, -1.0),
        }
    }

    /// The direction as a scene writes it, such as `-y`.
    pub fn name(self) -> &'static str {
        match self {
            Approach::PlusX => "+x",
            Approach::MinusX => "-x",
            Approach::PlusY => "+y",
            Approach::MinusY => "-y",
            Approach::PlusZ => "+z",
            Approach::MinusZ => "-z",
        }
    }
}

/// The rule for the contact row of a candidate node: its direction, and the point of the obstacle that it meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// Along the approach direction: `u . approach <= distance along it`; one entry per row.
    #[default]
    Approach,
    /// Along the obstacle's normal at the point closest to the node: `n . u <= distance`; one entry per coordinate.
    ClosestPoint,
}
