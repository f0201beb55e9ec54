//! Studies that take more than one solve, and the numbers of a report.

mod compare;
mod exact_path;
mod front;
mod kept_answers;
mod motion;
mod motion_tradeoff;
mod moving_mean;
mod obstacles;
#[cfg(feature = "cli")]
mod problem_sweep;
pub(crate) mod scene;
mod summary;
#[cfg(feature = "cli")]
pub(crate) mod total_error;
mod tradeoff;
mod warnings;

pub use compare::{Agreement, Comparison, Difference, MethodAnswer, compare};
#[cfg(feature = "cli")]
pub(crate) use front::on_front;
pub use motion::{MotionContact, MotionSummary};
pub use motion_tradeoff::{MotionPoint, MotionTradeoff, motion_tradeoff};
#[cfg(feature = "cli")]
pub(crate) use problem_sweep::{ProblemPoint, ProblemSweep, sweep_problem};
pub use scene::{Sweep, SweepCorner, SweepEvent, SweepPoint, scene_summary};
#[cfg(feature = "pictures")]
pub(crate) use summary::ObstacleContact;
pub use summary::{ContactSummary, ModelSize, RunSeconds, Status, Summary, Verification};
pub use tradeoff::{Advice, Tradeoff, TradeoffGrid, TradeoffMesh, TradeoffPoint, tradeoff};
pub use warnings::AnswerWarning;
