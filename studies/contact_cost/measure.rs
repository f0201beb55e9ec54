//! The measured tasks.

use serde_json::{Value, json};
use signorini::{Condense, ContactSet, Error, Method, Model, Prepared, Settings, qp};
use std::hint::black_box;

use super::case::{Case, FIRST_GAP};
use crate::clock::timed;
use crate::linear::{self, Ordering};
use support::clock::processor_seconds;

/// Number of gaps after the first one; each is a tenth of the first gap further.
const NEXT_GAPS: usize = 9;

/// A task whose time is measured.
#[derive(Clone, Copy, PartialEq)]
pub struct Task {
    pub name: &'static str,
    work: Work,
    /// Largest numbers of dofs, in the plane and in space, for which the task is run; methods on all dofs take long.
    most_dofs: [usize; 2],
}

#[derive(Clone, Copy, PartialEq)]
enum Work {
    Assembly,
    Linear(Ordering),
    /// A contact solve, from the checked problem to the certified answer.
    Contact(Method, Condense),
    /// As `Contact`, but only the condensed problem is certified.
    Uncertified,
    /// As `Contact` with this number of threads, in wall-clock time.
    Threads(usize),
    /// Contact set and forces for the next gap, as the mean of nine gaps.
    NextForces,
    /// Certified displacement of the whole body for the next gap, as the mean of nine gaps.
    NextDisplacement,
    /// A sweep over ten gaps with the contact forces at each gap, including the preparation and all events.
    Sweep,
}

const ALL: [usize; 2] = [usize::MAX; 2];

const fn task(name: &'static str, work: Work, most_dofs: [usize; 2]) -> Task {
    Task { name, work, most_dofs }
}

const fn contact(name: &'static str, method: Method) -> Task {
    task(name, Work::Contact(method, Condense::Auto), ALL)
}

const fn full(name: &'static str, method: Method, most_dofs: [usize; 2]) -> Task {
    task(name, Work::Contact(method, Condense::Never), most_dofs)
}

pub const TASKS: [Task; 15] = [
    task("assembly", Work::Assembly, ALL),
    task("linear solve", Work::Linear(Ordering::Amd), ALL),
    task("linear solve, dissected", Work::Linear(Ordering::NestedDissection(3)), [0, usize::MAX]),
    contact("active set", Method::ActiveSet),
    contact("QP", Method::qp()),
    contact("penalty", Method::penalty()),
    task("active set, uncertified", Work::Uncertified, ALL),
    task("active set, wall clock", Work::Threads(1), ALL),
    task("active set, two threads", Work::Threads(2), ALL),
    task("next gap, forces", Work::NextForces, ALL),
    task("next gap, displacement", Work::NextDisplacement, ALL),
    task("sweep of ten gaps", Work::Sweep, ALL),
    full("active set, full", Method::ActiveSet, [40_000, 10_000]),
    full("QP, full", Method::qp(), [140_000, 10_000]),
    full("penalty, full", Method::penalty(), [40_000, 10_000]),
];

impl Task {
    pub fn runs(&self, case: &Case) -> bool {
        case.dofs() <= self.most_dofs[usize::from(case.space)]
    }

    /// Returns `true` if the task is done once instead of in every round.
    pub fn is_slow(&self) -> bool {
        matches!(self.work, Work::Contact(_, Condense::Never))
    }

    /// Does the task, and returns the seconds that it took.
    pub fn seconds(&self, case: &Case, bench: &Bench) -> Result<f64, Error> {
        let problem = bench.model.problem();
        let start = processor_seconds();
        match self.work {
            Work::Assembly => drop(black_box(case.model()?)),
            Work::Linear(ordering) => drop(black_box(linear::solve(problem.stiffness(), problem.load(), ordering))),
            Work::Contact(method, condense) => {
                let mut settings = Settings::with_method(method);
                settings.condense = condense;
                match signorini::solve(problem, &settings) {
                    Ok(solution) => drop(black_box(solution)),
                    // The penalty method ends at its best accuracy, which may be below the tolerance of a certificate.
                    Err(qp::Error::NotCertified { solution, .. }) => drop(black_box(solution)),
                    Err(error) => return Err(error.into()),
                }
            }
            Work::Uncertified => {
                let prepared = bench.prepared()?;
                let boundary = prepared.boundary(problem.gap())?;
                black_box(boundary.displacement());
            }
            Work::Threads(threads) => {
                let mut settings = active_set();
                settings.threads = Some(threads);
                let (solution, seconds) = timed(|| signorini::solve(problem, &settings));
                black_box(solution?);
                return Ok(seconds);
            }
            Work::NextForces => {
                return bench.walk(|prepared, gap| Ok(prepared.boundary(gap)?.contact_set));
            }
            Work::NextDisplacement => {
                return bench.walk(|prepared, gap| Ok(prepared.solve(gap)?.contact_set));
            }
            Work::Sweep => {
                let prepared = bench.prepared()?;
                let path = prepared.path(problem.gap(), bench.last_gap())?;
                for step in 0..=NEXT_GAPS {
                    black_box(path.multiplier(step as f64 / NEXT_GAPS as f64));
                }
            }
        }
        Ok(processor_seconds() - start)
    }
}

fn active_set() -> Settings {
    Settings::with_method(Method::ActiveSet)
}

/// A model, and the gaps that follow its own gap.
pub struct Bench {
    model: Model,
    gaps: Vec<Vec<f64>>,
}

impl Bench {
    pub fn of(case: &Case) -> Result<Self, Error> {
        let model = case.model()?;
        let deeper = |step: usize| FIRST_GAP * step as f64 / 10.0;
        let gaps = (1..=NEXT_GAPS).map(|step| model.problem().gap().iter().map(|gap| gap + deeper(step)).collect());
        Ok(Bench { gaps: gaps.collect(), model })
    }

    fn prepared(&self) -> Result<Prepared, Error> {
        Ok(Prepared::new(self.model.problem(), &active_set())?)
    }

    /// Returns the mean seconds of `step` over the next gaps; each step starts from the contact set of the previous
    /// gap.
    fn walk(&self, step: impl Fn(&Prepared, &[f64]) -> Result<ContactSet, Error>) -> Result<f64, Error> {
        let prepared = self.prepared()?;
        let mut closed = prepared.solve(self.model.problem().gap())?.contact_set;
        let start = processor_seconds();
        for gap in &self.gaps {
            closed = step(&prepared.starting_from(closed), gap)?;
        }
        Ok((processor_seconds() - start) / NEXT_GAPS as f64)
    }

    fn last_gap(&self) -> &[f64] {
        self.gaps.last().map_or(self.model.problem().gap(), Vec::as_slice)
    }

    /// Returns the sizes of the problem, and the bytes of the values in the factors of both solves.
    pub fn sizes(&self) -> Result<Value, Error> {
        let (problem, prepared) = (self.model.problem(), self.prepared()?);
        let linear = linear::solve(problem.stiffness(), problem.load(), Ordering::Amd);
        Ok(json!({
            "dofs": problem.dofs(), "rows": problem.rows(), "condensed_dofs": prepared.condensed_dofs(),
            "linear_factor_bytes": linear.map(|(_, values)| 8.0 * values as f64),
            "factor_bytes": 8.0 * prepared.factor_entries() as f64,
        }))
    }
}
