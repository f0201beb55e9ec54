//! The midpoint rule; dofs without mass are in equilibrium with the others, at the middle of a step and at its end.
//!
//! ```text
//! ((4/dt^2) M + (2/dt) C + K) w = f(t + dt/2) - K u + (2/dt) M v + B' lambda,   B (u + w) <= g
//! u+ = u + 2 w,   v+ = 4 w/dt - v
//! ```
//!
//! Where contact nodes have no mass the rest moves under forces that are continuous in its displacement, which the
//! midpoint rule integrates without chatter; the end of a step satisfies every constraint.

use super::integrator::{Advance, Stepping, plus};
use super::{DynamicProblem, State};
use crate::error::Error;
use crate::problem::ContactProblem;
use crate::solution::ContactSet;
use crate::solve::Settings;
use crate::sparse::{SparseMatrix, SymmetricMatrix};

pub(super) struct Midpoint {
    stepping: Stepping,
    massless: Option<Massless>,
}

/// The dofs without mass, held by the others.
struct Massless {
    dofs: Vec<usize>,
    /// Their rows among all.
    rows: Vec<usize>,
    /// Columns of K of these dofs.
    columns: SparseMatrix,
    stepping: Stepping,
}

impl Midpoint {
    pub fn new(problem: &DynamicProblem, step: f64, settings: &Settings) -> Result<Self, Error> {
        let matrix = problem.combination(4.0 / (step * step), 2.0 / step, 1.0)?;
        let contact = problem.contact();
        let effective =
            ContactProblem::new(matrix, vec![0.0; contact.dofs()], contact.contact().clone(), contact.gap().to_vec())?;
        let dofs = problem.massless();
        let massless = if dofs.is_empty() { None } else { Some(Massless::new(problem, dofs, step, settings)?) };
        Ok(Midpoint { stepping: Stepping::new(&effective, settings)?, massless })
    }
}

impl Massless {
    fn new(problem: &DynamicProblem, dofs: Vec<usize>, step: f64, settings: &Settings) -> Result<Self, Error> {
        let contact = problem.contact();
        let mut place = vec![usize::MAX; contact.dofs()];
        dofs.iter().enumerate().for_each(|(number, &dof)| place[dof] = number);
        // Viscous forces of these dofs by their mean velocity over a step.
        let [_, viscous] = problem.damping();
        let (mut inside, mut columns) = (Vec::new(), Vec::new());
        for (row, column, value) in contact.stiffness().lower().triplets() {
            let (i, j) = (place[row], place[column]);
            if i != usize::MAX && j != usize::MAX {
                inside.push((i.max(j), i.min(j), value * (1.0 + viscous / step)));
            }
            if j != usize::MAX {
                columns.push((row, j, value));
            }
            if i != usize::MAX && row != column {
                columns.push((column, i, value));
            }
        }
        let mut rows = vec![false; contact.rows()];
        let mut entries = Vec::new();
        for (row, dof, value) in contact.contact().triplets().filter(|entry| place[entry.1] != usize::MAX) {
            rows[row] = true;
            entries.push((row, place[dof], value));
        }
        let rows: Vec<usize> = (0..contact.rows()).filter(|&row| rows[row]).collect();
        let count = dofs.len();
        let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(count, count, &inside)?)?;
        let of_rows = SparseMatrix::from_triplets(contact.rows(), count, &entries)?.select_rows(&rows);
        let gap = rows.iter().map(|&row| contact.gap()[row]).collect();
        let stepping = Stepping::new(&ContactProblem::new(stiffness, vec![0.0; count], of_rows, gap)?, settings)?;
        let columns = SparseMatrix::from_triplets(contact.dofs(), count, &columns)?;
        Ok(Massless { dofs, rows, columns, stepping })
    }

    /// Puts the dofs without mass in equilibrium with the others, whose displacement and velocity are those of `state`;
    /// `before` is the displacement a step earlier.
    fn settle(&self, problem: &DynamicProblem, step: f64, before: &[f64], state: &mut State) -> Result<(), Error> {
        let mut residual = plus(&problem.load_at(state.steps as f64 * step), -1.0, &state.elastic);
        self.dofs.iter().for_each(|&dof| state.velocity[dof] = (state.displacement[dof] - before[dof]) / step);
        if problem.damping()[1] != 0.0 {
            problem.damp(1.0, &state.velocity, &mut residual);
        }
        let force = self.dofs.iter().map(|&dof| residual[dof]).collect();
        let room = problem.remaining_gap(&state.displacement);
        let gap = self.rows.iter().map(|&row| room[row]).collect();
        let start = ContactSet::from_fn(self.rows.len(), |row| state.contact_set.contains(self.rows[row]));
        let change = self.stepping.change(force, gap, &start)?;
        for (&dof, change) in self.dofs.iter().zip(&change) {
            state.displacement[dof] += change;
            state.velocity[dof] = (state.displacement[dof] - before[dof]) / step;
        }
        for (dof, column, value) in self.columns.triplets() {
            state.elastic[dof] += value * change[column];
        }
        Ok(())
    }
}

impl Advance for Midpoint {
    fn start(&self, problem: &DynamicProblem, step: f64, mut state: State) -> Result<State, Error> {
        if let Some(massless) = &self.massless {
            let before = state.displacement.clone();
            massless.settle(problem, step, &before, &mut state)?;
            massless.dofs.iter().for_each(|&dof| state.velocity[dof] = 0.0);
        }
        Ok(state)
    }

    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let load = problem.load_at((state.steps as f64 + 0.5) * step);
        let forces = load.iter().zip(&state.elastic).zip(&state.momentum);
        let force = forces.map(|((f, elastic), momentum)| f - elastic + 2.0 / step * momentum).collect();
        let gap = problem.remaining_gap(&state.displacement);
        let found = self.stepping.solve(force, gap, &state.contact_set)?;
        let mut displacement = plus(&state.displacement, 2.0, &found.change);
        let changes = state.velocity.iter().zip(&found.change);
        let velocity: Vec<f64> = changes.map(|(v, w)| 4.0 / step * w - v).collect();
        let massless = self.massless.as_ref();
        massless
            .iter()
            .flat_map(|massless| &massless.dofs)
            .for_each(|&dof| displacement[dof] = state.displacement[dof]);
        let mut next = State {
            steps: state.steps + 1,
            momentum: problem.mass().mul(&velocity),
            velocity,
            acceleration: state.acceleration.clone(),
            elastic: problem.contact().stiffness().mul(&displacement),
            displacement,
            multiplier: found.multiplier,
            contact_set: found.contact_set,
        };
        if let Some(massless) = massless {
            massless.settle(problem, step, &state.displacement, &mut next)?;
        }
        Ok(next)
    }
}
