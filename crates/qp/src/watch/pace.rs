//! The speed of this machine against the estimates of cost.

/// Work shorter than this is too short to measure the pace.
const TELLING_SECONDS: f64 = 1e-3;

/// Measured seconds per estimated second; `None` before anything was measured.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace(pub Option<f64>);

impl Pace {
    /// Seconds that work with this `estimate` in seconds needs.
    pub fn seconds(self, estimate: f64) -> f64 {
        estimate * self.0.unwrap_or(1.0)
    }

    /// The pace after work that was estimated to take `estimate` seconds and took `seconds`.
    pub fn after(self, estimate: f64, seconds: f64) -> Self {
        if estimate >= TELLING_SECONDS { Pace(Some(seconds / estimate)) } else { self }
    }
}
