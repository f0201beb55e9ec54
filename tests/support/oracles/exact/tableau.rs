//! Integer-preserving pivoting (Edmonds, Bareiss): every entry is a minor of the initial integers.
//!
//! # Source
//! E. H. Bareiss, *Sylvester's identity and multistep integer-preserving Gaussian elimination*, Math. Comp. 22 (1968),
//! 565-578.

use num_bigint::BigInt;

use super::dyadic::sign;

/// Basic variables as affine functions of the others: `basic_i = (a_i0 + sum_j a_ij other_j) / denominator`.
#[derive(Clone, Debug)]
pub struct Tableau<V> {
    pub rows: Vec<Vec<BigInt>>,
    pub denominator: BigInt,
    pub basic: Vec<V>,
    /// The variable of each column except the first.
    pub others: Vec<V>,
}

impl<V: Copy> Tableau<V> {
    pub fn new(rows: Vec<Vec<BigInt>>, basic: Vec<V>, others: Vec<V>) -> Self {
        Tableau { rows, denominator: 1.into(), basic, others }
    }

    /// The coefficient of variable `other` in basic variable `basic`, both by index.
    pub fn entry(&self, basic: usize, other: usize) -> &BigInt {
        &self.rows[basic][other + 1]
    }

    /// Exchanges a basic variable with another, by index; their common entry must not be zero.
    pub fn pivot(&mut self, basic: usize, other: usize) {
        let column = other + 1;
        let flip = match sign(&self.rows[basic][column]) {
            0 => panic!("a pivot is zero"),
            sign => sign < 0,
        };
        let pivot_row = std::mem::take(&mut self.rows[basic]);
        let pivot = if flip { -&pivot_row[column] } else { pivot_row[column].clone() };
        for row in self.rows.iter_mut().filter(|row| !row.is_empty()) {
            let factor = if flip { -&row[column] } else { row[column].clone() };
            let is_zero = sign(&factor) == 0;
            for (place, (entry, of_pivot)) in row.iter_mut().zip(&pivot_row).enumerate() {
                if place == column {
                    // The pivot carries the sign of the denominator.
                    *entry = factor.clone();
                    continue;
                }
                let mut value = &*entry * &pivot;
                if !is_zero && sign(of_pivot) != 0 {
                    value -= &factor * of_pivot;
                }
                *entry = value / &self.denominator;
            }
        }
        let negated = |value: BigInt| if flip { value } else { -value };
        self.rows[basic] = pivot_row.into_iter().map(negated).collect();
        self.rows[basic][column] = if flip { -&self.denominator } else { self.denominator.clone() };
        self.denominator = pivot;
        std::mem::swap(&mut self.basic[basic], &mut self.others[other]);
    }

    /// Removes a variable that is zero.
    pub fn drop_other(&mut self, other: usize) {
        self.others.remove(other);
        self.rows.iter_mut().for_each(|row| drop(row.remove(other + 1)));
    }

    /// Takes out a basic variable, and returns its row.
    pub fn take_basic(&mut self, basic: usize) -> Vec<BigInt> {
        self.basic.remove(basic);
        self.rows.remove(basic)
    }
}

/// The rank of a matrix of integers.
pub fn rank(rows: Vec<Vec<BigInt>>) -> usize {
    let columns = rows.first().map_or(0, Vec::len);
    let with_constant = rows.into_iter().map(|row| [vec![BigInt::ZERO], row].concat()).collect::<Vec<_>>();
    let count = with_constant.len();
    let mut tableau = Tableau::new(with_constant, vec![(); count], vec![(); columns]);
    let mut used = vec![false; count];
    for column in 0..columns {
        let place = (0..count).find(|&row| !used[row] && sign(tableau.entry(row, column)) != 0);
        if let Some(row) = place {
            tableau.pivot(row, column);
            used[row] = true;
        }
    }
    used.iter().filter(|&&used| used).count()
}
