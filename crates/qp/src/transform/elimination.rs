//! The equalities of a problem eliminated, sparse, with the way back.
//!
//! Equalities `E u = e` of rank r are solved for r dofs, the pivots: `u = u_0 + Z y`. The rest is a problem in y,
//!
//! ```text
//! minimise 1/2 y' Z'K Z y - (f - K u_0)' Z y   subject to   B Z y <= g - B u_0
//! ```
//!
//! which is definite wherever the equalities hold a motion without energy. The way back gives the multipliers of the
//! equalities from the forces on the pivots. All sums have twice the working precision.
//!
//! A long equality, as a mean value over all dofs, would fill `Z'K Z`. It is cut: the sum over some dofs becomes an
//! unknown in the place of one of them, and the sum over some of these sums, until a short equality of sums is left.

use crate::error::{Error, Result};
use crate::linear::equations::{FOLLOWS, PIVOT, Pivot, Pivots, Remainder, Solved, Sparse, Sums, largest};
use crate::linear::twice::Sum;
use crate::linear::{SparseMatrix, Twice, exponent, ldexp};
use crate::problem::{ContactProblem, Equality};
use crate::solution::{ContactSet, Iteration, Solution};

/// The elimination may add this many entries to K for each one that it has, and `FEW` to any.
const FILL: usize = 4;

/// Entries that are not worth counting.
const FEW: usize = 2_000_000;

/// Equalities of more dofs are cut where they would fill the stiffness, into sums of `CUT`, as many as a solid cell
/// has.
const LONG: usize = 64;

const CUT: usize = 16;

/// A dof whose place a sum takes has at least this share of the largest entry: sums of sums amplify rounding.
const CUT_PIVOT: f64 = 0.5;

/// The share of its largest entry that a sum has in the row that defines it: below that of a pivot.
const NO_PIVOT: f64 = 1.0 / 32.0;

/// The equalities of a problem, solved for some of its dofs.
#[derive(Clone, Debug)]
pub struct Elimination {
    equalities: Vec<Equality>,
    /// Dofs, and then sums.
    solved: Solved,
    /// The sums that are unknowns: their numbers follow those of the dofs, and those of sums before them.
    sums: Vec<Sparse>,
    /// The rows that stay, in increasing order.
    pub rows: Vec<usize>,
}

impl Elimination {
    /// The elimination of all equalities; `None` if it fills the stiffness, or rounding hides whether some follow.
    pub fn of(problem: &ContactProblem) -> Result<Option<Self>> {
        let mut found = Self::cut(problem, usize::MAX);
        if let Err(None) = found {
            found = Self::cut(problem, LONG);
        }
        match found {
            Err(Some(error)) => Err(error),
            found => Ok(found.ok()),
        }
    }

    /// Returns `true` if a long equality is cut: its own pair of rows, put into a factor, would fill that.
    pub fn is_cut(&self) -> bool {
        !self.sums.is_empty()
    }

    /// The same with equalities of more than `long` dofs cut; an error without words if there is none.
    fn cut(problem: &ContactProblem, long: usize) -> Result<Self, Option<Error>> {
        let (equalities, by_row) = (problem.equalities().to_vec(), problem.contact().transposed());
        // Short rows first: they fill the others least.
        let mut order: Vec<usize> = (0..equalities.len()).collect();
        order.sort_by_key(|&number| by_row.column(equalities[number].row).count());
        // A dof of few equalities goes into few others; then one of few entries of K and B.
        let columns = [problem.stiffness().lower(), problem.contact()];
        let entries = |dof: usize| columns.iter().map(|matrix| matrix.column(dof).count()).sum::<usize>();
        let mut ranks: Vec<(usize, usize)> = (0..problem.dofs()).map(|dof| (0, entries(dof))).collect();
        let in_equalities = equalities.iter().flat_map(|pair| by_row.column(pair.row));
        in_equalities.filter(|entry| entry.1 != 0.0).for_each(|(dof, _)| ranks[dof].0 += 1);
        let most = FEW + FILL * problem.stiffness().entries();
        let (mut found, mut fill, mut all_sums) = (Pivots::default(), 0, Vec::new());
        // Sums come after the dofs, and follow from no equality but their own.
        let rank = |dof: usize| ranks.get(dof).copied().unwrap_or_default();
        for number in order {
            let row = equalities[number].row;
            let entries = by_row.column(row).filter(|entry| entry.1 != 0.0);
            match found.reduced(entries, problem.gap()[row].into(), (number, FOLLOWS)) {
                Remainder::Row(mut pivot) => {
                    let mut solve_for = |pivot: Pivot, share: f64| {
                        let dof = pivot.best(share, rank).ok_or(None)?;
                        fill += pivot.others.len() * (pivot.others.len() + rank(dof).1);
                        found.solve_for(dof, pivot);
                        if fill <= most { Ok(()) } else { Err(None) }
                    };
                    while pivot.others.len() > long {
                        let mut of_sums = Sparse::new();
                        for part in pivot.others.chunks(CUT) {
                            let (sum, number) = (problem.dofs() + all_sums.len(), equalities.len() + all_sums.len());
                            // In the unit of its dofs, and no pivot itself.
                            let unit: Twice = (NO_PIVOT * ldexp(1.0, exponent(largest(part)))).into();
                            let others = part.iter().copied().chain([(sum, -unit)]).collect();
                            let weights = vec![(number, 1.0.into())];
                            of_sums.push((sum, unit));
                            all_sums.push(part.iter().map(|&(dof, a)| (dof, a / unit)).collect());
                            solve_for(Pivot { dof: 0, constant: Twice::ZERO, others, weights }, CUT_PIVOT)?;
                        }
                        pivot.others = of_sums;
                    }
                    solve_for(pivot, PIVOT)?;
                }
                Remainder::Follows { .. } => {}
                Remainder::Contradicts(weights) => {
                    let (rows, weights) = signed(&equalities, &weights);
                    return Err(problem.overlap(&rows, &weights).map(|_| problem.infeasible(&rows, &weights)));
                }
                Remainder::Unclear => return Err(None),
            }
        }
        let mut is_equality = vec![false; problem.rows()];
        equalities.iter().flat_map(|pair| [pair.row, pair.opposed]).for_each(|row| is_equality[row] = true);
        let rows = (0..problem.rows()).filter(|&row| !is_equality[row]).collect();
        let solved = Solved::of(found.pivots, problem.dofs() + all_sums.len());
        Ok(Elimination { equalities, solved, sums: all_sums, rows })
    }

    pub fn problem(&self, problem: &ContactProblem) -> Result<ContactProblem> {
        let (stiffness, load) = (self.solved.congruent(problem.stiffness())?, self.load(problem));
        let (by_row, mut sums) = (problem.contact().transposed(), Sums::default());
        let mut entries = Vec::with_capacity(by_row.entries());
        for (number, &row) in self.rows.iter().enumerate() {
            for (dof, b) in by_row.column(row) {
                self.solved.row(dof).for_each(|(place, a)| sums.at(place).add(Twice::from(b) * a));
            }
            // What is left within the rounding of the entries of a row is no row of its own.
            entries.extend(sums.taken().map(|(place, sum)| (number, place, sum.beyond(FOLLOWS).rounded())));
        }
        let contact = SparseMatrix::from_triplets(self.rows.len(), self.solved.stays.len(), &entries)?;
        let gap = self.gap(problem, &contact);
        ContactProblem::computed(stiffness, load, contact, gap)?.with_near_null_of(problem, |mode| self.staying(mode))
    }

    /// `g - B u_0` of the rows that stay; `contact` is the matrix of their rest.
    pub fn gap(&self, problem: &ContactProblem, contact: &SparseMatrix) -> Vec<f64> {
        let mut distances: Vec<Sum> = vec![Sum::default(); problem.rows()];
        distances.iter_mut().zip(problem.gap()).for_each(|(distance, &gap)| distance.add(gap.into()));
        for pivot in self.solved.pivots.iter().filter(|pivot| pivot.dof < problem.dofs()) {
            let along = problem.contact().column(pivot.dof);
            along.for_each(|(row, b)| distances[row].add(-(Twice::from(b) * pivot.constant)));
        }
        let mut is_empty = vec![true; self.rows.len()];
        contact.triplets().filter(|entry| entry.2 != 0.0).for_each(|(row, ..)| is_empty[row] = false);
        let settled = |(&row, is_empty): (&usize, bool)| match (distances[row], is_empty) {
            (distance, _) if !distance.terms.is_finite() => f64::INFINITY,
            (distance, true) => distance.beyond(FOLLOWS).rounded(),
            (distance, false) => distance.settled().rounded(),
        };
        self.rows.iter().zip(is_empty).map(settled).collect()
    }

    /// Returns `true` if a problem has the same equalities as the one `before`, and the same rows without obstacle.
    pub fn serves(&self, problem: &ContactProblem, before: &ContactProblem) -> bool {
        let is_same = |row: usize| problem.gap()[row] == before.gap()[row];
        let is_alike = |row: usize| problem.gap()[row].is_finite() == before.gap()[row].is_finite();
        problem.equalities() == self.equalities
            && self.equalities.iter().all(|pair| is_same(pair.row) && is_same(pair.opposed))
            && (0..problem.rows()).all(is_alike)
    }

    /// `Z'(f - K u_0)`.
    pub fn load(&self, problem: &ContactProblem) -> Vec<f64> {
        let Solved { pivots, stays, .. } = &self.solved;
        let mut forces: Vec<Sum> = vec![Sum::default(); problem.dofs() + self.sums.len()];
        forces.iter_mut().zip(problem.load()).for_each(|(force, &f)| force.add(f.into()));
        for (row, column, value) in problem.stiffness().lower().triplets() {
            let value = Twice::from(value);
            forces[row].add(-(value * self.solved.constant(column)));
            if row != column {
                forces[column].add(-(value * self.solved.constant(row)));
            }
        }
        let mut load: Vec<Sum> = stays.iter().map(|&dof| forces[dof]).collect();
        for pivot in pivots {
            pivot.others.iter().for_each(|&(place, a)| load[place].add(a * forces[pivot.dof].value));
        }
        load.into_iter().map(|sum| sum.settled().rounded()).collect()
    }

    /// The entries of those dofs and sums that stay, of one for each dof.
    pub fn staying(&self, of_dofs: &[f64]) -> Vec<f64> {
        let mut all = of_dofs.to_vec();
        for sum in &self.sums {
            all.push(sum.iter().fold(Twice::ZERO, |all_terms, &(dof, a)| all_terms + a * all[dof].into()).rounded());
        }
        self.solved.stays.iter().map(|&dof| all[dof]).collect()
    }

    pub fn displacement(&self, y: &[f64]) -> Vec<f64> {
        self.of_dofs(y, 1.0).map(Twice::rounded).collect()
    }

    /// The motion of all dofs, length n, along a direction of those that stay.
    pub fn motion(&self, direction: &[f64]) -> Vec<Twice> {
        self.of_dofs(direction, 0.0).collect()
    }

    /// `Z y` of the dofs alone, and `u_0` this many times.
    fn of_dofs(&self, y: &[f64], times: f64) -> impl Iterator<Item = Twice> {
        let dofs = self.solved.stays.len() + self.solved.pivots.len() - self.sums.len();
        self.solved.of_all(y, times).take(dofs)
    }

    /// An answer in the dofs that stay as one of the whole, without a certificate.
    pub fn expanded(&self, problem: &ContactProblem, answer: Solution) -> Solution {
        let displacement = self.displacement(&answer.displacement);
        let mut multiplier = vec![0.0; problem.rows()];
        self.rows.iter().zip(&answer.multiplier).for_each(|(&row, &force)| multiplier[row] = force);
        let left: Vec<f64> = problem.accurate_residual(&displacement, &multiplier).iter().map(|force| -force).collect();
        for (pair, mu) in self.equalities.iter().zip(self.solved.balancing(&left, self.equalities.len())) {
            if mu <= 0.0 { multiplier[pair.row] = mu } else { multiplier[pair.opposed] = -mu / pair.ratio }
        }
        let set = |of: &ContactSet| {
            let mut set = ContactSet::open(problem.rows());
            of.iter().filter_map(|place| self.rows.get(place)).for_each(|&row| set.insert(row));
            // One row of each pair: both together follow from each other.
            let pressing = |pair: &Equality| if multiplier[pair.opposed] < 0.0 { pair.opposed } else { pair.row };
            self.equalities.iter().for_each(|pair| set.insert(pressing(pair)));
            set
        };
        let history = answer.history.iter();
        let history = history.map(|step| Iteration { contact_set: set(&step.contact_set), ..step.clone() }).collect();
        let (contact_set, method) = (set(&answer.contact_set), format!("{}-eliminated", answer.method));
        Solution { contact_set, history, method, displacement, multiplier, proven: None, ..answer }
    }

    /// Rows that contradict each other, with weights, from those that stay: the equalities take what is left on pivots.
    pub fn contradiction(&self, problem: &ContactProblem, rows: &[usize], weights: &[f64]) -> (Vec<usize>, Vec<f64>) {
        let mut pressed = vec![0.0; problem.rows()];
        rows.iter().zip(weights).for_each(|(&row, weight)| pressed[self.rows[row]] += weight);
        let left: Vec<f64> = problem.contact().mul_transposed(&pressed).iter().map(|force| -force).collect();
        let of_equalities = self.solved.balancing(&left, self.equalities.len());
        let of_equalities = of_equalities.into_iter().map(Twice::from).enumerate().collect();
        let (mut all, mut of_all) = signed(&self.equalities, &of_equalities);
        all.extend(rows.iter().map(|&row| self.rows[row]));
        of_all.extend(weights);
        (all, of_all)
    }
}

/// The rows of the pairs, each on the side of its weight, with their magnitudes.
fn signed(equalities: &[Equality], weights: &Sparse) -> (Vec<usize>, Vec<f64>) {
    let of = |&(number, weight): &(usize, Twice)| {
        let &Equality { row, opposed, ratio } = equalities.get(number)?;
        let weight = weight.rounded();
        Some(if weight >= 0.0 { (row, weight) } else { (opposed, -weight / ratio) })
    };
    weights.iter().filter(|entry| entry.1.rounded() != 0.0).filter_map(of).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;
    use crate::solve;

    /// Rounding of sums of a handful of numbers of order ten.
    const ROUNDING: f64 = 1e-13;

    /// A ring of four loaded dofs, with an inequality, and `u_0 - 2 u_1 + u_3 = 3` as two rows, the second thrice as
    /// large.
    fn tied(load: [f64; 4]) -> ContactProblem {
        let diagonal = [4.0, 3.0, 2.0, 5.0].into_iter().enumerate().map(|(dof, value)| (dof, dof, value));
        let stiffness: Vec<_> = diagonal.chain([(1, 0, -1.0), (2, 1, -1.0), (3, 2, -1.0), (3, 0, -0.5)]).collect();
        let tie = [(0, 1.0), (1, -2.0), (3, 1.0)];
        let rows = [(0, 0, 1.0), (0, 1, 3.0), (0, 2, -1.0)].into_iter();
        let rows = rows.chain(tie.map(|(dof, b)| (1, dof, b))).chain(tie.map(|(dof, b)| (2, dof, -3.0 * b)));
        ContactProblem::of_entries(&stiffness, &load, &rows.collect::<Vec<_>>(), &[2.0, 3.0, -9.0])
    }

    /// The same with a second tie on the dofs that the first one is solved for: `u_0 + u_1 + 2 u_3 = 1`.
    fn twice_tied(load: [f64; 4]) -> ContactProblem {
        let second = SparseMatrix::from_triplets(1, 4, &[(0, 0, 1.0), (0, 1, 1.0), (0, 3, 2.0)]).unwrap();
        tied(load).with_equalities(&second, vec![1.0]).unwrap()
    }

    /// `1/2 u'K u - f'u`.
    fn objective(problem: &ContactProblem, u: &[f64]) -> f64 {
        let elastic = problem.stiffness().mul(u);
        u.iter().zip(elastic).zip(problem.load()).map(|((u, k), f)| u * (k / 2.0 - f)).sum()
    }

    #[test]
    fn the_rest_has_the_objective_and_the_distances_of_the_whole_on_the_equalities() {
        let problem = twice_tied([1.0, -2.0, 3.0, 0.5]);
        let elimination = Elimination::of(&problem).unwrap().unwrap();
        let rest = elimination.problem(&problem).unwrap();
        assert_eq!((rest.dofs(), rest.rows()), (2, 1));
        let at_rest = objective(&problem, &elimination.displacement(&[0.0; 2]));
        for y in [[0.0; 2], [1.0, 2.0], [-3.0, 0.5], [0.25, -7.0]] {
            let u = elimination.displacement(&y);
            let held = [u[0] - 2.0 * u[1] + u[3] - 3.0, u[0] + u[1] + 2.0 * u[3] - 1.0];
            assert!(held.iter().all(|left| left.abs() < ROUNDING), "{u:?}");
            let (whole, of_rest) = (objective(&problem, &u) - at_rest, objective(&rest, &y));
            assert!((whole - of_rest).abs() < ROUNDING * (1.0 + whole.abs()), "{y:?}: {whole} {of_rest}");
            assert!((problem.violation(&u)[0] - rest.violation(&y)[0]).abs() < ROUNDING, "{y:?}");
        }
    }

    #[test]
    fn the_answer_of_the_rest_is_one_of_the_whole_with_multipliers_that_push() {
        // The tie pulls to one side and to the other: the multiplier goes to the first row or to the second.
        for (load, pressing) in [([9.0, -9.0, 3.0, 9.0], 1), ([-9.0, 9.0, 3.0, -9.0], 2)] {
            let problem = twice_tied(load);
            let elimination = Elimination::of(&problem).unwrap().unwrap();
            let answer = solve(&elimination.problem(&problem).unwrap(), &Settings::default()).unwrap();
            let found = elimination.expanded(&problem, answer);
            let left = problem.accurate_residual(&found.displacement, &found.multiplier);
            assert!(left.iter().all(|force| force.abs() < ROUNDING), "{left:?}");
            assert!(
                found.multiplier[pressing] < -0.1 && found.multiplier[3 - pressing] == 0.0,
                "{:?}",
                found.multiplier
            );
            assert!(found.contact_set.contains(pressing) && !found.contact_set.contains(3 - pressing));
        }
    }

    #[test]
    fn rows_that_follow_drop_out_and_contradictory_ones_are_named_with_weights_that_cancel() {
        let plain = tied([0.0; 4]);
        let entries = [(0, 0, 1.0), (0, 1, 1.0), (1, 1, 3.0), (1, 2, 1.0), (2, 0, 2.0), (2, 1, -1.0), (2, 2, -1.0)];
        // The third is twice the first less the second.
        let rows = SparseMatrix::from_triplets(3, 4, &entries).unwrap();
        let follows = plain.with_equalities(&rows, vec![1.0, 5.0, -3.0]).unwrap();
        // Two of these, and the tie.
        assert_eq!(Elimination::of(&follows).unwrap().unwrap().solved.pivots.len(), 3);
        let contradicts = plain.with_equalities(&rows, vec![1.0, 5.0, -4.0]).unwrap();
        let Err(Error::Infeasible { rows, weights, overlap, .. }) = Elimination::of(&contradicts) else {
            panic!("nothing is found")
        };
        let weight =
            |row: usize| rows.iter().zip(&weights).filter(|entry| *entry.0 == row).map(|entry| entry.1).sum::<f64>();
        // Twice the first less the second less the third, in either direction.
        let exact = [2.0, -1.0, -1.0].map(|of_exact| of_exact * weight(3) / 2.0);
        assert!((0..3).all(|row| (weight(3 + row) - exact[row]).abs() < ROUNDING) && weight(3) != 0.0, "{weights:?}");
        assert!(overlap > 0.0);
    }
}
