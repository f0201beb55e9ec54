//! What is learnt from more than one solve, and the numbers that a report shows.

mod compare;
mod motion;
mod motion_tradeoff;
mod scene;
mod summary;
mod tradeoff;
mod warnings;

pub use compare::{Agreement, Comparison, Difference, MethodAnswer, compare};
pub use motion::MotionSummary;
pub use motion_tradeoff::{MotionPoint, MotionTradeoff, motion_tradeoff};
pub use scene::{Sweep, SweepCorner, SweepEvent, SweepPoint, even_gaps, scene_summary, sweep};
#[cfg(feature = "pictures")]
pub(crate) use summary::status;
pub use summary::{ContactSummary, ModelSize, RunSeconds, Summary, Verification};
pub use tradeoff::{Advice, Tradeoff, TradeoffGrid, TradeoffMesh, TradeoffPoint, tradeoff};
pub use warnings::AnswerWarning;
