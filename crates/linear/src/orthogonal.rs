//! The distance of vectors from the span of the others, by orthogonal directions: products of vectors would lose half
//! the digits.

use super::dense::wide_dot;
use super::{UpperTriangle, dense_factor, dot, norm, take_out};

/// The component of a vector orthogonal to the others is rounding if it is below this share of the terms that cancel.
const CANCELLED_VECTOR: f64 = 64.0 * f64::EPSILON;

/// `sqrt((Z'Z)^-1_ii)` of each column i of Z: one over its distance from the span of the others, if it is independent.
/// It is infinite for columns that take part in a dependence to rounding. `None` if it `is_over` before.
///
/// Each column may be off by `rounding` times its length: by E in all, and `Z + E = (1 + E Z+) Z`. The rows of the
/// pseudoinverse Z+ have these lengths, so no distance is smaller by more than the share `|E Z+|`, at most the sum of
/// `rounding` times each length times that of its column.
///
/// # Source
/// Å. Björck, *Numerics of Gram-Schmidt orthogonalization*, Linear Algebra Appl. 197/198 (1994) 297-316.
pub fn inverse_lengths(columns: Vec<Vec<f64>>, rounding: f64, is_over: impl Fn() -> bool) -> Option<Vec<f64>> {
    let sizes: Vec<f64> = columns.iter().map(|column| norm(column)).collect();
    if sizes.iter().any(|size| !size.is_normal()) {
        return Some(vec![f64::INFINITY; sizes.len()]);
    }
    let triangle = Ordered::of(columns, &sizes, &is_over)?;
    let mut lengths = vec![f64::INFINITY; sizes.len()];
    for (place, &column) in triangle.order.iter().enumerate() {
        if is_over() {
            return None;
        }
        lengths[column] = triangle.inverse_length(place);
    }
    Some(widened(lengths, &sizes, rounding))
}

/// The `lengths` for columns of length one as those for columns of these `sizes`, with the rounding of the columns.
fn widened(mut lengths: Vec<f64>, sizes: &[f64], rounding: f64) -> Vec<f64> {
    let share = rounding * lengths.iter().filter(|length| length.is_finite()).sum::<f64>();
    let kept = (1.0 - share).max(0.0);
    lengths.iter_mut().zip(sizes).for_each(|(length, size)| *length /= size * kept);
    lengths
}

/// The largest number of lengths of a column that one over its distance from the span of the others may be, so that
/// products of columns leave it more digits than a bound needs.
const CLEAR: f64 = 1e3;

/// As [`inverse_lengths`], from the lower triangle of the products of this number of columns (column by column); `None`
/// if they are not clearly independent.
pub fn inverse_lengths_by_products(count: usize, mut products: Vec<f64>, rounding: f64) -> Option<Vec<f64>> {
    let sizes: Vec<f64> = (0..count).map(|place| products[place * count + place].sqrt()).collect();
    if sizes.iter().any(|size| !(size * size).is_normal()) {
        return None;
    }
    for (column, size) in products.chunks_mut(count.max(1)).zip(&sizes) {
        column.iter_mut().zip(&sizes).for_each(|(product, other)| *product /= size * other);
    }
    let triangle = dense_factor::factorise(count, products, 1).ok()?;
    let mut units = vec![0.0; count * count];
    (0..count).for_each(|place| units[place * count + place] = 1.0);
    let inverse = dense_factor::forward_all(&triangle, units);
    let lengths: Vec<f64> = inverse.chunks(count.max(1)).map(|column| wide_dot(column, column).sqrt()).collect();
    let is_clear = lengths.iter().all(|&length| length <= CLEAR);
    is_clear.then(|| widened(lengths, &sizes, rounding))
}

/// R of the columns, each of length one, ordered so that the farthest from the span of those before it comes first.
#[derive(Default)]
struct Ordered {
    order: Vec<usize>,
    /// R of the columns in that order; a column is independent if its diagonal entry is more than rounding.
    triangle: UpperTriangle,
}

impl Ordered {
    fn of(mut rest: Vec<Vec<f64>>, sizes: &[f64], is_over: &impl Fn() -> bool) -> Option<Self> {
        for (column, size) in rest.iter_mut().zip(sizes) {
            column.iter_mut().for_each(|value| *value /= size);
        }
        let mut left: Vec<usize> = (0..rest.len()).collect();
        let mut entries: Vec<Vec<f64>> = vec![Vec::new(); rest.len()];
        let mut found = Ordered::default();
        let mut directions: Vec<Vec<f64>> = Vec::new();
        while !left.is_empty() {
            if is_over() {
                return None;
            }
            let across = |&index: &usize| dot(&rest[index], &rest[index]);
            let farthest = (0..left.len()).max_by(|&a, &b| across(&left[a]).total_cmp(&across(&left[b])))?;
            let next = left.swap_remove(farthest);
            let (mut direction, mut column) = (std::mem::take(&mut rest[next]), std::mem::take(&mut entries[next]));
            // The second turn removes the rounding of the first.
            for (entry, before) in column.iter_mut().zip(&directions) {
                *entry += take_out(&mut direction, before);
            }
            let length = norm(&direction);
            found.close(next, column, length);
            if length > 0.0 {
                direction.iter_mut().for_each(|value| *value /= length);
            }
            for &index in &left {
                let share = take_out(&mut rest[index], &direction);
                entries[index].push(share);
            }
            directions.push(direction);
        }
        Some(found)
    }

    /// Appends a column of R with these entries above its diagonal entry.
    fn close(&mut self, index: usize, above: Vec<f64>, length: f64) {
        let weights = self.triangle.solve_upper(above.clone());
        let terms = weights.iter().fold(1.0, |sum, weight| sum + weight.abs());
        if length > CANCELLED_VECTOR * terms {
            self.triangle.push(above, length);
        } else {
            self.triangle.push_dependent(above, length);
        }
        self.order.push(index);
    }

    /// The length of `R'^-1 e_i`.
    fn inverse_length(&self, place: usize) -> f64 {
        let triangle = &self.triangle;
        if !triangle.independent()[place] {
            return f64::INFINITY;
        }
        let mut x = vec![1.0 / triangle.column(place)[place]];
        for next in place + 1..triangle.size() {
            let column = triangle.column(next);
            let above = &column[place..next];
            let share = dot(above, &x);
            if triangle.independent()[next] {
                x.push(-share / column[next]);
                continue;
            }
            let terms: f64 = above.iter().zip(&x).map(|(r, x)| (r * x).abs()).sum();
            if share.abs() > CANCELLED_VECTOR * terms {
                return f64::INFINITY;
            }
            x.push(0.0);
        }
        norm(&x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_known_beyond_half_the_digits() {
        let lengths = inverse_lengths(vec![vec![1e9, 1e-3, 0.0], vec![1e9, 0.0, 0.0], vec![0.0, 0.0, 4.0]], 0.0, || false);
        let close = |found: f64, exact: f64| (found / exact - 1.0).abs() < 1e-3;
        let lengths = lengths.unwrap();
        assert!(close(lengths[0], 1e3) && close(lengths[1], 1e3) && close(lengths[2], 0.25), "{lengths:?}");
    }

    #[test]
    fn products_give_the_lengths_of_clearly_independent_columns_and_of_no_others() {
        let columns =
            |off: f64| vec![vec![2.0, 1.0, 0.0, 0.5], vec![2.0, 1.0 + off, 0.0, 0.5], vec![0.0, 1.0, 4.0, 0.0]];
        let by_products = |off: f64| inverse_lengths_by_products(3, dense_factor::products(4, &columns(off).concat()), 0.0);
        for off in [1.0, 0.1] {
            let exact = inverse_lengths(columns(off), 0.0, || false).unwrap();
            for (found, exact) in by_products(off).unwrap().iter().zip(exact) {
                assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
            }
        }
        for off in [0.0, 1e-9, 1e-4] {
            assert_eq!(by_products(off), None, "{off}");
        }
    }

    #[test]
    fn lengths_are_above_those_of_all_columns_within_the_rounding() {
        let columns = |off: f64| vec![vec![1.0, 0.0], vec![1.0, 1e-3 - off]];
        let lengths = |off: f64, rounding: f64| inverse_lengths(columns(off), rounding, || false).unwrap();
        for off in [1e-6, 1e-4, 4e-4] {
            assert!(lengths(0.0, off).iter().zip(lengths(off, 0.0)).all(|(wide, moved)| *wide > moved), "{off}");
        }
        assert_eq!(lengths(0.0, 1e-3), [f64::INFINITY; 2]);
    }

    #[test]
    fn what_rounding_cannot_tell_from_a_dependence_has_no_length() {
        let columns = vec![vec![1e20, 1.0, 0.0], vec![1e20, 0.0, 0.0], vec![0.0, 0.0, 4.0]];
        assert_eq!(inverse_lengths(columns, 0.0, || false).unwrap(), [f64::INFINITY, f64::INFINITY, 0.25]);
    }
}
