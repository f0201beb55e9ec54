//! What is said of a problem that has no unique answer, rechecked in the problem itself with twice the working precision.

use crate::error::Error;
use crate::qp::linear::{Accumulator, largest};
use crate::qp::problem::ContactProblem;

/// A sum vanishes where its terms cancel to this share of their sizes: the direction is given in doubles, which leave 1e-16 of
/// each term, and was found by a factorisation, which leaves some digits more.
const VANISHES: f64 = 1e-10;

/// Entries below this share of the largest are what the factorisation has left of zero.
const ZERO: f64 = 1e-9;

/// A load drives a motion if its work is beyond this share of its terms.
const DRIVES: f64 = 1e-9;

/// A load does no work on a motion if that is within this share of its terms, as rounding of the sum leaves it: where rounding
/// of the direction leaves more, the load may as well hold what it seems to leave free.
const IDLE: f64 = 1e-30;

/// A speed beyond this share of its terms is more than rounding of a direction in doubles leaves; up to [`SURE`], it is less
/// than a direction that is found by a factorisation can tell.
const UNSURE: f64 = 1e-15;

/// See [`UNSURE`].
const SURE: f64 = 1e-8;

/// Entries of a motion are looked at in this unit of the largest: a translation becomes one without rounding.
const GRID: f64 = 1073741824.0;

/// An entry lies on the grid if it is this close to it, as rounding of a factorisation leaves it.
const ON_GRID: f64 = 1e-12;

/// Energy of a direction counts as negative beyond this share of its terms.
const NEGATIVE: f64 = 1e-12;

/// A direction without energy, and what the rows and the load say of it.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    /// The direction d, one entry per dof, largest entry one.
    pub direction: Vec<f64>,
    /// `B d` of each row, zero where it vanishes, positive where the motion closes the row.
    pub approach: Vec<f64>,
    /// The share of its terms that is left of `f'd`.
    pub work: f64,
}

impl Motion {
    /// The error that it is, if the load drives the motion and no row stops it.
    pub fn escapes(&self) -> bool {
        self.work > DRIVES && self.approach.iter().all(|&speed| speed <= 0.0)
    }

    /// Does the load do no work on the motion, and does no row stop it?
    pub fn drifts(&self) -> bool {
        self.work.abs() <= IDLE && self.approach.iter().all(|&speed| speed <= 0.0)
    }

    /// How the motion was rechecked, and most of it.
    pub fn in_words(&self) -> String {
        let mut entries: Vec<(usize, f64)> = self.direction.iter().copied().enumerate().collect();
        entries.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        let named: Vec<String> = entries.iter().take(3).filter(|e| e.1 != 0.0).map(|e| e.0.to_string()).collect();
        format!(
            "most of it at dof {} (indices from 0); its forces K d vanish to {VANISHES:.0e} of their terms",
            named.join(", ")
        )
    }
}

impl ContactProblem {
    /// A direction of which the stiffness resists nothing, if it is one: `K d` vanishes in every dof. A direction is none if it
    /// cannot tell whether it closes, opens or slides along a row.
    pub(crate) fn motion_along(&self, direction: &[f64]) -> Option<Motion> {
        let size = largest(direction);
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let kept = |value: &f64| if value.abs() > ZERO * size { value / size } else { 0.0 };
        let direction: Vec<f64> = direction.iter().map(kept).collect();
        let on_grid: Vec<f64> = direction.iter().map(|value| (value * GRID).round()).collect();
        let forces_of = |d: &[f64]| self.accurate_product(|column| self.stiffness.lower().column(column), d);
        // A stiffness without entries resists nothing, and a direction off the grid would be turned for no reason.
        let is_on_grid = on_grid.iter().zip(&direction).all(|(units, value)| (units / GRID - value).abs() <= ON_GRID);
        let is_exact = is_on_grid && forces_of(&on_grid).iter().all(|&force| force == 0.0);
        let direction = if is_exact { on_grid.iter().map(|value| value / GRID).collect() } else { direction };
        let forces = forces_of(&direction);
        let terms = self.stiffness.mul_abs(&direction);
        if forces.iter().zip(&terms).any(|(force, terms)| force.abs() > VANISHES * terms) {
            return None;
        }
        let mut approach = Accumulator::new(&vec![0.0; self.rows()]);
        self.contact.triplets().for_each(|(row, dof, b)| approach.add_product(row, b, direction[dof]));
        let sizes: Vec<f64> = direction.iter().map(|value| value.abs()).collect();
        let terms = self.contact.mul_abs(&sizes);
        let counts = |(row, speed): (usize, f64)| {
            if self.gap[row].is_finite() && speed.abs() > VANISHES * terms[row] { speed } else { 0.0 }
        };
        let sums = approach.into_sums();
        let is_unsure = |(row, &speed): (usize, &f64)| {
            let share = speed.abs() / terms[row];
            self.gap[row].is_finite() && share > UNSURE && share < SURE
        };
        if sums.iter().enumerate().any(is_unsure) {
            return None;
        }
        let approach = sums.into_iter().enumerate().map(counts).collect();
        let mut work = Accumulator::new(&[0.0]);
        self.load.iter().zip(&direction).for_each(|(&f, &d)| work.add_product(0, f, d));
        let terms: f64 = self.load.iter().zip(&sizes).map(|(f, d)| f.abs() * d).sum();
        let work = if terms > 0.0 { work.into_sums()[0] / terms } else { 0.0 };
        Some(Motion { direction, approach, work })
    }

    /// The error that a direction p of negative energy is, if `p'K p` is negative beyond rounding.
    pub(crate) fn not_convex_along(&self, p: &[f64]) -> Option<Error> {
        let size = largest(p);
        let p: Vec<f64> = p.iter().map(|value| value / size).collect();
        let forces = self.accurate_product(|column| self.stiffness.lower().column(column), &p);
        let energy: f64 = forces.iter().zip(&p).map(|(force, p)| force * p).sum();
        let terms: f64 = self.stiffness.mul_abs(&p).iter().zip(&p).map(|(force, p)| force * p.abs()).sum();
        let dof = p.iter().position(|value| value.abs() == 1.0).unwrap_or(0);
        (energy < -NEGATIVE * terms).then(|| Error::NotConvex {
            evidence: format!(
                "a direction p with largest entry one, at dof {dof} (indices from 0), has p'Kp = {energy:.3e}, beyond {NEGATIVE:.0e} \
                 of its terms, {terms:.3e}"
            ),
        })
    }
}
