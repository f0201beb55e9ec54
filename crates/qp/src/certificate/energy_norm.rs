//! The energy norm of a definite stiffness, with its data on the contact boundary.

use std::sync::Arc;

use super::scales::{compliance_of_rows, energies};
use crate::error::Result;
use crate::linear::watch::Watch;
use crate::linear::{
    Analysis, Cholesky, Compliance, Equilibration, LowerTriangle, SparseMatrix, SymmetricMatrix, dot, exponent,
    if_definite, ldexp,
};
use crate::problem::ContactProblem;

/// Contact dofs beyond this share of all are not ordered last: the boundary would be most of the body.
const LARGEST_SHARE: f64 = 0.25;

/// Up to this number, contact dofs are ordered last whatever their share: dense matrices then cost a millisecond.
const FEW_DOFS: usize = 100;

/// Rounding of a sweep, relative, over the smallest pivot.
const SWEEP_ROUNDING: f64 = 1e5 * f64::EPSILON;

/// If the rounding of a sweep may reach this multiple of the sweep itself, the factor belongs to another matrix.
const LOST: f64 = 1e3;

/// A bound is multiplied with this, because its own sums are rounded too.
pub const ROUNDED_BOUND: f64 = 1.0 + 1e-6;

/// Values of a dense matrix on the boundary that are not worth counting.
const FEW_VALUES: usize = 1_000_000;

/// The energy norm of a positive definite stiffness and its dual, from one factorisation of K with a diagonal near one.
#[derive(Clone, Debug)]
pub struct EnergyNorm {
    /// The factor of `c D K D`.
    pub cholesky: Cholesky,
    /// D and c, as exponents of two: `K^-1 = c D (c D K D)^-1 D`.
    pub equilibration: Equilibration,
    pub boundary: Option<Arc<Boundary>>,
    /// A contact matrix whose compliance is kept for many answers.
    kept: Option<Arc<(SparseMatrix, RowsOnBoundary)>>,
    pub springs: Option<Arc<Springs>>,
    /// The dofs without stiffness, in which the matrix has a stiffness of one, if these made K singular.
    pub loose: Option<Arc<Loose>>,
    pub watch: Watch,
}

/// Dofs without stiffness, load and contact force: in the norm they have a stiffness of one, on which no force may act.
#[derive(Clone, Debug)]
pub struct Loose {
    pub dofs: Vec<usize>,
    /// `true` for each row that acts on one of them.
    pub rows: Vec<bool>,
}

/// The contact dofs t, eliminated last: their block of the factor is that of the Schur complement.
#[derive(Clone, Debug)]
pub struct Boundary {
    pub dofs: Vec<usize>,
    /// L_tt, t x t.
    pub block: LowerTriangle,
}

/// Rows on the contact boundary or in the whole body, normalised by powers of two.
#[derive(Clone, Debug)]
pub struct RowsOnBoundary {
    /// W of the rows, each with the coefficients times D; the largest is near one.
    pub compliance: Arc<Compliance>,
    /// Exponent by which each row was multiplied.
    pub shift: Vec<i32>,
}

impl EnergyNorm {
    /// The energy norm of `stiffness`, with the boundary of the dofs in the rows `contact`; `None` if the stiffness is
    /// not positive definite to working precision.
    pub fn of(stiffness: &SymmetricMatrix, contact: &SparseMatrix) -> Result<Option<Self>> {
        if stiffness.diagonal().iter().any(|&value| value <= 0.0) {
            return Ok(None);
        }
        let equilibration = Equilibration::of(stiffness);
        let scaled = equilibration.apply(stiffness);
        let dofs = Self::last_dofs(&scaled, contact);
        let factor = Analysis::with_last(&scaled, &dofs).and_then(|analysis| analysis.factor(&scaled));
        let definite = if_definite(factor)?.filter(|cholesky| cholesky.is_definite(&scaled));
        Ok(definite.map(|cholesky| Self::new(cholesky, equilibration, dofs)))
    }

    /// The dofs to eliminate last, those in the rows `contact`; none if that is most of a body with a sparse factor.
    pub fn last_dofs(stiffness: &SymmetricMatrix, contact: &SparseMatrix) -> Vec<usize> {
        let dofs = contact.columns_with_entries();
        let most = FEW_DOFS.max((LARGEST_SHARE * contact.columns() as f64) as usize);
        if dofs.len() > most && !Analysis::is_dense_for(stiffness) { Vec::new() } else { dofs }
    }

    /// The energy norm from a factor of the equilibrated stiffness `c D K D`, with `last` as its last columns.
    pub fn new(cholesky: Cholesky, equilibration: Equilibration, last: Vec<usize>) -> Self {
        let values = last.len().saturating_mul(last.len());
        let worth = !last.is_empty() && values <= FEW_VALUES.max(cholesky.entries());
        let boundary = worth.then(|| Arc::new(Boundary { block: cholesky.trailing_block(), dofs: last }));
        let watch = Watch::default();
        EnergyNorm { cholesky, equilibration, boundary, kept: None, springs: None, loose: None, watch }
    }

    /// The same norm, which keeps the compliance of the rows `contact` for many answers; it is made at its first use.
    pub fn keeping(self, contact: &SparseMatrix) -> Self {
        let rows = self.rows_on_boundary(contact, |_| true).filter(|rows| !rows.compliance.is_kept());
        let Some(RowsOnBoundary { compliance, shift }) = rows else { return self };
        let rows = RowsOnBoundary { compliance: Arc::new(compliance.kept()), shift };
        EnergyNorm { kept: Some(Arc::new((contact.clone(), rows))), ..self }
    }

    /// The same if balances of forces cost less by it.
    pub fn lending(self, contact: &SparseMatrix) -> Self {
        if Compliance::pays(&self.cholesky, contact) { self.keeping(contact) } else { self }
    }

    pub fn compliance(&self) -> Option<&Compliance> {
        self.kept.as_ref().map(|kept| &*kept.1.compliance)
    }

    /// The entries of `B K^-1 B'` for these rows; `None` if the boundary is not known, or if a row reaches beyond it.
    pub fn compliances(&self, contact: &SparseMatrix) -> Option<impl Fn(usize, usize) -> f64 + use<>> {
        let RowsOnBoundary { compliance, shift } = self.clone().keeping(contact).rows_on_boundary(contact, |_| true)?;
        let unit = self.equilibration.factor;
        Some(move |a: usize, b: usize| ldexp(compliance.product(a, b), unit - shift[a] - shift[b]))
    }

    /// The energy norm of the equilibrated stiffness itself.
    pub fn equilibrated(&self) -> Self {
        EnergyNorm { equilibration: Equilibration::none(self.cholesky.dim()), ..self.clone() }
    }

    /// The same norm, with bounds that are cut short when `watch` says so: then a weaker bound, or none, is left.
    pub fn watched(&self, watch: &Watch) -> Self {
        EnergyNorm { watch: watch.clone(), ..self.clone() }
    }

    /// The length in the springs alone of a displacement that moves their rows by `moves`, with its rounding.
    pub fn length_of_springs(&self, moves: &[f64]) -> f64 {
        let springs = self.springs.iter().flat_map(|springs| &springs.stiffness).zip(moves);
        let square: f64 = springs.filter(|(d, _)| **d > 0.0).map(|(d, moved)| d * moved * moved).sum();
        ROUNDED_BOUND * square.sqrt()
    }

    pub fn is_over(&self) -> bool {
        self.watch.is_over()
    }

    /// Relative rounding of a norm that comes from sweeps through the factor: some last bits over the smallest pivot.
    pub fn rounding(&self) -> f64 {
        let share = SWEEP_ROUNDING * self.loss();
        if share < LOST { ROUNDED_BOUND + share } else { f64::INFINITY }
    }

    /// Returns `true` if the rounding of a sweep is no more than what every bound is widened by anyway.
    pub fn is_sharp(&self) -> bool {
        SWEEP_ROUNDING * self.loss() <= ROUNDED_BOUND - 1.0
    }

    /// The same of a single sweep `L^-1 r`, beside another with the same factor: over the smallest diagonal entry of L.
    pub fn rounding_of_column(&self) -> f64 {
        SWEEP_ROUNDING * self.loss().sqrt()
    }

    /// Amplification of rounding by a sweep, on a diagonal of order one: one over the smallest pivot, at least one.
    pub fn loss(&self) -> f64 {
        1.0 / self.cholesky.smallest_pivot().min(1.0)
    }

    /// The same norm with the stiffness in another unit, `2^unit`.
    pub fn with_unit(&self, unit: i32) -> Self {
        let mut norm = self.clone();
        norm.equilibration.factor += unit;
        if let Some(springs) = norm.springs.as_mut().map(Arc::make_mut) {
            springs.stiffness.iter_mut().for_each(|value| *value = ldexp(*value, -unit));
        }
        norm
    }

    /// `sqrt(r' K^-1 r)`: the energy norm of the displacement that the force r causes.
    ///
    /// Infinite if the force acts on a dof without stiffness.
    pub fn of_force(&self, force: &[f64]) -> f64 {
        if self.loose.as_ref().is_some_and(|loose| loose.dofs.iter().any(|&dof| force[dof] != 0.0)) {
            return f64::INFINITY;
        }
        // K^-1 = c D (c D K D)^-1 D
        ldexp(self.cholesky.inverse_product(&self.scaled(force)), self.equilibration.factor).max(0.0).sqrt()
    }

    /// The displacement that the force r causes: `K^-1 r`.
    pub fn displacement(&self, force: &[f64]) -> Vec<f64> {
        let scaled = self.cholesky.solve(&self.scaled(force));
        let exponents = self.equilibration.diagonal.iter().map(|d| d + self.equilibration.factor);
        scaled.iter().zip(exponents).map(|(&value, exponent)| ldexp(value, exponent)).collect()
    }

    pub fn loose_dofs(&self) -> usize {
        self.loose.as_ref().map_or(0, |loose| loose.dofs.len())
    }

    pub fn is_on_loose_dof(&self, row: usize) -> bool {
        self.loose.as_ref().is_some_and(|loose| loose.rows[row])
    }

    /// `L^-1 D r`, of which the [`length`](Self::length) is the energy norm of the displacement that the force r
    /// causes: the squares of the interior added up, and the entries of the boundary.
    pub fn sweep(&self, force: &[f64]) -> (f64, Vec<f64>) {
        let swept = self.cholesky.forward(&self.scaled(force));
        let size = self.boundary.as_ref().map_or(0, |boundary| boundary.dofs.len());
        let (interior, last) = swept.split_at(swept.len() - size.min(swept.len()));
        (dot(interior, interior), last.to_vec())
    }

    /// The length of a sweep, from its square, as an energy norm.
    pub fn length(&self, square: f64) -> f64 {
        ldexp(square, self.equilibration.factor).sqrt()
    }

    /// The rows of `contact` that `counts`, on the boundary, and no entry of the others; `None` if the boundary is not
    /// known, or if such a row reaches beyond it.
    pub fn rows_on_boundary(&self, contact: &SparseMatrix, counts: impl Fn(usize) -> bool) -> Option<RowsOnBoundary> {
        let boundary = self.boundary.as_ref()?;
        if let Some(kept) = self.kept.as_ref().filter(|kept| kept.0.is_shared_with(contact)) {
            return Some(kept.1.clone());
        }
        let is_entry = |entry: &(usize, f64)| entry.1 != 0.0 && counts(entry.0);
        let rows = self.rows_at(&boundary.dofs, contact, is_entry);
        let is_whole = boundary.dofs.len() == contact.columns()
            || rows.entries() == (0..contact.columns()).flat_map(|dof| contact.column(dof)).filter(is_entry).count();
        is_whole.then(|| self.normalised(&rows, Some(&boundary.block)))
    }

    /// The rows of `contact` in the whole body, each a column: dof, coefficient times D.
    pub fn scaled_rows(&self, contact: &SparseMatrix) -> SparseMatrix {
        self.rows_at(&(0..contact.columns()).collect::<Vec<_>>(), contact, |entry| entry.1 != 0.0)
    }

    /// Rows, each a column, on the block that they are in.
    pub fn normalised(&self, by_row: &SparseMatrix, block: Option<&LowerTriangle>) -> RowsOnBoundary {
        let largest = |row: usize| by_row.column(row).fold(0.0, |largest: f64, (_, b)| largest.max(b.abs()));
        let shift: Vec<i32> = (0..by_row.columns()).map(|row| -exponent(largest(row))).collect();
        let of_row = |row: usize| by_row.column(row).map(move |(_, b)| (b, row));
        let values = (0..by_row.columns()).flat_map(of_row).map(|(b, row)| ldexp(b, shift[row])).collect();
        let compliance = Arc::new(Compliance::new(&self.cholesky, block, by_row.with_values(values)));
        RowsOnBoundary { compliance, shift }
    }

    fn rows_at(
        &self,
        dofs: &[usize],
        contact: &SparseMatrix,
        is_entry: impl Fn(&(usize, f64)) -> bool,
    ) -> SparseMatrix {
        let entries = || {
            let of_dof = |(place, &dof): (usize, &usize)| contact.column(dof).map(move |(row, b)| (place, dof, row, b));
            dofs.iter().enumerate().flat_map(of_dof).filter(|&(.., row, b)| is_entry(&(row, b)))
        };
        let mut starts = vec![0; contact.rows() + 1];
        entries().for_each(|(.., row, _)| starts[row + 1] += 1);
        (0..contact.rows()).for_each(|row| starts[row + 1] += starts[row]);
        let (mut next, count) = (starts.clone(), starts[contact.rows()]);
        let (mut places, mut values) = (vec![0; count], vec![0.0; count]);
        for (place, dof, row, b) in entries() {
            (places[next[row]], values[next[row]]) = (place as u32, ldexp(b, self.equilibration.diagonal[dof]));
            next[row] += 1;
        }
        SparseMatrix::from_parts(dofs.len(), starts, places, values)
    }

    fn scaled(&self, force: &[f64]) -> Vec<f64> {
        force.iter().zip(&self.equilibration.diagonal).map(|(&r, &d)| ldexp(r, d)).collect()
    }
}

/// `2^length sqrt(2^stiffness) x`
pub fn ldexp_root(x: f64, stiffness: i32, length: i32) -> f64 {
    let root = if stiffness % 2 == 0 { 1.0 } else { std::f64::consts::SQRT_2 };
    ldexp(root * x, stiffness.div_euclid(2) + length)
}

/// Springs D on rows C that press, or that are equalities: with them a singular K becomes `K_D = K + B_C' D B_C`.
#[derive(Clone, Debug)]
pub struct Springs {
    /// D of each row, zero on rows without a spring.
    pub stiffness: Vec<f64>,
    /// The rows that are equalities: at their gaps they stay there, whatever their force.
    pub are_equalities: Vec<bool>,
}

impl Springs {
    /// `K + B_C' D B_C`; `None` if no row presses.
    pub fn added_to(&self, stiffness: &SymmetricMatrix, contact: &SparseMatrix) -> Result<Option<SymmetricMatrix>> {
        let closed: Vec<usize> = (0..contact.rows()).filter(|&row| self.stiffness[row] > 0.0).collect();
        if closed.is_empty() {
            return Ok(None);
        }
        let weights: Vec<f64> = closed.iter().map(|&row| self.stiffness[row]).collect();
        Ok(Some(stiffness.plus_squares(&contact.select_rows(&closed), &weights)?))
    }

    /// `f + B' lambda - K_D u + B_C' D g_C`: the `residual` with springs of an answer with this `violation`.
    pub fn residual(&self, contact: &SparseMatrix, residual: &[f64], violation: &[f64]) -> Vec<f64> {
        let pull: Vec<f64> = (self.stiffness.iter().zip(violation))
            .map(|(&stiffness, &violation)| if stiffness > 0.0 { -stiffness * violation } else { 0.0 })
            .collect();
        residual.iter().zip(contact.mul_transposed(&pull)).map(|(r, spring)| r + spring).collect()
    }

    /// `true` if each row with a spring is `closed`, and its force twice what `left(row)`, a dual norm, takes off.
    pub fn hold(&self, closed: &[bool], certain_force: impl Fn(usize) -> f64, left: impl Fn(usize) -> f64) -> bool {
        let springs = self.stiffness.iter().enumerate().filter(|spring| *spring.1 != 0.0);
        let presses = |row: usize, stiffness: f64| certain_force(row) > 2.0 * stiffness.sqrt() * left(row);
        springs
            .into_iter()
            .all(|(row, &stiffness)| closed[row] && (self.are_equalities[row] || presses(row, stiffness)))
    }
}

/// A row presses if its force could do more than this share of the energy norm of its part.
pub const PRESSING: f64 = 1e-8;

/// The energy norm of K; if K is semidefinite, that of K with springs on the rows that press, without the dofs that
/// have neither stiffness nor a force. `None` if the springs do not hold the body, or if K has a negative
/// eigenvalue, which springs would hide.
pub fn norm_of_answer(
    problem: &ContactProblem,
    displacement: &[f64],
    multiplier: &[f64],
) -> Result<Option<EnergyNorm>> {
    if let Some(norm) = EnergyNorm::of(&problem.stiffness, &problem.contact)? {
        return Ok(Some(norm));
    }
    let (mut stiffness, mut loose) = (problem.stiffness.clone(), None);
    if let Some(found) = loose_dofs(problem, multiplier) {
        let entries: Vec<_> = found.dofs.iter().enumerate().map(|(row, &dof)| (row, dof, 1.0)).collect();
        let rows = SparseMatrix::from_triplets(entries.len(), problem.dofs(), &entries)?;
        stiffness = stiffness.plus_squares(&rows, &vec![1.0; entries.len()])?;
        loose = Some(Arc::new(found));
        if let Some(norm) = EnergyNorm::of(&stiffness, &problem.contact)? {
            return Ok(Some(EnergyNorm { loose, ..norm }));
        }
    }
    let springs = springs_on(problem, displacement, multiplier);
    let Some(held) = springs.added_to(&stiffness, &problem.contact)? else { return Ok(None) };
    let Some(norm) = EnergyNorm::of(&held, &problem.contact)? else { return Ok(None) };
    let springs = Some(Arc::new(springs));
    Ok(problem.is_semidefinite()?.then_some(EnergyNorm { springs, loose, ..norm }))
}

/// The energy norm of a stiffness that is definite by itself, or with springs on equalities alone: it serves every
/// answer. `None` if there is none.
pub fn norm_on_equalities(problem: &ContactProblem) -> Result<Option<EnergyNorm>> {
    let (at_rest, forces) = (vec![0.0; problem.dofs()], vec![0.0; problem.rows()]);
    let norm = norm_of_answer(&problem.two_sided(&forces).0, &at_rest, &forces)?;
    Ok(norm.filter(|norm| norm.loose_dofs() == 0))
}

/// The dofs without stiffness on which neither a load nor a row acts, if there are some.
fn loose_dofs(problem: &ContactProblem, multiplier: &[f64]) -> Option<Loose> {
    let dofs = problem.diagonal().values.iter().zip(&problem.load);
    let mut is_loose: Vec<bool> = dofs.map(|(&stiffness, &f)| stiffness == 0.0 && f == 0.0).collect();
    // A coupling on a diagonal of zero has negative energy.
    for (row, column, _) in problem.stiffness.lower().triplets().filter(|entry| entry.2 != 0.0) {
        (is_loose[row], is_loose[column]) = (false, false);
    }
    let acts = |row: usize| multiplier[row] != 0.0 || problem.is_two_sided(row);
    let acting = problem.contact.triplets().filter(|&(row, _, b)| b != 0.0 && acts(row));
    acting.for_each(|(_, dof, _)| is_loose[dof] = false);
    let dofs: Vec<usize> = (0..problem.dofs()).filter(|&dof| is_loose[dof]).collect();
    let mut rows = vec![false; problem.rows()];
    problem.contact.triplets().filter(|&(_, dof, b)| b != 0.0 && is_loose[dof]).for_each(|(row, ..)| rows[row] = true);
    (!dofs.is_empty()).then_some(Loose { dofs, rows })
}

/// Springs on the rows that press and on equalities, each as stiff as the row itself if only its own dofs move.
pub fn springs_on(problem: &ContactProblem, displacement: &[f64], multiplier: &[f64]) -> Springs {
    let parts = problem.parts();
    let of_stiff = |square: f64, stiffness: f64| if stiffness > 0.0 { square / stiffness } else { 0.0 };
    let compliance = compliance_of_rows(problem, of_stiff);
    let sizes: Vec<f64> = energies(problem, true, displacement).0.iter().map(|energy| energy.max(0.0).sqrt()).collect();
    let violation = problem.accurate_violation(displacement);
    let spring = |row: usize| {
        let (force, size) = (-multiplier[row], sizes[parts.of_row[row]]);
        // A row that acts only on dofs without stiffness has no stiffness of its own: its force sets the scale.
        let stiffness = match compliance[row] {
            0.0 if size > 0.0 && force != 0.0 => (force / size).powi(2),
            0.0 => 1.0,
            compliance => 1.0 / compliance,
        };
        if problem.is_two_sided(row) {
            return stiffness;
        }
        let presses = force > PRESSING * stiffness.sqrt() * size && force * compliance[row] >= -violation[row];
        if presses { stiffness } else { 0.0 }
    };
    let has_one = |row: usize| multiplier[row] < 0.0 || problem.is_two_sided(row);
    Springs {
        stiffness: (0..problem.rows()).map(|row| if has_one(row) { spring(row) } else { 0.0 }).collect(),
        are_equalities: (0..problem.rows()).map(|row| problem.is_two_sided(row)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two dofs of the same stiffness, and a share of that stiffness between them.
    fn pair(stiffness: f64, coupling: f64) -> SymmetricMatrix {
        let entries = [(0, 0, stiffness), (1, 0, -coupling * stiffness), (1, 1, stiffness)];
        SymmetricMatrix::from_lower(SparseMatrix::from_triplets(2, 2, &entries).unwrap()).unwrap()
    }

    fn norm(stiffness: &SymmetricMatrix) -> EnergyNorm {
        EnergyNorm::of(stiffness, &SparseMatrix::from_triplets(0, 2, &[]).unwrap()).unwrap().unwrap()
    }

    #[test]
    fn a_small_pivot_is_a_loss_of_digits_that_widens_the_bound() {
        assert_eq!(norm(&pair(4.0, 0.0)).loss(), 1.0);
        for slack in [1e-3, 1e-6] {
            // The second pivot of (1, -c; -c, 1) is 1 - c^2.
            let (loss, exact) = (norm(&pair(4.0, 1.0 - slack)).loss(), 1.0 / (slack * (2.0 - slack)));
            assert!((loss / exact - 1.0).abs() < 1e-8, "{loss} {exact}");
            assert_eq!(norm(&pair(4.0, 1.0 - slack)).is_sharp(), slack > 1e-4);
            let rounding = norm(&pair(4.0, 1.0 - slack)).rounding();
            assert!((rounding - ROUNDED_BOUND - SWEEP_ROUNDING * exact).abs() < 1e-8 * rounding, "{rounding}");
        }
    }

    #[test]
    fn springs_of_stiffness_four_that_move_by_three_have_a_length_of_six() {
        let springs = Springs { stiffness: vec![4.0, 0.0], are_equalities: vec![false; 2] };
        let norm = EnergyNorm { springs: Some(Arc::new(springs)), ..norm(&pair(4.0, 0.0)) };
        assert_eq!(norm.length_of_springs(&[3.0, 7.0]), ROUNDED_BOUND * 6.0);
    }

    #[test]
    fn compliances_are_in_the_units_of_the_rows() {
        let rows = SparseMatrix::from_triplets(2, 2, &[(0, 0, 32.0), (1, 0, 0.5), (1, 1, 0.5)]).unwrap();
        let of = EnergyNorm::of(&pair(4.0, 0.0), &rows).unwrap().unwrap().compliances(&rows).unwrap();
        assert_eq!([of(0, 0), of(0, 1), of(1, 0), of(1, 1)], [256.0, 4.0, 4.0, 0.125]);
    }

    #[test]
    fn rows_that_count_are_on_the_boundary_only_without_entries_beyond_it() {
        let rows = |entries: &[(usize, usize, f64)]| SparseMatrix::from_triplets(2, 2, entries).unwrap();
        let norm = EnergyNorm::of(&pair(4.0, 0.0), &rows(&[(0, 1, 1.0)])).unwrap().unwrap();
        assert_eq!(norm.boundary.as_ref().unwrap().dofs, [1]);
        let beyond = rows(&[(0, 1, 1.0), (1, 0, 1.0), (1, 1, 1.0)]);
        assert!(norm.rows_on_boundary(&beyond, |_| true).is_none());
        let first = norm.rows_on_boundary(&beyond, |row| row == 0).unwrap();
        assert_eq!((0..2).map(|row| first.compliance.by_row().column(row).count()).collect::<Vec<_>>(), [1, 0]);
    }

    #[test]
    fn a_norm_ends_with_its_watch() {
        let norm = norm(&pair(4.0, 0.5));
        assert!(!norm.is_over());
        assert!(norm.watched(&Watch::default().within(0.0)).is_over());
    }
}
