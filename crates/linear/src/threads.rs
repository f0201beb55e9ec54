//! Work shared out among threads; the number of threads changes no result.

use std::ops::Range;

use rayon::prelude::*;

use super::Spare;
use super::real::Real;

/// Blocks below which a second thread costs more than it saves.
const LEAST_BLOCKS: usize = 20_000;

/// More threads share the memory of one machine without being faster.
const MOST_THREADS: usize = 8;

/// Number of processors for one problem: all of the machine, at most 8, because more would wait for the same memory.
pub fn threads_of_machine() -> usize {
    rayon::current_num_threads().min(MOST_THREADS)
}

/// The results of `work` on each part, in the order of the parts; a panic in one of them is one of the caller.
pub fn in_order<P: Send, R: Send>(parts: Vec<P>, work: impl Fn(P) -> R + Sync) -> Vec<R> {
    match parts.len() {
        // No thread is started.
        1 => parts.into_iter().map(work).collect(),
        _ => parts.into_par_iter().map(&work).collect(),
    }
}

/// Adds to y what `work` makes of each part: the first works on y itself, each other on zeros as many as `length` says,
/// which are added in the order of the parts. If the parts depend on the matrix alone, so does the sum.
pub fn add_parts<T: Real>(
    parts: &[Range<usize>],
    y: &mut [T],
    (threads, spare): (usize, &Spare<T>),
    length: impl Fn(&Range<usize>) -> usize,
    work: impl Fn(Range<usize>, &mut [T]) + Sync,
) {
    let mut sums: Vec<Vec<T>> = parts[1..].iter().map(|part| spare.zeros(length(part))).collect();
    let vectors = [&mut *y].into_iter().chain(sums.iter_mut().map(Vec::as_mut_slice));
    let mut parts: Vec<(Range<usize>, &mut [T])> = parts.iter().cloned().zip(vectors).collect();
    let of_thread = parts.len().div_ceil(threads);
    in_order(parts.chunks_mut(of_thread).collect(), |share| {
        share.iter_mut().for_each(|(part, sums)| work(part.clone(), sums));
    });
    for sum in sums {
        y.iter_mut().zip(&sum).for_each(|(y, &sum)| *y += sum);
        spare.give(sum);
    }
}

/// Rows of blocks to be shared out.
#[derive(Clone, Copy)]
pub struct SharedRows<'a> {
    /// The start of each row, as in compressed rows.
    pub starts: &'a [usize],
    pub threads: usize,
}

impl SharedRows<'_> {
    /// At most `threads` runs of rows with about the same number of blocks.
    pub fn runs(&self) -> Vec<Range<usize>> {
        self.runs_of(LEAST_BLOCKS)
    }

    /// The same with at least this number of blocks each.
    pub fn runs_of(&self, least: usize) -> Vec<Range<usize>> {
        let (rows, first) = (self.starts.len() - 1, self.starts[0]);
        let blocks = self.starts[rows] - first;
        let parts = self.threads.min(blocks / least).max(1);
        let bound = |part: usize| match part == parts {
            true => rows,
            false => self.starts.partition_point(|&start| start - first < blocks / parts * part),
        };
        (0..parts).map(|part| bound(part)..bound(part + 1)).collect()
    }

    /// The results of `work` on runs of rows, in their order.
    pub fn map<R: Send>(&self, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
        in_order(self.runs(), work)
    }

    /// Runs `work` on runs of rows, each with its parts of the vectors `ys`, which have `height` entries for each row.
    pub fn with_vectors<T: Send, const N: usize>(
        &self,
        height: usize,
        ys: [&mut [T]; N],
        work: impl Fn(Range<usize>, [&mut [T]; N]) + Sync,
    ) {
        self.with_parts(ys, |rows| rows.len() * height, work);
    }

    /// Runs `work` on runs of rows, each with the next entries of the vectors `ys`, as many as the `length` of the run.
    pub fn with_parts<T: Send, const N: usize>(
        &self,
        mut ys: [&mut [T]; N],
        length: impl Fn(&Range<usize>) -> usize,
        work: impl Fn(Range<usize>, [&mut [T]; N]) + Sync,
    ) {
        let with_parts = |rows: Range<usize>| {
            let parts = ys.each_mut().map(|rest| rest.split_off_mut(..length(&rows)).unwrap_or_default());
            (rows, parts)
        };
        in_order(self.runs().into_iter().map(with_parts).collect(), |(rows, parts)| work(rows, parts));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::guarded;

    /// A hundred rows of as many blocks as two threads need.
    const ROWS: usize = 100;

    fn starts() -> Vec<usize> {
        (0..=ROWS).map(|row| row * 4 * LEAST_BLOCKS / ROWS).collect()
    }

    #[test]
    fn results_come_in_the_order_of_the_rows() {
        for threads in 1..=4 {
            let rows: Vec<usize> =
                SharedRows { starts: &starts(), threads }.map(|rows| rows.collect::<Vec<_>>()).concat();
            assert_eq!(rows, (0..ROWS).collect::<Vec<_>>());
        }
    }

    #[test]
    fn no_row_is_lost_if_one_thread_panics() {
        let broken = |rows: Range<usize>| assert!(!rows.contains(&(ROWS / 2)), "row {} is broken", ROWS / 2);
        for threads in 1..=4 {
            let (starts, mut values) = (starts(), vec![0.0; 4 * LEAST_BLOCKS]);
            let shared = SharedRows { starts: &starts, threads };
            let of_rows = guarded(|| shared.map(broken));
            let in_place = guarded(|| shared.with_vectors(1, [&mut [0.0; ROWS][..]], |rows, _| broken(rows)));
            let length = |rows: &Range<usize>| starts[rows.end] - starts[rows.start];
            let in_blocks = guarded(|| shared.with_parts([&mut values[..]], length, |rows, _| broken(rows)));
            for ended in [of_rows.map(drop), in_place, in_blocks] {
                assert_eq!(ended, Err("it panicked: row 50 is broken".to_string()));
            }
        }
    }
}
