//! What is learnt from more than one solve, and the numbers that a report shows.

mod compare;
mod summary;

pub use compare::{Agreement, Comparison, Difference, MethodAnswer, compare};
pub use summary::{CertificateSummary, ContactSummary, ModelSize, SecondsSummary, Summary};
