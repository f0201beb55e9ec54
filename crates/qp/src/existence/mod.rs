//! Whether a problem has an answer, and only one: it may be not convex, infeasible, unbounded, or not held enough
//! (`Error::UnderHeld`: the answer can move along a mode without energy). This is decided here, from the problem alone,
//! if a method meets a motion without energy, or if an answer has no bound.
//!
//! With N a basis of the null space of K, all of it depends on cones in the few coordinates a of d = N a:
//!
//! ```text
//! unbounded         d = N a with  B d <= 0                              and  f'd > 0
//! not held enough   d = N a with  B d <= 0 on the rows that touch       and  f'd = 0,  from a displacement u that is an answer
//! ```
//!
//! The point of a cone that is nearest to some c is itself the answer to a contact problem, with K = I. It is zero
//! exactly if no direction of the cone has a positive product with c. N and the signs of all these sums have twice the
//! working precision: what is found holds for the given doubles of the problem.

mod cone;

use cone::{Cone, ConeFace, Row};

use super::cost::{Kept, check_memory, check_time, seconds};
use super::settings::Settings;
use crate::certificate::{NullMode, Rounding, mode_along, not_convex_along};
use crate::error::{Error, Result};
use crate::linear::twice::Sum;
use crate::linear::{Analysis, FactorError, NullSpace, Twice, across, extend, generic, largest, norm, subtract};
use crate::problem::ContactProblem;
use crate::solution::Solution;
use crate::transform::Scaling;

/// The forces of the rows hold the load if at most this share of the forces is left on every mode.
const BALANCED: f64 = 1e-9;

/// A row presses if its force on a dof exceeds this share of the forces in balance there; smaller forces are rounding.
const PRESSED: f64 = 1e-13;

/// An answer whose imbalance may move a row by more than this share of its displacement and gap shows no touching rows.
const SETTLED_FORCES: f64 = 1e-4;

/// A row that is open by less than this share of its displacement and gap may touch.
const TOUCHING: f64 = 1e-8;

/// The same, as a share of the displacement that the load would cause.
const STRAINED: f64 = 1e-13;

/// An answer is settled to this share of its largest displacement, in the units of equal stiffness.
const SETTLED_TO: f64 = 1e-11;

/// A body moves at most this many times as far as a dof that a force moves alone, unless it is slender.
const BENDS: f64 = 1e3;

/// A direction within this share of its length is a rigid-body mode: null vectors of rounded entries have ten digits.
const RIGID: f64 = 1e-6;

/// The analysis of the stiffness, if memory and time allow its factorisation.
fn analysed(problem: &ContactProblem, settings: &Settings) -> Result<Analysis> {
    check_memory(problem, Kept::Nothing, settings.memory)?;
    check_time(&settings.watch, seconds::ordering(problem))?;
    let analysis = Analysis::of(problem.stiffness())?;
    let kept = Kept::Factors { values: analysis.factor_entries(), last: 0, by_interior_point: false };
    check_memory(problem, kept, settings.memory)?;
    check_time(&settings.watch, seconds::factorisation(&analysis))?;
    Ok(analysis)
}

/// The problem in the units of `scaling`.
fn scaled(problem: &ContactProblem, scaling: &Scaling) -> Result<ContactProblem> {
    let (load, gap) = (scaling.load(problem.load(), 0), scaling.gap(problem.gap(), 0));
    ContactProblem::computed(scaling.stiffness().clone(), load, scaling.contact.clone(), gap)
}

/// A scaled problem with a basis of the null space of its stiffness.
pub struct Existence {
    scaled: ContactProblem,
    pub scaling: Scaling,
    null: NullSpace,
    rounding: Rounding,
    /// `B N` of each row with a bound, and the place of the row among all.
    rows: Vec<(usize, Row)>,
    /// `-f'N`: as a row, the load stops directions against it.
    against_load: Row,
    /// The softest motion that the stiffness holds within rounding, and the share of its terms with which.
    within_rounding: Option<(usize, f64)>,
}

impl Existence {
    /// The null space of the stiffness of `problem`; `None` if the range of doubles does not allow it.
    pub fn of(problem: &ContactProblem, settings: &Settings) -> Result<Option<Self>> {
        let scaling = Scaling::of(problem.stiffness(), problem.contact())?;
        let Ok(scaled) = scaled(problem, &scaling) else { return Ok(None) };
        let shifts = scaled.stiffness().shifts(analysed(&scaled, settings)?)?;
        let null = match scaled.stiffness().null_space(&shifts) {
            Ok(Some(null)) => null,
            Ok(None) => return Ok(None),
            Err(FactorError::NotPositiveDefinite) => {
                let direction = scaled.stiffness().negative_direction(&shifts, &settings.watch)?;
                return direction.and_then(|p| not_convex_along(&scaled, &p)).map_or(Ok(None), Err);
            }
            Err(error) => return Err(error.into()),
        };
        // A rounded direction is a motion without energy only for a body that is known to float.
        let bodies = scaled.stiffness().components().0;
        let expanded = |vector: &[Twice]| {
            let rounded: Vec<f64> = vector.iter().map(|value| value.rounded()).collect();
            scaling.expand_displacement(&rounded, 0)
        };
        let softest = null.shares.iter().zip(&null.vectors).max_by(|a, b| a.0.total_cmp(b.0));
        let dof = softest.map_or(0, |(_, vector)| place_of_largest(&expanded(vector)));
        let (null, share) = null.declared(|vector| is_rigid(problem, &expanded(vector), &bodies));
        let within_rounding = (share > 0.0).then_some((dof, share));
        Ok(Some(Existence { within_rounding, ..Self::with(scaled, scaling, null) }))
    }

    fn with(scaled: ContactProblem, scaling: Scaling, null: NullSpace) -> Self {
        let (rounding, by_row) = (Rounding::of(&null), scaled.contact().transposed());
        let bounded = (0..scaled.rows()).filter(|&row| scaled.gap()[row].is_finite());
        let rows = bounded.map(|row| (row, coordinates(&null, || by_row.column(row), rounding))).collect();
        let against_load = coordinates(&null, || scaled.load().iter().map(|f| -f).enumerate(), rounding);
        Existence { scaled, scaling, null, rounding, rows, against_load, within_rounding: None }
    }

    /// Springs at as many dofs as there are motions without energy, which hold all: their entries of a matrix.
    pub fn springs(&self) -> Vec<(usize, usize, f64)> {
        let (kind, mut motions, mut springs) = (self.scaling.identity(0), self.null.found.clone(), Vec::new());
        while let Some(motion) = motions.pop() {
            let dof = place_of_largest(&motion);
            for other in &mut motions {
                let share = other[dof] / motion[dof];
                subtract(other, share, &motion);
            }
            springs.push((dof, dof, kind[dof]));
        }
        springs
    }

    /// The error if the load drives a mode without energy that no row stops; that the rows can be met is left open.
    pub fn unbounded(&self) -> Option<Error> {
        let along_load: Vec<f64> = self.against_load.values.iter().map(|value| -value.rounded()).collect();
        let mode = self.mode(&self.cone(&|_| true).nearest(&along_load)?).filter(NullMode::escapes)?;
        Some(Error::Unbounded { mode: mode.in_words(), direction: self.expanded(&mode) })
    }

    /// The reason why existence is not decided, if the stiffness holds a motion by rounding alone.
    pub fn doubt(&self) -> Option<String> {
        let (dof, share) = self.within_rounding?;
        Some(format!(
            "the stiffness holds a motion, mainly at dof {dof} (indices from 0), by {share:.1e} of its terms, within the rounding of its \
             entries, {:.1e}; give the rigid-body modes if the body floats",
            NullSpace::OF_ENTRIES
        ))
    }

    /// Checks that no mode leads from the best answer to others. A problem with a displacement that meets its rows, and
    /// without a mode that the load drives, has an answer.
    pub fn check_unique(&self, problem: &ContactProblem, solution: &Solution, tolerance: f64) -> Result<()> {
        let certificate = &solution.certificate;
        // No row stops such a mode from any start: with it, a problem has more than one answer if it has any.
        let drift = if certificate.penetration <= tolerance { self.idle(&|_| true) } else { None };
        let freedom = || self.freedom(problem, solution).filter(|_| certificate.conditions_hold(tolerance));
        match drift.or_else(freedom) {
            Some(mode) => Err(Error::UnderHeld { mode: mode.in_words(), direction: self.expanded(&mode) }),
            None => Ok(()),
        }
    }

    /// The direction in the displacements of the problem itself, largest entry one.
    fn expanded(&self, mode: &NullMode) -> Vec<f64> {
        let mut direction = self.scaling.expand_displacement(&mode.direction, 0);
        let size = largest(&direction);
        direction.iter_mut().for_each(|value| *value /= size);
        direction
    }

    /// A mode without energy that leads from an answer to others.
    ///
    /// If a displacement differs from u by a d with `K d = 0` and `f'd = 0`, it has the same energy. It meets the rows
    /// if d closes no row that touches, also not on the way to where it has opened all rows that u violates.
    fn freedom(&self, problem: &ContactProblem, solution: &Solution) -> Option<NullMode> {
        let u = &solution.displacement;
        let violation = problem.accurate_violation(u);
        let sizes = problem.contact().mul_abs(u);
        // Two scales: the displacement by the load of dofs held by their own stiffness only, and the rounding that the
        // largest displacement leaves in others. Any u below these may be rounding.
        let ones = self.scaling.expand_displacement(&vec![1.0; u.len()], 0);
        let largest_move = u.iter().zip(&ones).fold(0.0, |most: f64, (u, one)| most.max(u.abs() / one));
        let unit = STRAINED * largest(self.scaled.load()) + SETTLED_TO * largest_move;
        let unit: Vec<f64> = ones.iter().map(|one| unit * one).collect();
        let strained = problem.contact().mul_abs(&unit);
        let shares = shares_of_forces(problem, solution);
        let presses = |row: usize| shares[row] > PRESSED;
        let pressing: Vec<f64> = (solution.multiplier.iter().enumerate())
            .map(|(row, &force)| if presses(row) { force } else { 0.0 })
            .collect();
        let unbalanced = moved_by_residual(problem, u, &pressing);
        let sure =
            |row: usize| unbalanced[row] <= SETTLED_FORCES * (sizes[row] + problem.gap()[row].abs()) + strained[row];
        if !(self.rows.iter().all(|&(row, _)| sure(row)) && self.is_carried_by(&self.scaling.multiplier(&pressing, 0)))
        {
            return None;
        }
        let touches = |row: usize| {
            let closed = TOUCHING * (sizes[row] + problem.gap()[row].abs()) + strained[row] + unbalanced[row];
            violation[row] >= -closed || solution.multiplier[row] != 0.0
        };
        let violation = self.scaling.gap(&violation, 0);
        let leads_on = |NullMode { approach, .. }: &NullMode| {
            let leaving = self.rows.iter().filter(|(row, _)| approach[*row] < 0.0);
            let way = leaving.fold(0.0, |way: f64, &(row, _)| way.max(violation[row] / -approach[row]));
            let stays_open = |row: usize| approach[row] <= 0.0 || violation[row] + way * approach[row] < 0.0;
            self.rows.iter().all(|&(row, _)| stays_open(row) && (!presses(row) || approach[row] == 0.0))
        };
        self.idle(&touches).filter(leads_on)
    }

    /// Returns `true` if these forces of the rows hold the load on all modes without energy: they do so to the digits
    /// of doubles, in their own terms, and the rows that carry them can do so exactly. The last bit of the load may
    /// need another row.
    fn is_carried_by(&self, forces: &[f64]) -> bool {
        let (mut left, mut terms) = (self.against_load.values.clone(), Vec::new());
        terms.extend(left.iter().map(|value| value.rounded().abs()));
        let mut face = ConeFace::default();
        for (row, of_row) in self.rows.iter().filter(|(row, _)| forces[*row] != 0.0) {
            face.hold(of_row, self.rounding.vanishes);
            for ((left, terms), &value) in left.iter_mut().zip(&mut terms).zip(&of_row.values) {
                let force = value * forces[*row].into();
                *left = *left - force;
                *terms += force.rounded().abs();
            }
        }
        let is_balanced = left.iter().zip(&terms).all(|(left, terms)| left.rounded().abs() <= BALANCED * terms);
        is_balanced && face.contains(&self.against_load, self.rounding.vanishes)
    }

    /// A mode without energy on which the load does no work, and that closes none of these rows.
    fn idle(&self, stops: &dyn Fn(usize) -> bool) -> Option<NullMode> {
        let cone = Cone { fixed: Some(&self.against_load), ..self.cone(stops) };
        let stays = |mode: &NullMode| {
            mode.is_idle() && self.rows.iter().all(|&(row, _)| mode.approach[row] <= 0.0 || !stops(row))
        };
        // All directions of a cone are orthogonal to c if no direction has a positive product with c or with -c.
        [1.0, -1.0].iter().find_map(|way| {
            let towards: Vec<f64> = generic(self.null.vectors.len(), 0).iter().map(|value| way * value).collect();
            self.mode(&cone.nearest(&towards)?).filter(stays)
        })
    }

    /// The cone of the modes that close none of these rows.
    fn cone<'b>(&'b self, stops: &dyn Fn(usize) -> bool) -> Cone<'b> {
        let rows = self.rows.iter().filter(|(row, _)| stops(*row)).map(|(_, row)| row).collect();
        Cone { rows, fixed: None, rounding: self.rounding.vanishes, is_exact: self.null.is_exact() }
    }

    fn mode(&self, coordinates: &[Twice]) -> Option<NullMode> {
        let mut direction = vec![Twice::ZERO; self.scaled.dofs()];
        for (&a, vector) in coordinates.iter().zip(&self.null.vectors) {
            direction.iter_mut().zip(vector).for_each(|(d, &value)| *d = *d + a * value);
        }
        mode_along(&self.scaled, &direction, self.rounding)
    }
}

/// A linear function of displacements in the coordinates of a null space.
fn coordinates<I: Iterator<Item = (usize, f64)>>(null: &NullSpace, entries: impl Fn() -> I, rounding: Rounding) -> Row {
    let along = |vector: &Vec<Twice>| entries().map(|(dof, b)| Twice::from(b) * vector[dof]).collect();
    let sums: Vec<Sum> = null.vectors.iter().map(along).collect();
    let values = sums.iter().map(|sum| sum.beyond(rounding.vanishes)).collect();
    Row { values, terms: sums.iter().map(|sum| sum.terms).sum() }
}

/// Upper bounds on the moves of rows by the imbalance of u and lambda: a force moves its dof against no more than the
/// stiffness of that dof, and a body that bends moves further.
fn moved_by_residual(problem: &ContactProblem, u: &[f64], lambda: &[f64]) -> Vec<f64> {
    let residual = problem.accurate_residual(u, lambda);
    let alone = problem.stiffness().diagonal();
    // A force on a dof without stiffness moves no dof with stiffness.
    let moved = |(force, stiffness): (f64, &f64)| if *stiffness > 0.0 { BENDS * force.abs() / stiffness } else { 0.0 };
    problem.contact().mul_abs(&residual.into_iter().zip(&alone).map(moved).collect::<Vec<f64>>())
}

/// The force of each row in the dof with the largest share, as a share of the forces in balance there.
fn shares_of_forces(problem: &ContactProblem, solution: &Solution) -> Vec<f64> {
    let lambda: Vec<f64> = solution.multiplier.iter().map(|value| value.abs()).collect();
    let (contact, elastic) =
        (problem.contact().mul_abs_transposed(&lambda), problem.stiffness().mul_abs(&solution.displacement));
    let terms = |dof: usize| contact[dof] + elastic[dof] + problem.load()[dof].abs();
    let mut shares = vec![0.0_f64; problem.rows()];
    for (row, dof, b) in problem.contact().triplets().filter(|entry| entry.2 != 0.0 && lambda[entry.0] > 0.0) {
        shares[row] = shares[row].max(b.abs() * lambda[row] / terms(dof));
    }
    shares
}

/// Returns `true` if a displacement of one of these bodies is a rigid-body mode that the problem declares.
fn is_rigid(problem: &ContactProblem, displacement: &[f64], bodies: &[usize]) -> bool {
    let Some(modes) = problem.near_null() else { return false };
    let body = bodies[place_of_largest(displacement)];
    let own = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(bodies).filter(|entry| *entry.1 == body).map(|entry| *entry.0).collect()
    };
    let mut directions: Vec<Vec<f64>> = Vec::new();
    for mode in modes.vectors() {
        extend(&mut directions, own(mode), RIGID);
    }
    let elsewhere = displacement.iter().zip(bodies).filter(|entry| *entry.1 != body).map(|entry| entry.0.abs());
    let left = norm(&across(&directions, own(displacement))) + elsewhere.sum::<f64>();
    left <= RIGID * norm(displacement)
}

fn place_of_largest(values: &[f64]) -> usize {
    let by_size = |a: &(usize, &f64), b: &(usize, &f64)| a.1.abs().total_cmp(&b.1.abs());
    values.iter().enumerate().max_by(by_size).map_or(0, |entry| entry.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::multigrid::NearNullSpace;
    use crate::solve;

    /// A dof of stiffness 2 under a force of 4 before a wall at 1, with that dof alone or with a second one that only a
    /// wall at 5 holds.
    fn before_a_wall(dofs: usize) -> ContactProblem {
        let walls: Vec<_> = (0..dofs).map(|dof| (dof, dof, 1.0)).collect();
        ContactProblem::of_entries(&[(0, 0, 2.0)], &[4.0, 0.0][..dofs], &walls, &[1.0, 5.0][..dofs])
    }

    #[test]
    fn a_force_counts_beside_all_forces_in_balance_on_its_dof() {
        // A force of 2 by the wall beside a load of 4 and an elastic force of 2.
        let problem = before_a_wall(1);
        let solution = solve(&problem, &Settings::default()).unwrap();
        assert_eq!((&solution.displacement[..], &solution.multiplier[..]), (&[1.0][..], &[-2.0][..]));
        assert_eq!(shares_of_forces(&problem, &solution), [0.25]);
    }

    /// What is looked at to decide on `problem`, with its scaling.
    fn looked_at(problem: &ContactProblem) -> (Existence, Scaling) {
        let scaling = Scaling::of(problem.stiffness(), problem.contact()).unwrap();
        let scaled = scaled(problem, &scaling).unwrap();
        let shifts = scaled.stiffness().shifts(Analysis::of(scaled.stiffness()).unwrap()).unwrap();
        let null = scaled.stiffness().null_space(&shifts).unwrap().unwrap();
        (Existence::with(scaled, scaling.clone(), null), scaling)
    }

    /// Returns `true` if `freedom` finds a mode for this displacement of the first dof and this force of its wall; the
    /// second dof is at rest.
    fn is_free(displacement: f64, force: f64) -> bool {
        let (problem, alone) = (before_a_wall(2), before_a_wall(1));
        let mut solution = solve(&alone, &Settings::default()).unwrap();
        (solution.displacement, solution.multiplier) = (vec![displacement, 0.0], vec![-force, 0.0]);
        looked_at(&problem).0.freedom(&problem, &solution).is_some()
    }

    #[test]
    fn forces_carry_a_load_if_they_balance_it_on_every_mode() {
        // Only its wall holds the second dof, under a force of 3.
        let problem = before_a_wall(2).with_load(vec![4.0, 3.0]).unwrap();
        let (looked, scaling) = looked_at(&problem);
        let is_carried = |forces: [f64; 2]| looked.is_carried_by(&scaling.multiplier(&forces, 0));
        // The force on the first wall does not act on the mode.
        assert!(is_carried([-2.0, -3.0]) && is_carried([0.0, -3.0]));
        assert!(is_carried([-2.0, -3.0 * (1.0 - BALANCED)]));
        for force in [-3.0 * (1.0 - 3.0 * BALANCED), -2.9, -3.1, 0.0, 3.0] {
            assert!(!is_carried([-2.0, force]), "{force}");
        }
    }

    #[test]
    fn an_answer_out_of_balance_shows_no_freedom() {
        assert!(is_free(1.0, 2.0));
        // With an imbalance e the dof may move by 1e3 e / 2; 1e-4 of displacement and gap, 2, are allowed.
        assert!(is_free(1.0, 2.0 + 3e-7) && is_free(1.0, 2.0 - 3e-7));
        assert!(!is_free(1.0, 2.0 + 5e-7) && !is_free(1.0, 2.0 - 5e-7));
    }

    #[test]
    fn walls_nearer_than_the_rounding_of_the_strain_leave_no_freedom() {
        // A dof without stiffness between two walls, beside one of stiffness 2 under a force of 4 before its wall.
        let rows = [(0, 0, 1.0), (1, 1, 1.0), (2, 1, -1.0)];
        let is_free = |room: f64| {
            let problem = ContactProblem::of_entries(&[(0, 0, 2.0)], &[4.0, 0.0], &rows, &[1.0, room, room]);
            let mut solution = solve(&before_a_wall(1), &Settings::default()).unwrap();
            (solution.displacement, solution.multiplier) = (vec![1.0, 0.0], vec![-2.0, 0.0, 0.0]);
            looked_at(&problem).0.freedom(&problem, &solution).is_some()
        };
        // In these units the displacement counts as 1e-11, the load as 1e-13 of itself.
        assert!(is_free(1e-9) && !is_free(1e-12) && !is_free(0.0));
    }

    #[test]
    fn a_force_out_of_balance_moves_a_row_a_thousand_times_as_far_as_its_dof_alone() {
        let springs = [(0, 0, 2.0), (1, 1, 8.0)];
        let rows = [(0, 0, -3.0), (0, 1, 1.0), (1, 2, 1.0)];
        let problem = ContactProblem::of_entries(&springs, &[4.0, 16.0, 1.0], &rows, &[1.0, 1.0]);
        // 4 / 2 through a coefficient of three, and 16 / 8; the third dof has no stiffness, and moves nothing.
        assert_eq!(moved_by_residual(&problem, &[0.0; 3], &[0.0; 2]), [BENDS * (3.0 * 2.0 + 2.0), 0.0]);
    }

    #[test]
    fn a_motion_is_rigid_if_it_is_one_of_those_declared_on_its_own_body() {
        // Two bodies of three dofs on a line, with a translation and a rotation of the whole space.
        let problem = ContactProblem::of_entries(&[(0, 0, 1.0)], &[0.0; 6], &[], &[]);
        let bodies = [0, 0, 0, 1, 1, 1];
        let translation = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        assert!(!is_rigid(&problem, &translation, &bodies));
        let modes = vec![vec![1.0; 6], vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]];
        let problem = problem.with_near_null(NearNullSpace::new(modes, 6).unwrap()).unwrap();
        assert!(is_rigid(&problem, &translation, &bodies));
        assert!(is_rigid(&problem, &[0.0, 0.0, 0.0, -1.0, 1.0, 3.0], &bodies));
        // A bend, and motions of both bodies.
        assert!(!is_rigid(&problem, &[1.0, 0.0, 1.0, 0.0, 0.0, 0.0], &bodies));
        assert!(!is_rigid(&problem, &[1.0; 6], &bodies));
        let nearly = |share: f64| [1.0, 1.0 + share, 1.0, 0.0, 0.0, 0.0];
        assert!(is_rigid(&problem, &nearly(RIGID), &bodies) && !is_rigid(&problem, &nearly(1e2 * RIGID), &bodies));
    }
}
