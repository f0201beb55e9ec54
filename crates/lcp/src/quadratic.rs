//! The convex programs behind a complementarity problem, solved by the QP: the energy of a symmetric M, the gap of a
//! monotone one. The rays that show that there is no point at all are found and checked here.

use signorini_qp::{
    ContactProblem, Error as QpError, Prepared, Settings, Solution, SparseMatrix, SymmetricMatrix, solve,
};

use crate::error::Error;
use crate::found::Found;
use crate::lemke::lemke;
use crate::problem::Lcp;
use crate::scaled::Scaled;

/// What each proximal step adds to the unit diagonal of a symmetric matrix.
const STEP: f64 = 1e-6;

/// Most proximal steps, and the change of the last one, relative.
const STEPS: usize = 20;
const SETTLED: f64 = 1e-13;

/// Sums that must vanish along a ray may keep this share of their terms, which are doubles.
const ROUNDING: f64 = 1e-12;

/// Entries of a ray below this share of the largest are rounding, in scaled units.
const DUST: f64 = 1e-14;

/// A ray that demands less than this share of its terms decides nothing.
const DECISIVE: f64 = 1e-9;

/// Inequalities `B x <= g` with an entry for each finite bound of x.
struct Rows {
    entries: Vec<(usize, usize, f64)>,
    gaps: Vec<f64>,
}

impl Rows {
    fn of_bounds(scaled: &Scaled) -> Self {
        let mut rows = Rows { entries: Vec::new(), gaps: Vec::new() };
        for (i, (&lower, &upper)) in scaled.lower.iter().zip(&scaled.upper).enumerate() {
            for (sign, bound) in [(-1.0, lower), (1.0, upper)] {
                if bound.is_finite() {
                    rows.push([(i, sign)], sign * bound);
                }
            }
        }
        rows
    }

    fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, gap: f64) {
        let row = self.gaps.len();
        self.entries.extend(entries.into_iter().map(|(column, value)| (row, column, value)));
        self.gaps.push(gap);
    }

    /// The rows that w must meet: nonnegative without an upper bound, nonpositive without a lower one; each has entries
    /// of order one, or else such a gap. The row of w and the factor of the demand, of each.
    fn push_signs(&mut self, scaled: &Scaled) -> Vec<(usize, f64)> {
        let by_rows = scaled.matrix.transposed();
        let mut demands = Vec::new();
        for (i, &offset) in scaled.offset.iter().enumerate() {
            let largest = by_rows.column(i).map(|entry| entry.1.abs()).fold(0.0, f64::max);
            let size = [largest, offset.abs()].into_iter().find(|&size| size > 0.0).unwrap_or(1.0);
            for (factor, bound) in [(1.0 / size, scaled.upper[i]), (-1.0 / size, scaled.lower[i])] {
                if bound.is_infinite() {
                    self.push(by_rows.column(i).map(|(j, value)| (j, -factor * value)), factor * offset);
                    demands.push((i, factor));
                }
            }
        }
        demands
    }

    fn problem(&self, stiffness: SymmetricMatrix, load: Vec<f64>) -> Result<ContactProblem, QpError> {
        let contact = SparseMatrix::from_triplets(self.gaps.len(), load.len(), &self.entries)?;
        ContactProblem::new(stiffness, load, contact, self.gaps.clone())
    }
}

/// Sorts the errors of a QP: what ends the search, and what leaves it to other methods.
fn found(scaled: &Scaled, answer: Result<Solution, QpError>, name: &str) -> Result<Found, Error> {
    let point = |solution: &Solution| {
        let z = solution.displacement.iter().zip(&scaled.column).map(|(x, unit)| x * unit).collect();
        Found::Point { z, places: None, iterations: solution.iterations }
    };
    match answer {
        Ok(solution) => Ok(point(&solution)),
        Err(QpError::NotCertified { solution, .. }) => Ok(point(&solution)),
        Err(QpError::Unbounded { direction, .. }) => Ok(Found::Ray(direction)),
        Err(
            error @ (QpError::Interrupted
            | QpError::OutOfTime { .. }
            | QpError::Setting { .. }
            | QpError::NoRoom { .. }
            | QpError::TooLarge { .. }),
        ) => Err(error.into()),
        Err(error) => Ok(Found::Nothing(format!("the {name} ended: {}", error.code()))),
    }
}

fn negative(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| -value).collect()
}

/// Minimises `1/2 x'A x + q'x` between the bounds, of a symmetric A.
///
/// # Errors
/// Those of the QP that are not about this problem.
pub fn quadratic_program(scaled: &Scaled, settings: &Settings) -> Result<Found, Error> {
    let problem = Rows::of_bounds(scaled).problem(scaled.symmetric_part(0.0)?, negative(&scaled.offset))?;
    found(scaled, solve(&problem, settings), "quadratic program")
}

/// The same for a singular A: by steps with a regular matrix, each from the last point, on one factor.
///
/// # Errors
/// As [`quadratic_program`].
pub fn proximal(scaled: &Scaled, settings: &Settings) -> Result<Found, Error> {
    let problem = Rows::of_bounds(scaled).problem(scaled.symmetric_part(STEP)?, negative(&scaled.offset))?;
    let prepared = Prepared::new(&problem, settings)?;
    let mut x = vec![0.0_f64; scaled.offset.len()];
    let mut last = Found::Nothing("no proximal step".into());
    for _ in 0..STEPS {
        let load = x.iter().zip(&scaled.offset).map(|(x, q)| STEP * x - q).collect();
        last = found(scaled, prepared.solve_load(load), "proximal step")?;
        let Found::Point { z, .. } = &last else { break };
        let next: Vec<f64> = z.iter().zip(&scaled.column).map(|(z, unit)| z / unit).collect();
        let is_settled = x.iter().zip(&next).all(|(x, next)| (x - next).abs() <= SETTLED * next.abs());
        x = next;
        if is_settled {
            break;
        }
    }
    Ok(last)
}

/// Minimises the gap `sum (x - l)_i (w_i)+ + (u - x)_i (-w_i)+` of a monotone A over the points that meet the
/// inequalities; in a solution it is zero. An unknown between two bounds brings its `(-w_i)+` as an unknown of its own.
///
/// # Errors
/// As [`quadratic_program`].
pub fn gap_program(scaled: &Scaled, settings: &Settings) -> Result<Found, Error> {
    let (n, lower, upper) = (scaled.offset.len(), &scaled.lower, &scaled.upper);
    let boxed: Vec<usize> = (0..n).filter(|&i| lower[i].is_finite() && upper[i].is_finite()).collect();
    let base = |i: usize| [lower[i], upper[i]].into_iter().find(|bound| bound.is_finite()).unwrap_or(0.0);
    let moved = scaled.matrix.mul_transposed(&(0..n).map(base).collect::<Vec<_>>());
    let mut load: Vec<f64> = moved.iter().zip(&scaled.offset).map(|(moved, q)| moved - q).collect();
    let mut rows = Rows::of_bounds(scaled);
    let bounds = rows.gaps.len();
    let demands = rows.push_signs(scaled);
    let by_rows = scaled.matrix.transposed();
    for &i in &boxed {
        let part = load.len();
        rows.push(by_rows.column(i).map(|(j, value)| (j, -value)).chain([(part, -1.0)]), scaled.offset[i]);
        rows.push([(part, -1.0)], 0.0);
        load.push(lower[i] - upper[i]);
    }
    let stiffness = scaled.symmetric_part(0.0)?.times(2.0)?.with_empty(boxed.len());
    match rows.problem(stiffness, load).and_then(|problem| solve(&problem, settings)) {
        Err(QpError::Infeasible { rows, weights, .. }) => {
            let mut ray = vec![0.0; n];
            for (row, weight) in rows.into_iter().zip(weights) {
                if let Some(&(i, factor)) = row.checked_sub(bounds).and_then(|place| demands.get(place)) {
                    ray[i] += factor * weight;
                }
            }
            Ok(Found::Ray(ray))
        }
        answer => found(scaled, answer, "gap program"),
    }
}

/// The ray that shows that no point meets the inequalities `B x <= g`, if there is one: Lemke's method on the skew
/// problem of x and y >= 0 with 0 = B'y and `g - B x >= 0`. Larger problems than it takes are not decided.
///
/// # Errors
/// Those of Lemke's method.
pub fn contradiction(lcp: &Lcp, scaled: &Scaled, allowed: f64, settings: &Settings) -> Result<Option<Error>, Error> {
    let n = scaled.offset.len();
    let mut rows = Rows::of_bounds(scaled);
    let bounds = rows.gaps.len();
    let demands = rows.push_signs(scaled);
    let size = n + rows.gaps.len();
    let both = rows.entries.iter().flat_map(|&(row, j, value)| [(n + row, j, -value), (j, n + row, value)]);
    let matrix = SparseMatrix::from_triplets(size, size, &both.collect::<Vec<_>>())?;
    let offset = [vec![0.0; n], rows.gaps].concat();
    let lower = (0..size).map(|k| if k < n { f64::NEG_INFINITY } else { 0.0 }).collect();
    let skew = Lcp::new(matrix, offset, lower, vec![f64::INFINITY; size])?;
    let end = match lemke(&Scaled::new(&skew, vec![1.0; size], vec![1.0; size]), 0, allowed, settings) {
        Err(Error::TooLarge { .. }) => return Ok(None),
        end => end?,
    };
    let Found::Ray(weights) = end else { return Ok(None) };
    let mut ray = vec![0.0; n];
    demands.iter().zip(&weights[n + bounds..]).for_each(|(&(i, factor), weight)| ray[i] += factor * weight);
    Ok(infeasible(lcp, scaled, &ray))
}

/// The error of a problem with this ray, in scaled units; `None` if it shows nothing.
pub fn infeasible(lcp: &Lcp, scaled: &Scaled, ray: &[f64]) -> Option<Error> {
    let (n, lower, upper) = (lcp.unknowns(), lcp.lower(), lcp.upper());
    let dust = DUST * ray.iter().fold(0.0, |largest: f64, y| largest.max(y.abs()));
    let ray: Vec<f64> = ray.iter().map(|&y| if y.abs() > dust { y } else { 0.0 }).collect();
    let largest = (0..n).map(|i| (ray[i] * scaled.row[i]).abs()).fold(0.0, f64::max);
    let allowed = |i: usize, y: f64| {
        let low = if upper[i].is_infinite() { f64::INFINITY } else { 0.0 };
        let high = if lower[i].is_infinite() { f64::INFINITY } else { 0.0 };
        y.clamp(-high, low)
    };
    let ray: Vec<f64> = (0..n).map(|i| allowed(i, ray[i] * scaled.row[i] / largest)).collect();
    let (sums, sizes) = (lcp.matrix().mul_transposed(&ray), lcp.matrix().mul_abs_transposed(&ray));
    let (mut needed, mut terms) = (0.0, 0.0);
    for i in 0..n {
        let bound = if sums[i] > 0.0 { upper[i] } else { lower[i] };
        let share = match bound.is_finite() {
            true => sums[i] * bound,
            // What should vanish is rounding.
            false if sums[i].abs() <= ROUNDING * sizes[i] => 0.0,
            false => return None,
        };
        for term in [ray[i] * lcp.offset()[i], share] {
            (needed, terms) = (needed - term, terms + term.abs());
        }
    }
    (needed > DECISIVE * terms).then_some(Error::Infeasible { ray, needed })
}
