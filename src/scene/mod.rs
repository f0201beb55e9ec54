//! Scenes: a JSON text becomes a checked model of bodies, supports, loads and obstacles.
//!
//! ```
//! let text = r#"{
//!     "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [4]}, "y": {"points": [0, 1], "divisions": [4]}}},
//!     "material": {"young": 1e7, "poisson": 0.3},
//!     "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
//!     "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 1], "normal": [0, 1]}}}],
//!     "gap": -0.01
//! }"#;
//! let model = signorini::Scene::from_json(text, "scene")?.build()?;
//! assert_eq!(model.problem().dofs(), 40);
//! assert_eq!(model.problem().gap(), [-0.01; 5]);
//! # Ok::<(), signorini::Error>(())
//! ```

mod body;
mod build;
mod condition;
mod dynamics;
mod explain;
mod held;
mod locate;
mod mesh;
mod model;
mod obstacle;
mod parse;
mod parts;
mod refine;
mod rigid_modes;
mod rows;
mod schema;
mod size;
mod warning;

pub use dynamics::Dynamics;
pub use model::Model;
pub use obstacle::Obstacle;
pub use rows::ContactRow;
pub use schema::{
    AnalysisSpec, Approach, AxisSpec, BarSpec, BodySpec, BoxSpec, CircleSpec, ConeSpec, CylinderSpec, DampingSpec,
    DiscSpec, DynamicSpec, ElementSpec, FacingSpec, FactorSpec, FactorTableSpec, FieldSpec, ForceSpec, FurtherBodySpec,
    GmshSpec, HalfBallSpec, HalfDiscSpec, HalfSpec, HeightMapSpec, InitialSpec, IntegrationSpec, IntervalSpec,
    LoadInTimeSpec, LoadSpec, MassSpec, MaterialSpec, ModelSpec, ObstacleSpec, ParabolaSpec, PenetrationSpec, Place,
    PlaneSpec, PressureSpec, RectangleSpec, RingSpec, Rule, Scene, SchemeSpec, ShapeSpec, SineSpec, SolidElementSpec,
    SphereSpec, SupportSpec, SymmetrySpec, TableSpec, TractionSpec, Units, WedgeSpec, ZoneSpec,
};
pub use size::Size;
pub use warning::Warning;

use build::located;

use crate::error::Error;

/// A point named in a scene must lie on a node, and a table must reach a candidate, to within this times the body's
/// size: above the rounding of written decimals, far below any cell.
const PLACE_TOLERANCE: f64 = 1e-9;

/// Lengths below this times the body's size are rounding of coordinates.
const ROUNDING: f64 = 1e-12;

fn wrong(path: impl Into<String>, message: impl Into<String>) -> Error {
    Error::Scene { path: path.into(), message: message.into() }
}

fn finite(path: impl Into<String>, value: f64) -> Result<(), Error> {
    if value.is_finite() { Ok(()) } else { Err(wrong(path, format!("{value} is not finite"))) }
}

fn finite_pair(path: &str, pair: [f64; 2]) -> Result<(), Error> {
    finite(format!("{path}[0]"), pair[0])?;
    finite(format!("{path}[1]"), pair[1])
}

/// A number as a reader writes it: plain in the middle, with an exponent at the extremes.
fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-4..1e7).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// A point as a reader writes it, with as many coordinates as it has entries.
fn point(at: &[f64]) -> String {
    let coordinates: Vec<String> = at.iter().map(|&coordinate| number(coordinate)).collect();
    format!("({})", coordinates.join(", "))
}

/// A point or vector of a scene in `dimension` coordinates; those beyond are zero.
fn vector(path: &str, entries: &[f64], dimension: usize) -> Result<[f64; 3], Error> {
    if entries.len() != dimension {
        let (found, names) = (entries.len(), ["[x]", "[x, y]", "[x, y, z]"][dimension - 1]);
        return Err(wrong(path, format!("the array has {found} entries; in this model it has {dimension}: {names}")));
    }
    let mut vector = [0.0; 3];
    for (index, (place, &entry)) in vector.iter_mut().zip(entries).enumerate() {
        finite(format!("{path}[{index}]"), entry)?;
        *place = entry;
    }
    Ok(vector)
}
