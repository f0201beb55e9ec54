//! The scene as it is written: typed, with defaults, unknown fields refused.

use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

pub(crate) mod analysis;
pub(crate) mod body;
pub(crate) mod condition;
pub(crate) mod model;
pub(crate) mod obstacle;
pub(crate) mod tie;

pub use analysis::{
    AnalysisSpec, DynamicSpec, FactorSpec, FieldSpec, LoadInTimeSpec, ModesSpec, PenetrationSpec, WatchSpec,
};
pub use body::{
    FurtherBodySpec, InitialStressSpec, MaterialPartSpec, MaterialSpec, OrthotropicSpec, PartSpec, TemperatureSpec,
};
pub use condition::{LoadSpec, PlaceSpec, RigidFaceSpec, SupportSpec, SymmetryPlane};
pub use model::{ModelSpec, Rule};
pub use obstacle::{ContactSpec, ObstacleSpec};
pub use tie::{
    CouplingSpec, EquationSpec, PointSpec, PreloadSpec, SpringSpec, TermPlace, TermSpec, TieSpec, TiedSurfacesSpec,
};

use std::path::PathBuf;

use super::body::BodySpec;
use super::warning::Warning;

/// The format of scenes that this program reads.
const FORMAT: u32 = 1;

/// A contact scene: an elastic body, its supports and loads, and the obstacles around it.
///
/// Any consistent system of units. Points and vectors have as many entries as the model has coordinates: `[x]` in a
/// bar, `[x, y]` in the plane and about an axis, `[x, y, z]` in space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Scene {
    /// Path of the JSON Schema of scenes, for editors: a file that `signorini schema` printed. The program does not
    /// read it.
    #[serde(rename = "$schema", skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// Version of the format of scenes: 1, the only one so far. Later formats will have other numbers, and be refused
    /// by programs that do not read them.
    #[serde(default, deserialize_with = "format", skip_serializing_if = "Option::is_none")]
    #[schemars(extend("const" = 1))]
    pub format: Option<u32>,
    /// Title: what the scene shows.
    #[serde(default)]
    pub title: String,
    /// Names of the units, for tables and pictures.
    #[serde(default)]
    pub units: Units,
    /// The space that holds the physics, and what happens in the directions that it leaves out.
    #[serde(default)]
    pub model: ModelSpec,
    /// Depth across the plane, positive; only in plane strain and plane stress.
    #[serde(default = "model::one")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub thickness: f64,
    /// The shape and the mesh of the elastic body.
    pub body: BodySpec,
    /// The material of the body, except of the elements that `materials` name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialSpec>,
    /// The materials of parts of the body, by groups of the mesh file or by boxes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<MaterialPartSpec>,
    /// Temperature above that of the body without stress.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub temperature: Vec<TemperatureSpec>,
    /// Stresses at zero strain.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub initial_stress: Vec<InitialStressSpec>,
    /// Further elastic bodies, joined to the first and to each other by contact only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further_bodies: Vec<FurtherBodySpec>,
    /// Parts of boundaries, each with a name that is a boundary like any other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartSpec>,
    /// Prescribed displacements.
    #[serde(default)]
    pub supports: Vec<SupportSpec>,
    /// Boundaries that move as rigid plates.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rigid_faces: Vec<RigidFaceSpec>,
    /// Places that move without being nodes: couplings, equations and springs join them to nodes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<PointSpec>,
    /// Displacements that are tied to each other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ties: Vec<TieSpec>,
    /// Springs between the bodies and the ground, or between nodes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<SpringSpec>,
    /// Planes of symmetry: the body is a half, a quarter or an eighth of a whole. Each is supported, and forces and
    /// areas in reports are those of the whole.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub symmetry: Vec<SymmetryPlane>,
    /// External loads; they add up.
    #[serde(default)]
    pub loads: Vec<LoadSpec>,
    /// Frictionless obstacles: rigid ones, or the surfaces of other bodies.
    #[serde(default)]
    pub obstacles: Vec<ObstacleSpec>,
    /// The contacts between bodies besides those in `obstacles`: none, or all that are found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactSpec>,
    /// Shift of every obstacle along its own approach direction; a negative shift moves it towards, and into, the body.
    #[serde(default)]
    pub gap: f64,
    /// The analysis: the equilibrium if this is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub analysis: Option<AnalysisSpec>,
    /// The folder of the scene file: relative file names start there. Not part of the text.
    #[serde(skip)]
    pub folder: Option<PathBuf>,
    /// `true` if the scene may name files outside its folder. Not part of the text.
    #[serde(skip)]
    pub reads_outside: bool,
    /// `true` if the answer of small displacements is wanted whatever its strains and rotations are, also to a deck
    /// that asks for large displacements. Not part of the text.
    #[serde(skip)]
    pub is_linear: bool,
    /// Warnings about the deck that the scene was read from. Not part of the text.
    #[serde(skip)]
    pub noted: Vec<Warning>,
    /// The files and lines of that deck for JSON paths; the first is that of the whole scene. Not part of the text.
    #[serde(skip)]
    pub lines: Vec<(String, (PathBuf, usize))>,
}

/// Accepts the number of the one format of scenes.
fn format<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u32>, D::Error> {
    match u32::deserialize(deserializer)? {
        FORMAT => Ok(Some(FORMAT)),
        other => Err(D::Error::custom(format_args!(
            "format {other} of scenes is not known; this program reads format {FORMAT}"
        ))),
    }
}

/// Names of the units of length and force, for tables and pictures. They convert no number of a scene, which may have
/// any consistent system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Units {
    /// Name of the unit of all coordinates and displacements, as `m`.
    pub length: String,
    /// Name of the unit of all forces and multipliers, as `N`.
    pub force: String,
}

impl Default for Units {
    fn default() -> Self {
        Units { length: "m".into(), force: "N".into() }
    }
}

impl Units {
    /// The units of a problem that names none.
    pub fn unnamed() -> Self {
        Units { length: String::new(), force: String::new() }
    }

    /// The unit of time of motions: `s` for newtons and metres or millimetres, with a consistent mass; else none.
    pub fn time(&self) -> &'static str {
        let is_metric = ["N", "kN", "MN"].contains(&self.force.as_str()) && ["m", "mm"].contains(&self.length.as_str());
        if is_metric { "s" } else { "" }
    }

    /// The unit of length over that of time, as a reader writes it.
    pub fn velocity(&self) -> String {
        match self.time() {
            "" => String::new(),
            time => format!("{}/{time}", self.length),
        }
    }

    /// Pascals in a unit of force over a unit of length squared, if the length is in millimetres: a scene that names no
    /// units has metres, which may stand for any consistent system.
    pub(crate) fn pascals(&self) -> Option<f64> {
        let newtons = match self.force.as_str() {
            "N" => 1.0,
            "kN" => 1e3,
            "MN" => 1e6,
            _ => return None,
        };
        (self.length == "mm").then_some(newtons * 1e6)
    }

    /// The unit of pressure and stress: `Pa`, `MPa`, or force over length squared.
    pub fn pressure(&self) -> String {
        match (self.force.as_str(), self.length.as_str()) {
            ("N", "m") => "Pa".into(),
            ("N", "mm") => "MPa".into(),
            ("", "") => String::new(),
            (force, length) => format!("{force}/{length}²"),
        }
    }
}
