//! The clock of the measurements.

use std::sync::OnceLock;
use std::time::Instant;

/// Returns the processor seconds of this thread, without the time of other programs. If the system does not report
/// them, returns wall-clock seconds.
pub fn processor_seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let from_system = || -> Option<f64> {
        // The system updates the time of a running thread when the thread yields.
        std::thread::yield_now();
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
    };
    from_system().unwrap_or_else(|| START.get_or_init(Instant::now).elapsed().as_secs_f64())
}
