//! The numbers of a motion: what the report of a run says, gathered step by step.

use serde::{Deserialize, Serialize};

use crate::motion::Observation;

/// What a run has come to, gathered step by step; its size does not depend on how many there were.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionSummary {
    /// Steps so far.
    pub steps: usize,
    /// Time so far.
    pub time: f64,
    /// Time at which the first contact force acted, at the middle of its step; none where nothing touched.
    pub first_contact: Option<f64>,
    /// Time at which the last contact force acted.
    pub last_contact: Option<f64>,
    /// Time with a contact force.
    pub contact_time: f64,
    /// Largest contact force.
    pub force_max: f64,
    /// Integral of the contact force over time.
    pub impulse: f64,
    /// Deepest penetration, in length.
    pub penetration_max: f64,
    /// Kinetic, strain and potential energy at the start.
    pub energy_first: [f64; 3],
    /// The same now.
    pub energy_last: [f64; 3],
    /// Smallest and largest sum of the three.
    pub energy_range: [f64; 2],
    /// Largest sum of kinetic and strain energy: what energies are compared with.
    pub energy_scale: f64,
}

impl MotionSummary {
    /// A run that starts as `seen`.
    pub fn starting(seen: &Observation) -> Self {
        let energies = [seen.kinetic, seen.strain, seen.potential];
        MotionSummary {
            time: seen.time,
            penetration_max: seen.penetration,
            energy_first: energies,
            energy_last: energies,
            energy_range: [seen.energy(); 2],
            energy_scale: seen.kinetic + seen.strain,
            ..MotionSummary::default()
        }
    }

    /// One step of length `step` further.
    pub fn add(&mut self, seen: &Observation, step: f64) {
        self.steps += 1;
        self.time = seen.time;
        if seen.force > 0.0 {
            let middle = seen.time - step / 2.0;
            self.first_contact.get_or_insert(middle);
            self.last_contact = Some(middle);
            self.contact_time += step;
            self.impulse += seen.force * step;
            self.force_max = self.force_max.max(seen.force);
        }
        self.penetration_max = self.penetration_max.max(seen.penetration);
        self.energy_last = [seen.kinetic, seen.strain, seen.potential];
        let [least, most] = self.energy_range;
        self.energy_range = [least.min(seen.energy()), most.max(seen.energy())];
        self.energy_scale = self.energy_scale.max(seen.kinetic + seen.strain);
    }

    /// The sum of the energies now less that at the start, over the largest energy of motion and strain.
    pub fn energy_change(&self) -> f64 {
        self.relative(self.energy_last.iter().sum())
    }

    /// The largest sum of the energies less that at the start, over the largest energy of motion and strain.
    pub fn energy_gain(&self) -> f64 {
        self.relative(self.energy_range[1])
    }

    fn relative(&self, energy: f64) -> f64 {
        let change = energy - self.energy_first.iter().sum::<f64>();
        if change == 0.0 { 0.0 } else { change / self.energy_scale }
    }
}
