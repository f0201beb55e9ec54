//! Seconds of work by the wall clock.

use std::time::Instant;

/// Returns what the work returns, and its seconds.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let clock = Instant::now();
    let done = work();
    (done, clock.elapsed().as_secs_f64())
}

/// Returns what the last run returns, and the seconds of the fastest one; at least one run is done.
pub fn fastest<T, E>(runs: usize, mut work: impl FnMut() -> Result<T, E>) -> Result<(T, f64), E> {
    let (done, mut least) = timed(&mut work);
    let mut last = done?;
    for _ in 1..runs {
        let (done, seconds) = timed(&mut work);
        (last, least) = (done?, least.min(seconds));
    }
    Ok((last, least))
}
