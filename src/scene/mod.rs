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

mod absent;
mod answer;
pub(crate) mod body;
mod build;
mod condition;
#[cfg(feature = "cli")]
mod continuum;
#[cfg(feature = "cli")]
pub(crate) mod depths;
mod dynamics;
mod elastic;
mod entry;
mod explain;
mod files;
mod held;
mod json;
#[cfg(feature = "cli")]
mod json_schema;
mod load;
mod loads_in_time;
mod locate;
mod materials;
mod model;
mod moving_supports;
mod obstacle;
mod parse;
mod part;
mod parts;
mod patch;
mod profile;
mod refine;
mod resultants;
mod rigid_body_modes;
mod rigid_face;
#[cfg(feature = "cli")]
mod roles;
mod rows;
pub(crate) mod schema;
mod segments;
mod selection;
#[cfg(feature = "pictures")]
mod set_up;
mod size;
mod springs;
#[cfg(feature = "cli")]
mod start;
mod suspect;
mod symmetry;
mod unknowns;
mod unstrained;
mod warning;
mod watched;

#[cfg(feature = "cli")]
pub(crate) use absent::absent;
pub use answer::{Answer, Forces};
pub use body::{Sides, bar, cuboid, disc, half_ball, half_disc, rectangle, ring};
pub use dynamics::Dynamics;
pub(crate) use entry::refused;
pub use model::Model;
pub use obstacle::{Obstacle, ObstacleRow, PlacedObstacle};
pub(crate) use patch::straight_cells;
pub use resultants::Resultant;
pub use rows::ContactRow;
pub use schema::{Rule, Scene, Units};
pub use segments::{ContactExtent, Segment};
#[cfg(feature = "cli")]
pub(crate) use set_up::HeldNode;
#[cfg(feature = "pictures")]
pub(crate) use set_up::Hold;
pub use size::Size;
#[cfg(feature = "cli")]
pub(crate) use start::start_scene;
#[cfg(feature = "pictures")]
pub(crate) use unknowns::Meaning;
pub use warning::Warning;
pub use watched::WatchedPoint;
