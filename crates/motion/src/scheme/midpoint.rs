//! The midpoint rule; dofs without mass are in equilibrium with the others, at the middle of a step and at its end.
//!
//! ```text
//! ((4/dt^2) M + (2/dt) C + K) w = f(t + dt/2) - K u + (2/dt) M v + B' lambda,   B (u + w) <= g
//! u+ = u + 2 w,   v+ = 4 w/dt - v
//! ```
//!
//! If contact nodes have no mass, the other nodes move under forces that are continuous in their displacement. The
//! midpoint rule integrates these without chatter; the end of a step satisfies every constraint.
//!
//! In a step in which contact nodes close or open, the work of the force at the middle differs from the energy that
//! they store. If the difference is not small, the force of the step becomes `R + s ((R_n + R_n+1)/2 - R)`: between the
//! force at the middle, R, and the mean of those at both ends, with the share s that preserves the energy. For a spring
//! that closes, the middle gives too little and the ends too much.
//!
//! # Source
//! O. Gonzalez, *Exact energy and momentum conserving algorithms for general models in nonlinear elasticity*, Comput.
//! Methods Appl. Mech. Eng. 190 (2000) 1763-1783: midpoint forces corrected so that their work is the change of energy.

use super::newmark::TRAPEZOIDAL;
use crate::step::{Advance, Facts, Moved, Stepping, next, plus};
use crate::{Balance, DynamicProblem, State};
use signorini_fem::assembly::MassForm;
use signorini_qp::Error;
use signorini_qp::{ContactProblem, ContactSet, Settings, SparseMatrix, SymmetricMatrix, dot, largest};

/// Error in energy of a step, relative to kinetic and strain energy, above which its contact force is corrected.
const TOLERATED: f64 = 1e-5;

/// Remaining error of a corrected step, relative as above.
const CORRECTION_TOLERANCE: f64 = 1e-7;

/// A contact force below this, relative to the largest, counts as zero.
const NEGLIGIBLE_FORCE: f64 = 1e-9;

/// Largest number of trial shares of the correction.
const TRIALS: usize = 8;

pub(super) static ABOUT: Facts = Facts {
    name: "midpoint",
    masses: &[MassForm::Redistributed, MassForm::Consistent, MassForm::Lumped],
    gains_energy: false,
    load_times: &[0.5],
    // A node with mass that is held at the wall at the middle of a step is as far inside the wall at one end as it was
    // outside at the other. A step that starts inside by d gains the energy 2 |lambda| d, one that starts outside loses
    // it, and nothing balances the two. Measured on two bars, a block and a disc at steps of 0.25 to 3 times the time
    // of a wave through a cell: the energy grows by at least 5 % and up to 160 times. It is preserved only in a bar
    // that flies freely, at steps of one such time and more.
    unstable_in_contact: &[MassForm::Consistent, MassForm::Lumped],
    prepare: |problem, step, _, settings| {
        let matrix = problem.combination(4.0 / (step * step), 2.0 / step, 1.0)?;
        let stepping = Stepping::of(problem, matrix, settings)?;
        let dofs = problem.massless();
        let massless = if dofs.is_empty() { None } else { Some(Massless::new(problem, dofs, step, settings)?) };
        Ok(Box::new(Midpoint { stepping, massless }))
    },
    ..TRAPEZOIDAL
};

#[derive(Debug)]
struct Midpoint {
    stepping: Stepping,
    massless: Option<Massless>,
}

/// The dofs without mass, in equilibrium with the others.
#[derive(Debug)]
struct Massless {
    dofs: Vec<usize>,
    /// Their rows in the whole problem.
    rows: Vec<usize>,
    stepping: Stepping,
}

impl Massless {
    fn new(problem: &DynamicProblem, dofs: Vec<usize>, step: f64, settings: &Settings) -> Result<Self, Error> {
        let statics = problem.statics();
        let mut place = vec![usize::MAX; statics.dofs()];
        dofs.iter().enumerate().for_each(|(number, &dof)| place[dof] = number);
        // Viscous forces of these dofs by their mean velocity over a step.
        let [_, viscous] = problem.damping();
        let mut inside = Vec::new();
        for (row, column, value) in statics.stiffness().lower().triplets() {
            let (i, j) = (place[row], place[column]);
            if i != usize::MAX && j != usize::MAX {
                inside.push((i.max(j), i.min(j), value * (1.0 + viscous / step)));
            }
        }
        let mut rows = vec![false; statics.rows()];
        let mut entries = Vec::new();
        for (row, dof, value) in statics.contact().triplets().filter(|entry| place[entry.1] != usize::MAX) {
            rows[row] = true;
            entries.push((row, place[dof], value));
        }
        let rows: Vec<usize> = (0..statics.rows()).filter(|&row| rows[row]).collect();
        let count = dofs.len();
        let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(count, count, &inside)?)?;
        let of_rows = SparseMatrix::from_triplets(statics.rows(), count, &entries)?.select_rows(&rows);
        let gap = rows.iter().map(|&row| statics.gap()[row]).collect();
        let stepping = Stepping::new(&ContactProblem::new(stiffness, vec![0.0; count], of_rows, gap)?, settings)?;
        Ok(Massless { dofs, rows, stepping })
    }

    /// Puts the dofs without mass in equilibrium with the others, which have the displacement and velocity of `state`;
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
        state.elastic = problem.statics().stiffness().mul(&state.displacement);
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
        let next = self.after(problem, step, state, &found)?;
        match &self.massless {
            Some(massless) if problem.damping() == [0.0; 2] => {
                Ok(self.balanced(problem, step, state, (&found, load), massless, &next)?.unwrap_or(next))
            }
            _ => Ok(next),
        }
    }

    /// At the middle of the step. There the contact forces of the step determine the dofs without mass; they are not
    /// the mean of both ends.
    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        let mean = Balance::of_middle(step, before, after, at);
        if after.middle.is_empty() {
            return mean;
        }
        let velocity = at.iter().map(|&dof| 2.0 / step * (after.middle[dof] - before.displacement[dof])).collect();
        Balance { displacement: at.iter().map(|&dof| after.middle[dof]).collect(), velocity, ..mean }
    }
}

impl Midpoint {
    /// The end of the step from `state` with the given change at its middle.
    fn after(&self, problem: &DynamicProblem, step: f64, state: &State, found: &Moved) -> Result<State, Error> {
        let mut displacement = plus(&state.displacement, 2.0, &found.change);
        let changes = state.velocity.iter().zip(&found.change);
        let velocity: Vec<f64> = changes.map(|(v, w)| 4.0 / step * w - v).collect();
        let massless = self.massless.as_ref();
        let dofs = massless.iter().flat_map(|massless| &massless.dofs);
        dofs.for_each(|&dof| displacement[dof] = state.displacement[dof]);
        let contact = (found.multiplier.clone(), found.contact_set.clone());
        let mut end = next(problem, state, [displacement, velocity], contact);
        if let Some(massless) = massless {
            massless.settle(problem, step, &state.displacement, &mut end)?;
            end.middle = plus(&state.displacement, 1.0, &found.change);
        }
        Ok(end)
    }

    /// The end of the step with the contact force that preserves the energy; `None` if the step to `next` preserves it,
    /// or if no force between those of the middle and the ends does.
    fn balanced(
        &self,
        problem: &DynamicProblem,
        step: f64,
        state: &State,
        (found, mut load): (&Moved, Vec<f64>),
        massless: &Massless,
        next: &State,
    ) -> Result<Option<State>, Error> {
        let scale = energy(state) + energy(next);
        if imbalance(state, next, &load).abs() <= TOLERATED * scale {
            return Ok(None);
        }
        // Dofs without mass are in equilibrium with the loads of both ends, not of the middle.
        let ends = [state.steps, next.steps].map(|steps| problem.load_at(steps as f64 * step));
        massless.dofs.iter().for_each(|&dof| load[dof] = (ends[0][dof] + ends[1][dof]) / 2.0);
        let first = imbalance(state, next, &load);
        if first.abs() <= TOLERATED * scale {
            return Ok(None);
        }
        let contact = problem.statics().contact();
        let middle = contact.mul_transposed(&found.multiplier);
        let mut correction = vec![0.0; middle.len()];
        for &dof in &massless.dofs {
            correction[dof] = (state.elastic[dof] + next.elastic[dof]) / 2.0 - load[dof] - middle[dof];
        }
        let of_rows = along_rows(contact, &correction);
        let Some(response) = self.stepping.response(correction)? else { return Ok(None) };
        let at = |share: f64| -> Result<(State, f64), Error> {
            let mut multiplier = plus(&found.multiplier, share, &of_rows);
            // Open rows carry only the rounding of a balance of forces.
            let rounding = NEGLIGIBLE_FORCE * largest(&multiplier);
            multiplier.iter_mut().filter(|lambda| **lambda > -rounding).for_each(|lambda| *lambda = 0.0);
            let contact_set = ContactSet::from_fn(multiplier.len(), |row| multiplier[row] < 0.0);
            let corrected = Moved { change: plus(&found.change, share, &response), multiplier, contact_set };
            let end = self.after(problem, step, state, &corrected)?;
            let off = imbalance(state, &end, &load);
            Ok((end, off))
        };
        regula_falsi(first, CORRECTION_TOLERANCE * scale, at)
    }
}

/// The multiplier of each row, from the component of `force` along the row.
fn along_rows(contact: &SparseMatrix, force: &[f64]) -> Vec<f64> {
    let mut squares = vec![0.0; contact.rows()];
    contact.triplets().for_each(|(row, _, b)| squares[row] += b * b);
    let share_of_row = |(along, square): (f64, &f64)| if *square > 0.0 { along / square } else { 0.0 };
    contact.mul(force).into_iter().zip(&squares).map(share_of_row).collect()
}

/// The state at the share from 0 to 1 at which the imbalance of `at` is zero to within `kept`; `first` is the imbalance
/// at 0. `None` if the signs at both ends are equal.
fn regula_falsi(
    first: f64,
    kept: f64,
    at: impl Fn(f64) -> Result<(State, f64), Error>,
) -> Result<Option<State>, Error> {
    let (mut low, mut high) = ((0.0, first), (1.0, at(1.0)?.1));
    if (low.1 > 0.0) == (high.1 > 0.0) {
        return Ok(None);
    }
    let mut best = None;
    for _ in 0..TRIALS {
        let share = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
        let (end, off) = at(share)?;
        best = Some(end);
        if off.abs() <= kept {
            break;
        }
        // Illinois rule: the value at the end that stays is halved.
        if (off > 0.0) == (low.1 > 0.0) {
            (low, high.1) = ((share, off), high.1 / 2.0);
        } else {
            (high, low.1) = ((share, off), low.1 / 2.0);
        }
    }
    Ok(best)
}

/// Kinetic and strain energy.
fn energy(state: &State) -> f64 {
    (dot(&state.velocity, &state.momentum) + dot(&state.displacement, &state.elastic)) / 2.0
}

/// Kinetic and strain energy gained in a step, minus the work of a load.
fn imbalance(before: &State, after: &State, load: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (dof, load) in load.iter().enumerate() {
        let elastic = (before.elastic[dof] + after.elastic[dof]) / 2.0;
        let momentum = (before.momentum[dof] + after.momentum[dof]) / 2.0;
        sum += (after.displacement[dof] - before.displacement[dof]) * (elastic - load);
        sum += (after.velocity[dof] - before.velocity[dof]) * momentum;
    }
    sum
}
