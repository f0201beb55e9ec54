//! Lemke's method with the lexicographic rule, on a dense tableau. It ends in a solution or a ray. A ray
//! proves something only if M is monotone; no caller takes it as a proof without a check.
//!
//! Bounds become nonnegative unknowns: z = l + x or z = u - x; an unknown between two bounds also has its slack
//! v = u - l - x, with the negative part of w as its complement. One without bounds is basic from the start and never
//! leaves; if that cannot be, it is a difference of two.
//!
//! # Source
//! R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem* (1992), sections 4.4 and 4.9.

use signorini_qp::Settings;

use crate::answer::Found;
use crate::basis::check_size;
use crate::error::Error;
use crate::scaled::Scaled;

/// Entries below this share of the largest of their column, and differences of ratios below it, are rounding.
const ROUNDING: f64 = 1e-11;

/// Constants below this, of the largest at the start, and entries of the inverse of the basis are zero.
const ZERO: f64 = 1e-13;

/// A pivot of the start below this is zero, in scaled units.
const SINGULAR: f64 = 1e-6;

/// Its multiples are spread evenly over the fractions.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The unknown x of a column: the unknown of the problem, and the sign by which it enters; of a slack its place.
#[derive(Clone, Copy)]
enum Column {
    Part { of: usize, sign: f64 },
    Slack { of: usize },
}

/// Basic variables as affine functions of the others: each row has their coefficients, and its constant at the end. The
/// variables 0..N are x, N..2N their complements, 2N is the artificial one.
struct Tableau {
    rows: Vec<Vec<f64>>,
    basic: Vec<usize>,
    others: Vec<usize>,
    /// The variables x without bounds.
    free: Vec<bool>,
    /// The unit of the constants.
    unit: f64,
}

impl Tableau {
    fn pivot(&mut self, place: usize, column: usize) {
        let mut own = std::mem::take(&mut self.rows[place]);
        let pivot = own[column];
        own[column] = -1.0;
        own.iter_mut().for_each(|entry| *entry /= -pivot);
        for row in self.rows.iter_mut().filter(|row| !row.is_empty() && row[column] != 0.0) {
            let factor = std::mem::take(&mut row[column]);
            row.iter_mut().zip(&own).for_each(|(entry, own)| *entry += factor * own);
        }
        self.rows[place] = own;
        std::mem::swap(&mut self.basic[place], &mut self.others[column]);
    }

    fn is_free(&self, place: usize) -> bool {
        self.free.get(self.basic[place]) == Some(&true)
    }

    /// Exchanges these variables x for their complements, by principal blocks of one or two; `false` if some are left.
    fn exchange(&mut self, mut left: Vec<usize>) -> bool {
        let mut is_whole = true;
        loop {
            let size = |row: usize, column: usize| self.rows[row][column].abs();
            let best = (0..left.len()).max_by(|&a, &b| size(left[a], left[a]).total_cmp(&size(left[b], left[b])));
            let Some(best) = best else { return is_whole };
            let k = left.swap_remove(best);
            let of_two = |l: usize| size(k, l).min(size(l, k));
            let other = (0..left.len()).max_by(|&a, &b| of_two(left[a]).total_cmp(&of_two(left[b])));
            match other.filter(|&at| of_two(left[at]) > SINGULAR) {
                _ if size(k, k) > SINGULAR => self.pivot(k, k),
                Some(at) => {
                    let l = left.swap_remove(at);
                    self.pivot(k, l);
                    self.pivot(l, k);
                }
                None => is_whole = false,
            }
        }
    }

    /// Gives the artificial variable a column, and the constants a unit. Slacks do not need it: the first attempt,
    /// without it, finds a point for every matrix if each unknown has two bounds.
    fn cover(&mut self, columns: &[Column], attempt: usize) {
        let count = self.rows.len();
        let is_slack =
            |place: usize| matches!(columns.get(self.basic[place].wrapping_sub(count)), Some(Column::Slack { .. }));
        let is_covered = |place: &usize| !self.is_free(*place) && (attempt > 0 || !is_slack(*place));
        let places: Vec<usize> = (0..count).filter(is_covered).collect();
        self.unit = self.rows.iter().map(|row| row[count + 1].abs()).fold(f64::MIN_POSITIVE, f64::max);
        self.rows.iter_mut().for_each(|row| row[count + 1] /= self.unit);
        for place in places {
            self.rows[place][count] = 1.0 + (GOLDEN * ((place + 1) * (attempt + 1)) as f64).fract();
        }
    }

    /// The basic variable that becomes zero first as the variable at `column` grows, by the lexicographic rule; the
    /// artificial one as soon as it may.
    fn first_to_vanish(&self, column: usize) -> Option<usize> {
        let count = self.rows.len();
        let largest = self.rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max);
        let is_falling = |place: &usize| self.rows[*place][column] < -ROUNDING * largest && !self.is_free(*place);
        let falling: Vec<usize> = (0..count).filter(is_falling).collect();
        let ratio = |place: usize| {
            let constant = self.rows[place][count + 1];
            if constant.abs() > ZERO { -constant / self.rows[place][column] } else { 0.0 }
        };
        let best = falling.iter().copied().min_by(|&a, &b| ratio(a).total_cmp(&ratio(b)))?;
        let most = ratio(best) + ROUNDING * ratio(best).abs();
        let artificial = falling.into_iter().find(|&place| self.basic[place] == 2 * count);
        artificial.filter(|&place| ratio(place) <= most).or(Some(best))
    }
}

/// A point of a problem with any matrix, if the method ends in one. Each `attempt` has its own artificial column, and
/// so its own way; the entries of the column differ, which leaves few ties.
///
/// # Errors
/// [`Error::TooLarge`].
pub fn lemke(scaled: &Scaled, attempt: usize, allowed: f64, settings: &Settings) -> Result<Found, Error> {
    let (mut tableau, columns) = start(scaled, allowed)?;
    let count = columns.len();
    let is_drawn = |k: &usize| attempt > 0 && (GOLDEN * ((k + 1) * (attempt + 1)) as f64).fract() < 0.5;
    tableau.exchange((0..count).filter(|k| !tableau.free[*k] && is_drawn(k)).collect());
    tableau.cover(&columns, attempt);
    let end = |reason: &str| Ok(Found::Nothing(format!("Lemke's method {reason}")));
    let needed = |place: usize| tableau.rows[place][count + 1] / tableau.rows[place][count];
    let places = (0..count).rev().filter(|&place| tableau.rows[place][count] > 0.0);
    let lowest = places.min_by(|&a, &b| needed(a).total_cmp(&needed(b)));
    let Some(lowest) = lowest.filter(|&place| needed(place) < 0.0) else {
        return Ok(point(&tableau, scaled, &columns, 0));
    };
    let complement = |variable: usize| if variable < count { variable + count } else { variable - count };
    let mut entering = complement(tableau.basic[lowest]);
    tableau.pivot(lowest, count);
    for step in 1..=settings.max_iterations {
        if settings.watch.is_over() {
            return end("was stopped");
        }
        let Some(column) = tableau.others.iter().position(|&other| other == entering) else {
            return end("lost its basis to rounding");
        };
        let Some(leaving) = tableau.first_to_vanish(column) else {
            return Ok(Found::Ray(ray(&tableau, column, &columns, scaled.lower.len())));
        };
        let left = tableau.basic[leaving];
        tableau.pivot(leaving, column);
        if left == 2 * count {
            return Ok(point(&tableau, scaled, &columns, step));
        }
        entering = complement(left);
    }
    end("used up its pivots")
}

/// The bound from which an unknown is measured.
fn base(scaled: &Scaled, of: usize) -> f64 {
    let (lower, upper) = (scaled.lower[of], scaled.upper[of]);
    if lower.is_finite() {
        lower
    } else if upper.is_finite() {
        upper
    } else {
        0.0
    }
}

/// The first tableau, without its artificial column. Unknowns without bounds are basic, or differences of two if their
/// block is singular.
///
/// # Errors
/// [`Error::TooLarge`].
fn start(scaled: &Scaled, allowed: f64) -> Result<(Tableau, Vec<Column>), Error> {
    let (mut tableau, columns) = standard(scaled, false, allowed)?;
    let free: Vec<usize> = (0..columns.len()).filter(|&k| tableau.free[k]).collect();
    if tableau.exchange(free) { Ok((tableau, columns)) } else { standard(scaled, true, allowed) }
}

fn standard(scaled: &Scaled, is_split: bool, allowed: f64) -> Result<(Tableau, Vec<Column>), Error> {
    let n = scaled.lower.len();
    let mut columns = Vec::new();
    for of in 0..n {
        let (is_above, is_below) = (scaled.lower[of].is_finite(), scaled.upper[of].is_finite());
        columns.push(Column::Part { of, sign: if is_below && !is_above { -1.0 } else { 1.0 } });
        match (is_above, is_below) {
            (true, true) => columns.push(Column::Slack { of }),
            (false, false) if is_split => columns.push(Column::Part { of, sign: -1.0 }),
            _ => {}
        }
    }
    let count = columns.len();
    check_size(count, count, allowed)?;
    let mut at = vec![Vec::new(); n];
    let mut rows = vec![vec![0.0; count + 2]; count];
    let bases: Vec<f64> = (0..n).map(|of| base(scaled, of)).collect();
    let moved = scaled.matrix.mul(&bases);
    for (k, column) in columns.iter().enumerate() {
        rows[k][count + 1] = match *column {
            Column::Part { of, sign } => {
                at[of].push((k, sign));
                sign * (scaled.offset[of] + moved[of])
            }
            Column::Slack { of } => {
                // v = u - l - x, and w+ = w + w-.
                (rows[k][k - 1], rows[k - 1][k]) = (-1.0, 1.0);
                scaled.upper[of] - scaled.lower[of]
            }
        };
    }
    for (i, j, value) in scaled.matrix.triplets() {
        for &(row, of_row) in &at[i] {
            at[j].iter().for_each(|&(column, of_column)| rows[row][column] = of_row * of_column * value);
        }
    }
    let is_free = |of: usize| scaled.lower[of].is_infinite() && scaled.upper[of].is_infinite();
    let is_free = |column: &Column| matches!(*column, Column::Part { of, .. } if !is_split && is_free(of));
    let free = columns.iter().map(is_free).collect();
    let (basic, others) = ((count..2 * count).collect(), (0..count).chain([2 * count]).collect());
    Ok((Tableau { rows, basic, others, free, unit: 1.0 }, columns))
}

/// The direction of the unknowns along the ray of a column. If M is monotone it is the y that shows that there is no
/// solution (section 4.4 of the source): y'(M + M')y = 0 along it.
fn ray(tableau: &Tableau, column: usize, columns: &[Column], unknowns: usize) -> Vec<f64> {
    let rates = tableau.rows.iter().map(|row| row[column]).chain([1.0]);
    let mut ray = vec![0.0; unknowns];
    for (variable, rate) in tableau.basic.iter().chain([&tableau.others[column]]).zip(rates) {
        if let Some(Column::Part { of, sign }) = columns.get(*variable) {
            ray[*of] += sign * rate;
        }
    }
    ray
}

/// The point of the last tableau, in units of z.
fn point(tableau: &Tableau, scaled: &Scaled, columns: &[Column], iterations: usize) -> Found {
    let count = columns.len();
    let mut z: Vec<f64> = (0..scaled.lower.len()).map(|of| base(scaled, of)).collect();
    for (row, &basic) in tableau.rows.iter().zip(&tableau.basic) {
        if let Some(&Column::Part { of, sign }) = columns.get(basic) {
            z[of] += sign * row[count + 1] * tableau.unit;
        }
    }
    z.iter_mut().zip(&scaled.column).for_each(|(z, unit)| *z *= unit);
    Found::Point { z, iterations }
}
