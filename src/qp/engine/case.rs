//! What an engine is asked for.

use super::loading::Load;
use crate::qp::method::Start;
use crate::qp::settings::Settings;

/// What an engine is asked for.
pub(super) struct Case<'a> {
    pub load: &'a Load,
    /// Gaps, one entry per row.
    pub gap: &'a [f64],
    pub start: &'a Start,
    /// Settings whose clock runs.
    pub settings: &'a Settings,
}
