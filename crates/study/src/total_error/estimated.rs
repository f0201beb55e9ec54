//! The search with an estimate, if no guarantee exists: the recovered stress gives the distance of the mesh from the
//! continuum.

use std::sync::Arc;

use super::found::{Answering, Asked, Ended, Level, LevelKind, PER_UNKNOWN, TotalError, marked, shortage};
use crate::{ModelSize, Status};
use signorini_fem::body::ElasticBody;
use signorini_fem::mesh::bisection::Tetrahedra;
use signorini_mechanics::Error;
use signorini_mechanics::scene::answers::beside_nodes::Depths;
use signorini_mechanics::scene::input::size::{check_bodies, is_round};
use signorini_mechanics::scene::models::build::model_of;
use signorini_mechanics::scene::models::elastic::bodies;
use signorini_mechanics::scene::{Answer, Model, Scene};
use signorini_qp as qp;
use signorini_qp::solve;

/// The share of the total error allowed for the algebraic error: the errors are nearly orthogonal, so that it adds half
/// a hundredth.
const OF_ALGEBRA: f64 = 0.1;

/// Number of times that a marked tetrahedron of the estimate is halved. Measured on a block under a sphere: with 1 more
/// meshes are needed, and 3 refine too much.
const GENERATIONS: usize = 2;

/// Allowed exponents of the error in the cell size: from a strong singularity to smooth quadratic elements.
const RATES: [f64; 2] = [0.25, 2.0];

impl TotalError {
    /// The requested algebraic accuracy of an estimate, relative in energy.
    pub fn algebra(&self) -> f64 {
        OF_ALGEBRA * self.goal.total_error
    }
}

/// Refines the meshes of a scene until the estimate is small enough, or time, memory or meshes end: tetrahedra where
/// the estimate is large, other elements everywhere.
pub(super) fn total_error(given: &Asked, reason: String) -> Result<TotalError, Error> {
    let settings = given.settings.clone().with_accuracy(OF_ALGEBRA * given.goal.total_error);
    let given = &Asked { settings: &settings, ..*given };
    let mut refinement = Refinement::of(given.scene)?;
    let mut now = given.begun(Some(reason));
    let mut shares = given.solve_on(given.model.clone(), &mut now)?;
    let ended = loop {
        if now.levels.last().is_some_and(|level| level.meets(given.goal)) {
            break Ended::Goal;
        }
        if matches!(refinement, Refinement::Fixed) {
            break Ended::Mesh;
        }
        (given.keep)(&now);
        let next = match given.next(&mut refinement, &shares, &now) {
            Ok(Some(finer)) => given.solve_on(Arc::new(finer), &mut now),
            Ok(None) => break Ended::Time,
            Err(error) => Err(error),
        };
        match next {
            Ok(of_next) => shares = of_next,
            Err(error) => match shortage(&error) {
                Some(ended) => break ended,
                None => return Err(error),
            },
        }
    };
    let status = if ended == Ended::Goal { Status::Certified } else { Status::NotCertified };
    Ok(TotalError { status, ended, seconds: given.seconds(), ..now })
}

/// The cells of a plane mesh, or in space the facets that may touch, seen along the approach direction; empty for a
/// bar.
fn cells(model: &Model) -> Vec<Vec<[f64; 2]>> {
    let (mesh, nodes) = (model.mesh(), model.mesh().nodes());
    if mesh.dimension() == 2 {
        let corners = |element: usize| &mesh.element(element)[..mesh.kind_of(element).corners()];
        let cell = |element| corners(element).iter().map(|&node| [nodes[node][0], nodes[node][1]]).collect();
        return (0..mesh.element_count()).map(cell).collect();
    }
    let mut facets = Vec::new();
    for obstacle in model.obstacles().iter().filter(|_| mesh.dimension() == 3) {
        let approach = obstacle.approach().map(f64::abs);
        let along = (0..3).fold(0, |most, axis| if approach[axis] > approach[most] { axis } else { most });
        let across = [[1, 2], [0, 2], [0, 1]][along];
        let Some(boundary) = mesh.boundary(obstacle.boundary()) else { continue };
        let corners = boundary.kind.reference().corners;
        let seen =
            |facet: &[usize]| facet[..corners].iter().map(|&node| across.map(|axis| nodes[node][axis])).collect();
        facets.extend(boundary.facets().map(seen));
    }
    facets
}

/// The way to finer meshes.
enum Refinement {
    /// By bisection of the tetrahedra that make up each body.
    Bisected(Vec<Bisected>, Answering),
    /// By division of each edge of the scene's mesh into this number of parts.
    Divided(usize),
    /// None: a mesh from a file cannot be made finer.
    Fixed,
}

/// A body whose finer meshes are quadratic tetrahedra.
struct Bisected {
    /// As the scene has it, with the materials of its elements.
    body: ElasticBody,
    cells: Tetrahedra,
    /// For each cell, the element of the present mesh that it is a part of.
    elements: Vec<usize>,
}

impl Bisected {
    /// `None` for a body that cannot be cut into straight tetrahedra.
    fn of(body: ElasticBody) -> Option<Self> {
        let cells = Tetrahedra::of(body.mesh())?;
        let elements = cells.parents();
        Some(Bisected { body, cells, elements })
    }

    /// The body on the next mesh, from the marked elements of the present one.
    fn refined(&mut self, marked: &[bool]) -> Result<ElasticBody, Error> {
        let of_cells: Vec<bool> = self.elements.iter().map(|&element| marked[element]).collect();
        self.cells.refine(&of_cells, GENERATIONS);
        let parents = self.cells.parents();
        self.elements = (0..parents.len()).collect();
        Ok(self.body.on(self.cells.mesh()?, &parents)?)
    }
}

impl Refinement {
    fn of(scene: &Scene) -> Result<Self, Error> {
        // Only a mesh file cannot be divided further.
        let divided = || if scene.refined(2).is_ok() { Refinement::Divided(1) } else { Refinement::Fixed };
        if is_round(scene) {
            return Ok(divided());
        }
        let bisected: Option<_> = bodies(scene)?.into_iter().map(Bisected::of).collect();
        Ok(bisected.map_or_else(divided, |bodies| Refinement::Bisected(bodies, Answering::new())))
    }
}

/// Where an answer is far off: what the next mesh is made from.
struct Shares {
    model: Arc<Model>,
    /// The square of the estimated error on each element.
    of_elements: Vec<f64>,
    depths: Depths,
}

impl Asked<'_> {
    /// Solves a model, which becomes the last mesh of `now`.
    fn solve_on(&self, model: Arc<Model>, now: &mut TotalError) -> Result<Shares, Error> {
        self.settings.watch.step("mesh", now.levels.len());
        let solution = match solve(model.problem(), self.settings) {
            // The answer of the previous mesh is better than an interrupted one.
            Err(qp::Error::NotCertified { .. }) if !now.levels.is_empty() && self.settings.watch.is_over() => {
                return Err(qp::Error::Interrupted.into());
            }
            Err(qp::Error::NotCertified { solution, .. }) => *solution,
            other => other.map_err(|error| model.explain(error))?,
        };
        let answer = Answer::of_any_size(model.clone(), &solution)?;
        let (estimated, depths) = (answer.estimated_error()?, answer.depths_between_nodes()?);
        let (of_mesh, of_algebra) = (estimated.relative(), solution.certificate.energy_error_bound);
        let level = Level {
            elements: model.mesh().element_count(),
            dofs: model.problem().dofs(),
            total_error: of_mesh.hypot(of_algebra),
            contact_force: model.parts_of_whole() * solution.contact_force(),
            kind: LevelKind::Estimated {
                contact_rows: model.rows().len(),
                method: solution.method.clone(),
                discretisation_error: of_mesh,
                energy_error_bound: of_algebra,
                depth_between_nodes: depths.relative(),
            },
            seconds: self.seconds(),
        };
        (now.total_error.bound, now.seconds) = (level.total_error, level.seconds);
        now.model = ModelSize::of(model.problem());
        now.levels.push(level);
        now.meshes.push(cells(&model));
        now.last = Ok(Box::new((answer, solution)));
        Ok(Shares { model, of_elements: estimated.of_elements, depths })
    }

    /// The model on the next mesh; `None` if there is no time for one.
    fn next(&self, refinement: &mut Refinement, shares: &Shares, now: &TotalError) -> Result<Option<Model>, Error> {
        let (scene, goal, levels) = (self.scene, self.goal, now.levels.as_slice());
        match refinement {
            Refinement::Fixed => Ok(None),
            Refinement::Bisected(bodies, answering) => {
                let error = levels.last().map_or(1.0, |level| level.total_error);
                let mut marked = marked(&shares.of_elements, answering.share(error, goal.total_error));
                let too_deep = goal.total_error * shares.depths.pushed;
                let deep = marked.iter_mut().zip(&shares.depths.of_elements);
                deep.for_each(|(marked, depth)| *marked |= *depth > too_deep);
                let regions = shares.model.body().regions();
                let finer = regions.iter().zip(bodies).map(|(region, body)| body.refined(&marked[region.elements()]));
                let finer = finer.collect::<Result<Vec<_>, _>>()?;
                let nodes: usize = finer.iter().map(|body| body.mesh().nodes().len()).sum();
                if !self.allows(levels, nodes as f64 / shares.model.mesh().nodes().len() as f64) {
                    return Ok(None);
                }
                if let Some(memory) = self.settings.memory {
                    check_bodies(&finer, memory)?;
                }
                model_of(scene, finer, &[]).map(Some)
            }
            Refinement::Divided(times) => {
                let dimension = shares.model.body().dimension() as i32;
                let growth = |next: usize| (next as f64 / *times as f64).powi(dimension);
                let wanted = finer(levels, *times, goal.total_error, dimension);
                let Some(next) = (*times + 1..=wanted).rev().find(|&next| self.allows(levels, growth(next))) else {
                    return Ok(None);
                };
                *times = next;
                let scene = scene.refined(next)?;
                if let Some(memory) = self.settings.memory {
                    scene.check_size_without_factor(memory)?;
                }
                scene.build().map(Some)
            }
        }
    }

    /// Returns `true` if there is time for a mesh with `growth` times the unknowns of the last one.
    fn allows(&self, levels: &[Level], growth: f64) -> bool {
        let before = levels.len().checked_sub(2).map_or(0.0, |before| levels[before].seconds);
        let taken = levels.last().map_or(0.0, |last| last.seconds - before);
        self.settings.watch.allows(growth.powf(PER_UNKNOWN) * taken)
    }
}

/// The next number of parts of each edge of the scene's mesh: from the convergence rate of the last two meshes, but at
/// most twice the present number.
fn finer(levels: &[Level], times: usize, goal: f64, dimension: i32) -> usize {
    let [.., before, last] = levels else { return 2 * times };
    let size = (last.dofs as f64 / before.dofs as f64).ln() / f64::from(dimension);
    let [before, last] = [before, last].map(|level| level.total_error.max(level.depth_between_nodes().unwrap_or(0.0)));
    let rate = ((before / last).ln() / size).clamp(RATES[0], RATES[1]);
    let wanted = times as f64 * (last / goal).powf(1.0 / rate);
    (wanted.ceil().min(1e9) as usize).clamp(times + 1, 2 * times)
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_qp::{Settings, dot};

    fn level(dofs: usize, total_error: f64) -> Level {
        let kind = LevelKind::Estimated {
            contact_rows: 0,
            method: String::new(),
            discretisation_error: total_error,
            energy_error_bound: 0.0,
            depth_between_nodes: 0.0,
        };
        Level { elements: 0, dofs, total_error, contact_force: 0.0, kind, seconds: 0.0 }
    }

    /// A column of height 2 under its weight, its sides on rollers: u_z is quadratic, and the square of its energy norm
    /// is b^2 h^3 A / 3M. Without contact the square of the norm of the error is this value minus twice the work of the
    /// load, plus the square of the norm of the answer.
    #[test]
    fn the_second_mesh_of_a_column_of_tetrahedra_is_exact_because_it_is_quadratic() {
        let text = r#"{
            "model": "space",
            "body": {"box": {
                "x": {"points": [0, 2], "divisions": [3]}, "y": {"points": [0, 2], "divisions": [3]},
                "z": {"points": [0, 2], "divisions": [3]}, "element": "tet4"
            }},
            "material": {"young": 100, "poisson": 0.3},
            "supports": [
                {"on": {"boundary": "bottom"}, "z": 0},
                {"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0},
                {"on": {"boundary": "front"}, "y": 0}, {"on": {"boundary": "back"}, "y": 0}
            ],
            "loads": [{"body-force": [0, 0, 3]}],
            "obstacles": [{"boundary": "top", "approach": "+z", "shape": {"plane": {"point": [0, 0, 9], "normal": [0, 0, 1]}}}]
        }"#;
        let scene: Scene = serde_json::from_str(text).unwrap();
        let (model, settings) = (Arc::new(scene.build().unwrap()), Settings::default());
        let (scene, model, settings, goal) = (&scene, &model, &settings, 0.05.into());
        let search = Asked { scene, model, goal, settings, keep: &|_| {}, clock: std::time::Instant::now() };
        let found = total_error(&search, "for comparison".into()).unwrap();
        assert!(!found.total_error.guaranteed && found.reason.is_some());
        let (answer, solution) = *found.last.unwrap();
        let problem = answer.model().problem();
        let whole = 9.0 * 8.0 * 4.0 / 3.0 / (100.0 * 0.7 / (1.3 * 0.4));
        let moved = &solution.displacement;
        let stored = dot(moved, &problem.stiffness().mul(moved));
        // The difference of an exact answer is rounding, of either sign.
        let error = ((whole - 2.0 * dot(problem.load(), moved) + stored).abs() / whole).sqrt();
        let last = found.levels.last().unwrap();
        assert!(found.levels.len() == 2 && found.levels[0].total_error > 0.05, "{:?}", found.levels);
        assert!(error < 1e-3 && last.total_error < 0.005, "{error} {last:?}");
    }

    #[test]
    fn the_next_mesh_follows_the_rate_of_the_last_two() {
        assert_eq!(finer(&[level(100, 0.2)], 1, 0.1, 2), 2);
        // First order: from 0.1 to 0.06 the cells must shrink to 0.6 of their size.
        assert_eq!(finer(&[level(100, 0.2), level(400, 0.1)], 2, 0.06, 2), 4);
        assert_eq!(finer(&[level(100, 0.2), level(400, 0.1)], 8, 0.09, 2), 9);
        assert_eq!(finer(&[level(100, 0.2), level(800, 0.1)], 8, 0.0501, 3), 16);
        // At most twice as fine, at any rate.
        assert_eq!(finer(&[level(100, 0.2), level(400, 0.2)], 2, 0.1, 2), 4);
    }
}
