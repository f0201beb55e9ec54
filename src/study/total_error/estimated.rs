//! The search with an estimate, if no guarantee exists: the recovered stress gives the distance of the mesh from the continuum.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::goal::{Answering, Bound, Ended, TotalErrorGoal, marked, shortage};
use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::fem::mesh::bisection::Tetrahedra;
use crate::qp::{Settings, solve};
use crate::scene::answers::depths::Depths;
use crate::scene::{Answer, Model, Scene};
use crate::solution::Solution;
use crate::study::Status;

/// The share of the total error allowed for the algebraic error: the errors are nearly orthogonal, so that it adds half a hundredth.
const OF_ALGEBRA: f64 = 0.1;

/// The seconds of a mesh grow with this power of its unknowns.
const PER_UNKNOWN: f64 = 1.3;

/// Unknowns of a bisected mesh over those of the previous one.
const BISECTED: f64 = 2.0;

/// Allowed exponents of the error in the cell size: from a strong singularity to smooth quadratic elements.
const RATES: [f64; 2] = [0.25, 2.0];

/// One mesh of the search.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct EstimatedLevel {
    /// Elements.
    pub elements: usize,
    /// Unknowns.
    pub dofs: usize,
    /// Contact rows.
    pub contact_rows: usize,
    /// The method for the contact problem.
    pub method: String,
    /// The estimated discretisation error, relative in energy.
    pub discretisation_error: f64,
    /// The bound on the algebraic error, relative in energy.
    pub energy_error_bound: f64,
    /// Both errors together.
    pub total_error: f64,
    /// The largest depth in an obstacle between nodes, over the displacement that the obstacles impose.
    pub depth_between_nodes: f64,
    /// The sum of the contact forces, in force.
    pub contact_force: f64,
    /// Seconds since the start.
    pub seconds: f64,
}

impl EstimatedLevel {
    /// If the mesh misses the tip of an obstacle between its nodes, the stresses do not show that error.
    fn meets(&self, goal: TotalErrorGoal) -> bool {
        self.total_error <= goal.total_error && self.depth_between_nodes <= goal.total_error
    }
}

/// An answer with its estimated error against the continuum.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Estimated {
    pub status: Status,
    pub goal: TotalErrorGoal,
    pub ended: Ended,
    /// |u - v| / |v| in the energy norm, estimated: u the exact displacement, v the answer.
    pub total_error: Bound,
    /// The reason for which it is not guaranteed.
    pub reason: String,
    pub levels: Vec<EstimatedLevel>,
    pub seconds: f64,
    /// The cells of each mesh for pictures: in space the facets that may touch, along the approach direction.
    #[serde(skip)]
    pub views: Vec<Vec<Vec<[f64; 2]>>>,
    /// The answer on the last mesh.
    #[serde(skip)]
    pub answer: Answer,
    #[serde(skip)]
    pub solution: Solution,
}

impl Estimated {
    /// The requested algebraic accuracy, relative in energy.
    pub fn algebra(&self) -> f64 {
        OF_ALGEBRA * self.goal.total_error
    }
}

/// Refines the meshes of a scene until the estimate is small enough, or time, memory or meshes end: tetrahedra where the estimate is
/// large, other elements everywhere.
///
/// # Errors
/// Those of [`solve`] on the first mesh.
pub(super) fn total_error(
    scene: &Scene,
    model: &Arc<Model>,
    goal: TotalErrorGoal,
    reason: String,
    settings: &Settings,
) -> Result<Estimated, Error> {
    let settings = Settings { accuracy: Some(OF_ALGEBRA * goal.total_error), ..settings.clone() };
    let search = Search { scene, settings, clock: Instant::now() };
    let mut refinement = Refinement::of(scene)?;
    let mut levels = Vec::<EstimatedLevel>::new();
    let mut found = search.solved(model.clone(), &mut levels)?;
    let mut views = vec![view(model)];
    let ended = loop {
        if levels.last().is_some_and(|level| level.meets(goal)) {
            break Ended::Goal;
        }
        if matches!(refinement, Refinement::Fixed) {
            break Ended::Mesh;
        }
        let next = match search.next(&mut refinement, &found, &levels, goal) {
            Ok(Some(finer)) => search.solved(Arc::new(finer), &mut levels),
            Ok(None) => break Ended::Time,
            Err(error) => Err(error),
        };
        match next {
            Ok(finer) => {
                views.push(view(finer.answer.model()));
                found = finer;
            }
            Err(error) => match shortage(&error) {
                Some(ended) => break ended,
                None => return Err(error),
            },
        }
    };
    let bound = levels.last().map_or(f64::INFINITY, |level| level.total_error);
    Ok(Estimated {
        status: if ended == Ended::Goal { Status::Certified } else { Status::NotCertified },
        goal,
        ended,
        total_error: Bound { bound, guaranteed: false },
        reason,
        levels,
        seconds: search.clock.elapsed().as_secs_f64(),
        views,
        answer: found.answer,
        solution: found.solution,
    })
}

/// The cells of a plane mesh, or in space the facets that may touch, seen along the approach direction; empty for a bar.
fn view(model: &Model) -> Vec<Vec<[f64; 2]>> {
    let (mesh, nodes) = (model.mesh(), model.mesh().nodes());
    if mesh.dimension() == 2 {
        let corners = mesh.kind().corners();
        let cell =
            |element: &[usize]| element[..corners].iter().map(|&node| [nodes[node][0], nodes[node][1]]).collect();
        return mesh.elements().map(cell).collect();
    }
    let mut facets = Vec::new();
    for obstacle in model.obstacles().iter().filter(|_| mesh.dimension() == 3) {
        let approach = obstacle.approach().map(f64::abs);
        let along = (0..3).fold(0, |most, axis| if approach[axis] > approach[most] { axis } else { most });
        let across = [[1, 2], [0, 2], [0, 1]][along];
        let seen = |facet: &[usize]| facet.iter().map(|&node| across.map(|axis| nodes[node][axis])).collect();
        facets.extend(mesh.boundary(obstacle.boundary()).into_iter().flat_map(|boundary| boundary.facets()).map(seen));
    }
    facets
}

/// The way to finer meshes.
enum Refinement {
    /// By bisection of the tetrahedra of each body. Each body is as the scene has it, with the materials of its elements.
    Bisected(Vec<(ElasticBody, Tetrahedra)>, Answering),
    /// By division of each edge of the scene's mesh into this number of parts.
    Divided(usize),
    /// None.
    Fixed,
}

impl Refinement {
    fn of(scene: &Scene) -> Result<Self, Error> {
        let bodies = scene.bodies()?;
        let bisected = bodies.into_iter().map(|body| Tetrahedra::of(body.mesh()).map(|cells| (body, cells)));
        // Only a mesh file cannot be divided further.
        let divided = || if scene.refined(2).is_ok() { Refinement::Divided(1) } else { Refinement::Fixed };
        Ok(bisected
            .collect::<Option<_>>()
            .map_or_else(divided, |bodies| Refinement::Bisected(bodies, Answering::new())))
    }
}

/// The answer on one mesh.
struct Found {
    answer: Answer,
    solution: Solution,
    /// The square of the estimated error on each element.
    shares: Vec<f64>,
    depths: Depths,
}

/// The data that stay the same from mesh to mesh.
struct Search<'a> {
    scene: &'a Scene,
    settings: Settings,
    clock: Instant,
}

impl Search<'_> {
    /// The answer of a model; its numbers are added to the levels.
    fn solved(&self, model: Arc<Model>, levels: &mut Vec<EstimatedLevel>) -> Result<Found, Error> {
        self.settings.watch.step("mesh", levels.len());
        let solution = match solve(model.problem(), &self.settings) {
            // The answer of the previous mesh is better than an interrupted one.
            Err(Error::NotCertified { .. }) if !levels.is_empty() && self.settings.watch.is_over() => {
                return Err(Error::Interrupted);
            }
            Err(Error::NotCertified { solution, .. }) => *solution,
            other => other.map_err(|error| model.explain(error))?,
        };
        let answer = Answer::of(model.clone(), &solution)?;
        let (estimated, depths) = (answer.estimated_error()?, answer.depths_between_nodes()?);
        let (of_mesh, of_algebra) = (estimated.relative(), solution.certificate.energy_error_bound);
        levels.push(EstimatedLevel {
            elements: model.mesh().element_count(),
            dofs: model.problem().dofs(),
            contact_rows: model.rows().len(),
            method: solution.method.clone(),
            discretisation_error: of_mesh,
            energy_error_bound: of_algebra,
            total_error: of_mesh.hypot(of_algebra),
            depth_between_nodes: depths.relative(),
            contact_force: model.parts_of_whole() * solution.contact_force(),
            seconds: self.clock.elapsed().as_secs_f64(),
        });
        Ok(Found { answer, solution, shares: estimated.of_elements, depths })
    }

    /// The model on the next mesh; `None` if there is no time for one.
    fn next(
        &self,
        refinement: &mut Refinement,
        found: &Found,
        levels: &[EstimatedLevel],
        goal: TotalErrorGoal,
    ) -> Result<Option<Model>, Error> {
        match refinement {
            Refinement::Fixed => Ok(None),
            Refinement::Bisected(bodies, answering) => {
                if !self.allows(levels, BISECTED) {
                    return Ok(None);
                }
                let error = levels.last().map_or(1.0, |level| level.total_error);
                let mut marked = marked(&found.shares, answering.share(error, goal.total_error));
                let too_deep = goal.total_error * found.depths.pushed;
                let deep = marked.iter_mut().zip(&found.depths.of_elements);
                deep.for_each(|(marked, depth)| *marked |= *depth > too_deep);
                let regions = found.answer.model().body().regions();
                let finer = regions.iter().zip(bodies.iter_mut()).map(|(region, (body, cells))| {
                    cells.refine(&marked[region.elements()]);
                    body.on(cells.mesh()?, &cells.parents())
                });
                self.scene.build_of(finer.collect::<Result<_, _>>()?, &[]).map(Some)
            }
            Refinement::Divided(times) => {
                let dimension = found.answer.model().body().dimension() as i32;
                let growth = |next: usize| (next as f64 / *times as f64).powi(dimension);
                let wanted = finer(levels, *times, goal.total_error, dimension);
                let Some(next) = (*times + 1..=wanted).rev().find(|&next| self.allows(levels, growth(next))) else {
                    return Ok(None);
                };
                *times = next;
                let scene = self.scene.refined(next)?;
                if let Some(memory) = self.settings.memory {
                    scene.check_size_without_factor(memory)?;
                }
                scene.build().map(Some)
            }
        }
    }

    /// Returns `true` if there is time for a mesh with `growth` times the unknowns of the last one.
    fn allows(&self, levels: &[EstimatedLevel], growth: f64) -> bool {
        let before = levels.len().checked_sub(2).map_or(0.0, |before| levels[before].seconds);
        let taken = levels.last().map_or(0.0, |last| last.seconds - before);
        self.settings.watch.allows(growth.powf(PER_UNKNOWN) * taken)
    }
}

/// The next number of parts of each edge of the scene's mesh: from the convergence rate of the last two meshes, but at most twice the
/// present number.
fn finer(levels: &[EstimatedLevel], times: usize, goal: f64, dimension: i32) -> usize {
    let [.., before, last] = levels else { return 2 * times };
    let size = (last.dofs as f64 / before.dofs as f64).ln() / f64::from(dimension);
    let [before, last] = [before, last].map(|level| level.total_error.max(level.depth_between_nodes));
    let rate = ((before / last).ln() / size).clamp(RATES[0], RATES[1]);
    let wanted = times as f64 * (last / goal).powf(1.0 / rate);
    (wanted.ceil().min(1e9) as usize).clamp(times + 1, 2 * times)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::qp::linear::dot;

    fn level(dofs: usize, total_error: f64) -> EstimatedLevel {
        EstimatedLevel {
            elements: 0,
            dofs,
            contact_rows: 0,
            method: String::new(),
            discretisation_error: total_error,
            energy_error_bound: 0.0,
            total_error,
            depth_between_nodes: 0.0,
            contact_force: 0.0,
            seconds: 0.0,
        }
    }

    /// A column of height 2 under its weight, its sides on rollers: u_z is quadratic, and the square of its energy norm is b^2 h^3 A /
    /// 3M. Without contact the square of the norm of the error is this value minus twice the work of the load, plus the square of the
    /// norm of the answer.
    #[test]
    fn a_column_of_tetrahedra_is_about_as_far_off_as_the_estimate_says() {
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
        let model = Arc::new(scene.build().unwrap());
        let goal = TotalErrorGoal { total_error: 0.05, force_error: None };
        let found = total_error(&scene, &model, goal, "space".into(), &Settings::default()).unwrap();
        let problem = found.answer.model().problem();
        let whole = 9.0 * 8.0 * 4.0 / 3.0 / (100.0 * 0.7 / (1.3 * 0.4));
        let moved = &found.solution.displacement;
        let stored = dot(moved, &problem.stiffness().mul(moved));
        let error = ((whole - 2.0 * dot(problem.load(), moved) + stored) / whole).sqrt();
        let last = found.levels.last().unwrap();
        assert!(last.total_error <= 0.05 && found.levels.len() > 2, "{:?}", found.levels);
        // Measured 0.66: an estimate is not a bound.
        let share = last.total_error / error;
        assert!(0.6 < share && share < 1.1, "{share}");
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
