//! The contact set: the closed rows of a problem, as bits.

use std::fmt;

/// The contact indicator C of the formulation: the closed rows of `rows` contact rows.
///
/// Stored as bits, so that a method can keep its whole history of sets.
#[derive(Clone, PartialEq, Eq, Hash, Default)]
pub struct ContactSet {
    rows: usize,
    bits: Vec<u64>,
}

impl ContactSet {
    /// The set of `rows` rows, all open.
    pub fn open(rows: usize) -> Self {
        ContactSet { rows, bits: vec![0; rows.div_ceil(64)] }
    }

    /// The set of `rows` rows, all closed.
    pub fn closed(rows: usize) -> Self {
        Self::from_fn(rows, |_| true)
    }

    /// The set of `rows` rows in which row `i` is closed if `closed(i)` is `true`.
    pub fn from_fn(rows: usize, mut closed: impl FnMut(usize) -> bool) -> Self {
        let mut set = Self::open(rows);
        (0..rows).filter(|&row| closed(row)).for_each(|row| set.insert(row));
        set
    }

    /// Number of contact rows, closed or open.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of closed rows in the set.
    pub fn count(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Returns `true` if row `row` is closed. Rows beyond the last are open.
    pub fn contains(&self, row: usize) -> bool {
        row < self.rows && self.bits[row / 64] >> (row % 64) & 1 == 1
    }

    /// Closes row `row`; a row beyond the last is ignored.
    pub fn insert(&mut self, row: usize) {
        if row < self.rows {
            self.bits[row / 64] |= 1 << (row % 64);
        }
    }

    /// Opens row `row`; a row beyond the last is ignored.
    pub fn remove(&mut self, row: usize) {
        if row < self.rows {
            self.bits[row / 64] &= !(1 << (row % 64));
        }
    }

    /// Closes row `row` if it is open, and opens it if it is closed; a row beyond the last is ignored.
    pub fn toggle(&mut self, row: usize) {
        if row < self.rows {
            self.bits[row / 64] ^= 1 << (row % 64);
        }
    }

    /// The closed rows in increasing order.
    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.rows).filter(|&row| self.contains(row))
    }
}

/// One flag for each row: `true` if it is closed.
impl FromIterator<bool> for ContactSet {
    fn from_iter<I: IntoIterator<Item = bool>>(closed: I) -> Self {
        let flags: Vec<bool> = closed.into_iter().collect();
        Self::from_fn(flags.len(), |row| flags[row])
    }
}

/// The closed rows, as [`ContactSet::iter`].
impl<'a> IntoIterator for &'a ContactSet {
    type Item = usize;
    type IntoIter = Box<dyn Iterator<Item = usize> + 'a>;

    fn into_iter(self) -> Self::IntoIter {
        Box::new(self.iter())
    }
}

impl fmt::Debug for ContactSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of {}", self.iter().collect::<Vec<_>>(), self.rows)
    }
}
