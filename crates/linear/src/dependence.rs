//! The rows of a matrix that follow from others: exactly, for the given doubles, without a threshold.
//!
//! Doubles are integers times powers of two, so elimination modulo a prime finds their rank. Rows that are independent
//! modulo a prime are independent. The converse fails if the prime divides a minor; this happens for about one minor in
//! 2^61.

use std::iter;

use super::SparseMatrix;

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
}
