//! The contact problem of simplices with the same number of unknowns each, some of which are prescribed, with rows of one unknown.

use super::simplex::Point;
use crate::error::Error;
use crate::fem::geometry::Around;
use signorini_qp::{ContactProblem, NearNullSpace, SparseMatrix, SymmetricMatrix};

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
    pub fn iter(&self) -> impl Iterator<Item = &[usize]> + Clone {
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

    /// The rigid motions as values of the free unknowns.
    fn rigid_motions(&self, places: &[Point]) -> Result<Option<NearNullSpace>, Error> {
        let dimension = self.held.len() / places.len();
        let along = |axis: usize| places.iter().map(|place| place[axis]).collect();
        let all = NearNullSpace::of_nodes(&(0..dimension).map(along).collect::<Vec<_>>())?;
        Ok(NearNullSpace::of_modes(all.vectors().iter().map(|motion| self.reduced(motion)).collect()))
    }

    /// The problem of simplices with these unknowns and matrices, under a load on all unknowns, with rows on free ones. At each of the `places`
    /// a linear displacement has the values of the unknowns along the axes.
    ///
    /// # Errors
    /// As [`ContactProblem::new`].
    pub fn problem(
        &self,
        numbers: &Numbers,
        blocks: &[Block],
        load: &[f64],
        rows: &[Row],
        places: &[Point],
    ) -> Result<ContactProblem, Error> {
        let (starts, row_indices) = self.pattern(numbers, self.held.len() / places.len());
        let (mut values, mut load) = (vec![0.0; row_indices.len()], self.reduced(load));
        for (unknowns, block) in numbers.iter().zip(blocks) {
            for (&unknown, line) in unknowns.iter().zip(block.chunks_exact(unknowns.len())) {
                let Some(column) = self.numbers[unknown] else { continue };
                let of_column = starts[column]..starts[column + 1];
                for (&other, &value) in unknowns.iter().zip(line) {
                    match (self.numbers[other], self.held[other]) {
                        (Some(row), _) if row >= column => {
                            let place = row_indices[of_column.clone()].partition_point(|&other| (other as usize) < row);
                            values[of_column.start + place] += value;
                        }
                        (None, Some(held)) => load[column] -= value * held,
                        _ => {}
                    }
                }
            }
        }
        let stiffness = SparseMatrix::from_parts(self.free, starts, row_indices, values);
        let numbered = |(index, row): (usize, &Row)| Some((index, self.numbers[row.unknown]?, row.sense));
        let contact: Vec<_> = rows.iter().enumerate().filter_map(numbered).collect();
        let contact = SparseMatrix::from_triplets(rows.len(), self.free, &contact)?;
        let gap = rows.iter().map(|row| row.gap).collect();
        let posed = ContactProblem::new(SymmetricMatrix::from_lower(stiffness)?, load, contact, gap)?;
        Ok(match self.rigid_motions(places)? {
            Some(motions) => posed.with_near_null(motions)?,
            None => posed,
        })
    }

    /// Column starts and rows of the lower triangle in the free unknowns.
    fn pattern(&self, numbers: &Numbers, dimension: usize) -> (Vec<usize>, Vec<u32>) {
        let around = Around::new(self.held.len(), numbers.iter().map(|cell| cell.iter().copied()));
        let (mut starts, mut rows, mut found) = (vec![0], Vec::new(), Vec::new());
        let mut place = usize::MAX;
        for (unknown, column) in self.numbers.iter().enumerate() {
            let Some(column) = *column else { continue };
            // The unknowns of one place have the same neighbours.
            if std::mem::replace(&mut place, unknown / dimension) != unknown / dimension {
                let cells = around.at(unknown).iter().map(|&cell| numbers.of(cell as usize));
                found.clear();
                found.extend(cells.flatten().filter_map(|&other| self.numbers[other].map(|row| row as u32)));
                found.sort_unstable();
                found.dedup();
            }
            rows.extend(found.iter().filter(|&&row| row as usize >= column));
            starts.push(rows.len());
        }
        (starts, rows)
    }
}
