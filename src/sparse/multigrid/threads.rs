//! Rows of a matrix shared out among threads.

use std::ops::Range;
use std::thread;

/// Blocks below which a second thread costs more than it saves.
const LEAST_BLOCKS: usize = 20_000;

/// Bounds of at most `threads` runs of rows with about the same number of blocks; `starts` as in compressed rows.
fn bounds(starts: &[usize], threads: usize) -> Vec<usize> {
    let (rows, blocks) = (starts.len() - 1, starts[starts.len() - 1]);
    let parts = threads.min(blocks / LEAST_BLOCKS).max(1);
    let mut bounds: Vec<usize> =
        (0..parts).map(|part| starts.partition_point(|&start| start < blocks / parts * part)).collect();
    bounds.push(rows);
    bounds
}

/// Runs `work` on runs of rows, each with its part of `y`, which has `height` entries for each row.
pub fn in_row_chunks<T: Send>(
    starts: &[usize],
    height: usize,
    y: &mut [T],
    threads: usize,
    work: impl Fn(Range<usize>, &mut [T]) + Sync,
) {
    let bounds = bounds(starts, threads);
    if let [first, last] = bounds[..] {
        return work(first..last, y);
    }
    thread::scope(|scope| {
        let mut rest = y;
        for pair in bounds.windows(2) {
            let (part, others) = rest.split_at_mut((pair[1] - pair[0]) * height);
            rest = others;
            let (work, rows) = (&work, pair[0]..pair[1]);
            scope.spawn(move || work(rows, part));
        }
    });
}

/// The results of `work` on runs of rows, in their order.
pub fn row_chunks<R: Send>(starts: &[usize], threads: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    let bounds = bounds(starts, threads);
    if let [first, last] = bounds[..] {
        return vec![work(first..last)];
    }
    thread::scope(|scope| {
        let runs: Vec<_> = bounds
            .windows(2)
            .map(|pair| {
                let (work, rows) = (&work, pair[0]..pair[1]);
                scope.spawn(move || work(rows))
            })
            .collect();
        runs.into_iter().filter_map(|run| run.join().ok()).collect()
    })
}
