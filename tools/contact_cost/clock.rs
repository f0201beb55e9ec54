//! The clock of the measurements.

use std::sync::OnceLock;
use std::time::Instant;

/// Seconds that this thread has had a processor: other programs do not count. Wall-clock seconds where the system does
/// not tell.
pub fn processor_seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let from_system = || -> Option<f64> {
        // The account of a running thread is brought up to date when it gives way.
        std::thread::yield_now();
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
    };
    from_system().unwrap_or_else(|| START.get_or_init(Instant::now).elapsed().as_secs_f64())
}
