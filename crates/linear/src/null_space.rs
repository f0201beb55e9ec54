//! The null vectors of a positive semidefinite matrix, and what distinguishes a positive definite matrix from a
//! singular one that passed its Cholesky factorisation by rounding.

use super::real::{generic, power_iteration};
use super::twice::Sum;
use super::{
    Analysis, AugmentedMatrix, Cholesky, Equilibration, FactorError, Forest, SparseMatrix, SymmetricMatrix, Twice, dot,
    if_definite, largest, norm, take_out,
};
use crate::watch::Watch;

/// Added to a diagonal of order one, so that a singular matrix has a factor: far below its other eigenvalues, far above
/// rounding.
const SHIFT: f64 = 1e-10;

/// Largest number of steps of inverse iteration: each multiplies components with energy by `SHIFT / eigenvalue`.
const MOST_STEPS: usize = 30;

/// Entries of a null vector below this share of the largest are zeros with an error of the iteration.
const ZERO: f64 = 1e-12;

/// Largest number of null vectors: every vector is made orthogonal to all before it.
const MOST_VECTORS: usize = 256;

/// Corrections of a null vector in twice the working precision.
const MOST_CORRECTIONS: usize = 20;

/// An entry of `A v` vanishes exactly if it is below this share of its terms.
const EXACT: f64 = 1e-26;

/// Entries of a vector in twice the working precision below this share of the largest are zeros with an error of the
/// corrections.
const NO_ENTRY: f64 = 1e-24;

/// On a diagonal of order one, a smallest pivot above this leaves no doubt; below it the smallest eigenvalue is
/// computed.
const SAFE_PIVOT: f64 = 1e-9;

/// `norm(A x)` of a null vector x is rounding: up to this many units in the last place of the terms that cancel.
const NULL_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Steps of inverse iteration: each gains several digits, since eigenvalues differ by many orders of magnitude.
const SOFTEST_STEPS: usize = 5;

/// On a diagonal of order one, a negative eigenvalue above this, or above this for each column, is rounding of the
/// entries and of the factor.
const LEAST_NEGATIVE: f64 = 1e-12;
const NEGATIVE_BY_COLUMN: f64 = 8.0 * f64::EPSILON;

/// The vectors that a matrix maps to zero.
#[derive(Clone, Debug, Default)]
pub struct NullSpace {
    /// Linearly independent vectors of length about one.
    pub vectors: Vec<Vec<Twice>>,
    /// The largest share of its terms that is left in an entry of `A v`, for each vector: zero if `A v` vanishes
    /// exactly, for the doubles of the matrix. Otherwise it would vanish with the entries rounded in another way, and
    /// the vector has no more digits than the entries.
    pub shares: Vec<f64>,
    /// All vectors without energy to rounding: also those that are left out because a change of entries by their own
    /// rounding does not explain it.
    pub found: Vec<Vec<f64>>,
}

impl NullSpace {
    /// If a change of every entry of A by this share of itself makes `A v` vanish, A may be a singular matrix with
    /// rounded entries, rounded several times during assembly.
    ///
    /// # Source
    /// W. Oettli, W. Prager, *Compatibility of approximate solution of linear equations with given error bounds for
    /// coefficients and right-hand sides*, Numer. Math. 6 (1964) 405-409.
    pub const OF_ENTRIES: f64 = 4.0 * f64::EPSILON;

    /// Returns `true` if every vector vanishes exactly under the matrix.
    pub fn is_exact(&self) -> bool {
        self.shares.iter().all(|&share| share == 0.0)
    }

    /// The vectors on which A vanishes exactly and those that `is_declared`, and the largest share of the others.
    pub fn declared(self, is_declared: impl Fn(&[Twice]) -> bool) -> (Self, f64) {
        let all = self.vectors.into_iter().zip(self.shares);
        let (kept, others): (Vec<_>, Vec<_>) = all.partition(|(vector, share)| *share == 0.0 || is_declared(vector));
        let (vectors, shares) = kept.into_iter().unzip();
        (NullSpace { vectors, shares, found: self.found }, others.iter().map(|other| other.1).fold(0.0, f64::max))
    }
}

impl Cholesky {
    /// Returns `true` if the pivots of this factor alone show that the matrix, with a diagonal of order one, is
    /// definite.
    pub fn is_safely_definite(&self) -> bool {
        self.smallest_pivot() > SAFE_PIVOT
    }

    /// Returns `true` if `matrix`, with a diagonal of order one and with this factor, is definite beyond rounding.
    pub fn is_definite(&self, matrix: &SymmetricMatrix) -> bool {
        if self.is_safely_definite() {
            return true;
        }
        let softest = self.softest_vector();
        largest(&matrix.mul(&softest)) > NULL_ROUNDING * largest(&matrix.mul_abs(&softest))
    }

    /// The vector with the least energy, largest entry one, by inverse iteration.
    pub fn softest_vector(&self) -> Vec<f64> {
        power_iteration(self.dim(), 0.5, SOFTEST_STEPS, |x| Some(self.solve(x)))
    }
}

impl SymmetricMatrix {
    /// Returns `true` if the matrix is positive semidefinite, to rounding: its equilibrated form plus a small multiple
    /// of the unit matrix has a factor.
    pub fn is_semidefinite(&self) -> Result<bool, FactorError> {
        let diagonal = self.diagonal();
        let has_none = |dof: usize| diagonal[dof] == 0.0;
        let is_free = |row: usize, column: usize| row != column && (has_none(row) || has_none(column));
        if diagonal.iter().any(|&value| value < 0.0)
            || self.lower().triplets().any(|(row, column, value)| value != 0.0 && is_free(row, column))
        {
            return Ok(false);
        }
        let shift = LEAST_NEGATIVE.max(NEGATIVE_BY_COLUMN * self.dim() as f64);
        Ok(Equilibration::of(self).apply(self).shifted_factor(shift)?.is_some())
    }

    /// A basis of the null space of a positive semidefinite matrix with a diagonal of order one or zero; `None` if it
    /// has more than 256 vectors.
    ///
    /// Inverse iteration with A + 1e-10 I, each vector orthogonal to those before, ends at the first vector with
    /// energy; `shifts` are those of this matrix.
    pub fn null_space(&self, shifts: &AugmentedMatrix) -> Result<Option<NullSpace>, FactorError> {
        let factor = shifts.shifted(SHIFT)?.ok_or(FactorError::NotPositiveDefinite)?;
        let (mut found, components): (Vec<Vec<f64>>, _) = (Vec::new(), self.components());
        while found.len() < self.dim() {
            let Some(vector) = self.null_vector(&factor, &found) else { break };
            let pieces = self.in_components(&vector, &components);
            if found.len() + pieces.len() > MOST_VECTORS {
                return Ok(None);
            }
            found.extend(pieces);
        }
        let mut basis = NullSpace::default();
        for vector in &found {
            let (corrected, share) = self.corrected(&factor, vector);
            if share <= EXACT {
                basis.vectors.push(corrected);
                basis.shares.push(0.0);
            } else if share <= NullSpace::OF_ENTRIES {
                // Corrections follow the rounding of the entries, and make the vectors less orthogonal to each other.
                basis.vectors.push(vector.iter().map(|&value| value.into()).collect());
                basis.shares.push(share);
            }
        }
        basis.found = found;
        Ok(Some(basis))
    }

    /// A null vector in twice the working precision, and the largest share of its terms that is left in an entry of
    /// `A v`.
    ///
    /// `(A + s I)^-1 A v` is the component of v with energy, except for the share `s / eigenvalue`; the rounding in it
    /// lies mostly in the null space.
    fn corrected(&self, factor: &Cholesky, vector: &[f64]) -> (Vec<Twice>, f64) {
        let mut vector: Vec<Twice> = vector.iter().map(|&value| value.into()).collect();
        let mut left = self.resistance(&vector);
        for _ in 0..MOST_CORRECTIONS {
            let forces: Vec<f64> = left.iter().map(|force| force.value.rounded()).collect();
            let correction = factor.solve(&forces);
            let next = vector.iter().zip(correction).map(|(&value, change)| value - change.into());
            let mut next: Vec<Twice> = next.collect();
            let least = NO_ENTRY * next.iter().map(|value| value.rounded().abs()).fold(0.0, f64::max);
            next.iter_mut().filter(|value| value.rounded().abs() <= least).for_each(|value| *value = Twice::ZERO);
            let of_next = self.resistance(&next);
            let size = |force: &Sum| force.value.rounded().abs();
            let most = |left: &[Sum]| left.iter().map(size).fold(0.0, f64::max);
            // A NaN in either also ends the loop.
            let is_less = most(&of_next) < 0.5 * most(&left);
            if !is_less {
                break;
            }
            (vector, left) = (next, of_next);
        }
        let shares = left.iter().filter(|sum| sum.terms > 0.0).map(|sum| sum.value.rounded().abs() / sum.terms);
        let share = shares.fold(0.0, f64::max);
        (vector, share)
    }

    /// The entries of `A v`.
    pub fn resistance(&self, vector: &[Twice]) -> Vec<Sum> {
        let mut sums = vec![Sum::default(); vector.len()];
        for (row, column, value) in self.lower().triplets() {
            sums[row].add(Twice::from(value) * vector[column]);
            if row != column {
                sums[column].add(Twice::from(value) * vector[row]);
            }
        }
        sums
    }

    /// A unit null vector, orthogonal to those `found`.
    fn null_vector(&self, factor: &Cholesky, found: &[Vec<f64>]) -> Option<Vec<f64>> {
        // No entry of A v is larger than this, for a unit vector v.
        let terms = largest(&self.mul_abs(&vec![1.0; self.dim()]));
        let mut vector = generic(self.dim(), found.len());
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            vector = factor.solve(&vector);
            // A second pass removes the rounding of the first.
            for other in found.iter().chain(found) {
                take_out(&mut vector, other);
            }
            let length = norm(&vector);
            vector.iter_mut().for_each(|value| *value /= length);
            let resistance = largest(&self.mul(&vector));
            if resistance <= NULL_ROUNDING * terms {
                let largest = largest(&vector);
                let kept = |value: f64| if value.abs() > ZERO * largest { value } else { 0.0 };
                return Some(vector.into_iter().map(kept).collect());
            }
            if resistance.is_nan() || resistance > 0.5 * before {
                return None;
            }
            before = resistance;
        }
        None
    }

    /// The connected component of each unknown, and their number.
    pub fn components(&self) -> (Vec<usize>, usize) {
        let mut forest = Forest::new(self.dim());
        let couplings = self.lower().triplets().filter(|entry| entry.2 != 0.0);
        couplings.for_each(|(row, column, _)| forest.join(row, column));
        forest.into_trees()
    }

    /// A null vector as the sum of null vectors of single components, of length one: the components are independent of
    /// each other, and one may be smaller than another by more digits than doubles have. Iteration errors in a
    /// component with energy are left out.
    fn in_components(&self, vector: &[f64], (component, count): &(Vec<usize>, usize)) -> Vec<Vec<f64>> {
        if *count == 1 {
            return vec![vector.to_vec()];
        }
        let mut squares = vec![0.0; *count];
        vector.iter().zip(component).for_each(|(value, &at)| squares[at] += value * value);
        let piece = |of: usize| -> Vec<f64> {
            let length = squares[of].sqrt();
            vector.iter().zip(component).map(|(value, &at)| if at == of { value / length } else { 0.0 }).collect()
        };
        let terms = largest(&self.mul_abs(&vec![1.0; self.dim()]));
        let is_null = |piece: &Vec<f64>| largest(&self.mul(piece)) <= NULL_ROUNDING * terms;
        let pieces = (0..*count).filter(|&of| squares[of] > 0.0).map(piece).filter(is_null);
        let pieces: Vec<Vec<f64>> = pieces.take(MOST_VECTORS + 1).collect();
        if pieces.is_empty() { vec![vector.to_vec()] } else { pieces }
    }

    /// A direction of negative energy, if there is one beyond rounding: largest entry one. `None` also if the `watch`
    /// is over.
    pub fn negative_direction(&self, shifts: &AugmentedMatrix, watch: &Watch) -> Result<Option<Vec<f64>>, FactorError> {
        // Gershgorin: with more than this on its diagonal, the matrix is definite.
        let most = 2.0 * largest(&self.mul_abs(&vec![1.0; self.dim()]));
        let mut shift = SHIFT;
        while shift < 4.0 * most && !watch.is_over() {
            let Some(factor) = shifts.shifted(shift)? else {
                shift *= 4.0;
                continue;
            };
            // With a shift close above the least eigenvalue, inverse iteration converges to its vector.
            let vector = power_iteration(self.dim(), -0.5, MOST_STEPS, |x| Some(factor.solve(x)));
            return Ok((dot(&vector, &self.mul(&vector)) < 0.0).then_some(vector));
        }
        Ok(None)
    }

    pub(super) fn shifted_factor(&self, shift: f64) -> Result<Option<Cholesky>, FactorError> {
        self.shifts(Analysis::of(self)?)?.shifted(shift)
    }

    /// The matrix with many shifts, from its `analysis`.
    pub fn shifts(&self, analysis: Analysis) -> Result<AugmentedMatrix, FactorError> {
        let no_rows = SparseMatrix::from_parts(0, vec![0; self.dim() + 1], Vec::new(), Vec::new());
        AugmentedMatrix::new(self, &no_rows, Some(&analysis))
    }
}

impl AugmentedMatrix {
    /// The factor of `K + shift I`; `None` if that is not positive definite.
    fn shifted(&self, shift: f64) -> Result<Option<Cholesky>, FactorError> {
        if_definite(self.factor(self.matrix(|_| 0.0, shift)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_of_negative_energy_is_found_by_one_analysis_unless_the_watch_is_over() {
        let matrix = SymmetricMatrix::from_table(2, &[1.0, 2.0, 2.0, 1.0]).unwrap();
        let shifts = matrix.shifts(Analysis::of(&matrix).unwrap()).unwrap();
        let direction = |watch: &Watch| matrix.negative_direction(&shifts, watch).unwrap();
        let found = direction(&Watch::default()).unwrap();
        assert!((found[0] + found[1]).abs() < 1e-12 && found[0] != 0.0, "{found:?}");
        assert_eq!(direction(&Watch::default().within(0.0)), None);
    }

    fn is_semidefinite([first, second]: [f64; 2], coupling: f64) -> bool {
        let matrix = SymmetricMatrix::from_table(2, &[first, coupling, coupling, second]).unwrap();
        matrix.is_semidefinite().unwrap()
    }

    #[test]
    fn a_negative_eigenvalue_is_told_from_none() {
        assert!(is_semidefinite([1e-20, 1e20], 1.0));
        assert!(is_semidefinite([0.0, 1.0], 0.0));
        assert!(!is_semidefinite([1e-20, 1e20], 1.0 + 1e-9));
        assert!(!is_semidefinite([0.0, 1.0], 1e-100));
        assert!(!is_semidefinite([-1e-100, 1.0], 0.0));
    }
}
