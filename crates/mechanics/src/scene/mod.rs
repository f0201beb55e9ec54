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
//! let model = signorini_mechanics::Scene::from_json(text, "scene")?.build()?;
//! assert_eq!(model.problem().dofs(), 40);
//! assert_eq!(model.problem().gap(), [-0.01; 5]);
//! # Ok::<(), signorini_mechanics::Error>(())
//! ```

pub(crate) mod answers;
pub(crate) mod derivatives;
pub(crate) mod input;
pub(crate) mod models;
mod modes;
mod motions;

pub use answers::answer::{Answer, Forces};
pub use answers::segments::{ContactExtent, Segment};
pub use derivatives::sensitivity::{ByParameter, Sensitivities, Sensitivity, outputs_of};
pub use input::body::{Sides, bar, cuboid, disc, half_ball, half_disc, rectangle, ring};
pub use input::deck::requests::{RequestedTable, Requests};
pub(crate) use input::entry::refused;
pub use input::obstacle::{Inertia, Obstacle, ObstacleRow, PlacedObstacle};
pub use input::schema::{Rule, Scene, Units};
pub use input::size::Size;
pub use input::warning::Warning;
pub use models::model::Model;
pub use models::resultants::Resultant;
pub use models::rows::ContactRow;
pub use models::set_up::{HeldNode, Hold};
pub use models::unknowns::Meaning;
pub use modes::ModalAnalysis;
pub use motions::dynamics::Dynamics;
pub use motions::moving_supports::WatchedPoint;
