//! Central differences with a diagonal mass; a node that would cross the obstacle gets an impulse.
//!
//! ```text
//! v* = v + dt a/2,   v~ = argmin norm_M(v~ - v*) with B v~ <= bound,   u+ = u + dt v~
//! M a+ = f+ - K u+ - C v~,   v+ = v~ + dt a+/2,   lambda = M (v~ - v*)/dt
//! ```
//!
//! The bound lets an open row reach the obstacle but not cross it; with a restitution e > 0 a row that would cross it
//! leaves with `-e` times its velocity.
//!
//! A restitution above 0 makes the mesh oscillate: with e = 0.5 the energy of a bar stays within 1 % at 0.3 of the
//! stable step, and grows by 10 % at 0.5 and by 500 % at 0.9. With e = 0 it never grows: see `fox_goodwin.rs`, of which
//! this is the rule with beta = 0.
//!
//! # Source
//! J. J. Moreau, *Numerical aspects of the sweeping process*, Comput. Methods Appl. Mech. Eng. 177 (1999) 329-349: the
//! impact law.

use super::newmark::TRAPEZOIDAL;
use crate::step::{Advance, Facts, HalfStep, Parameter, Stepping, halfway, next, plus};
use crate::{Balance, DynamicProblem, State};
use signorini_fem::assembly::MassForm;
use signorini_qp as qp;
use signorini_qp::Error;
use signorini_qp::{ContactSet, SymmetricMatrix, largest};

pub(super) static ABOUT: Facts = Facts {
    name: "central-difference",
    parameter: Some(Parameter {
        name: "restitution",
        default: 0.0,
        allows: |restitution| (0.0..=1.0).contains(&restitution),
        range: "from 0 to 1",
    }),
    // The scheme divides by the mass.
    masses: &[MassForm::Lumped],
    gains_energy: false,
    is_explicit: true,
    load_times: &[0.0],
    prepare: |problem, step, restitution, settings| {
        check_step(problem, step)?;
        let mass = Stepping::of(problem, problem.mass().clone(), settings)?;
        Ok(Box::new(CentralDifference { restitution, mass, diagonal: problem.mass().diagonal() }))
    },
    ..TRAPEZOIDAL
};

#[derive(Debug)]
struct CentralDifference {
    restitution: f64,
    mass: Stepping,
    diagonal: Vec<f64>,
}

impl CentralDifference {
    /// The acceleration without contact.
    fn acceleration(&self, problem: &DynamicProblem, t: f64, elastic: &[f64], velocity: &[f64]) -> Vec<f64> {
        let mut force = plus(&problem.load_at(t), -1.0, elastic);
        problem.damp(1.0, velocity, &mut force);
        force.iter().zip(&self.diagonal).map(|(f, m)| f / m).collect()
    }
}

impl Advance for CentralDifference {
    fn start(&self, problem: &DynamicProblem, _: f64, state: State) -> Result<State, Error> {
        let acceleration = self.acceleration(problem, 0.0, &state.elastic, &state.velocity);
        Ok(State { acceleration, ..state })
    }

    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let statics = problem.statics();
        let mut velocity = plus(&state.velocity, step / 2.0, &state.acceleration);
        let approach = statics.contact().mul(&velocity);
        let room = problem.remaining_gap(&state.displacement);
        let bound = room.iter().zip(&approach).map(|(room, &approach)| {
            let crosses = step * approach > *room && approach > 0.0;
            let allowed = if crosses && self.restitution > 0.0 { -self.restitution * approach } else { room / step };
            allowed - approach
        });
        let (mut multiplier, mut contact_set) = (vec![0.0; statics.rows()], ContactSet::open(statics.rows()));
        if let Some(blow) = self.mass.smallest(bound.collect(), &state.contact_set)? {
            velocity = plus(&velocity, 1.0, &blow.change);
            multiplier = blow.multiplier.iter().map(|impulse| impulse / step).collect();
            contact_set = blow.contact_set;
        }
        let displacement = plus(&state.displacement, step, &velocity);
        let mut end = next(problem, state, [displacement, velocity], (multiplier, contact_set));
        end.rate = end.elastic.iter().zip(&state.elastic).map(|(after, before)| (after - before) / step).collect();
        end.acceleration = self.acceleration(problem, end.steps as f64 * step, &end.elastic, &end.velocity);
        end.velocity = plus(&end.velocity, step / 2.0, &end.acceleration);
        Ok(end.with_forces(problem))
    }

    /// Leapfrog preserves its energy halfway between two displacements.
    fn half_step(&self, problem: &DynamicProblem, step: f64, state: &State) -> Option<HalfStep> {
        let back = if state.steps == 0 { 0.0 } else { step };
        let velocity = plus(&state.velocity, -back / 2.0, &state.acceleration);
        let momentum = problem.mass().mul(&velocity);
        let elastic = || problem.statics().stiffness().mul(&velocity);
        let rate = if state.rate.is_empty() { elastic() } else { state.rate.clone() };
        Some(halfway(back, 0.0, state, (&velocity, &momentum), &rate))
    }

    /// The mean of both ends: the impulse of the contact forces changes the momentum over this interval. Dampers act
    /// with the velocities `v~` that led to both ends; at the start there is only v.
    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        let back = |state: &State| if state.steps == 0 { 0.0 } else { step / 2.0 };
        let damped = |state: &State, dof: usize| state.velocity[dof] - back(state) * state.acceleration[dof];
        let velocity = at.iter().map(|&dof| (damped(before, dof) + damped(after, dof)) / 2.0).collect();
        Balance { velocity, ..Balance::between(step, before, after, 0.5, at) }
    }
}

/// Steps of the iteration for the largest frequency; each gives a bound, later bounds are sharper.
const STEPS: usize = 60;

/// The step may exceed the limit by this share: rounding.
const LIMIT_ROUNDING: f64 = 1e-12;

/// The largest allowed share of the stable step if bodies touch.
///
/// At 1 the shortest wave has a double root: each impact adds to it, and it grows with time. Below 1, at the share C,
/// it carries up to 1/(1 - C^2) times the energy of the impacts that feed it: 50 at 0.99. Measured on the bar of period
/// 3 over 20 periods, the energy grows by 0.1 % at 0.9, by 0.4 % at 0.99, by 6 % at 0.999, by 420 % at 0.9999 and by
/// 100 % at 1.
pub const MOST_IN_CONTACT: f64 = 0.99;

/// An upper bound on the largest angular frequency, per time, of a stiffness with a positive diagonal mass, without
/// damping.
pub fn frequency_bound(stiffness: &SymmetricMatrix, mass: &[f64]) -> f64 {
    let mut x = vec![1.0; mass.len()];
    let mut bound = f64::INFINITY;
    for _ in 0..STEPS {
        let mut product = stiffness.mul_abs(&x);
        product.iter_mut().zip(mass).for_each(|(p, m)| *p /= m);
        bound = product.iter().zip(&x).fold(0.0, |most: f64, (p, x)| most.max(p / x)).min(bound);
        let size = largest(&product);
        if size <= 0.0 {
            break;
        }
        // The mean with the last vector stays positive and does not oscillate.
        x.iter_mut().zip(&product).for_each(|(x, p)| *x = (*x + p / size) / 2.0);
    }
    bound.sqrt()
}

/// Checks that `step` is stable.
pub(super) fn check_step(problem: &DynamicProblem, step: f64) -> Result<(), Error> {
    let most = problem.stable_step()?;
    if step <= most * (1.0 + LIMIT_ROUNDING) {
        return Ok(());
    }
    let reason = format!("the step {step:e} is beyond the largest stable one, {most:e}; take a smaller step");
    Err(qp::LinearError::Numerical { step: "central differences", reason }.into())
}

impl DynamicProblem {
    /// An upper bound on the largest angular frequency without damping, per time: the given one, or that of a positive
    /// diagonal mass; `None` if none is known.
    pub(super) fn largest_frequency(&self) -> Option<f64> {
        let diagonal = self.mass().diagonal();
        let is_diagonal = || {
            let beside = self.mass().lower().triplets().any(|(row, column, value)| row != column && value != 0.0);
            !beside && diagonal.iter().all(|&mass| mass > 0.0)
        };
        let bound = || is_diagonal().then(|| frequency_bound(self.statics().stiffness(), &diagonal));
        self.frequency.or_else(bound)
    }

    /// A step, in time, up to which central differences with a diagonal mass are stable:
    /// `2/omega (sqrt(1 + xi^2) - xi)` with an upper bound of the largest frequency omega and its damping ratio xi.
    ///
    /// The bound is that of Collatz for the matrix of magnitudes `|M^-1 K|`: `omega^2 <= max_i (|M^-1 K| x)_i / x_i`
    /// for every positive x. It is sharp in a bar and a few percent to some ten percent large elsewhere.
    ///
    /// # Source
    /// T. Belytschko, W. K. Liu, B. Moran, *Nonlinear Finite Elements for Continua and Structures*, Wiley, 2000,
    /// section 6.2: the stable step with damping. L. Collatz, *Einschließungssatz für die charakteristischen Zahlen von
    /// Matrizen*, Math. Z. 48 (1942) 221-226.
    pub fn stable_step(&self) -> Result<f64, Error> {
        let mass = self.mass();
        let diagonal = mass.diagonal();
        if let Some(&value) = diagonal.iter().find(|&&entry| entry <= 0.0) {
            let allowed = "positive in an explicit scheme";
            return Err(qp::LinearError::Setting { name: "mass of a dof", value, allowed }.into());
        }
        if let Some((_, _, value)) = mass.lower().triplets().find(|&(row, column, value)| row != column && value != 0.0)
        {
            let allowed = "zero in an explicit scheme: take a lumped mass";
            return Err(
                qp::LinearError::Setting { name: "entry of the mass beside its diagonal", value, allowed }.into()
            );
        }
        let omega = frequency_bound(self.statics().stiffness(), &diagonal);
        let [of_mass, of_stiffness] = self.damping();
        let ratio = if omega > 0.0 { of_mass / (2.0 * omega) + of_stiffness * omega / 2.0 } else { 0.0 };
        Ok(2.0 / omega * (ratio.hypot(1.0) - ratio))
    }
}
