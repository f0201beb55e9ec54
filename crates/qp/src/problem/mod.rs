//! The contact problem as a convex QP, checked once.

mod given_rows;
mod structure;

pub(crate) use structure::{Equality, Parts};

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use structure::{Diagonal, OpposedRows, settle, without_entries};

use crate::error::{Error, LinearError, Result};
use crate::linear::equations::Following;
use crate::linear::multigrid::NearNullSpace;
use crate::linear::{Accumulator, SparseMatrix, SymmetricMatrix, check_finite, check_vector};

/// Frictionless unilateral contact as a convex quadratic program:
///
/// ```text
/// minimise 1/2 u'K u - f'u   subject to   B u - g <= 0
/// K u - f - B' lambda = 0,  B u - g <= 0,  lambda <= 0,  lambda_i (B u - g)_i = 0
/// ```
///
/// Shapes, finite values and symmetry are checked once, when it is built. The solve finds out whether K is positive
/// semidefinite, and whether supports and obstacle hold the body.
///
/// ```
/// use signorini_qp::{ContactProblem, SparseMatrix, SymmetricMatrix};
///
/// // Two springs of stiffness 2 and 1 in a row, pushed with the forces 2 and 3; the end meets a wall at distance 1.
/// let stiffness = SparseMatrix::from_triplets(2, 2, &[(0, 0, 3.0), (1, 0, -1.0), (1, 1, 1.0)])?;
/// let contact = SparseMatrix::from_triplets(1, 2, &[(0, 1, 1.0)])?;
/// let problem = ContactProblem::new(SymmetricMatrix::from_lower(stiffness)?, vec![2.0, 3.0], contact, vec![1.0])?;
///
/// assert_eq!((problem.dofs(), problem.rows()), (2, 1));
/// // At u = (1, 4) the end is 3 inside the wall.
/// assert_eq!(problem.violation(&[1.0, 4.0]), [3.0]);
/// // At u = (1, 1) the forces are in balance if the wall pushes back with 3: K u = (2, 0) = f + B' lambda.
/// assert!(problem.certify(&[1.0, 1.0], &[-3.0])?.meets(1e-12));
/// assert!(!problem.certify(&[1.0, 1.0], &[-2.0])?.meets(1e-2));
/// # Ok::<(), signorini_qp::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct ContactProblem {
    pub(crate) stiffness: SymmetricMatrix,
    pub(crate) load: Vec<f64>,
    pub(crate) contact: SparseMatrix,
    pub(crate) gap: Vec<f64>,
    near_null: Option<Arc<NearNullSpace>>,
    diagonal: FoundOnce<Diagonal>,
    semidefinite: FoundOnce<bool>,
    parts: FoundOnce<Parts>,
    free_motions: FoundOnce<usize>,
    opposed: FoundOnce<OpposedRows>,
    equalities: FoundOnce<Vec<Equality>>,
    /// The number of equality rows: the last rows are as many, and the same from the other side.
    equality_rows: usize,
    /// The equality rows that follow from others except for rounding, each after its value: they have no gap.
    following: Arc<[(f64, Following)]>,
    /// The rows without an entry, and those of them whose gaps were rounding, with these gaps.
    pub(crate) without_entries: Arc<[usize]>,
    rounded: Vec<(usize, f64)>,
    /// The rows that are equalities by themselves, with a multiplier of either sign: see `two_sided`.
    two_sided: Vec<bool>,
}

/// Data that follow from the matrices of a problem, and some also from which rows have an obstacle: computed at the
/// first use and shared by the same problem under other loads and gaps.
type FoundOnce<T> = Arc<OnceLock<T>>;

impl PartialEq for ContactProblem {
    /// Data that follow from equal data are equal.
    fn eq(&self, other: &Self) -> bool {
        let same_matrices = self.stiffness == other.stiffness && self.contact == other.contact;
        let same_vectors =
            self.load == other.load && self.gap == other.gap && self.equality_rows == other.equality_rows;
        same_matrices && same_vectors && self.near_null == other.near_null
    }
}

/// Forces of a mode below this share of their terms are rounding.
const FREE: f64 = 1e-9;

impl ContactProblem {
    /// The problem of stiffness K (n x n, in N/m), load f (length n, in N, along the positive axes), contact rows B (m
    /// x n, dimensionless) and initial gaps g (length m, in m). A row of B is positive towards the obstacle. A gap is
    /// negative if the obstacle starts inside the body and `f64::INFINITY`, or exactly 1e20 or 1e30, without an
    /// obstacle. The gap of a row without entries counts as zero if it is rounding beside the largest, see
    /// [`warnings`](Self::warnings).
    ///
    /// # Errors
    /// [`LinearError::Length`] and [`LinearError::Shape`] for sizes that do not fit, [`LinearError::NotFinite`] for a
    /// load that is not finite or a gap that is NaN or minus infinity, [`LinearError::NotConvex`] for a negative
    /// diagonal entry of K.
    pub fn new(
        stiffness: SymmetricMatrix,
        load: Vec<f64>,
        contact: SparseMatrix,
        gap: Vec<f64>,
    ) -> Result<Self, Error> {
        let mut problem = Self::computed(stiffness, load, contact, gap)?;
        problem.rounded = settle(&problem.without_entries, &mut problem.gap);
        Ok(problem)
    }

    /// The same for numbers that come from another problem: every finite gap is a length, and none is rounding.
    pub(crate) fn computed(
        stiffness: SymmetricMatrix,
        load: Vec<f64>,
        contact: SparseMatrix,
        gap: Vec<f64>,
    ) -> Result<Self> {
        let dofs = stiffness.dim();
        if contact.columns() != dofs {
            let (found, expected) = ((contact.rows(), contact.columns()), (contact.rows(), dofs));
            return Err(LinearError::Shape { name: "contact matrix", found, expected }.into());
        }
        check_load(&load, dofs)?;
        check_gap(&gap, contact.rows())?;
        if let Some((dof, value)) = stiffness.diagonal().iter().enumerate().find(|entry| *entry.1 < 0.0) {
            return Err(LinearError::NotConvex {
                evidence: format!("diagonal entry {dof} is {value:e}, indices from 0"),
            }
            .into());
        }
        let without_entries: Arc<[usize]> = without_entries(&contact).into();
        Ok(ContactProblem {
            stiffness,
            load,
            contact,
            gap,
            near_null: None,
            diagonal: FoundOnce::default(),
            semidefinite: FoundOnce::default(),
            parts: FoundOnce::default(),
            free_motions: FoundOnce::default(),
            opposed: FoundOnce::default(),
            equalities: FoundOnce::default(),
            equality_rows: 0,
            following: Arc::new([]),
            without_entries,
            rounded: Vec::new(),
            two_sided: Vec::new(),
        })
    }

    /// The same problem with the near-null space of its body for multigrid: displacements of almost no energy, such as
    /// the rigid-body modes.
    ///
    /// # Errors
    /// [`LinearError::Length`] if they are for another number of dofs.
    pub fn with_near_null(self, near_null: impl Into<Arc<NearNullSpace>>) -> Result<Self, Error> {
        let near_null = near_null.into();
        let (found, expected) = (near_null.dofs(), self.dofs());
        if found != expected {
            return Err(LinearError::Length { name: "near-null vector", found, expected, of: "dofs" }.into());
        }
        Ok(ContactProblem { near_null: Some(near_null), free_motions: FoundOnce::default(), ..self })
    }

    /// The same with the near-null space of another problem, each vector made one `of` these dofs unless it vanishes.
    pub(crate) fn with_near_null_of(self, other: &Self, of: impl Fn(&[f64]) -> Vec<f64>) -> Result<Self> {
        let vectors = other.near_null().map_or(&[][..], |modes| modes.vectors()).iter().map(|mode| of(mode));
        let moves = |mode: &Vec<f64>| mode.iter().any(|&value| value != 0.0);
        match NearNullSpace::of_modes(vectors.filter(moves).collect()) {
            Some(modes) => self.with_near_null(modes),
            None => Ok(self),
        }
    }

    /// The near-null space, if one was given.
    pub fn near_null(&self) -> Option<&Arc<NearNullSpace>> {
        self.near_null.as_ref()
    }

    /// Number of dofs n.
    pub fn dofs(&self) -> usize {
        self.load.len()
    }

    /// Number of rows: m of B, and two for each equality row.
    pub fn rows(&self) -> usize {
        self.gap.len()
    }

    /// The stiffness K (n x n), in N/m.
    pub fn stiffness(&self) -> &SymmetricMatrix {
        &self.stiffness
    }

    /// The external load f, length n, in N, along the positive axes.
    pub fn load(&self) -> &[f64] {
        &self.load
    }

    /// The contact rows B (m x n), dimensionless, positive towards the obstacle.
    pub fn contact(&self) -> &SparseMatrix {
        &self.contact
    }

    /// The initial gaps g, length m, in m; negative if the obstacle starts inside the body.
    pub fn gap(&self) -> &[f64] {
        &self.gap
    }

    /// The same body and obstacle with other gaps, length m, in m; negative if the obstacle starts inside the body.
    ///
    /// # Errors
    /// As [`ContactProblem::new`].
    pub fn with_gap(&self, gap: Vec<f64>) -> Result<Self, Error> {
        self.with(self.load.clone(), gap)
    }

    /// The same body and obstacle under another load, length n, in N, along the positive axes.
    ///
    /// # Errors
    /// As [`ContactProblem::new`].
    pub fn with_load(&self, load: Vec<f64>) -> Result<Self, Error> {
        self.with(load, self.gap.clone())
    }

    /// The same body and contact rows with another load (length n, in N) and other gaps (length m, in m, negative
    /// inside the body); the matrices are shared.
    ///
    /// # Errors
    /// As [`ContactProblem::new`].
    pub fn with(&self, load: Vec<f64>, gap: Vec<f64>) -> Result<Self, Error> {
        check_load(&load, self.dofs())?;
        let mut gap = self.gaps_of_all_rows(gap);
        check_gap(&gap, self.rows())?;
        let rounded = settle(&self.without_entries, &mut gap);
        let mut problem = ContactProblem { load, gap, rounded, ..self.clone() };
        let same_rows = problem.gap.iter().zip(&self.gap).all(|(gap, before)| gap.is_finite() == before.is_finite());
        if !same_rows {
            (problem.parts, problem.free_motions) = (FoundOnce::default(), FoundOnce::default());
        }
        if problem.gap != self.gap {
            problem.equalities = FoundOnce::default();
        }
        Ok(problem)
    }

    pub(crate) fn diagonal(&self) -> &Diagonal {
        self.diagonal.get_or_init(|| {
            let values = self.stiffness.diagonal();
            Diagonal { roots: values.iter().map(|value| value.sqrt()).collect(), values }
        })
    }

    /// Returns `true` if K is positive semidefinite, to rounding. One factorisation, at the first use.
    pub(crate) fn is_semidefinite(&self) -> Result<bool> {
        if let Some(&found) = self.semidefinite.get() {
            return Ok(found);
        }
        let found = self.stiffness.is_semidefinite()?;
        Ok(*self.semidefinite.get_or_init(|| found))
    }

    /// The dofs without stiffness, in increasing order.
    pub(crate) fn without_stiffness(&self) -> Vec<usize> {
        (0..self.dofs()).filter(|&dof| self.diagonal().values[dof] == 0.0).collect()
    }

    /// The motions of whole bodies without energy that contact joins: the most of any part. A motion is a vector of the
    /// near-null space on one body. Computed at its first use.
    pub(crate) fn free_motions(&self) -> usize {
        let count = || {
            let parts = self.parts();
            let mut part_of_body = vec![0; parts.bodies()];
            (0..self.dofs()).for_each(|dof| part_of_body[parts.body_of_dof(dof)] = parts.of_dof[dof]);
            let largest = |forces: &[f64]| {
                let mut of_body = vec![0.0_f64; parts.bodies()];
                for (dof, force) in forces.iter().enumerate() {
                    let largest = &mut of_body[parts.body_of_dof(dof)];
                    *largest = largest.max(force.abs());
                }
                of_body
            };
            let mut motions = vec![0; parts.count()];
            for mode in self.near_null().map_or(&[][..], |modes| modes.vectors()) {
                let own: Vec<f64> = self.diagonal().values.iter().zip(mode).map(|(own, at)| own * at).collect();
                let (forces, terms) = (largest(&self.stiffness.mul(mode)), largest(&own));
                let is_free = |body: &usize| terms[*body] > 0.0 && forces[*body] <= FREE * terms[*body];
                (0..parts.bodies()).filter(is_free).for_each(|body| motions[part_of_body[body]] += 1);
            }
            motions.into_iter().max().unwrap_or(0)
        };
        *self.free_motions.get_or_init(count)
    }

    /// Returns `true` if the stiffness is known to be singular: contact alone holds a dof or a mode.
    pub(crate) fn is_singular(&self) -> bool {
        !self.without_stiffness().is_empty() || self.free_motions() > 0
    }

    pub(crate) fn parts(&self) -> &Parts {
        self.parts.get_or_init(|| Parts::of(&self.stiffness, self.diagonal(), &self.contact, &self.gap))
    }

    /// Checks that no rows contradict each other at sight; the rows that may do so are found at the first use.
    pub(crate) fn check_rows(&self) -> Result<()> {
        match self.opposed_rows().check(&self.without_entries, &self.gap) {
            Err(Error::Infeasible { rows, weights, .. }) if self.equality_rows > 0 => {
                Err(self.infeasible(&rows, &weights))
            }
            checked => checked,
        }
    }

    fn opposed_rows(&self) -> &OpposedRows {
        self.opposed.get_or_init(|| OpposedRows::of(&self.contact))
    }

    /// The pairs of rows that are equalities, found at their first use.
    pub(crate) fn equalities(&self) -> &[Equality] {
        self.equalities.get_or_init(|| self.opposed_rows().equalities(&self.gap))
    }

    /// The same problem with one row of either sign in place of each pair that is an equality, and the multiplier
    /// (length m, in force) that belongs to it.
    pub(crate) fn two_sided<'a>(&'a self, multiplier: &'a [f64]) -> (Cow<'a, Self>, Cow<'a, [f64]>) {
        if self.equalities().is_empty() {
            return (Cow::Borrowed(self), Cow::Borrowed(multiplier));
        }
        let (mut problem, mut multiplier) = (self.clone(), multiplier.to_vec());
        problem.two_sided = vec![false; self.rows()];
        for &Equality { row, opposed, ratio } in self.equalities() {
            problem.two_sided[row] = true;
            problem.gap[opposed] = f64::INFINITY;
            multiplier[row] -= ratio * std::mem::take(&mut multiplier[opposed]);
        }
        (Cow::Owned(problem), Cow::Owned(multiplier))
    }

    /// Returns `true` for a row that counts as an equality by itself.
    pub(crate) fn is_two_sided(&self, row: usize) -> bool {
        self.two_sided.get(row).copied().unwrap_or(false)
    }

    /// The violation B u - g of each row, length m, in m: positive is penetration; `-inf` without an obstacle. The
    /// displacement u has length n, in m.
    pub fn violation(&self, displacement: &[f64]) -> Vec<f64> {
        self.contact.mul(displacement).iter().zip(&self.gap).map(|(moved, gap)| moved - gap).collect()
    }

    /// The work f'd of the load on a mode d, as a share of its terms `|f|'|d|`, between -1 and 1.
    pub(crate) fn share_of_work(&self, mode: &[f64]) -> f64 {
        let mut work = Accumulator::new(&[0.0]);
        self.load.iter().zip(mode).for_each(|(&f, &d)| work.add_product(0, f, d));
        let terms: f64 = self.load.iter().zip(mode).map(|(f, d)| (f * d).abs()).sum();
        if terms > 0.0 { work.into_sums()[0] / terms } else { 0.0 }
    }

    /// Checks that the vectors of an answer have the lengths of the problem.
    pub(crate) fn check_answer(&self, displacement: &[f64], multiplier: &[f64]) -> Result<()> {
        let length = LinearError::check_length;
        length("displacement", displacement.len(), self.dofs(), "dofs")?;
        let (found, of) =
            (multiplier.len(), if self.equality_rows() == 0 { "contact rows" } else { "contact and equality rows" });
        if found == self.rows() {
            Ok(())
        } else {
            Ok(length("multiplier", found, self.inequalities() + self.equality_rows(), of)?)
        }
    }

    /// `f + B' lambda - K u` of the given doubles, with twice the working precision.
    pub(crate) fn accurate_residual(&self, u: &[f64], lambda: &[f64]) -> Vec<f64> {
        self.accurate_balance(u, &[lambda]).residual
    }

    /// The same with its terms, for multipliers that are given as sums, which are not rounded.
    pub(crate) fn accurate_balance(&self, u: &[f64], multipliers: &[&[f64]]) -> Balance {
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
    pub(crate) fn accurate_forces(&self, u: &[f64]) -> Accumulator {
        let mut sums = Accumulator::new(&vec![0.0; u.len()]);
        sums.add_matrix_product(|column| self.stiffness.lower().column(column), u);
        sums
    }
}

/// The forces on each dof at a displacement u, with twice the working precision.
pub struct Balance {
    /// `f + B' lambda - K u` at the displacement u, one entry per dof.
    pub residual: Vec<f64>,
    /// `|K u|`.
    pub elastic: Vec<f64>,
    /// `u' K u`.
    pub strain: f64,
    /// `|K| |u|`, the terms of the elastic forces and the scale of rounding in them.
    pub terms: Vec<f64>,
}

/// The distances `B u - g` of a displacement that is a sum, which is not rounded.
pub struct Distances<'a> {
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

pub fn check_load(load: &[f64], dofs: usize) -> Result<()> {
    Ok(check_finite("load vector", load, (dofs, "dofs"))?)
}

pub fn check_gap(gap: &[f64], rows: usize) -> Result<()> {
    let allowed = "finite, or +inf for a row without obstacle";
    Ok(check_vector("gap vector", gap, (rows, "contact rows"), |gap| gap > f64::NEG_INFINITY, allowed)?)
}

#[cfg(test)]
impl ContactProblem {
    /// The problem with these entries `(row, column, value)` of the lower triangle of K, and of B.
    pub(crate) fn of_entries(
        stiffness: &[(usize, usize, f64)],
        load: &[f64],
        contact: &[(usize, usize, f64)],
        gap: &[f64],
    ) -> Self {
        let stiffness = SparseMatrix::from_triplets(load.len(), load.len(), stiffness).unwrap();
        let contact = SparseMatrix::from_triplets(gap.len(), load.len(), contact).unwrap();
        let stiffness = SymmetricMatrix::from_lower(stiffness).unwrap();
        ContactProblem::new(stiffness, load.to_vec(), contact, gap.to_vec()).unwrap()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_equality_counts_as_one_row_with_the_force_of_both_of_its_rows() {
        // u <= 1 and -3 u <= -3: a force of -2 on the second row is one of 6 along the first.
        let problem = ContactProblem::of_entries(&[(0, 0, 1.0)], &[4.0], &[(0, 0, 1.0), (1, 0, -3.0)], &[1.0, -3.0]);
        for (forces, along) in [([0.0, -2.0], 6.0), ([-5.0, 0.0], -5.0), ([-5.0, -2.0], 1.0)] {
            let (two_sided, multiplier) = problem.two_sided(&forces);
            assert_eq!(*multiplier, [along, 0.0]);
            assert!(two_sided.is_two_sided(0) && !two_sided.is_two_sided(1) && two_sided.gap()[1].is_infinite());
        }
        let apart = problem.with_gap(vec![1.0, -2.0]).unwrap();
        assert!(!apart.two_sided(&[0.0, 0.0]).0.is_two_sided(0));
    }
}
