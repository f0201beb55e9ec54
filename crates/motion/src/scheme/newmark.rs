//! Newmark's family with the constraint at the end of the step: the trapezoidal rule with beta = 1/4 and gamma = 1/2,
//! HHT-alpha, and the contact-stabilised rule.
//!
//! ```text
//! u^ = u + dt v + dt^2 (1/2 - beta) a,   v^ = v + dt (1 - gamma) a,   u+ = u^ + w,   a+ = w/(beta dt^2),   v+ = v^ + dt gamma a+
//! M a+ + (1 + alpha) (C v+ + K u+ - f+) - alpha (C v + K u - f) = B' lambda+,   B u+ <= g
//! ```
//!
//! # Source
//! H. M. Hilber, T. J. R. Hughes, R. L. Taylor, *Improved numerical dissipation for time integration algorithms in
//! structural dynamics*, Earthq. Eng. Struct. Dyn. 5 (1977) 283-292.

use crate::step::{Advance, Facts, Moved, Parameter, Stepping, next, plus};
use crate::{Balance, DynamicProblem, State};
use signorini_fem::assembly::MassForm;
use signorini_qp as qp;
use signorini_qp::Error;
use signorini_qp::{Method, Penalty, Settings, largest};

#[derive(Debug)]
pub(super) struct Newmark {
    alpha: f64,
    beta: f64,
    gamma: f64,
    pub stepping: Stepping,
    mass: Stepping,
}

/// The start of a step: displacement and velocity as they would be without its acceleration, and the contact problem of
/// the change.
pub(super) struct Predicted {
    pub displacement: Vec<f64>,
    velocity: Vec<f64>,
    pub force: Vec<f64>,
    pub gap: Vec<f64>,
}

impl Newmark {
    /// The rule with parameter alpha; `rigid` are the settings of the contact problems with the mass, `settings` those
    /// of the steps.
    pub fn new(
        problem: &DynamicProblem,
        step: f64,
        alpha: f64,
        settings: &Settings,
        rigid: &Settings,
    ) -> Result<Self, Error> {
        let (beta, gamma) = ((1.0 - alpha).powi(2) / 4.0, 0.5 - alpha);
        let inertia = 1.0 / (beta * step * step);
        let weight = 1.0 + alpha;
        let matrix = problem.combination(inertia, weight * gamma / (beta * step), weight)?;
        let stepping = Stepping::of(problem, matrix, settings)?;
        Ok(Newmark { alpha, beta, gamma, stepping, mass: Stepping::of(problem, problem.mass().clone(), rigid)? })
    }

    /// The contact problem of the step from `state`.
    pub fn predict(&self, problem: &DynamicProblem, step: f64, state: &State) -> Predicted {
        let Newmark { alpha, beta, gamma, .. } = *self;
        let time = |steps: usize| steps as f64 * step;
        let coasting = plus(&state.displacement, step, &state.velocity);
        let displacement = plus(&coasting, step * step * (0.5 - beta), &state.acceleration);
        let velocity = plus(&state.velocity, step * (1.0 - gamma), &state.acceleration);
        let elastic = problem.statics().stiffness().mul(&displacement);
        let mut force = plus(&problem.load_at(time(state.steps + 1)), -1.0, &elastic);
        problem.damp(1.0, &velocity, &mut force);
        if alpha != 0.0 {
            let mut before = plus(&problem.load_at(time(state.steps)), -1.0, &state.elastic);
            problem.damp(1.0, &state.velocity, &mut before);
            force.iter_mut().zip(before).for_each(|(f, before)| *f = (1.0 + alpha) * *f - alpha * before);
        }
        let gap = problem.remaining_gap(&displacement);
        Predicted { displacement, velocity, force, gap }
    }

    /// The end of the step from `state` with the given change.
    pub fn arrive(
        &self,
        problem: &DynamicProblem,
        step: f64,
        state: &State,
        predicted: &Predicted,
        found: Moved,
    ) -> State {
        let Newmark { beta, gamma, .. } = *self;
        let displacement = plus(&predicted.displacement, 1.0, &found.change);
        let velocity = plus(&predicted.velocity, gamma / (beta * step), &found.change);
        let acceleration = found.change.iter().map(|w| w / (beta * step * step)).collect();
        let contact = (found.multiplier, found.contact_set);
        State { acceleration, ..next(problem, state, [displacement, velocity], contact) }
    }
}

impl Advance for Newmark {
    /// The initial acceleration; contact rows that would be violated within the step act against it.
    fn start(&self, problem: &DynamicProblem, step: f64, state: State) -> Result<State, Error> {
        let mut force = plus(&problem.load_at(0.0), -1.0, &state.elastic);
        problem.damp(1.0, &state.velocity, &mut force);
        let coasting = plus(&state.displacement, step, &state.velocity);
        let room = problem.remaining_gap(&coasting);
        let bound = room.into_iter().map(|gap| 2.0 * gap.max(0.0) / (step * step)).collect();
        let acceleration = self.mass.solve(force, bound, &state.contact_set)?.change;
        Ok(State { acceleration, ..state })
    }

    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let predicted = self.predict(problem, step, state);
        let found = self.stepping.solve(predicted.force.clone(), predicted.gap.clone(), &state.contact_set)?;
        Ok(self.arrive(problem, step, state, &predicted, found))
    }

    /// The balance at the end of the step, or with alpha < 0 earlier by the share `-alpha`; the acceleration is that of
    /// the end.
    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        let acceleration = at.iter().map(|&dof| after.acceleration[dof]).collect();
        Balance { acceleration, ..Balance::between(step, before, after, 1.0 + self.alpha, at) }
    }
}

// HHT-alpha: Newmark's rule with beta = (1 - alpha)^2/4 and gamma = 1/2 - alpha, which damps short waves.

pub(super) static HHT: Facts = Facts {
    name: "hht",
    parameter: Some(Parameter {
        name: "alpha",
        default: -0.1,
        allows: |alpha| (-1.0 / 3.0..=0.0).contains(&alpha),
        range: "from -1/3 to 0",
    }),
    prepare: |problem, step, alpha, settings| Ok(Box::new(Newmark::new(problem, step, alpha, settings, settings)?)),
    ..TRAPEZOIDAL
};

/// The other rules name only what differs.
pub(super) const TRAPEZOIDAL: Facts = Facts {
    name: "trapezoidal",
    parameter: None,
    masses: &[MassForm::Consistent, MassForm::Lumped],
    gains_energy: true,
    penetrates: false,
    is_explicit: false,
    uses_frequency: false,
    follows_obstacles: false,
    is_exact_in_bars: false,
    load_times: &[0.0, 1.0],
    unstable_in_contact: &[],
    prepare: |problem, step, _, settings| Ok(Box::new(Newmark::new(problem, step, 0.0, settings, settings)?)),
};

// Newmark's rule, contact-stabilised: the prediction is made admissible first, and contact forces are implicit.
//
// ```text
// u^ = argmin norm_M(u^ - u - dt v) with B u^ <= g,   u+ = u^ + w,   v+ = v + 2 w/dt
// (2/dt^2) M w + C (v + w/dt) + K (u + u+)/2 = f(t + dt/2) + B' lambda,   B u+ <= g
// ```
//
// # Source
// P. Deuflhard, R. Krause, S. Ertel, *A contact-stabilized Newmark method for dynamical contact problems*, Int. J.
// Numer. Methods Eng. 73 (2008) 1274-1290.

pub(super) static CONTACT_STABILISED: Facts = Facts {
    name: "contact-stabilised",
    gains_energy: false,
    load_times: &[0.5],
    prepare: |problem, step, _, settings| {
        // The equation above, multiplied by two.
        let matrix = problem.combination(4.0 / (step * step), 2.0 / step, 1.0)?;
        let stepping = Stepping::of(problem, matrix, settings)?;
        Ok(Box::new(ContactStabilised { stepping, mass: Stepping::of(problem, problem.mass().clone(), settings)? }))
    },
    ..TRAPEZOIDAL
};

#[derive(Debug)]
struct ContactStabilised {
    stepping: Stepping,
    mass: Stepping,
}

impl Advance for ContactStabilised {
    fn start(&self, _: &DynamicProblem, _: f64, state: State) -> Result<State, Error> {
        Ok(state)
    }

    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let mut predicted = plus(&state.displacement, step, &state.velocity);
        let bound = problem.remaining_gap(&predicted);
        if let Some(correction) = self.mass.smallest(bound, &state.contact_set)? {
            predicted = plus(&predicted, 1.0, &correction.change);
        }
        let elastic = plus(&state.elastic, 1.0, &problem.statics().stiffness().mul(&predicted));
        let load = problem.load_at((state.steps as f64 + 0.5) * step);
        let mut force: Vec<f64> = load.iter().zip(&elastic).map(|(f, k)| 2.0 * f - k).collect();
        problem.damp(2.0, &state.velocity, &mut force);
        let gap = problem.remaining_gap(&predicted);
        let found = self.stepping.solve(force, gap, &state.contact_set)?;
        let displacement = plus(&predicted, 1.0, &found.change);
        let velocity = plus(&state.velocity, 2.0 / step, &found.change);
        let multiplier = found.multiplier.iter().map(|lambda| lambda / 2.0).collect();
        Ok(next(problem, state, [displacement, velocity], (multiplier, found.contact_set)))
    }

    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        Balance::of_middle(step, before, after, at)
    }
}

// The trapezoidal rule with the classical penalty loop in every step: springs ten times stiffer, until nothing
// penetrates.
//
// ```text
// for eps = 1, 10, 100, ... times the local stiffness of a step:
//     repeat: (K_eff + eps C) u = f_eff + eps C g,  C <- heaviside(u - g)     until C repeats
//     stop when norm[C (u - g)] < threshold times the largest displacement of the body
// ```
//
// The contact set of a penalty starts from that of the penalty before, the first from that of the last step.

/// Number of penalties, each ten times the one before, from the local stiffness on. At the last one, 1e8, the rounding
/// of double precision and the remaining penetration are equally large; larger penalties would only add noise.
const PENALTIES: i32 = 9;

pub(super) static PENALTY_LOOP: Facts = Facts {
    name: "penalty-loop",
    parameter: Some(Parameter {
        name: "threshold",
        default: 1e-6,
        allows: |threshold| threshold > 0.0 && threshold <= 0.1,
        range: "positive and at most 0.1",
    }),
    penetrates: true,
    prepare: |problem, step, threshold, settings| {
        let newmark = Newmark::new(problem, step, 0.0, &springs(settings, 1.0), settings)?;
        let stiffer = (1..PENALTIES).map(|power| newmark.stepping.under(&springs(settings, 10.0_f64.powi(power))));
        let stiffer = stiffer.collect::<Result<Vec<_>, Error>>()?;
        Ok(Box::new(PenaltyLoop { threshold, newmark, stiffer }))
    },
    ..TRAPEZOIDAL
};

#[derive(Debug)]
struct PenaltyLoop {
    threshold: f64,
    /// The rule with the first penalty.
    newmark: Newmark,
    /// The larger penalties, with the same factor.
    stiffer: Vec<Stepping>,
}

impl Advance for PenaltyLoop {
    fn start(&self, problem: &DynamicProblem, step: f64, state: State) -> Result<State, Error> {
        self.newmark.start(problem, step, state)
    }

    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let predicted = self.newmark.predict(problem, step, state);
        let mut closed = state.contact_set.clone();
        let mut left = f64::INFINITY;
        for (index, penalty) in std::iter::once(&self.newmark.stepping).chain(&self.stiffer).enumerate() {
            let found = penalty.solve(predicted.force.clone(), predicted.gap.clone(), &closed)?;
            closed = found.contact_set.clone();
            let next = self.newmark.arrive(problem, step, state, &predicted, found);
            let scale = largest(&next.displacement).max(largest(&predicted.displacement));
            let inside = problem.remaining_gap(&next.displacement).into_iter().filter(|&gap| gap < 0.0);
            let norm = inside.map(|gap| gap * gap).sum::<f64>().sqrt();
            if norm <= self.threshold * scale {
                return Ok(State { penalties: index + 1, ..next });
            }
            left = norm / scale;
        }
        let reason = format!(
            "in step {} the last of {PENALTIES} penalties leaves a penetration of {left:.1e} of the largest \
             displacement, above the threshold {:e}; take a larger threshold",
            state.steps + 1,
            self.threshold
        );
        Err(qp::LinearError::Numerical { step: "penalty loop", reason }.into())
    }

    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        self.newmark.balance(step, before, after, at)
    }
}

// The trapezoidal rule with springs of `penalty` times the local stiffness instead of closed rows.

pub(super) static PENALTY: Facts = Facts {
    name: "penalty",
    parameter: Some(Parameter {
        name: "penalty",
        default: 10.0,
        allows: |penalty| penalty.is_finite() && penalty > 0.0,
        range: "positive and finite",
    }),
    penetrates: true,
    prepare: |problem, step, penalty, settings| {
        Ok(Box::new(Newmark::new(problem, step, 0.0, &springs(settings, penalty), settings)?))
    },
    ..TRAPEZOIDAL
};

/// The settings with springs of one penalty, in multiples of the local stiffness, instead of closed rows.
pub(super) fn springs(settings: &Settings, penalty: f64) -> Settings {
    let one = Penalty { first: penalty, last: penalty, penetration_threshold: 0.0 };
    // Springs yield, so that no certificate of rigid contact is possible.
    settings.clone().by(Method::Penalty(one)).without_tolerance()
}
