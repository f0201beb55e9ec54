//! The problem as the least distance to a polyhedron, and the basis of its closed rows.
//!
//! With K = L L' and w = L' u the problem is to find the point of `C w <= g`, `C = B L^-T`, nearest to `h = L^-1 f`.
//! Dofs are scaled by `diag(K)^-1/2` and rows by `1 / |L^-1 b|`, both rounded to powers of two, so that lengths are
//! energies and the rows have about the same length.

use std::cell::Cell;

use crate::error::Result;
use crate::linear::{
    Accumulator, AugmentedMatrix, Cholesky, Equilibration, SparseMatrix, UpperTriangle, dot, exponent, if_definite,
    largest, ldexp, norm, subtract, turned,
};
use crate::method::{Ending, ScaledProblem};
use crate::problem::ContactProblem;
use crate::solution::ContactSet;

/// Weight of the proximal term `1/2 weight |u - u_k|^2` that makes a semidefinite K, with a diagonal between 1 and 4,
/// definite. With 1e-6 the same number of problems is solved, with 1 about half.
const PROXIMAL: f64 = 1e-9;

/// Multiplications that the method may cost: about a minute on one core.
const MOST_WORK: f64 = 5e10;

/// Values of an orthonormal basis that may be kept: 400 MB.
const MOST_VALUES: usize = 50_000_000;

/// The scaled problem with the factor L of its stiffness.
#[derive(Debug)]
pub struct Polyhedron {
    pub problem: ContactProblem,
    /// B', with the rows as columns.
    by_row: SparseMatrix,
    /// L of K, or of K with the proximal term: `L^-1 r` of a force r, and u = L^-T w.
    pub factor: Cholesky,
    /// `|L^-1 b|` of each row b.
    pub lengths: Vec<f64>,
    /// `|L^-1 f|`.
    pub reach: f64,
    equilibration: Equilibration,
    scales: Vec<i32>,
    work: Cell<f64>,
}

impl Polyhedron {
    /// The polyhedron of a problem; `None` if its factorisation fails or would take too many sweeps.
    pub fn of(scaled: &ScaledProblem) -> Result<Option<Self>> {
        let of = scaled.problem;
        let equilibration = Equilibration::of(of.stiffness());
        let stiffness = equilibration.apply(of.stiffness());
        let no_rows = SparseMatrix::from_triplets(0, of.dofs(), &[])?;
        let body = AugmentedMatrix::new(&stiffness, &no_rows, None)?;
        let factor_with = |weight: f64| if_definite(body.factor(body.matrix(|_| 0.0, weight)));
        let mut factor = if scaled.is_definite { factor_with(0.0)? } else { None };
        if factor.is_none() {
            factor = factor_with(PROXIMAL)?;
        }
        let Some(factor) = factor else { return Ok(None) };
        if (of.rows() * factor.entries()) as f64 > MOST_WORK {
            return Ok(None);
        }
        let of_dof = |dof: usize| equilibration.diagonal[dof];
        let by_row = of.contact().times_powers(&vec![0; of.rows()], of_dof).transposed();
        let length = |row: usize| norm(&swept(&by_row, &factor, row));
        let lengths: Vec<f64> = (0..of.rows()).map(length).collect();
        let scales: Vec<i32> = lengths.iter().map(|&length| -exponent(length)).collect();
        let lengths = lengths.iter().zip(&scales).map(|(&length, &scale)| ldexp(length, scale)).collect();
        let contact = of.contact().times_powers(&scales, of_dof);
        let by_row = contact.transposed();
        let load = of.load().iter().zip(&equilibration.diagonal);
        let load: Vec<f64> = load.map(|(&f, &d)| ldexp(f, d + equilibration.factor)).collect();
        let gap = of.gap().iter().zip(&scales).map(|(&g, &scale)| ldexp(g, scale)).collect();
        let reach = norm(&factor.forward(&load));
        let problem = ContactProblem::computed(stiffness, load, contact, gap)?;
        let work = Cell::new((of.rows() * factor.entries()) as f64);
        Ok(Some(Polyhedron { problem, by_row, factor, lengths, reach, equilibration, scales, work }))
    }

    /// Adds the multiplications of a step with `closed` rows: `false` once there were too many.
    pub fn affords(&self, closed: usize) -> bool {
        let dofs = self.problem.dofs();
        self.work.set(self.work.get() + (4 * self.factor.entries() + 12 * dofs * closed) as f64);
        self.work.get() <= MOST_WORK && dofs * closed <= MOST_VALUES
    }

    /// The row c = L^-1 b of C, length n.
    pub fn row(&self, row: usize) -> Vec<f64> {
        swept(&self.by_row, &self.factor, row)
    }

    /// B'y for the rows' weights `y = weights + rest`, rounded once.
    pub fn force(&self, weights: &[f64], rest: &[f64]) -> Vec<f64> {
        let mut sums = Accumulator::new(&vec![0.0; self.problem.dofs()]);
        for (row, dof, b) in self.problem.contact().triplets() {
            sums.add_product(dof, b, weights[row]);
            sums.add_product(dof, b, rest[row]);
        }
        sums.into_sums()
    }

    /// The contradiction of these rows under `weights`, in the units of the unscaled problem.
    pub fn contradiction(&self, rows: Vec<usize>, weights: &[f64]) -> Ending {
        let weights = rows.iter().zip(weights).map(|(&row, &weight)| ldexp(weight, self.scales[row])).collect();
        Ending::Infeasible { rows, weights }
    }

    /// Displacements and multipliers in the units of the unscaled problem; `pressures` are `-lambda`.
    pub fn expand(&self, displacement: &[f64], pressures: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let of_row = |(&y, &scale): (&f64, &i32)| -ldexp(y.max(0.0), scale - self.equilibration.factor);
        let dofs = displacement.iter().zip(&self.equilibration.diagonal);
        (dofs.map(|(&v, &d)| ldexp(v, d)).collect(), pressures.iter().zip(&self.scales).map(of_row).collect())
    }
}

/// `L^-1 b` of a row b.
fn swept(by_row: &SparseMatrix, factor: &Cholesky, row: usize) -> Vec<f64> {
    let mut dense = vec![0.0; by_row.rows()];
    by_row.column(row).for_each(|(dof, b)| dense[dof] = b);
    factor.forward(&dense)
}

/// A row depends on the closed ones if its remainder is below this share of the row, times the size of its weights: the
/// remainder is then rounding. Any value between 1e-15 and 1e-5 gives the same sets on several thousand random
/// problems.
pub const DEPENDENT_ROW: f64 = 64.0 * f64::EPSILON;

/// A remainder that keeps this share of its length is orthogonal to Q to working precision.
const ORTHOGONAL_SHARE: f64 = 0.5;

/// Largest number of orthogonalisations of one row: two suffice unless the row depends on the others.
const MOST_TURNS: usize = 3;

/// The orthonormal basis of the closed rows in their order: `C_A' = Q R`, Q (n x k) and R (k x k), updated row by row.
///
/// A row that closes is orthogonalised against Q until it stays the same; a row that opens is removed by plane
/// rotations. Both cost `O(n k)` for k closed rows.
///
/// # Source
/// J. W. Daniel, W. B. Gragg, L. Kaufman, G. W. Stewart, 1976, "Reorthogonalization and stable algorithms for updating
/// the Gram-Schmidt QR factorization", Mathematics of Computation 30, pp. 772-795.
#[derive(Clone, Debug, Default)]
pub struct Basis {
    pub rows: Vec<usize>,
    /// The columns of Q.
    directions: Vec<Vec<f64>>,
    /// R.
    pub triangle: UpperTriangle,
}

/// A row c split by a basis: `c = Q along + across`.
#[derive(Clone, Debug)]
pub struct Split {
    along: Vec<f64>,
    /// The component orthogonal to the closed rows, length n.
    pub across: Vec<f64>,
    /// The weights r of the closed rows that give the rest as `C_A' r`.
    pub weights: Vec<f64>,
    /// `true` if `across` is rounding.
    pub depends: bool,
}

impl Basis {
    /// The closed rows as a set, `rows` being the number of all rows.
    pub fn set(&self, rows: usize) -> ContactSet {
        let mut closed = ContactSet::open(rows);
        self.rows.iter().for_each(|&row| closed.insert(row));
        closed
    }

    pub fn split(&self, c: &[f64]) -> Split {
        let length = norm(c);
        let (mut along, mut across, mut left) = (vec![0.0; self.rows.len()], c.to_vec(), length);
        for _ in 0..MOST_TURNS {
            let turn = self.along(&across);
            self.take_out(&turn, &mut across);
            along.iter_mut().zip(&turn).for_each(|(sum, part)| *sum += part);
            let before = left;
            left = norm(&across);
            if left >= ORTHOGONAL_SHARE * before {
                break;
            }
        }
        let weights = self.triangle.solve_upper(along.clone());
        let depends = left <= DEPENDENT_ROW * (1.0 + largest(&weights)) * length;
        Split { along, across, weights, depends }
    }

    pub fn close(&mut self, row: usize, split: Split) {
        let Split { along, mut across, .. } = split;
        let length = norm(&across);
        across.iter_mut().for_each(|entry| *entry /= length);
        self.rows.push(row);
        self.directions.push(across);
        self.triangle.push(along, length);
    }

    /// Opens the row at `place` of `rows`.
    pub fn open(&mut self, place: usize) {
        self.rows.remove(place);
        let directions = &mut self.directions;
        self.triangle.remove(place, |first, cosine, sine| {
            let (left, right) = directions.split_at_mut(first + 1);
            for (x, y) in left[first].iter_mut().zip(&mut right[0]) {
                (*x, *y) = turned(cosine, sine, *x, *y);
            }
        });
        self.directions.pop();
    }

    /// The point w (length n) nearest to `target` at which each closed row has its value in `values`, and the
    /// multipliers y of the closed rows with `w = target - C_A' y`.
    pub fn nearest(&self, target: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut excess = self.along(target);
        let wanted = self.triangle.solve_lower(values.to_vec());
        excess.iter_mut().zip(&wanted).for_each(|(along, wanted)| *along -= wanted);
        let mut point = target.to_vec();
        self.take_out(&excess, &mut point);
        (point, self.triangle.solve_upper(excess))
    }

    /// Q' x.
    pub fn along(&self, x: &[f64]) -> Vec<f64> {
        self.directions.iter().map(|direction| dot(direction, x)).collect()
    }

    fn take_out(&self, shares: &[f64], x: &mut [f64]) {
        for (direction, &share) in self.directions.iter().zip(shares) {
            subtract(x, share, direction);
        }
    }
}
