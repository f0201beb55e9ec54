//! The space of a model.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The space of a model, and the assumption for the directions that it leaves out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ModelSpec {
    /// A bar along x; no stress across it.
    Bar,
    /// No strain across the plane: a long body.
    #[default]
    PlaneStrain,
    /// No stress across the plane: a thin body.
    PlaneStress,
    /// A body of revolution about the y axis; x is the radius; forces are those of the full circle.
    Axisymmetric,
    /// Three dimensions.
    Space,
}

impl ModelSpec {
    /// The model as a scene writes it, such as `plane-strain`.
    pub fn name(self) -> &'static str {
        match self {
            ModelSpec::Bar => "bar",
            ModelSpec::PlaneStrain => "plane-strain",
            ModelSpec::PlaneStress => "plane-stress",
            ModelSpec::Axisymmetric => "axisymmetric",
            ModelSpec::Space => "space",
        }
    }

    /// Coordinates of a point: 1 in a bar, 2 in plane and axisymmetric models, 3 in space.
    pub fn dimension(self) -> usize {
        match self {
            ModelSpec::Bar => 1,
            ModelSpec::PlaneStrain | ModelSpec::PlaneStress | ModelSpec::Axisymmetric => 2,
            ModelSpec::Space => 3,
        }
    }
}
