//! Natural vibrations: the lowest solutions of `K x = w M x`, with a proof by counting that none is missed.
//!
//! With the factor `K + s M = L L'` the lowest eigenvalues w are the largest 1/(w + s) of `L^-1 M L^-T`, which a block
//! Krylov space finds after few products. The negative pivots of `K - t M` count the eigenvalues below t: if the space
//! has as many, it has them all.
//!
//! # Source
//! T. Ericsson, A. Ruhe, *The spectral transformation Lanczos method for the numerical solution of large sparse
//! generalized symmetric eigenvalue problems*, Math. Comp. 35 (1980) 1251-1268. R. G. Grimes, J. G. Lewis, H. D. Simon,
//! *A shifted block Lanczos algorithm for solving sparse symmetric generalized eigenproblems*, SIAM J. Matrix Anal.
//! Appl. 15 (1994) 228-272.

use std::borrow::Cow;
use std::f64::consts::SQRT_2;

use crate::error::{Error, LinearError, Result};
use crate::linear::eigen::{Krylov, Pairs, negative_eigenvalues};
use crate::linear::equations::Solved;
use crate::linear::watch::Watch;
use crate::linear::{
    Analysis, Cholesky, Equilibration, SymmetricMatrix, Twice, dot, if_definite, in_order, ldexp, norm, par,
};
use crate::problem::ContactProblem;

/// What is left of a row below this share of its largest entry is rounding: the row follows from those before it.
const DEPENDENT: f64 = 1e-12;

/// A pivot of a matrix with a diagonal of order one below this is rounding: the matrix may be singular.
const SINGULAR: f64 = 1e-12;

/// Shift of a singular matrix, relative to the smallest ratio of diagonals: far above rounding, far below eigenvalues.
const SHIFT: f64 = 1e-8;

/// The largest ratio of the extreme eigenvalues of the operator: with more, the smallest have too few digits.
const SPREAD: f64 = 1e6;

/// Pairs after the last wanted one among which a gap for the count is looked for.
const BEYOND: usize = 4;

/// A gap between two eigenvalues, relative, that is wide enough for a count.
const GAP: f64 = 1e-4;

/// An eigenvalue of the operator below this share of the largest is rounding of zero: its motion has no mass.
const NO_MASS: f64 = 1e-14;

/// Shares of a gap at which eigenvalues are counted, one after the other: a pivot may be rounding at one of them.
const SHARES: [f64; 4] = [0.5, 0.38, 0.66, 0.27];

/// An eigenvalue is zero if its energy `x'K x` is below this share of that of its entries, each alone.
const ZERO: f64 = 1e-13;

/// Columns that a thread sweeps at a time.
const TOGETHER: usize = 4;

/// Searches of one space, each with more directions, before it is left unproven.
const MOST_SEARCHES: usize = 8;

/// Columns of a space beyond those of 24 times the wanted pairs.
const MOST_COLUMNS: usize = 240;

/// The lowest natural vibrations of a problem with some rows held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Modes {
    /// Eigenvalues w = (2 pi f)^2, one for each mode, not decreasing, in one over time squared; exactly zero for a
    /// motion without energy.
    pub values: Vec<f64>,
    /// A vector x of each eigenvalue, length n, in one over the root of mass: `x'M x = 1`, and the largest entry is
    /// positive.
    pub vectors: Vec<Vec<f64>>,
    /// The forces of the rows in each mode, length m, in the unit of `K x`: `K x - w M x = B' lambda`; of either sign,
    /// zero for open rows.
    pub multipliers: Vec<Vec<f64>>,
    /// For each pair, dimensionless, `>= 0`: the norm of `K x - w M x` in the inverse of K + s M over the root of w +
    /// s. An eigenvalue w* exists with `|w* - w| <= residual (w* + s)` up to rounding; s is zero unless K is singular,
    /// or w is spread over many digits.
    pub residuals: Vec<f64>,
    /// `true` if the count of negative pivots shows that no eigenvalue below the last one is missed.
    pub is_complete: bool,
}

/// The lowest pairs of `K x = w M x` of a problem, with rows `closed` and unknowns that come `first`.
pub fn modes(
    problem: &ContactProblem,
    mass: &SymmetricMatrix,
    (closed, first): (&[usize], &[usize]),
    count: usize,
    threads: usize,
    watch: &Watch,
) -> Result<Modes> {
    let equalities = problem.inequalities()..problem.inequalities() + problem.equality_rows();
    // Equalities that follow from the others are left out.
    let equalities = equalities.filter(|&row| problem.gap()[row].is_finite());
    let rows: Vec<usize> = closed.iter().copied().chain(equalities).collect();
    let (dofs, of_contact) = (problem.dofs(), problem.contact());
    if let Some(&row) = rows.iter().find(|&&row| row >= problem.rows()) {
        return Err(LinearError::IndexOutOfRange { row, column: 0, rows: problem.rows(), columns: dofs }.into());
    }
    if mass.dim() != dofs {
        let found = (mass.dim(), mass.dim());
        return Err(LinearError::Shape { name: "mass", found, expected: (dofs, dofs) }.into());
    }
    // u = Z y: the rows vanish for any y.
    let rank = |dof: usize| (!first.contains(&dof), of_contact.column(dof).count());
    let solved = Solved::of_rows(of_contact, &rows, (DEPENDENT, rank));
    let reduced = |matrix| match rows.is_empty() {
        true => Ok(Cow::Borrowed(matrix)),
        false => solved.congruent(matrix).map(Cow::Owned),
    };
    let reduced = [reduced(problem.stiffness())?, reduced(mass)?];
    let mut found = lowest([&reduced[0], &reduced[1]], count, threads, watch)?;
    let lifted = |y: &Vec<f64>| solved.of_all(y, 0.0).map(Twice::rounded).collect();
    found.vectors = found.vectors.iter().map(lifted).collect();
    let multiplier = |(x, value): (&Vec<f64>, &f64)| {
        let (elastic, inertia) = (problem.stiffness().mul(x), mass.mul(x));
        let rest: Vec<f64> = elastic.iter().zip(inertia).map(|(k, m)| k - value * m).collect();
        solved.balancing(&rest, problem.inequalities())
    };
    found.multipliers = found.vectors.iter().zip(&found.values).map(multiplier).collect();
    Ok(found)
}

fn lowest([stiffness, mass]: [&SymmetricMatrix; 2], count: usize, threads: usize, watch: &Watch) -> Result<Modes> {
    // A diagonal of order one of the stiffness, by powers of two. Both matrices change alike: the eigenvalues stay.
    let scale = Equilibration::of(&stiffness.combined(1.0, 0.0, mass)?);
    let scaled = [stiffness, mass].map(|matrix| scale.apply(matrix));
    let pencil = Pencil::of(&scaled, threads, watch)?;
    let shifted = pencil.shifted()?;
    let space = shifted.space(count)?;
    let found = match shifted.better_shift(&space.pairs()?, count) {
        None => shifted.lowest(space, count)?,
        Some(shift) => {
            let shifted = Shifted { pencil: &pencil, shift, factor: pencil.factor(shift)? };
            shifted.lowest(shifted.space(count)?, count)?
        }
    };
    // Both matrices have the factor c of the scale.
    let (half, root) = (scale.factor.div_euclid(2), if scale.factor % 2 == 0 { 1.0 } else { SQRT_2 });
    let unscaled = |vector: Vec<f64>| {
        let entries = vector.iter().zip(&scale.diagonal);
        let mut vector: Vec<f64> = entries.map(|(value, by)| ldexp(root * value, by + half)).collect();
        let largest = vector.iter().fold(0.0, |most: f64, value| if value.abs() > most.abs() { *value } else { most });
        vector.iter_mut().for_each(|value| *value *= largest.signum());
        vector
    };
    Ok(Modes { vectors: found.vectors.into_iter().map(unscaled).collect(), ..found })
}

/// Both matrices with one pattern, analysed once.
struct Pencil<'a> {
    matrices: &'a [SymmetricMatrix; 2],
    analysis: Analysis,
    /// The mass in the order of elimination.
    ordered: SymmetricMatrix,
    threads: usize,
    watch: &'a Watch,
}

impl<'a> Pencil<'a> {
    fn of(matrices: &'a [SymmetricMatrix; 2], threads: usize, watch: &'a Watch) -> Result<Self> {
        let [stiffness, mass] = matrices;
        let analysis = Analysis::sparse_with_last(&stiffness.combined(1.0, 0.0, mass)?, &[])?.with_threads(threads);
        let ordered = mass.ordered(analysis.order())?;
        Ok(Pencil { matrices, analysis, ordered, threads, watch })
    }

    /// The factor of `K + shift M`.
    fn factor(&self, shift: f64) -> Result<Cholesky> {
        let [stiffness, mass] = self.matrices;
        Ok(self.analysis.factor_last(stiffness.combined(1.0, shift, mass)?)?)
    }

    /// The factor of K, or with a shift if K is singular.
    fn shifted(&self) -> Result<Shifted<'_>> {
        let [stiffness, mass] = self.matrices;
        let own = if_definite(self.analysis.factor_last(stiffness.combined(1.0, 0.0, mass)?))?;
        if let Some(factor) = own.filter(|factor| factor.smallest_pivot() > SINGULAR) {
            return Ok(Shifted { pencil: self, shift: 0.0, factor });
        }
        let ratios = stiffness.diagonal().into_iter().zip(mass.diagonal()).filter(|(k, m)| *k > 0.0 && *m > 0.0);
        let least = ratios.map(|(k, m)| k / m).fold(f64::INFINITY, f64::min);
        let shift = if least.is_finite() { SHIFT * least } else { 1.0 };
        Ok(Shifted { pencil: self, shift, factor: self.factor(shift)? })
    }

    /// Number of eigenvalues below a number between these bounds; `None` if rounding hides it.
    fn below(&self, [low, high]: [f64; 2]) -> Result<Option<usize>> {
        let [stiffness, mass] = self.matrices;
        for share in SHARES {
            let bound = low.max(0.0) + share * (high - low.max(0.0));
            let shifted = stiffness.combined(1.0, -bound, mass)?;
            if let Some(count) = negative_eigenvalues(&self.analysis, &shifted, self.threads)? {
                return Ok(Some(count));
            }
        }
        Ok(None)
    }
}

/// The operator `L^-1 M L^-T`, in the order of elimination, with `L L' = K + shift M`.
struct Shifted<'a> {
    pencil: &'a Pencil<'a>,
    shift: f64,
    factor: Cholesky,
}

/// Number of the first `count` pairs whose motion has mass.
fn with_mass(pairs: &Pairs, count: usize) -> usize {
    let least = NO_MASS * pairs.values.first().copied().unwrap_or(0.0);
    pairs.values.iter().take(count).take_while(|value| **value > least).count()
}

impl Shifted<'_> {
    /// The space in which pairs are looked for the first time.
    fn space(&self, count: usize) -> Result<Krylov<impl Fn(&[f64]) -> Vec<f64>>> {
        let Pencil { ordered, threads, watch, .. } = self.pencil;
        if watch.is_over() {
            return Err(Error::Interrupted);
        }
        let mut space = Krylov::new(|columns: &[f64]| self.apply(columns), ordered.dim(), par(*threads));
        space.extend(space.next_extension(count));
        Ok(space)
    }

    /// A shift with which the largest eigenvalue keeps its digits, if the first `count` reach far below it.
    fn better_shift(&self, pairs: &Pairs, count: usize) -> Option<f64> {
        let (first, last) = (pairs.values.first()?, pairs.values[..with_mass(pairs, count)].last()?);
        (first / last > SPREAD).then(|| (1.0 / last - self.shift) / SPREAD.sqrt())
    }

    /// The lowest pairs, with the space extended until they have converged.
    fn lowest(&self, mut space: Krylov<impl Fn(&[f64]) -> Vec<f64>>, count: usize) -> Result<Modes> {
        let Pencil { ordered, watch, .. } = self.pencil;
        let count = count.min(ordered.dim());
        let most = 24 * count + MOST_COLUMNS;
        let (mut wanted, mut is_complete, mut searches) = (count, false, 0);
        let mut pairs = loop {
            if watch.is_over() {
                return Err(Error::Interrupted);
            }
            let pairs = space.pairs()?;
            let is_last = space.columns() >= most || searches >= MOST_SEARCHES || space.is_whole();
            if pairs.converged() >= wanted.min(space.columns()) || is_last {
                match self.gap_after(&pairs, wanted) {
                    // The last eigenvalues of all.
                    None if is_last => {
                        is_complete = space.is_whole();
                        break pairs;
                    }
                    // They are so close to each other that more of them are needed.
                    None => wanted += BEYOND,
                    Some((bounds, below)) => match self.pencil.below(bounds)? {
                        Some(counted) if counted == below => {
                            is_complete = true;
                            break pairs;
                        }
                        Some(counted) if !is_last => {
                            searches += 1;
                            wanted = wanted.max(counted);
                            space.widen();
                        }
                        _ => break pairs,
                    },
                }
            }
            space.extend(space.next_extension(wanted));
        };
        pairs.values.truncate(with_mass(&pairs, count));
        let vectors = space.vectors(&pairs, pairs.values.len());
        let mut all = self.pairs(&vectors);
        all.sort_by(|one, other| one.0.total_cmp(&other.0));
        let (values, (residuals, vectors)) = all.into_iter().unzip();
        Ok(Modes { values, vectors, residuals, is_complete, ..Modes::default() })
    }

    /// The eigenvalue, residual and vector, with mass one, of vectors of the operator, one after the other.
    fn pairs(&self, vectors: &[f64]) -> Vec<(f64, (f64, Vec<f64>))> {
        let Pencil { matrices: [stiffness, mass], ordered, analysis, .. } = self.pencil;
        let (dim, order, diagonal) = (ordered.dim(), analysis.order(), stiffness.diagonal());
        self.in_parts(vectors, |part| {
            let mut x = vec![0.0; part.len()];
            let swept = self.factor.backward_all(part.to_vec());
            for (x, swept) in x.chunks_mut(dim).zip(swept.chunks(dim)) {
                order.iter().zip(swept).for_each(|(&unknown, &value)| x[unknown] = value);
            }
            let [elastic, inertia] = [stiffness, mass].map(|matrix| matrix.mul_all(&x));
            let products = elastic.chunks(dim).zip(inertia.chunks(dim));
            let (mut values, mut rests) = (Vec::new(), Vec::with_capacity(x.len()));
            for (x, (elastic, inertia)) in x.chunks_mut(dim).zip(products) {
                let (energy, square) = (dot(x, elastic), dot(x, inertia));
                let terms: f64 = x.iter().zip(&diagonal).map(|(x, k)| k * x * x).sum();
                let value = if energy > ZERO * terms { energy / square } else { 0.0 };
                let length = square.sqrt();
                rests.extend(order.iter().map(|&unknown| (elastic[unknown] - value * inertia[unknown]) / length));
                x.iter_mut().for_each(|entry| *entry /= length);
                values.push(value);
            }
            let rests = self.factor.forward_all(rests);
            let residual = |(value, rest): (&f64, &[f64])| norm(rest) / (value + self.shift).sqrt();
            let residuals = values.iter().zip(rests.chunks(dim)).map(residual).collect::<Vec<f64>>();
            let vectors = x.chunks(dim).map(<[f64]>::to_vec);
            values.into_iter().zip(residuals.into_iter().zip(vectors)).collect()
        })
    }

    /// The ends of a gap of the eigenvalues w after the first `count`, and how many lie below it; `None` without a gap.
    fn gap_after(&self, pairs: &Pairs, count: usize) -> Option<([f64; 2], usize)> {
        let all = pairs.values.len();
        // Eigenvalues 1/(w + s), decreasing.
        let gap = |below: usize| {
            let upper = pairs.values[below - 1] - pairs.residuals[below - 1];
            let lower = pairs.values[below] + pairs.residuals[below];
            ((upper - lower) / upper, below, [upper, lower].map(|end| 1.0 / end - self.shift))
        };
        let gaps = (count.max(1)..(count + BEYOND).min(all)).map(gap);
        let widest = gaps.filter(|gap| gap.0 > GAP && gap.2[1] > 0.0).max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((widest.2, widest.1))
    }

    fn apply(&self, columns: &[f64]) -> Vec<f64> {
        let Pencil { ordered, .. } = self.pencil;
        self.in_parts(columns, |part| {
            self.factor.forward_all(ordered.mul_all(&self.factor.backward_all(part.to_vec())))
        })
    }

    /// The results of `work` on as many columns as are treated together, in their order.
    fn in_parts<T: Send>(&self, columns: &[f64], work: impl Fn(&[f64]) -> Vec<T> + Sync) -> Vec<T> {
        // Held rows may leave nothing that moves.
        let parts: Vec<&[f64]> = columns.chunks((TOGETHER * self.pencil.ordered.dim()).max(1)).collect();
        match self.pencil.threads {
            0 | 1 => parts.into_iter().flat_map(work).collect(),
            _ => in_order(parts, work).into_iter().flatten().collect(),
        }
    }
}
