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

use super::EnergyNorm;
use super::proof::ComplianceFactor;
use crate::linear::multigrid::Multigrid;
use crate::linear::selected_inverse::FACTORISATIONS;
use crate::linear::watch::Watch;
use crate::linear::{dot, largest};
use crate::problem::ContactProblem;

/// Steps of power iteration for the largest eigenvalue of M D.
const POWER_STEPS: usize = 3;

/// Possible error, as a factor, of the quotient of two measured eigenvalues.
const SAFETY: f64 = 4.0;

/// Rounding of an entry of K w, relative to the sum of its terms, is at most this for each term.
const OF_TERM: f64 = 2.0 * f64::EPSILON;

/// Number of multiplications of a blocked factorisation that take the time of one in a sweep.
const BLOCKED: f64 = 4.0;

impl ContactProblem {
    /// Upper bounds on `sqrt(G_ii)` of every row, from one solve: `solve(s)` returns about `K^-1 s`. `None` if that
    /// does not show that K is an M-matrix.
    pub(super) fn monotone_reach(&self, solve: impl FnOnce(&[f64]) -> Option<Vec<f64>>) -> Option<Vec<f64>> {
        if self.stiffness().lower().triplets().any(|(row, column, value)| row != column && value > 0.0) {
            return None;
        }
        // On a unit diagonal the right-hand side is one everywhere.
        let load: Vec<f64> = self.stiffness().diagonal().iter().map(|value| value.sqrt()).collect();
        let w = solve(&load)?;
        if load.iter().chain(&w).any(|&value| !(value > 0.0 && value.is_finite())) {
            return None;
        }
        let terms = self.stiffness().mul_abs(&w);
        let rounding = OF_TERM * self.dofs() as f64;
        let sure = self.stiffness().mul(&w).into_iter().zip(terms).map(|(sum, terms)| sum - rounding * terms);
        let kappa = sure.zip(&load).map(|(sum, s)| sum / s).fold(f64::INFINITY, f64::min);
        if kappa.is_nan() || kappa <= 0.0 {
            return None;
        }
        let roots: Vec<f64> = w.iter().zip(&load).map(|(w, s)| (w / (s * kappa)).sqrt()).collect();
        Some(self.contact().mul_abs(&roots))
    }

    /// The largest eigenvalue of M D, with the cycle M and `D = diag K`, by power iteration that starts at the smooth
    /// `displacement`. `None` if the iteration does not settle.
    pub(super) fn largest_eigenvalue(&self, multigrid: &Multigrid, displacement: &[f64], watch: &Watch) -> Option<f64> {
        let diagonal = self.stiffness().diagonal();
        if diagonal.iter().any(|&value| value <= 0.0) {
            return None;
        }
        let mut x = displacement.to_vec();
        let mut quotient = 0.0_f64;
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
        Some(quotient)
    }

    /// Upper bounds on `sqrt(G_ii)` of every row from two measured eigenvalues: with the cycle M and `D = diag K`,
    ///
    /// ```text
    /// K^-1 <= M / least(M K),     M <= largest(M D) D^-1
    /// ```
    pub(super) fn measured_reach(&self, least: f64, largest: f64) -> Vec<f64> {
        let mu = least / (SAFETY * largest);
        let squares = self.compliance_of_rows(|square, stiffness| square / stiffness);
        squares.into_iter().map(|square| (square / mu).sqrt()).collect()
    }

    /// Lower bounds on `sqrt(G_ii)` of every row, `max |b_ij| / sqrt(K_jj)` over the dofs with stiffness: the distance
    /// by which unit energy norm of a single dof moves it.
    pub(super) fn least_reach(&self) -> Vec<f64> {
        let (roots, mut least) = (&self.diagonal().roots, vec![0.0_f64; self.rows()]);
        for (dof, &root) in roots.iter().enumerate().filter(|entry| *entry.1 > 0.0) {
            self.contact().with_rows(dof, &mut least, |least, b| *least = least.max(b.abs() / root));
        }
        least
    }

    /// The sum over the entries b of each row of `of_entry(b^2, K_jj)`, the compliance of a row if its dofs stand
    /// alone.
    pub(super) fn compliance_of_rows(&self, of_entry: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let mut compliance = vec![0.0; self.rows()];
        for (dof, &stiffness) in self.diagonal().values.iter().enumerate() {
            self.contact().with_rows(dof, &mut compliance, |sum, b| {
                if b != 0.0 {
                    *sum += of_entry(b * b, stiffness);
                }
            });
        }
        compliance
    }

    /// The rows of `rows` with a `sqrt(G_ii)` below their limit, by sweeps or by the selected inverse, whichever costs
    /// less.
    pub(super) fn within_reach(
        &self,
        norm: &EnergyNorm,
        compliance: &ComplianceFactor,
        rows: &[(usize, f64)],
    ) -> Vec<usize> {
        let by_sweeps = rows.len() as f64 * compliance.sweep();
        let at_once = FACTORISATIONS * norm.cholesky.multiplications() / BLOCKED;
        let one_by_one = by_sweeps <= at_once || norm.is_over();
        let inverse = if one_by_one { None } else { norm.cholesky.selected_inverse() };
        let inverse = inverse.map(|inverse| (inverse, norm.rows_in_body(self.contact())));
        let reach = |row: usize| {
            let square =
                inverse.as_ref().and_then(|(inverse, by_row)| inverse.product(&by_row.column(row).collect::<Vec<_>>()));
            let of_square = |square: f64| norm.length(norm.rounding() * square.max(0.0));
            square.map_or_else(|| compliance.reach(row), of_square)
        };
        rows.iter().filter(|&&(row, limit)| reach(row) < limit).map(|&(row, _)| row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
            let reach = alone.monotone_reach(solve).unwrap();
            for (reach, exact) in reach.iter().zip([1.0, 2.0, 4.0]) {
                assert!((reach / exact - 1.0).abs() < 1e-14, "{reach} {exact}");
            }
        }
    }

    #[test]
    fn the_reach_by_one_solve_is_above_the_exact_one_and_needs_an_m_matrix() {
        let lattice = lattice(14, 0.0);
        let norm = EnergyNorm::of(lattice.stiffness(), lattice.contact()).unwrap().unwrap();
        let reach = lattice.monotone_reach(|s| Some(norm.displacement(s))).unwrap();
        let exact = exact(&lattice, &norm);
        assert!(reach.iter().zip(&exact).all(|(reach, exact)| reach >= exact && *reach < 20.0 * exact));
        let twisted = super::tests::lattice(14, 0.3);
        assert!(twisted.monotone_reach(|s| Some(s.to_vec())).is_none());
        // K w with a negative entry shows nothing.
        assert!(
            lattice
                .monotone_reach(|s| Some(s.iter().enumerate().map(|(i, s)| s * (1.0 + (i % 2) as f64)).collect()))
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
            let largest = lattice.largest_eigenvalue(&multigrid, &smooth, &Watch::default()).unwrap();
            let reach = lattice.measured_reach(least, largest);
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
        assert_eq!(lattice.within_reach(&norm, &compliance, &limits(1.0 + 1e-5)).len(), exact.len());
        assert!(lattice.within_reach(&norm, &compliance, &limits(1.0 - 1e-5)).is_empty());
        assert!(lattice.least_reach().iter().zip(&exact).all(|(least, exact)| least < exact && 2.0 * least > *exact));
    }
}
