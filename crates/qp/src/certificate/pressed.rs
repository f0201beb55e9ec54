//! The proof of the rows of obstacles that forces press: travels are dofs t without stiffness, `b'u + c t <= g`, c > 0,
//! under a force F > 0.
//!
//! The energy does not see a travel, but its rows do. Some row of it presses in the exact answer, because only rows
//! carry F, and none is violated: `t* = min (g - b'u*)/c`. With the bound E on the error of the body in energy and the
//! reach r of each row in the body, each term is known up to `r E / c`, and so is their least one. The proof is then
//! that of the body alone, with rows that this uncertainty brings nearer.

use super::conditions::Evidence;
use super::energy_norm::{EnergyNorm, ROUNDED_BOUND};
use super::proof::proven_in;
use super::reach::ComplianceFactor;
use crate::error::Error;
use crate::linear::SymmetricMatrix;
use crate::problem::ContactProblem;
use crate::solution::ProvenSet;

/// Rows that may be the least are swept one by one up to this number.
const MOST_SWEPT: usize = 200;

/// Rounding of a place on the way of a travel: a few units in the last place of its terms.
const PLACE_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A travel: its dof, and its rows with their shares c > 0 along its load.
struct Travel {
    dof: usize,
    rows: Vec<(usize, f64)>,
}

/// The rows that an answer proves if dofs without stiffness are travels, and the rest is definite by itself.
pub fn proven_pressed(
    problem: &ContactProblem,
    [displacement, multiplier]: [&[f64]; 2],
    evidence: Evidence,
) -> Result<Option<ProvenSet>, Error> {
    let Some(travels) = travels(problem).filter(|_| evidence.error.is_finite()) else { return Ok(None) };
    let is_body = |dof: &usize| travels.iter().all(|travel| travel.dof != *dof);
    let dofs: Vec<usize> = (0..problem.dofs()).filter(is_body).collect();
    let mut place = vec![None; problem.dofs()];
    dofs.iter().enumerate().for_each(|(index, &dof)| place[dof] = Some(index));
    let of_body = |values: &[f64]| dofs.iter().map(|&dof| values[dof]).collect::<Vec<f64>>();
    let lower = problem.stiffness.lower().select(dofs.len(), |row| place[row], dofs.iter().copied());
    let contact = problem.contact.select(problem.rows(), Some, dofs.iter().copied());
    let stiffness = SymmetricMatrix::from_lower(lower)?;
    let body = ContactProblem::computed(stiffness, of_body(&problem.load), contact, problem.gap.clone())?;
    let Some(norm) = EnergyNorm::of(&body.stiffness, &body.contact)? else { return Ok(None) };
    let displacement = of_body(displacement);
    let mut violation = body.accurate_violation(&displacement);
    for travel in &travels {
        travel.bring_near(&body, &norm, ROUNDED_BOUND * evidence.error, &mut violation);
    }
    let evidence = Evidence { residual: of_body(&evidence.residual), violation, measured: None, ..evidence };
    Ok(proven_in(&body, &norm, [&displacement, multiplier], Some(evidence)))
}

/// The travels; `None` without any, or if a dof without stiffness is none: all of its rows stop the same sense of
/// it, no other travel is in them, and a force drives it against them.
fn travels(problem: &ContactProblem) -> Option<Vec<Travel>> {
    let dofs = problem.without_stiffness();
    let mut is_taken = vec![false; problem.rows()];
    let of_dof = |&dof: &usize| {
        let sense = problem.load[dof].signum();
        let rows: Vec<(usize, f64)> =
            problem.contact.column(dof).filter(|entry| entry.1 != 0.0).map(|(row, c)| (row, sense * c)).collect();
        let is_own = |&(row, c): &(usize, f64)| c > 0.0 && !std::mem::replace(&mut is_taken[row], true);
        (problem.load[dof] != 0.0 && rows.iter().all(is_own)).then_some(Travel { dof, rows })
    };
    let travels: Vec<Travel> = dofs.iter().map(of_dof).collect::<Option<_>>()?;
    (!travels.is_empty()).then_some(travels)
}

impl Travel {
    /// Moves the rows of this travel to the place where it can be at most: `violation` is `b'u - g` before, and
    /// `b'u + c t - g` after, with all that is not known of t. The displacement of the body has an error of at most
    /// `error` in energy.
    fn bring_near(&self, body: &ContactProblem, norm: &EnergyNorm, error: f64, violation: &mut [f64]) {
        let compliance = ComplianceFactor::of(body, norm);
        let rough = compliance.reach_at_once().unwrap_or_else(|| vec![f64::INFINITY; body.rows()]);
        let place = |&(row, c): &(usize, f64)| -violation[row] / c;
        let nearest = self.rows.iter().map(place).fold(f64::INFINITY, f64::min);
        let mut off: Vec<f64> = self.rows.iter().map(|&(row, c)| error * rough[row] / c).collect();
        let candidates = |off: &[f64]| -> Vec<usize> {
            let surely = self.rows.iter().zip(off).map(|(row, off)| place(row) + off).fold(f64::INFINITY, f64::min);
            (0..off.len()).filter(|&index| place(&self.rows[index]) - off[index] <= surely).collect()
        };
        let first = candidates(&off);
        if first.len() <= MOST_SWEPT {
            for &index in &first {
                let (row, c) = self.rows[index];
                off[index] = off[index].min(error * compliance.reach(row) / c);
            }
        }
        let unsure = candidates(&off).into_iter().map(|index| off[index]).fold(0.0, f64::max);
        for &(row, c) in &self.rows {
            let rounding = PLACE_ROUNDING * (violation[row].abs() + (c * nearest).abs() + body.gap[row].abs());
            violation[row] += c * (nearest + unsure) + rounding;
        }
    }
}
