//! MPRGP: modified proportioning with reduced gradient projections, preconditioned in the free face.
//!
//! Rows are turned into bounds by reflections and shears. The gradient g = K u - f is split into the free gradient, of
//! unknowns that may move, and the chopped gradient, of those that want to leave their bound. An iteration is one of
//!
//! ```text
//! proportioning   if the chopped gradient is larger than the free one: a step along it, which opens rows
//! CG step         along conjugate directions of the free face, one cycle of the hierarchy each
//! expansion       if the CG step would cross bounds: its projection, which closes rows; if that raises the energy,
//!                 the least energy on the way there or the step to the first bound, and a projected gradient step of
//!                 fixed length
//! ```
//!
//! Each of these steps lowers the energy. The hierarchy is built once, for K; a face is a small change of the
//! hierarchy. Rows that depend on others, such as those of far obstacles at a node, are left out; those that the answer
//! violates are exchanged for others, and the loop goes on from there.
//!
//! # Source
//! Z. Dostál, *Optimal Quadratic Programming Algorithms*, Springer (2009), algorithm 5.8 and section 5.10.

mod exchange;
mod iterate;
mod nested;
mod travel;

use super::bounds::Bounds;
use super::{Ending, Outcome, Solver, Start};
use crate::error::Error;
use crate::linear::multigrid::{Face, Multigrid};
use crate::linear::watch::Watch;
use crate::problem::ContactProblem;
use exchange::{Exchange, order};
use iterate::{BoundedIterate, Conjugate};
use nested::nested_start;
use travel::Travels;
pub use travel::takes_travels;

/// The loop has stagnated after this many iterations without a residual half as large as the best before; those that
/// change the face count only beyond one for each row.
const PATIENCE: usize = 60;

/// Cycles on one face after which their rate gives an estimate of all cycles, and the factor by which it may be wrong.
const TRIAL: (usize, f64) = (16, 1.2);

/// At least the worth divided by this number is spent first: conjugate gradients begin slowly on a stretched mesh, and
/// little is lost by waiting for the other way. If no more cycles than that are left to go, the answer is near.
const SHARE: usize = 8;

/// The variant of a loop that came no further.
const STAGNATED: &str = "-stagnated";

/// Exchanges of rows that are left out, at most.
const MOST_EXCHANGES: usize = 30;

/// A displacement with a residual up to this is near the answer: nothing else is tried as a start.
const NEAR: f64 = 1e-3;

/// If the residual in twice the precision is above this share of the previous one, it will not decrease any more.
const NO_GAIN: f64 = 0.5;

/// The accuracy and the costs at which a loop ends.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Largest imbalance of forces and largest wrong-signed multiplier, relative to the largest force.
    pub tolerance: f64,
    pub most_cycles: usize,
    /// Cycles that the answer by another way is worth: the loop ends if its rate shows that clearly more are left, or
    /// after this number unless few are left.
    pub worth: usize,
    /// Estimated seconds that the sets of a loop with a factor may take, because another way takes less.
    pub most_seconds: f64,
}

impl Limits {
    /// This accuracy at any cost.
    pub fn to(tolerance: f64) -> Self {
        Limits { tolerance, most_cycles: usize::MAX, worth: usize::MAX, most_seconds: f64::INFINITY }
    }

    /// The sets of a loop with a factor whose cost they allow, one at least, if a set takes this number of seconds.
    pub fn most_sets(&self, set_seconds: f64) -> usize {
        (self.most_seconds / set_seconds.max(f64::MIN_POSITIVE)).max(1.0) as usize
    }
}

/// MPRGP on an unscaled problem, with the hierarchy of its stiffness.
#[derive(Clone, Copy)]
pub struct Mprgp<'a> {
    /// The problem in its own units.
    pub problem: &'a ContactProblem,
    pub multigrid: &'a Multigrid,
    /// The accuracy and the cycles of this solve.
    pub limits: Limits,
    /// The watch that may end the loop before, with the answer so far.
    pub watch: &'a Watch,
}

impl Solver for Mprgp<'_> {
    /// Finds displacement, multipliers and contact set; `iterations` counts the cycles of the hierarchy.
    ///
    /// The loop is finite. It ends at the limits, or if only rounding is left, or, as `-stagnated`, if 60 iterations
    /// together do not halve the residual; those that change the face count only beyond one for each row.
    fn solve(&self, start: Start) -> Result<Outcome, Error> {
        let Mprgp { problem, multigrid, limits, .. } = *self;
        let (rows, units, mut start) = ((problem.contact(), problem.gap()), multigrid.units(), start);
        let mut before: Option<Outcome> = None;
        let mut exchanges = Vec::new();
        loop {
            let order = order(problem, &start, exchanges.last());
            let bounds = Bounds::of(rows, &order, &units, problem.without_stiffness())?;
            let used = before.as_ref().map_or(0, |before| before.iterations);
            let limits = Limits { most_cycles: limits.most_cycles.saturating_sub(used), ..limits };
            let next = Mprgp { limits, ..*self }.within(&bounds, start)?;
            let next = if let Some(before) = before { next.after(before) } else { next };
            let exchange = next.is_settled().then(|| Exchange::of(problem, &bounds, &next, limits.tolerance)).flatten();
            let Some(exchange) = exchange else { return Ok(next) };
            if let Some(ending) = exchange.ending() {
                return Ok(Outcome { ending, ..next });
            }
            if exchanges.len() == MOST_EXCHANGES {
                return Ok(Outcome { ending: Ending::Unsettled, variant: STAGNATED, ..next });
            }
            start = exchange.start(&next);
            exchanges.push(exchange);
            before = Some(next);
        }
    }
}

impl Mprgp<'_> {
    fn within(&self, bounds: &Bounds, start: Start) -> Result<Outcome, Error> {
        let Mprgp { problem, multigrid, limits, watch } = *self;
        let mut iterate = started(self, bounds, start);
        let mut history = vec![iterate.step()];
        let (travels, of_faces) = (Travels::default(), 0);
        let mut steps = Steps { multigrid, watch, face: None, travels, is_old: false, last: None, cycles: 0, of_faces };
        let mut progress = Progress::default();
        let mut ending = Ending::Unsettled;
        while steps.cycles < limits.most_cycles
            && progress.since_best < progress.patience(problem.rows())
            && !watch.is_over()
        {
            let residual = iterate.residual();
            if residual <= limits.tolerance {
                if progress.is_fresh || progress.has_settled(&mut iterate) {
                    ending = Ending::Settled;
                    break;
                }
                steps.last = None;
                continue;
            }
            progress.note(residual);
            if progress.is_hopeless(&steps, limits) {
                break;
            }
            let before = iterate.at.clone();
            if !steps.take_one(&mut iterate)? {
                ending = Ending::Unheld;
                break;
            }
            if iterate.at != before {
                (steps.is_old, steps.last) = (true, None);
                progress.changes += 1;
                progress.on_face = (steps.cycles, residual);
                history.push(iterate.step());
            }
        }
        let (multiplier, contact_set) = bounds.multipliers(|index| iterate.held_gradient(index));
        let mut displacement = iterate.x;
        bounds.turn_back(&mut displacement);
        let variant = match ending {
            Ending::Settled => "",
            _ if steps.cycles >= limits.most_cycles || watch.is_over() || progress.is_hopeless(&steps, limits) => {
                "-unsettled"
            }
            _ => STAGNATED,
        };
        Ok(Outcome { displacement, multiplier, contact_set, iterations: steps.cycles, history, ending, variant })
    }
}

/// The iterate at the start; if a displacement is given that is not near the answer, the better one of that and none.
fn started<'a>(mprgp: &Mprgp<'a>, bounds: &'a Bounds, start: Start) -> BoundedIterate<'a> {
    let at = |start: Start| BoundedIterate::new(mprgp.problem, bounds, start, mprgp.multigrid);
    let from_nothing = || at(nested(mprgp, bounds).unwrap_or_default());
    if start.is_unknown() {
        return from_nothing();
    }
    let is_displacement = start.displacement.is_some();
    let given = at(start);
    let residual = given.residual();
    if !is_displacement || residual <= NEAR {
        return given;
    }
    let other = from_nothing();
    if other.residual() < residual { other } else { given }
}

/// The start from the second level, if there is one with nodal values.
fn nested(mprgp: &Mprgp, bounds: &Bounds) -> Option<Start> {
    let below = |problem: &ContactProblem, multigrid: &Multigrid, tolerance, most_cycles| {
        let limits = Limits { most_cycles, ..Limits::to(tolerance) };
        Mprgp { problem, multigrid, limits, watch: mprgp.watch }.solve(Start::default())
    };
    nested_start(mprgp.problem, bounds, mprgp.multigrid, below).map(Start::near)
}

struct Progress {
    /// Cycles before the last change of the face, and the residual then.
    on_face: (usize, f64),
    best: f64,
    since_best: usize,
    /// Changes of the face since the best residual.
    changes: usize,
    /// `true` if the gradient was just computed from the unknowns, in twice the precision.
    is_fresh: bool,
    last_checked: f64,
}

impl Default for Progress {
    fn default() -> Self {
        let best = f64::INFINITY;
        Progress { on_face: (0, best), best, since_best: 0, changes: 0, is_fresh: true, last_checked: f64::INFINITY }
    }
}

impl Progress {
    fn patience(&self, rows: usize) -> usize {
        PATIENCE + self.changes.min(rows)
    }

    /// Notes a residual above the tolerance.
    fn note(&mut self, residual: f64) {
        self.is_fresh = false;
        self.since_best += 1;
        if residual < 0.5 * self.best {
            (self.best, self.since_best, self.changes) = (residual, 0, 0);
        }
    }

    /// Returns `true` if the other way, which is worth `limits.worth` cycles, is the shorter one from here.
    fn is_hopeless(&self, steps: &Steps, limits: Limits) -> bool {
        let ((least, unsure), (before, first)) = (TRIAL, self.on_face);
        let gained = (first / self.best).ln();
        let needed = (self.best / limits.tolerance).ln();
        let taken = steps.cycles - before;
        let left = taken as f64 * needed / gained.max(0.0);
        let worth = limits.worth as f64;
        let is_told = taken >= least.max(limits.worth / SHARE);
        let is_near = left <= worth / SHARE as f64;
        (is_told && left > unsure * worth) || (steps.cycles + steps.of_faces >= limits.worth && !is_near)
    }

    /// Recomputes the gradient, which the steps have only updated. Returns `true` if only rounding of the displacement
    /// is left.
    fn has_settled(&mut self, iterate: &mut BoundedIterate) -> bool {
        iterate.refresh_gradient_accurately();
        let checked = iterate.residual();
        if checked > NO_GAIN * self.last_checked {
            return true;
        }
        (self.is_fresh, self.last_checked) = (true, checked);
        false
    }
}

/// The data that the steps keep from one to the next.
struct Steps<'a> {
    multigrid: &'a Multigrid,
    watch: &'a Watch,
    face: Option<Face<'a>>,
    travels: Travels,
    /// `true` if the set of unknowns at bounds has changed since the face was built.
    is_old: bool,
    last: Option<Conjugate>,
    cycles: usize,
    /// Cycles that take about the seconds of the coarsest factors of all faces.
    of_faces: usize,
}

impl Steps<'_> {
    /// Takes a proportioning, conjugate gradient or expansion step. Returns `false` at a direction along which nothing
    /// is held, or along which the energy is negative.
    fn take_one(&mut self, iterate: &mut BoundedIterate) -> Result<bool, Error> {
        if iterate.is_disproportionate() {
            iterate.proportion();
            return Ok(true);
        }
        let face = match self.face.take() {
            Some(face) if !self.is_old => face,
            old => {
                let face = self.multigrid.face(&iterate.held(), old.as_ref())?;
                self.travels = std::mem::take(&mut self.travels).in_face(iterate, &face);
                self.cycles += iterate.bounds.travels.len();
                self.of_faces += self.multigrid.cycles_of_face();
                face
            }
        };
        self.is_old = false;
        let last = self.last.take();
        let direction = iterate.of_free_gradient(|gradient| {
            let step = self.travels.preconditioned(iterate, &face, gradient);
            self.cycles += 1;
            self.watch.step("MPRGP", self.cycles);
            Conjugate::of(step, last, gradient, iterate)
        });
        self.face = Some(face);
        if direction.is_free || direction.energy < 0.0 {
            return Ok(false);
        }
        self.last = iterate.advance(direction);
        Ok(true)
    }
}
