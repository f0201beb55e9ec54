//! The rows of a matrix that follow from others: exactly, for the given doubles, without a threshold. And the distance
//! of vectors from the span of the others, by orthogonal directions: products of vectors would lose half the digits.
//!
//! Doubles are integers times powers of two, so elimination modulo a prime finds their rank. Rows that are independent
//! modulo a prime are independent. The converse fails if the prime divides a minor; this happens for about one minor in
//! 2^61.

use std::iter;

use super::dense::wide_dot;
use super::{SparseMatrix, UpperTriangle, dot, factor, norm, take_out};

/// `2^61 - 1`, a prime: a power of two is a rotation of 61 bits.
const PRIME: u64 = (1 << BITS) - 1;

const BITS: i32 = 61;

/// Which rows of a matrix follow from others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dependence {
    /// A basis: rows that do not follow from those before them.
    pub independent: Vec<bool>,
    /// Rows that take part in some dependence; the others follow from no set of rows.
    pub takes_part: Vec<bool>,
}

/// A sparse vector modulo the prime, places increasing.
type Residues = Vec<(usize, u64)>;

impl Dependence {
    /// The dependence of some `rows` of a matrix, in this order; `None` if it `is_over` before it is found.
    pub fn of(matrix: &SparseMatrix, rows: &[usize], is_over: impl Fn() -> bool) -> Option<Self> {
        let by_row = matrix.transposed();
        let mut found = Dependence { independent: vec![false; rows.len()], takes_part: vec![false; rows.len()] };
        // Rows in echelon form by their first column, each with the rows of the matrix of which it is the combination.
        let mut echelon: Vec<Option<(Residues, Residues)>> = vec![None; matrix.columns()];
        for (index, &row) in rows.iter().enumerate() {
            if is_over() {
                return None;
            }
            let entries = by_row.column(row).map(|(column, value)| (column, residue(value)));
            let mut rest: Residues = entries.filter(|entry| entry.1 != 0).collect();
            let mut made_of: Residues = vec![(index, 1)];
            while let Some(&(first, value)) = rest.first() {
                let Some((pivot, pivot_of)) = &echelon[first] else { break };
                let share = PRIME - value;
                rest = plus(&rest, share, pivot);
                made_of = plus(&made_of, share, pivot_of);
            }
            match rest.first() {
                Some(&(first, value)) => {
                    let inverse = power(value, PRIME - 2);
                    for entry in rest.iter_mut().chain(&mut made_of) {
                        entry.1 = times(entry.1, inverse);
                    }
                    echelon[first] = Some((rest, made_of));
                    found.independent[index] = true;
                }
                None => made_of.iter().for_each(|&(member, _)| found.takes_part[member] = true),
            }
        }
        Some(found)
    }
}

/// A finite double modulo the prime.
fn residue(value: f64) -> u64 {
    let bits = value.to_bits();
    let (biased, fraction) = (((bits >> 52) & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | (1 << 52), biased - 1075) };
    let magnitude = times(mantissa, 1 << exponent.rem_euclid(BITS));
    if value < 0.0 && magnitude != 0 { PRIME - magnitude } else { magnitude }
}

fn times(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    let folded = (product as u64 & PRIME) + (product >> BITS) as u64;
    if folded >= PRIME { folded - PRIME } else { folded }
}

fn power(base: u64, mut exponent: u64) -> u64 {
    let (mut result, mut square) = (1, base);
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = times(result, square);
        }
        square = times(square, square);
        exponent >>= 1;
    }
    result
}

/// `a + share b`, without zeros.
fn plus(a: &Residues, share: u64, b: &Residues) -> Residues {
    let sum = |(place, a, b): (usize, Option<u64>, Option<u64>)| {
        let value = a.unwrap_or(0) + b.map_or(0, |value| times(value, share));
        (place, if value >= PRIME { value - PRIME } else { value })
    };
    merged(a.iter().copied(), b.iter().copied()).map(sum).filter(|entry| entry.1 != 0).collect()
}

/// The entries of two sparse vectors at the places of either; places increase.
pub fn merged<T: Copy>(
    a: impl Iterator<Item = (usize, T)>,
    b: impl Iterator<Item = (usize, T)>,
) -> impl Iterator<Item = (usize, Option<T>, Option<T>)> {
    let (mut a, mut b) = (a.peekable(), b.peekable());
    iter::from_fn(move || {
        let place = a.peek().into_iter().chain(b.peek()).map(|entry| entry.0).min()?;
        let [a, b] = [a.next_if(|entry| entry.0 == place), b.next_if(|entry| entry.0 == place)];
        Some((place, a.map(|entry| entry.1), b.map(|entry| entry.1)))
    })
}

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
    let (order, triangle) = ordered(columns, &sizes, &is_over)?;
    let mut lengths = vec![f64::INFINITY; sizes.len()];
    for (place, &column) in order.iter().enumerate() {
        if is_over() {
            return None;
        }
        lengths[column] = inverse_length(&triangle, place);
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
    let triangle = factor::factorised_densely(count, products, 1).ok()?;
    let mut units = vec![0.0; count * count];
    (0..count).for_each(|place| units[place * count + place] = 1.0);
    let inverse = factor::forward_all(&triangle, units);
    let lengths: Vec<f64> = inverse.chunks(count.max(1)).map(|column| wide_dot(column, column).sqrt()).collect();
    let is_clear = lengths.iter().all(|&length| length <= CLEAR);
    is_clear.then(|| widened(lengths, &sizes, rounding))
}

/// The columns ordered so that the farthest from the span of those before it comes first, and R of them in that order,
/// each of length one. A column is independent if its diagonal entry is more than rounding.
fn ordered(mut rest: Vec<Vec<f64>>, sizes: &[f64], is_over: &impl Fn() -> bool) -> Option<(Vec<usize>, UpperTriangle)> {
    for (column, size) in rest.iter_mut().zip(sizes) {
        column.iter_mut().for_each(|value| *value /= size);
    }
    let mut left: Vec<usize> = (0..rest.len()).collect();
    let mut entries: Vec<Vec<f64>> = vec![Vec::new(); rest.len()];
    let (mut order, mut triangle) = (Vec::new(), UpperTriangle::default());
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
        let weights = triangle.solve_upper(column.clone());
        let terms = weights.iter().fold(1.0, |sum, weight| sum + weight.abs());
        match length > CANCELLED_VECTOR * terms {
            true => triangle.push(column, length),
            false => triangle.push_dependent(column, length),
        }
        order.push(next);
        if length > 0.0 {
            direction.iter_mut().for_each(|value| *value /= length);
        }
        for &index in &left {
            let share = take_out(&mut rest[index], &direction);
            entries[index].push(share);
        }
        directions.push(direction);
    }
    Some((order, triangle))
}

/// The length of `R'^-1 e_i`.
fn inverse_length(triangle: &UpperTriangle, place: usize) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn dependence<const N: usize>(rows: &[[f64; N]]) -> Dependence {
        let matrix = SparseMatrix::from_table(rows.len(), N, &rows.concat()).unwrap();
        Dependence::of(&matrix, &(0..rows.len()).collect::<Vec<_>>(), || false).unwrap()
    }

    #[test]
    fn rows_that_differ_in_the_last_bit_are_independent() {
        let found = dependence(&[[0.1, 0.2], [0.1, 0.2 + f64::EPSILON / 8.0], [1e-300, 0.0]]);
        assert_eq!(found.independent, [true, true, false]);
        let found = dependence(&[[0.1, 0.2], [0.1, 0.2 + f64::EPSILON / 4.0]]);
        assert_eq!(found, Dependence { independent: vec![true; 2], takes_part: vec![false; 2] });
    }

    #[test]
    fn only_rows_of_a_dependence_take_part() {
        let found = dependence(&[[0.1, -0.3, 0.0], [0.0, 0.0, 7.5], [-0.4, 1.2, 0.0], [0.0; 3]]);
        assert_eq!(found.independent, [true, true, false, false]);
        assert_eq!(found.takes_part, [true, false, true, true]);
    }

    #[test]
    fn a_length_is_known_beyond_half_the_digits() {
        let lengths =
            inverse_lengths(vec![vec![1e9, 1e-3, 0.0], vec![1e9, 0.0, 0.0], vec![0.0, 0.0, 4.0]], 0.0, || false);
        let close = |found: f64, exact: f64| (found / exact - 1.0).abs() < 1e-3;
        let lengths = lengths.unwrap();
        assert!(close(lengths[0], 1e3) && close(lengths[1], 1e3) && close(lengths[2], 0.25), "{lengths:?}");
    }

    #[test]
    fn products_give_the_lengths_of_clearly_independent_columns_and_of_no_others() {
        let columns =
            |off: f64| vec![vec![2.0, 1.0, 0.0, 0.5], vec![2.0, 1.0 + off, 0.0, 0.5], vec![0.0, 1.0, 4.0, 0.0]];
        let by_products = |off: f64| inverse_lengths_by_products(3, factor::products(4, &columns(off).concat()), 0.0);
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
