//! A problem split into pieces without coupling: each piece is a separate problem, and the answers are joined.

use crate::error::Error;
use crate::linear::{SparseMatrix, SymmetricMatrix};
use crate::problem::ContactProblem;
use crate::solution::ContactSet;

/// Pieces of a problem that no entry of K and no row with an obstacle couples.
#[derive(Debug)]
pub struct Pieces {
    of_dof: Vec<usize>,
    of_row: Vec<usize>,
    /// Number of each dof, and of each row, within its piece.
    place_of_dof: Vec<usize>,
    place_of_row: Vec<usize>,
    /// The dofs, and the rows, of each piece, in increasing order.
    dofs: Vec<Vec<usize>>,
    rows: Vec<Vec<usize>>,
}

impl Pieces {
    /// The pieces of `problem`, given by the piece of each of its parts, from 0 to `count - 1`.
    pub fn of(problem: &ContactProblem, of_part: &[usize], count: usize) -> Self {
        let parts = problem.parts();
        let of_dof: Vec<usize> = parts.of_dof.iter().map(|&part| of_part[part]).collect();
        let of_row: Vec<usize> = (0..problem.rows()).map(|row| of_part[parts.of_row(row)]).collect();
        let (place_of_dof, dofs) = members(&of_dof, count);
        let (place_of_row, rows) = members(&of_row, count);
        Pieces { of_dof, of_row, place_of_dof, place_of_row, dofs, rows }
    }

    pub fn count(&self) -> usize {
        self.dofs.len()
    }

    /// The dof of the whole that is number `dof` of a piece; the first for a piece without dofs.
    pub fn dof(&self, piece: usize, dof: usize) -> usize {
        self.dofs[piece].get(dof).copied().unwrap_or(0)
    }

    /// One piece of `problem`.
    pub fn problem(&self, problem: &ContactProblem, piece: usize) -> Result<ContactProblem, Error> {
        let (dofs, rows) = (&self.dofs[piece], &self.rows[piece]);
        let columns = |matrix: &SparseMatrix, of: &[usize], place: &[usize], count: usize| {
            matrix.select(count, |row| (of[row] == piece).then_some(place[row]), dofs.iter().copied())
        };
        let lower = columns(problem.stiffness().lower(), &self.of_dof, &self.place_of_dof, dofs.len());
        let contact = columns(problem.contact(), &self.of_row, &self.place_of_row, rows.len());
        let load = dofs.iter().map(|&dof| problem.load()[dof]).collect();
        let gap = rows.iter().map(|&row| problem.gap()[row]).collect();
        let own = ContactProblem::computed(SymmetricMatrix::from_lower(lower)?, load, contact, gap)?;
        own.with_near_null_of(problem, |mode| dofs.iter().map(|&dof| mode[dof]).collect())
    }

    /// One value for each dof, from those of the pieces.
    pub fn join_dofs<'a>(&self, of_pieces: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
        joined(&self.dofs, of_pieces)
    }

    /// One value for each row, from those of the pieces.
    pub fn join_rows<'a>(&self, of_pieces: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
        joined(&self.rows, of_pieces)
    }

    /// The set of all rows, from those of the pieces; a piece without a set has none.
    pub fn join_sets<'a>(&self, of_pieces: impl Iterator<Item = Option<&'a ContactSet>>) -> ContactSet {
        let of_pieces: Vec<_> = of_pieces.collect();
        let is_in = |row: usize| of_pieces[self.of_row[row]].is_some_and(|set| set.contains(self.place_of_row[row]));
        ContactSet::from_fn(self.of_row.len(), is_in)
    }
}

/// The number of each member within its piece, and the members of each piece.
fn members(of_member: &[usize], count: usize) -> (Vec<usize>, Vec<Vec<usize>>) {
    let mut members = vec![Vec::new(); count];
    let mut places = Vec::with_capacity(of_member.len());
    for (member, &piece) in of_member.iter().enumerate() {
        places.push(members[piece].len());
        members[piece].push(member);
    }
    (places, members)
}

fn joined<'a>(members: &[Vec<usize>], of_pieces: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
    let mut all = vec![0.0; members.iter().map(Vec::len).sum()];
    for (members, values) in members.iter().zip(of_pieces) {
        members.iter().zip(values).for_each(|(&member, &value)| all[member] = value);
    }
    all
}
