//! Dense vectors and triangles.

use std::sync::Arc;

use crate::error::Error;
use crate::real::for_processor;

/// The maximum norm: the entry farthest from zero, by its magnitude; 0 for an empty slice. For the crates of this
/// workspace.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// The scalar product a'b of two vectors, which have one entry per unknown each. For the crates of this workspace.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The same for long vectors: in sums side by side, which a processor forms at once.
#[inline(always)]
pub(super) fn wide_dot(a: &[f64], b: &[f64]) -> f64 {
    wide_product(a, b, |value| value)
}

/// The same, of which `entry` makes the entries of `a`.
#[inline(always)]
pub(super) fn wide_product(a: &[f64], b: &[f64], entry: impl Fn(f64) -> f64) -> f64 {
    let (of_a, rest_of_a) = a.as_chunks::<WIDTH>();
    let (of_b, rest_of_b) = b.as_chunks::<WIDTH>();
    let mut sums = [0.0; WIDTH];
    for (a, b) in of_a.iter().zip(of_b) {
        sums.iter_mut().zip(a).zip(b).for_each(|((sum, &a), b)| *sum += entry(a) * b);
    }
    let rest: f64 = rest_of_a.iter().zip(rest_of_b).map(|(&a, b)| entry(a) * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// Sums that are formed side by side.
const WIDTH: usize = 8;

/// The Euclidean length.
pub fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// Subtracts `share y` from x, entry by entry.
#[inline(always)]
pub fn subtract(x: &mut [f64], share: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(entry, y)| *entry -= share * y);
}

/// Subtracts from a vector its component along a direction of length one, and returns that component.
pub fn take_out(vector: &mut [f64], direction: &[f64]) -> f64 {
    let share = dot(vector, direction);
    subtract(vector, share, direction);
    share
}

/// The part of a vector that is orthogonal to unit vectors of its length; the second turn removes the rounding of the
/// first.
pub fn across(basis: &[Vec<f64>], mut vector: Vec<f64>) -> Vec<f64> {
    basis.iter().chain(basis).for_each(|direction| _ = take_out(&mut vector, direction));
    vector
}

/// Extends an orthonormal basis by a vector; returns `false` if it leaves at most this share of its length.
pub fn extend(basis: &mut Vec<Vec<f64>>, vector: Vec<f64>, share: f64) -> bool {
    let whole = norm(&vector);
    let mut rest = across(basis, vector);
    let length = norm(&rest);
    let is_new = length > share * whole;
    if is_new {
        rest.iter_mut().for_each(|value| *value /= length);
        basis.push(rest);
    }
    is_new
}

/// Checks that a vector has an entry for each of those that it belongs to, and that its values are allowed.
pub fn check_vector(
    name: &'static str,
    values: &[f64],
    (expected, of): (usize, &'static str),
    is_allowed: fn(f64) -> bool,
    allowed: &'static str,
) -> Result<(), Error> {
    Error::check_length(name, values.len(), expected, of)?;
    let refused = values.iter().enumerate().find(|entry| !is_allowed(*entry.1));
    let Some((index, &value)) = refused else { return Ok(()) };
    Err(Error::NotFinite { name, at: format!("entry {index}"), value, allowed })
}

/// The same for a vector of this length of any finite values.
pub fn check_finite(name: &'static str, values: &[f64], of: (usize, &'static str)) -> Result<(), Error> {
    check_vector(name, values, of, f64::is_finite, "finite")
}

/// A lower triangle L (n x n), such as the last block of a Cholesky factor. Clones share their memory.
#[derive(Clone, Debug)]
pub struct LowerTriangle {
    size: usize,
    /// Column by column, n x n.
    values: Arc<Vec<f64>>,
}

impl LowerTriangle {
    /// The triangle of `size` columns of `size` values each; values above the diagonal are not read.
    pub fn new(size: usize, values: impl Into<Arc<Vec<f64>>>) -> Self {
        LowerTriangle { size, values: values.into() }
    }

    /// The values, column by column, n x n; those above the diagonal have no meaning.
    pub(super) fn values(&self) -> &Arc<Vec<f64>> {
        &self.values
    }

    /// The diagonal entry of a row.
    pub fn diagonal(&self, place: usize) -> f64 {
        self.values[place * self.size + place]
    }

    /// The block of the last `size` rows and columns.
    pub fn last(&self, size: usize) -> Self {
        if size == self.size {
            return self.clone();
        }
        let first = self.size - size;
        let rows = |column: usize| &self.values[column * self.size + first..(column + 1) * self.size];
        LowerTriangle::new(size, (first..self.size).flat_map(rows).copied().collect::<Vec<f64>>())
    }

    /// Number of columns n.
    pub fn size(&self) -> usize {
        self.size
    }

    /// A column from its diagonal entry down.
    #[inline(always)]
    fn column(&self, column: usize) -> &[f64] {
        &self.values[column * self.size + column..(column + 1) * self.size]
    }

    /// `L^-1 b`, length n.
    pub fn forward(&self, mut b: Vec<f64>) -> Vec<f64> {
        self.sweep(&mut b, false);
        b
    }

    /// Replaces b by `L^-1 b`, from its first entry that is not zero, or by `L'^-1 b`.
    pub(super) fn sweep(&self, b: &mut [f64], is_backward: bool) {
        swept(self, b, is_backward);
    }

    /// `L'^-1 y`, length n.
    pub fn backward(&self, mut y: Vec<f64>) -> Vec<f64> {
        self.sweep(&mut y, true);
        y
    }

    /// Upper bounds on the sums of magnitudes of each column of `L^-1`, by one sweep: no entry of the inverse is larger
    /// than that of the triangle with the magnitudes of L on the diagonal and the negative magnitudes of L below.
    ///
    /// # Source
    /// N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, SIAM (2002), section 8.2: the comparison matrix.
    pub fn sums_of_inverse(&self) -> Vec<f64> {
        let mut sums = vec![1.0; self.size];
        for j in (0..self.size).rev() {
            let column = self.column(j);
            let below: f64 = column[1..].iter().zip(&sums[j + 1..]).map(|(l, sum)| l.abs() * sum).sum();
            sums[j] = (1.0 + below) / column[0].abs();
        }
        sums
    }

    /// `L x`.
    pub fn mul(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.size];
        for (j, &x) in x.iter().enumerate() {
            product[j..].iter_mut().zip(self.column(j)).for_each(|(entry, l)| *entry += l * x);
        }
        product
    }

    /// `L' x`.
    pub fn mul_transposed(&self, x: &[f64]) -> Vec<f64> {
        (0..self.size).map(|j| dot(self.column(j), &x[j..])).collect()
    }

    /// The lower triangle of `L L'`, n x n, column by column.
    pub fn times_transpose(&self) -> Vec<f64> {
        let size = self.size;
        let mut product = vec![0.0; size * size];
        for k in 0..size {
            let column = self.column(k);
            for (place, &scale) in column.iter().enumerate() {
                let j = k + place;
                let target = &mut product[j * size + j..(j + 1) * size];
                target.iter_mut().zip(&column[place..]).for_each(|(entry, l)| *entry += scale * l);
            }
        }
        product
    }
}

for_processor! {
    /// A sweep through a triangle, or through its transpose, in place.
    fn swept['a](triangle: &'a LowerTriangle, vector: &'a mut [f64], is_backward: bool) -> () {
        if is_backward {
            for j in (0..triangle.size).rev() {
                let column = triangle.column(j);
                vector[j] = (vector[j] - wide_dot(&column[1..], &vector[j + 1..])) / column[0];
            }
            return;
        }
        let first = vector.iter().position(|&value| value != 0.0).unwrap_or(triangle.size);
        for j in first..triangle.size {
            let (column, [value, below @ ..]) = (triangle.column(j), &mut vector[j..]) else { return };
            *value /= column[0];
            subtract(below, *value, &column[1..]);
        }
    }
}

/// An upper triangle R that grows column by column, as in `Z = Q R` of vectors Z. Columns that follow from those before
/// them take no part in solutions.
#[derive(Clone, Debug, Default)]
pub struct UpperTriangle {
    /// The columns, each down to its diagonal entry.
    columns: Vec<Vec<f64>>,
    independent: Vec<bool>,
}

impl UpperTriangle {
    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        self.columns.len()
    }

    /// A column down to its diagonal entry.
    pub fn column(&self, place: usize) -> &[f64] {
        &self.columns[place]
    }

    /// `true` for each column that does not follow from those before it.
    pub fn independent(&self) -> &[bool] {
        &self.independent
    }

    /// Appends the column with these entries above its diagonal entry, which does not follow from those before it.
    pub fn push(&mut self, mut above: Vec<f64>, diagonal: f64) {
        above.push(diagonal);
        self.columns.push(above);
        self.independent.push(true);
    }

    /// The same for a column that follows from those before it, of the same length.
    pub fn push_dependent(&mut self, above: Vec<f64>, diagonal: f64) {
        self.push(above, diagonal);
        self.independent[self.columns.len() - 1] = false;
    }

    /// Removes the column at `place`. Rotations remove the entries that later columns then have below their diagonal.
    /// Each one calls `turn(i, c, s)`: rows i and i + 1 of R were turned by a plane rotation with cosine c and sine s.
    pub fn remove(&mut self, place: usize, mut turn: impl FnMut(usize, f64, f64)) {
        self.columns.remove(place);
        self.independent.remove(place);
        for first in place..self.columns.len() {
            let (a, b) = (self.columns[first][first], self.columns[first][first + 1]);
            let length = a.hypot(b);
            let (cosine, sine) = if length > 0.0 { (a / length, b / length) } else { (1.0, 0.0) };
            for column in &mut self.columns[first..] {
                (column[first], column[first + 1]) = turned(cosine, sine, column[first], column[first + 1]);
            }
            turn(first, cosine, sine);
            self.columns[first].truncate(first + 1);
        }
    }

    /// The length of each column of `R'^-1`: that of `Z x` for the shortest shift that moves one of the columns of Z by
    /// one and leaves the others; zero on columns that follow from others.
    pub fn lengths_of_inverse(&self) -> Vec<f64> {
        let length = |place: usize| {
            if !self.independent[place] {
                return 0.0;
            }
            let mut shift = vec![0.0; self.size()];
            shift[place] = 1.0;
            for (i, column) in self.columns.iter().enumerate().skip(place) {
                if self.independent[i] {
                    shift[i] = (shift[i] - dot(&column[place..i], &shift[place..i])) / column[i];
                }
            }
            norm(&shift)
        };
        (0..self.size()).map(length).collect()
    }

    /// `(R'R)^-1 b`, length n; zero on columns that follow from others.
    pub fn solve_normal(&self, b: Vec<f64>) -> Vec<f64> {
        self.solve_upper(self.solve_lower(b))
    }

    /// `R^-1 b` for the first columns, as many as b has entries; zero on columns that follow from others.
    pub fn solve_upper(&self, mut b: Vec<f64>) -> Vec<f64> {
        for (place, column) in self.columns.iter().enumerate().take(b.len()).rev() {
            if !self.independent[place] {
                b[place] = 0.0;
                continue;
            }
            b[place] /= column[place];
            let value = b[place];
            subtract(&mut b[..place], value, column);
        }
        b
    }

    /// `R'^-1 b`, length n; zero on columns that follow from others.
    pub fn solve_lower(&self, mut b: Vec<f64>) -> Vec<f64> {
        for (place, column) in self.columns.iter().enumerate() {
            b[place] = match self.independent[place] {
                true => (b[place] - dot(&column[..place], &b[..place])) / column[place],
                false => 0.0,
            };
        }
        b
    }
}

/// A point (x, y) turned by a plane rotation.
pub fn turned(cosine: f64, sine: f64, x: f64, y: f64) -> (f64, f64) {
    (cosine * x + sine * y, cosine * y - sine * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lower_triangle_is_multiplied_and_solved_with() {
        // [2 0; 1 3], column by column; the value above the diagonal does not belong to it.
        let l = LowerTriangle::new(2, vec![2.0, 1.0, 9.0, 3.0]);
        assert_eq!((l.mul(&[1.0, 2.0]), l.mul_transposed(&[1.0, 2.0])), (vec![2.0, 7.0], vec![4.0, 6.0]));
        assert_eq!((l.forward(vec![2.0, 7.0]), l.backward(vec![4.0, 6.0])), (vec![1.0, 2.0], vec![1.0, 2.0]));
        assert_eq!(l.forward(vec![0.0, 6.0]), [0.0, 2.0]);
        // The inverse of [[2, 0], [l, 3]] is [[1/2, 0], [-l/6, 1/3]].
        for below in [1.0, -1.0] {
            let l = LowerTriangle::new(2, vec![2.0, below, 9.0, 3.0]);
            assert_eq!(l.sums_of_inverse(), [(1.0 + 1.0 / 3.0) / 2.0, 1.0 / 3.0]);
        }
        assert_eq!(l.times_transpose(), [4.0, 2.0, 0.0, 10.0]);
    }

    #[test]
    fn an_upper_triangle_leaves_out_columns_that_follow_from_others() {
        let mut r = UpperTriangle::default();
        r.push(vec![], 2.0);
        r.push_dependent(vec![4.0], 0.0);
        r.push(vec![1.0, 5.0], 4.0);
        assert_eq!(r.solve_upper(vec![4.0, 7.0, 8.0]), [1.0, 0.0, 2.0]);
        assert_eq!(r.solve_lower(vec![2.0, 7.0, 9.0]), [1.0, 0.0, 2.0]);
    }

    #[test]
    fn a_column_that_is_taken_out_leaves_a_triangle_with_the_same_products() {
        let mut r = UpperTriangle::default();
        r.push(vec![], 3.0);
        r.push(vec![1.0], 3.0);
        r.push(vec![1.0, 4.0], 2.0);
        let mut turns = Vec::new();
        r.remove(1, |first, cosine, sine| turns.push((first, cosine, sine)));
        // (4, 2) becomes (sqrt(20), 0).
        let length = 20.0_f64.sqrt();
        assert_eq!(turns, [(1, 4.0 / length, 2.0 / length)]);
        assert!((r.column(1)[1] - length).abs() < 1e-15 && r.column(1).len() == 2 && r.size() == 2);
    }
}
