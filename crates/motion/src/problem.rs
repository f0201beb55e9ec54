//! The motion of a body with contact: mass, damping, loads in time, initial state.

use std::f64::consts::{PI, TAU};

use signorini_fem::geometry::between;
use signorini_qp as qp;
use signorini_qp::Error;
use signorini_qp::{ContactProblem, SparseMatrix, SymmetricMatrix, dot};

/// The motion of a body with contact, from a given displacement and velocity:
///
/// ```text
/// M a + C v + K u = f(t) + B' lambda,   B u - g <= 0,   lambda <= 0,   lambda_i (B u - g)_i = 0,   C = c_m M + c_k K
/// ```
///
/// Time, mass, length and force are in one consistent system of units. A dof has no mass if its diagonal entry of M is
/// zero.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicProblem {
    statics: ContactProblem,
    /// Transposed contact rows: the entries of a row form a column.
    by_row: SparseMatrix,
    mass: SymmetricMatrix,
    /// c_m and c_k of `C = c_m M + c_k K`.
    damping: [f64; 2],
    loads: Vec<(TimeFunction, Vec<f64>)>,
    /// Changes of the gaps with time, one entry per row each, in length.
    shifts: Vec<(TimeFunction, Vec<f64>)>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    /// Forces on the free dofs from prescribed displacements, and the strain energy of these displacements.
    held: (Vec<f64>, f64),
    /// An upper bound on the largest angular frequency without damping.
    pub(super) frequency: Option<f64>,
}

impl DynamicProblem {
    /// The motion from rest of the body of `statics`, under its constant load, with the mass M (n x n).
    pub fn new(statics: ContactProblem, mass: SymmetricMatrix) -> Result<Self, Error> {
        let dofs = statics.dofs();
        if mass.dim() != dofs {
            let (found, expected) = ((mass.dim(), mass.dim()), (dofs, dofs));
            return Err(qp::LinearError::Shape { name: "mass", found, expected }.into());
        }
        if let Some(&value) = mass.diagonal().iter().find(|&&entry| entry < 0.0) {
            let (name, allowed) = ("diagonal entry of the mass", "zero or positive");
            return Err(qp::LinearError::Setting { name, value, allowed }.into());
        }
        let zeros = vec![0.0; dofs];
        Ok(DynamicProblem {
            by_row: statics.contact().transposed(),
            statics,
            mass,
            damping: [0.0; 2],
            loads: Vec::new(),
            shifts: Vec::new(),
            displacement: zeros.clone(),
            velocity: zeros.clone(),
            held: (zeros, 0.0),
            frequency: None,
        })
    }

    /// The same with Rayleigh damping `C = mass M + stiffness K`; `mass` in one over time, `stiffness` in time.
    pub fn with_damping(mut self, mass: f64, stiffness: f64) -> Result<Self, Error> {
        for (name, value) in [("mass damping", mass), ("stiffness damping", stiffness)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(qp::LinearError::Setting { name, value, allowed: "zero or positive, and finite" }.into());
            }
        }
        self.damping = [mass, stiffness];
        Ok(self)
    }

    /// The same with one more load (length n, in force, along the positive axes), multiplied by a factor that changes
    /// with time.
    pub fn with_load(mut self, factor: TimeFunction, load: Vec<f64>) -> Result<Self, Error> {
        factor.check()?;
        let load = self.statics.with_load(load)?.load().to_vec();
        self.loads.push((factor, load));
        Ok(self)
    }

    /// The same with obstacles that move: `shift` (one entry per row, in length, positive away from the body) times a
    /// factor that changes with time is added to the gaps, less its value at the start. Only `fox-goodwin` follows such
    /// obstacles.
    pub fn with_moving_gaps(mut self, factor: TimeFunction, shift: Vec<f64>) -> Result<Self, Error> {
        factor.check()?;
        check_finite("shift", &shift, (self.statics.rows(), "contact rows"))?;
        self.shifts.push((factor, shift));
        Ok(self)
    }

    /// The same from another displacement and velocity (length n each, in length and length over time).
    pub fn starting_from(mut self, displacement: Vec<f64>, velocity: Vec<f64>) -> Result<Self, Error> {
        check_finite("initial displacement", &displacement, (self.statics.dofs(), "dofs"))?;
        check_finite("initial velocity", &velocity, (self.statics.dofs(), "dofs"))?;
        (self.displacement, self.velocity) = (displacement, velocity);
        Ok(self)
    }

    /// The same with the part of the constant load that holds prescribed displacements (length n, in force), and the
    /// strain energy of these displacements alone. They are used only to separate strain energy from potential energy.
    pub fn holding(mut self, forces: Vec<f64>, energy: f64) -> Self {
        self.held = (forces, energy);
        self
    }

    /// The same with an upper bound on the largest angular frequency of K and M without damping, per time, positive.
    /// `fox-goodwin` finds one itself if M is diagonal; without a bound it is of second order.
    pub fn bounded_by(self, frequency: f64) -> Self {
        DynamicProblem { frequency: Some(frequency), ..self }
    }

    /// The problem without inertia: stiffness, constant load, contact rows and gaps.
    pub fn statics(&self) -> &ContactProblem {
        &self.statics
    }

    /// The mass M (n x n), symmetric, in mass.
    pub fn mass(&self) -> &SymmetricMatrix {
        &self.mass
    }

    /// The coefficients `[c_m, c_k]` of the damping `C = c_m M + c_k K`: the first in one over time, the second in
    /// time.
    pub fn damping(&self) -> [f64; 2] {
        self.damping
    }

    /// The initial displacement, length n, in length, along the positive axes.
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// The initial velocity, length n, in length over time, along the positive axes.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// The kinetic energy at the start and the work of deformation, `(v'M v + u'K u)/2`.
    pub fn initial_energy(&self) -> f64 {
        let [u, v] = [&self.displacement, &self.velocity];
        (dot(v, &self.mass.mul(v)) + dot(u, &self.statics.stiffness().mul(u))) / 2.0
    }

    /// The load at time `t`, length n, in force, along the positive axes.
    pub fn load_at(&self, t: f64) -> Vec<f64> {
        let mut load = self.statics.load().to_vec();
        for (factor, of_factor) in &self.loads {
            let factor = factor.at(t);
            load.iter_mut().zip(of_factor).for_each(|(sum, part)| *sum += factor * part);
        }
        load
    }

    /// The dofs without mass: their indices, from 0, increasing.
    pub fn massless(&self) -> Vec<usize> {
        (0..).zip(self.mass.diagonal()).filter(|entry| entry.1 == 0.0).map(|(dof, _)| dof).collect()
    }

    /// The gaps at time `t`, one entry per row, in length.
    pub fn gap_at(&self, t: f64) -> Vec<f64> {
        let mut gap = self.statics.gap().to_vec();
        if let Some(growth) = self.growth_of_gaps(0.0, t) {
            gap.iter_mut().zip(growth).for_each(|(gap, growth)| *gap += growth);
        }
        gap
    }

    /// The growth of the gaps from one time to another, one entry per row; `None` if no obstacle moves.
    fn growth_of_gaps(&self, from: f64, to: f64) -> Option<Vec<f64>> {
        let mut shifts = self.shifts.iter().map(|(factor, shift)| (factor.at(to) - factor.at(from), shift));
        let (factor, shift) = shifts.next()?;
        let mut growth: Vec<f64> = shift.iter().map(|shift| factor * shift).collect();
        shifts.for_each(|(factor, shift)| growth.iter_mut().zip(shift).for_each(|(sum, shift)| *sum += factor * shift));
        Some(growth)
    }

    /// The largest shift of a row by an obstacle that moves; 0 if none moves.
    pub(super) fn largest_shift(&self) -> f64 {
        self.shifts.iter().fold(0.0, |largest, (_, shift)| qp::largest(shift).max(largest))
    }

    /// The velocities along the rows, `B v`, less those of the obstacles between two times.
    pub(super) fn relative_velocity(&self, velocity: &[f64], [from, to]: [f64; 2]) -> Vec<f64> {
        let mut along = self.statics.contact().mul(velocity);
        if let Some(growth) = self.growth_of_gaps(from, to) {
            along.iter_mut().zip(growth).for_each(|(along, growth)| *along -= growth / (to - from));
        }
        along
    }

    /// The work that obstacles do with these multipliers while they move from one time to another.
    pub(super) fn work_of_obstacles(&self, multiplier: &[f64], [from, to]: [f64; 2]) -> f64 {
        self.growth_of_gaps(from, to).map_or(0.0, |growth| dot(multiplier, &growth))
    }

    /// The work that damping takes, `w'C v`, while the dofs with the velocity v move by w.
    pub(super) fn damping_work(&self, velocity: &[f64], moved: &[f64]) -> f64 {
        let mut force = vec![0.0; velocity.len()];
        self.damp(-1.0, velocity, &mut force);
        dot(&force, moved)
    }

    /// The deepest penetration, `max(B u - g, 0)`, in length, at a displacement u of length n, in length, at time `t`.
    pub fn penetration(&self, displacement: &[f64], t: f64) -> f64 {
        self.remaining_gap_at(displacement, t).into_iter().fold(0.0, |deepest, gap| (-gap).max(deepest))
    }

    /// The remaining gaps after a displacement, `g - B u`, one entry per row, of obstacles that stand still.
    pub(super) fn remaining_gap(&self, displacement: &[f64]) -> Vec<f64> {
        self.remaining_gap_at(displacement, 0.0)
    }

    /// The same at time `t`.
    pub(super) fn remaining_gap_at(&self, displacement: &[f64], t: f64) -> Vec<f64> {
        let moved = |row: usize| self.by_row.column(row).map(|(dof, b)| b * displacement[dof]).sum::<f64>();
        self.gap_at(t).into_iter().enumerate().map(|(row, gap)| gap - moved(row)).collect()
    }

    /// `mass M + damping C + stiffness K`.
    pub(super) fn combination(&self, mass: f64, damping: f64, stiffness: f64) -> Result<SymmetricMatrix, Error> {
        let [of_mass, of_stiffness] = self.damping;
        let (m, k) = (mass + damping * of_mass, stiffness + damping * of_stiffness);
        let stiffness = self.statics.stiffness();
        Ok(match (m == 0.0, k == 0.0) {
            // A mass alone may be diagonal.
            (_, true) => self.mass.times(m)?,
            (true, _) => stiffness.times(k)?,
            _ => stiffness.combined(k, m, &self.mass)?,
        })
    }

    /// Subtracts `factor C v` from a force.
    pub(super) fn damp(&self, factor: f64, velocity: &[f64], force: &mut [f64]) {
        for (coefficient, matrix) in self.damping.into_iter().zip([&self.mass, self.statics.stiffness()]) {
            if coefficient != 0.0 {
                let product = matrix.mul(velocity);
                force.iter_mut().zip(product).for_each(|(f, c)| *f -= factor * coefficient * c);
            }
        }
    }

    /// Work of the loads between two displacements, with the mean of their values at some times, without the part that
    /// holds prescribed displacements.
    pub(super) fn work(&self, times: impl ExactSizeIterator<Item = f64>, [from, to]: [&Vec<f64>; 2]) -> f64 {
        let count = times.len() as f64;
        let moved: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
        times.map(|t| dot(&self.load_at(t), &moved)).sum::<f64>() / count - dot(&self.held.0, &moved)
    }

    /// Strain energy of a displacement with the elastic forces K u, and the potential of the loads at time `t`.
    pub(super) fn energies(&self, displacement: &[f64], elastic: &[f64], t: f64) -> [f64; 2] {
        let (forces, energy) = &self.held;
        let of_held = dot(forces, displacement);
        let strain = dot(displacement, elastic) / 2.0 - of_held + energy;
        [strain, 0.0 + of_held - dot(&self.load_at(t), displacement)]
    }
}

/// Checks length and values of a vector.
fn check_finite(name: &'static str, values: &[f64], (expected, of): (usize, &'static str)) -> Result<(), Error> {
    qp::LinearError::check_length(name, values.len(), expected, of)?;
    match values.iter().enumerate().find(|entry| !entry.1.is_finite()) {
        Some((index, &value)) => {
            Err(qp::LinearError::NotFinite { name, at: format!("entry {index}"), value, allowed: "finite" }.into())
        }
        None => Ok(()),
    }
}

/// A factor, without a unit, that changes with time and multiplies one load of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeFunction {
    /// Straight lines between points `(time, factor)`, times strictly increasing; constant before the first and after
    /// the last.
    Table(Vec<(f64, f64)>),
    /// `sin(2 pi frequency t + phase)`, between -1 and 1.
    Sine {
        /// Number of periods in a unit of time.
        frequency: f64,
        /// Angle at time 0, in radians.
        phase: f64,
    },
    /// 0 until `start`, a straight line to 1 at `end`, 1 from there on.
    Ramp {
        /// Time up to which the factor is 0.
        start: f64,
        /// Time from which the factor is 1.
        end: f64,
    },
    /// Half a sine wave from `start` to `end`, 0 before and after.
    Pulse {
        /// Time at which the half wave begins.
        start: f64,
        /// Time at which the half wave is over.
        end: f64,
    },
}

impl TimeFunction {
    /// Checks that the numbers are finite and the times in order.
    pub fn check(&self) -> Result<(), Error> {
        // Each number with its name, whether it is allowed, and what is.
        let numbers: Vec<(&'static str, f64, bool, &'static str)> = match self {
            TimeFunction::Table(points) if points.is_empty() => vec![("number of times", 0.0, false, "at least 1")],
            TimeFunction::Table(points) => {
                let of_point = |(index, &(time, factor)): (usize, &(f64, f64))| {
                    let is_later = time.is_finite() && (index == 0 || time > points[index - 1].0);
                    let time = ("time of a table", time, is_later, "finite and later than the one before it");
                    [time, ("factor of a table", factor, factor.is_finite(), "finite")]
                };
                points.iter().enumerate().flat_map(of_point).collect()
            }
            &TimeFunction::Sine { frequency, phase } => vec![
                ("frequency", frequency, frequency.is_finite() && frequency > 0.0, "positive and finite"),
                ("phase", phase, phase.is_finite(), "finite"),
            ],
            &TimeFunction::Ramp { start, end } | &TimeFunction::Pulse { start, end } => vec![
                ("start", start, start.is_finite(), "finite"),
                ("end", end, end.is_finite() && end > start, "finite and later than the start"),
            ],
        };
        match numbers.into_iter().find(|number| !number.2) {
            Some((name, value, _, allowed)) => Err(qp::LinearError::Setting { name, value, allowed }.into()),
            None => Ok(()),
        }
    }

    /// The factor at time `t`.
    ///
    /// ```
    /// use signorini_motion::TimeFunction;
    /// let table = TimeFunction::Table(vec![(0.0, 1.0), (2.0, 5.0)]);
    /// assert_eq!([-1.0, 0.5, 3.0].map(|t| table.at(t)), [1.0, 2.0, 5.0]);
    /// ```
    pub fn at(&self, t: f64) -> f64 {
        let share = |start: f64, end: f64| ((t - start) / (end - start)).clamp(0.0, 1.0);
        match *self {
            TimeFunction::Table(ref points) => between(points, t),
            TimeFunction::Sine { frequency, phase } => (TAU * frequency * t + phase).sin(),
            TimeFunction::Ramp { start, end } => share(start, end),
            TimeFunction::Pulse { start, end } => match share(start, end) {
                outside if outside <= 0.0 || outside >= 1.0 => 0.0,
                inside => (PI * inside).sin(),
            },
        }
    }
}
