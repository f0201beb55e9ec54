//! Compressed columns: where each starts, and the check of their order and values, with indices of any type.

use crate::error::Error;

/// The start of each of `count` groups among all members, and the number of members at the end, from the group of each
/// member.
pub fn group_starts(count: usize, groups: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut starts = vec![0; count + 1];
    groups.for_each(|group| starts[group + 1] += 1);
    (0..count).for_each(|group| starts[group + 1] += starts[group]);
    starts
}

/// The start of each of `count` groups, and the members of one group after another, each in increasing order.
pub fn grouped(count: usize, of_member: &[u32]) -> (Vec<usize>, Vec<usize>) {
    let starts = group_starts(count, of_member.iter().map(|&group| group as usize));
    let mut next = starts.clone();
    let mut members = vec![0; of_member.len()];
    for (member, &group) in of_member.iter().enumerate() {
        members[next[group as usize]] = member;
        next[group as usize] += 1;
    }
    (starts, members)
}

/// The place of each column in an order of all.
pub fn places(order: &[usize]) -> Vec<usize> {
    let mut places = vec![0; order.len()];
    order.iter().enumerate().for_each(|(place, &column)| places[column] = place);
    places
}

/// Compressed columns with indices of any type, as given.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns<'a, S, R> {
    pub starts: &'a [S],
    pub rows: &'a [R],
    pub values: &'a [f64],
}

/// The triangle that gives the values if mirrored entries differ by rounding: the lower one for columns, the upper one
/// for rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Taken {
    Lower,
    Upper,
}

impl<S: Copy + TryInto<usize>, R: Copy + TryInto<usize>> Columns<'_, S, R> {
    /// Calls `take(column, rows, values)` for each column, from the first on.
    pub fn each(self, mut take: impl FnMut(usize, &[R], &[f64]) -> Result<(), Error>) -> Result<(), Error> {
        let (columns, entries) = (self.starts.len().saturating_sub(1), self.values.len());
        Error::check_length("row indices", self.rows.len(), entries, "values")?;
        if self.starts.is_empty() || self.start(0)? != 0 || self.start(columns)? != entries {
            let message = format!("the column starts must begin with 0 and end with the number of values, {entries}");
            return Err(Error::Pattern { message });
        }
        let mut first = 0;
        for column in 0..columns {
            let end = self.start(column + 1)?;
            let (Some(rows), Some(values)) = (self.rows.get(first..end), self.values.get(first..end)) else {
                let message = format!("the column starts decrease after column {column} (indices from 0)");
                return Err(Error::Pattern { message });
            };
            take(column, rows, values)?;
            first = end;
        }
        Ok(())
    }

    fn start(&self, column: usize) -> Result<usize, Error> {
        let start = self.starts.get(column).and_then(|&start| start.try_into().ok());
        start.ok_or_else(|| Error::Pattern { message: format!("the start of column {column} is no index (from 0)") })
    }
}

impl Taken {
    /// Checks that the indices of a line increase and lie inside a matrix of this shape, and that its values are
    /// finite.
    pub fn check<I: Copy + TryInto<usize>>(
        self,
        (rows, columns): (usize, usize),
        number: usize,
        indices: &[I],
        values: &[f64],
    ) -> Result<(), Error> {
        // A walked line of the matrix is a row or a column; this names its entries in errors.
        let [line, entry] = match self {
            Taken::Lower => ["column", "row"],
            Taken::Upper => ["row", "column"],
        };
        let mut least = 0;
        let mut fits = |(&index, value): (&I, &f64)| {
            let index: usize = index.try_into().unwrap_or(usize::MAX);
            let fits = (least..rows).contains(&index) && value.is_finite();
            least = index.saturating_add(1);
            fits
        };
        let Some(at) = indices.iter().zip(values).position(|entry| !fits(entry)) else { return Ok(()) };
        let Ok(index) = indices[at].try_into() else {
            let message = format!("a {entry} of {line} {number} is negative (indices from 0)");
            return Err(Error::Pattern { message });
        };
        let place = self.place(index, number);
        if index >= rows {
            return Err(Error::IndexOutOfRange { row: place.0, column: place.1, rows, columns });
        }
        let before = at.checked_sub(1).and_then(|before| indices[before].try_into().ok());
        if let Some(before) = before.filter(|&before| before >= index) {
            let where_to = format!("{entry} {index} of {line} {number} does not lie beyond {entry} {before}");
            return Err(Error::Pattern { message: format!("{where_to}, the one before (indices from 0)") });
        }
        let (at, value) = (format!("{place:?}"), values[at]);
        Err(Error::NotFinite { name: "matrix", at, value, allowed: "finite" })
    }

    /// Row and column of an entry, or of a pair of mirrored entries, in a line that is walked as a column.
    pub fn place<T>(self, row: T, column: T) -> (T, T) {
        match self {
            Taken::Lower => (row, column),
            Taken::Upper => (column, row),
        }
    }
}
