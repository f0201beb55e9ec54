//! What is learnt from more than one solve, and the numbers that a report shows.

mod compare;
mod manufactured;
mod motion;
mod motion_tradeoff;
mod scene;
mod summary;
mod tradeoff;

pub use compare::{Agreement, Comparison, Difference, MethodAnswer, compare};
pub use manufactured::{NodalPressure, SolvedBlock, solve_block};
pub use motion::MotionSummary;
pub use motion_tradeoff::{MotionPoint, MotionTradeoff, motion_tradeoff};
pub use scene::{
    Sweep, SweepCorner, SweepEvent, SweepPoint, contact_area, contact_width, even_gaps, scene_summary, sweep,
};
pub use summary::{
    AnswerWarning, CertificateSummary, ContactSummary, HistoryEntry, ModelSize, ProvenSummary, SecondsSummary, Summary,
    Verification,
};
pub use tradeoff::{Advice, Tradeoff, TradeoffGrid, TradeoffMesh, TradeoffPoint, tradeoff};
