//! Work on many elements or nodes, shared out among the threads of the pool of rayon; the number of threads changes no
//! bit of a result.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use signorini_linear::threads_of_machine;

/// Elements, or nodes, of a run: their work is worth a thread, and their results fit into its cache.
const RUN: usize = 1024;

/// Runs of a thread whose results wait to be taken.
const WAITING: usize = 8;

/// The number of threads that was asked for; 0 if none was.
static LIMIT: AtomicUsize = AtomicUsize::new(0);

/// Lets assembly and the recovery of stresses take this number of threads in this process, at least 1, instead of those
/// of the machine (8 at most). The number changes no bit of a result.
pub fn limit_threads(threads: usize) {
    LIMIT.store(threads.max(1), Ordering::Relaxed);
}

fn threads() -> usize {
    match LIMIT.load(Ordering::Relaxed) {
        0 => threads_of_machine(),
        threads => threads,
    }
}

/// Takes the results of `work` on runs of `0..count`, in their order; each run is worked on by one thread.
pub fn in_order<R: Send>(count: usize, work: impl Fn(Range<usize>) -> R + Sync, mut take: impl FnMut(R)) {
    let starts: Vec<usize> = (0..count).step_by(RUN).collect();
    let run = |&start: &usize| work(start..count.min(start + RUN));
    let threads = threads();
    if threads == 1 || starts.len() == 1 {
        return starts.iter().map(run).for_each(take);
    }
    for waiting in starts.chunks(threads * WAITING) {
        let of_thread = |starts: &[usize]| starts.iter().map(run).collect::<Vec<R>>();
        let results: Vec<Vec<R>> = waiting.par_chunks(WAITING).map(of_thread).collect();
        results.into_iter().flatten().for_each(&mut take);
    }
}

/// The results of `work` on each of `0..count`, in their order.
pub fn each<R: Send>(count: usize, work: impl Fn(usize) -> R + Sync) -> Vec<R> {
    let mut all = Vec::with_capacity(count);
    in_order(count, |run| run.map(&work).collect::<Vec<R>>(), |results| all.extend(results));
    all
}

/// The results of two pieces of work.
pub fn both<A: Send, B: Send>(one: impl FnOnce() -> A + Send, other: impl FnOnce() -> B + Send) -> (A, B) {
    if threads() == 1 { (one(), other()) } else { rayon::join(one, other) }
}

/// The parts of `values` between consecutive `bounds`, each given to `work` with its number; a part is worked on by one
/// thread.
pub fn on_parts<T: Send>(values: &mut [T], bounds: &[usize], work: impl Fn(usize, &mut [T]) + Sync) {
    let mut rest = values;
    let lengths = bounds.windows(2).map(|pair| pair[1] - pair[0]);
    let parts: Vec<&mut [T]> = lengths.map(|length| rest.split_off_mut(..length).unwrap_or_default()).collect();
    match parts.len() {
        // No thread is started.
        0 | 1 => parts.into_iter().enumerate().for_each(|(part, values)| work(part, values)),
        _ => parts.into_par_iter().enumerate().for_each(|(part, values)| work(part, values)),
    }
}

/// Number of parts that `count` pieces of work are worth on the threads of the pool: at least 1.
pub fn parts(count: usize) -> usize {
    (count / RUN).clamp(1, threads())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_their_order() {
        for count in [0, 1, RUN, RUN + 1, 40 * RUN + 7] {
            assert_eq!(each(count, |index| index), (0..count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn parts_are_those_between_the_bounds() {
        let mut values = vec![0; 10];
        on_parts(&mut values, &[0, 3, 3, 10], |part, values| values.fill(part + 1));
        assert_eq!(values, [1, 1, 1, 3, 3, 3, 3, 3, 3, 3]);
    }
}
