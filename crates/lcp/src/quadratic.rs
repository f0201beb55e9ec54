//! The convex programs behind a complementarity problem, solved by the QP: that of a symmetric M, also with
//! multipliers, and the gap of a monotone one. The rays that show that there is no point are found and checked here.

use signorini_qp::{
    ContactProblem, Error as QpError, LinearError, Settings, SparseMatrix, SymmetricMatrix, largest, solve,
};

use crate::answer::Found;
use crate::class::{SMALL, dense};
use crate::error::Error;
use crate::exact::null_vector;
use crate::lemke::lemke;
use crate::problem::Lcp;
use crate::scaled::Scaled;

/// Sums below this share of their terms are taken for zero, and made so.
const ROUNDING: f64 = 1e-12;

/// What is added to the diagonal of a program that has many points.
const SHIFT: f64 = 1e-11;

/// Entries of a ray below this share of the largest are rounding, in scaled units.
const DUST: f64 = 1e-14;

/// A ray that demands less than this share of its terms decides nothing.
const DECISIVE: f64 = 1e-9;

/// A program in the unknowns that have a column.
struct Program<'a> {
    scaled: &'a Scaled,
    columns: Vec<Option<usize>>,
    load: Vec<f64>,
    /// The inequalities `B x <= g`.
    entries: Vec<(usize, usize, f64)>,
    gaps: Vec<f64>,
    /// Of a row that demands a sign of w its unknown, and the factor of the demand.
    demands: Vec<Option<(usize, f64)>>,
}

impl<'a> Program<'a> {
    /// The program in the unknowns that are no multipliers, with a row for each of their bounds.
    fn of(scaled: &'a Scaled, is_multiplier: impl Fn(usize) -> bool) -> Self {
        let n = scaled.offset.len();
        let own: Vec<usize> = (0..n).filter(|&i| !is_multiplier(i)).collect();
        let mut columns = vec![None; n];
        own.iter().enumerate().for_each(|(column, &i)| columns[i] = Some(column));
        let load = own.iter().map(|&i| -scaled.offset[i]).collect();
        let mut program = Program { scaled, columns, load, entries: Vec::new(), gaps: Vec::new(), demands: Vec::new() };
        for (column, i) in own.into_iter().enumerate() {
            for (sign, bound) in [(-1.0, scaled.lower[i]), (1.0, scaled.upper[i])] {
                if bound.is_finite() {
                    program.push([(column, sign)], sign * bound, None);
                }
            }
        }
        program
    }

    fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, gap: f64, demand: Option<(usize, f64)>) {
        let row = self.gaps.len();
        self.entries.extend(entries.into_iter().map(|(column, value)| (row, column, value)));
        self.gaps.push(gap);
        self.demands.push(demand);
    }

    /// Adds the rows that these w must meet: nonnegative without an upper bound, nonpositive without a lower one; each
    /// has entries of order one, or else such a gap.
    fn push_signs(&mut self, has_row: impl Fn(usize) -> bool) {
        let (scaled, by_rows) = (self.scaled, self.scaled.matrix.transposed());
        for i in (0..scaled.offset.len()).filter(|&i| has_row(i)) {
            let offset = scaled.offset[i];
            let largest = by_rows.column(i).map(|entry| entry.1.abs()).fold(0.0, f64::max);
            let size = [largest, offset.abs()].into_iter().find(|&size| size > 0.0).unwrap_or(1.0);
            for (factor, bound) in [(1.0 / size, scaled.upper[i]), (-1.0 / size, scaled.lower[i])] {
                if bound.is_infinite() {
                    let entries = by_rows.column(i).filter_map(|(j, value)| Some((self.columns[j]?, -factor * value)));
                    self.push(entries.collect::<Vec<_>>(), factor * offset, Some((i, factor)));
                }
            }
        }
    }

    /// The end of the program with a stiffness; it sorts the errors of a QP: what ends the search, and what leaves it
    /// to other methods.
    ///
    /// # Errors
    /// Those of the QP that are not about this problem.
    fn solved(self, stiffness: Result<SymmetricMatrix, LinearError>, settings: &Settings) -> Result<Found, Error> {
        let Program { scaled, columns, load, entries, gaps, demands } = self;
        let problem = || {
            let contact = SparseMatrix::from_triplets(gaps.len(), load.len(), &entries)?;
            ContactProblem::new(stiffness?, load, contact, gaps)
        };
        let whole = |values: &[f64]| -> Vec<f64> {
            columns.iter().map(|column| column.map_or(0.0, |column| values[column])).collect()
        };
        let answer = match problem().and_then(|problem| solve(&problem, settings)) {
            Err(QpError::NotCertified { solution, .. }) => Ok(*solution),
            answer => answer,
        };
        match answer {
            Ok(solution) => {
                let mut z = whole(&solution.displacement);
                for (demand, multiplier) in demands.iter().zip(&solution.multiplier) {
                    if let Some((i, factor)) = demand.filter(|&(i, _)| columns[i].is_none()) {
                        z[i] -= factor * multiplier;
                    }
                }
                z.iter_mut().zip(&scaled.column).for_each(|(z, unit)| *z *= unit);
                Ok(Found::Point { z, iterations: solution.iterations })
            }
            Err(QpError::Unbounded { direction, .. }) => Ok(Found::Ray(whole(&direction))),
            Err(QpError::Infeasible { rows, weights, .. }) => {
                Ok(Found::Ray(ray_of(&demands, columns.len(), rows.into_iter().zip(weights))))
            }
            Err(
                error @ (QpError::Interrupted
                | QpError::OutOfTime { .. }
                | QpError::Linear(LinearError::Setting { .. })
                | QpError::NoRoom { .. }
                | QpError::TooLarge { .. }),
            ) => Err(error.into()),
            Err(error) => Ok(Found::Nothing(format!("the program ended: {}", error.code()))),
        }
    }
}

/// Minimises `1/2 x'A x + q'x` between the bounds, of a symmetric A; the w of multipliers are its rows.
///
/// # Errors
/// Those of the QP that are not about this problem.
pub fn quadratic_program(
    scaled: &Scaled,
    is_multiplier: &[bool],
    shift: f64,
    settings: &Settings,
) -> Result<Found, Error> {
    let mut program = Program::of(scaled, |i| is_multiplier[i]);
    program.push_signs(|i| is_multiplier[i]);
    let lower = scaled.matrix.triplets().filter(|entry| entry.0 >= entry.1);
    let lower = lower.filter_map(|(i, j, value)| Some((program.columns[i]?, program.columns[j]?, value)));
    let n = program.load.len();
    let lower: Vec<_> = lower.chain((0..n).map(|k| (k, k, shift))).collect();
    match program.solved(SparseMatrix::from_triplets(n, n, &lower).and_then(SymmetricMatrix::from_lower), settings)? {
        // One of many points.
        Found::Nothing(reason) if shift == 0.0 && reason.ends_with("under-held") => {
            quadratic_program(scaled, is_multiplier, SHIFT, settings)
        }
        found => Ok(found),
    }
}

/// Minimises the gap `sum (x - l)_i (w_i)+ + (u - x)_i (-w_i)+` of a monotone A over the points that meet the
/// inequalities; in a solution it is zero. An unknown between two bounds brings its `(-w_i)+` as an unknown of its own.
///
/// # Errors
/// As [`quadratic_program`].
pub fn gap_program(scaled: &Scaled, settings: &Settings) -> Result<Found, Error> {
    let (n, lower, upper) = (scaled.offset.len(), &scaled.lower, &scaled.upper);
    let mut program = Program::of(scaled, |_| false);
    let base = |i: usize| [lower[i], upper[i]].into_iter().find(|bound| bound.is_finite()).unwrap_or(0.0);
    let moved = scaled.matrix.mul_transposed(&(0..n).map(base).collect::<Vec<_>>());
    program.load.iter_mut().zip(moved).for_each(|(load, moved)| *load += moved);
    program.push_signs(|_| true);
    let by_rows = scaled.matrix.transposed();
    for i in (0..n).filter(|&i| lower[i].is_finite() && upper[i].is_finite() && lower[i] < upper[i]) {
        let part = program.load.len();
        let entries = by_rows.column(i).map(|(j, value)| (j, -value)).chain([(part, -1.0)]);
        program.push(entries, scaled.offset[i], None);
        program.push([(part, -1.0)], 0.0, None);
        program.load.push(lower[i] - upper[i]);
    }
    let parts = program.load.len() - n;
    let stiffness = scaled.symmetric_part(0.0).and_then(|part| part.times(2.0));
    program.solved(stiffness.map(|stiffness| stiffness.with_empty(parts)), settings)
}

/// The ray that shows that no point meets the inequalities `B x <= g`, if one is found by
/// Lemke's method on the skew problem of x and y >= 0 with 0 = B'y and `g - B x >= 0`.
///
/// # Errors
/// Those of Lemke's method.
pub fn contradiction(lcp: &Lcp, scaled: &Scaled, allowed: f64, settings: &Settings) -> Result<Option<Error>, Error> {
    let n = lcp.unknowns();
    let mut program = Program::of(scaled, |_| false);
    program.push_signs(|_| true);
    let (size, entries) = (n + program.gaps.len(), &program.entries);
    let both = entries.iter().flat_map(|&(row, j, value)| [(n + row, j, -value), (j, n + row, value)]);
    let matrix = SparseMatrix::from_triplets(size, size, &both.collect::<Vec<_>>())?;
    let lower = (0..size).map(|k| if k < n { f64::NEG_INFINITY } else { 0.0 }).collect();
    let skew = Lcp::new(matrix, [vec![0.0; n], program.gaps].concat(), lower, vec![f64::INFINITY; size])?;
    match lemke(&Scaled::new(&skew, vec![1.0; size], vec![1.0; size]), 0, allowed, settings) {
        Ok(Found::Ray(weights)) => {
            Ok(infeasible(lcp, scaled, &ray_of(&program.demands, n, weights.into_iter().skip(n).enumerate())))
        }
        Ok(_) | Err(Error::TooLarge { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// The ray of weights of rows.
fn ray_of(demands: &[Option<(usize, f64)>], n: usize, weights: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
    let mut ray = vec![0.0; n];
    weights.for_each(|(row, weight)| demands[row].iter().for_each(|&(i, factor)| ray[i] += factor * weight));
    ray
}

/// The error of a problem with this ray, in scaled units; `None` if it shows nothing. What must vanish along a ray
/// vanishes for the ray in integers near it, or only to rounding, which shows nothing.
pub fn infeasible(lcp: &Lcp, scaled: &Scaled, ray: &[f64]) -> Option<Error> {
    let dust = DUST * largest(ray);
    let allowed = |i: usize| {
        let low = if lcp.upper()[i].is_infinite() { f64::INFINITY } else { 0.0 };
        let high = if lcp.lower()[i].is_infinite() { f64::INFINITY } else { 0.0 };
        if ray[i].abs() > dust { ray[i].clamp(-high, low) } else { 0.0 }
    };
    let ray: Vec<f64> = (0..lcp.unknowns()).map(allowed).collect();
    shown(lcp, scaled, &ray).or_else(|| shown(lcp, scaled, &in_integers(scaled, &ray)?))
}

/// The ray in integers near another of a small problem: the columns that vanish along that to rounding vanish along it.
fn in_integers(scaled: &Scaled, ray: &[f64]) -> Option<Vec<f64>> {
    let (sums, sizes) = (scaled.matrix.mul_transposed(ray), scaled.matrix.mul_abs_transposed(ray));
    let own: Vec<usize> = (0..ray.len()).filter(|&i| ray[i] != 0.0).collect();
    if !scaled.is_exact || ray.len() > SMALL {
        return None;
    }
    let columns = dense(&scaled.matrix.transposed());
    let vanish = (0..ray.len()).filter(|&j| sums[j].abs() <= ROUNDING * sizes[j]);
    let rows: Vec<Vec<f64>> = vanish.map(|j| own.iter().map(|&i| columns[j][i]).collect()).collect();
    let found = null_vector(&rows, &own.iter().map(|&i| ray[i]).collect::<Vec<_>>())?;
    let mut exact = vec![0.0; ray.len()];
    own.into_iter().zip(found).for_each(|(i, y)| exact[i] = if y * ray[i] > 0.0 { y } else { 0.0 });
    Some(exact)
}

/// The error of a problem with this ray, if all its signs are right without any rounding.
fn shown(lcp: &Lcp, scaled: &Scaled, ray: &[f64]) -> Option<Error> {
    let (n, matrix) = (lcp.unknowns(), lcp.matrix());
    let ray: Vec<f64> = (0..n).map(|i| ray[i] * scaled.row[i]).collect();
    let unit = (-largest(&ray).log2().floor()).exp2();
    let ray: Vec<f64> = ray.iter().map(|y| y * unit).collect();
    let (sums, sizes) = (matrix.mul_transposed(&ray), matrix.mul_abs_transposed(&ray));
    let signs = matrix.signs_transposed(&ray)?;
    let (mut needed, mut terms) = (0.0, 0.0);
    for i in 0..n {
        let bound = [lcp.lower()[i], 0.0, lcp.upper()[i]][(signs[i] + 1) as usize];
        if bound.is_infinite() {
            return None;
        }
        let own = ray[i] * lcp.offset()[i];
        needed -= own + sums[i] * bound;
        terms += own.abs() + sizes[i] * bound.abs();
    }
    (needed > DECISIVE * terms).then_some(Error::Infeasible { ray, needed })
}
