//! Fox and Goodwin's rule: Newmark's two-step rule with beta = 1/12. A contact node that reaches its obstacle stops
//! there.
//!
//! ```text
//! (S + dt C/2) (v+ - v)/dt = f_n - K u_n - C v + B' lambda,   u+ = u_n + dt v+,   B u+ <= g,   S = M + beta dt^2 K
//! ```
//!
//! The velocities v stand between the steps, the displacements u and the forces at them. The rule is of fourth order,
//! and so are the waves on the mean of the lumped and the consistent mass along a uniform mesh; together they move a
//! bar exactly if a step is the time of a wave through a cell. Beyond the largest step at which beta = 1/12 is stable,
//! `sqrt(6)/omega` with the largest frequency omega of the mesh, beta grows to `1/4 - 1/(omega dt)^2`; without a bound
//! on omega it is 1/4.
//!
//! **Energy never grows.** `S - dt^2/4 K` is positive for every step, so that `E = v'(S - dt^2/4 K)v/2 + u~'K u~/2`
//! with the mean u~ of two displacements is an energy. A step adds to it the work of all forces along
//! `(B u+ - B u-)/2`, u- being the displacement before u_n. A row with a force has `B u+ = g`, and `B u- <= g`: contact
//! forces only take energy. What they take is kinetic energy of the contact nodes that stop, a share that falls with
//! the cell size.
//!
//! **Obstacles that move** have their gap at the end of a step; what they put in is the work of the contact forces
//! along the mean change of the gap, `(g+ - g-)/2`, and rows have velocities relative to them.
//!
//! **At release** a node gets back what it lost when it stopped, up to the velocity with which it would follow its
//! neighbours if it had no mass. In a bar that hits a wall, at any time within a step, this restores the motion
//! exactly.
//!
//! # Source
//! T. J. R. Hughes, *The Finite Element Method*, Prentice-Hall, 1987, section 9.1: Newmark's family, with Fox and
//! Goodwin's rule. T. A. Laursen, G. R. Love, *Improved implicit integrators for transient impact problems*, Int. J.
//! Numer. Methods Eng. 53 (2002) 245-274: velocities that change at release so that energy is restored.

use super::newmark::TRAPEZOIDAL;
use crate::step::{Advance, Facts, HalfStep, Moved, Stepping, halfway, next, plus};
use crate::{Balance, DynamicProblem, State};
use signorini_fem::assembly::MassForm;
use signorini_qp::Error;
use signorini_qp::SparseMatrix;

/// The beta of fourth order.
const FOURTH_ORDER: f64 = 1.0 / 12.0;

/// Entries of the matrix of a step below this, relative to those on the diagonal, are what is left of mass and
/// stiffness that cancel.
const CANCELLED: f64 = 1e-13;

/// A distance from the obstacle below this, relative to that of one step with the velocity that was stopped, is none.
const CLOSE: f64 = 1e-6;

/// An impulse below this, relative to the one that gives back all that is kept, and energy below this, relative to what
/// was kept, are rounding.
const NEGLIGIBLE: f64 = 1e-9;

pub(super) static ABOUT: Facts = Facts {
    name: "fox-goodwin",
    masses: &[MassForm::Averaged, MassForm::Lumped, MassForm::Consistent],
    gains_energy: false,
    uses_frequency: true,
    follows_obstacles: true,
    is_exact_in_bars: true,
    load_times: &[0.0],
    prepare: |problem, step, _, settings| {
        let angle = problem.largest_frequency().map_or(f64::INFINITY, |omega| omega * step);
        let scaling = FOURTH_ORDER.max(0.25 - 1.0 / (angle * angle)) * step * step;
        let matrix =
            problem.combination(1.0 / (step * step), 0.5 / step, scaling / (step * step))?.without_rounding(CANCELLED);
        let inertia = problem.combination(1.0, 0.0, scaling)?;
        let (contact, stiffness) = (problem.statics().contact(), problem.statics().stiffness().diagonal());
        let of = |entries: Vec<_>| SparseMatrix::from_triplets(contact.rows(), contact.columns(), &entries);
        let elastic = || contact.triplets().filter(|entry| stiffness[entry.1] != 0.0);
        let of_nodes = of(elastic().collect())?;
        let following = of(elastic().map(|(row, dof, b)| (row, dof, b / stiffness[dof])).collect())?;
        let inertia = inertia.diagonal();
        let of_nodes = masses_along(&of_nodes, &inertia, &vec![1.0; contact.rows()]);
        let masses = masses_along(contact, &inertia, &of_nodes);
        let stepping = Stepping::of(problem, matrix, settings)?;
        Ok(Box::new(FoxGoodwin { scaling, masses, following, stepping }))
    },
    ..TRAPEZOIDAL
};

#[derive(Debug)]
struct FoxGoodwin {
    /// `beta dt^2`, in time squared.
    scaling: f64,
    /// The mass that a force along each row moves, if only the dofs of rows move.
    masses: Vec<f64>,
    /// The motion along each row in which nodes without mass would follow forces on the dofs.
    following: SparseMatrix,
    stepping: Stepping,
}

impl Advance for FoxGoodwin {
    fn start(&self, _: &DynamicProblem, _: f64, state: State) -> Result<State, Error> {
        Ok(State { kept: vec![0.0; self.masses.len()], ..state })
    }

    /// The first step starts from the velocity at its beginning, over which forces act for half of it.
    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let rate = elastic_rate(problem, state);
        let is_first = state.steps == 0;
        let share = if is_first { 0.5 } else { 1.0 };
        let load = problem.load_at(state.steps as f64 * step);
        let inertial = state.momentum.iter().zip(&rate).map(|(momentum, rate)| (momentum + self.scaling * rate) / step);
        let forces = load.iter().zip(&state.elastic).zip(inertial);
        let mut force: Vec<f64> =
            forces.map(|((load, elastic), inertial)| share * (load - elastic) + inertial).collect();
        if !is_first {
            problem.damp(0.5, &state.velocity, &mut force);
        }
        let room = problem.remaining_gap_at(&state.displacement, (state.steps as f64 + 1.0) * step);
        let found = self.stepping.solve(force.clone(), room.clone(), &state.contact_set)?;
        let end = self.after(problem, step, state, &found, None);
        match self.released(problem, step, state, &found, &end) {
            None => Ok(end),
            Some(pull) => self.let_go(problem, step, state, (&force, pull, room), end),
        }
    }

    /// At the beginning of the step, where the forces act. `beta dt^2` times the acceleration is part of the
    /// displacement.
    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        let (time, over) = (before.steps as f64 * step, if before.steps == 0 { step / 2.0 } else { step });
        let each = |value: &dyn Fn(usize) -> f64| at.iter().map(|&dof| value(dof)).collect::<Vec<f64>>();
        let acceleration = |dof: usize| (after.velocity[dof] - before.velocity[dof]) / over;
        Balance {
            displacement: each(&|dof| before.displacement[dof] + self.scaling * acceleration(dof)),
            velocity: each(&|dof| match before.steps {
                0 => after.velocity[dof],
                _ => (before.velocity[dof] + after.velocity[dof]) / 2.0,
            }),
            acceleration: each(&acceleration),
            loads: [(time, 1.0), (time, 0.0)],
        }
    }

    fn half_step(&self, problem: &DynamicProblem, step: f64, state: &State) -> Option<HalfStep> {
        let rate = elastic_rate(problem, state);
        let back = if state.steps == 0 { 0.0 } else { step };
        Some(halfway(back, self.scaling, state, (&state.velocity, &state.momentum), &rate))
    }

    fn acting(&self, step: f64, steps: usize) -> [f64; 2] {
        let middle = (steps as f64 - 1.0) * step;
        [(middle - step / 2.0).max(0.0), middle + step / 2.0]
    }
}

impl FoxGoodwin {
    /// The end of the step with the given change; `pull` are the forces, as multipliers, that let rows go.
    fn after(&self, problem: &DynamicProblem, step: f64, state: &State, found: &Moved, pull: Option<&[f64]>) -> State {
        let share = if state.steps == 0 { 0.5 } else { 1.0 };
        let velocity: Vec<f64> = found.change.iter().map(|w| w / step).collect();
        let displacement = plus(&state.displacement, 1.0, &found.change);
        let [before, now] = along_rows_of_step(problem, step, state, &velocity);
        let forces = pull.map_or_else(|| found.multiplier.clone(), |pull| plus(&found.multiplier, 1.0, pull));
        let work = |row: usize| forces[row] * (before[row] + now[row]) / 2.0 * step;
        let kept = |(row, kept): (usize, &f64)| {
            let left = kept - work(row);
            // A row that gave back too much remembers it. At the start the energy is that of the velocity then, not of
            // the first step.
            match left.abs() <= NEGLIGIBLE * kept {
                true => 0.0,
                false if forces[row] == 0.0 || state.steps == 0 => left.min(0.0),
                false => left,
            }
        };
        let kept = state.kept.iter().enumerate().map(kept).collect();
        let multiplier = forces.iter().map(|force| force / share).collect();
        let end = next(problem, state, [displacement, velocity], (multiplier, found.contact_set.clone()));
        let rate = end.elastic.iter().zip(&state.elastic).map(|(after, before)| (after - before) / step).collect();
        State { rate, kept, ..end }
    }

    /// The forces, as multipliers, that let nodes follow their neighbours at the end of their contact; `None` if there
    /// are none.
    fn released(
        &self,
        problem: &DynamicProblem,
        step: f64,
        state: &State,
        found: &Moved,
        end: &State,
    ) -> Option<Vec<f64>> {
        if state.kept.iter().all(|&kept| kept <= 0.0) {
            return None;
        }
        let left = plus(&problem.load_at(end.steps as f64 * step), -1.0, &end.elastic);
        let follow = self.following.mul(&left);
        let [before, now] = along_rows_of_step(problem, step, state, &end.velocity);
        let room = problem.remaining_gap_at(&state.displacement, state.steps as f64 * step);
        let pull = |(row, &kept): (usize, &f64)| {
            let mass = self.masses[row];
            // The velocity that was stopped, if it was all of the energy.
            let stopped = (2.0 * kept / mass).sqrt();
            // A contact that ends within a step presses until then: its node was at the obstacle a step ago.
            let was_closed = room[row] + step * before[row] <= CLOSE * step * stopped;
            // The impulse after which the neighbours do not pull, and the one that gives back all energy.
            let to_follow = -follow[row] * mass / step;
            let parting = -(before[row] + now[row]) / 2.0 - found.multiplier[row] * step / (2.0 * mass);
            let of_energy = mass * (parting.hypot(stopped) - parting);
            let is_due = kept > 0.0 && was_closed && to_follow > NEGLIGIBLE * mass * stopped;
            if is_due { found.multiplier[row] - to_follow.min(of_energy) / step } else { 0.0 }
        };
        let pull: Vec<f64> = state.kept.iter().enumerate().map(pull).collect();
        pull.iter().any(|&force| force != 0.0).then_some(pull)
    }

    /// The step once more with forces that let nodes go, or `end` without them if they gave back more energy than was
    /// kept.
    fn let_go(
        &self,
        problem: &DynamicProblem,
        step: f64,
        state: &State,
        (force, pull, room): (&[f64], Vec<f64>, Vec<f64>),
        end: State,
    ) -> Result<State, Error> {
        let contact = problem.statics().contact();
        let pulled = plus(force, 1.0, &contact.mul_transposed(&pull));
        let found = self.stepping.solve(pulled, room, &state.contact_set)?;
        let let_go = self.after(problem, step, state, &found, Some(&pull));
        Ok(if let_go.kept.iter().sum::<f64>() >= 0.0 { let_go } else { end })
    }
}

/// The velocities along the rows, less those of their obstacles, in the step that led to a state and in the next one.
fn along_rows_of_step(problem: &DynamicProblem, step: f64, state: &State, velocity: &[f64]) -> [Vec<f64>; 2] {
    let time = state.steps as f64 * step;
    [
        problem.relative_velocity(&state.velocity, [time - step, time]),
        problem.relative_velocity(velocity, [time, time + step]),
    ]
}

/// K v, one entry per dof, in force over time.
fn elastic_rate(problem: &DynamicProblem, state: &State) -> Vec<f64> {
    if state.rate.is_empty() { problem.statics().stiffness().mul(&state.velocity) } else { state.rate.clone() }
}

/// The mass that a force along each row moves if the dofs have the masses S: `1/(b'S^-1 b)`, or its share in the mass
/// of dofs that several rows have, with forces on all rows in proportion to `others`, if that is less.
fn masses_along(contact: &SparseMatrix, masses: &[f64], others: &[f64]) -> Vec<f64> {
    let of_all = contact.mul_transposed(others);
    let (mut alone, mut together) = (vec![0.0; contact.rows()], vec![0.0; contact.rows()]);
    for (row, dof, b) in contact.triplets() {
        alone[row] += b * b / masses[dof];
        together[row] += b * of_all[dof] / masses[dof];
    }
    let of_row = |((alone, together), own): ((f64, f64), &f64)| 1.0 / (together / own).max(alone);
    alone.into_iter().zip(together).zip(others).map(of_row).collect()
}
