//! Bodies with round sides, and bodies from mesh files, as they are written in a scene.

use serde::{Deserialize, Serialize};

use super::json::{object, word, words};
use super::{AxisSpec, ElementSpec, IntegrationSpec, one};

/// A mesh written by Gmsh: a `.msh` file of version 4.1 or 2.2 in ASCII. A bar has the cross-section 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GmshSpec {
    /// The file, below the folder of the scene unless that is allowed to read outside; a relative name starts there.
    pub file: String,
    /// What the coordinates of the file are multiplied by, positive.
    #[serde(default = "one")]
    pub scale: f64,
    /// The physical group that is the body; all elements of the highest dimension where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// How the stiffness is integrated.
    #[serde(default, deserialize_with = "word")]
    pub integration: IntegrationSpec,
}

/// Half of a disc, the lower one where not said otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct HalfDiscSpec {
    /// The centre [x, y].
    #[serde(default)]
    pub centre: [f64; 2],
    /// Which half; the upper one is the mirror image of the lower one, graded towards its highest point.
    #[serde(default, deserialize_with = "word", skip_serializing_if = "HalfSpec::is_lower")]
    pub half: HalfSpec,
    /// Radius, positive.
    pub radius: f64,
    /// The finely meshed zone around the lowest (highest) point.
    #[serde(deserialize_with = "object")]
    pub zone: ZoneSpec,
    /// Only the part right of the centre; the plane x = centre becomes the boundary `symmetry-x`.
    #[serde(default)]
    pub symmetric: bool,
    /// The element.
    #[serde(default, deserialize_with = "word")]
    pub element: ElementSpec,
    /// How its stiffness is integrated.
    #[serde(default, deserialize_with = "word")]
    pub integration: IntegrationSpec,
}

/// A disc, graded towards its lowest and its highest point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DiscSpec {
    /// The centre [x, y].
    #[serde(default)]
    pub centre: [f64; 2],
    /// Radius, positive.
    pub radius: f64,
    /// The finely meshed zone around the lowest and the highest point.
    #[serde(deserialize_with = "object")]
    pub zone: ZoneSpec,
    /// Only the part right of the centre; the plane x = centre becomes the boundary `symmetry-x`.
    #[serde(default)]
    pub symmetric: bool,
    /// The element.
    #[serde(default, deserialize_with = "word")]
    pub element: ElementSpec,
    /// How its stiffness is integrated.
    #[serde(default, deserialize_with = "word")]
    pub integration: IntegrationSpec,
}

/// Half of a ball, the lower one where not said otherwise, of `hex8`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct HalfBallSpec {
    /// The centre [x, y, z].
    #[serde(default)]
    pub centre: [f64; 3],
    /// Which half; the upper one is the mirror image of the lower one, graded towards its highest point.
    #[serde(default, deserialize_with = "word", skip_serializing_if = "HalfSpec::is_lower")]
    pub half: HalfSpec,
    /// Radius, positive.
    pub radius: f64,
    /// The finely meshed zone around the lowest (highest) point.
    #[serde(deserialize_with = "object")]
    pub zone: ZoneSpec,
    /// Axes along which only the part beyond the centre is meshed; the planes through the centre become the boundaries
    /// `symmetry-x` and `symmetry-y`.
    #[serde(default, deserialize_with = "words")]
    pub symmetric: Vec<SymmetrySpec>,
    /// How its stiffness is integrated.
    #[serde(default, deserialize_with = "word")]
    pub integration: IntegrationSpec,
}

/// The half of a disc or a ball.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum HalfSpec {
    /// Below the centre.
    #[default]
    Lower,
    /// Above the centre.
    Upper,
}

impl HalfSpec {
    fn is_lower(&self) -> bool {
        *self == HalfSpec::Lower
    }
}

/// The axis across a plane of symmetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SymmetrySpec {
    /// Along x.
    X,
    /// Along y.
    Y,
}

/// A ring or a sector of it: the product of a radial axis and an angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RingSpec {
    /// The centre [x, y].
    #[serde(default)]
    pub centre: [f64; 2],
    /// The radial axis, from the inner to the outer radius.
    #[serde(deserialize_with = "object")]
    pub radius: AxisSpec,
    /// The angle in degrees, counterclockwise from x; the ring closes where it spans 360.
    #[serde(deserialize_with = "object")]
    pub angle: AxisSpec,
    /// The element.
    #[serde(default, deserialize_with = "word")]
    pub element: ElementSpec,
    /// How its stiffness is integrated.
    #[serde(default, deserialize_with = "word")]
    pub integration: IntegrationSpec,
}

/// The finely meshed zone around the lowest (highest) point of a round body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ZoneSpec {
    /// How far the cells of one size reach from the lowest point, to each side and into the body: positive, at most the
    /// radius. Twice the expected contact half-width is a good choice.
    pub width: f64,
    /// Cells on this width, at least 1.
    pub divisions: usize,
    /// Size of each further cell over that of its neighbour towards the zone, from 1 to 10.
    #[serde(default = "growth")]
    pub growth: f64,
}

fn growth() -> f64 {
    1.2
}
