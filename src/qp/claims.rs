//! What is said of a problem without a unique answer: not convex, infeasible, unbounded, under-held. A method that ends with such
//! a claim, or without a bound, is a reason to look; what is said then rests on the problem alone.
//!
//! With N a basis of the null space of K, everything turns on cones in the few coordinates a of d = N a:
//!
//! ```text
//! unbounded    d = N a with  B d <= 0                              and  f'd > 0
//! under-held   d = N a with  B d = 0 under pressure, <= 0 touching  and  f'd = 0,  from a displacement u that is an answer
//! ```
//!
//! The point of a cone that is nearest to some c is itself the answer to a contact problem, with K = I. It is zero exactly if
//! no direction of the cone leans towards c. Where a method left no answer, steps with `K + rho E` instead of K find one.

use super::attempts;
use super::cost::{Kept, check_memory, check_time, seconds};
use super::judged::{judged, not_rechecked};
use super::settings::{Method, Precision, Settings};
use crate::error::Error;
use crate::qp::certificate::Motion;
use crate::qp::linear::{Analysis, FactorError, SparseMatrix, SymmetricMatrix, dot, exponent, generic, largest, ldexp};
use crate::qp::problem::ContactProblem;
use crate::qp::transform::Scaling;
use crate::solution::Solution;

/// Coordinates below this share of their terms are what the null space leaves of zero.
const NULL_SPACE_ROUNDING: f64 = 1e-10;

/// Rounding of sums in twice the working precision, as a share of their terms.
const TWICE: f64 = 1e-30;

/// Rows under pressure that lie within this share of others are combinations of them.
const DEPENDENT: f64 = 1e-9;

/// A point of a cone that is nearer to its tip than this share of c is the tip.
const TIP: f64 = 1e-8;

/// A row presses if its force on a dof is beyond this share of the forces that are in balance there: less is their rounding.
const PRESSED: f64 = 1e-13;

/// Powers of two in a decade, about.
const DECADE: i32 = 4;

/// A row that is open by less than this share of its displacement and gap may touch.
const TOUCHING: f64 = 1e-8;

/// The same, as a share of what the load would move.
const STRAINED: f64 = 1e-13;

/// A body moves at most so many times as far as a dof that a force moves alone: soft enough for what is not slender.
const BENDS: f64 = 1e3;

/// Where a dof comes that a force moves and no stiffness holds.
const FAR: f64 = 1e300;

/// An answer shows which rows press only if its conditions hold to this, however little is asked for.
const SURE: f64 = 1e-9;

/// Exponent of rho: on a diagonal of order one, far above rounding and far below what resists.
const STEP: i32 = -20;

/// What a step with the added diagonal makes of rounding is below this share of its terms.
const OF_STEP: f64 = 1e-14;

/// A step gains something if the square of its length is below this share of that of the one before.
const SHORTER: f64 = 1e-2;

/// Steps after which one that gains nothing is the last: the first finds a place, the second its forces.
const FEWEST_STEPS: usize = 3;

/// Steps with `K + rho E`, each of which takes a factor `rho / eigenvalue` off the error.
const MOST_STEPS: usize = 12;

/// The ending of a solve, with every claim rechecked; where an ending left no answer, the one that is found here.
///
/// # Errors
/// As [`solve`](super::solve()).
pub(super) fn rechecked(
    problem: &ContactProblem,
    settings: &Settings,
    ending: Result<Solution, Error>,
) -> Result<Solution, Error> {
    let before = match ending {
        Err(error) if is_doubtful(&error, settings) => error,
        sure => return sure,
    };
    if settings.watch.is_over() {
        return Err(not_decided(problem, before)?);
    }
    let scaling = Scaling::of(problem.stiffness(), problem.contact())?;
    let (load, gap) = (scaling.load(problem.load(), 0), scaling.gap(problem.gap(), 0));
    let scaled = match ContactProblem::new(scaling.stiffness().clone(), load, scaling.contact().clone(), gap) {
        Ok(scaled) => scaled,
        // Beyond the range of doubles nothing can be rechecked.
        Err(_) => return Err(not_decided(problem, before)?),
    };
    if check_room(&scaled, settings).is_err() {
        return Err(not_decided(problem, before)?);
    }
    let null = match scaled.stiffness().null_space() {
        Ok(null) => null,
        Err(FactorError::NotPositiveDefinite) => {
            let direction = scaled.stiffness().negative_direction()?;
            let claim = direction.and_then(|p| scaled.not_convex_along(&p));
            return Err(claim.map_or_else(|| not_decided(problem, before), Ok)?);
        }
        Err(error) => return Err(error.into()),
    };
    let Some(null) = null else { return Err(not_decided(problem, before)?) };
    let looked = Looked { scaled: &scaled, scaling: &scaling, by_row: scaled.contact().transposed(), null };
    if let Some(motion) = looked.escape() {
        return Err(Error::Unbounded { motion: motion.in_words(), direction: looked.expanded(&motion) });
    }
    let tolerance = settings.tolerance.min(SURE);
    let holds = |solution: &Solution| solution.certificate.conditions_hold(tolerance);
    let solution = match before {
        Error::NotCertified { solution, .. } if holds(&solution) => *solution,
        before => looked.answer(problem, settings, before)?,
    };
    // A problem that has a place within its rows, and no motion that the load drives, has an answer.
    let motion = match solution.certificate.penetration <= tolerance {
        true => looked.drift(),
        false => None,
    };
    if let Some(motion) = motion.or_else(|| looked.freedom(problem, &solution).filter(|_| holds(&solution))) {
        return Err(Error::UnderHeld { motion: motion.in_words(), direction: looked.expanded(&motion) });
    }
    judged(solution, settings.goal())
}

/// Refuses a factorisation of the stiffness that memory or time do not allow.
///
/// # Errors
/// [`Error::TooLarge`], [`Error::OutOfTime`], and those of the analysis.
fn check_room(problem: &ContactProblem, settings: &Settings) -> Result<(), Error> {
    check_memory(problem, Kept::Nothing, settings)?;
    check_time(&settings.watch, seconds::ordering(problem))?;
    let analysis = Analysis::of(problem.stiffness())?;
    let kept = Kept::Factors { values: analysis.factor_entries(), last: 0, by_interior_point: false };
    check_memory(problem, kept, settings)?;
    check_time(&settings.watch, seconds::factorisation(&analysis))
}

/// Does an ending make a claim, or leave open whether there is one? Without a bound it does where its answer holds its
/// conditions, or where a factor has shown the stiffness to be singular and the answer was to be as good as can be.
fn is_doubtful(error: &Error, settings: &Settings) -> bool {
    match error {
        Error::NotConvex { .. } | Error::Unbounded { .. } | Error::UnderHeld { .. } => true,
        Error::NotCertified { solution, .. } => {
            let is_singular = solution.lost_pivot.is_some() && settings.wants_best();
            let is_open = is_singular || solution.certificate.conditions_hold(settings.tolerance);
            !solution.certificate.has_bound() && is_open
        }
        _ => false,
    }
}

/// The ending of a claim that cannot be rechecked: no answer, and why.
fn not_decided(problem: &ContactProblem, before: Error) -> Result<Error, Error> {
    match before {
        before @ Error::NotCertified { .. } => Ok(before),
        claim => not_rechecked(problem, &claim),
    }
}

/// A scaled problem with a basis of the null space of its stiffness.
struct Looked<'a> {
    scaled: &'a ContactProblem,
    scaling: &'a Scaling,
    /// The contact rows as columns.
    by_row: SparseMatrix,
    null: Vec<Vec<f64>>,
}

impl Looked<'_> {
    /// The direction in the displacements of the problem itself, largest entry one.
    fn expanded(&self, motion: &Motion) -> Vec<f64> {
        let mut direction = self.scaling.expand_displacement(&motion.direction, 0);
        let size = largest(&direction);
        direction.iter_mut().for_each(|value| *value /= size);
        direction
    }

    /// A motion without energy that the load drives and no row stops.
    fn escape(&self) -> Option<Motion> {
        let rows: Vec<Vec<f64>> = self.bounded_rows().map(|row| self.coordinates_of_row(row)).collect();
        let nearest = nearest_of_cone(&rows, &self.coordinates_of_load())?;
        self.motion(&nearest).filter(Motion::escapes)
    }

    /// A motion without energy on which the load does no work, and that no row stops, wherever it starts: of a problem that has
    /// an answer, it has others.
    fn drift(&self) -> Option<Motion> {
        let mut rows: Vec<Vec<f64>> = self.bounded_rows().map(|row| self.coordinates_of_row(row)).collect();
        rows.push(self.coordinates_of_load().iter().map(|value| -value).collect());
        [1.0, -1.0].iter().find_map(|way| {
            let towards: Vec<f64> = generic(self.null.len(), 0).iter().map(|value| way * value).collect();
            self.motion(&nearest_of_cone(&rows, &towards)?).filter(Motion::drifts)
        })
    }

    /// A motion without energy that leads from an answer to others.
    fn freedom(&self, problem: &ContactProblem, solution: &Solution) -> Option<Motion> {
        let u = &solution.displacement;
        let violation = problem.accurate_violation(u);
        let sizes = problem.contact().mul_abs(u);
        // What the load would move dofs that nothing but their own stiffness holds: all that is left of u may be rounding of it.
        let unit = self.scaling.expand_displacement(&vec![STRAINED * largest(self.scaled.load()); u.len()], 0);
        let strained = problem.contact().mul_abs(&unit);
        let (shares, forces) = self.pressing(problem, solution);
        let exponents: Vec<i32> = forces.iter().map(|&force| exponent(force)).collect();
        let mut least: Vec<i32> = (self.bounded_rows().filter(|&row| shares[row] > PRESSED))
            .map(|row| exponents[row].div_euclid(DECADE))
            .collect();
        least.sort_unstable();
        least.dedup();
        // A force may be rounding of those elsewhere: the least ones are left out, one decade after another.
        least.into_iter().chain([i32::MAX]).find_map(|least| {
            let presses = |row: usize| shares[row] > PRESSED && exponents[row].div_euclid(DECADE) >= least;
            let without = self.moved_without(problem, solution, &presses);
            // A row that may press is closed.
            let touches = |row: usize| {
                let closed = TOUCHING * (sizes[row] + problem.gap()[row].abs()) + strained[row] + without[row];
                violation[row] >= -closed || shares[row] > PRESSED
            };
            self.freedom_with(problem, solution, &presses, &touches, &|row| shares[row] > PRESSED)
        })
    }

    /// How far rows may move if none but those that press carry a force: what is then out of balance moves its dof against no
    /// more than the stiffness of that dof, and a body that bends moves further.
    fn moved_without(
        &self,
        problem: &ContactProblem,
        solution: &Solution,
        presses: &dyn Fn(usize) -> bool,
    ) -> Vec<f64> {
        let kept: Vec<f64> = (solution.multiplier.iter().enumerate())
            .map(|(row, &force)| if presses(row) { force } else { 0.0 })
            .collect();
        let residual = problem.accurate_residual(&solution.displacement, &kept);
        let alone = problem.stiffness().diagonal();
        let moved = |(force, stiffness): (f64, &f64)| {
            if force == 0.0 { 0.0 } else { (BENDS * force.abs() / stiffness).min(FAR) }
        };
        problem.contact().mul_abs(&residual.into_iter().zip(&alone).map(moved).collect::<Vec<f64>>())
    }

    /// The same, where it is told which rows press and which touch.
    fn freedom_with(
        &self,
        problem: &ContactProblem,
        solution: &Solution,
        presses: &dyn Fn(usize) -> bool,
        touches: &dyn Fn(usize) -> bool,
        may_press: &dyn Fn(usize) -> bool,
    ) -> Option<Motion> {
        let mut left = Complement::of(self.null.len());
        self.bounded_rows().filter(|&row| presses(row)).for_each(|row| left.remove(&self.coordinates_of_row(row)));
        if !self.is_carried(problem, solution, presses, &left) {
            return None;
        }
        let mut rows: Vec<Vec<f64>> = (self.bounded_rows())
            .filter(|&row| !presses(row) && touches(row))
            .map(|row| left.coordinates(&self.coordinates_of_row(row)))
            .collect();
        rows.push(left.coordinates(&self.coordinates_of_load()).iter().map(|value| -value).collect());
        let stays = |motion: &Motion| {
            self.is_in_balance(problem, solution, motion)
                && self.bounded_rows().all(|row| match motion.approach[row] {
                    speed if speed > 0.0 => !presses(row) && !touches(row),
                    speed if speed < 0.0 => !may_press(row),
                    _ => true,
                })
        };
        // No direction of a cone leans towards c or towards -c only if all are at right angles to it.
        [1.0, -1.0].iter().find_map(|way| {
            let towards: Vec<f64> = generic(left.basis.len(), 0).iter().map(|value| way * value).collect();
            let nearest = nearest_of_cone(&rows, &towards)?;
            self.motion(&left.expanded(&nearest, self.null.len())).filter(stays)
        })
    }

    /// The force of each row, in the dof where it is largest: as a share of those that are in balance there, and in the units
    /// of the scaled problem.
    fn pressing(&self, problem: &ContactProblem, solution: &Solution) -> (Vec<f64>, Vec<f64>) {
        let terms = forces_at(problem, &solution.displacement, &solution.multiplier);
        let units = &self.scaling.equilibration().diagonal;
        let (mut shares, mut forces) = (vec![0.0_f64; problem.rows()], vec![0.0_f64; problem.rows()]);
        for (row, dof, b) in problem.contact().triplets() {
            let force = (b * solution.multiplier[row]).abs();
            if force > 0.0 {
                shares[row] = shares[row].max(force / terms[dof]);
                forces[row] = forces[row].max(ldexp(force, units[dof]));
            }
        }
        (shares, forces)
    }

    /// Is the load in balance on all motions without energy that no pressing row stops? Where it is not, even by the last bit of the
    /// load, rows that seem to carry no force must press.
    fn is_carried(
        &self,
        problem: &ContactProblem,
        solution: &Solution,
        presses: &dyn Fn(usize) -> bool,
        left: &Complement,
    ) -> bool {
        let pressing = (solution.multiplier.iter().enumerate())
            .map(|(row, &force)| if presses(row) { force } else { 0.0 })
            .collect();
        let of_answer = Left::of(problem, solution, pressing);
        left.basis.iter().all(|coordinates| {
            let mut direction = vec![0.0; self.scaled.dofs()];
            for (a, vector) in coordinates.iter().zip(&self.null) {
                direction.iter_mut().zip(vector).for_each(|(d, value)| *d += a * value);
            }
            of_answer.does_no_work_on(&self.scaling.expand_displacement(&direction, 0))
        })
    }

    /// Does the load do no work on a motion d? With `K d = 0`, and `B d = 0` where a row presses, `f'd` is `r'd` for the residual
    /// r of any u and lambda. That of an answer is rounding, and the rounding of d takes from it what is rounding of rounding.
    fn is_in_balance(&self, problem: &ContactProblem, solution: &Solution, motion: &Motion) -> bool {
        let pressing: Vec<f64> = (solution.multiplier.iter().zip(&motion.approach))
            .map(|(&force, &speed)| if speed == 0.0 { force } else { 0.0 })
            .collect();
        let left = Left::of(problem, solution, pressing);
        left.does_no_work_on(&self.expanded(motion))
    }

    fn bounded_rows(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.scaled.rows()).filter(|&row| self.scaled.gap()[row].is_finite())
    }

    fn motion(&self, coordinates: &[f64]) -> Option<Motion> {
        let mut direction = vec![0.0; self.scaled.dofs()];
        for (a, vector) in coordinates.iter().zip(&self.null) {
            direction.iter_mut().zip(vector).for_each(|(d, value)| *d += a * value);
        }
        self.scaled.motion_along(&direction)
    }

    fn coordinates_of_load(&self) -> Vec<f64> {
        self.null.iter().map(|vector| product(self.scaled.load().iter().copied().enumerate(), vector)).collect()
    }

    fn coordinates_of_row(&self, row: usize) -> Vec<f64> {
        self.null.iter().map(|vector| product(self.by_row.column(row), vector)).collect()
    }

    /// The diagonal of `rho E`.
    fn added(&self) -> Vec<f64> {
        let equilibration = self.scaling.equilibration();
        equilibration.diagonal.iter().map(|d| ldexp(1.0, STEP - equilibration.factor - 2 * d)).collect()
    }

    /// An answer by steps with `K + rho E`, E the diagonal that the scaling makes the identity: minimise the energy plus
    /// `rho/2` times the squared distance, in E, from the last answer.
    ///
    /// # Errors
    /// Those of the solves, with [`Error::Infeasible`] for contact rows that contradict each other.
    ///
    /// # Source
    /// R. T. Rockafellar, *Monotone operators and the proximal point algorithm*, SIAM J. Control Optim. 14 (1976) 877-898.
    fn answer(&self, problem: &ContactProblem, settings: &Settings, before: Error) -> Result<Solution, Error> {
        let added = self.added();
        let stiffness = with_diagonal(problem.stiffness(), &added)?;
        let dofs = problem.dofs();
        let settings_of_step = Settings {
            method: Method::ActiveSet,
            precision: Precision::Double,
            accuracy: None,
            prove: false,
            ..settings.clone()
        };
        // The pivot of K itself, not of the steps.
        let lost_pivot = match &before {
            Error::NotCertified { solution, .. } => solution.lost_pivot,
            _ => None,
        };
        let mut best: Option<Solution> = None;
        let (mut centre, mut before_last) = (vec![0.0; dofs], f64::INFINITY);
        for step in 1..=MOST_STEPS {
            let load = (problem.load().iter().zip(&added).zip(&centre)).map(|((f, e), u)| f + e * u).collect();
            let of_step =
                ContactProblem::new(stiffness.clone(), load, problem.contact().clone(), problem.gap().to_vec())?;
            let found = match attempts::solved(&of_step, &settings_of_step) {
                Ok(solution) => solution,
                Err(Error::NotCertified { solution, .. }) => *solution,
                Err(infeasible @ Error::Infeasible { .. }) => return Err(infeasible),
                Err(_) => break,
            };
            let moved = (0..dofs).map(|dof| added[dof] * (found.displacement[dof] - centre[dof]).powi(2)).sum::<f64>();
            centre.clone_from(&found.displacement);
            // The steps become shorter until they are rounding, also where the conditions cannot tell.
            let mut is_better = moved < SHORTER * before_last;
            before_last = moved;
            for (displacement, multiplier) in without_rounding(problem, &added, &centre, &found.multiplier) {
                let certificate = problem.certify(&displacement, &multiplier)?;
                if best.as_ref().is_none_or(|best| certificate.worst().1 < 0.5 * best.certificate.worst().1) {
                    let reason =
                        Some(format!("by {step} steps with K + rho E, since the stiffness is singular: {before}"));
                    let answer =
                        Solution { displacement, multiplier, certificate, reason, lost_pivot, ..found.clone() };
                    best = Some(answer);
                    is_better = true;
                }
            }
            if settings.watch.is_over() || step >= FEWEST_STEPS && !is_better {
                break;
            }
        }
        match best {
            Some(solution) => Ok(solution),
            None => Err(not_decided(problem, before)?),
        }
    }
}

fn with_diagonal(stiffness: &SymmetricMatrix, added: &[f64]) -> Result<SymmetricMatrix, Error> {
    let diagonal = added.iter().enumerate().map(|(dof, &value)| (dof, dof, value));
    let entries: Vec<(usize, usize, f64)> = stiffness.lower().triplets().chain(diagonal).collect();
    SymmetricMatrix::from_lower(SparseMatrix::from_triplets(added.len(), added.len(), &entries)?)
}

/// An answer of a step as it is, without the forces that the added diagonal makes of the rounding of the displacement, and
/// also without the displacements that such forces make.
fn without_rounding(problem: &ContactProblem, added: &[f64], u: &[f64], lambda: &[f64]) -> [(Vec<f64>, Vec<f64>); 3] {
    let mut rounding = vec![0.0_f64; problem.rows()];
    for (row, dof, b) in problem.contact().triplets().filter(|entry| entry.2 != 0.0) {
        rounding[row] = rounding[row].max(OF_STEP * (added[dof] * u[dof] / b).abs());
    }
    let counts = |(&force, least): (&f64, &f64)| if force.abs() > *least { force } else { 0.0 };
    let pressing: Vec<f64> = lambda.iter().zip(&rounding).map(counts).collect();
    let forces = problem.contact().mul_abs_transposed(&absolute(&pressing));
    let left = problem.contact().mul_abs_transposed(&rounding);
    let alone = problem.stiffness().diagonal();
    let moved = |dof: usize| {
        let least = left[dof] + OF_STEP * (forces[dof] + problem.load()[dof].abs());
        if (alone[dof] + added[dof]) * u[dof].abs() > least { u[dof] } else { 0.0 }
    };
    [(u.to_vec(), lambda.to_vec()), (u.to_vec(), pressing.clone()), ((0..u.len()).map(moved).collect(), pressing)]
}

fn absolute(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value.abs()).collect()
}

/// The sizes of the forces that are in balance at each dof.
fn forces_at(problem: &ContactProblem, u: &[f64], lambda: &[f64]) -> Vec<f64> {
    let contact = problem.contact().mul_abs_transposed(&absolute(lambda));
    let elastic = problem.stiffness().mul_abs(u);
    (0..u.len()).map(|dof| contact[dof] + elastic[dof] + problem.load()[dof].abs()).collect()
}

/// The sum of `b_i v_i`, zero where its terms cancel.
fn product(entries: impl Iterator<Item = (usize, f64)>, vector: &[f64]) -> f64 {
    let (sum, terms) = entries.fold((0.0, 0.0_f64), |(sum, terms), (dof, b)| {
        let term = b * vector[dof];
        (sum + term, terms + term.abs())
    });
    if f64::abs(sum) > NULL_SPACE_ROUNDING * terms { sum } else { 0.0 }
}

/// The point of the cone `{a: rows a <= 0}` that is nearest to c, as the answer to a contact problem with K = I; `None` where
/// that is its tip.
fn nearest_of_cone(rows: &[Vec<f64>], c: &[f64]) -> Option<Vec<f64>> {
    let (size, dofs) = (largest(c), c.len());
    if dofs == 0 || !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let diagonal: Vec<(usize, usize, f64)> = (0..dofs).map(|dof| (dof, dof, 1.0)).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &diagonal).ok()?).ok()?;
    let entries: Vec<(usize, usize, f64)> = (rows.iter().enumerate())
        .flat_map(|(number, row)| {
            let unit = exponent(largest(row));
            row.iter().enumerate().filter(|e| *e.1 != 0.0).map(move |(dof, &b)| (number, dof, ldexp(b, -unit)))
        })
        .collect();
    let contact = SparseMatrix::from_triplets(rows.len(), dofs, &entries).ok()?;
    let load = c.iter().map(|value| value / size).collect();
    let problem = ContactProblem::new(stiffness, load, contact, vec![0.0; rows.len()]).ok()?;
    let nearest = match attempts::solved(&problem, &Settings::with_method(Method::Auto)) {
        Ok(solution) => solution.displacement,
        Err(Error::NotCertified { solution, .. }) => solution.displacement,
        Err(_) => return None,
    };
    let distance = largest(&nearest);
    let kept = |value: &f64| if value.abs() > NULL_SPACE_ROUNDING * distance { *value } else { 0.0 };
    (distance > TIP).then(|| nearest.iter().map(kept).collect())
}

/// What an answer leaves of the forces, and what rounding of it is measured by.
struct Left {
    residual: Vec<f64>,
    terms: Vec<f64>,
}

impl Left {
    /// Of an answer whose rows carry the forces `pressing`.
    fn of(problem: &ContactProblem, solution: &Solution, pressing: Vec<f64>) -> Self {
        Left {
            residual: problem.accurate_residual(&solution.displacement, &pressing),
            terms: forces_at(problem, &solution.displacement, &pressing),
        }
    }

    fn does_no_work_on(&self, direction: &[f64]) -> bool {
        let size = absolute(direction);
        let most = NULL_SPACE_ROUNDING * dot(&absolute(&self.residual), &size) + TWICE * dot(&self.terms, &size);
        dot(&self.residual, direction).abs() <= most
    }
}

/// What is at right angles to some vectors of coordinates: an orthonormal basis.
struct Complement {
    basis: Vec<Vec<f64>>,
}

impl Complement {
    /// All coordinates.
    fn of(coordinates: usize) -> Self {
        let unit = |place: usize| (0..coordinates).map(|other| if other == place { 1.0 } else { 0.0 }).collect();
        Complement { basis: (0..coordinates).map(unit).collect() }
    }

    fn coordinates(&self, vector: &[f64]) -> Vec<f64> {
        self.basis.iter().map(|basis| product(vector.iter().copied().enumerate(), basis)).collect()
    }

    /// Takes a vector out: a reflection turns it onto one basis vector, which is dropped.
    fn remove(&mut self, vector: &[f64]) {
        let mut along = self.coordinates(vector);
        let length = dot(&along, &along).sqrt();
        if length <= DEPENDENT * dot(vector, vector).sqrt() {
            return;
        }
        let place = (0..along.len()).max_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
        along[place] += length.copysign(along[place]);
        let square = dot(&along, &along);
        let mut reflector = vec![0.0; vector.len()];
        for (share, basis) in along.iter().zip(&self.basis) {
            reflector.iter_mut().zip(basis).for_each(|(sum, value)| *sum += share * value);
        }
        for (share, basis) in along.iter().zip(&mut self.basis) {
            basis.iter_mut().zip(&reflector).for_each(|(value, r)| *value -= 2.0 * share / square * r);
        }
        self.basis.swap_remove(place);
    }

    fn expanded(&self, coordinates: &[f64], length: usize) -> Vec<f64> {
        let mut sum = vec![0.0; length];
        for (share, basis) in coordinates.iter().zip(&self.basis) {
            sum.iter_mut().zip(basis).for_each(|(sum, value)| *sum += share * value);
        }
        sum
    }
}
