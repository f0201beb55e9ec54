//! How far vectors are from the span of the others, by orthogonal directions: products of vectors would lose half the digits.

use super::dot;

/// What is left of a vector across the others is rounding where it is below this share of the terms that cancel.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// `sqrt((Z'Z)^-1_ii)`, one over the distance of column i of Z from the span of the others, for independent columns. It is
/// infinite for columns with a share in what rounding cannot tell from a dependence. `None` where it `is_over` before.
///
/// # Source
/// Å. Björck, *Numerics of Gram-Schmidt orthogonalization*, Linear Algebra Appl. 197/198 (1994) 297-316.
pub fn inverse_lengths(columns: Vec<Vec<f64>>, is_over: impl Fn() -> bool) -> Option<Vec<f64>> {
    let sizes: Vec<f64> = columns.iter().map(|column| dot(column, column).sqrt()).collect();
    if sizes.iter().any(|size| !size.is_normal()) {
        return Some(vec![f64::INFINITY; sizes.len()]);
    }
    let triangle = Triangle::of(columns, &sizes, &is_over)?;
    let mut lengths = vec![f64::INFINITY; sizes.len()];
    for (place, &column) in triangle.order.iter().enumerate() {
        if is_over() {
            return None;
        }
        lengths[column] = triangle.inverse_length(place) / sizes[column];
    }
    Some(lengths)
}

/// R of the columns, each of length one, the farthest from the span of those before it first.
struct Triangle {
    order: Vec<usize>,
    /// The columns of R in that order, each down to its diagonal entry.
    columns: Vec<Vec<f64>>,
    /// Is the diagonal entry more than rounding?
    is_clear: Vec<bool>,
}

impl Triangle {
    fn of(mut rest: Vec<Vec<f64>>, sizes: &[f64], is_over: &impl Fn() -> bool) -> Option<Self> {
        for (column, size) in rest.iter_mut().zip(sizes) {
            column.iter_mut().for_each(|value| *value /= size);
        }
        let mut left: Vec<usize> = (0..rest.len()).collect();
        let mut entries: Vec<Vec<f64>> = vec![Vec::new(); rest.len()];
        let mut found = Triangle { order: Vec::new(), columns: Vec::new(), is_clear: Vec::new() };
        let mut directions: Vec<Vec<f64>> = Vec::new();
        while !left.is_empty() {
            if is_over() {
                return None;
            }
            let across = |&index: &usize| dot(&rest[index], &rest[index]);
            let farthest = (0..left.len()).max_by(|&a, &b| across(&left[a]).total_cmp(&across(&left[b])))?;
            let next = left.swap_remove(farthest);
            let (mut direction, mut column) = (std::mem::take(&mut rest[next]), std::mem::take(&mut entries[next]));
            // Rounding of the first turn is taken out.
            for (entry, before) in column.iter_mut().zip(&directions) {
                *entry += subtract(&mut direction, before);
            }
            let length = dot(&direction, &direction).sqrt();
            found.close(next, column, length);
            if length > 0.0 {
                direction.iter_mut().for_each(|value| *value /= length);
            }
            for &index in &left {
                let share = subtract(&mut rest[index], &direction);
                entries[index].push(share);
            }
            directions.push(direction);
        }
        Some(found)
    }

    /// Appends a column of R with this diagonal entry.
    fn close(&mut self, index: usize, mut column: Vec<f64>, length: f64) {
        let mut weights = column.clone();
        for (place, before) in self.columns.iter().enumerate().rev() {
            weights[place] = if self.is_clear[place] { weights[place] / before[place] } else { 0.0 };
            let weight = weights[place];
            weights[..place].iter_mut().zip(before).for_each(|(entry, r)| *entry -= r * weight);
        }
        let terms = weights.iter().fold(1.0, |sum, weight| sum + weight.abs());
        self.is_clear.push(length > ROUNDING * terms);
        column.push(length);
        self.order.push(index);
        self.columns.push(column);
    }

    /// The length of `R'^-1 e_i`.
    fn inverse_length(&self, place: usize) -> f64 {
        if !self.is_clear[place] {
            return f64::INFINITY;
        }
        let mut x = vec![1.0 / self.columns[place][place]];
        for (column, &is_clear) in self.columns.iter().zip(&self.is_clear).skip(place + 1) {
            let above = &column[place..column.len() - 1];
            let share = dot(above, &x);
            if is_clear {
                x.push(-share / column[column.len() - 1]);
                continue;
            }
            let terms: f64 = above.iter().zip(&x).map(|(r, x)| (r * x).abs()).sum();
            if share.abs() > ROUNDING * terms {
                return f64::INFINITY;
            }
            x.push(0.0);
        }
        dot(&x, &x).sqrt()
    }
}

/// Takes the share of a direction out of a vector.
fn subtract(vector: &mut [f64], direction: &[f64]) -> f64 {
    let share = dot(vector, direction);
    vector.iter_mut().zip(direction).for_each(|(value, d)| *value -= share * d);
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_known_beyond_half_the_digits() {
        let lengths = inverse_lengths(vec![vec![1e9, 1e-3, 0.0], vec![1e9, 0.0, 0.0], vec![0.0, 0.0, 4.0]], || false);
        let close = |found: f64, exact: f64| (found / exact - 1.0).abs() < 1e-3;
        let lengths = lengths.unwrap();
        assert!(close(lengths[0], 1e3) && close(lengths[1], 1e3) && close(lengths[2], 0.25), "{lengths:?}");
    }

    #[test]
    fn what_rounding_cannot_tell_from_a_dependence_has_no_length() {
        let columns = vec![vec![1e20, 1.0, 0.0], vec![1e20, 0.0, 0.0], vec![0.0, 0.0, 4.0]];
        assert_eq!(inverse_lengths(columns, || false).unwrap(), [f64::INFINITY, f64::INFINITY, 0.25]);
    }
}
