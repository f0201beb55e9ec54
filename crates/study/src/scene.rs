//! Answers to a scene: its summary, and sweeps over gaps and forces with the exact path between gaps; a problem that
//! moves to another end.

use std::sync::Arc;
use std::time::Instant;

use super::summary::{LargestDisplacement, OF_MESHED_PART, Status, contact_on_obstacles};
use super::warnings::{BEYOND, check_approach, check_deformation, initial_overlap, of_scene, point_support};
use super::{ModelSize, Summary};
use serde::Serialize;
use signorini_fem::formulation::Formulation;
use signorini_mechanics::Error;
use signorini_mechanics::bytes;
use signorini_mechanics::scene::models::model::{pressed_by, touched};
use signorini_mechanics::scene::models::rigid_body_modes::RigidBodyModes;
use signorini_mechanics::scene::{Answer, ContactExtent, Model, Warning};
use signorini_qp as qp;
use signorini_qp::{ContactProblem, ContactSet, Goal, Path, Prepared, Settings, Solution, Start, solve};

/// Gaps at the middle that differ by more than this from the mean of the ends, relative, are not on a straight line.
const STRAIGHT_LINE: f64 = 1e-12;

/// Displacements that differ by less, relative, are the same up to the rounding of a solve, as those of symmetric
/// nodes.
const SAME: f64 = 1e-9;

impl Summary {
    /// The numbers of `solution` to a problem without a scene.
    pub fn of_problem(
        problem: &ContactProblem,
        solution: Solution,
        goal: impl Into<Goal>,
        assemble_seconds: f64,
    ) -> Summary {
        let warning = super::warnings::untouched(problem, &solution);
        let of_rows = problem.warnings().into_iter().map(|(code, message)| Warning { code, message });
        let mut summary = Summary::new(solution, ModelSize::of(problem), goal, assemble_seconds);
        summary.warnings.extend(of_rows.chain(warning));
        summary
    }

    /// The numbers of `solution`, the solution behind `answer`: with pressures, the width of the contact, and the
    /// balance of all forces.
    ///
    /// # Errors
    /// [`Error::Refused`] for an obstacle that pulls, and for large displacements that a deck asks for; as
    /// [`Model::reactions`].
    pub fn of_answer(
        answer: &Answer,
        solution: Solution,
        goal: impl Into<Goal>,
        assemble_seconds: f64,
    ) -> Result<Summary, Error> {
        let (model, closed) = (answer.model(), answer.contact_set());
        check_approach(model, &solution.multiplier)?;
        check_deformation(answer)?;
        let segments = answer.segments();
        let warnings = of_scene(answer, &solution, &segments);
        let mesh = model.mesh();
        let size = ModelSize {
            nodes: Some(mesh.nodes().len()),
            elements: Some(mesh.element_count()),
            ..ModelSize::of(model.problem())
        };
        let mut summary = Summary::new(solution, size, goal, assemble_seconds);
        let is_supported = || RigidBodyModes::of_parts(&model.parts).free(&model.parts, &[]).is_empty();
        if summary.solution.lost_pivot().is_some() && !is_supported() {
            // The small pivot belongs to a rigid-body mode that only contact holds: no digit is lost.
            summary.warnings.clear();
        }
        if !model.parts.scene.is_linear && warnings.iter().any(|warning| warning.code == BEYOND) {
            summary.status = Status::BeyondSmallDisplacements;
        }
        summary.warnings.extend(warnings);
        let contact = &mut summary.contact;
        contact.pressure_max = Some(answer.pressure().iter().copied().fold(0.0, f64::max));
        let parts = model.parts_of_whole();
        contact.force *= parts;
        contact.width = contact_width(model, closed);
        contact.area = Some(contact_area(model, closed));
        contact.force_balance = answer.balance()?;
        if mesh.dimension() > 1 {
            contact.estimate = ContactExtent::of(segments.iter()).map(|extent| extent.of_parts(parts));
        }
        summary.largest_displacement = largest_displacement(answer);
        summary.resultants = answer.resultants()?.to_vec();
        contact_on_obstacles(answer, &segments, &mut summary);
        if parts > 1.0 {
            (summary.parts_of_whole, summary.of_meshed_part) = (Some(parts as usize), &OF_MESHED_PART);
        }
        summary.warnings.extend(point_support(answer, &summary.resultants));
        summary.force_basis = model.basis_of_forces();
        summary.initial_overlap = initial_overlap(model);
        summary.segments = segments;
        Ok(summary)
    }
}

/// The component of the displacement with the largest magnitude; of several that agree up to rounding, the first.
fn largest_displacement(answer: &Answer) -> Option<LargestDisplacement> {
    let (mesh, values) = (answer.model().mesh(), answer.displacement());
    let largest = signorini_qp::largest(values);
    let number = values.iter().position(|value| value.abs() >= (1.0 - SAME) * largest)?;
    let (node, axis) = (number / mesh.dimension(), number % mesh.dimension());
    let place = mesh.nodes().get(node)?[..mesh.dimension()].to_vec();
    Some(LargestDisplacement { value: values[number], axis, node, place })
}

/// Area of the boundary that belongs to the closed rows; thickness, cross-section or circumference included.
fn contact_area(model: &Model, closed: &ContactSet) -> f64 {
    let of_part =
        closed.iter().filter_map(|row| model.rows().get(row)).fold(0.0, |area, row| area + row.tributary_area);
    model.parts_of_whole() * of_part
}

/// Length of the boundary that belongs to the closed rows, in the unit of length, if the model has a thickness.
fn contact_width(model: &Model, closed: &ContactSet) -> Option<f64> {
    match *model.body().formulation() {
        Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness } => {
            Some(contact_area(model, closed) / thickness)
        }
        _ => None,
    }
}

/// One gap, or one force, of a sweep: the answer there, with its certificate and its summary.
#[derive(Clone, Debug, Serialize)]
pub struct SweepPoint {
    /// The scene-wide gap, in length; negative if it moves the obstacles into the body.
    pub gap: f64,
    /// The force that presses the obstacle, in force, `>= 0`, in a sweep over forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// The answer at this gap or force with its certificate, forces and warnings.
    #[serde(flatten)]
    pub summary: Summary,
    /// The answer, with the model at this gap.
    #[serde(skip)]
    pub answer: Answer,
}

impl SweepPoint {
    /// The point of a model that was built in `assemble_seconds`.
    fn of((model, assemble_seconds): (Model, f64), solution: Solution, settings: &Settings) -> Result<Self, Error> {
        let gap = model.gap();
        let answer = Answer::of_any_size(Arc::new(model), &solution)?;
        let summary = Summary::of_answer(&answer, solution, settings.goal(), assemble_seconds)?;
        Ok(SweepPoint { gap, force: None, summary, answer: answer.without_stress() })
    }

    /// The displacement of the pressed obstacle, in a sweep over forces.
    pub fn travel(&self) -> Option<f64> {
        self.force?;
        (0..self.answer.model().obstacles().len()).find_map(|obstacle| self.answer.travel(obstacle))
    }
}

/// A row that touches or releases at a gap between the first and the last one of a sweep. The gap is exact, because the
/// answer is linear in it between two events.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SweepEvent {
    /// Scene-wide gap at which it happens, in length, exact up to rounding.
    pub gap: f64,
    /// Index of the row that touches or releases in the problem, from 0.
    pub row: usize,
    /// Index of the node of the row in the mesh, from 0.
    pub node: usize,
    /// `true` if the node touches, `false` if it releases.
    pub touches: bool,
}

/// A corner of the polylines over the gap. At a change of the contact set there are two, before and after.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SweepCorner {
    /// Scene-wide gap, in length; negative if it moves the obstacles into the body.
    pub gap: f64,
    /// Total contact force `-sum(lambda)` at this corner, in force, `>= 0`.
    pub force: f64,
    /// Length of the boundary in contact, in length, if the model has a thickness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Area of the boundary in contact, in area.
    pub area: f64,
    /// Largest contact pressure at this corner, in force per area, `>= 0`.
    pub pressure_max: f64,
}

/// A scene at several gaps, or forces: the answer at each, and the exact events in between.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Sweep {
    /// The answers at the requested gaps or forces, in their order.
    pub points: Vec<SweepPoint>,
    /// The events between the first and the last gap; empty if the rows do not move on straight lines.
    pub events: Vec<SweepEvent>,
    /// Exact force, width and pressure in between; empty if the events are.
    pub corners: Vec<SweepCorner>,
    /// The names of these entries of the meshed part; empty without planes of symmetry. Those of the points are in each
    /// point.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub of_meshed_part: &'static [&'static str],
    /// The answers in between, if the events are known.
    #[serde(skip)]
    pub path: Option<ExactPath>,
}

impl Sweep {
    /// A number of values from `first` to `last`, both included, in their unit and in that order: gaps or forces to
    /// sweep over.
    pub fn even_gaps(first: f64, last: f64, count: usize) -> Vec<f64> {
        let share = |i: usize| i as f64 / (count.max(2) - 1) as f64;
        let between = |i: usize| first * (1.0 - share(i)) + last * share(i);
        // Fifteen digits, so that gaps appear as a person would write them: -0.03, not -0.030000000000000002.
        let written = |gap: f64| format!("{gap:.14e}").parse().unwrap_or(gap);
        let gap = |i: usize| match i {
            0 => first,
            i if i + 1 == count => last,
            i => written(between(i)),
        };
        (0..count).map(gap).collect()
    }

    /// Solves a scene at every one of `gaps`, in length, negative into the body; an answer that is not certified counts
    /// as an answer here.
    ///
    /// The stiffness is factorised once, or a hierarchy is built once, and every solve starts from the last contact
    /// set. If the body is condensed and the rows move on straight lines (rows along the approach direction do), all
    /// events between the first and the last gap are found.
    ///
    /// An interrupted sweep holds the gaps that were solved before, and nothing in between.
    ///
    /// # Errors
    /// As [`Model::with_gap`] and [`solve`]; [`qp::Error::Interrupted`] if no gap was
    /// solved.
    pub fn over_gaps(model: &Model, gaps: &[f64], settings: &Settings) -> Result<Self, Error> {
        let (Some(&first), Some(&last)) = (gaps.first(), gaps.last()) else { return Ok(Sweep::default()) };
        let kept = KeptAnswers::of(gaps.len(), model.problem().dofs(), settings);
        let settings = &kept.settings(settings);
        let at_first = model.with_gap(first)?;
        let prepared = Prepared::for_gaps(at_first.problem(), gaps.len(), settings)
            .map_err(|error| at_first.explain(kept.explain(error.into())))?;
        let solved_at = |gap: f64, known: Start| {
            let clock = Instant::now();
            let model = model.with_gap(gap)?;
            let assemble_seconds = clock.elapsed().as_secs_f64();
            let same_rows = model.problem().contact() == at_first.problem().contact();
            let solved = match same_rows {
                true => prepared.starting_from(known).solve(model.problem().gap()),
                false => solve(model.problem(), settings),
            };
            let solved = solved.map_err(|error| model.explain(kept.explain(error.into())));
            Ok(((model, assemble_seconds), solved))
        };
        let points = points("gap", gaps, settings, solved_at, |gap, of_gap, solution| {
            Ok(SweepPoint { gap, ..SweepPoint::of(of_gap, solution, settings)? })
        })?;
        if settings.watch.acknowledge() {
            return Ok(Sweep { points, ..Sweep::default() });
        }
        let Some(path) = between(&prepared, &at_first, last)? else { return Ok(Sweep { points, ..Sweep::default() }) };
        let events = path.path.events().iter().map(|event| {
            let node = at_first.rows()[event.row].node;
            SweepEvent { gap: path.gap(event.at), row: event.row, node, touches: event.touches }
        });
        let (events, corners) = (events.collect(), corners(&path, &at_first)?);
        let of_meshed_part: &[&str] = if model.parts_of_whole() > 1.0 { &["events"] } else { &[] };
        Ok(Sweep { points, events, corners, of_meshed_part, path: Some(path) })
    }

    /// Solves a scene at every one of `forces`, in force, 0 or positive, of the one obstacle that a force presses. At
    /// the force 0 the obstacle stands where it first touches the body.
    ///
    /// # Errors
    /// [`Error::Scene`] if a force presses no obstacle or several, or for a force that is negative or not finite; as
    /// [`solve`]; [`qp::Error::Interrupted`] if no force was solved.
    pub fn over_forces(model: &Model, forces: &[f64], settings: &Settings) -> Result<Self, Error> {
        if forces.is_empty() {
            return Ok(Sweep::default());
        }
        let kept = KeptAnswers::of(forces.len(), model.problem().dofs(), settings);
        let settings = &kept.settings(settings);
        let prepared =
            Prepared::new(model.problem(), settings).map_err(|error| model.explain(kept.explain(error.into())))?;
        let solved_at = |force: f64, known: Start| {
            let clock = Instant::now();
            let model = pressed_by(model, force)?;
            let assemble_seconds = clock.elapsed().as_secs_f64();
            let solved = match force > 0.0 {
                true => prepared.starting_from(known).solve_load(model.problem().load().to_vec()).map_err(Error::from),
                false => touched(&model, settings),
            };
            let solved = solved.map_err(|error| model.explain(kept.explain(error)));
            Ok(((model, assemble_seconds), solved))
        };
        let points = points("force", forces, settings, solved_at, |force, of_force, solution| {
            Ok(SweepPoint { force: Some(force), ..SweepPoint::of(of_force, solution, settings)? })
        })?;
        Ok(Sweep { points, ..Sweep::default() })
    }
}

/// The exact path between two gaps; `None` if the rows rotate on the path, or if the body is not condensed.
fn between(prepared: &Prepared, at_first: &Model, last: f64) -> Result<Option<ExactPath>, Error> {
    let first = at_first.gap();
    let (at_last, at_middle) = (at_first.with_gap(last)?, at_first.with_gap((first + last) / 2.0)?);
    let rows = at_first.problem().contact();
    let (from, to) = (at_first.problem().gap(), at_last.problem().gap());
    let is_straight =
        rows == at_last.problem().contact()
            && rows == at_middle.problem().contact()
            && from.iter().zip(to).zip(at_middle.problem().gap()).all(|((from, to), middle)| {
                ((from + to) / 2.0 - middle).abs() <= STRAIGHT_LINE * (from.abs() + to.abs())
            });
    // Without a factor no path can be computed.
    if first == last || !is_straight || prepared.hierarchy().is_some() {
        return Ok(None);
    }
    Ok(prepared.path(from, to).ok().map(|path| ExactPath::new(path, at_first.clone(), last)))
}

/// Force, width and pressure at both ends of every stretch of an exact path.
fn corners(path: &ExactPath, model: &Model) -> Result<Vec<SweepCorner>, Error> {
    let mut corners = Vec::new();
    for piece in 0..path.pieces() {
        let (closed, multipliers, pressures) =
            (path.contact_set(piece), path.multipliers(piece), path.pressures(piece)?);
        for ((share, multiplier), pressure) in path.ends(piece).into_iter().zip(&multipliers).zip(pressures) {
            corners.push(SweepCorner {
                gap: path.gap(share),
                force: -multiplier.iter().sum::<f64>() * model.parts_of_whole(),
                width: contact_width(model, &closed),
                area: contact_area(model, &closed),
                pressure_max: pressure.into_iter().fold(0.0, f64::max),
            });
        }
    }
    Ok(corners)
}

/// The answer to a problem whose gaps and load lie between those of a directory and those of its other end.
#[derive(Clone, Debug, Serialize)]
pub struct ProblemPoint {
    /// Position on the path: 0 for the problem itself, 1 for its other end.
    pub t: f64,
    /// The answer at this point of the path with its certificate, forces and warnings.
    #[serde(flatten)]
    pub summary: Summary,
}

/// A row that touches or releases on the path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProblemEvent {
    /// The exact position.
    pub t: f64,
    /// The contact row.
    pub row: usize,
    /// `true` if the row closes as t grows, `false` if it opens.
    pub touches: bool,
}

/// The answers of a problem directory at several points of the way to its other end.
#[derive(Clone, Debug, Serialize)]
pub struct ProblemSweep {
    /// The answers at the points, from 0 to 1.
    pub points: Vec<ProblemPoint>,
    /// The events between the points; `None` if they are not known: the load changes, or the problem is not condensed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events: Option<Vec<ProblemEvent>>,
}

impl ProblemSweep {
    /// Solves `first` at `count` points of the path to `last`, the same body and rows with other gaps, another load, or
    /// both. An answer that is not certified counts as an answer here.
    ///
    /// The body is factorised once, or a hierarchy is built once, and every solve starts from the last answer. An
    /// interrupted sweep holds the points that were solved before.
    ///
    /// # Errors
    /// As [`solve`](signorini_qp::solve()); [`qp::Error::Interrupted`] if no point
    /// was solved.
    pub fn of(first: &ContactProblem, last: &ContactProblem, count: usize, settings: &Settings) -> Result<Self, Error> {
        let kept = KeptAnswers::of(count, first.dofs(), settings);
        let settings = &kept.settings(settings);
        let prepared = Prepared::for_gaps(first, count, settings).map_err(|error| kept.explain(error.into()))?;
        let same_load = first.load() == last.load();
        let solved_at = |t: f64, known: Start| {
            let problem = first.towards(last, t)?;
            let prepared = match same_load {
                true => prepared.starting_from(known),
                false => prepared.with_load(problem.load().to_vec())?.starting_from(known),
            };
            let solved = prepared.solve(problem.gap()).map_err(|error| kept.explain(error.into()));
            Ok((problem, solved))
        };
        let point = |t: f64, problem: ContactProblem, solution: Solution| {
            Ok(ProblemPoint { t, summary: Summary::of_problem(&problem, solution, settings.goal(), 0.0) })
        };
        let points = points("point", &Sweep::even_gaps(0.0, 1.0, count), settings, solved_at, point)?;
        let is_known = same_load && !settings.watch.acknowledge() && prepared.hierarchy().is_none();
        let path = if is_known { prepared.path(first.gap(), last.gap()).ok() } else { None };
        let of_path = path.as_ref().map(|path| path.events().iter());
        let events = of_path.map(|events| {
            events.map(|event| ProblemEvent { t: event.at, row: event.row, touches: event.touches }).collect()
        });
        Ok(ProblemSweep { points, events })
    }
}

/// The points of a sweep at all `values` of the quantity `name`: `solved_at` a value gives the solution, started from
/// the last one, with what else `point` needs. An answer that is not certified counts as an answer. An interrupted
/// sweep holds the points before.
fn points<T, P>(
    name: &'static str,
    values: &[f64],
    settings: &Settings,
    solved_at: impl Fn(f64, Start) -> Result<(T, Result<Solution, Error>), Error>,
    point: impl Fn(f64, T, Solution) -> Result<P, Error>,
) -> Result<Vec<P>, Error> {
    let (mut points, mut known) = (Vec::with_capacity(values.len()), Start::default());
    for (index, &value) in values.iter().enumerate() {
        settings.watch.part(name, index + 1, values.len());
        let (of_value, solved) = solved_at(value, known)?;
        let solution = match solved {
            Ok(solution) => solution,
            // An interrupted solve is no answer to this value.
            Err(_) if settings.watch.acknowledge() => break,
            Err(Error::Qp(qp::Error::NotCertified { solution, .. })) => *solution,
            Err(error) => return Err(error),
        };
        known = Start::from(&solution);
        points.push(point(value, of_value, solution)?);
        if settings.watch.acknowledge() {
            break;
        }
    }
    if points.is_empty() { Err(qp::Error::Interrupted.into()) } else { Ok(points) }
}

/// The answers that a sweep keeps until its report: they leave less of the allowed memory to each solve.
struct KeptAnswers {
    count: usize,
    dofs: usize,
    /// The allowed memory, in bytes; `None` if there is no limit.
    allowed: Option<f64>,
}

impl KeptAnswers {
    /// `count` answers with `dofs` unknowns each.
    fn of(count: usize, dofs: usize, settings: &Settings) -> Self {
        KeptAnswers { count, dofs, allowed: settings.memory }
    }

    fn bytes(&self) -> f64 {
        bytes::of_answers(self.count as f64, self.dofs as f64)
    }

    fn settings(&self, settings: &Settings) -> Settings {
        match self.allowed {
            Some(allowed) => settings.clone().with_memory((allowed - self.bytes()).max(1.0)),
            None => settings.clone(),
        }
    }

    /// The error of a solve under these settings, with the limit that was set: the answers are the reason if the solve
    /// alone fits.
    fn explain(&self, error: Error) -> Error {
        let Some(allowed) = self.allowed else { return error };
        let of_answers = |solve: f64| {
            let (count, dofs, kept) = (self.count, self.dofs, self.bytes());
            Error::TooManyAnswers { count, dofs, kept, solve, allowed }
        };
        match error {
            Error::Qp(qp::Error::TooLarge { bytes, .. }) if bytes <= allowed => of_answers(bytes),
            Error::Qp(qp::Error::NoRoom { factor, multigrid, .. }) if factor.min(multigrid) <= allowed => {
                of_answers(factor.min(multigrid))
            }
            Error::Qp(qp::Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, .. }) => {
                qp::Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed }.into()
            }
            Error::Qp(qp::Error::NoRoom { factor, multigrid, ended, .. }) => {
                qp::Error::NoRoom { factor, multigrid, allowed, ended }.into()
            }
            error => error,
        }
    }
}

/// Two corners closer than this are one, as shares of the path.
const SAME_PLACE: f64 = 1e-13;

/// The exact changes of a scene from one gap to another: between two corners everything is linear in the gap.
#[derive(Clone, Debug)]
pub struct ExactPath {
    /// The path between the first gap and the last.
    pub path: Path,
    /// The scene at the first gap.
    model: Model,
    first: f64,
    last: f64,
}

impl ExactPath {
    /// The `path` of the rows of `model`, which has the gap `first`, to the gap `last`.
    pub fn new(path: Path, model: Model, last: f64) -> Self {
        let first = model.gap();
        ExactPath { path, model, first, last }
    }

    /// The scene-wide gap at a share of the path.
    pub fn gap(&self, share: f64) -> f64 {
        (1.0 - share) * self.first + share * self.last
    }

    /// Number of stretches on which the contact set does not change.
    pub fn pieces(&self) -> usize {
        self.path.pieces().len()
    }

    /// The two ends of a stretch, its start before its end, as shares of the path: dimensionless, in `[0, 1]`.
    pub fn ends(&self, piece: usize) -> [f64; 2] {
        [self.path.pieces()[piece].from, self.path.pieces()[piece].to]
    }

    /// The closed rows on a stretch.
    pub fn contact_set(&self, piece: usize) -> ContactSet {
        self.path.contact_set_on(&self.path.pieces()[piece])
    }

    /// The multipliers at both ends of a stretch, one per row, in force, `<= 0`.
    pub fn multipliers(&self, piece: usize) -> [Vec<f64>; 2] {
        self.ends(piece).map(|share| self.path.multiplier_on(&self.path.pieces()[piece], share))
    }

    /// The pressures of all rows at both ends of a stretch, in force per area.
    pub fn pressures(&self, piece: usize) -> Result<[Vec<f64>; 2], Error> {
        let [from, to] = self.multipliers(piece);
        Ok([self.model.pressure(&from)?, self.model.pressure(&to)?])
    }

    /// The start, every event and the end in this order, as shares of the path, dimensionless.
    pub fn corners(&self) -> Vec<f64> {
        let mut corners = self.path.corners();
        corners.dedup_by(|next, last| (*next - *last).abs() <= SAME_PLACE);
        corners
    }

    /// The answer at a share of the path, without its own certificate.
    pub fn answer(&self, share: f64) -> Result<Answer, Error> {
        let model = Arc::new(self.model.with_gap(self.gap(share))?);
        let (displacement, multiplier) = (self.path.displacement(share)?, self.path.multiplier(share));
        let multiplier = [multiplier, self.path.equality_multiplier(share)].concat();
        Answer::new(model, &displacement, &multiplier, &self.path.contact_set(share))
    }
}
