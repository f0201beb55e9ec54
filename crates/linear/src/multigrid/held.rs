//! What a face holds: its projection N, of vectors with few dofs.

use super::blocks::BlockMatrix;
use super::nodes::Nodes;
use crate::real::Real;

/// A vector of few dofs: dofs and coefficients, in the units of the nodes.
pub type Direction = Vec<(usize, f64)>;

/// A held displacement: `row'v = 0`, because v gives way along `way`, with `row'way = 1`. The row has nothing along the
/// ways of the other holds of a face. For an orthonormal system both are the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Hold {
    /// The displacement that gives way, a unit vector.
    pub way: Direction,
    /// What is held.
    pub row: Direction,
}

impl Hold {
    /// A unit vector that is held, and that itself gives way.
    pub fn of(unit: Direction) -> Self {
        Hold { way: unit.clone(), row: unit }
    }

    /// The dof, if it is a single one.
    fn unit(&self) -> Option<usize> {
        match (&self.way[..], &self.row[..]) {
            (&[(dof, way)], &[(held, row)]) if dof == held && way * row == 1.0 => Some(dof),
            _ => None,
        }
    }
}

/// The projection N of a face.
#[derive(Debug)]
pub struct Held<T> {
    pub matrix: BlockMatrix<T>,
    /// N'.
    pub transposed: BlockMatrix<T>,
    /// The nodes that have entries in N, and in N'.
    rows: [Vec<usize>; 2],
    /// The places of what is held, if all of it are single dofs.
    units: Option<Vec<usize>>,
}

impl<T: Real> Held<T> {
    /// The projection of `holds`.
    pub fn of(nodes: &Nodes, holds: &[Hold]) -> Self {
        let matrix = sum(nodes, holds.iter().map(|hold| (&hold.way, &hold.row)));
        let units =
            holds.iter().map(|hold| hold.unit().map(|dof| nodes.place[dof] as usize)).collect::<Option<Vec<_>>>();
        // A single dof gives way along itself.
        let transposed = match units {
            Some(_) => matrix.clone(),
            None => sum(nodes, holds.iter().map(|hold| (&hold.row, &hold.way))),
        };
        Self::with(matrix, transposed, units)
    }

    fn with(matrix: BlockMatrix<T>, transposed: BlockMatrix<T>, units: Option<Vec<usize>>) -> Self {
        let rows = [&matrix, &transposed].map(|matrix| matrix.filled_rows().collect());
        Held { matrix, transposed, rows, units }
    }

    /// Takes out what `matrix` N or N' holds.
    fn subtract(&self, matrix: &BlockMatrix<T>, rows: &[usize], x: &mut [T]) {
        match &self.units {
            Some(units) => units.iter().for_each(|&place| x[place] = T::default()),
            None => matrix.subtract_from(rows, x),
        }
    }

    /// `x = E x` for displacements.
    pub fn project(&self, x: &mut [T]) {
        self.subtract(&self.matrix, &self.rows[0], x);
    }

    /// `f = E' f` for forces.
    pub fn project_force(&self, f: &mut [T]) {
        self.subtract(&self.transposed, &self.rows[1], f);
    }

    /// What is held beyond `last`.
    pub fn beyond(&self, last: &Self) -> Self {
        let minus = |own: &BlockMatrix<T>, last: &BlockMatrix<T>| own.plus(-1.0, last).without_zeros();
        Self::with(minus(&self.matrix, &last.matrix), minus(&self.transposed, &last.transposed), None)
    }

    /// `N' A`.
    pub fn forces(&self, matrix: &BlockMatrix<T>) -> BlockMatrix<T> {
        let of_rows = self.rows[1].iter().flat_map(|&row| self.transposed.row(row));
        self.transposed.product(&matrix.with_rows(of_rows.map(|entry| entry.0)), 1)
    }

    /// `A - E' A E`.
    pub fn change(&self, matrix: &BlockMatrix<T>) -> BlockMatrix<T> {
        let rows = self.forces(matrix);
        rows.plus(1.0, &rows.transposed()).plus(-1.0, &rows.product(&self.matrix, 1))
    }

    /// `E' A E + W`, for a hierarchy of one level, W of [`ways`].
    pub fn held_matrix(&self, matrix: &BlockMatrix<T>, nodes: &Nodes, holds: &[Hold]) -> BlockMatrix<T> {
        matrix.plus(-1.0, &self.change(matrix)).plus(1.0, &ways(nodes, holds))
    }
}

/// W, the sum of `d d'` over the ways d of `holds`: what is held has a stiffness of its own in `E' A E + W`, which is
/// definite.
pub fn ways<T: Real>(nodes: &Nodes, holds: &[Hold]) -> BlockMatrix<T> {
    sum(nodes, holds.iter().map(|hold| (&hold.way, &hold.way)))
}

/// The sum of the products a b' of directions.
fn sum<'a, T: Real>(nodes: &Nodes, products: impl Iterator<Item = (&'a Direction, &'a Direction)>) -> BlockMatrix<T> {
    let (size, count) = (nodes.size, nodes.count);
    let mut entries: Vec<(u32, u32, f64)> = Vec::new();
    for (one, other) in products {
        for &(first, a) in one {
            for &(second, b) in other {
                entries.push((nodes.place[first], nodes.place[second], a * b));
            }
        }
    }
    let node = |place: u32| place as usize / size;
    entries.sort_unstable_by_key(|&(row, column, _)| (node(row), node(column)));
    let mut held = BlockMatrix::empty(0, count, (size, size));
    for block in entries.chunk_by(|a, b| (node(a.0), node(a.1)) == (node(b.0), node(b.1))) {
        held.starts.resize(node(block[0].0) + 1, held.indices.len());
        held.indices.push(node(block[0].1) as u32);
        let start = held.values.len();
        held.values.resize(start + size * size, T::default());
        for &(row, column, value) in block {
            held.values[start + row as usize % size * size + column as usize % size] += T::of(value);
        }
    }
    held.starts.resize(count + 1, held.indices.len());
    held
}
