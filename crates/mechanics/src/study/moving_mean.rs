//! The largest mean of a force over any window of time: a peak without oscillations shorter than the window.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// Bins of a window: with more steps, several steps share a bin. The window then moves by 1/64 of its length, and its
/// memory does not grow with the number of steps.
const MOST_BINS: usize = 64;

/// The mean over a window that moves with time, and the largest mean so far. Before the first step the force is zero.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct MovingMean {
    /// Steps of a bin.
    per_bin: usize,
    /// Bins of a window.
    bins: usize,
    /// Sums of the forces of complete bins in the window, the oldest first.
    sums: VecDeque<f64>,
    /// Steps in the current bin, and the sum of their forces.
    filling: (usize, f64),
    /// The mean over the last window, and the largest so far.
    pub latest: f64,
    pub largest: f64,
}

impl MovingMean {
    /// The mean over the whole number of steps nearest to `steps`, at least one; a bin of several has an even number of
    /// them.
    pub fn over(steps: f64) -> Self {
        let steps = (steps.round() as usize).max(1);
        let per_bin = match steps.div_ceil(MOST_BINS) {
            1 => 1,
            several => several.next_multiple_of(2),
        };
        MovingMean { per_bin, bins: (steps / per_bin).max(1), ..MovingMean::default() }
    }

    /// The number of steps of the window.
    pub fn steps(&self) -> usize {
        self.per_bin * self.bins
    }

    /// Adds the force of one more step.
    pub fn add(&mut self, force: f64) {
        let (count, sum) = (self.filling.0 + 1, self.filling.1 + force);
        if count < self.per_bin {
            self.filling = (count, sum);
            return;
        }
        self.filling = (0, 0.0);
        self.sums.push_back(sum);
        if self.sums.len() > self.bins {
            self.sums.pop_front();
        }
        self.latest = self.sums.iter().sum::<f64>() / self.steps() as f64;
        self.largest = self.largest.max(self.latest);
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST_BINS, MovingMean};

    #[test]
    fn a_window_of_many_steps_keeps_few_sums_and_the_mean_of_a_plateau() {
        let mut mean = MovingMean::over(100_000.0);
        (0..300_000).for_each(|step| mean.add(if step == 150_000 { 9e9 } else { 3.0 }));
        assert!(mean.sums.len() <= MOST_BINS && mean.steps().abs_diff(100_000) <= 100_000 / MOST_BINS);
        assert!((mean.largest - 3.0 - 9e9 / mean.steps() as f64).abs() < 1e-3, "{}", mean.largest);
    }
}
