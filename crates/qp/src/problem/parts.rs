//! The parts of a problem: bodies, or pieces of one, that share almost no energy.
//!
//! An answer may be right for a stiff part and wrong for a soft one beside it, because the energy of the soft part is
//! too small to show in that of the whole. Therefore a certificate measures every part in its own scale.

use crate::linear::{Forest, SparseMatrix, SymmetricMatrix};

/// A coupling below this share of `sqrt(K_ii K_jj)` does not make two dofs one part.
const WEAK_COUPLING: f64 = 1e-6;

#[derive(Clone, Debug)]
pub(crate) struct Diagonal {
    /// K_ii of each dof.
    pub values: Vec<f64>,
    /// `sqrt(K_ii)` of each dof.
    pub roots: Vec<f64>,
}

impl Diagonal {
    pub fn of(stiffness: &SymmetricMatrix) -> Self {
        let values = stiffness.diagonal();
        Diagonal { roots: values.iter().map(|value| value.sqrt()).collect(), values }
    }
}

/// The connected components of K and B: dofs that a coupling of K or a row with an obstacle joins.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Parts {
    /// The part of each dof, length n, numbered from 0 in the order of their first dofs.
    pub of_dof: Vec<usize>,
    /// The part of each row; 0 for a row without dofs.
    of_row: Vec<usize>,
    count: usize,
    /// The body of each dof, and the number of bodies: the connected components of K alone, numbered in the same way;
    /// nothing and zero if there is but one.
    bodies: (Vec<usize>, usize),
}

impl Parts {
    /// The parts of a stiffness with this `diagonal`, under contact rows with these gaps; rows with an infinite gap
    /// join nothing.
    pub fn of(stiffness: &SymmetricMatrix, diagonal: &Diagonal, contact: &SparseMatrix, gap: &[f64]) -> Self {
        let roots = &diagonal.roots;
        let mut forest = Forest::new(roots.len());
        for (column, &own) in roots.iter().enumerate() {
            if forest.is_one_tree() {
                break;
            }
            for (row, value) in stiffness.lower().column(column) {
                if row != column && value.abs() > WEAK_COUPLING * own * roots[row] {
                    forest.join(column, row);
                }
            }
        }
        let bodies = if forest.is_one_tree() { Default::default() } else { forest.clone().into_trees() };
        let mut first: Vec<Option<usize>> = vec![None; contact.rows()];
        let dofs = if forest.is_one_tree() { 0 } else { roots.len() };
        for dof in 0..dofs {
            let bounded = |entry: &(usize, f64)| entry.1 != 0.0 && gap[entry.0].is_finite();
            for (row, _) in contact.column(dof).filter(bounded) {
                forest.join(*first[row].get_or_insert(dof), dof);
            }
        }
        let (of_dof, count) = forest.into_trees();
        let mut of_row = vec![0; contact.rows()];
        if count > 1 {
            contact.triplets().filter(|entry| entry.2 != 0.0).for_each(|(row, dof, _)| of_row[row] = of_dof[dof]);
        }
        Parts { of_dof, of_row, count, bodies }
    }

    /// Number of parts, at least one: a problem without dofs has an empty one.
    pub fn count(&self) -> usize {
        self.count.max(1)
    }

    pub fn of_dof(&self, dof: usize) -> usize {
        self.of_dof[dof]
    }

    /// The part of a row; 0 for a row without dofs.
    pub fn of_row(&self, row: usize) -> usize {
        self.of_row[row]
    }

    /// Returns `true` if the stiffness has no coupling of two parts, not even a weak one.
    pub fn are_apart(&self, stiffness: &SymmetricMatrix) -> bool {
        stiffness.lower().triplets().all(|(row, column, value)| value == 0.0 || self.of_dof[row] == self.of_dof[column])
    }

    /// Number of bodies, at least one.
    pub fn bodies(&self) -> usize {
        self.bodies.1.max(1)
    }

    /// The body of a dof: K alone joins its dofs.
    pub fn body_of_dof(&self, dof: usize) -> usize {
        self.bodies.0.get(dof).copied().unwrap_or(0)
    }

    /// Number of dofs of each body.
    pub fn dofs_of_bodies(&self) -> Vec<usize> {
        let mut dofs = vec![0; self.bodies()];
        (0..self.of_dof.len()).for_each(|dof| dofs[self.body_of_dof(dof)] += 1);
        dofs
    }

    /// The sum of `term(dof)` over the dofs of each part.
    pub fn sums(&self, term: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.count()];
        self.of_dof.iter().enumerate().for_each(|(dof, &part)| sums[part] += term(dof));
        sums
    }
}
