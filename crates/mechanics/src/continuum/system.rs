//! The contact problem of simplices with the same number of unknowns each, some of which are prescribed, with rows of one unknown.

use crate::error::Error;
use signorini_qp::{ContactProblem, SparseMatrix, SymmetricMatrix};

/// The matrix of a simplex, row by row.
pub type Block = Vec<f64>;

/// The unknowns of each simplex.
#[derive(Clone, Debug)]
pub struct Numbers {
    of_cell: usize,
    numbers: Vec<usize>,
}

impl Numbers {
    /// The unknowns of all simplices one after another, so many of each.
    pub fn new(of_cell: usize, numbers: Vec<usize>) -> Self {
        Numbers { of_cell, numbers }
    }

    /// The unknowns of a simplex.
    pub fn of(&self, cell: usize) -> &[usize] {
        &self.numbers[cell * self.of_cell..(cell + 1) * self.of_cell]
    }

    /// The unknowns of each simplex.
    pub fn iter(&self) -> impl Iterator<Item = &[usize]> {
        self.numbers.chunks_exact(self.of_cell)
    }
}

/// A bound on one unknown: `sense x <= gap`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The unknown.
    pub unknown: usize,
    /// 1 or -1.
    pub sense: f64,
    /// In length.
    pub gap: f64,
}

/// The free unknowns and the values of the others.
#[derive(Clone, Debug)]
pub struct Unknowns {
    /// The prescribed values.
    pub held: Vec<Option<f64>>,
    /// The number of each free unknown.
    numbers: Vec<Option<usize>>,
    /// How many are free.
    pub free: usize,
}

impl Unknowns {
    /// Numbers the unknowns that are not held.
    pub fn new(held: Vec<Option<f64>>) -> Self {
        let mut free = 0;
        let number = |value: &Option<f64>| match value {
            Some(_) => None,
            None => {
                free += 1;
                Some(free - 1)
            }
        };
        let numbers = held.iter().map(number).collect();
        Unknowns { held, numbers, free }
    }

    /// Returns `true` if the unknown is free.
    pub fn is_free(&self, unknown: usize) -> bool {
        self.numbers[unknown].is_some()
    }

    /// All values from those of the free unknowns.
    pub fn expanded(&self, free: &[f64]) -> Vec<f64> {
        let value = |(held, number): (&Option<f64>, &Option<usize>)| held.or(number.map(|at| free[at])).unwrap_or(0.0);
        self.held.iter().zip(&self.numbers).map(value).collect()
    }

    /// The values of the free unknowns among all values.
    pub fn reduced(&self, all: &[f64]) -> Vec<f64> {
        all.iter().zip(&self.numbers).filter(|entry| entry.1.is_some()).map(|entry| *entry.0).collect()
    }

    /// The problem of these simplices, each with its unknowns and its matrix, under a load on all unknowns, with rows on free ones.
    ///
    /// # Errors
    /// As [`ContactProblem::new`].
    pub fn problem<'a>(
        &self,
        cells: impl Iterator<Item = (&'a [usize], Block)>,
        load: &[f64],
        rows: &[Row],
    ) -> Result<ContactProblem, Error> {
        let (mut entries, mut load) = (Vec::new(), self.reduced(load));
        for (unknowns, block) in cells {
            for (&unknown, line) in unknowns.iter().zip(block.chunks_exact(unknowns.len())) {
                let Some(row) = self.numbers[unknown] else { continue };
                for (&other, &value) in unknowns.iter().zip(line) {
                    match (self.numbers[other], self.held[other]) {
                        (Some(column), _) if column <= row => entries.push((row, column, value)),
                        (None, Some(held)) => load[row] -= value * held,
                        _ => {}
                    }
                }
            }
        }
        let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(self.free, self.free, &entries)?)?;
        let numbered = |(index, row): (usize, &Row)| Some((index, self.numbers[row.unknown]?, row.sense));
        let contact: Vec<_> = rows.iter().enumerate().filter_map(numbered).collect();
        let contact = SparseMatrix::from_triplets(rows.len(), self.free, &contact)?;
        Ok(ContactProblem::new(stiffness, load, contact, rows.iter().map(|row| row.gap).collect())?)
    }
}
