//! Transforms of a contact problem into one that is easier to solve, each with its inverse transform.

mod elimination;

pub use elimination::Elimination;

use std::sync::OnceLock;

use crate::error::{LinearError, Result};
use crate::linear::{
    Analysis, Cholesky, Equilibration, FactorError, LowerTriangle, SparseMatrix, SymmetricMatrix, dot, exponent, ldexp,
};
use crate::problem::ContactProblem;
use crate::solution::ContactSet;

/// The rows that can close: those with an obstacle (finite gap) and with a dof to move.
#[derive(Clone, Debug, PartialEq)]
pub struct RowSelection {
    rows: usize,
    /// The index of each selected row in the original problem.
    pub kept: Vec<usize>,
}

impl RowSelection {
    pub fn of(problem: &ContactProblem) -> Self {
        let (gap, mut acts) = (problem.gap(), vec![true; problem.rows()]);
        problem.without_entries.iter().for_each(|&row| acts[row] = false);
        RowSelection {
            rows: gap.len(),
            kept: (0..gap.len()).filter(|&row| gap[row].is_finite() && acts[row]).collect(),
        }
    }

    pub fn contact(&self, contact: &SparseMatrix) -> SparseMatrix {
        if self.kept.len() == self.rows { contact.clone() } else { contact.select_rows(&self.kept) }
    }

    pub fn gap(&self, gap: &[f64]) -> Vec<f64> {
        self.kept.iter().map(|&row| gap[row]).collect()
    }

    /// Multipliers of all rows from those of the selected ones: a row that cannot close carries none.
    pub fn expand_multiplier(&self, multiplier: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.rows];
        for (&row, &value) in self.kept.iter().zip(multiplier) {
            all[row] = value;
        }
        all
    }

    pub fn expand_set(&self, set: &ContactSet) -> ContactSet {
        let mut all = ContactSet::open(self.rows);
        set.iter().for_each(|row| all.insert(self.kept[row]));
        all
    }

    pub fn restrict_set(&self, set: &ContactSet) -> ContactSet {
        ContactSet::from_fn(self.kept.len(), |row| set.contains(self.kept[row]))
    }
}

/// Pieces of a problem that no entry of K and no row with an obstacle couples.
#[derive(Debug)]
pub struct Pieces {
    /// The piece of each dof, and of each row, with its number there.
    of_dof: Vec<(usize, usize)>,
    of_row: Vec<(usize, usize)>,
    /// The dofs, and the rows, of each piece, in increasing order.
    pub dofs: Vec<Vec<usize>>,
    pub rows: Vec<Vec<usize>>,
}

impl Pieces {
    /// The pieces of `problem`, given by the piece of each of its parts, from 0 to `count - 1`.
    pub fn of(problem: &ContactProblem, of_part: &[usize], count: usize) -> Self {
        let parts = problem.parts();
        let (of_dof, dofs) = members(parts.of_dof.iter().map(|&part| of_part[part]), count);
        let (of_row, rows) = members((0..problem.rows()).map(|row| of_part[parts.of_row[row]]), count);
        Pieces { of_dof, of_row, dofs, rows }
    }

    pub fn count(&self) -> usize {
        self.dofs.len()
    }

    pub fn problem(&self, problem: &ContactProblem, piece: usize) -> Result<ContactProblem> {
        let (dofs, rows) = (&self.dofs[piece], &self.rows[piece]);
        let columns = |matrix: &SparseMatrix, of: &[(usize, usize)], count: usize| {
            matrix.select(count, |row| (of[row].0 == piece).then_some(of[row].1), dofs.iter().copied())
        };
        let lower = columns(problem.stiffness().lower(), &self.of_dof, dofs.len());
        let contact = columns(problem.contact(), &self.of_row, rows.len());
        let load = dofs.iter().map(|&dof| problem.load()[dof]).collect();
        let gap = rows.iter().map(|&row| problem.gap()[row]).collect();
        let own = ContactProblem::computed(SymmetricMatrix::from_lower(lower)?, load, contact, gap)?;
        own.with_near_null_of(problem, |mode| dofs.iter().map(|&dof| mode[dof]).collect())
    }

    /// The set of all rows, from those of the pieces; a piece without a set has none.
    pub fn join_sets<'a>(&self, of_pieces: impl Iterator<Item = Option<&'a ContactSet>>) -> ContactSet {
        let of_pieces: Vec<_> = of_pieces.collect();
        let is_in = |&(piece, place): &(usize, usize)| of_pieces[piece].is_some_and(|set| set.contains(place));
        self.of_row.iter().map(is_in).collect()
    }
}

/// The number of each member within its piece, and the members of each piece.
fn members(of_member: impl Iterator<Item = usize>, count: usize) -> (Vec<(usize, usize)>, Vec<Vec<usize>>) {
    let mut members = vec![Vec::new(); count];
    let place = |(member, piece): (usize, usize)| {
        members[piece].push(member);
        (piece, members[piece].len() - 1)
    };
    let places = of_member.enumerate().map(place).collect();
    (places, members)
}

/// One value for each dof or row, from those of the pieces.
pub fn joined<'a>(members: &[Vec<usize>], of_pieces: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
    let mut all = vec![0.0; members.iter().map(Vec::len).sum()];
    for (members, values) in members.iter().zip(of_pieces) {
        members.iter().zip(values).for_each(|(&member, &value)| all[member] = value);
    }
    all
}

/// Powers of two with exponents up to this size are doubles that lose no digit.
const SURE: i32 = 1000;

/// The scaling of a body and its contact rows to dimensionless data of order one, with its inverse.
///
/// With a reference displacement u0 and the equilibration `c D K D` of the stiffness:
///
/// ```text
/// u = u0 D v,   K~ = c D K D,   f~ = c D f / u0,   B~ = R B D,   g~ = R g / u0,   lambda = (u0 / c) R mu
/// ```
///
/// D reduces a stiffness contrast inside the body, R gives every contact row a largest entry near one. All factors are
/// powers of two: the scaled problem is the same problem in other units, bit by bit. u0 belongs to a load and a gap;
/// the rest belongs to the body and is computed once.
#[derive(Clone, Debug)]
pub struct Scaling {
    pub equilibration: Equilibration,
    /// Exponent of each entry of R.
    pub row_exponents: Vec<i32>,
    /// The original stiffness, and the scaled one, which is computed at its first use.
    unscaled: SymmetricMatrix,
    stiffness: OnceLock<SymmetricMatrix>,
    pub contact: SparseMatrix,
}

/// The exponent of the largest entry of each row of B D, with the exponents `d` of D; zero for a row of zeros.
fn largest_exponents(contact: &SparseMatrix, d: &[i32]) -> Vec<i32> {
    let mut sizes = vec![0.0_f64; contact.rows()];
    for (dof, &of_dof) in d.iter().enumerate() {
        let power = ldexp(1.0, of_dof);
        contact.with_rows(dof, &mut sizes, |size, value| {
            *size = if value.abs() * power > *size { value.abs() * power } else { *size }
        });
    }
    if sizes.iter().all(|size| size.is_normal()) && d.iter().all(|d| d.abs() <= SURE) {
        return sizes.into_iter().map(exponent).collect();
    }
    // A product may have left the range of doubles.
    let mut largest = vec![None; contact.rows()];
    for (dof, &of_dof) in d.iter().enumerate() {
        let entries = contact.column(dof).filter(|entry| entry.1 != 0.0);
        entries.for_each(|(row, value)| largest[row] = largest[row].max(Some(exponent(value) + of_dof)));
    }
    largest.into_iter().map(|exponent| exponent.unwrap_or(0)).collect()
}

impl Scaling {
    pub fn of(stiffness: &SymmetricMatrix, contact: &SparseMatrix) -> Result<Self> {
        let equilibration = Equilibration::of(stiffness);
        let d = &equilibration.diagonal;
        let row_exponents: Vec<i32> = largest_exponents(contact, d).into_iter().map(|e| -e).collect();
        let contact = contact.times_powers(&row_exponents, |dof| d[dof]);
        if let Some((place, &value)) = contact.values().iter().enumerate().find(|entry| !entry.1.is_finite()) {
            let at = contact.triplets().nth(place).map_or_else(String::new, |(row, dof, _)| format!("({row}, {dof})"));
            return Err(LinearError::NotFinite { name: "matrix", at, value, allowed: "finite" }.into());
        }
        Ok(Scaling { equilibration, row_exponents, unscaled: stiffness.clone(), stiffness: OnceLock::new(), contact })
    }

    pub fn stiffness(&self) -> &SymmetricMatrix {
        self.stiffness.get_or_init(|| self.equilibration.apply(&self.unscaled))
    }

    /// The diagonal matrix, length n, that the scaling makes `2^exponent` times the identity.
    pub fn identity(&self, exponent: i32) -> Vec<f64> {
        let Equilibration { factor, diagonal } = &self.equilibration;
        diagonal.iter().map(|d| ldexp(1.0, exponent - factor - 2 * d)).collect()
    }

    /// The scaled load for u0 = `2^unit`.
    pub fn load(&self, load: &[f64], unit: i32) -> Vec<f64> {
        let exponent = self.equilibration.factor - unit;
        load.iter().zip(&self.equilibration.diagonal).map(|(&f, &d)| ldexp(f, d + exponent)).collect()
    }

    pub fn gap(&self, gap: &[f64], unit: i32) -> Vec<f64> {
        gap.iter().zip(&self.row_exponents).map(|(&g, &r)| ldexp(g, r - unit)).collect()
    }

    pub fn expand_displacement(&self, scaled: &[f64], unit: i32) -> Vec<f64> {
        scaled.iter().zip(&self.equilibration.diagonal).map(|(&v, &d)| ldexp(v, d + unit)).collect()
    }

    pub fn multiplier(&self, multiplier: &[f64], unit: i32) -> Vec<f64> {
        let exponent = self.equilibration.factor - unit;
        multiplier.iter().zip(&self.row_exponents).map(|(&lambda, &r)| ldexp(lambda, exponent - r)).collect()
    }

    pub fn expand_multiplier(&self, scaled: &[f64], unit: i32) -> Vec<f64> {
        let exponent = unit - self.equilibration.factor;
        scaled.iter().zip(&self.row_exponents).map(|(&mu, &r)| ldexp(mu, r + exponent)).collect()
    }
}

/// If contact dofs exceed this share of all, condensing removes too little.
const LARGEST_SHARE: f64 = 0.25;

/// A dense factorisation on the contact dofs may cost this many times the estimate for the sparse one, which is low.
const DENSE_WORK: f64 = 3.0;

/// A difference below this share of its terms is rounding: the factorisation of a large body loses a few digits.
const LEFT_OVER: f64 = 1e-12;

/// The stiffness condensed onto the dofs in contact rows, by one Cholesky factorisation, with the way back.
///
/// With the contact dofs t ordered last in K = L L':
///
/// ```text
/// S = K_tt - K_ti K_ii^-1 K_it = L_tt L_tt'      the stiffness that the contact boundary feels
/// y = L^-1 f,  f_c = L_tt y_t                     the load that reaches it
/// L' u = (y_i, L_tt' u_t)                         the way back to the whole body
/// ```
///
/// A body that only its contact rows hold has a singular K. In that case `K + B'B` is factorised; its Schur complement
/// is `S + B_t'B_t`: the interior blocks, and so both sweeps, are the same.
#[derive(Clone, Debug)]
pub struct Condensation {
    /// The contact dofs, in increasing order.
    pub contact_dofs: Vec<usize>,
    cholesky: Cholesky,
    trailing: LowerTriangle,
    pub stiffness: SymmetricMatrix,
    pub contact: SparseMatrix,
}

impl Condensation {
    /// The analysis of `stiffness` with the contact dofs last, or `None` if condensing onto them does not pay.
    pub fn analyse(stiffness: &SymmetricMatrix, contact_dofs: &[usize]) -> Result<Option<Analysis>, FactorError> {
        let (dim, count) = (stiffness.dim() as f64, contact_dofs.len() as f64);
        if !Self::pays(count, dim, f64::INFINITY) {
            return Ok(None);
        }
        let analysis = Analysis::sparse_with_last(stiffness, contact_dofs)?;
        let interior_entries = (analysis.factor_entries() as f64 - count * count / 2.0).max(0.0);
        Ok(Self::pays(count, dim, interior_entries).then_some(analysis))
    }

    /// Returns `true` if the dense factorisation on `count` contact dofs of `dim` costs little beside that of the
    /// interior, whose factor has `interior_entries` values. Whether the dense matrices fit is a question of memory.
    pub fn pays(count: f64, dim: f64, interior_entries: f64) -> bool {
        // The work of the interior is at least the square of its entries over its columns.
        let interior_work = interior_entries * interior_entries / (dim - count);
        count > 0.0 && count <= LARGEST_SHARE * dim && count.powi(3) / 3.0 <= DENSE_WORK * interior_work
    }

    /// Condenses by a factor of K, or of K + B'B if it `holds_rows`, which are then subtracted, with `contact_dofs`
    /// last.
    pub fn new(cholesky: Cholesky, holds_rows: bool, contact_dofs: Vec<usize>, contact: &SparseMatrix) -> Result<Self> {
        let contact = contact.select(contact.rows(), Some, contact_dofs.iter().copied());
        let trailing = cholesky.trailing_block();
        let mut schur = trailing.times_transpose();
        if holds_rows {
            subtract_rows(&mut schur, &contact);
        }
        let stiffness = SymmetricMatrix::from_lower(dense_triangle(&schur, contact_dofs.len())?)?;
        Ok(Condensation { contact_dofs, cholesky, trailing, stiffness, contact })
    }

    pub fn factor_entries(&self) -> usize {
        self.cholesky.entries()
    }

    /// The forward sweep y of a load, to be kept for [`load`](Self::load) and [`expand`](Self::expand).
    pub fn sweep(&self, load: &[f64]) -> Vec<f64> {
        // Many bodies are loaded by their obstacle alone.
        if load.iter().all(|&force| force == 0.0) { load.to_vec() } else { self.cholesky.forward(load) }
    }

    /// The condensed load L_tt y_t.
    pub fn load(&self, sweep: &[f64]) -> Vec<f64> {
        let size = self.contact_dofs.len();
        self.trailing.mul(&sweep[sweep.len() - size..])
    }

    /// The square of the energy norm that the load alone adds inside the body.
    pub fn interior_energy(&self, sweep: &[f64]) -> f64 {
        let interior = &sweep[..sweep.len() - self.contact_dofs.len()];
        dot(interior, interior)
    }

    /// The displacement of the contact dofs that the load alone causes, if K is definite.
    pub fn free_displacement(&self, sweep: &[f64]) -> Vec<f64> {
        let size = self.contact_dofs.len();
        self.trailing.backward(sweep[sweep.len() - size..].to_vec())
    }

    pub fn expand(&self, sweep: &[f64], displacement: &[f64]) -> Vec<f64> {
        let size = self.contact_dofs.len();
        let first = sweep.len() - size;
        let mut y = sweep.to_vec();
        y[first..].copy_from_slice(&self.trailing.mul_transposed(displacement));
        let mut expanded = self.cholesky.backward(y);
        // The sweep gives these values back except for rounding.
        self.contact_dofs.iter().zip(displacement).for_each(|(&dof, &u)| expanded[dof] = u);
        expanded
    }
}

fn subtract_rows(schur: &mut [f64], contact: &SparseMatrix) {
    let (before, by_row) = (schur.to_vec(), contact.transposed());
    for (i, j, product) in (0..contact.rows()).flat_map(|row| by_row.square(row)) {
        schur[j * contact.columns() + i] -= product;
    }
    // The difference of equal terms is rounding, and would hold a body that nothing holds.
    for (entry, before) in schur.iter_mut().zip(&before) {
        if entry.abs() <= LEFT_OVER * before.abs() {
            *entry = 0.0;
        }
    }
}

/// The lower triangle of a dense matrix (n x n, column by column), zeros included.
fn dense_triangle(matrix: &[f64], size: usize) -> Result<SparseMatrix> {
    let places = || (0..size).flat_map(|column| (column..size).map(move |row| (row, column)));
    let values: Vec<f64> = places().map(|(row, column)| matrix[column * size + row]).collect();
    if let Some(&value) = values.iter().find(|value| !value.is_finite()) {
        let at = "the condensed stiffness".to_string();
        return Err(LinearError::NotFinite { name: "matrix", at, value, allowed: "finite" }.into());
    }
    let starts = (0..=size).map(|column| column * (2 * size - column + 1) / 2).collect();
    Ok(SparseMatrix::from_parts(size, starts, places().map(|(row, _)| row as u32).collect(), values))
}
