//! Studies that take more than one solve, and the numbers of a report.
//!
//! ```
//! use signorini_mechanics::Scene;
//! let scene = Scene::from_json(
//!     r#"{
//!         "model": "bar",
//!         "body": {"bar": {"x": {"points": [0, 2], "divisions": [4]}}},
//!         "material": {"young": 100, "poisson": 0},
//!         "supports": [{"on": {"boundary": "left"}, "x": 0}],
//!         "loads": [{"force": {"boundary": "right", "value": [3]}}],
//!         "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2.04], "normal": [1]}}}]
//!     }"#,
//!     "rod",
//! )?;
//! let model = scene.build()?;
//! // Every method finds the same answer.
//! let comparison = signorini_study::compare(model.problem(), &signorini_qp::Settings::default())?;
//! assert!(comparison.agreement.exact_methods && comparison.agreement.penalty_within_its_bound);
//! # Ok::<(), signorini_mechanics::Error>(())
//! ```

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]
#![allow(clippy::missing_errors_doc, reason = "the sentence of an error says what is wrong")]

mod compare;
mod motion;
mod motion_tradeoff;
mod scene;
mod summary;
mod total_error;
mod tradeoff;
mod warnings;

pub use compare::{Agreement, Comparison, Difference, MethodAnswer, compare};
pub use motion::{MotionContact, MotionSummary};
pub use motion_tradeoff::{MotionError, MotionPoint, MotionTradeoff};
pub use scene::{ExactPath, ProblemPoint, ProblemSweep, Sweep, SweepCorner, SweepEvent, SweepPoint};
pub use summary::{ContactSummary, ModelSize, ObstacleContact, RunSeconds, Status, Summary, Verification};
pub use total_error::{
    Bound, ContinuumAnswer, Domain, Ended, Examined, Guarantee, JudgedMesh, Level, LevelKind, TotalError,
    TotalErrorGoal, total_error,
};
pub use tradeoff::{Advice, Tradeoff, TradeoffGrid, TradeoffMesh, TradeoffPoint};
