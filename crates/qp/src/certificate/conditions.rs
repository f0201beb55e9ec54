//! The certificate: every condition of the solution recomputed from the original problem, and the numbers that decide,
//! from a bound on the error: relative to the energy norm of each part, or to the forces on a part that rests.

use std::borrow::Cow;

use super::bound::boundary::energy_error_bound;
use super::bound::general::energy_error_bound_by;
use super::bound::{Answer, ErrorBound, Measured};
use super::energy_norm::{EnergyNorm, norm_of_answer};
use super::scales::{OfPart, Scales, balanced_forces, coupled_lengths, larger, relative};
use crate::error::Result;
use crate::linear::multigrid::Multigrid;
use crate::linear::watch::Watch;
use crate::problem::{Balance, ContactProblem};
use crate::solution::{Cancellation, Certificate};

/// Rounding moves an entry of u or lambda by half a last bit, and so may the arithmetic that made it: both are excused.
const ENTRY_ROUNDING: f64 = f64::EPSILON;

/// The means by which the error is bounded in energy.
pub enum Bounding<'a> {
    /// None: the conditions are recomputed, and no bound is known.
    Nothing,
    /// A factor that is made for this certificate alone.
    OwnFactor,
    /// A factor that is at hand.
    Factor(EnergyNorm),
    /// The cycles of the hierarchy of K, which need no factor and rest on a measured eigenvalue. There is no bound if K
    /// is singular to the precision of its levels, or if the watch is over before it is found.
    Cycles(&'a Multigrid, Watch),
    /// The certificates of pieces without coupling, of which the answer was put together.
    Pieces(&'a [Certificate]),
}

/// A certificate and the evidence that it was computed from; an answer in far units has no evidence.
pub struct Examined {
    pub certificate: Certificate,
    pub evidence: Option<Evidence>,
    /// The parts that move in the answer, but may rest in the exact one: their error is too large to exclude it.
    pub may_rest: Vec<usize>,
}

/// Evidence that a certificate has found for an answer, used to prove its contact set.
#[derive(Debug)]
pub struct Evidence {
    /// `f + B' lambda - K u` of the answer, one entry per dof.
    pub residual: Vec<f64>,
    /// `B u - g`.
    pub violation: Vec<f64>,
    /// An upper bound on `|u - u*|_K`; infinite if none is known.
    pub error: f64,
    pub measured: Option<Measured>,
    /// The norm of a factor that was made for the certificate, if the proof needs it and it is that of K itself.
    pub norm: Option<EnergyNorm>,
}

fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |worst, value| larger(value.abs(), worst))
}

/// A certificate of an error that is as large in energy, for this displacement: with the rounding of it.
pub fn with_rounding(problem: &ContactProblem, certificate: Certificate, displacement: &[f64]) -> Certificate {
    let of = energy_of(problem, displacement);
    let energy_error = certificate.energy_error + of.rounding();
    let part_error_bound = larger(certificate.part_error_bound, relative(energy_error, of.certain_norm()));
    Certificate { energy_error, part_error_bound, ..certificate }
}

pub fn energy_of(problem: &ContactProblem, displacement: &[f64]) -> OfPart {
    let Balance { strain, terms, .. } = problem.accurate_balance(displacement, &[]);
    let moves = displacement.iter().any(|&u| u != 0.0);
    let terms = displacement.iter().zip(&terms).map(|(u, terms)| u.abs() * terms).sum();
    OfPart { strain, terms, moves, ..OfPart::default() }
}

/// The displacement u with those parts at rest that may rest, which is an answer too; `None` if no part may. A
/// method leaves the rounding of forces as a displacement of a part at rest, which is wrong by all of it.
pub fn at_rest(problem: &ContactProblem, u: &[f64], may_rest: &[usize]) -> Option<Vec<f64>> {
    let rests = |dof: usize| may_rest.contains(&problem.parts().of_dof[dof]);
    let at_rest = || u.iter().enumerate().map(|(dof, &u)| if rests(dof) { 0.0 } else { u }).collect();
    (!may_rest.is_empty()).then(at_rest)
}

/// The certificate of an answer, with a factor that is made here if there is none.
pub fn examined(problem: &ContactProblem, by: &Bounding, [u, lambda]: [&[f64]; 2]) -> Result<Examined> {
    let (two_sided, of_rows) = problem.two_sided(lambda);
    let own = if matches!(by, Bounding::OwnFactor) { norm_of_answer(&two_sided, u, &of_rows)? } else { None };
    let norm = if let Bounding::Factor(norm) = by { Some(norm) } else { own.as_ref() };
    let balance = problem.accurate_balance(u, &[lambda]);
    let violation = problem.accurate_violation(u);
    let (contact_terms, lengths) = (problem.contact.mul_abs_transposed(lambda), problem.contact.mul_abs(u));
    let forces: Vec<f64> = problem.load.iter().zip(&contact_terms).map(|(f, contact)| f.abs() + contact).collect();
    let scales = Scales::of(problem, [u, lambda], &balance, &forces);
    let Balance { residual, elastic, strain, terms } = balance;

    let balanced = balanced_forces(problem, terms.iter().zip(&forces).map(|(terms, forces)| terms + forces).collect());
    let share = |dof: usize, force: f64| relative(force.abs(), balanced[dof]);
    // With the multiplier of each row.
    let mut shares_of_rows: Vec<(f64, f64)> = lambda.iter().map(|&lambda| (lambda, 0.0)).collect();
    for dof in 0..problem.dofs() {
        problem.contact.with_rows(dof, &mut shares_of_rows, |(lambda, most), b| {
            if *lambda != 0.0 {
                *most = larger(share(dof, b * *lambda), *most);
            }
        });
    }
    let own_length = |row: usize| {
        let of_part = scales.of_parts[problem.parts().of_row[row]].strain.max(0.0).sqrt() * scales.reach[row];
        let gap = if problem.gap[row].is_finite() { problem.gap[row].abs() } else { 0.0 };
        larger(lengths[row], larger(gap, of_part))
    };
    let lengths_of_rows = coupled_lengths(problem, (0..problem.rows()).map(own_length).collect());
    let length = |row: usize| lengths_of_rows[row];
    let rows = || (0..problem.rows()).filter(|&row| problem.gap[row].is_finite() || lambda[row] != 0.0);
    // A row without obstacle carries no multiplier.
    let work = |row: usize| if lambda[row] == 0.0 { 0.0 } else { lambda[row] * violation[row] };
    let stationarity = worst((0..u.len()).map(|dof| share(dof, residual[dof])));
    // Rounding of u moves a row, and a part that rests is known only to the rounding of its forces.
    let is_rounding = |row: usize| {
        let rest = scales.rest_of_row(row, problem.parts().of_row[row]);
        violation[row].abs() <= ENTRY_ROUNDING * lengths[row] + rest
    };
    let distance = |row: usize| if is_rounding(row) { 0.0 } else { relative(violation[row], length(row)) };
    let penetration = worst(rows().map(|row| distance(row).max(0.0)));
    let adhesion = worst(rows().filter(|&row| lambda[row] > 0.0).map(|row| shares_of_rows[row].1));
    let gap = u.iter().zip(&residual).map(|(u, r)| -u * r).chain(rows().map(work)).sum::<f64>();
    let mut certificate = Certificate {
        stationarity,
        penetration,
        adhesion,
        complementarity: relative(worst(rows().map(work)), strain.max(0.0)),
        duality_gap: relative(gap.abs(), strain.max(0.0)),
        imbalance: imbalance(problem, &residual, |dof| balanced[dof]),
        loose_dofs: norm.map_or(0, EnergyNorm::loose_dofs),
        open_force: worst(rows().map(|row| shares_of_rows[row].1.min((-distance(row)).max(0.0)))),
        parts: problem.parts().count(),
        bound_is_measured: matches!(by, Bounding::Cycles(..)),
        ..Certificate::unknown()
    };
    let rounding = scales.whole.rounding();
    let answer = Answer { problem, displacement: u, multiplier: lambda, residual, violation, rounding };
    let by_sides = match &of_rows {
        Cow::Borrowed(_) => None,
        Cow::Owned(of_rows) => Some(Answer { rounding, ..Answer::of(&two_sided, u, of_rows) }),
    };
    let bounded = by_sides.as_ref().unwrap_or(&answer);
    let (bound, measured, loss) = match (by, norm) {
        (_, Some(norm)) => (energy_error_bound(norm, bounded), None, norm.loss()),
        (Bounding::Cycles(multigrid, watch), _) => {
            let found = energy_error_bound_by(multigrid, bounded, watch);
            let (bound, measured) = found.unwrap_or((ErrorBound::none(), None));
            (bound, measured, measured.map_or(1.0, |measured| 1.0 / measured.ritz.min(1.0)))
        }
        _ => (ErrorBound::none(), None, 1.0),
    };
    let part = certificate.set_bounds(&bound, &scales, loss);
    certificate.cancellation = cancellation(problem, &forces, &elastic, part);
    let Answer { residual, violation, .. } = answer;
    let has_bound = norm.is_some() || matches!(by, Bounding::Cycles(..));
    let (may_rest, error) = (scales.may_rest(&bound), bound.whole);
    // Only the proof of a problem with equalities has no factor of its own.
    let norm = own.filter(|norm| !problem.equalities().is_empty() && norm.springs.is_none() && norm.loose.is_none());
    let evidence = has_bound.then_some(Evidence { residual, violation, error, measured, norm });
    Ok(Examined { certificate, evidence, may_rest })
}

/// The largest imbalance above rounding, relative to the largest force on the part; without stiffness, on the dof.
fn imbalance(problem: &ContactProblem, residual: &[f64], terms: impl Fn(usize) -> f64) -> f64 {
    let (parts, roots) = (problem.parts(), &problem.diagonal().roots);
    let (mut left, mut largest, mut without_stiffness) = (vec![0.0; parts.count()], vec![0.0; parts.count()], 0.0);
    for (dof, &root) in roots.iter().enumerate() {
        let (part, terms) = (parts.of_dof[dof], terms(dof));
        let excess = if residual[dof].abs() <= ENTRY_ROUNDING * terms { 0.0 } else { residual[dof].abs() };
        if root > 0.0 {
            left[part] = larger(excess / root, left[part]);
            largest[part] = larger(terms / root, largest[part]);
        } else {
            without_stiffness = larger(relative(excess, terms), without_stiffness);
        }
    }
    let of_parts = left.iter().zip(&largest).map(|(&left, &largest)| relative(left, largest));
    larger(without_stiffness, worst(of_parts))
}

/// The dof of a part, or of all, at which the `forces` lose most digits to what is left as elastic force.
fn cancellation(problem: &ContactProblem, forces: &[f64], elastic: &[f64], part: Option<usize>) -> Cancellation {
    let is_in = |dof: &usize| part.is_none_or(|part| problem.parts().of_dof[*dof] == part);
    let all = (0..forces.len()).filter(is_in).map(|dof| Cancellation { dof, forces: forces[dof], left: elastic[dof] });
    let fewer = |a: Cancellation, b: Cancellation| if b.forces * a.left > a.forces * b.left { b } else { a };
    all.filter(|at| at.forces > 0.0).reduce(fewer).unwrap_or(Cancellation { dof: 0, forces: 0.0, left: 0.0 })
}

/// An error up to this multiple of `eps sqrt(|u|'|K||u|)` is what rounding u to doubles does: half a unit in the last
/// place of each entry, once for the rounding of u and once for the rounding of the bound.
const AS_ROUNDED: f64 = f64::EPSILON;

/// An error of a part at rest is rounding up to this multiple of its forces and of the loss of the factor.
const FORCES_ROUNDED: f64 = f64::EPSILON;

/// The same for forces that cancel to the last bit: far above the rounding of twice the working precision.
const CANCELLED: f64 = 1e-26;

/// Relative error of sums with twice the working precision stays below this share of their terms: no bound is smaller.
const LEAST: f64 = 1e-28;

/// Rounding of an energy computed with twice the working precision, as a share of its terms.
const OF_ENERGY: f64 = 1e-31;

impl OfPart {
    /// The certain part of the energy norm: a body that moves far and does not bend has only energy from rounding.
    pub fn certain_norm(&self) -> f64 {
        (self.strain - OF_ENERGY * self.terms).max(0.0).sqrt()
    }

    /// What rounding the displacement to doubles does to its energy norm.
    pub fn rounding(&self) -> f64 {
        AS_ROUNDED * self.terms.sqrt()
    }

    /// The bound with the rounding of sums in twice the working precision.
    fn widened(&self, error: f64) -> f64 {
        error + LEAST * self.terms.sqrt()
    }

    /// The energy norm that rounding gives a part at rest, from the squares of the forces that it leaves and of all.
    pub fn rest(&self, rounded: f64, all: f64) -> f64 {
        FORCES_ROUNDED * rounded.sqrt() + CANCELLED * all.sqrt()
    }
}

#[derive(Default)]
struct Worst {
    relative: f64,
    excess: f64,
    part: Option<usize>,
    resting: usize,
    of_rest: f64,
}

impl Worst {
    fn moving(&mut self, error: f64, of: &OfPart, part: Option<usize>) {
        let share = relative(error, of.certain_norm());
        self.relative = larger(share, self.relative);
        let excess = if error <= of.rounding() { 0.0 } else { share };
        if self.part.is_none() || excess.is_nan() || excess > self.excess {
            self.part = part;
        }
        self.excess = larger(excess, self.excess);
    }
}

impl Certificate {
    /// Sets the numbers that follow from a bound on the error, in a norm whose factor amplifies rounding by `loss`.
    /// Returns the part that is farthest from its goal, or `None` if that is the whole.
    pub(super) fn set_bounds(&mut self, bound: &ErrorBound, scales: &Scales, loss: f64) -> Option<usize> {
        let Scales { of_parts: parts, whole, .. } = scales;
        let mut worst = Worst::default();
        let of_parts = bound.of_parts.as_deref().unwrap_or(std::slice::from_ref(&bound.whole));
        let each = if of_parts.len() == parts.len() { &parts[..] } else { std::slice::from_ref(whole) };
        for (number, (of, &error)) in each.iter().zip(of_parts).enumerate().filter(|(_, (of, _))| of.is_stiff) {
            let error = of.widened(error);
            // Rounding of the forces on a part at rest, which a factor amplifies by `loss`.
            if !of.moves && error <= loss * of.rest(of.squares[1][0], of.squares[0][0]) {
                worst.resting += 1;
                worst.of_rest = larger(relative(error, of.force), worst.of_rest);
            } else {
                worst.moving(error, of, Some(number));
            }
        }
        let error = whole.widened(bound.whole);
        self.energy_error = error;
        self.energy_error_bound = relative(error, whole.certain_norm());
        if whole.moves {
            worst.moving(error, whole, None);
        }
        (self.part_error_bound, self.energy_error_excess) = (worst.relative, worst.excess);
        (self.parts_at_rest, self.rest_error) = (worst.resting, worst.of_rest);
        self.at_rest = worst.resting > 0 && worst.resting == each.iter().filter(|of| of.is_stiff).count();
        self.met_tolerance = self.reached_without_excuse();
        worst.part
    }

    /// The certificate with the bounds of pieces without coupling, which are these scales of the `whole`.
    pub(super) fn with_bounds_of(self, pieces: &[Certificate], whole: &OfPart) -> Self {
        let largest = |of: fn(&Certificate) -> f64| pieces.iter().fold(0.0, |worst, piece| larger(of(piece), worst));
        let energy_error = pieces.iter().map(|piece| piece.energy_error.powi(2)).sum::<f64>().sqrt();
        let mut worst = Worst::default();
        if whole.moves {
            worst.moving(energy_error, whole, None);
        }
        let farthest = |a: &&Certificate, b: &&Certificate| a.energy_error_excess.total_cmp(&b.energy_error_excess);
        let mut whole = Certificate {
            energy_error,
            energy_error_bound: relative(energy_error, whole.certain_norm()),
            part_error_bound: larger(worst.relative, largest(|piece| piece.part_error_bound)),
            energy_error_excess: larger(worst.excess, largest(|piece| piece.energy_error_excess)),
            at_rest: !pieces.is_empty() && pieces.iter().all(|piece| piece.at_rest),
            parts_at_rest: pieces.iter().map(|piece| piece.parts_at_rest).sum(),
            rest_error: largest(|piece| piece.rest_error),
            bound_is_measured: pieces.iter().any(|piece| piece.bound_is_measured),
            cancellation: pieces.iter().max_by(farthest).map_or(self.cancellation, |piece| piece.cancellation),
            ..self
        };
        whole.met_tolerance = whole.reached_without_excuse();
        whole
    }

    /// The tolerance that is met without the excuse of rounding or, if none is, with it.
    fn reached_without_excuse(&self) -> f64 {
        match self.imbalance.max(self.penetration).max(self.open_force).max(self.part_error_bound) {
            _ if self.adhesion != 0.0 => f64::INFINITY,
            met if met.is_finite() => met,
            _ => self.reached(),
        }
    }
}

impl Scales {
    /// The parts that move in the answer, but whose error is so large that they may rest in the exact one, increasing.
    pub fn may_rest(&self, bound: &ErrorBound) -> Vec<usize> {
        let errors = bound.of_parts.as_deref().unwrap_or(std::slice::from_ref(&bound.whole));
        let may_rest = |of: &OfPart, error: f64| {
            of.moves && error.is_finite() && error >= of.certain_norm() && error > of.rounding()
        };
        let each = self.of_parts.iter().zip(errors).enumerate();
        each.filter(|(_, (of, error))| may_rest(of, **error)).map(|(part, _)| part).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::Examination;
    use crate::settings::Settings;
    use crate::solve;

    /// The relative excess of the bound of an answer over its error, from the factor for rounding.
    const ROUNDED: f64 = 1e-5;

    #[test]
    fn the_energy_of_a_displacement_of_three_against_a_stiffness_of_four_is_thirty_six() {
        let spring = ContactProblem::of_entries(&[(0, 0, 4.0)], &[0.0], &[], &[]);
        let OfPart { strain, terms, moves, .. } = energy_of(&spring, &[-3.0]);
        assert_eq!((strain, terms, moves), (36.0, 36.0, true));
    }

    /// Two dofs of stiffness 4 and 16, each a part, under loads of 8 and 48, before walls at 1 and 2.
    fn parts() -> ContactProblem {
        let walls = [(0, 0, 1.0), (1, 1, 1.0)];
        ContactProblem::of_entries(&[(0, 0, 4.0), (1, 1, 16.0)], &[8.0, 48.0], &walls, &[1.0, 2.0])
    }

    #[test]
    fn the_energy_error_is_in_the_unit_of_energy_and_relative_to_the_energy_norm() {
        let problem = parts();
        let answer = solve(&problem, &Settings::default()).unwrap();
        assert_eq!((&answer.displacement[..], &answer.multiplier[..]), (&[1.0, 2.0][..], &[-4.0, -16.0][..]));
        assert!(answer.certificate.energy_error < ROUNDED);
        // The first dof is off by 3e-3, of stiffness 4; the second by 2e-3, of stiffness 16.
        let certificate = problem.certify(&[1.003, 2.002], &answer.multiplier).unwrap();
        assert!((certificate.energy_error / 1e-2 - 1.0).abs() < ROUNDED, "{certificate:?}");
        let norm = (4.0 * 1.003_f64.powi(2) + 16.0 * 2.002_f64.powi(2)).sqrt();
        assert!((certificate.energy_error_bound * norm / 1e-2 - 1.0).abs() < ROUNDED, "{certificate:?}");
    }

    #[test]
    fn errors_of_pieces_add_up_as_squares_and_the_worst_part_stays_the_worst() {
        let problem = parts();
        let (u, lambda) = ([1.0, 2.0], [-4.0, -16.0]);
        let mut pieces = [0; 2].map(|_| problem.certify(&u, &lambda).unwrap());
        let by_pieces = |pieces: &[Certificate]| {
            let by = Bounding::Pieces(pieces);
            Examination::of(&problem, [&u, &lambda], &by).unwrap().certificate().unwrap().certificate
        };
        (pieces[0].energy_error, pieces[1].energy_error) = (3e-3, 4e-3);
        (pieces[0].part_error_bound, pieces[1].part_error_bound) = (0.25, 7.0);
        (pieces[0].energy_error_excess, pieces[1].energy_error_excess) = (5.0, 0.5);
        pieces[0].cancellation.dof = 1;
        let whole = by_pieces(&pieces);
        // The energy norm is sqrt(4 1^2 + 16 2^2).
        let bound = 5e-3 / 68_f64.sqrt();
        assert!((whole.energy_error_bound / bound - 1.0).abs() < ROUNDED, "{whole:?}");
        assert_eq!((whole.part_error_bound, whole.energy_error_excess, whole.bound_is_measured), (7.0, 5.0, false));
        assert_eq!((whole.met_tolerance, whole.cancellation.dof), (7.0, 1));
        pieces[1].bound_is_measured = true;
        (pieces[0].part_error_bound, pieces[1].part_error_bound) = (0.0, 0.0);
        let whole = by_pieces(&pieces);
        assert!(whole.bound_is_measured && whole.part_error_bound == whole.energy_error_bound, "{whole:?}");
        // The error of a part at rest counts in the whole.
        pieces[0].parts_at_rest = 1;
        (pieces[1].part_error_bound, pieces[0].energy_error_excess) = (1e-11, 0.0);
        let whole = by_pieces(&pieces);
        assert_eq!((whole.part_error_bound, whole.parts_at_rest), (whole.energy_error_bound, 1), "{whole:?}");
        pieces[1].energy_error_excess = 0.0;
        let whole = by_pieces(&pieces);
        assert!((whole.energy_error_excess / bound - 1.0).abs() < ROUNDED && !whole.at_rest, "{whole:?}");
    }

    #[test]
    fn a_load_on_the_wall_is_no_scale_of_the_error_beside_it() {
        let stiffness = [(0, 0, 1.0), (1, 0, -0.5), (1, 1, 1.0)];
        let problem = ContactProblem::of_entries(&stiffness, &[1e9, 1.0], &[(0, 0, 1.0)], &[1.0]);
        // At the wall the second dof is at 3/2; an answer with 0 there is wrong by sqrt(9/4).
        let wrong = problem.certify(&[1.0, 0.0], &[-(1e9 - 1.0)]).unwrap();
        assert!(!wrong.meets(1.0) && wrong.energy_error >= 1.5 && wrong.energy_error_bound >= 1.5, "{wrong:?}");
        let right = problem.certify(&[1.0, 1.5], &[-(1e9 - 0.25)]).unwrap();
        assert!(right.meets(1e-9) && right.cancellation.dof == 0, "{right:?}");
        // 2e9 cancel down to a quarter.
        assert!((right.cancellation.digits_left() - (16.0 - 8e9_f64.log10())).abs() < ROUNDED, "{right:?}");
    }

    #[test]
    fn a_part_at_rest_is_certified_by_its_forces_and_any_displacement_of_it_is_not() {
        let problem = parts().with(vec![0.3, 48.0], vec![0.0, 2.0]).unwrap();
        let rests = problem.certify(&[0.0, 2.0], &[-0.3, -16.0]).unwrap();
        assert!(rests.meets(1e-12) && !rests.at_rest, "{rests:?}");
        assert_eq!((rests.parts, rests.parts_at_rest), (2, 1));
        // The bound is that of the displacement; a wrong force is seen in the balance.
        let off = problem.certify(&[0.0, 2.0], &[-0.3 * (1.0 - 1e-6), -16.0]).unwrap();
        assert!(off.meets(1e-6) && !off.meets(1e-7) && off.parts_at_rest == 1, "{off:?}");
        // The first part rests; a displacement of 1e-17 is wrong by all of it.
        let moved = problem.certify(&[-1e-17, 2.0], &[-0.3, -16.0]).unwrap();
        assert!(!moved.meets(0.5) && moved.parts_at_rest == 0, "{moved:?}");
        let found = solve(&problem, &Settings::default()).unwrap();
        assert_eq!((found.displacement[0], found.certificate.parts_at_rest), (0.0, 1));
    }

    #[test]
    fn a_row_that_pulls_is_never_certified() {
        let problem = parts();
        let pulled = problem.certify(&[2.0, 3.0], &[1e-20, 0.0]).unwrap();
        assert!(!pulled.meets(1e9) && pulled.met_tolerance.is_infinite(), "{pulled:?}");
        assert_eq!(pulled.decisive(1e-9).0, "adhesion");
    }

    #[test]
    fn dofs_without_stiffness_or_force_out_of_balance_do_not_hide_the_bound() {
        // A dof of stiffness 4 under a force of 8 before a wall at 1, and a loose dof between two walls.
        let walls = [(0, 0, 1.0), (1, 1, 1.0), (2, 1, -1.0)];
        let problem = ContactProblem::of_entries(&[(0, 0, 4.0)], &[8.0, 0.0], &walls, &[1.0, 0.0, 1.0]);
        let right = problem.certify(&[1.0, 0.0], &[-4.0, 0.0, 0.0]).unwrap();
        assert!(right.meets(1e-12), "{right:?}");
        let off = problem.certify(&[0.75, 0.0], &[-5.0, 0.0, 0.0]).unwrap();
        assert!((off.energy_error / 0.5 - 1.0).abs() < ROUNDED, "{off:?}");
        // A force on the loose dof that no row takes has no bound, nor has one that rows take with another force.
        assert!(!problem.certify(&[1.0, 0.0], &[-4.0, -1e-30, 0.0]).unwrap().has_bound());
        // Without clearance the walls are an equality, which holds the dof by any force.
        let held = problem.with_gap(vec![1.0, 0.0, 0.0]).unwrap();
        assert!(held.certify(&[1.0, 0.0], &[-4.0, -1e-30, 0.0]).unwrap().has_bound());
    }
}
