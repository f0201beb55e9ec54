//! The certificate: every condition of the solution recomputed from the original problem.

use super::EnergyNorm;
use super::bound::{Answer, ErrorBound, Measured};
use super::scales::{Forces, Scales, larger, relative};
use crate::error::Error;
use crate::qp::linear::Accumulator;
use crate::qp::linear::multigrid::Multigrid;
use crate::qp::problem::ContactProblem;
use crate::solution::{Certificate, Solution};
use crate::watch::Watch;

/// Rounding moves an entry of u or lambda by half a unit in the last place. The sum of such errors is excused twice: once for
/// the rounding and once for the arithmetic that made the entry.
const ENTRY_ROUNDING: f64 = f64::EPSILON;

/// Relative error of sums with twice the working precision stays below this share of their terms: no bound is smaller.
const LEAST: f64 = 1e-28;

/// Rounding of an energy computed with twice the working precision, as a share of its terms.
const OF_ENERGY: f64 = 1e-31;

/// The means by which the error is bounded in energy.
#[derive(Clone, Copy)]
enum Bounding<'a> {
    Nothing,
    Factor(&'a EnergyNorm),
    Cycles(&'a Multigrid, &'a Watch),
}

impl<'a> Bounding<'a> {
    fn by(norm: Option<&'a EnergyNorm>) -> Self {
        norm.map_or(Bounding::Nothing, Bounding::Factor)
    }
}

/// A certificate and the evidence that it was computed from; an answer in far units has no evidence.
pub(crate) struct Examined {
    pub certificate: Certificate,
    pub evidence: Option<Evidence>,
}

impl Examined {
    /// A certificate alone.
    pub fn without_evidence(certificate: Certificate) -> Self {
        Examined { certificate, evidence: None }
    }
}

/// Evidence that a certificate has found for an answer, used to prove its contact set.
pub(crate) struct Evidence {
    /// `f + B' lambda - K u`.
    pub(super) residual: Vec<f64>,
    /// `B u - g`.
    pub(super) violation: Vec<f64>,
    /// An upper bound on `|u - u*|_K`; infinite if none is known.
    pub(super) error: f64,
    /// Numbers that cycles have measured, if the bound comes from cycles.
    pub(super) measured: Option<Measured>,
}

/// The forces on each dof, with twice the working precision.
struct Balance {
    /// `f + B' lambda - K u`.
    residual: Vec<f64>,
    /// `u' K u`.
    strain: f64,
    /// `|K| |u|`, the scale of rounding in it.
    terms: Vec<f64>,
}

fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |worst, value| larger(value.abs(), worst))
}

impl ContactProblem {
    /// The certificate of an answer: displacement u (length n, in m) and multiplier lambda (length m, in N, `<= 0` in
    /// compression), with the energy bound if K is positive definite or the rows that press hold the body.
    ///
    /// # Errors
    /// [`Error::Length`] for vectors that do not fit, [`Error::Numerical`] if the factorisation of K fails for lack of memory.
    pub fn certify(&self, displacement: &[f64], multiplier: &[f64]) -> Result<Certificate, Error> {
        self.check_answer(displacement, multiplier)?;
        if let Some(units) = self.far_units(displacement) {
            return self.in_units(&units)?.certify(&units.displacement(displacement), &units.force(multiplier));
        }
        let norm = self.energy_norm(displacement, multiplier)?;
        self.certify_in(norm.as_ref(), displacement, multiplier)
    }

    /// As [`ContactProblem::certify`], in an energy norm that is already available.
    ///
    /// # Errors
    /// [`Error::Length`] for vectors that do not fit.
    pub(crate) fn certify_in(
        &self,
        norm: Option<&EnergyNorm>,
        displacement: &[f64],
        multiplier: &[f64],
    ) -> Result<Certificate, Error> {
        Ok(self.examine_in(norm, displacement, multiplier)?.certificate)
    }

    /// As `certify_in`, with the evidence.
    ///
    /// # Errors
    /// [`Error::Length`] for vectors that do not fit.
    pub(crate) fn examine_in(
        &self,
        norm: Option<&EnergyNorm>,
        displacement: &[f64],
        multiplier: &[f64],
    ) -> Result<Examined, Error> {
        self.check_answer(displacement, multiplier)?;
        let Some(units) = self.far_units(displacement) else {
            return Ok(self.recomputed(Bounding::by(norm), displacement, multiplier));
        };
        let (norm, problem) = (norm.map(|norm| units.norm(norm)), self.in_units(&units)?);
        let bounding = Bounding::by(norm.as_ref());
        let in_units = problem.recomputed(bounding, &units.displacement(displacement), &units.force(multiplier));
        Ok(Examined::without_evidence(in_units.certificate))
    }

    /// As [`ContactProblem::certify`], with the energy bound by the cycles of the hierarchy of K, which needs no factor and
    /// rests on a measured eigenvalue. There is no bound if K is singular to the precision of its levels, or if `watch` is over
    /// before it is found. A hierarchy of one level is already a factor, with so few dofs that another one in double precision
    /// costs nothing.
    ///
    /// # Errors
    /// As [`ContactProblem::certify`].
    pub(crate) fn examine_by_cycles(
        &self,
        multigrid: &Multigrid,
        watch: &Watch,
        displacement: &[f64],
        multiplier: &[f64],
    ) -> Result<Examined, Error> {
        self.check_answer(displacement, multiplier)?;
        if multigrid.unknowns().len() <= 1 {
            return self.certify(displacement, multiplier).map(Examined::without_evidence);
        }
        if self.far_units(displacement).is_some() {
            return self.examine_in(None, displacement, multiplier);
        }
        Ok(self.recomputed(Bounding::Cycles(multigrid, watch), displacement, multiplier))
    }

    /// The certificate of an answer that was put together from answers of pieces without coupling. The conditions are
    /// recomputed; the bounds are those of the pieces, with an upper bound on `|u - u*|_K` of each in `errors`.
    ///
    /// # Errors
    /// [`Error::Length`] for vectors that do not fit.
    pub(crate) fn certify_pieces(
        &self,
        pieces: &[Certificate],
        errors: &[f64],
        displacement: &[f64],
        multiplier: &[f64],
    ) -> Result<Certificate, Error> {
        let certificate = self.certify_in(None, displacement, multiplier)?;
        let largest = |of: fn(&Certificate) -> f64| worst(pieces.iter().map(of));
        let whole = errors.iter().map(|error| error * error).sum::<f64>().sqrt();
        let energy_error_bound = relative(whole, self.size_of(displacement, multiplier));
        Ok(Certificate {
            energy_error_bound,
            part_error_bound: larger(energy_error_bound, largest(|piece| piece.part_error_bound)),
            energy_error_excess: largest(|piece| piece.energy_error_excess),
            bound_is_measured: pieces.iter().any(|piece| piece.bound_is_measured),
            ..certificate
        })
    }

    /// The upper bound on `|u - u*|_K` of an answer with its certificate.
    pub(crate) fn error_of(&self, answer: &Solution) -> f64 {
        let bound = answer.certificate.energy_error_bound;
        if bound == 0.0 { 0.0 } else { bound * self.size_of(&answer.displacement, &answer.multiplier) }
    }

    /// The energy norm that the bound of an answer is relative to.
    fn size_of(&self, displacement: &[f64], multiplier: &[f64]) -> f64 {
        let Balance { strain, terms, .. } = self.accurate_balance(displacement, &[multiplier]);
        let contact = self.contact.mul_transposed(multiplier);
        let scales = Scales::of(self, self.parts(), &Forces { displacement, multiplier, contact: &contact, strain });
        let sum = displacement.iter().zip(&terms).map(|(u, terms)| u.abs() * terms).sum();
        sure_size(&scales, strain, sum)
    }

    fn recomputed(&self, bounding: Bounding, u: &[f64], lambda: &[f64]) -> Examined {
        let parts = self.parts();
        let contact = self.contact.mul_transposed(lambda);
        let Balance { residual, strain, terms } = self.accurate_balance(u, &[lambda]);
        let violation = self.accurate_violation(u);
        let (contact_terms, lengths) = (self.contact.mul_abs_transposed(lambda), self.contact.mul_abs(u));
        let scales =
            Scales::of(self, parts, &Forces { displacement: u, multiplier: lambda, contact: &contact, strain });

        let is_rounding = |dof: usize| residual[dof].abs() <= ENTRY_ROUNDING * (terms[dof] + contact_terms[dof]);
        let excess = |dof: usize| if is_rounding(dof) { 0.0 } else { residual[dof] };
        let own = |dof: usize| larger(self.load[dof].abs(), contact[dof].abs());
        // A row without obstacle carries no multiplier; a violation within the rounding of u does no work.
        let work = |row: usize| {
            if lambda[row] == 0.0 || violation[row].abs() <= ENTRY_ROUNDING * lengths[row] {
                0.0
            } else {
                lambda[row] * violation[row]
            }
        };
        let penetration = |row: usize| {
            let scale = larger(
                lengths[row],
                larger(self.gap[row].abs(), scales.size(scales.part_of_row(row)) * scales.reach[row]),
            );
            relative(violation[row].max(0.0), scale)
        };
        let adhesion = |row: usize| {
            let force = lambda[row].max(0.0) * scales.reach[row];
            relative(force, scales.force[scales.part_of_row(row)])
        };
        let mut gaps = parts.sums(|dof| -u[dof] * excess(dof));
        (0..self.rows()).for_each(|row| gaps[scales.part_of_row(row)] += work(row));
        let rows = || (0..self.rows()).filter(|&row| self.gap[row].is_finite() || lambda[row] != 0.0);
        let mut certificate = Certificate {
            stationarity: scales.largest_force(parts, |dof| residual[dof], own),
            stationarity_excess: scales.largest_force(parts, excess, own),
            penetration: worst(rows().map(penetration)),
            adhesion: worst(rows().map(adhesion)),
            complementarity: worst(rows().map(|row| relative(work(row), scales.energy[scales.part_of_row(row)]))),
            duality_gap: worst(gaps.iter().zip(&scales.energy).map(|(&gap, &energy)| relative(gap, energy))),
            energy_error_bound: f64::INFINITY,
            part_error_bound: f64::INFINITY,
            energy_error_excess: f64::INFINITY,
            parts: parts.count(),
            bound_is_measured: matches!(bounding, Bounding::Cycles(..)),
        };
        let answer = Answer { displacement: u, multiplier: lambda, residual, violation: &violation };
        let (bound, measured) = match bounding {
            Bounding::Nothing => return Examined::without_evidence(certificate),
            Bounding::Factor(norm) => (self.energy_error_bound(norm, &answer), None),
            Bounding::Cycles(multigrid, watch) => self.energy_error_bound_by(multigrid, &answer, watch),
        };
        let rounding = parts.sums(|dof| u[dof].abs() * terms[dof]);
        certificate.judge(&bound, &scales, strain, &rounding);
        let Answer { residual, .. } = answer;
        Examined { certificate, evidence: Some(Evidence { residual, violation, error: bound.whole, measured }) }
    }

    /// Checks that the vectors of an answer have the lengths of the problem.
    pub(super) fn check_answer(&self, displacement: &[f64], multiplier: &[f64]) -> Result<(), Error> {
        let length = |name, found: usize, expected, of| {
            if found == expected { Ok(()) } else { Err(Error::Length { name, found, expected, of }) }
        };
        length("displacement", displacement.len(), self.dofs(), "dofs")?;
        length("multiplier", multiplier.len(), self.rows(), "contact rows")
    }

    /// `f + B' lambda - K u` of the given doubles, with twice the working precision.
    pub(crate) fn accurate_residual(&self, u: &[f64], lambda: &[f64]) -> Vec<f64> {
        self.accurate_residual_of(u, &[lambda])
    }

    /// The same for multipliers that are given as sums, which are not rounded.
    pub(super) fn accurate_residual_of(&self, u: &[f64], multipliers: &[&[f64]]) -> Vec<f64> {
        self.accurate_balance(u, multipliers).residual
    }

    /// The same, with its terms.
    fn accurate_balance(&self, u: &[f64], multipliers: &[&[f64]]) -> Balance {
        // Summed with opposite sign, K u first: if a body moves far and bends little, its energy is so small that forces
        // rounded first would leave nothing of that energy.
        let mut sums = Accumulator::new(&vec![0.0; self.dofs()]);
        let terms = sums.add_matrix_product(|column| self.stiffness.lower().column(column), u);
        let strain = sums.products_by(u, |_| 0, 1)[0];
        for (dof, &load) in self.load.iter().enumerate() {
            sums.add_product(dof, load, -1.0);
            for lambda in multipliers {
                self.contact.column(dof).for_each(|(row, b)| sums.add_product(dof, b, -lambda[row]));
            }
        }
        Balance { residual: sums.sums().map(|sum| -sum).collect(), strain, terms }
    }

    /// `B u - g` of the given doubles, with twice the working precision; `-inf` for a row without obstacle.
    pub(crate) fn accurate_violation(&self, u: &[f64]) -> Vec<f64> {
        let start: Vec<f64> = self.gap.iter().map(|&gap| if gap.is_finite() { -gap } else { 0.0 }).collect();
        let mut sums = Accumulator::new(&start);
        for (column, &at_column) in u.iter().enumerate() {
            self.contact.column(column).for_each(|(row, b)| sums.add_product(row, b, at_column));
        }
        let sums = sums.into_sums();
        sums.iter().zip(&self.gap).map(|(&sum, &gap)| if gap.is_finite() { sum } else { f64::NEG_INFINITY }).collect()
    }

    /// The product with u of the entries `(row, value)` of the lower triangle that `within(column)` gives, and of their
    /// mirror images, with twice the working precision.
    pub(super) fn accurate_product<I: Iterator<Item = (usize, f64)>>(
        &self,
        within: impl Fn(usize) -> I,
        u: &[f64],
    ) -> Vec<f64> {
        self.unrounded_product(within, u).into_sums()
    }

    /// The same, not yet rounded.
    pub(super) fn unrounded_product<I: Iterator<Item = (usize, f64)>>(
        &self,
        within: impl Fn(usize) -> I,
        u: &[f64],
    ) -> Accumulator {
        let mut sums = Accumulator::new(&vec![0.0; u.len()]);
        sums.add_matrix_product(within, u);
        sums
    }
}

/// The part of the energy norm that is certain: a body that moves far and does not bend has only energy from rounding of `sum`,
/// the sum of `|u_i| (|K| |u|)_i`.
fn sure_size(scales: &Scales, strain: f64, sum: f64) -> f64 {
    scales.size_of_whole((strain - OF_ENERGY * sum).max(0.0))
}

impl Certificate {
    /// Takes in a bound on the error: of the whole and of each part, relative to its own energy norm. An error within the
    /// rounding, with `rounding` the sum of `|u_i| (|K| |u|)_i` of each part, is no excess.
    fn judge(&mut self, bound: &ErrorBound, scales: &Scales, strain: f64, rounding: &[f64]) {
        let explained = |sum: f64| ENTRY_ROUNDING * sum.sqrt();
        let unexplained =
            |error: f64, size: f64, sum: f64| if error <= explained(sum) { 0.0 } else { relative(error, size) };
        let sum = rounding.iter().sum::<f64>();
        let whole = sure_size(scales, strain, sum);
        let of_whole = bound.whole + LEAST * sum.sqrt();
        self.energy_error_bound = relative(of_whole, whole);
        (self.part_error_bound, self.energy_error_excess) =
            (self.energy_error_bound, unexplained(of_whole, whole, sum));
        if let Some(of_parts) = &bound.of_parts {
            for (part, &error) in of_parts.iter().enumerate().filter(|entry| scales.is_stiff[entry.0]) {
                let (size, error) = (scales.size(part), error + LEAST * rounding[part].sqrt());
                self.part_error_bound = larger(relative(error, size), self.part_error_bound);
                self.energy_error_excess = larger(unexplained(error, size, rounding[part]), self.energy_error_excess);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::qp::linear::{SparseMatrix, SymmetricMatrix};
    use crate::qp::settings::Settings;
    use crate::qp::solve;

    /// The relative excess of the bound of an answer over its error, from the factor for rounding.
    const ROUNDED: f64 = 1e-5;

    /// Two dofs of stiffness 4 and 16, each a part, under loads of 8 and 48, before walls at 1 and 2.
    fn parts() -> ContactProblem {
        let matrix = |entries: &[(usize, usize, f64)]| SparseMatrix::from_triplets(2, 2, entries).unwrap();
        let stiffness = SymmetricMatrix::from_lower(matrix(&[(0, 0, 4.0), (1, 1, 16.0)])).unwrap();
        ContactProblem::new(stiffness, vec![8.0, 48.0], matrix(&[(0, 0, 1.0), (1, 1, 1.0)]), vec![1.0, 2.0]).unwrap()
    }

    #[test]
    fn the_error_of_an_answer_is_its_bound_in_the_unit_of_energy() {
        let problem = parts();
        let mut answer = solve(&problem, &Settings::default()).unwrap();
        assert_eq!((&answer.displacement[..], &answer.multiplier[..]), (&[1.0, 2.0][..], &[-4.0, -16.0][..]));
        assert!(problem.error_of(&answer) < ROUNDED);
        // The first dof is off by 3e-3, of stiffness 4; the second by 2e-3, of stiffness 16.
        answer.displacement = vec![1.003, 2.002];
        answer.certificate = problem.certify(&answer.displacement, &answer.multiplier).unwrap();
        assert!((problem.error_of(&answer) / 1e-2 - 1.0).abs() < ROUNDED, "{:e}", problem.error_of(&answer));
        answer.certificate.energy_error_bound = 0.0;
        assert_eq!(problem.error_of(&answer), 0.0);
    }

    #[test]
    fn errors_of_pieces_add_up_as_squares_and_the_worst_part_stays_the_worst() {
        let problem = parts();
        let (u, lambda) = ([1.0, 2.0], [-4.0, -16.0]);
        let mut pieces = [0; 2].map(|_| problem.certify(&u, &lambda).unwrap());
        (pieces[0].part_error_bound, pieces[1].part_error_bound) = (0.25, 7.0);
        (pieces[0].energy_error_excess, pieces[1].energy_error_excess) = (5.0, 0.5);
        let whole = problem.certify_pieces(&pieces, &[3e-3, 4e-3], &u, &lambda).unwrap();
        // The energy norm is sqrt(4 1^2 + 16 2^2).
        let bound = 5e-3 / 68_f64.sqrt();
        assert!((whole.energy_error_bound / bound - 1.0).abs() < ROUNDED, "{whole:?}");
        assert_eq!((whole.part_error_bound, whole.energy_error_excess, whole.bound_is_measured), (7.0, 5.0, false));
        pieces[1].bound_is_measured = true;
        (pieces[0].part_error_bound, pieces[1].part_error_bound) = (0.0, 0.0);
        let whole = problem.certify_pieces(&pieces, &[3e-3, 4e-3], &u, &lambda).unwrap();
        assert!(whole.bound_is_measured && whole.part_error_bound == whole.energy_error_bound, "{whole:?}");
    }
}
