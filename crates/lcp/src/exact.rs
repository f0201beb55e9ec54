//! Elimination in integers: what decides on a small matrix that is singular, and on its rays, where rounding cannot.

/// Binary digits of the integers at the start.
const DIGITS: i32 = 60;

/// Where several rays meet, their shares are multiples of this part of the largest.
const SHARES: f64 = 1024.0;

/// Rows of integers over one denominator.
///
/// # Source
/// E. H. Bareiss, *Sylvester's identity and multistep integer-preserving Gaussian elimination*, Math. Comput. 22 (1968)
/// 565-578: every division is exact.
struct Exact {
    rows: Vec<Vec<i128>>,
    denominator: i128,
}

impl Exact {
    /// The rows, with entries of order one, times a power of two; `None` if that does not make them integers.
    fn of(rows: &[Vec<f64>]) -> Option<Self> {
        let is_whole = |unit: &f64| rows.iter().flatten().all(|value| (value * unit).fract() == 0.0);
        let unit = (0..=DIGITS).map(|digits| f64::from(digits).exp2()).find(is_whole)?;
        let fits = |value: &f64| (value * unit).abs() < f64::from(DIGITS).exp2();
        let whole = |row: &Vec<f64>| row.iter().map(|value| (value * unit) as i128).collect();
        let fit = rows.iter().flatten().all(fits);
        fit.then(|| Exact { rows: rows.iter().map(whole).collect(), denominator: 1 })
    }

    /// Takes a column out of all other rows; `None` if a number leaves the range.
    fn pivot(&mut self, row: usize, column: usize) -> Option<()> {
        let own = self.rows[row].clone();
        for (_, other) in self.rows.iter_mut().enumerate().filter(|(i, _)| *i != row) {
            let factor = other[column];
            for (entry, own_entry) in other.iter_mut().zip(&own) {
                let product = entry.checked_mul(own[column])?;
                *entry = product.checked_sub(factor.checked_mul(*own_entry)?)? / self.denominator;
            }
        }
        self.denominator = own[column];
        Some(())
    }
}

/// `Some(true)` if A + A' is positive definite, `Some(false)` if it is singular and semidefinite, `None` if it is
/// indefinite or the integers do not decide.
pub fn is_definite(rows: &[Vec<f64>]) -> Option<bool> {
    let (n, Exact { rows: a, denominator }) = (rows.len(), Exact::of(rows)?);
    let sums = (0..n).map(|i| (0..n).map(|j| a[i][j] + a[j][i]).collect()).collect();
    let (mut exact, mut is_definite) = (Exact { rows: sums, denominator }, true);
    for k in 0..n {
        let row = &exact.rows[k];
        // Beside a zero on its diagonal, a semidefinite matrix has zeros.
        if row[k] < 0 || (row[k] == 0 && row[k..].iter().any(|&entry| entry != 0)) {
            return None;
        }
        match row[k] {
            0 => is_definite = false,
            _ => exact.pivot(k, k)?,
        }
    }
    Some(is_definite)
}

/// An integer vector y with A y = 0 near one for which that holds to rounding.
pub fn null_vector(rows: &[Vec<f64>], near: &[f64]) -> Option<Vec<f64>> {
    let mut exact = Exact::of(rows)?;
    let mut held = vec![None; near.len()];
    for row in 0..rows.len() {
        if let Some(column) = exact.rows[row].iter().position(|&entry| entry != 0) {
            exact.pivot(row, column)?;
            held[column] = Some(row);
        }
    }
    let largest = near.iter().fold(0.0, |largest: f64, y| largest.max(y.abs()));
    let share = |k: usize| if held[k].is_none() { (near[k] / largest * SHARES).round() as i128 } else { 0 };
    let value = |k: usize| match held[k] {
        None => exact.denominator.checked_mul(share(k)),
        Some(row) => (0..near.len())
            .try_fold(0_i128, |sum, free| sum.checked_sub(exact.rows[row][free].checked_mul(share(free))?)),
    };
    let values: Vec<i128> = (0..near.len()).map(value).collect::<Option<_>>()?;
    let common = values.iter().fold(0, |common, &value| divisor(common, value)).max(1) * exact.denominator.signum();
    let rounded = |value: i128| Some((value / common) as f64).filter(|&y| y as i128 == value / common);
    values.into_iter().map(rounded).collect()
}

/// The greatest common divisor.
fn divisor(a: i128, b: i128) -> i128 {
    if b == 0 { a.saturating_abs() } else { divisor(b, a % b) }
}
