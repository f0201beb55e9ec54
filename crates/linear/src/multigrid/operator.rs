//! The matrix of a level, in all dofs or in a face, and what a face holds: its projection N, of vectors with few dofs.

use super::blocks::BlockMatrix;
use super::nodes::Nodes;
use crate::Spare;
use crate::real::Real;

/// A matrix A minus the change by a face: on the finest level the face is the range of E = I - N, on coarser ones A
/// becomes A - C.
#[derive(Clone, Copy, Debug)]
pub struct Operator<'a, T> {
    /// A.
    pub matrix: &'a BlockMatrix<T>,
    /// The projection N of the face on the finest level; `None` on coarser ones and without a face.
    pub held: Option<&'a Held<T>>,
    /// C.
    pub change: Option<&'a BlockMatrix<T>>,
    pub threads: usize,
    /// Its work vectors.
    pub spare: &'a Spare<T>,
}

impl<'a, T: Real> Operator<'a, T> {
    pub fn whole(matrix: &'a BlockMatrix<T>, threads: usize, spare: &'a Spare<T>) -> Self {
        Operator { matrix, held: None, change: None, threads, spare }
    }

    pub fn dim(&self) -> usize {
        self.matrix.rows() * self.matrix.height
    }

    /// The force of an `x` in the face.
    pub fn mul_into(&self, x: &[T], y: &mut [T]) {
        y.fill(T::default());
        self.add_product(1.0, x, y);
    }

    /// `y += sign A x` for forces `y` and an `x` in the face.
    pub fn add_product(&self, sign: f64, x: &[T], y: &mut [T]) {
        match self.matrix.height {
            _ if !self.matrix.is_half && !self.matrix.is_shared() => self.matrix.add_product(sign, x, y, self.threads),
            1 => self.add_compact::<1>(T::of(sign), x, y),
            2 => self.add_compact::<2>(T::of(sign), x, y),
            _ => self.add_compact::<3>(T::of(sign), x, y),
        }
        if let Some(change) = self.change {
            change.add_few_products(x, y, -sign);
        }
        if let Some(held) = self.held {
            held.project_force(y);
        }
    }

    /// The product of a matrix that stores half of its blocks, or rows that repeat once.
    fn add_compact<const H: usize>(&self, sign: T, x: &[T], y: &mut [T]) {
        match self.matrix.is_half {
            true => self.matrix.add_by_half::<H>(sign, x, y, (self.threads, self.spare)),
            false => self.matrix.add_by_kinds::<H>(sign, x, y, (self.threads, self.spare)),
        }
    }

    /// The Rayleigh quotient of M A at x in the energy product, in which it is symmetric, and M A x; `moved` makes that
    /// of A x. `None` without positive energy.
    pub fn quotient(&self, x: &[T], moved: impl FnOnce(&[T]) -> Vec<T>) -> Option<(f64, Vec<T>)> {
        let mut force = self.spare.take(x.len());
        self.mul_into(x, &mut force);
        let moved = moved(&force);
        let product = |x: &[T]| x.iter().zip(&force).map(|(x, force)| x.double() * force.double()).sum::<f64>();
        let (energy, dual) = (product(x), product(&moved));
        self.spare.give(force);
        (energy > 0.0 && dual.is_finite()).then(|| (dual / energy, moved))
    }

    /// Brings a displacement into the face.
    pub fn project(&self, x: &mut [T]) {
        self.held.into_iter().for_each(|held| held.project(x));
    }

    pub fn add(&self, x: &[T], y: &mut [T]) {
        let height = self.matrix.height;
        self.matrix.shared(self.threads).with_vectors(height, [y], |rows, [y]| {
            y.iter_mut().zip(&x[rows.start * height..]).for_each(|(y, &x)| *y += x);
        });
    }
}

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
    pub fn of(nodes: &Nodes, holds: &[Hold]) -> Self {
        let matrix = sum(nodes, holds.iter().map(|hold| (&hold.way, &hold.row)));
        let unit = |hold: &Hold| hold.unit().map(|dof| nodes.place[dof] as usize);
        let units: Option<Vec<usize>> = holds.iter().map(unit).collect();
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
        let is_kept = |_, _, block: &[T]| block.iter().any(|&value| value != T::default());
        let minus = |own: &BlockMatrix<T>, last: &BlockMatrix<T>| own.plus(-1.0, last).filtered(is_kept);
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
