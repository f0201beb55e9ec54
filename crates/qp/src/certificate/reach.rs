//! Upper bounds on `sqrt(G_ii)`, `G = B K^-1 B'`: the distance by which a displacement of unit energy norm moves a row.
//!
//! If no entry of K off its diagonal is positive and some w > 0 has `K w >= kappa s` with kappa, s > 0, then K is an
//! M-matrix, no entry of its inverse is negative, and
//!
//! ```text
//! (K^-1)_ii s_i <= (K^-1 s)_i <= w_i / kappa
//! ```
//!
//! One solve `K w = s`, of any accuracy, serves all rows; this is the cheapest bound. Rows that need a smaller one are
//! swept through the factor one by one or, if they are many, read off the selected inverse.
//!
//! # Source
//! A. Berman, R. J. Plemmons, *Nonnegative Matrices in the Mathematical Sciences*, SIAM (1994), theorem 6.2.3:
//! condition I27 of an M-matrix.

use super::energy_norm::{Boundary, EnergyNorm, RowsOnBoundary, ldexp_root};
use super::scales::compliance_of_rows;
use crate::linear::multigrid::Multigrid;
use crate::linear::selected_inverse::FACTORISATIONS;
use crate::linear::watch::Watch;
use crate::linear::{Dependence, SparseMatrix, dot, inverse_lengths, inverse_lengths_by_products, largest, ldexp};
use crate::problem::ContactProblem;

/// Steps of power iteration for the largest eigenvalue of M D.
const POWER_STEPS: usize = 3;

/// Possible error, as a factor, of the quotient of two measured eigenvalues.
const SAFETY: f64 = 4.0;

/// Rounding of an entry of K w, relative to the sum of its terms, is at most this for each term.
const OF_TERM: f64 = 2.0 * f64::EPSILON;

/// Number of multiplications of a blocked factorisation that take the time of one in a sweep.
const BLOCKED: f64 = 4.0;

/// Upper bounds on `sqrt(G_ii)` of every row, from one solve: `solve(s)` returns about `K^-1 s`. `None` if that
/// does not show that K is an M-matrix.
pub fn monotone_reach(problem: &ContactProblem, solve: impl FnOnce(&[f64]) -> Option<Vec<f64>>) -> Option<Vec<f64>> {
    if problem.stiffness().lower().triplets().any(|(row, column, value)| row != column && value > 0.0) {
        return None;
    }
    // On a unit diagonal the right-hand side is one everywhere.
    let load: Vec<f64> = problem.stiffness().diagonal().iter().map(|value| value.sqrt()).collect();
    let w = solve(&load)?;
    if load.iter().chain(&w).any(|&value| !(value > 0.0 && value.is_finite())) {
        return None;
    }
    let terms = problem.stiffness().mul_abs(&w);
    let rounding = OF_TERM * problem.dofs() as f64;
    let sure = problem.stiffness().mul(&w).into_iter().zip(terms).map(|(sum, terms)| sum - rounding * terms);
    let kappa = sure.zip(&load).map(|(sum, s)| sum / s).fold(f64::INFINITY, f64::min);
    if kappa.is_nan() || kappa <= 0.0 {
        return None;
    }
    let roots: Vec<f64> = w.iter().zip(&load).map(|(w, s)| (w / (s * kappa)).sqrt()).collect();
    Some(problem.contact().mul_abs(&roots))
}

/// Upper bounds on `sqrt(G_ii)` of every row from two measured eigenvalues: with the cycle M and `D = diag K`,
///
/// ```text
/// K^-1 <= M / least(M K),     M <= largest(M D) D^-1
/// ```
///
/// The largest is found by power iteration that starts at the smooth `displacement`. `None` if that does not settle.
pub fn measured_reach(
    problem: &ContactProblem,
    (multigrid, least): (&Multigrid, f64),
    displacement: &[f64],
    watch: &Watch,
) -> Option<Vec<f64>> {
    let diagonal = problem.stiffness().diagonal();
    if diagonal.iter().any(|&value| value <= 0.0) {
        return None;
    }
    let (mut x, mut quotient) = (displacement.to_vec(), 0.0_f64);
    for _ in 0..POWER_STEPS {
        let size = largest(&x);
        if size == 0.0 || !size.is_finite() || watch.is_over() {
            return None;
        }
        x.iter_mut().for_each(|value| *value /= size);
        let force: Vec<f64> = x.iter().zip(&diagonal).map(|(x, d)| x * d).collect();
        let moved = multigrid.cycle(&force);
        quotient = quotient.max(dot(&force, &moved) / dot(&force, &x));
        x = moved;
    }
    let mu = least / (SAFETY * quotient);
    let squares = compliance_of_rows(problem, |square, stiffness| square / stiffness);
    Some(squares.into_iter().map(|square| (square / mu).sqrt()).collect())
}

/// The rows of `rows` with a `sqrt(G_ii)` below their limit, by sweeps or by the selected inverse, whichever costs
/// less.
pub fn within_reach(compliance: &ComplianceFactor, rows: &[(usize, f64)]) -> Vec<usize> {
    let norm = compliance.norm;
    let by_sweeps = rows.len() as f64 * compliance.sweep();
    let at_once = FACTORISATIONS * norm.cholesky.multiplications() / BLOCKED;
    let one_by_one = by_sweeps <= at_once || norm.is_over();
    let inverse = if one_by_one { None } else { norm.cholesky.selected_inverse() };
    let inverse = inverse.map(|inverse| (inverse, norm.scaled_rows(compliance.contact)));
    let reach = |row: usize| {
        let square =
            inverse.as_ref().and_then(|(inverse, by_row)| inverse.product(&by_row.column(row).collect::<Vec<_>>()));
        let of_square = |square: f64| norm.length(norm.rounding() * square.max(0.0));
        square.map_or_else(|| compliance.reach(row), of_square)
    };
    rows.iter().filter(|&&(row, limit)| reach(row) < limit).map(|&(row, _)| row).collect()
}

/// The compliance of the rows of a contact matrix: on the boundary if all rows are on it, and otherwise in the whole
/// body.
pub struct ComplianceFactor<'a> {
    contact: &'a SparseMatrix,
    norm: &'a EnergyNorm,
    rows: RowsOnBoundary,
    /// The boundary, if all rows are on it.
    boundary: Option<&'a Boundary>,
}

impl<'a> ComplianceFactor<'a> {
    pub fn of(problem: &'a ContactProblem, norm: &'a EnergyNorm) -> Self {
        let contact = &problem.contact;
        let on_boundary = norm.rows_on_boundary(contact, |_| true);
        let boundary = on_boundary.as_ref().and(norm.boundary.as_deref());
        let rows = on_boundary.unwrap_or_else(|| norm.normalised(&norm.scaled_rows(contact), None));
        ComplianceFactor { contact, norm, rows, boundary }
    }

    /// `sqrt(G_ii)`, with the rounding of a sweep: the distance by which a displacement of unit energy norm moves the
    /// row.
    pub fn reach(&self, row: usize) -> f64 {
        if self.norm.is_over() {
            return f64::INFINITY;
        }
        let compliance = &self.rows.compliance;
        let square = match compliance.is_kept() {
            true => compliance.product(row, row),
            false => {
                let column = compliance.columns(&[row]);
                dot(&column, &column)
            }
        };
        ldexp(self.norm.rounding() * self.norm.length(square), -self.rows.shift[row])
    }

    /// The reach of all rows, if their compliance is known; otherwise upper bounds by one sweep, if the contact
    /// boundary is known: the length of a column is at most the sum of its magnitudes.
    pub fn reach_at_once(&self) -> Option<Vec<f64>> {
        let all = 0..self.rows.shift.len();
        if self.rows.compliance.is_kept() {
            return Some(all.map(|row| self.reach(row)).collect());
        }
        let sums = self.rows.compliance.by_row().mul_abs_transposed(&self.boundary?.block.sums_of_inverse());
        let reach = |row: usize| self.norm.rounding() * self.norm.length(sums[row].powi(2));
        Some(all.map(|row| ldexp(reach(row), -self.rows.shift[row])).collect())
    }

    /// Multiplications of one sweep.
    pub fn sweep(&self) -> f64 {
        match self.boundary {
            Some(boundary) => (boundary.dofs.len() as f64).powi(2) / 2.0,
            None => self.norm.cholesky.entries() as f64,
        }
    }

    pub fn work(&self, rows: usize) -> f64 {
        (rows * rows) as f64 * (self.rows.compliance.by_row().rows() + rows) as f64
    }

    /// `sqrt((G_CC^-1)_ii)` of the rows C; infinite for those that take part in a dependence.
    pub fn moved_together(&self, rows: &[usize]) -> Vec<f64> {
        let (none, rounding) = (|| vec![f64::INFINITY; rows.len()], self.norm.rounding_of_column());
        let of_reciprocal = |row: usize, reciprocal: f64| {
            self.norm.rounding() * ldexp_root(reciprocal, -self.norm.equilibration.factor, self.rows.shift[row])
        };
        if self.norm.is_sharp()
            && self.boundary.is_some()
            && let Some(products) = self.rows.compliance.products(rows, || self.norm.is_over())
            && let Some(reciprocals) = inverse_lengths_by_products(rows.len(), products, rounding)
        {
            return rows.iter().zip(reciprocals).map(|(&row, reciprocal)| of_reciprocal(row, reciprocal)).collect();
        }
        let Some(Dependence { independent, takes_part }) = Dependence::of(self.contact, rows, || self.norm.is_over())
        else {
            return none();
        };
        let basis: Vec<usize> = (0..rows.len()).filter(|&index| independent[index]).collect();
        let in_time = |&index: &usize| {
            if self.norm.is_over() { None } else { Some(self.rows.compliance.columns(&[rows[index]])) }
        };
        let Some(columns) = basis.iter().map(in_time).collect::<Option<Vec<_>>>() else { return none() };
        let Some(reciprocals) = inverse_lengths(columns, rounding, || self.norm.is_over()) else { return none() };
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
    use crate::certificate::scales::least_reach;
    use crate::linear::multigrid::NearNullSpace;

    /// A row on every unknown, twice the unknown.
    fn problem(dofs: usize, entries: &[(usize, usize, f64)]) -> ContactProblem {
        let rows: Vec<_> = (0..dofs).map(|dof| (dof, dof, 2.0)).collect();
        ContactProblem::of_entries(entries, &vec![1.0; dofs], &rows, &vec![1.0; dofs])
    }

    /// Five points on a square of `n` unknowns along a side; with `twist` an entry of either sign across each cell.
    fn lattice(n: usize, twist: f64) -> ContactProblem {
        let mut entries = Vec::new();
        for own in 0..n * n {
            entries.push((own, own, 4.0 + 2.0 * twist));
            let (right, above) = (own % n + 1 < n, own + n < n * n);
            entries.extend(right.then_some((own + 1, own, -1.0)));
            entries.extend(above.then_some((own + n, own, -1.0)));
            entries.extend((right && above).then_some((own + n + 1, own, twist)));
        }
        problem(n * n, &entries)
    }

    /// `sqrt(G_ii)` of every row, by a solve each.
    fn exact(problem: &ContactProblem, norm: &EnergyNorm) -> Vec<f64> {
        let of_row = |row: usize| {
            let mut force = vec![0.0; problem.dofs()];
            force[row] = 2.0;
            (2.0 * norm.displacement(&force)[row]).sqrt()
        };
        (0..problem.rows()).map(of_row).collect()
    }

    #[test]
    fn the_reach_of_unknowns_that_stand_alone_is_exact_however_rough_the_solve() {
        let alone = problem(3, &[(0, 0, 4.0), (1, 1, 1.0), (2, 2, 0.25)]);
        for share in [1.0, 0.5, 3.0] {
            let solve = |s: &[f64]| Some((0..3).map(|i| share * s[i] / [4.0, 1.0, 0.25][i]).collect());
            let reach = monotone_reach(&alone, solve).unwrap();
            for (reach, exact) in reach.iter().zip([1.0, 2.0, 4.0]) {
                assert!((reach / exact - 1.0).abs() < 1e-14, "{reach} {exact}");
            }
        }
    }

    #[test]
    fn the_reach_by_one_solve_is_above_the_exact_one_and_needs_an_m_matrix() {
        let lattice = lattice(14, 0.0);
        let norm = EnergyNorm::of(lattice.stiffness(), lattice.contact()).unwrap().unwrap();
        let reach = monotone_reach(&lattice, |s| Some(norm.displacement(s))).unwrap();
        let exact = exact(&lattice, &norm);
        assert!(reach.iter().zip(&exact).all(|(reach, exact)| reach >= exact && *reach < 20.0 * exact));
        let twisted = super::tests::lattice(14, 0.3);
        assert!(monotone_reach(&twisted, |s| Some(s.to_vec())).is_none());
        // K w with a negative entry shows nothing.
        assert!(
            monotone_reach(&lattice, |s| Some(s.iter().enumerate().map(|(i, s)| s * (1.0 + (i % 2) as f64)).collect()))
                .is_none()
        );
    }

    #[test]
    fn the_measured_reach_is_above_the_exact_one() {
        for twist in [0.0, 0.3] {
            let lattice = lattice(48, twist);
            let near_null = NearNullSpace::constants(lattice.stiffness()).unwrap();
            let multigrid = Multigrid::new(lattice.stiffness(), &near_null, 1).unwrap();
            let norm = EnergyNorm::of(lattice.stiffness(), lattice.contact()).unwrap().unwrap();
            let smooth = norm.displacement(lattice.load());
            let stiffness = multigrid.preconditioning(lattice.stiffness());
            let least = stiffness.dual_norm(lattice.load(), &Watch::default()).unwrap().ritz;
            let reach = measured_reach(&lattice, (&multigrid, least), &smooth, &Watch::default()).unwrap();
            let exact = exact(&lattice, &norm);
            assert!(reach.iter().zip(&exact).all(|(reach, exact)| reach >= exact && *reach < 100.0 * exact));
            // Every row has the coefficient 2 and the stiffness d. The first step of the power iteration is at the
            // smooth displacement itself, which is close to the softest motion: the others add little.
            let d = 4.0 + 2.0 * twist;
            let force: Vec<f64> = smooth.iter().map(|value| d * value).collect();
            let quotient = dot(&force, &multigrid.cycle(&force)) / dot(&force, &smooth);
            let share = reach[0] * reach[0] * least * d / (4.0 * SAFETY * quotient);
            assert!((1.0 - 1e-9..1.1).contains(&share), "{share}");
        }
    }

    #[test]
    fn rows_are_within_reach_by_the_selected_inverse_exactly_where_they_are() {
        let lattice = lattice(14, 0.3);
        let norm = EnergyNorm::of(lattice.stiffness(), lattice.contact()).unwrap().unwrap();
        let compliance = ComplianceFactor::of(&lattice, &norm);
        let exact = exact(&lattice, &norm);
        assert!(exact.len() as f64 * compliance.sweep() > FACTORISATIONS * norm.cholesky.multiplications() / BLOCKED);
        let limits = |share: f64| exact.iter().map(|reach| share * reach).enumerate().collect::<Vec<_>>();
        assert_eq!(within_reach(&compliance, &limits(1.0 + 1e-5)).len(), exact.len());
        assert!(within_reach(&compliance, &limits(1.0 - 1e-5)).is_empty());
        assert!(least_reach(&lattice).iter().zip(&exact).all(|(least, exact)| least < exact && 2.0 * least > *exact));
    }

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
        let known = alone.clone().lending(problem.contact());
        let [alone, known] = [&alone, &known].map(|norm| ComplianceFactor::of(&problem, norm));
        assert!(known.rows.compliance.is_kept() && !alone.rows.compliance.is_kept());
        let all: Vec<usize> = (0..4).collect();
        let lengths = [&alone, &known].map(|of| of.moved_together(&all));
        let reach = known.reach_at_once().unwrap();
        for row in all {
            assert!((reach[row] / alone.reach(row) - 1.0).abs() < 1e-14, "{row}: {reach:?}");
            assert!((lengths[1][row] / lengths[0][row] - 1.0).abs() < 1e-12, "{row}: {lengths:?}");
        }
    }

    #[test]
    fn the_reach_at_once_is_the_sum_of_the_ways_of_the_dofs_of_a_row() {
        // Each dof moves by 1/2 for an energy norm of one; both together move the row by the root of 1/2.
        let row = [(0, 0, 1.0), (0, 1, 1.0)];
        let problem = ContactProblem::of_entries(&[(0, 0, 4.0), (1, 1, 4.0)], &[0.0; 2], &row, &[3.0]);
        let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
        let compliance = ComplianceFactor::of(&problem, &norm);
        assert_eq!(compliance.reach_at_once().unwrap(), [norm.rounding()]);
        assert!((compliance.reach(0) / norm.rounding() - 0.5_f64.sqrt()).abs() < 1e-15);
        // Three rows on two dofs: nine products of two terms, and a triangle of three.
        assert_eq!(compliance.work(3), 45.0);
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
            // Each column may be off by its rounding; a column of length one has at most two in the inverse.
            let rounding = 2.0 * dofs as f64 * norm.rounding_of_column();
            for length in compliance.moved_together(&all) {
                let share = length / norm.rounding() / (0.75_f64).sqrt() - 1.0;
                assert!((-1e-13..1e-13 + rounding).contains(&share), "{length} of {dofs}");
            }
        }
    }
}
