//! The rows of a contact set that are proven open or closed, from the bound on the energy norm of the error.
//!
//! With `|u - u*|_K <= E` and the compliance `G = B K^-1 B'` of the rows:
//!
//! * `|B_i (u - u*)| <= sqrt(G_ii) E`: a row with a larger distance is open in the exact answer too.
//! * Let C be all other rows, `r = f + B_C' lambda_C - K u`, and w a shift with `B_i w = 1` that moves no other row of
//!   C. From `B_C' (lambda - lambda*)_C = r + K (u - u*)`: `|lambda_i - lambda*_i| <= |w|_K (|r|_{K^-1} + E)`. A row
//!   with a larger force is closed in the exact answer too. The cheapest such shift has `|w|_K^2 = (G_CC^-1)_ii`.
//!
//! If only springs D on equalities make K definite, both hold in the norm of `K_D = K + B' D B`: an answer that misses
//! the equalities by d has there an error of at most `sqrt(E^2 + d'D d)`.

use super::EnergyNorm;
use super::bound::Answer;
use super::conditions::{Bounding, Evidence};
use super::energy_norm::{Boundary, ROUNDED_BOUND, RowsOnBoundary};
use super::units::ldexp_root;
use crate::error::Error;
use crate::linear::multigrid::Multigrid;
use crate::linear::watch::Watch;
use crate::linear::{
    Dependence, SparseMatrix, dot, forward_all, inverse_lengths, inverse_lengths_by_products, ldexp, products,
};
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, ProvenSet};

/// Accuracy of the solve for an M-matrix without a factor; its error widens the bounds.
const ROUGH: f64 = 1e-2;

/// Largest number of cycles of that solve.
const MOST_CYCLES: usize = 20;

/// Multiplications that the compliance of the rows in question may cost; beyond this, one dof of each row is moved
/// alone.
const MOST_WORK: f64 = 2e9;

/// Number of rows that a sweep of the proof takes at once.
const AT_ONCE: usize = 128;

/// An answer whose rows are to be proven.
pub(crate) struct WithEvidence<'a> {
    pub displacement: &'a [f64],
    pub multiplier: &'a [f64],
    /// What its certificate has found, if that is known.
    pub evidence: Option<Evidence>,
}

impl Evidence {
    /// The same with the rounding of its bound; `None` if no bound is known.
    fn bounded(self) -> Option<Self> {
        let error = ROUNDED_BOUND * self.error;
        error.is_finite().then_some(Evidence { error, ..self })
    }
}

impl ContactProblem {
    /// The rows for which an answer (u of length n, in m; lambda of length m, in N, `<= 0` in compression) proves, by
    /// its distance and force, that they are open or closed in the exact answer; `None` if K is not positive definite
    /// by itself, except for travels that forces drive against rows, and if no bound is known.
    ///
    /// # Errors
    /// As [`ContactProblem::certify`].
    pub fn prove(&self, displacement: &[f64], multiplier: &[f64]) -> Result<Option<ProvenSet>, Error> {
        let multiplier = &*self.of_all_rows(multiplier);
        self.check_answer(displacement, multiplier)?;
        self.prove_alone(WithEvidence { displacement, multiplier, evidence: None })
    }

    /// The same for vectors that fit, with the factor of the certificate that gave the evidence, or with one of its
    /// own.
    pub(crate) fn prove_alone(&self, mut answer: WithEvidence) -> Result<Option<ProvenSet>, Error> {
        let norm = match answer.evidence.as_mut().and_then(|evidence| evidence.norm.take()) {
            Some(norm) => Some(norm),
            None if self.without_stiffness().is_empty() => EnergyNorm::of(&self.stiffness, &self.contact)?,
            None => return self.prove_pressed(answer),
        };
        Ok(norm.and_then(|norm| self.prove_by(&Bounding::Factor(norm), answer)))
    }

    /// As [`ContactProblem::prove`], by the means of a certificate, for vectors that fit; from the evidence of that
    /// certificate if there is any.
    pub(crate) fn prove_by(&self, by: &Bounding, answer: WithEvidence) -> Option<ProvenSet> {
        let proven = match by {
            Bounding::Factor(norm) => self.prove_in(norm, answer),
            Bounding::Cycles(multigrid, watch) => self.prove_by_cycles(multigrid, watch, answer),
            Bounding::OwnFactor if !self.without_stiffness().is_empty() => self.prove_pressed(answer).ok().flatten(),
            Bounding::Nothing | Bounding::OwnFactor | Bounding::Pieces(_) => None,
        };
        proven.map(|proven| self.with_equalities_closed(proven))
    }

    /// The same with the rows of equalities, which are closed in every answer.
    pub(super) fn with_equalities_closed(&self, mut proven: ProvenSet) -> ProvenSet {
        self.equalities().iter().flat_map(|pair| [pair.row, pair.opposed]).for_each(|row| proven.closed.insert(row));
        proven
    }

    /// As [`ContactProblem::prove`], in an energy norm that is already available.
    pub(super) fn prove_in(&self, norm: &EnergyNorm, answer: WithEvidence) -> Option<ProvenSet> {
        let WithEvidence { displacement, multiplier, evidence } = answer;
        if let Some(units) = self.far_units(displacement) {
            let (problem, norm) = (self.in_units(&units).ok()?, norm.with_unit(units.stiffness));
            let [displacement, multiplier] = [&units.displacement(displacement), &units.force(multiplier)];
            return problem.prove_in(&norm, WithEvidence { displacement, multiplier, evidence: None });
        }
        if norm.loose_dofs() > 0 {
            return None;
        }
        let found = || self.recomputed(&Bounding::Factor(norm.clone()), displacement, multiplier).evidence;
        let Evidence { residual, violation, reach: least, error, .. } = evidence.or_else(found)?.bounded()?;
        let error = error.hypot(norm.length_of_springs(&violation));
        let answer = Answer { displacement, multiplier, residual, violation, rounding: 0.0 };
        let compliance = ComplianceFactor::of(self, norm);
        // One solve saves sweeps.
        let at_once = || compliance.reach_at_once().or_else(|| self.monotone_reach(|s| Some(norm.displacement(s))));
        let reach = if norm.is_over() { None } else { at_once() }.unwrap_or_else(|| self.any_reach());
        let distances = self.distances(&answer);
        let mut open = self.open_by(&distances, error, &reach);
        let limits = distances.iter().map(|distance| distance / error).enumerate();
        let is_doubtful = |&(row, limit): &(usize, f64)| limit > least[row] && !open.contains(row);
        let doubtful: Vec<(usize, f64)> = limits.filter(is_doubtful).collect();
        self.within_reach(norm, &compliance, &doubtful).into_iter().for_each(|row| open.insert(row));
        let of_force = ROUNDED_BOUND * norm.of_force(&self.unbalanced(&answer, &open).force);
        let imbalance = of_force + error;
        let mut closed = self.closed_alone(&answer, &open, imbalance);
        let in_question: Vec<usize> = (0..self.rows()).filter(|&row| !open.contains(row)).collect();
        let is_doubtful = |row: &usize| multiplier[*row] < 0.0 && !closed.contains(*row);
        if in_question.iter().any(is_doubtful) && compliance.work(in_question.len()) <= MOST_WORK {
            for (&row, length) in in_question.iter().zip(compliance.moved_together(&self.contact, &in_question)) {
                if -multiplier[row] > length * imbalance {
                    closed.insert(row);
                }
            }
        }
        Some(ProvenSet { open, closed })
    }

    /// As [`ContactProblem::prove`], without a factor: with the bound by the cycles of the hierarchy of K, and one
    /// solve by cycles for an M-matrix. `None` if the cycles find no bound, or if K is singular.
    fn prove_by_cycles(&self, multigrid: &Multigrid, watch: &Watch, answer: WithEvidence) -> Option<ProvenSet> {
        let WithEvidence { displacement, multiplier, evidence } = answer;
        // A hierarchy of one level is already a factor.
        if multigrid.unknowns().len() <= 1 {
            return self.prove(displacement, multiplier).ok()?;
        }
        // Without a bound on the move of a travel, nothing is known of its rows.
        if multigrid.is_shifted() || !self.without_stiffness().is_empty() {
            return None;
        }
        let Evidence { residual, violation, error, measured, .. } = evidence?.bounded()?;
        let answer = Answer { displacement, multiplier, residual, violation, rounding: 0.0 };
        let stiffness = multigrid.preconditioning(&self.stiffness);
        let reach = self.monotone_reach(|s| stiffness.solve(s, ROUGH, MOST_CYCLES).ok().map(|found| found.solution));
        let by_eigenvalues = || {
            let least = measured?.ritz;
            Some(self.measured_reach(least, self.largest_eigenvalue(multigrid, displacement, watch)?))
        };
        let reach = reach.or_else(by_eigenvalues).unwrap_or_else(|| self.any_reach());
        let open = self.open_by(&self.distances(&answer), error, &reach);
        let Unbalanced { force, is_residual } = self.unbalanced(&answer, &open);
        let of_force = match measured {
            Some(measured) if is_residual => Some(measured.of_residual),
            _ => stiffness.dual_norm(&force, watch).map(|norm| ROUNDED_BOUND * norm.most),
        };
        let closed = self.closed_alone(&answer, &open, of_force.map_or(f64::INFINITY, |force| force + error));
        Some(ProvenSet { open, closed })
    }

    /// Bounds on the reach of the rows if nothing is known about it: infinite.
    fn any_reach(&self) -> Vec<f64> {
        vec![f64::INFINITY; self.rows()]
    }

    /// The distance `g - B u` of each row, less its possible error from rounding of u; infinite without obstacle.
    fn distances(&self, answer: &Answer) -> Vec<f64> {
        let distances = answer.violation.iter().zip(self.negligible(answer.displacement));
        distances.map(|(violation, negligible)| -violation - negligible).collect()
    }

    /// The rows at these `distances` that are open beyond an error of `error` in the energy norm; `reach` bounds the
    /// move of each row by it.
    fn open_by(&self, distances: &[f64], error: f64, reach: &[f64]) -> ContactSet {
        ContactSet::from_fn(self.rows(), |row| {
            let distance = distances[row];
            distance > 0.0 && (distance.is_infinite() || error == 0.0 || distance > reach[row] * error)
        })
    }

    /// The force that is out of balance without the multipliers of the `open` rows.
    fn unbalanced(&self, answer: &Answer, open: &ContactSet) -> Unbalanced {
        let dropped: Vec<f64> =
            (0..self.rows()).map(|row| if open.contains(row) { -answer.multiplier[row] } else { 0.0 }).collect();
        let (mut force, is_residual) = (answer.residual.clone(), dropped.iter().all(|&force| force == 0.0));
        if !is_residual {
            force.iter_mut().zip(self.contact.mul_transposed(&dropped)).for_each(|(r, part)| *r += part);
        }
        Unbalanced { force, is_residual }
    }

    /// The rows that are closed, proven by one dof each: the shift of that dof moves no other row that is not `open`.
    fn closed_alone(&self, answer: &Answer, open: &ContactSet, imbalance: f64) -> ContactSet {
        // `|w|_K` of that shift.
        let mut lengths = vec![f64::INFINITY; self.rows()];
        for (dof, &stiffness) in self.diagonal().values.iter().enumerate() {
            let mut felt = self.contact.column(dof).filter(|&(row, b)| b != 0.0 && !open.contains(row));
            if let (Some((row, b)), None) = (felt.next(), felt.next()) {
                lengths[row] = lengths[row].min(stiffness.sqrt() / b.abs());
            }
        }
        ContactSet::from_fn(self.rows(), |row| -answer.multiplier[row] > lengths[row] * imbalance)
    }
}

/// The force that is left over at each dof.
struct Unbalanced {
    force: Vec<f64>,
    is_residual: bool,
}

/// The columns of `L^-1 B'`; their products are the compliance of the rows.
pub(super) struct ComplianceFactor<'a> {
    norm: &'a EnergyNorm,
    /// The rows in the dofs that are swept: on the boundary, or in the whole body.
    rows: RowsOnBoundary,
    /// The boundary, if all rows are on it.
    boundary: Option<&'a Boundary>,
    /// That of a sweep, relative.
    rounding: f64,
}

impl<'a> ComplianceFactor<'a> {
    pub(super) fn of(problem: &ContactProblem, norm: &'a EnergyNorm) -> Self {
        let rounding = norm.rounding();
        match norm.rows_on_boundary(&problem.contact, |_| true) {
            Some(rows) => ComplianceFactor { norm, rows, boundary: norm.boundary.as_deref(), rounding },
            None => {
                let rows = RowsOnBoundary::of(&norm.rows_in_body(&problem.contact));
                ComplianceFactor { norm, rows, boundary: None, rounding }
            }
        }
    }

    fn length(&self) -> usize {
        self.boundary.map_or(self.norm.cholesky.dim(), |boundary| boundary.dofs.len())
    }

    fn column(&self, row: usize) -> Vec<f64> {
        let mut column = vec![0.0; self.length()];
        self.rows.by_row.column(row).for_each(|(place, b)| column[place] = b);
        match self.boundary {
            Some(boundary) => boundary.block.forward(column),
            None => self.norm.cholesky.forward(&column),
        }
    }

    /// The lower triangle of the products of the columns of these rows, column by column; `None` if there is no time,
    /// or without a boundary.
    fn products(&self, rows: &[usize]) -> Option<Vec<f64>> {
        let count = rows.len();
        if let Some(compliance) = &self.rows.compliance {
            let of_column = |j: usize| {
                rows.iter().enumerate().map(move |(i, &row)| if i < j { 0.0 } else { compliance.product(row, rows[j]) })
            };
            return Some((0..count).flat_map(of_column).collect());
        }
        let block = &self.boundary?.block;
        let size = block.size();
        let mut columns = Vec::with_capacity(count * size);
        for some in rows.chunks(AT_ONCE) {
            if self.norm.is_over() {
                return None;
            }
            let mut forces = vec![0.0; some.len() * size];
            for (column, &row) in forces.chunks_mut(size.max(1)).zip(some) {
                self.rows.by_row.column(row).for_each(|(place, b)| column[place] = b);
            }
            columns.append(&mut forward_all(block, forces));
        }
        Some(products(size, &columns))
    }

    /// `sqrt(G_ii)`, with the rounding of a sweep: the distance by which a displacement of unit energy norm moves the
    /// row.
    pub(super) fn reach(&self, row: usize) -> f64 {
        if self.norm.is_over() {
            return f64::INFINITY;
        }
        let square = match &self.rows.compliance {
            Some(compliance) => compliance.product(row, row),
            None => {
                let column = self.column(row);
                dot(&column, &column)
            }
        };
        ldexp(self.rounding * self.norm.length(square), -self.rows.shift[row])
    }

    /// The reach of all rows, if their compliance is known; otherwise upper bounds by one sweep, if the contact
    /// boundary is known: the length of a column is at most the sum of its magnitudes.
    pub(super) fn reach_at_once(&self) -> Option<Vec<f64>> {
        let all = 0..self.rows.shift.len();
        if self.rows.compliance.is_some() {
            return Some(all.map(|row| self.reach(row)).collect());
        }
        let sums = self.rows.by_row.mul_abs_transposed(&self.boundary?.block.sums_of_inverse());
        let reach = |row: usize| self.rounding * self.norm.length(sums[row].powi(2));
        Some(all.map(|row| ldexp(reach(row), -self.rows.shift[row])).collect())
    }

    /// Multiplications of one sweep.
    pub(super) fn sweep(&self) -> f64 {
        match self.boundary {
            Some(boundary) => (boundary.dofs.len() as f64).powi(2) / 2.0,
            None => self.norm.cholesky.entries() as f64,
        }
    }

    fn work(&self, rows: usize) -> f64 {
        (rows * rows) as f64 * (self.length() + rows) as f64
    }

    /// `sqrt((G_CC^-1)_ii)` of the rows C of `contact`; infinite for those that take part in a dependence.
    fn moved_together(&self, contact: &SparseMatrix, rows: &[usize]) -> Vec<f64> {
        let none = || vec![f64::INFINITY; rows.len()];
        let of_reciprocal = |row: usize, reciprocal: f64| {
            self.rounding * ldexp_root(reciprocal, -self.norm.equilibration.factor, self.rows.shift[row])
        };
        if self.norm.is_sharp()
            && let Some(products) = self.products(rows)
            && let Some(reciprocals) = inverse_lengths_by_products(rows.len(), products)
        {
            return rows.iter().zip(reciprocals).map(|(&row, reciprocal)| of_reciprocal(row, reciprocal)).collect();
        }
        let Some(Dependence { independent, takes_part }) = Dependence::of(contact, rows, || self.norm.is_over()) else {
            return none();
        };
        let basis: Vec<usize> = (0..rows.len()).filter(|&index| independent[index]).collect();
        let in_time = |&index: &usize| if self.norm.is_over() { None } else { Some(self.column(rows[index])) };
        let Some(columns) = basis.iter().map(in_time).collect::<Option<Vec<_>>>() else { return none() };
        let Some(reciprocals) = inverse_lengths(columns, || self.norm.is_over()) else { return none() };
        let mut lengths = none();
        for (&index, reciprocal) in basis.iter().zip(reciprocals).filter(|entry| !takes_part[*entry.0]) {
            lengths[index] = of_reciprocal(rows[index], reciprocal);
        }
        lengths
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs of both signs across, with a row `b u_i - u_(i-1) <= 1` at every fifth of its 50 dofs.
    #[test]
    fn the_reach_of_all_rows_by_one_sweep_is_above_that_of_each() {
        let dofs = 50;
        let stiff = |i: usize| 3.0 + (i % 7) as f64;
        let mut entries: Vec<_> = (0..dofs).map(|i| (i, i, stiff(i))).collect();
        entries.extend((1..dofs).map(|i| (i, i - 1, if i % 3 == 0 { 1.0 } else { -1.4 })));
        let rows: Vec<_> = (0..9).flat_map(|r| [(r, 5 * r + 1, 2.0), (r, 5 * r, -1.0)]).collect();
        let problem = ContactProblem::of_entries(&entries, &vec![1.0; dofs], &rows, &[1.0; 9]);
        let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
        let compliance = ComplianceFactor::of(&problem, &norm);
        let at_once = compliance.reach_at_once().unwrap();
        for (row, &bound) in at_once.iter().enumerate() {
            let exact = compliance.reach(row);
            assert!(bound >= exact && bound < 10.0 * exact, "row {row}: {bound} {exact}");
        }
    }

    /// K = [3, b; b, 3] with b near three: a row on one dof moves by sqrt(3 / ((3 - b) (3 + b))), in which 3 - b is
    /// exact.
    #[test]
    fn the_reach_of_a_row_is_not_below_the_exact_one_if_a_pivot_is_small() {
        let mut missed = 0.0_f64;
        for number in 0..300 {
            let b = 3.0 - 1e-4 * 0.95_f64.powi(number) * (1.0 + f64::from(number) / 997.0);
            let exact = (3.0 / ((3.0 - b) * (3.0 + b))).sqrt();
            let problem =
                ContactProblem::of_entries(&[(0, 0, 3.0), (1, 0, b), (1, 1, 3.0)], &[1.0; 2], &[(0, 0, 1.0)], &[1.0]);
            let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
            let reach = ComplianceFactor::of(&problem, &norm).reach(0);
            assert!(reach >= exact, "{b}: {reach} {exact}");
            missed = missed.max((reach / exact / norm.rounding() - 1.0).abs());
        }
        // The sweep itself misses by far more than the last bits.
        assert!(missed > 1e-13, "{missed}");
    }

    /// A spring of stiffness one from a support to a wall, which it presses with 1e-9.
    #[test]
    fn an_answer_beside_its_support_proves_no_row_open() {
        let k = [(0, 0, 1.0), (1, 0, -1.0), (1, 1, 1.0)];
        let rows = [(0, 1, 1.0), (1, 0, 1.0), (2, 0, -1.0)];
        let problem = ContactProblem::of_entries(&k, &[0.0, 1.0 + 1e-9], &rows, &[1.0, 0.0, 0.0]);
        let norm = problem.norm_on_equalities().unwrap().unwrap();
        let open = |off: f64| {
            let (displacement, multiplier) = ([off, 1.0 + off], [0.0, -1.0, 0.0]);
            let answer = WithEvidence { displacement: &displacement, multiplier: &multiplier, evidence: None };
            problem.prove_by(&Bounding::Factor(norm.clone()), answer).is_some_and(|proven| proven.open.contains(0))
        };
        // Both ends off by as much keep the energy and the forces.
        assert!(!open(-0.1) && !open(-1e-6));
    }

    #[test]
    fn what_is_out_of_balance_without_the_open_rows_is_free_of_their_forces() {
        // K = 4, f = 8 and u = 1: a row that is proven open has no force in the exact answer, and -4 on the other
        // balances.
        let problem = ContactProblem::of_entries(&[(0, 0, 4.0)], &[8.0], &[(0, 0, 1.0), (1, 0, -2.0)], &[1.0, 9.0]);
        let (displacement, multiplier) = ([1.0], [-4.0, -0.5]);
        let answer = problem.answer(&displacement, &multiplier);
        assert_eq!(answer.residual, [1.0]);
        for (open, balance) in [([false, true], 0.0), ([false, false], 1.0)] {
            let left = problem.unbalanced(&answer, &open.into_iter().collect());
            assert_eq!((left.is_residual, &left.force[..]), (!open[1], &[balance][..]));
        }
    }

    #[test]
    fn the_compliance_that_a_method_knows_gives_the_reach_and_the_shifts_that_sweeps_give() {
        // A dense K of twelve dofs with sizes from 1/8 to 8, and four dense rows of sizes from 1 to 1/512.
        let (dofs, size) = (12, |dof: usize| 2.0_f64.powi(dof as i32 % 7 - 3));
        let coupling = |i: usize, j: usize| if i == j { 4.0 } else { 1.0 / (1.0 + (i - j) as f64) };
        let lower = (0..dofs).flat_map(|j| (j..dofs).map(move |i| (i, j)));
        let entries: Vec<_> = lower.map(|(i, j)| (i, j, coupling(i, j) * size(i) * size(j))).collect();
        let of_row =
            |row: usize, dof: usize| (1.0 + ((row + 2) * (dof + 1) % 5) as f64) * size(dof) / 8.0_f64.powi(row as i32);
        let rows: Vec<_> = (0..4).flat_map(|row| (0..dofs).map(move |dof| (row, dof, of_row(row, dof)))).collect();
        let problem = ContactProblem::of_entries(&entries, &vec![1.0; dofs], &rows, &[1.0; 4]);
        let alone = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
        let RowsOnBoundary { by_row, shift, .. } = alone.rows_on_boundary(problem.contact(), |_| true).unwrap();
        let known = alone.clone().with_rows(problem.contact(), &by_row.transposed(), &shift);
        let [alone, known] = [&alone, &known].map(|norm| ComplianceFactor::of(&problem, norm));
        assert!(known.rows.compliance.is_some() && alone.rows.compliance.is_none());
        let all: Vec<usize> = (0..4).collect();
        let lengths = [&alone, &known].map(|of| of.moved_together(problem.contact(), &all));
        let reach = known.reach_at_once().unwrap();
        for row in all {
            assert!((reach[row] / alone.reach(row) - 1.0).abs() < 1e-14, "{row}: {reach:?}");
            assert!((lengths[1][row] / lengths[0][row] - 1.0).abs() < 1e-12, "{row}: {lengths:?}");
        }
    }

    #[test]
    fn a_row_has_the_same_reach_on_the_boundary_and_in_the_whole_body() {
        // With K = tridiag(-1, 3, -1) and B = 2 the compliance is 4 K^-1, and its inverse K / 4.
        for (dofs, on_boundary) in [(30, true), (400, false)] {
            let diagonal = (0..dofs).map(|i| (i, i, 3.0));
            let entries: Vec<_> = diagonal.chain((1..dofs).map(|i| (i, i - 1, -1.0))).collect();
            let rows: Vec<_> = (0..dofs).map(|row| (row, row, 2.0)).collect();
            let problem = ContactProblem::of_entries(&entries, &vec![1.0; dofs], &rows, &vec![1.0; dofs]);
            let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
            assert_eq!(norm.boundary.is_some(), on_boundary);
            let compliance = ComplianceFactor::of(&problem, &norm);
            // A sweep takes one multiplication for each value of the factor: those of a full triangle, or no less than
            // those of K.
            let full = dofs * (dofs + 1) / 2;
            let least = if on_boundary { full - dofs } else { 2 * dofs - 1 };
            assert!((least as f64..=full as f64).contains(&compliance.sweep()), "{}", compliance.sweep());
            for row in [0, 1, dofs / 2, dofs - 1] {
                let mut force = vec![0.0; dofs];
                force[row] = 2.0;
                let exact = (2.0 * norm.displacement(&force)[row]).sqrt();
                // The reach is that of the sweep, with its rounding.
                let swept = compliance.reach(row) / norm.rounding();
                assert!((swept / exact - 1.0).abs() < 1e-14, "row {row} of {dofs}");
            }
            let all: Vec<usize> = (0..dofs).collect();
            for length in compliance.moved_together(problem.contact(), &all) {
                assert!((length / norm.rounding() / (0.75_f64).sqrt() - 1.0).abs() < 1e-13, "{length} of {dofs}");
            }
        }
    }
}
