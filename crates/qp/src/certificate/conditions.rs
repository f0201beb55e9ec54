//! The certificate: every condition of the solution recomputed from the original problem.

use std::borrow::Cow;

use super::EnergyNorm;
use super::bound::{Answer, ErrorBound, Measured};
use super::scales::{Balance, OfPart, Scales, larger, relative};
use crate::error::{Error, LinearError};
use crate::linear::Accumulator;
use crate::linear::multigrid::Multigrid;
use crate::linear::watch::Watch;
use crate::problem::ContactProblem;
use crate::solution::{Cancellation, Certificate};

/// Rounding moves an entry of u or lambda by half a unit in the last place: once for the rounding and once for the
/// arithmetic that made the entry, their sum is excused.
const ENTRY_ROUNDING: f64 = f64::EPSILON;

/// The means by which the error is bounded in energy.
pub(crate) enum Bounding<'a> {
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
pub(crate) struct Examined {
    pub certificate: Certificate,
    pub evidence: Option<Evidence>,
    /// The parts that move in the answer, but may rest in the exact one: their error is too large to exclude it.
    pub may_rest: Vec<usize>,
}

/// Evidence that a certificate has found for an answer, used to prove its contact set.
#[derive(Debug)]
pub(crate) struct Evidence {
    /// `f + B' lambda - K u` of the answer, one entry per dof.
    pub(super) residual: Vec<f64>,
    /// `B u - g`.
    pub(super) violation: Vec<f64>,
    /// The least reach of each row.
    pub(super) reach: Vec<f64>,
    /// An upper bound on `|u - u*|_K`; infinite if none is known.
    pub(super) error: f64,
    /// Numbers that cycles have measured, if the bound comes from cycles.
    pub(super) measured: Option<Measured>,
    /// The norm of a factor that was made for the certificate, if the proof needs it and it is that of K itself.
    pub(super) norm: Option<EnergyNorm>,
}

fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |worst, value| larger(value.abs(), worst))
}

impl ContactProblem {
    /// The certificate of an answer: displacement u (length n, in m) and multiplier lambda (length m, in N, `<= 0` in
    /// compression; with equality rows followed by theirs, of either sign), with the energy bound if K is positive
    /// definite or the rows that press hold the body.
    ///
    /// # Errors
    /// [`LinearError::Length`] for vectors that do not fit, [`LinearError::Numerical`] if the factorisation of K fails for lack of
    /// memory.
    pub fn certify(&self, displacement: &[f64], multiplier: &[f64]) -> Result<Certificate, Error> {
        Ok(self.examine(&Bounding::OwnFactor, displacement, multiplier)?.certificate)
    }

    /// As [`ContactProblem::certify`], with the bound by these means, and with the evidence.
    pub(crate) fn examine(&self, by: &Bounding, displacement: &[f64], multiplier: &[f64]) -> Result<Examined, Error> {
        let multiplier = &*self.of_all_rows(multiplier);
        self.check_answer(displacement, multiplier)?;
        if let Bounding::Pieces(pieces) = by {
            let examined = self.examine(&Bounding::Nothing, displacement, multiplier)?;
            let certificate = examined.certificate.with_bounds_of(pieces, &self.energy_of(displacement));
            return Ok(Examined { certificate, ..examined });
        }
        let one_level = |multigrid: &Multigrid| multigrid.unknowns().len() <= 1;
        let by = match by {
            // A hierarchy of one level is already a factor, with so few dofs that another one in double precision costs
            // nothing.
            Bounding::Cycles(multigrid, _) if one_level(multigrid) => &Bounding::OwnFactor,
            by => by,
        };
        let Some(units) = self.far_units(displacement) else { return self.recomputed_by(by, displacement, multiplier) };
        let in_units;
        let by = match by {
            Bounding::OwnFactor => by,
            Bounding::Factor(norm) => {
                in_units = Bounding::Factor(norm.with_unit(units.stiffness));
                &in_units
            }
            _ => &Bounding::Nothing,
        };
        let (problem, u, lambda) = (self.in_units(&units)?, units.displacement(displacement), units.force(multiplier));
        let found = problem.recomputed_by(by, &u, &lambda)?;
        Ok(Examined { certificate: units.in_own(found.certificate), evidence: None, ..found })
    }

    /// As [`ContactProblem::recomputed`], with a factor that is made here if there is none.
    fn recomputed_by(&self, by: &Bounding, displacement: &[f64], multiplier: &[f64]) -> Result<Examined, Error> {
        if !matches!(by, Bounding::OwnFactor) {
            return Ok(self.recomputed(by, displacement, multiplier));
        }
        let (two_sided, of_rows) = self.two_sided(multiplier);
        let Some(norm) = two_sided.energy_norm(displacement, &of_rows)? else {
            return Ok(self.recomputed(&Bounding::Nothing, displacement, multiplier));
        };
        let mut examined = self.recomputed(&Bounding::Factor(norm.clone()), displacement, multiplier);
        // Only the proof of a problem with equalities has no factor of its own.
        let is_for_proof = !self.equalities().is_empty() && norm.is_of_stiffness_alone();
        if let Some(evidence) = examined.evidence.as_mut().filter(|_| is_for_proof) {
            evidence.norm = Some(norm);
        }
        Ok(examined)
    }

    /// A certificate of an error that is as large in energy, for this displacement: with the rounding of it.
    pub(crate) fn with_rounding(&self, certificate: Certificate, displacement: &[f64]) -> Certificate {
        certificate.rounded_by(&self.energy_of(displacement))
    }

    /// The scales of a displacement, without forces.
    fn energy_of(&self, displacement: &[f64]) -> OfPart {
        let Balance { strain, terms, .. } = self.accurate_balance(displacement, &[]);
        let moves = displacement.iter().any(|&u| u != 0.0);
        let terms = displacement.iter().zip(&terms).map(|(u, terms)| u.abs() * terms).sum();
        OfPart { strain, terms, moves, ..OfPart::default() }
    }

    /// The displacement u with those parts at rest that may rest, which is an answer too; `None` if no part may. A
    /// method leaves the rounding of forces as a displacement of a part at rest, which is wrong by all of it.
    pub(crate) fn at_rest(&self, u: &[f64], may_rest: &[usize]) -> Option<Vec<f64>> {
        let rests = |dof: usize| may_rest.contains(&self.parts().of_dof(dof));
        let at_rest = || u.iter().enumerate().map(|(dof, &u)| if rests(dof) { 0.0 } else { u }).collect();
        (!may_rest.is_empty()).then(at_rest)
    }

    pub(super) fn recomputed(&self, bounding: &Bounding, u: &[f64], lambda: &[f64]) -> Examined {
        let balance = self.accurate_balance(u, &[lambda]);
        let violation = self.accurate_violation(u);
        let (contact_terms, lengths) = (self.contact.mul_abs_transposed(lambda), self.contact.mul_abs(u));
        let forces: Vec<f64> = self.load.iter().zip(&contact_terms).map(|(f, contact)| f.abs() + contact).collect();
        let scales = Scales::of(self, [u, lambda], &balance, &forces);
        let Balance { residual, elastic, strain, terms } = balance;

        let balanced = self.balanced_forces(terms.iter().zip(&forces).map(|(terms, forces)| terms + forces).collect());
        let share = |dof: usize, force: f64| relative(force.abs(), balanced[dof]);
        // With the multiplier of each row.
        let mut shares_of_rows: Vec<(f64, f64)> = lambda.iter().map(|&lambda| (lambda, 0.0)).collect();
        for dof in 0..self.dofs() {
            self.contact.with_rows(dof, &mut shares_of_rows, |(lambda, most), b| {
                if *lambda != 0.0 {
                    *most = larger(share(dof, b * *lambda), *most);
                }
            });
        }
        let own_length = |row: usize| {
            let of_part = scales.of_parts[self.parts().of_row(row)].strain.max(0.0).sqrt() * scales.reach[row];
            let gap = if self.gap[row].is_finite() { self.gap[row].abs() } else { 0.0 };
            larger(lengths[row], larger(gap, of_part))
        };
        let lengths_of_rows = self.coupled_lengths((0..self.rows()).map(own_length).collect());
        let length = |row: usize| lengths_of_rows[row];
        let rows = || (0..self.rows()).filter(|&row| self.gap[row].is_finite() || lambda[row] != 0.0);
        // A row without obstacle carries no multiplier.
        let work = |row: usize| if lambda[row] == 0.0 { 0.0 } else { lambda[row] * violation[row] };
        let stationarity = worst((0..u.len()).map(|dof| share(dof, residual[dof])));
        // Rounding of u moves a row, and a part that rests is known only to the rounding of its forces.
        let is_rounding = |row: usize| {
            let rest = scales.rest_of_row(row, self.parts().of_row(row));
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
            imbalance: self.imbalance(&residual, |dof| balanced[dof]),
            loose_dofs: if let Bounding::Factor(norm) = bounding { norm.loose_dofs() } else { 0 },
            open_force: worst(rows().map(|row| shares_of_rows[row].1.min((-distance(row)).max(0.0)))),
            parts: self.parts().count(),
            bound_is_measured: matches!(bounding, Bounding::Cycles(..)),
            ..Certificate::unknown()
        };
        let rounding = scales.whole.rounding();
        let (two_sided, of_rows) = self.two_sided(lambda);
        let answer = Answer { displacement: u, multiplier: lambda, residual, violation, rounding };
        let by_sides = match &of_rows {
            Cow::Borrowed(_) => None,
            Cow::Owned(of_rows) => Some(Answer { rounding, ..two_sided.answer(u, of_rows) }),
        };
        let bounded = by_sides.as_ref().unwrap_or(&answer);
        let (bound, measured, loss) = match bounding {
            Bounding::Nothing | Bounding::OwnFactor | Bounding::Pieces(_) => (ErrorBound::none(), None, 1.0),
            Bounding::Factor(norm) => (two_sided.energy_error_bound(norm, bounded), None, norm.loss()),
            Bounding::Cycles(multigrid, watch) => {
                let found = two_sided.energy_error_bound_by(multigrid, bounded, watch);
                let (bound, measured) = found.unwrap_or((ErrorBound::none(), None));
                (bound, measured, measured.map_or(1.0, |measured| 1.0 / measured.ritz.min(1.0)))
            }
        };
        let part = certificate.set_bounds(&bound, &scales, loss);
        certificate.cancellation = self.cancellation(&forces, &elastic, part);
        let Answer { residual, violation, .. } = answer;
        let has_bound = !matches!(bounding, Bounding::Nothing);
        let (may_rest, reach, error) = (scales.may_rest(&bound), scales.reach, bound.whole);
        let evidence = has_bound.then_some(Evidence { residual, violation, reach, error, measured, norm: None });
        Examined { certificate, evidence, may_rest }
    }

    /// The largest imbalance of forces above rounding, relative to the largest of the forces that balance on the part;
    /// on a dof without stiffness, to those on the dof.
    fn imbalance(&self, residual: &[f64], terms: impl Fn(usize) -> f64) -> f64 {
        let (parts, roots) = (self.parts(), &self.diagonal().roots);
        let (mut left, mut largest, mut without_stiffness) = (vec![0.0; parts.count()], vec![0.0; parts.count()], 0.0);
        for (dof, &root) in roots.iter().enumerate() {
            let (part, terms) = (parts.of_dof(dof), terms(dof));
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
    fn cancellation(&self, forces: &[f64], elastic: &[f64], part: Option<usize>) -> Cancellation {
        let is_in = |dof: &usize| part.is_none_or(|part| self.parts().of_dof(*dof) == part);
        let all =
            (0..forces.len()).filter(is_in).map(|dof| Cancellation { dof, forces: forces[dof], left: elastic[dof] });
        let fewer = |a: Cancellation, b: Cancellation| if b.forces * a.left > a.forces * b.left { b } else { a };
        all.filter(|at| at.forces > 0.0).reduce(fewer).unwrap_or(Cancellation { dof: 0, forces: 0.0, left: 0.0 })
    }

    /// Checks that the vectors of an answer have the lengths of the problem.
    pub(crate) fn check_answer(&self, displacement: &[f64], multiplier: &[f64]) -> Result<(), Error> {
        let length = |name, found: usize, expected, of| {
            if found == expected { Ok(()) } else { Err(LinearError::Length { name, found, expected, of }.into()) }
        };
        length("displacement", displacement.len(), self.dofs(), "dofs")?;
        let (found, of) =
            (multiplier.len(), if self.equality_rows() == 0 { "contact rows" } else { "contact and equality rows" });
        if found == self.rows() {
            Ok(())
        } else {
            length("multiplier", found, self.inequalities() + self.equality_rows(), of)
        }
    }

    /// `f + B' lambda - K u` of the given doubles, with twice the working precision.
    pub(crate) fn accurate_residual(&self, u: &[f64], lambda: &[f64]) -> Vec<f64> {
        self.accurate_residual_of(u, &[lambda])
    }

    /// The same for multipliers that are given as sums, which are not rounded.
    pub(crate) fn accurate_residual_of(&self, u: &[f64], multipliers: &[&[f64]]) -> Vec<f64> {
        self.accurate_balance(u, multipliers).residual
    }

    /// The same, with its terms.
    fn accurate_balance(&self, u: &[f64], multipliers: &[&[f64]]) -> Balance {
        // Summed with opposite sign, K u first: if a body moves far and bends little, its energy is so small that
        // forces rounded first would leave nothing of that energy.
        let mut sums = Accumulator::new(&vec![0.0; self.dofs()]);
        let terms = sums.add_matrix_product(|column| self.stiffness.lower().column(column), u);
        let strain = sums.products_by(u, |_| 0, 1)[0];
        let elastic = sums.sums().map(f64::abs).collect();
        self.load.iter().enumerate().for_each(|(dof, &load)| sums.add_product(dof, load, -1.0));
        for lambda in multipliers {
            let against: Vec<f64> = lambda.iter().map(|lambda| -lambda).collect();
            sums.add_transposed(|dof| self.contact.column(dof), &against);
        }
        Balance { residual: sums.sums().map(|sum| -sum).collect(), elastic, strain, terms }
    }

    /// `B u - g` of the given doubles, with twice the working precision; `-inf` for a row without obstacle.
    pub(crate) fn accurate_violation(&self, u: &[f64]) -> Vec<f64> {
        Distances::of(self).moved(u)
    }

    /// The forces `K u` of the given doubles, with twice the working precision.
    pub(super) fn accurate_forces(&self, u: &[f64]) -> Accumulator {
        let mut sums = Accumulator::new(&vec![0.0; u.len()]);
        sums.add_matrix_product(|column| self.stiffness.lower().column(column), u);
        sums
    }
}

/// The distances `B u - g` of a displacement that is a sum, which is not rounded.
pub(super) struct Distances<'a> {
    problem: &'a ContactProblem,
    sums: Accumulator,
}

impl<'a> Distances<'a> {
    /// Those of no displacement.
    pub fn of(problem: &'a ContactProblem) -> Self {
        let start: Vec<f64> = problem.gap.iter().map(|&gap| if gap.is_finite() { -gap } else { 0.0 }).collect();
        Distances { problem, sums: Accumulator::new(&start) }
    }

    /// Adds a displacement. Returns the distances, with twice the working precision; `-inf` for a row without obstacle.
    pub fn moved(&mut self, by: &[f64]) -> Vec<f64> {
        self.sums.add_columns(|dof| self.problem.contact.column(dof), by);
        let with_obstacle = |(sum, gap): (f64, &f64)| if gap.is_finite() { sum } else { f64::NEG_INFINITY };
        self.sums.sums().zip(&self.problem.gap).map(with_obstacle).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;
    use crate::solve;

    /// The relative excess of the bound of an answer over its error, from the factor for rounding.
    const ROUNDED: f64 = 1e-5;

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
        (pieces[0].energy_error, pieces[1].energy_error) = (3e-3, 4e-3);
        (pieces[0].part_error_bound, pieces[1].part_error_bound) = (0.25, 7.0);
        (pieces[0].energy_error_excess, pieces[1].energy_error_excess) = (5.0, 0.5);
        pieces[0].cancellation.dof = 1;
        let whole = problem.examine(&Bounding::Pieces(&pieces), &u, &lambda).unwrap().certificate;
        // The energy norm is sqrt(4 1^2 + 16 2^2).
        let bound = 5e-3 / 68_f64.sqrt();
        assert!((whole.energy_error_bound / bound - 1.0).abs() < ROUNDED, "{whole:?}");
        assert_eq!((whole.part_error_bound, whole.energy_error_excess, whole.bound_is_measured), (7.0, 5.0, false));
        assert_eq!((whole.met_tolerance, whole.cancellation.dof), (7.0, 1));
        pieces[1].bound_is_measured = true;
        (pieces[0].part_error_bound, pieces[1].part_error_bound) = (0.0, 0.0);
        let whole = problem.examine(&Bounding::Pieces(&pieces), &u, &lambda).unwrap().certificate;
        assert!(whole.bound_is_measured && whole.part_error_bound == whole.energy_error_bound, "{whole:?}");
        // The error of a part at rest counts in the whole.
        pieces[0].parts_at_rest = 1;
        (pieces[1].part_error_bound, pieces[0].energy_error_excess) = (1e-11, 0.0);
        let whole = problem.examine(&Bounding::Pieces(&pieces), &u, &lambda).unwrap().certificate;
        assert_eq!((whole.part_error_bound, whole.parts_at_rest), (whole.energy_error_bound, 1), "{whole:?}");
        pieces[1].energy_error_excess = 0.0;
        let whole = problem.examine(&Bounding::Pieces(&pieces), &u, &lambda).unwrap().certificate;
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
        // A force on the loose dof that no row takes has no bound, and neither has one that rows take with another
        // force.
        assert!(!problem.certify(&[1.0, 0.0], &[-4.0, -1e-30, 0.0]).unwrap().has_bound());
        // Without clearance the walls are an equality, which holds the dof by any force.
        let held = problem.with_gap(vec![1.0, 0.0, 0.0]).unwrap();
        assert!(held.certify(&[1.0, 0.0], &[-4.0, -1e-30, 0.0]).unwrap().has_bound());
    }
}
