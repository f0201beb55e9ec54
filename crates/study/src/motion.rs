//! The numbers of a motion for the report of a run, gathered step by step; the largest mean over any window of time.

use std::collections::VecDeque;

use super::warnings::FEW_NODES;
use serde::{Deserialize, Serialize};
use signorini_mechanics::motion::Observation;
use signorini_mechanics::scene::{Model, Warning};

/// Largest allowed growth of the energy, relative to the initial energy and the work of the loads; a motion beyond it
/// is not reliable.
///
/// It lies between two groups of measurements on bars, blocks and discs: 0.01 % by `midpoint`, none by `fox-goodwin`,
/// `contact-stabilised` and central differences, up to 0.5 % by other schemes in good cases; from 5 % to 6,000 % in
/// schemes that gain energy. A gain of 1 % is 0.5 % of the speeds.
const MOST_GROWTH: f64 = 0.01;

/// A share of the energy that a scheme takes without a word.
const MOST_TAKEN: f64 = 0.01;

/// Times, forces and impulse of the obstacles of a motion: of all together, or of one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionContact {
    /// Time at which the first contact began, `None` if nothing touched: its first two steps count by their forces over
    /// that of the third.
    pub first: Option<f64>,
    /// Time at which the last contact ended, or the end of the last step with a force; its last two steps count
    /// likewise.
    pub last: Option<f64>,
    /// Sum of the lengths of all contacts, in time.
    pub duration: f64,
    /// The contact forces of the last two steps, the older one first, and of the step before them.
    forces: [f64; 2],
    third_last: f64,
    /// The steps of the contact that lasts, and the number of contacts so far.
    run: usize,
    contacts: usize,
    /// Largest contact force of a single step, in force, `>= 0`; it does not converge in a mesh that oscillates behind
    /// a wave front.
    pub force_max: f64,
    /// Mean of the contact force over a window of time, and its largest value; each half of a step is one of its
    /// values.
    force_mean: MovingMean,
    /// The same over the time of a wave through a few cells, and over twice that time.
    peak: MovingMean,
    pub(super) wide: MovingMean,
    /// Integral of the contact force over time, in force times time, `>= 0`.
    pub impulse: f64,
    /// The largest number of rows with a force in one step; 0 for all obstacles together.
    #[serde(default)]
    pub rows_max: usize,
}

impl MotionContact {
    /// Nothing touched yet; the force and its peak are averaged over the whole numbers of steps that are nearest to
    /// `steps`.
    fn averaged_over(steps: [f64; 2]) -> Self {
        let halves = steps.map(|steps| 2.0 * steps.round().max(1.0));
        let [force_mean, peak] = halves.map(MovingMean::over);
        MotionContact { force_mean, peak, wide: MovingMean::over(2.0 * halves[1]), ..MotionContact::default() }
    }

    /// Adds a step with its contact force, which acted from one time to another: for half of a `step`, or for all of
    /// it.
    fn add(&mut self, force: f64, [from, to]: [f64; 2], step: f64) {
        let length = to - from;
        if force > 0.0 {
            if self.run == 0 {
                self.contacts += 1;
                self.first.get_or_insert(from);
            }
            self.run += 1;
            self.last = Some(to);
            self.duration += length;
            self.impulse += force * length;
            self.force_max = self.force_max.max(force);
        }
        let [before, last] = self.forces;
        if force > 0.0 && self.run == 3 {
            let late = length * missing([before, last], force);
            self.duration -= late;
            if self.contacts == 1 {
                self.first = self.first.map(|first| first + late);
            }
        }
        if force == 0.0 && self.run > 2 {
            let early = length * missing([before, last], self.third_last);
            self.duration -= early;
            self.last = self.last.map(|last| last - early);
        }
        if force == 0.0 {
            self.run = 0;
        }
        (self.third_last, self.forces) = (before, [last, force]);
        for _ in 0..if length < 0.75 * step { 1 } else { 2 } {
            self.force_mean.add(force);
            self.peak.add(force);
            self.wide.add(force);
        }
    }

    /// Largest mean of the contact force over any window of [`MotionSummary::window_steps`] steps, in force.
    pub fn force_mean_max(&self) -> f64 {
        self.force_mean.largest
    }

    /// The mean of the contact force over the last [`MotionSummary::peak_steps`] steps, in force, `>= 0`.
    pub fn mean_force(&self) -> f64 {
        self.peak.latest
    }

    /// The peak of the contact force: its largest mean over [`MotionSummary::peak_steps`] steps, in force.
    pub fn peak_force(&self) -> f64 {
        self.peak.largest
    }
}

/// What is missing in two steps at the beginning or the end of a contact, in steps, beside the force of the step next
/// to them.
fn missing(forces: [f64; 2], beside: f64) -> f64 {
    forces.into_iter().map(|force| (1.0 - force / beside).clamp(0.0, 1.0)).sum()
}

/// The summary of a run, gathered step by step; its size does not depend on the number of steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionSummary {
    /// Number of steps that the run has made.
    pub steps: usize,
    /// Time from the start of the motion to the last step.
    pub time: f64,
    /// The sum of the forces of all obstacles over time.
    pub contact: MotionContact,
    /// The force of each obstacle and pair of bodies over time, in the order of the scene.
    pub obstacles: Vec<MotionContact>,
    /// Deepest penetration of a row in the run so far, in length.
    pub penetration_max: f64,
    /// Kinetic, strain and potential energy at the start, in this order, in force times length.
    pub energy_first: [f64; 3],
    /// Kinetic, strain and potential energy after the last step, in this order, in force times length.
    pub energy_last: [f64; 3],
    /// Smallest and largest sum of the three energies so far, in this order, in force times length.
    pub energy_range: [f64; 2],
    /// Largest sum of kinetic and strain energy, in force times length: the reference for energies.
    pub energy_scale: f64,
    /// Total number of penalties in all steps, and the largest number in one step; 0 in schemes without a loop over
    /// penalties.
    pub penalties: [usize; 2],
    /// Work of loads and moving obstacles in the whole run so far, in force times length.
    pub work: f64,
    /// Energy that damping took in the whole run so far, in force times length.
    pub damped: f64,
    /// The largest work of the loads so far, in force times length, `>= 0`.
    pub work_max: f64,
    /// The largest excess of kinetic and strain energy over the work of the loads, `>= 0`, in force times length.
    pub excess_max: f64,
}

impl MotionSummary {
    /// A run with a number of obstacles that starts as `seen`; the force and its peak are averaged over whole numbers
    /// of steps of length `step`: those nearest to `windows`, in time.
    pub fn starting(seen: &Observation, obstacles: usize, windows: [f64; 2], step: f64) -> Self {
        let contact = MotionContact::averaged_over(windows.map(|window| window / step));
        let energies = [seen.kinetic, seen.strain, seen.potential];
        MotionSummary {
            time: seen.time,
            penetration_max: seen.penetration,
            energy_first: energies,
            energy_last: energies,
            energy_range: [seen.energy(); 2],
            energy_scale: seen.kinetic + seen.strain,
            obstacles: vec![contact.clone(); obstacles],
            contact,
            ..MotionSummary::default()
        }
    }

    /// Adds one step: for each obstacle the force with which it pressed, in force, `>= 0`, and the number of its rows
    /// with a force.
    pub fn add(&mut self, seen: &Observation, of_obstacles: &[(f64, usize)]) {
        self.steps += 1;
        let step = seen.time - self.time;
        self.time = seen.time;
        self.contact.add(seen.force, seen.acting, step);
        for (one, &(force, rows)) in self.obstacles.iter_mut().zip(of_obstacles) {
            one.add(force, seen.acting, step);
            one.rows_max = one.rows_max.max(rows);
        }
        self.penetration_max = self.penetration_max.max(seen.penetration);
        self.energy_last = [seen.kinetic, seen.strain, seen.potential];
        let [least, most] = self.energy_range;
        self.energy_range = [least.min(seen.energy()), most.max(seen.energy())];
        self.energy_scale = self.energy_scale.max(seen.kinetic + seen.strain);
        self.penalties = [self.penalties[0] + seen.penalties, self.penalties[1].max(seen.penalties)];
        (self.work, self.damped) = (seen.work, seen.damped);
        self.work_max = self.work_max.max(seen.work);
        self.excess_max = self.excess_max.max(seen.kinetic + seen.strain - self.initial_energy() - seen.work);
    }

    /// Steps of the window over which the force is averaged.
    pub fn window_steps(&self) -> usize {
        self.contact.force_mean.steps() / 2
    }

    /// Steps over which the peak of the force is averaged.
    pub fn peak_steps(&self) -> usize {
        self.contact.peak.steps() / 2
    }

    /// Kinetic and strain energy at the start.
    pub fn initial_energy(&self) -> f64 {
        self.energy_first[0] + self.energy_first[1]
    }

    /// The energy that the scheme took: what the start, the loads and the obstacles put in, less what is there and what
    /// damping took, in force times length; negative if it gave some.
    pub fn taken_by_scheme(&self) -> f64 {
        self.initial_energy() + self.work - self.damped - self.energy_last[0] - self.energy_last[1]
    }

    /// Present and largest kinetic and strain energy, in this order, over the initial one, relative; `None` for a
    /// motion that starts with zero energy.
    pub fn over_initial(&self) -> Option<[f64; 2]> {
        let initial = self.initial_energy();
        (initial > 0.0).then(|| [self.energy_last[0] + self.energy_last[1], self.energy_scale].map(|now| now / initial))
    }

    /// Returns `true` if the energy grew by more than 1 %: the motion is not reliable.
    pub fn is_unstable(&self) -> bool {
        self.growth() > MOST_GROWTH
    }

    /// The largest growth of energy without work of the loads, over the initial energy and the largest work of the
    /// loads.
    pub fn growth(&self) -> f64 {
        let given = self.initial_energy() + self.work_max;
        if self.excess_max > 0.0 { self.excess_max / given } else { 0.0 }
    }

    /// Warnings for this motion of a model.
    pub fn warnings(&self, model: &Model) -> Vec<Warning> {
        [self.unstable(), self.takes_energy(), self.few_rows(model)].into_iter().flatten().collect()
    }

    /// Warns of a contact that closes one or two nodes in every step: its force depends on the mesh.
    fn few_rows(&self, model: &Model) -> Option<Warning> {
        let is_small = |(index, one): &(usize, &MotionContact)| {
            let rows = 1..=FEW_NODES.min(model.obstacles()[*index].candidates().len().saturating_sub(1));
            rows.contains(&one.rows_max)
        };
        let of_body = self.obstacles.iter().enumerate().filter(|_| model.mesh().dimension() > 1);
        let (index, one) = of_body.into_iter().find(is_small)?;
        let nodes = if one.rows_max == 1 { "one node" } else { "two nodes" };
        let message = format!(
            "the contact of obstacles[{index}] closes at most {nodes} in a step. Peak force and times depend on the mesh there: \
             refine it near the contact and compare"
        );
        Some(Warning { code: "mesh-dependent", message })
    }

    /// Warns of a scheme that takes a visible share of the energy, once a contact is over.
    fn takes_energy(&self) -> Option<Warning> {
        let share = self.taken_by_scheme() / self.energy_scale;
        let message = || {
            format!(
                "the scheme takes {:.1} % of the energy, {:.3e} of {:.3e}, at the impacts. A finer mesh near the \
                 contact and a smaller step lose less",
                100.0 * share,
                self.taken_by_scheme(),
                self.energy_scale
            )
        };
        (share > MOST_TAKEN && self.contact.run == 0).then(|| Warning { code: "takes-energy", message: message() })
    }

    /// Warns of an energy that grows by more than 1 %.
    fn unstable(&self) -> Option<Warning> {
        if !self.is_unstable() {
            return None;
        }
        let message = format!(
            "the energy grew by {:.1} %: by {:.3e} beyond the {:.3e} at the start and the {:.3e} that loads put in; more than \
             {:.0} % is unstable: do not trust this motion. Take the scheme `fox-goodwin` or \
             `midpoint`, or a smaller step",
            100.0 * self.growth(),
            self.excess_max,
            self.initial_energy(),
            self.work_max,
            100.0 * MOST_GROWTH
        );
        Some(Warning { code: "unstable", message })
    }

    /// The present sum of the energies minus the initial sum, over the largest kinetic and strain energy.
    pub fn energy_change(&self) -> f64 {
        self.relative(self.energy_last.iter().sum())
    }

    /// The largest sum of the energies minus the initial sum, over the largest kinetic and strain energy.
    pub fn energy_gain(&self) -> f64 {
        self.relative(self.energy_range[1])
    }

    fn relative(&self, energy: f64) -> f64 {
        let change = energy - self.energy_first.iter().sum::<f64>();
        if change == 0.0 { 0.0 } else { change / self.energy_scale }
    }
}

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
