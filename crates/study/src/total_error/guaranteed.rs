//! The total error with a guaranteed bound: a mesh refined where the elements contribute most to the bound, until it is
//! small enough.

use std::sync::Arc;

use super::continuum;
use super::found::{
    Asked, Bound, Domain, Ended, Guarantee, JudgedMesh, LEAST, Level, LevelKind, MARKED, PER_UNKNOWN, TotalError,
    marked, shortage,
};
use crate::warnings::{check_motion, of_refined};
use crate::{ModelSize, Status};
use signorini_fem::ElementKind;
use signorini_fem::assembly::internal_force;
use signorini_guarantee::{Bracket, ContinuumAnswer, ContinuumProblem, Judged, Point, SimplexMesh, Strain};
use signorini_mechanics::Error;
use signorini_mechanics::scene::{Answer, Scene, Warning};
use signorini_qp as qp;
use signorini_qp::{Method, Settings, Solution, dot, solve};

/// Times that the simplices at obstacles are refined before a body counts as held by nothing. On a coarse mesh the rows
/// of the stress problem, whose gaps are means, may stay open where the body touches.
const COARSE: usize = 6;

/// The error of the solver over that of the goal. A hundred times as much would not be seen in the bound, but the
/// interval of the force needs the distances near the edge of the contact.
const OF_SOLVER: f64 = 1e-4;

/// Refines the mesh of a problem until its total error is small enough, or time or memory end.
pub(super) fn total_error(given: &Asked, problem: &ContinuumProblem, mesh: SimplexMesh) -> Result<TotalError, Error> {
    if given.goal.force_error.is_some() && !problem.has_one_direction() {
        let message = "the contact force has a guaranteed interval only if all obstacles stand still, in one direction from the body";
        return Err(Error::Scene { path: "obstacles".into(), message: message.into() });
    }
    // An error of the solver that is small beside the goal does not matter.
    let least = given.goal.force_error.map_or(given.goal.total_error, |force| force.min(given.goal.total_error));
    let settings = given.settings.clone().with_accuracy(OF_SOLVER * least);
    let search = Proving { given, problem, settings };
    let mut found = search.run(mesh)?;
    given.settings.watch.step("answer", 0);
    match found.guarantee.as_ref().map(|guarantee| on_last_mesh(given, &guarantee.answer, guarantee.distance)) {
        Some(Ok((last, judged))) => {
            found.model = ModelSize::of(last.0.model().problem());
            found.last = Ok(Box::new(last));
            if let Some(guarantee) = found.guarantee.as_mut() {
                guarantee.last_mesh = Some(judged);
            }
        }
        Some(Err(error)) => found.last = Err(error.to_string()),
        None => {}
    }
    Ok(TotalError { seconds: given.seconds(), ..found })
}

/// The answer to the scene on the last mesh, and its distance from the continuum: that of the displacement of the
/// bound, which is at most `distance`, plus the one from that displacement.
fn on_last_mesh(
    given: &Asked,
    of_bound: &ContinuumAnswer,
    distance: f64,
) -> Result<((Answer, Solution), JudgedMesh), Error> {
    let model = Arc::new(continuum::on_last_mesh(given.scene, given.model, of_bound)?);
    let solution = solve(model.problem(), given.settings)?;
    let answer = Answer::of_any_size(model, &solution)?;
    let [away, size] = compared(&answer, of_bound)?;
    let judged = JudgedMesh::of(&answer, distance + away, size)?;
    Ok(((answer, solution), judged))
}

/// The distance of an answer on the last mesh from the displacement of the bound, and its own length, in the energy
/// norm of the body.
pub(super) fn compared(answer: &Answer, of_bound: &ContinuumAnswer) -> Result<[f64; 2], Error> {
    let body = answer.model().body();
    // Stresses without strain do not belong to the norm.
    let own = internal_force(body, &vec![0.0; body.nodal_dofs()])?;
    let size = |displacement: &[f64]| -> Result<f64, Error> {
        let all = dot(displacement, &internal_force(body, displacement)?);
        Ok((all - dot(displacement, &own)).max(0.0).sqrt())
    };
    let of_bound = of_bound.components(&of_bound.displacement);
    let away: Vec<f64> = answer.displacement().iter().zip(&of_bound).map(|(own, other)| own - other).collect();
    Ok([size(&away)?, size(answer.displacement())?])
}

/// The continuum problem and the settings of a guaranteed bound, the same on every mesh.
struct Proving<'a> {
    given: &'a Asked<'a>,
    problem: &'a ContinuumProblem,
    settings: Settings,
}

impl Proving<'_> {
    fn run(&self, first: SimplexMesh) -> Result<TotalError, Error> {
        let mut now = self.given.begun(None);
        let (mut next, mut own, mut touching) = (first, None, None);
        let (mut before, mut last_seconds) = (0.0, 0.0);
        let (mut foresight, mut coarse) = (Foresight::default(), 0);
        let goal = self.given.goal;
        loop {
            let mesh = next;
            self.settings.watch.step("mesh", now.levels.len());
            // The answer on the last mesh takes as long as its displacement.
            let settings = self.settings.clone().watched(&self.settings.watch.keeping(last_seconds));
            let found = Bracket::new(self.problem, &mesh, touching.as_deref(), &settings);
            let bracket = match found.map_err(Error::from) {
                Ok(bracket) => bracket,
                Err(Error::Qp(qp::Error::UnderHeld { .. })) if coarse < COARSE && !self.problem.has_circles() => {
                    coarse += 1;
                    let mut at_obstacles = vec![false; mesh.count()];
                    self.problem.facing(&mesh).for_each(|(outer, _)| at_obstacles[outer.cell] = true);
                    (next, touching) = (self.problem.refined(&mesh, &at_obstacles), None);
                    continue;
                }
                Err(error) => match shortage(&error).filter(|_| !now.levels.is_empty()) {
                    // Its mesh is the one that was not made.
                    Some(ended) => return Ok(TotalError { ended, ..now }),
                    None => return Err(error),
                },
            };
            let level = self.level(&bracket)?;
            let (is_first, is_met) = (now.levels.is_empty(), level.meets(goal));
            // The force converges at its own rate.
            let wanted = if goal.force_error.is_some() { 0.0 } else { goal.total_error };
            let finer = (!is_met).then(|| foresight.finer(&bracket, wanted));
            let elements = finer.as_ref().map(|(finer, _)| finer.count());
            let growth = (elements.unwrap_or(0) as f64 / mesh.count() as f64).powf(PER_UNKNOWN);
            last_seconds = growth * bracket.primal.seconds;
            let is_late = !self.settings.watch.allows(growth * (level.seconds - before) + last_seconds);
            before = level.seconds;
            let mut guarantee = self.guarantee(&bracket, &level, now.guarantee.take());
            // An obstacle that just touches presses less from mesh to mesh.
            let components = guarantee.answer.displacement.iter().flatten();
            check_motion(self.given.model, components.fold(0.0, |largest: f64, part| largest.max(part.abs())))?;
            if let Some((answer, warnings)) = if is_first { self.own_answer()? } else { None } {
                (own, guarantee.warnings) = (Some(answer), warnings);
            }
            // The answer on the scene's own mesh belongs to the polygon of the first mesh.
            if is_first || !self.problem.has_circles() && (is_met || is_late) {
                let judged_by = |own: &Answer| {
                    let Judged { bound, norm, .. } = judged(own, &bracket);
                    JudgedMesh::of(own, bound, norm)
                };
                guarantee.own_mesh = own.as_ref().map(judged_by).transpose()?;
            }
            guarantee.next_elements = elements;
            now.meshes.push(self.seen(&mesh));
            now.total_error.bound = level.total_error;
            now.levels.push(level);
            (now.guarantee, now.seconds) = (Some(guarantee), self.given.seconds());
            if is_met {
                (now.status, now.ended) = (Status::Certified, Ended::Goal);
            }
            let Some(finer) = finer.filter(|_| !is_late) else { return Ok(now) };
            (next, touching) = (finer.0, Some(finer.1));
            (self.given.keep)(&now);
        }
    }

    /// The cells of a mesh in the plane; in space the facets that may touch, along the approach direction.
    fn seen(&self, mesh: &SimplexMesh) -> Vec<Vec<[f64; 2]>> {
        let across = |axis: usize| [[1, 2], [0, 2], [0, 1]][axis];
        let steepest = |normal: Point| (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(2);
        let along = |corners: &[Point], axes: [usize; 2]| corners.iter().map(|at| axes.map(|axis| at[axis])).collect();
        if mesh.dimension == 2 {
            return (0..mesh.count()).map(|cell| along(mesh.simplex(cell).corners(), across(2))).collect();
        }
        let facing = self.problem.facing(mesh);
        let seen = facing.map(|(outer, obstacle)| {
            along(&mesh.corners_of_facet(outer.facet), across(steepest(self.problem.obstacles[obstacle].normal)))
        });
        seen.collect()
    }

    /// What is proven on one more mesh; what earlier meshes say of the scene's own mesh stays.
    fn guarantee(&self, bracket: &Bracket, level: &Level, earlier: Option<Guarantee>) -> Guarantee {
        let (own_mesh, warnings) =
            earlier.map_or_else(Default::default, |earlier| (earlier.own_mesh, earlier.warnings));
        Guarantee {
            domain: match self.problem.dimension {
                2 if self.problem.has_circles() => Domain::LastPolygon,
                2 => Domain::FirstPolygon,
                _ => Domain::FirstPolyhedron,
            },
            distance: bracket.bound() * bracket.energy.sqrt(),
            mean_stress_error: Bound { bound: bracket.bound_of_mean(), guaranteed: true },
            potential_energy: [bracket.energy_of_stress(), bracket.energy_of_displacement()]
                .map(|energy| self.given.model.parts_of_whole() * energy),
            contact_force: level.contact_force,
            force_basis: self.given.model.basis_of_forces(),
            force_interval: level.force_interval(),
            defect: bracket.defect,
            own_mesh,
            last_mesh: None,
            warnings,
            next_elements: None,
            answer: bracket.answer(),
        }
    }

    /// The answer on the scene's own mesh and its warnings; `None` without an answer.
    fn own_answer(&self) -> Result<Option<(Answer, Vec<Warning>)>, Error> {
        let Ok(solution) = solve(self.given.model.problem(), &self.given.settings.clone().exactly()) else {
            return Ok(None);
        };
        let Ok(answer) = Answer::of_any_size(self.given.model.clone(), &solution) else { return Ok(None) };
        let warnings = of_refined(&answer, &solution)?;
        Ok(Some((answer, warnings)))
    }

    /// The numbers of a mesh; the interval of the force if it is requested, or if nothing else is.
    fn level(&self, bracket: &Bracket) -> Result<Level, Error> {
        let goal = self.given.goal;
        let is_near = bracket.bound() <= goal.total_error || goal.force_error.is_some();
        let is_last = is_near || self.settings.watch.time_left().is_some();
        let parts = self.given.model.parts_of_whole();
        let of_whole = |interval: [f64; 2]| interval.map(|force| parts * force);
        // The force is of second order in the error.
        let enough = goal.force_error.unwrap_or(f64::INFINITY).min(goal.total_error.powi(2));
        let force_interval = if is_last { bracket.force_interval(enough)?.map(of_whole) } else { None };
        Ok(Level {
            elements: bracket.mesh.count(),
            dofs: bracket.primal.unknowns.free,
            total_error: bracket.bound(),
            contact_force: parts * bracket.force(),
            kind: LevelKind::Guaranteed {
                stress_dofs: bracket.dual.unknowns.free,
                mean_stress_error: bracket.bound_of_mean(),
                force_interval,
                displacement_seconds: bracket.primal.seconds,
                stress_seconds: bracket.dual.seconds,
            },
            seconds: self.given.seconds(),
        })
    }
}

/// Judges an answer by a bracket on pieces of its elements.
pub(super) fn judged(answer: &Answer, bracket: &Bracket) -> Judged {
    let (body, is_axisymmetric) = (answer.model().body(), bracket.problem.is_axisymmetric);
    bracket.judged(|element| {
        let strain = body.strain_in(answer.displacement(), element);
        let in_plane = bracket.problem.dimension == 2 && !is_axisymmetric;
        let own = move |at| {
            let own @ [xx, yy, _, xy, ..] = strain(at);
            // The strain across the plane belongs to the material.
            if in_plane { [xx, yy, 0.0, xy, 0.0, 0.0] } else { own }
        };
        match body.mesh().kind_of(element) {
            ElementKind::LINEAR_TRIANGLE | ElementKind::LINEAR_TETRAHEDRON if !is_axisymmetric => {
                Strain::Constant(own([0.0; 3]))
            }
            _ if in_plane && body.is_parallelogram(element) => Strain::Linear(own),
            _ => Strain::Varying(own),
        }
    })
}

/// The share of the square of the error that is refined at once. Several small steps grade the mesh better than a large
/// one.
const AT_ONCE: f64 = 0.2;

/// A mesh that is not expected to meet the goal has more than this many times the simplices of the one before.
const GROWN: f64 = 1.9;

/// A simplex with at least this share of the size of the one before is whole: new nodes on circles change sizes a
/// little.
const WHOLE: f64 = 0.9;

/// The logarithm of the measured reduction of the error over that of the expected one lies in this range, or the last
/// step is no example.
const RESPONSE: [f64; 2] = [0.5, 2.0];

/// How shares answer to refinement, as the meshes so far show it.
#[derive(Debug, Default)]
pub(super) struct Foresight {
    /// For each node the power of the size of the simplices at it with which their shares fall: small at a
    /// singularity.
    powers: Vec<f64>,
    /// For each simplex, the share and the size of the simplex of the last mesh of which it is a piece.
    wholes: Vec<[f64; 2]>,
    /// The bound on the last mesh, and the share of its square that was expected to be left on this one.
    before: Option<[f64; 2]>,
}

impl Foresight {
    /// A finer mesh, for a bound that meets the goal or for one that is as small as [`GROWN`] allows, and the nodes of
    /// it that are expected to touch.
    pub fn finer(&mut self, bracket: &Bracket, goal: f64) -> (SimplexMesh, Vec<bool>) {
        let (problem, mesh, bound) = (bracket.problem, bracket.mesh, bracket.bound());
        let (mut shares, mut touching) = (bracket.shares.clone(), bracket.touching());
        let (whole, smooth) = (bracket.distance(), smooth(mesh));
        self.learn(mesh, &shares);
        let response = self.before.map_or(1.0, |[before, left]| 2.0 * (bound / before).ln() / left.ln());
        let response = if response.is_nan() { 1.0 } else { response.clamp(RESPONSE[0], RESPONSE[1]) };
        self.wholes = (0..mesh.count()).map(|cell| [shares[cell], mesh.simplex(cell).size()]).collect();
        let (mut finer, mut wanted) = (mesh.clone(), 1.0 - (goal / bound).powi(2));
        loop {
            let next = problem.refined(&finer, &marked(&shares, wanted.clamp(LEAST, AT_ONCE)));
            touching = next.carried(touching, |one, other| one && other);
            self.powers = next.carried(std::mem::take(&mut self.powers), f64::max);
            let of_piece = |cell: usize| {
                let power = next.cell(cell).iter().map(|&node| self.powers[node]).fold(smooth, f64::min);
                let whole = next.wholes[cell];
                shares[whole] * (next.simplex(cell).size() / finer.simplex(whole).size()).powf(power)
            };
            shares = (0..next.count()).map(of_piece).collect();
            self.wholes = next.wholes.iter().map(|&whole| self.wholes[whole]).collect();
            let left = shares.iter().sum::<f64>() / whole;
            wanted = 1.0 - (goal / bound).powi(2) / left.powf(response);
            let is_enough = next.count() as f64 > GROWN * mesh.count() as f64 || next.count() == finer.count();
            finer = next;
            if wanted <= 0.0 || is_enough {
                self.before = Some([bound, left]);
                return (finer, touching);
            }
        }
    }

    /// Takes the powers at the nodes of the simplices that were refined last from the shares of their pieces. A node
    /// has the largest: at a singularity all of them are small.
    fn learn(&mut self, mesh: &SimplexMesh, shares: &[f64]) {
        let (smooth, mut found) = (smooth(mesh), vec![-1.0_f64; mesh.nodes.len()]);
        for (cell, [share, size]) in self.wholes.iter().enumerate() {
            let power = (shares[cell] / share).ln() / (mesh.simplex(cell).size() / size).ln();
            // The power of a simplex that was not refined has no meaning.
            if mesh.simplex(cell).size() < WHOLE * size && !power.is_nan() {
                mesh.cell(cell).iter().for_each(|&node| found[node] = found[node].max(power.clamp(0.0, smooth)));
            }
        }
        self.powers.resize(mesh.nodes.len(), smooth);
        self.powers.iter_mut().zip(found).filter(|pair| pair.1 >= 0.0).for_each(|(power, found)| *power = found);
    }
}

/// The power where stresses are smooth: the square of the error of linear stresses falls with the fourth power of the
/// length, on the volume.
fn smooth(mesh: &SimplexMesh) -> f64 {
    1.0 + 4.0 / mesh.dimension as f64
}

/// The numbers of one mesh for a study of the guarantee: bounds from both sides, with the answer that they bound.
#[derive(Clone, Debug)]
pub struct Examined {
    /// `[D(tau), J(v)]`, in force times length: the exact potential energy lies between them.
    pub energies: [f64; 2],
    /// The bound on |u - v|.
    pub bound: f64,
    /// |v|: the length of the displacement in the energy norm.
    pub norm: f64,
    /// The sum of the contact forces of the answer v on this mesh, in force.
    pub force: f64,
    /// The ends `[low, high]`, in force, between which the exact contact force lies.
    pub force_interval: Option<[f64; 2]>,
    /// The answer w on the scene's own mesh, in the energy norm, whose unit is the root of force times length: `[an
    /// upper bound of |u - w|,
    /// |v - w|, |w|]`.
    pub own: [f64; 3],
    /// |v - w| with the answer w of the scene by finite elements on the last mesh; `None` on the others.
    pub from_elements: Option<f64>,
    /// Unknowns of v.
    pub dofs: usize,
}

impl Examined {
    /// Brackets on the mesh of a scene and on `levels` finer ones, from the first to the last.
    pub fn of(scene: &Scene, levels: usize) -> Result<Vec<Examined>, Error> {
        let model = Arc::new(scene.build()?);
        let (problem, mut mesh) = continuum::problem(scene, &model)?;
        let settings = Settings::with_method(Method::ActiveSet);
        let own = Answer::of_any_size(model.clone(), &solve(model.problem(), &settings)?)?;
        let mut found = Vec::with_capacity(levels + 1);
        for level in 0..=levels {
            let bracket = Bracket::new(&problem, &mesh, None, &settings)?;
            let judged = judged(&own, &bracket);
            let from_elements = || -> Result<f64, Error> {
                let of_bound = bracket.answer();
                let last = Arc::new(continuum::on_last_mesh(scene, &model, &of_bound)?);
                let solution = solve(last.problem(), &settings)?;
                Ok(compared(&Answer::of_any_size(last, &solution)?, &of_bound)?[0])
            };
            found.push(Examined {
                energies: [bracket.energy_of_stress(), bracket.energy_of_displacement()],
                bound: (2.0 * bracket.distance().max(0.0)).sqrt(),
                norm: bracket.energy.sqrt(),
                force: bracket.force(),
                force_interval: bracket.force_interval(0.0)?,
                own: [judged.bound, judged.from_displacement, judged.norm],
                from_elements: if level == levels { Some(from_elements()?) } else { None },
                dofs: bracket.primal.unknowns.free,
            });
            if level < levels {
                mesh = mesh.refined(&marked(&bracket.shares, MARKED), |_, middle| middle);
            }
        }
        Ok(found)
    }
}
