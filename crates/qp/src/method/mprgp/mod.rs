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

use super::bounds::Bounds;
use super::{Ending, Outcome, Start};
use crate::error::Result;
use crate::linear::SparseMatrix;
use crate::linear::multigrid::{Face, Interval, Multigrid};
use crate::linear::watch::Watch;
use crate::problem::ContactProblem;
pub use exchange::takes_travels;
use exchange::{Exchange, in_face, order, preconditioned};
use iterate::{BoundedIterate, Move};

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

/// Tolerance of the problem of the second level, which is only approximate because its bounds are means.
const NESTED_TOLERANCE: f64 = 1e-3;

/// Largest number of cycles on the second level.
const MOST_NESTED_CYCLES: usize = 40;

/// The accuracy and the costs at which a loop ends.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Largest imbalance of forces and largest wrong-signed multiplier, relative to the largest force.
    pub tolerance: f64,
    pub most_cycles: usize,
    /// Cycles that another way is worth: the loop ends if clearly more are left, or after these unless few are left.
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
    pub problem: &'a ContactProblem,
    pub multigrid: &'a Multigrid,
    pub limits: Limits,
    /// The watch that may end the loop before, with the answer so far.
    pub watch: &'a Watch,
}

impl Mprgp<'_> {
    /// Finds displacement, multipliers and contact set; `iterations` counts the cycles of the hierarchy.
    ///
    /// The loop is finite. It ends at the limits, or if only rounding is left, or, as `-stagnated`, if 60 iterations
    /// together do not halve the residual; those that change the face count only beyond one for each row.
    pub fn solve(&self, start: Start) -> Result<Outcome> {
        let Mprgp { problem, multigrid, limits, .. } = *self;
        let (rows, units, mut start) = ((problem.contact(), problem.gap()), multigrid.units(), start);
        let mut before: Option<Outcome> = None;
        let mut exchanges = Vec::new();
        loop {
            let (order, needed) = order(problem, &start, exchanges.last());
            let bounds = Bounds::of(rows, (&order, needed), &units, problem.without_stiffness())?;
            let used = before.as_ref().map_or(0, |before| before.iterations);
            let limits = Limits { most_cycles: limits.most_cycles.saturating_sub(used), ..limits };
            let next = Mprgp { limits, ..*self }.within(&bounds, start)?;
            let next = if let Some(before) = before { next.after(before) } else { next };
            let exchange = next.is_settled().then(|| Exchange::of(problem, &bounds, &next, limits.tolerance)).flatten();
            let Some(exchange) = exchange else { return Ok(next) };
            if let Some(ending) = exchange.contradiction {
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

    fn within(&self, bounds: &Bounds, start: Start) -> Result<Outcome> {
        let (limits, watch, rows) = (self.limits, self.watch, self.problem.rows());
        let (iterate, best) = (self.started(bounds, start), f64::INFINITY);
        let mut steps = Steps {
            multigrid: self.multigrid,
            watch,
            iterate,
            face: None,
            travels: Vec::new(),
            is_old: false,
            last: None,
            cycles: 0,
            of_faces: 0,
            on_face: (0, best),
            best,
            since_best: 0,
            changes: 0,
            is_fresh: true,
            last_checked: best,
        };
        let mut history = vec![steps.iterate.step()];
        let mut ending = Ending::Unsettled;
        while steps.cycles < limits.most_cycles
            && steps.since_best < PATIENCE + steps.changes.min(rows)
            && !watch.is_over()
        {
            let residual = steps.iterate.residual();
            if residual <= limits.tolerance {
                if steps.is_fresh || steps.has_settled() {
                    ending = Ending::Settled;
                    break;
                }
                steps.last = None;
                continue;
            }
            steps.note(residual);
            if steps.is_hopeless(limits) {
                break;
            }
            let before = steps.iterate.at.clone();
            if !steps.take_one()? {
                ending = Ending::Unheld;
                break;
            }
            if steps.iterate.at != before {
                (steps.is_old, steps.last) = (true, None);
                steps.changes += 1;
                steps.on_face = (steps.cycles, residual);
                history.push(steps.iterate.step());
            }
        }
        let variant = match ending {
            Ending::Settled => "",
            _ if steps.cycles >= limits.most_cycles || watch.is_over() || steps.is_hopeless(limits) => "-unsettled",
            _ => STAGNATED,
        };
        let Steps { iterate, cycles: iterations, .. } = steps;
        let (multiplier, contact_set) = bounds.multipliers(|index| iterate.held_gradient(index));
        let mut displacement = iterate.x;
        bounds.turn_back(&mut displacement);
        Ok(Outcome { displacement, multiplier, contact_set, iterations, history, ending, variant })
    }

    /// The iterate at the start: of a given displacement far from the answer and none the better one.
    fn started<'b>(&'b self, bounds: &'b Bounds, start: Start) -> BoundedIterate<'b> {
        let at = |start: Start| BoundedIterate::new(self.problem, bounds, start, self.multigrid);
        let from_nothing = || at(self.nested(bounds).map(Start::near).unwrap_or_default());
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

    /// A start from the second level of the hierarchy: the same problem is solved there, with means as bounds. `None`
    /// if there is no second level with nodal values, if `bounds` are not those of unknowns without reflections, or if
    /// no answer is found there.
    ///
    /// From zero, the first step that the bounds cut off leaves jumps with an energy that grows as the mesh is refined:
    /// a fine mesh is then closed layer by layer. From the answer of the second level a few steps remain, on any mesh.
    ///
    /// # Source
    /// R. Kornhuber, *Monotone multigrid methods for elliptic variational inequalities I*, Numer. Math. 69 (1994)
    /// 167-184, section 5: nested iteration.
    fn nested(&self, bounds: &Bounds) -> Option<Vec<f64>> {
        if !bounds.is_plain || bounds.bounds.is_empty() {
            return None;
        }
        let coarser = self.multigrid.coarser()?;
        let mut intervals = vec![[f64::NEG_INFINITY, f64::INFINITY]; self.problem.dofs()];
        bounds.bounds.iter().for_each(|bound| intervals[bound.unknown] = [bound.lower, bound.upper]);
        let coarse = coarser.bounds(&intervals);
        let (contact, gap) = rows_of(&coarse)?;
        let mut load = self.problem.load().to_vec();
        bounds.turn_forces(&mut load);
        let problem = &ContactProblem::computed(coarser.matrix.clone(), coarser.load(&load), contact, gap).ok()?;
        let limits = Limits { most_cycles: MOST_NESTED_CYCLES, ..Limits::to(NESTED_TOLERANCE) };
        let below = Mprgp { problem, multigrid: &coarser.multigrid, limits, watch: self.watch };
        let found = below.solve(Start::default()).ok()?;
        let mut displacement = coarser.interpolated(&found.displacement, &coarse, &intervals);
        bounds.turn_back(&mut displacement);
        Some(displacement)
    }
}

/// Rows and gaps of bounds, one row for each side.
fn rows_of(intervals: &[Interval]) -> Option<(SparseMatrix, Vec<f64>)> {
    let sides = |(unknown, &[lower, upper]): (usize, &Interval)| [(unknown, -1.0, -lower), (unknown, 1.0, upper)];
    let rows: Vec<(usize, f64, f64)> =
        intervals.iter().enumerate().flat_map(sides).filter(|side| side.2.is_finite()).collect();
    let entries: Vec<(usize, usize, f64)> =
        rows.iter().enumerate().map(|(row, &(unknown, sign, _))| (row, unknown, sign)).collect();
    let contact = SparseMatrix::from_triplets(rows.len(), intervals.len(), &entries).ok()?;
    Some((contact, rows.into_iter().map(|(_, _, gap)| gap).collect()))
}

/// The loop on some bounds: its iterate, its progress, and the data that a step keeps for the next.
struct Steps<'a> {
    multigrid: &'a Multigrid,
    watch: &'a Watch,
    iterate: BoundedIterate<'a>,
    face: Option<Face<'a>>,
    travels: Vec<Move>,
    /// `true` if the set of unknowns at bounds has changed since the face was built.
    is_old: bool,
    last: Option<Move>,
    cycles: usize,
    /// Cycles that take about the seconds of the coarsest factors of all faces.
    of_faces: usize,
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

impl Steps<'_> {
    /// Notes a residual above the tolerance.
    fn note(&mut self, residual: f64) {
        self.is_fresh = false;
        self.since_best += 1;
        if residual < 0.5 * self.best {
            (self.best, self.since_best, self.changes) = (residual, 0, 0);
        }
    }

    /// Returns `true` if the other way, which is worth `limits.worth` cycles, is the shorter one from here.
    fn is_hopeless(&self, limits: Limits) -> bool {
        let ((least, unsure), (before, first)) = (TRIAL, self.on_face);
        let gained = (first / self.best).ln();
        let needed = (self.best / limits.tolerance).ln();
        let taken = self.cycles - before;
        let left = taken as f64 * needed / gained.max(0.0);
        let worth = limits.worth as f64;
        let is_told = taken >= least.max(limits.worth / SHARE);
        let is_near = left <= worth / SHARE as f64;
        (is_told && left > unsure * worth) || (self.cycles + self.of_faces >= limits.worth && !is_near)
    }

    /// Recomputes the gradient, which steps only update. Returns `true` if only rounding of the displacement is left.
    fn has_settled(&mut self) -> bool {
        self.iterate.refresh_gradient_accurately();
        let checked = self.iterate.residual();
        if checked > NO_GAIN * self.last_checked {
            return true;
        }
        (self.is_fresh, self.last_checked) = (true, checked);
        false
    }

    /// Takes one of the steps. Returns `false` at a direction along which nothing is held, or the energy is negative.
    fn take_one(&mut self) -> Result<bool> {
        let iterate = &mut self.iterate;
        if iterate.is_disproportionate() {
            iterate.proportion();
            return Ok(true);
        }
        let face = match self.face.take() {
            Some(face) if !self.is_old => face,
            old => {
                let face = self.multigrid.face(&iterate.held(), old.as_ref())?;
                self.travels = in_face(std::mem::take(&mut self.travels), iterate, &face);
                self.cycles += iterate.bounds.travels.len();
                self.of_faces += self.multigrid.cycles_of_face();
                face
            }
        };
        self.is_old = false;
        let last = self.last.take();
        let (direction, slope) = iterate.of_free_gradient(|gradient| {
            let step = preconditioned(&self.travels, iterate, &face, gradient);
            self.cycles += 1;
            self.watch.step("MPRGP", self.cycles);
            iterate.conjugate(step, last, gradient)
        });
        self.face = Some(face);
        let is_free = direction.energy == 0.0 && iterate.longest_step(&direction.way).is_infinite();
        if is_free || direction.energy < 0.0 {
            return Ok(false);
        }
        self.last = iterate.advance(direction, slope);
        Ok(true)
    }
}
