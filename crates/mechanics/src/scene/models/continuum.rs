//! The plane contact problem that a scene describes, before any mesh.

use std::collections::{BTreeMap, HashMap};

use super::load::spread;
use crate::continuum::{
    Circle, Condition, Distance, Enclosure, Facing, PlaneAnswer, PlaneProblem, Point, Triangulation,
};
use crate::error::Error;
use crate::fem::material::Stiffness;
use crate::fem::mesh::triangle_pieces::TrianglePieces;
use crate::fem::{ElasticBody, Formulation, Mesh};
use crate::scene::Model;
use crate::scene::input::entry::{boundary, wrong};
use crate::scene::input::obstacle::PlacedObstacle;
use crate::scene::input::schema::load::{LoadSpec, PressureSpec, TractionSpec};
use crate::scene::input::schema::{Place, Rule, Scene};

/// The component of a unit vector normal to a coordinate axis below which it is rounding of the written components.
const ALONG_AXIS: f64 = 1e-14;

/// What of a scene has no guaranteed bound, and what would have one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NoGuarantee {
    /// JSON path of what has none.
    pub path: String,
    /// A sentence.
    pub message: String,
}

/// Why there is no plane problem: an answer to the question for a guarantee, or a failure, which answers nothing.
#[derive(Debug)]
pub(crate) enum WhyNot {
    /// The scene has no guaranteed bound.
    NoGuarantee(NoGuarantee),
    /// The question has no answer.
    Failed(Error),
}

impl From<Error> for WhyNot {
    fn from(error: Error) -> Self {
        WhyNot::Failed(error)
    }
}

impl From<WhyNot> for Error {
    fn from(why: WhyNot) -> Self {
        match why {
            WhyNot::NoGuarantee(NoGuarantee { path, message }) => Error::Scene { path, message },
            WhyNot::Failed(error) => error,
        }
    }
}

fn none(path: impl Into<String>, message: impl Into<String>) -> WhyNot {
    WhyNot::NoGuarantee(NoGuarantee { path: path.into(), message: message.into() })
}

impl Scene {
    /// Refuses a scene without an answer in the continuum.
    ///
    /// # Errors
    /// [`Error::Scene`] for a force at a point, except on a bar.
    pub(crate) fn check_continuum(&self) -> Result<(), Error> {
        match self.loads.iter().position(LoadSpec::is_at_points) {
            Some(index) if self.model.dimension() > 1 => {
                let message = "a force at a point makes an infinite displacement in a continuum, so that there is \
                               no total error; spread it over a boundary";
                let field = if self.loads[index].is_at_point() { "force" } else { "nodal-forces" };
                Err(wrong(format!("loads[{index}].{field}"), message))
            }
            _ => Ok(()),
        }
    }

    /// Asks for a guaranteed bound: the plane problem of the polygon that the mesh of `model` fills and the initial triangles, or why not.
    pub(crate) fn plane_problem(&self, model: &Model) -> Result<(PlaneProblem, Triangulation), WhyNot> {
        let body = model.body();
        let formulation = *body.formulation();
        let (Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness }) = formulation else {
            let message =
                format!("{} has no guaranteed bound: only plane strain and plane stress have one", formulation.name());
            return Err(none("model", message));
        };
        for (field, is_there) in [
            ("springs", !self.springs.is_empty()),
            ("symmetry", !self.symmetry.is_empty()),
            ("rigid-faces", !self.rigid_faces.is_empty()),
            ("ties", !self.ties.is_empty()),
        ] {
            if is_there {
                return Err(none(field, "they have no guaranteed bound: only supports have one"));
            }
        }
        let [_] = body.regions() else {
            let message = "several bodies have no guaranteed bound: only one body with rigid obstacles has one";
            return Err(none("further-bodies", message));
        };
        if body.has_own_stress() {
            let path = if self.temperature.is_empty() { "initial-stress" } else { "temperature" };
            let message = "a body with temperatures or initial stresses has no guaranteed bound: only one without \
                           them has";
            return Err(none(path, message));
        }
        let [phase] = body.phases() else {
            let message = "several materials in one body have no guaranteed bound: only a single one has";
            return Err(none("materials", message));
        };
        let Stiffness::Isotropic(lame) = phase.law.stiffness else {
            let message = "an orthotropic material has no guaranteed bound: only an isotropic one has";
            return Err(none("material.orthotropic", message));
        };
        let mut body_force = [0.0; 2];
        for load in &self.loads {
            let (force, density) = match load {
                LoadSpec::BodyForce(force) => (force, 1.0),
                // The model is built, so that the density exists.
                LoadSpec::Gravity(acceleration) => (acceleration, phase.material().density().unwrap_or_default()),
                _ => continue,
            };
            body_force.iter_mut().zip(force).for_each(|(sum, part)| *sum += density * part);
        }
        let obstacles = model.obstacles().iter().enumerate();
        let mut problem = PlaneProblem {
            lame,
            thickness,
            body_force,
            conditions: Vec::new(),
            obstacles: obstacles
                .map(|(index, obstacle)| facing(index, obstacle, model.gap()))
                .collect::<Result<_, _>>()?,
            boundaries: model.mesh().boundaries().iter().map(|boundary| boundary.name.clone()).collect(),
        };
        let at_body = |error: Error| match error {
            Error::Mesh { message } => none("body", format!("{message}, so that there is no guaranteed bound")),
            other => other.into(),
        };
        let pieces = TrianglePieces::of(model.mesh()).map_err(at_body)?;
        let outline = self.outline(model, &pieces, &mut problem.conditions)?;
        let TrianglePieces { nodes, triangles, elements, .. } = pieces;
        let unmatched = || {
            none("body", "the triangles of the mesh do not meet in whole edges, so that there is no guaranteed bound")
        };
        let mesh = Triangulation::new(nodes, triangles, elements, &outline).ok_or_else(unmatched)?;
        Ok((problem, mesh))
    }

    /// The scene on the last mesh of a guaranteed error, with the boundaries and parts of the first mesh.
    ///
    /// # Errors
    /// As [`Scene::build`].
    pub(crate) fn on_last_mesh(&self, first: &Model, last: &PlaneAnswer) -> Result<Model, Error> {
        let body = first.body();
        let [phase] = body.phases() else { return Err(wrong("materials", "only a single one has a guaranteed bound")) };
        let body = ElasticBody::new(last.mesh()?, *phase.material(), *body.formulation())?;
        // The parts are boundaries of that mesh; to choose them again would move their ends.
        Scene { parts: Vec::new(), ..self.clone() }.build_of(vec![body], &[])
    }

    /// The condition of each edge of the outline.
    fn outline(
        &self,
        model: &Model,
        pieces: &TrianglePieces,
        conditions: &mut Vec<Condition>,
    ) -> Result<HashMap<[usize; 2], usize>, WhyNot> {
        let mut outline = Outline::of(model.mesh(), pieces);
        for (index, support) in self.supports.iter().enumerate() {
            let path = format!("supports[{index}].on");
            let Place::Boundary(name) = &support.on else {
                let message = "a support at a point holds nothing in a continuum, so that there is no guaranteed bound; \
                               hold a boundary";
                return Err(none(path, message));
            };
            if support.profile.is_some() {
                let message =
                    "a displacement that changes along a boundary has no guaranteed bound: only a constant one has";
                return Err(none(format!("supports[{index}].profile"), message));
            }
            for component in self.components(index, support)? {
                let Some(axis) = axis_of(component.direction) else {
                    let message = "an inclined support has no guaranteed bound: only one along x or y has one";
                    return Err(none(format!("supports[{index}].normal"), message));
                };
                let value = component.value * component.direction[axis];
                outline.change(&format!("{path}.boundary"), name, |condition| condition.held[axis] = Some(value))?;
            }
        }
        for (index, load) in self.loads.iter().enumerate() {
            let Some((path, boundary, traction, pressure)) = on_outline(model, index, load)? else { continue };
            outline.change(&path, boundary, |condition| {
                (0..2).for_each(|axis| condition.traction[axis] += traction[axis]);
                condition.pressure += pressure;
            })?;
        }
        for (index, obstacle) in model.obstacles().iter().enumerate() {
            let path = format!("obstacles[{index}].boundary");
            outline.change(&path, obstacle.boundary(), |condition| condition.obstacles.push(index))?;
        }
        for (index, boundary) in model.mesh().boundaries().iter().enumerate() {
            outline.change_outer(&boundary.name, |condition| condition.boundaries.push(index));
        }
        for (name, centre, radius) in self.body.shape().circles() {
            outline.change_outer(name, |condition| condition.circle = Some(Circle { centre, radius }));
        }
        Ok(outline.numbered(conditions))
    }
}

/// Path, boundary, traction and pressure of a load on the outline; `None` for another load.
type OnOutline<'a> = Option<(String, &'a str, Point, f64)>;

/// The traction and pressure of load number `index` on the outline.
///
/// # Errors
/// [`WhyNot::NoGuarantee`] for a load that is not constant.
fn on_outline<'a>(model: &Model, index: usize, load: &'a LoadSpec) -> Result<OnOutline<'a>, WhyNot> {
    let path = |field: &str| format!("loads[{index}].{field}");
    let varies = |field: &str, what: &str| {
        let message =
            format!("{what} has no guaranteed bound: only constant tractions, pressures and body forces have one");
        Err(none(path(field), message))
    };
    let in_plane = |value: &[f64]| [0, 1].map(|axis| value.get(axis).copied().unwrap_or(0.0));
    match load {
        LoadSpec::Traction(TractionSpec { profile: Some(_), .. }) => {
            varies("traction.profile", "a traction that changes along a boundary")
        }
        LoadSpec::Pressure(PressureSpec { profile: Some(_), .. }) => {
            varies("pressure.profile", "a pressure that changes along a boundary")
        }
        LoadSpec::Moment(_) => varies("moment", "the traction of a moment"),
        LoadSpec::NodalForces(_) => varies("nodal-forces", "a force on a node"),
        LoadSpec::Centrifugal(_) => varies("centrifugal", "a force that grows with the distance from an axis"),
        LoadSpec::Traction(spec) => Ok(Some((path("traction.boundary"), &spec.boundary, in_plane(&spec.value), 0.0))),
        LoadSpec::Pressure(spec) => Ok(Some((path("pressure.boundary"), &spec.boundary, [0.0; 2], spec.value))),
        LoadSpec::Force(spec) => {
            let (Some(name), path) = (&spec.boundary, path("force.boundary")) else { return Ok(None) };
            let [x, y] = in_plane(&spec.value);
            let traction = spread(model.body(), boundary(model.mesh(), name, &path)?, [x, y, 0.0], &path)?;
            Ok(Some((path, name, in_plane(&traction), 0.0)))
        }
        LoadSpec::BodyForce(_) | LoadSpec::Gravity(_) => Ok(None),
    }
}

/// The edges that belong to only one triangle, by their nodes, increasing, with the condition of each.
struct Outline<'a> {
    mesh: &'a Mesh,
    pieces: &'a TrianglePieces,
    edges: BTreeMap<[usize; 2], Condition>,
}

impl<'a> Outline<'a> {
    fn of(mesh: &'a Mesh, pieces: &'a TrianglePieces) -> Self {
        let mut triangles_at: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for &[a, b, c] in &pieces.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *triangles_at.entry([from.min(to), from.max(to)]).or_default() += 1;
            }
        }
        let outer = triangles_at.into_iter().filter(|entry| entry.1 == 1);
        Outline { mesh, pieces, edges: outer.map(|(edge, _)| (edge, Condition::default())).collect() }
    }

    /// Changes the condition on each edge of a boundary at a JSON path.
    fn change(&mut self, path: &str, name: &str, change: impl Fn(&mut Condition)) -> Result<(), WhyNot> {
        for edge in self.pieces.edges_of(self.mesh, name) {
            let Some(condition) = self.edges.get_mut(&edge) else {
                let message = format!("`{name}` runs through the body, so that there is no guaranteed bound");
                return Err(none(path, message));
            };
            change(condition);
        }
        Ok(())
    }

    /// Changes the condition on those edges of a boundary that belong to the outline.
    fn change_outer(&mut self, name: &str, change: impl Fn(&mut Condition)) {
        for edge in self.pieces.edges_of(self.mesh, name) {
            self.edges.get_mut(&edge).into_iter().for_each(&change);
        }
    }

    /// The number of the condition of each edge; equal ones have one number.
    fn numbered(self, conditions: &mut Vec<Condition>) -> HashMap<[usize; 2], usize> {
        let mut number = |condition: Condition| {
            conditions.iter().position(|other| *other == condition).unwrap_or_else(|| {
                conditions.push(condition);
                conditions.len() - 1
            })
        };
        self.edges.into_iter().map(|(edge, condition)| (edge, number(condition))).collect()
    }
}

/// The axis of a unit vector, if it lies along one.
fn axis_of(direction: [f64; 3]) -> Option<usize> {
    (0..2).find(|&axis| direction[1 - axis].abs() <= ALONG_AXIS)
}

/// An obstacle with rows along one axis.
fn facing(index: usize, obstacle: &PlacedObstacle, gap: f64) -> Result<Facing, WhyNot> {
    let path = format!("obstacles[{index}]");
    if obstacle.force().is_some() {
        let message = "an obstacle that a force presses has no guaranteed bound: one that stands still has";
        return Err(none(format!("{path}.force"), message));
    }
    match (obstacle.rule(), axis_of(obstacle.approach())) {
        (Some(Rule::Approach), Some(axis)) if obstacle.rigid().is_some() => {
            let (sense, gap) = (obstacle.approach()[axis].signum(), obstacle.shift(gap));
            let surface = Shifted { obstacle: obstacle.clone(), gap };
            Ok(Facing { axis, sense, surface: std::sync::Arc::new(surface) })
        }
        (Some(Rule::ClosestPoint), _) => Err(none(
            format!("{path}.rule"),
            "rows along the normals of an obstacle have no guaranteed bound: rule `approach` has one",
        )),
        _ => Err(none(path, "only the rigid obstacles of a scene have a guaranteed bound")),
    }
}

/// An obstacle of the model at its gap.
#[derive(Debug)]
struct Shifted {
    obstacle: PlacedObstacle,
    gap: f64,
}

impl Distance for Shifted {
    fn gap(&self, from: Point, to: Point) -> Option<Enclosure> {
        let [from, to] = [from, to].map(|[x, y]| [x, y, 0.0]);
        let (values, [below, above]) = self.obstacle.rigid()?.gap_along(from, to, self.gap)?;
        Some(Enclosure { values, below, above })
    }
}
