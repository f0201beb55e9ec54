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

/// Runs `work` on runs of rows, each with its parts of the vectors `ys`, which have `height` entries for each row.
pub fn in_row_chunks<T: Send, const N: usize>(
    starts: &[usize],
    height: usize,
    ys: [&mut [T]; N],
    threads: usize,
    work: impl Fn(Range<usize>, [&mut [T]; N]) + Sync,
) {
    let bounds = bounds(starts, threads);
    if let [first, last] = bounds[..] {
        return work(first..last, ys);
    }
    thread::scope(|scope| {
        let mut rest = ys;
        for pair in bounds.windows(2) {
            let parts = rest.each_mut().map(|rest| split_off(rest, (pair[1] - pair[0]) * height));
            let (work, rows) = (&work, pair[0]..pair[1]);
            scope.spawn(move || work(rows, parts));
        }
    });
}

/// Runs `work` on runs of rows, each with the values of its blocks, `size` for each.
pub fn in_block_chunks<T: Send>(
    starts: &[usize],
    size: usize,
    values: &mut [T],
    threads: usize,
    work: impl Fn(Range<usize>, &mut [T]) + Sync,
) {
    let bounds = bounds(starts, threads);
    if let [first, last] = bounds[..] {
        return work(first..last, values);
    }
    thread::scope(|scope| {
        let mut rest = values;
        for pair in bounds.windows(2) {
            let part = split_off(&mut rest, (starts[pair[1]] - starts[pair[0]]) * size);
            let (work, rows) = (&work, pair[0]..pair[1]);
            scope.spawn(move || work(rows, part));
        }
    });
}

/// Takes the first `length` entries off a slice.
fn split_off<'a, T>(rest: &mut &'a mut [T], length: usize) -> &'a mut [T] {
    let (part, others) = std::mem::take(rest).split_at_mut(length);
    *rest = others;
    part
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
