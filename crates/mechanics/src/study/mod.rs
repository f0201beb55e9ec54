//! Studies that take more than one solve, and the numbers of a report.

pub(crate) mod compare;
pub(crate) mod motion;
pub(crate) mod motion_tradeoff;
pub(crate) mod scene;
pub(crate) mod summary;
mod total_error;
pub(crate) mod tradeoff;
pub(crate) mod warnings;

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
