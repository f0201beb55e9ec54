//! Statements on a problem without a unique answer, rechecked in the problem itself with twice the working precision.

use crate::error::{Error, LinearError};
use crate::linear::twice::Sum;
use crate::linear::{NullSpace, Twice, largest};
use crate::problem::ContactProblem;

/// A load drives a mode if its work is beyond this share of its terms.
const DRIVES: f64 = 1e-9;

/// The work of a load vanishes below this share of its terms: a row holds a load out of balance by its last bit.
const IDLE: f64 = 1e-29;

/// Rounding of sums over a direction, as shares of their terms.
#[derive(Clone, Copy)]
pub struct Rounding {
    /// Entries below this share of the largest are rounded zeros.
    entry: f64,
    /// Forces `K d` up to this count as zero, and so do the coordinates of a row.
    pub vanishes: f64,
    /// A sum up to this is zero.
    pub zero: f64,
    /// A sum beyond this has a certain sign; between `zero` and this its sign is not known.
    sure: f64,
}

impl Rounding {
    /// For a direction in twice the working precision on which the stiffness does exactly no work.
    const OF_EXACT: Rounding = Rounding { entry: 1e-24, vanishes: 1e-28, zero: 1e-28, sure: 1e-28 };

    /// For a rigid-body mode that the problem declares: known as precisely as rounded entries of the stiffness.
    const OF_ROUNDED: Rounding = Rounding { entry: 1e-9, vanishes: 1e-10, zero: 1e-15, sure: 1e-8 };

    pub fn of(null: &NullSpace) -> Self {
        if null.is_exact() { Self::OF_EXACT } else { Self::OF_ROUNDED }
    }
}

/// Energy of a direction counts as negative beyond this share of its terms.
const NEGATIVE: f64 = 1e-12;

/// A direction without energy, with the approach of the rows and the work of the load along it.
#[derive(Clone, Debug)]
pub struct NullMode {
    /// The direction d, one entry per dof, largest entry one.
    pub direction: Vec<f64>,
    /// `B d` of each row, zero if it vanishes, positive if the mode closes the row.
    pub approach: Vec<f64>,
    /// `f'd` as a share of its terms, zero if it vanishes.
    pub work: f64,
    /// `K d` stays below this share of its terms.
    resistance: f64,
}

impl NullMode {
    /// The error to report if the load drives the mode and no row stops it.
    pub fn escapes(&self) -> bool {
        self.work > DRIVES && self.approach.iter().all(|&speed| speed <= 0.0)
    }

    pub fn is_idle(&self) -> bool {
        self.work == 0.0
    }

    pub fn in_words(&self) -> String {
        let mut entries: Vec<(usize, f64)> = self.direction.iter().copied().enumerate().collect();
        entries.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        let named: Vec<String> = entries.iter().take(3).filter(|e| e.1 != 0.0).map(|e| e.0.to_string()).collect();
        format!(
            "mainly at dof {} (indices from 0); its forces K d vanish to {:.0e} of their terms",
            named.join(", "),
            self.resistance
        )
    }
}

/// The null mode along a direction, if it is one: `K d` vanishes in every dof. There is no mode if it is not
/// certain whether the direction closes, opens or slides along a row.
pub fn mode_along(problem: &ContactProblem, direction: &[Twice], rounding: Rounding) -> Option<NullMode> {
    let by_size = |a: &&Twice, b: &&Twice| a.rounded().abs().total_cmp(&b.rounded().abs());
    let size = direction.iter().max_by(by_size)?.abs();
    if !(size.rounded() > 0.0 && size.rounded().is_finite()) {
        return None;
    }
    let whole: Vec<Twice> = direction.iter().map(|&value| value / size).collect();
    let kept = |&value: &Twice| if value.rounded().abs() > rounding.entry { value } else { Twice::ZERO };
    let cleaned = whole.iter().map(kept).collect();
    let is_free = |direction: &Vec<Twice>| {
        let resists = |force: &Sum| force.beyond(rounding.vanishes) != Twice::ZERO;
        !problem.stiffness.resistance(direction).iter().any(resists)
    };
    // Small entries may be rounded zeros or part of the mode.
    let direction = [cleaned, whole].into_iter().find(is_free)?;
    let by_row = problem.contact.transposed();
    let mut approach = vec![0.0; problem.rows()];
    for row in (0..problem.rows()).filter(|&row| problem.gap[row].is_finite()) {
        let moved: Sum = by_row.column(row).map(|(dof, b)| Twice::from(b) * direction[dof]).collect();
        approach[row] = moved.beyond(rounding.zero).rounded();
        if approach[row] != 0.0 && moved.beyond(rounding.sure) == Twice::ZERO {
            return None;
        }
    }
    let work: Sum = problem.load.iter().zip(&direction).map(|(&f, &d)| Twice::from(f) * d).collect();
    let left = work.beyond(IDLE).rounded();
    let work = if left == 0.0 { 0.0 } else { left / work.terms };
    let direction = direction.into_iter().map(Twice::rounded).collect();
    Some(NullMode { direction, approach, work, resistance: rounding.vanishes })
}

/// The error to report for a direction along which the problem without its equalities has no answer or several, if
/// it is a null mode up to the rounding of entries, and the equalities let it be.
pub fn motion_along(problem: &ContactProblem, direction: &[Twice]) -> Option<Error> {
    // The small entries of a motion that meets the equalities are part of it.
    let found = mode_along(problem, direction, Rounding { entry: 0.0, ..Rounding::OF_ROUNDED })?;
    if problem.equalities().iter().any(|pair| found.approach[pair.row] != 0.0 || found.approach[pair.opposed] != 0.0) {
        return None;
    }
    let (is_driven, mode, direction) = (found.work > DRIVES, found.in_words(), found.direction);
    Some(if is_driven { Error::Unbounded { mode, direction } } else { Error::UnderHeld { mode, direction } })
}

/// The error to report for a direction p of negative energy, if `p'K p` is negative beyond rounding.
pub fn not_convex_along(problem: &ContactProblem, p: &[f64]) -> Option<Error> {
    let size = largest(p);
    let p: Vec<f64> = p.iter().map(|value| value / size).collect();
    let forces = problem.accurate_forces(&p).into_sums();
    let energy: f64 = forces.iter().zip(&p).map(|(force, p)| force * p).sum();
    let terms: f64 = problem.stiffness.mul_abs(&p).iter().zip(&p).map(|(force, p)| force * p.abs()).sum();
    let dof = p.iter().position(|value| value.abs() == 1.0).unwrap_or(0);
    let evidence = || {
        format!(
            "a direction p with largest entry one, at dof {dof} (indices from 0), has p'Kp = {energy:.3e}, beyond {NEGATIVE:.0e} \
             of its terms, {terms:.3e}"
        )
    };
    (energy < -NEGATIVE * terms).then(|| LinearError::NotConvex { evidence: evidence() }.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_names_the_dofs_that_move_most_and_none_that_rests() {
        let in_words = |direction: &[f64]| {
            let direction = direction.to_vec();
            NullMode { direction, approach: Vec::new(), work: 0.0, resistance: 1e-28 }.in_words()
        };
        let named = |dofs: &str| {
            format!("mainly at dof {dofs} (indices from 0); its forces K d vanish to 1e-28 of their terms")
        };
        assert_eq!(in_words(&[0.25, 0.0, -1.0, 0.5, 0.125]), named("2, 3, 0"));
        assert_eq!(in_words(&[0.0, 1.0, 0.0, 0.0]), named("1"));
    }
}
