//! The cost of accuracy: every method at several tolerances, timed, and compared with the exact discrete answer.

use std::sync::Arc;
use std::time::Instant;

use super::warnings::check_approach;
use serde::Serialize;
use signorini_mechanics::Error;
use signorini_mechanics::scene::{Answer, Scene};
use signorini_qp as qp;
use signorini_qp::{
    Condense, ContactProblem, InteriorPoint, Method, Penalty, Prepared, Settings, Solution, Watch, dot, solve,
};

/// Tolerances of the interior point.
const TOLERANCES: [f64; 6] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12];

/// Accuracies of the multigrid method; its setting is the error bound to reach.
const ACCURACIES: [f64; 5] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10];

/// The two fastest runs of a point differ by less than this share, or there are [`MOST_RUNS`] times as many runs as
/// requested.
const REPEATED: f64 = 0.03;

/// See [`REPEATED`].
const MOST_RUNS: usize = 4;

/// The seconds of a mesh grow with this power of its unknowns, for all methods together.
const PER_UNKNOWN: f64 = 1.5;

/// Last penalties of the penalty ladder, in multiples of the local stiffness; 1e8 is the best.
const PENALTIES: [f64; 9] = [1e0, 1e2, 1e4, 1e6, 1e7, 1e8, 1e10, 1e12, 1e14];

/// Tolerances for which the report names the cheapest method.
const WANTED: [f64; 3] = [1e-2, 1e-4, 1e-8];

/// Total errors and seconds for which the report names the best mesh and method.
const TOTAL_ERRORS: [f64; 3] = [0.1, 0.03, 0.01];
const BUDGETS: [f64; 3] = [0.1, 1.0, 10.0];

/// Reference method: the QP to this tolerance, on all dofs unless there are too many.
const USUAL_TOLERANCE: f64 = 1e-8;

/// Share of the reference method's time for which the report names the most accurate method.
const HURRY: f64 = 0.1;

/// Errors below this are rounding; they are not compared.
const ERROR_ROUNDING: f64 = 1e-12;

/// The QP whose contact set is settled by active-set steps.
const POLISHED: &str = "qp, polished";

/// The varied parameters of a trade-off and the effort of its timing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TradeoffGrid {
    /// Number of meshes besides the scene's own, each with half the cell size of the previous one.
    pub refinements: usize,
    /// Runs of each point, at least 1, and up to four times as many until the two fastest differ by less than 3 %; the
    /// fastest counts.
    pub runs: usize,
    /// Points of more dofs than this are solved on the contact boundary only.
    pub most_full_dofs: usize,
    /// No finer mesh is started if, by the time of the last one, it would end later than this many seconds after the
    /// start.
    pub seconds: f64,
}

impl Default for TradeoffGrid {
    fn default() -> Self {
        TradeoffGrid { refinements: 1, runs: 5, most_full_dofs: 10_000, seconds: f64::INFINITY }
    }
}

/// One mesh of a trade-off, by the divisions of the scene's own mesh, its sizes and its estimated error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TradeoffMesh {
    /// Number of parts into which each edge of the scene's mesh is divided.
    pub divided_by: usize,
    /// Number of unknown displacements on this mesh.
    pub dofs: usize,
    /// Number of candidate nodes with a row of B.
    pub contact_rows: usize,
    /// Estimated discretisation error, relative in energy; a problem directory has no mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<f64>,
}

/// One method with its settings: its time, and the errors against the exact answer of its mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TradeoffPoint {
    /// Index into [`Tradeoff::meshes`], from 0.
    pub mesh: usize,
    /// `qp`, `qp, polished`, `active-set`, `mprgp` or `penalty`.
    pub method: &'static str,
    /// Tolerance of the interior point, last penalty of the ladder over the local stiffness, or accuracy of the cycles;
    /// `None` if the method has no such setting.
    pub knob: Option<f64>,
    /// `true` if the problem was condensed onto its contact boundary.
    pub condensed: bool,
    /// The fastest run, in seconds, from the checked problem to the answer at the tolerance of the method.
    pub seconds: f64,
    /// Wall-clock time of recomputing the conditions and the bound, in seconds; not part of `seconds`.
    pub certificate_seconds: f64,
    /// Wall-clock time of proving the contact set, in seconds; not part of `seconds`.
    pub proof_seconds: f64,
    /// `true` if the two fastest runs are within 3 % of each other.
    pub is_repeated: bool,
    /// Energy norm of the error of the displacement over that of the displacement, defined as in the bound.
    pub energy_error: f64,
    /// Error against the exact answer of the scene, relative in energy: the algebraic error and the estimated
    /// discretisation error together, which are nearly orthogonal; `None` in a problem directory.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub total_error: Option<f64>,
    /// Error of the contact force, relative.
    pub force_error: f64,
    /// Error of the largest pressure, relative; `None` in a problem directory, which has no areas.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_error: Option<f64>,
    /// Misclassified rows: closed in one contact set and open in the other.
    pub rows_wrong: usize,
    /// Upper bound of `energy_error` that the certificate states; infinite if none is known.
    pub energy_error_bound: f64,
    /// `true` if the point is on the Pareto front of its mesh: no other point is both faster and more accurate.
    pub best: bool,
}

/// The recommended choice for a goal: the point that reaches an accuracy in the least time, or the best accuracy in a
/// time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Advice {
    /// The energy error to reach on the scene's own mesh.
    pub accuracy: Option<f64>,
    /// The total error to reach, on any of the meshes.
    pub total_error: Option<f64>,
    /// Seconds to spend: for the least energy error on the scene's own mesh, or for the least total error on any mesh.
    pub seconds: Option<f64>,
    /// `true` if a mesh is chosen too.
    pub chooses_mesh: bool,
    /// Index of the point to choose; `None` if no point is good enough.
    pub point: Option<usize>,
}

/// A scene solved by all methods on several meshes: the time and the errors of each, and the recommended choice.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tradeoff {
    /// The meshes, the scene's own first, then each finer one.
    pub meshes: Vec<TradeoffMesh>,
    /// One entry for each mesh and method with its settings, mesh by mesh.
    pub points: Vec<TradeoffPoint>,
    /// The recommended choices on the scene's own mesh, then on any of the meshes.
    pub advice: Vec<Advice>,
    /// Least number of runs for each point; the fastest run counts.
    pub runs: usize,
}

impl Tradeoff {
    /// Solves a scene by all methods on the meshes of `grid`.
    ///
    /// The exact answer of a mesh is that of the active set on the contact boundary, which ends with a linear solve.
    ///
    /// If `watch` is asked to stop, the result holds the points measured until then.
    ///
    /// # Errors
    /// As [`Scene::refined`], [`Scene::build`] and [`solve`]; an answer that is not certified counts as an answer here.
    /// [`qp::Error::Interrupted`] if no point was measured.
    pub fn of_scene(scene: &Scene, grid: &TradeoffGrid, watch: &Watch) -> Result<Self, Error> {
        let mut result = Tradeoff::new(grid);
        let clock = Instant::now();
        for refinement in 0..=grid.refinements {
            let began = clock.elapsed().as_secs_f64();
            let divided_by = 1_usize << refinement.min(usize::BITS as usize - 1);
            let model = Arc::new(scene.refined(divided_by)?.build()?);
            let peak = |solution: &Solution| -> Result<Option<f64>, Error> {
                Ok(Some(model.pressure(&solution.multiplier)?.into_iter().fold(0.0, f64::max)))
            };
            let measured = Measured { problem: model.problem(), peak: &peak, mesh: refinement, grid, watch };
            let exact = measured.all(&mut result.points).map_err(|error| model.explain(error))?;
            let Some(exact) = exact else { break };
            check_approach(&model, &exact.multiplier)?;
            let discretisation_error = Some(Answer::of(model.clone(), &exact)?.discretisation_error()?);
            result.meshes.push(TradeoffMesh { discretisation_error, ..TradeoffMesh::of(model.problem(), divided_by) });
            let now = clock.elapsed().as_secs_f64();
            let growth = 2_f64.powi(model.body().dimension() as i32).powf(PER_UNKNOWN);
            if watch.acknowledge() || now + growth * (now - began) > grid.seconds {
                break;
            }
        }
        result.advised()
    }

    /// Returns for each point, given by its two costs `[time, error]` in any unit, whether it is on the front: no other
    /// point is as small in both of its costs, and smaller in one. In the order of the points.
    pub fn on_front(costs: &[[f64; 2]]) -> Vec<bool> {
        let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
        costs.iter().map(|cost| !costs.iter().any(|other| beats(other, cost))).collect()
    }

    /// Solves a problem given as matrices by all methods: algebraic errors only.
    pub fn of_problem(problem: &ContactProblem, grid: &TradeoffGrid, watch: &Watch) -> Result<Self, Error> {
        let mut result = Tradeoff::new(grid);
        Measured { problem, peak: &|_| Ok(None), mesh: 0, grid, watch }.all(&mut result.points)?;
        result.meshes.push(TradeoffMesh::of(problem, 1));
        result.advised()
    }

    fn new(grid: &TradeoffGrid) -> Self {
        Tradeoff { meshes: Vec::new(), points: Vec::new(), advice: Vec::new(), runs: grid.runs.max(1) }
    }

    /// With the results that follow from all points together.
    fn advised(mut self) -> Result<Self, Error> {
        if self.points.is_empty() {
            return Err(qp::Error::Interrupted.into());
        }
        for point in &mut self.points {
            let of_mesh = self.meshes.get(point.mesh).and_then(|mesh| mesh.discretisation_error);
            point.total_error = of_mesh.map(|of_mesh| point.energy_error.hypot(of_mesh));
        }
        for of_mesh in self.points.chunk_by_mut(|a, b| a.mesh == b.mesh) {
            let costs = of_mesh.iter().map(|point| [point.seconds, point.error_above_rounding()]);
            let best = Tradeoff::on_front(&costs.collect::<Vec<_>>());
            of_mesh.iter_mut().zip(best).for_each(|(point, best)| point.best = best);
        }
        self.advice = advice(&self.points);
        if self.meshes.iter().any(|mesh| mesh.discretisation_error.is_some()) {
            self.advice.extend(advice_of_meshes(&self.points));
        }
        Ok(self)
    }
}

impl TradeoffMesh {
    fn of(problem: &ContactProblem, divided_by: usize) -> Self {
        let (dofs, contact_rows) = (problem.dofs(), problem.inequalities());
        TradeoffMesh { divided_by, dofs, contact_rows, discretisation_error: None }
    }
}

struct Measured<'a> {
    problem: &'a ContactProblem,
    /// The largest pressure of an answer, if there are areas.
    peak: &'a dyn Fn(&Solution) -> Result<Option<f64>, Error>,
    mesh: usize,
    grid: &'a TradeoffGrid,
    watch: &'a Watch,
}

impl Measured<'_> {
    /// Adds the points of all ways; returns the exact answer, or `None` if `watch` was asked to stop before.
    fn all(&self, points: &mut Vec<TradeoffPoint>) -> Result<Option<Solution>, Error> {
        let (grid, watch) = (self.grid, self.watch);
        let watched = |settings: Settings| settings.watched(watch);
        let exact = match solve(self.problem, &watched(Settings::with_method(Method::ActiveSet))) {
            Err(_) if watch.acknowledge() => return Ok(None),
            solved => solved?,
        };
        let mut ways = ways(Condense::Auto);
        if self.problem.dofs() <= grid.most_full_dofs {
            ways.extend(self::ways(Condense::Never));
        }
        // Multigrid, on all dofs.
        ways.extend(ACCURACIES.map(|accuracy| Trial {
            method: Method::Mprgp.name(),
            knob: Some(accuracy),
            settings: Settings::with_method(Method::Mprgp).with_accuracy(accuracy).with_condensation(Condense::Never),
        }));
        ways.iter_mut().for_each(|way| way.settings = watched(way.settings.clone()));
        for (way, timed) in ways.iter().zip(timed(self.problem, &ways, grid.runs.max(1), watch)?) {
            if let Some(timed) = timed {
                points.push(self.point(way, &timed, &exact)?);
            }
        }
        Ok(Some(exact))
    }

    /// The time of an answer, and its errors against the exact one.
    fn point(&self, way: &Trial, timed: &Timed, exact: &Solution) -> Result<TradeoffPoint, Error> {
        let Timed { solution, seconds, second } = timed;
        let norm = |u: &[f64]| energy_norm(self.problem, u);
        let away: Vec<f64> = solution.displacement.iter().zip(&exact.displacement).map(|(u, v)| u - v).collect();
        let force = exact.contact_force();
        let pressure_error =
            (self.peak)(solution)?.zip((self.peak)(exact)?).map(|(peak, exact)| relative(peak - exact, exact));
        let differs = |row: &usize| solution.contact_set.contains(*row) != exact.contact_set.contains(*row);
        Ok(TradeoffPoint {
            mesh: self.mesh,
            method: way.method,
            knob: way.knob,
            condensed: solution.condensed_dofs < self.problem.dofs(),
            seconds: *seconds,
            certificate_seconds: solution.seconds.certificate,
            proof_seconds: solution.seconds.proof,
            is_repeated: *second < (1.0 + REPEATED) * seconds,
            energy_error: relative(norm(&away), norm(&solution.displacement)),
            total_error: None,
            force_error: relative(solution.contact_force() - force, force),
            pressure_error,
            rows_wrong: (0..exact.contact_set.rows()).filter(differs).count(),
            energy_error_bound: solution.certificate.energy_error_bound,
            best: false,
        })
    }
}

/// The size of a number beside a scale; zero beside any is zero.
pub(super) fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { (value / scale).abs() }
}

pub(super) fn energy_norm(problem: &ContactProblem, u: &[f64]) -> f64 {
    dot(u, &problem.stiffness().mul(u)).max(0.0).sqrt()
}

/// One way to an answer: a method with its settings.
struct Trial {
    method: &'static str,
    knob: Option<f64>,
    settings: Settings,
}

/// Every way to an answer with this condensation.
fn ways(condense: Condense) -> Vec<Trial> {
    let base = |method| Settings::with_method(method).with_condensation(condense);
    let mut ways = Vec::new();
    for (method, polish) in [("qp", false), (POLISHED, true)] {
        for tolerance in TOLERANCES {
            let settings = base(Method::Qp(InteriorPoint { polish, tolerance }));
            // A loose answer is judged only by its own tolerance: otherwise it would be refined again, and the time
            // would count.
            let settings = if polish { settings } else { settings.without_tolerance() };
            ways.push(Trial { method, knob: Some(tolerance), settings });
        }
    }
    ways.push(Trial { method: "active-set", knob: None, settings: base(Method::ActiveSet) });
    for last in PENALTIES {
        let ladder = Penalty { last, penetration_threshold: 0.0, ..Penalty::default() };
        let settings = base(Method::Penalty(ladder)).without_tolerance();
        ways.push(Trial { method: "penalty", knob: Some(last), settings });
    }
    ways
}

/// An answer with the seconds of its two fastest runs, without certificate and proof.
struct Timed {
    solution: Solution,
    seconds: f64,
    second: f64,
}

/// The answer of each way, certified or not, and the seconds of its fastest runs. All ways run once before any runs
/// again, so that other work on the machine affects them equally.
///
/// The answer is `None` if multigrid cannot solve the problem, or if `watch` was asked to stop before the way was run.
fn timed(problem: &ContactProblem, ways: &[Trial], runs: usize, watch: &Watch) -> Result<Vec<Option<Timed>>, Error> {
    let run = |number: usize, way: &Trial| {
        if watch.acknowledge() {
            return Ok(None);
        }
        watch.part("run", number + 1, runs * ways.len());
        let clock = Instant::now();
        let solved = Prepared::new(problem, &way.settings).and_then(|prepared| prepared.solve(problem.gap()));
        let seconds = clock.elapsed().as_secs_f64();
        if watch.acknowledge() {
            // An interrupted run gives no measurement.
            return Ok(None);
        }
        let by_cycles = way.settings.method == Method::Mprgp;
        let solution = match solved {
            Ok(solution) => solution,
            Err(qp::Error::NotCertified { solution, .. }) => *solution,
            Err(_) if by_cycles => return Ok(None),
            Err(error) => return Err(Error::from(error)),
        };
        let of_method = seconds - solution.seconds.certificate - solution.seconds.proof;
        Ok(Some(Timed { solution, seconds: of_method, second: f64::INFINITY }))
    };
    let mut fastest = ways.iter().enumerate().map(|(index, way)| run(index, way)).collect::<Result<Vec<_>, Error>>()?;
    for round in 1..MOST_RUNS * runs {
        for (index, (way, fastest)) in ways.iter().zip(&mut fastest).enumerate() {
            let wants = |timed: &Timed| round < runs || (runs > 1 && timed.second >= (1.0 + REPEATED) * timed.seconds);
            if let Some(fastest) = fastest.as_mut().filter(|timed| wants(timed))
                && let Some(again) = run((round % runs) * ways.len() + index, way)?
            {
                let slower = fastest.seconds.max(again.seconds);
                fastest.second = fastest.second.min(slower);
                if again.seconds < fastest.seconds {
                    *fastest = Timed { second: fastest.second, ..again };
                }
            }
        }
    }
    Ok(fastest)
}

impl TradeoffPoint {
    fn error_above_rounding(&self) -> f64 {
        self.energy_error.max(ERROR_ROUNDING)
    }
}

/// The first point of those allowed that has the smallest of both measures, the first measure before the second.
fn least(
    points: &[TradeoffPoint],
    measures: impl Fn(&TradeoffPoint) -> [f64; 2],
    is_allowed: impl Fn(&TradeoffPoint) -> bool,
) -> Option<usize> {
    let allowed = points.iter().enumerate().filter(|(_, point)| is_allowed(point));
    let least = allowed.min_by(|(_, a), (_, b)| {
        let ([a, first], [b, second]) = (measures(a), measures(b));
        a.total_cmp(&b).then(first.total_cmp(&second))
    });
    least.map(|(index, _)| index)
}

/// The fastest way to an accuracy on the first mesh, and the most accurate one in a tenth of the usual time.
fn advice(points: &[TradeoffPoint]) -> Vec<Advice> {
    let own = points.partition_point(|point| point.mesh == 0);
    let own = &points[..own];
    let of_accuracy = |&accuracy: &f64| {
        let point = least(own, |point| [point.seconds, 0.0], |point| point.energy_error <= accuracy);
        Advice { accuracy: Some(accuracy), point, ..Advice::default() }
    };
    let mut advice: Vec<Advice> = WANTED.iter().map(of_accuracy).collect();
    let usual = own.iter().rfind(|point| point.method == POLISHED && point.knob == Some(USUAL_TOLERANCE));
    if let Some(usual) = usual {
        let seconds = HURRY * usual.seconds;
        let errors = |point: &TradeoffPoint| [point.error_above_rounding(), point.seconds];
        let point = least(own, errors, |point| point.seconds <= seconds);
        advice.push(Advice { seconds: Some(seconds), point, ..Advice::default() });
    }
    advice
}

/// The mesh and method that reach a total error first, and those with the smallest total error within a time.
fn advice_of_meshes(points: &[TradeoffPoint]) -> Vec<Advice> {
    let seconds = |point: &TradeoffPoint| [point.seconds, point.total_error.unwrap_or(f64::INFINITY)];
    let of_errors = TOTAL_ERRORS.iter().map(|&total| Advice {
        total_error: Some(total),
        point: least(points, seconds, |point| point.total_error.is_some_and(|of_point| of_point <= total)),
        chooses_mesh: true,
        ..Advice::default()
    });
    // Of errors that differ by less than about a hundredth, the one that is found first.
    let rounded =
        |point: &TradeoffPoint| [(100.0 * point.total_error.map_or(f64::INFINITY, f64::ln)).round(), point.seconds];
    let of_budgets = BUDGETS.iter().map(|&seconds| Advice {
        seconds: Some(seconds),
        point: least(points, rounded, |point| {
            point.seconds <= seconds && point.total_error.is_some_and(f64::is_finite)
        }),
        chooses_mesh: true,
        ..Advice::default()
    });
    of_errors.chain(of_budgets).collect()
}

#[cfg(test)]
mod tests {
    use super::Tradeoff;

    #[test]
    fn a_point_is_on_the_front_unless_another_is_as_small_in_both_costs_and_smaller_in_one() {
        let points = [[1.0, 4.0], [2.0, 4.0], [2.0, 3.0], [2.0, 3.0], [3.0, 3.5], [4.0, 1.0]];
        assert_eq!(Tradeoff::on_front(&points), [true, false, true, true, false, true]);
    }
}
