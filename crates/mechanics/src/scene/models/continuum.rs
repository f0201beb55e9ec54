//! The contact problem of the continuum that a scene describes, before any mesh.

use std::collections::{BTreeMap, HashMap};

use super::load::spread;
use crate::continuum::{
    Circle, Condition, ContinuumAnswer, ContinuumProblem, Distance, Enclosure, Facing, Point, SimplexMesh,
};
use crate::error::Error;
use crate::fem::material::Stiffness;
use crate::fem::mesh::pieces::Pieces;
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

/// Why there is no problem of the continuum: an answer to the question for a guarantee, or a failure, which answers nothing.
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

    /// Asks for a guaranteed bound: the problem of the polygon or polyhedron that the mesh of `model` fills and the initial simplices, or
    /// why not.
    pub(crate) fn continuum_problem(&self, model: &Model) -> Result<(ContinuumProblem, SimplexMesh), WhyNot> {
        let body = model.body();
        let formulation = *body.formulation();
        let thickness = match formulation {
            Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness } => thickness,
            Formulation::Space => 1.0,
            _ => {
                let name = formulation.name();
                let message =
                    format!("{name} has no guaranteed bound: only plane strain, plane stress and space have one");
                return Err(none("model", message));
            }
        };
        for (field, is_there) in [
            ("springs", !self.springs.is_empty()),
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
        let mut body_force = [0.0; 3];
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
        let dimension = model.mesh().dimension();
        let mut problem = ContinuumProblem {
            dimension,
            lame,
            thickness,
            body_force,
            conditions: Vec::new(),
            obstacles: obstacles
                .map(|(index, obstacle)| facing(dimension, index, obstacle, model.gap()))
                .collect::<Result<_, _>>()?,
            boundaries: model.mesh().boundaries().iter().map(|boundary| boundary.name.clone()).collect(),
        };
        let at_body = |error: Error| match error {
            Error::Mesh { message } => none("body", format!("{message}, so that there is no guaranteed bound")),
            other => other.into(),
        };
        let pieces = Pieces::of(model.mesh()).map_err(at_body)?;
        let surface = self.surface(model, &pieces, &mut problem.conditions)?;
        let Pieces { nodes, cells, elements, .. } = pieces;
        let unmatched = || {
            let message = match dimension {
                2 => "the triangles of the mesh do not meet in whole edges, so that there is no guaranteed bound",
                _ => {
                    "the cells of the mesh, cut into tetrahedra, do not meet in whole faces, so that there is no guaranteed bound"
                }
            };
            none("body", message)
        };
        let mesh = SimplexMesh::new(dimension, nodes, &cells, elements, &surface).ok_or_else(unmatched)?;
        for (outer, obstacle) in problem.facing(&mesh) {
            let gap = problem.obstacles[obstacle].surface.gap(&mesh.corners_of_facet(outer.facet));
            if gap.is_some_and(|gap| gap.below.is_infinite()) {
                let message = "the distance to a surface of this shape has no bounds between nodes, so that there is no guaranteed bound";
                return Err(none(format!("obstacles[{obstacle}].shape"), message));
            }
        }
        Ok((problem, mesh))
    }

    /// The scene on the last mesh of a guaranteed error, with the boundaries and parts of the first mesh.
    ///
    /// # Errors
    /// As [`Scene::build`].
    pub(crate) fn on_last_mesh(&self, first: &Model, last: &ContinuumAnswer) -> Result<Model, Error> {
        let body = first.body();
        let [phase] = body.phases() else { return Err(wrong("materials", "only a single one has a guaranteed bound")) };
        let body = ElasticBody::new(last.mesh()?, *phase.material(), *body.formulation())?;
        // The parts are boundaries of that mesh; to choose them again would move their ends.
        Scene { parts: Vec::new(), ..self.clone() }.build_of(vec![body], &[])
    }

    /// The condition of each facet of the surface, by its nodes.
    fn surface(
        &self,
        model: &Model,
        pieces: &Pieces,
        conditions: &mut Vec<Condition>,
    ) -> Result<HashMap<Vec<usize>, usize>, WhyNot> {
        let dimension = model.mesh().dimension();
        let mut surface = Surface::of(model.mesh(), pieces);
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
                let Some(axis) = axis_of(dimension, component.direction) else {
                    let axes = if dimension == 2 { "x or y" } else { "x, y or z" };
                    let message = format!("an inclined support has no guaranteed bound: only one along {axes} has one");
                    return Err(none(format!("supports[{index}].normal"), message));
                };
                let value = component.value * component.direction[axis];
                surface.change(&format!("{path}.boundary"), name, |condition| condition.held[axis] = Some(value))?;
            }
        }
        surface.change_on_planes(|at| model.axes_of_symmetry(at));
        for (index, load) in self.loads.iter().enumerate() {
            let Some((path, boundary, traction, pressure)) = on_surface(model, index, load)? else { continue };
            surface.change(&path, boundary, |condition| {
                (0..3).for_each(|axis| condition.traction[axis] += traction[axis]);
                condition.pressure += pressure;
            })?;
        }
        for (index, obstacle) in model.obstacles().iter().enumerate() {
            let path = format!("obstacles[{index}].boundary");
            surface.change(&path, obstacle.boundary(), |condition| condition.obstacles.push(index))?;
        }
        for (index, boundary) in model.mesh().boundaries().iter().enumerate() {
            surface.change_outer(&boundary.name, |condition| condition.boundaries.push(index));
        }
        for (name, centre, radius) in self.body.shape().circles() {
            surface.change_outer(name, |condition| {
                let [x, y] = centre;
                condition.circle = Some(Circle { centre: [x, y, 0.0], radius });
            });
        }
        Ok(surface.numbered(conditions))
    }
}

/// Path, boundary, traction and pressure of a load on the surface; `None` for another load.
type OnSurface<'a> = Option<(String, &'a str, Point, f64)>;

/// The traction and pressure of load number `index` on the surface.
///
/// # Errors
/// [`WhyNot::NoGuarantee`] for a load that is not constant.
fn on_surface<'a>(model: &Model, index: usize, load: &'a LoadSpec) -> Result<OnSurface<'a>, WhyNot> {
    let path = |field: &str| format!("loads[{index}].{field}");
    let varies = |field: &str, what: &str| {
        let message =
            format!("{what} has no guaranteed bound: only constant tractions, pressures and body forces have one");
        Err(none(path(field), message))
    };
    let in_space = |value: &[f64]| [0, 1, 2].map(|axis| value.get(axis).copied().unwrap_or(0.0));
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
        LoadSpec::Traction(spec) => Ok(Some((path("traction.boundary"), &spec.boundary, in_space(&spec.value), 0.0))),
        LoadSpec::Pressure(spec) => Ok(Some((path("pressure.boundary"), &spec.boundary, [0.0; 3], spec.value))),
        LoadSpec::Force(spec) => {
            let (Some(name), path) = (&spec.boundary, path("force.boundary")) else { return Ok(None) };
            let traction = spread(model.body(), boundary(model.mesh(), name, &path)?, in_space(&spec.value), &path)?;
            Ok(Some((path, name, traction, 0.0)))
        }
        LoadSpec::BodyForce(_) | LoadSpec::Gravity(_) => Ok(None),
    }
}

/// The facets of the pieces of a mesh, by their nodes, increasing: those of one piece with their condition, those inside with none.
struct Surface<'a> {
    mesh: &'a Mesh,
    pieces: &'a Pieces,
    facets: BTreeMap<Vec<usize>, Option<Condition>>,
}

impl<'a> Surface<'a> {
    fn of(mesh: &'a Mesh, pieces: &'a Pieces) -> Self {
        let mut facets = BTreeMap::new();
        for facet in pieces.facets() {
            facets.entry(facet).and_modify(|condition| *condition = None).or_insert(Some(Condition::default()));
        }
        Surface { mesh, pieces, facets }
    }

    /// Changes the condition on each facet of a boundary at a JSON path.
    fn change(&mut self, path: &str, name: &str, change: impl Fn(&mut Condition)) -> Result<(), WhyNot> {
        for facet in self.pieces.facets_of(self.mesh, name) {
            match self.facets.get_mut(&facet) {
                Some(Some(condition)) => change(condition),
                Some(None) => {
                    let message = format!("`{name}` runs through the body, so that there is no guaranteed bound");
                    return Err(none(path, message));
                }
                // A facet of the other diagonal.
                None => {}
            }
        }
        Ok(())
    }

    /// Changes the condition on those facets of a boundary that belong to the surface.
    fn change_outer(&mut self, name: &str, change: impl Fn(&mut Condition)) {
        for facet in self.pieces.facets_of(self.mesh, name) {
            self.facets.get_mut(&facet).into_iter().flatten().for_each(&change);
        }
    }

    /// Holds the facets on planes of symmetry along the normals; `axes` says across which axes a place lies on a plane.
    fn change_on_planes(&mut self, axes: impl Fn(&Point) -> [bool; 3]) {
        for (facet, condition) in &mut self.facets {
            let Some(condition) = condition else { continue };
            let of_corners: Vec<_> = facet.iter().map(|&node| axes(&self.pieces.nodes[node])).collect();
            for axis in (0..3).filter(|&axis| of_corners.iter().all(|axes| axes[axis])) {
                condition.held[axis] = Some(0.0);
            }
        }
    }

    /// The number of the condition of each facet of the surface; equal ones have one number.
    fn numbered(self, conditions: &mut Vec<Condition>) -> HashMap<Vec<usize>, usize> {
        let mut number = |condition: Condition| {
            conditions.iter().position(|other| *other == condition).unwrap_or_else(|| {
                conditions.push(condition);
                conditions.len() - 1
            })
        };
        self.facets.into_iter().filter_map(|(facet, condition)| Some((facet, number(condition?)))).collect()
    }
}

/// The axis of a unit vector, if it lies along one.
fn axis_of(dimension: usize, direction: [f64; 3]) -> Option<usize> {
    let is_across = |axis: usize| (0..3).all(|other| other == axis || direction[other].abs() <= ALONG_AXIS);
    (0..dimension).find(|&axis| is_across(axis))
}

/// An obstacle with rows along one axis.
fn facing(dimension: usize, index: usize, obstacle: &PlacedObstacle, gap: f64) -> Result<Facing, WhyNot> {
    let path = format!("obstacles[{index}]");
    if obstacle.force().is_some() {
        let message = "an obstacle that a force presses has no guaranteed bound: one that stands still has";
        return Err(none(format!("{path}.force"), message));
    }
    match (obstacle.rule(), axis_of(dimension, obstacle.approach())) {
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
    fn gap(&self, corners: &[Point]) -> Option<Enclosure> {
        let rigid = self.obstacle.rigid()?;
        match *corners {
            [from, to] => {
                let ([first, middle, last], [below, above]) = rigid.gap_along(from, to, self.gap)?;
                let coefficients = vec![first, last, 2.0 * middle - (first + last) / 2.0];
                Some(Enclosure { coefficients, below, above })
            }
            [first, second, third] => {
                let (coefficients, [below, above]) = rigid.gap_over([first, second, third], self.gap)?;
                Some(Enclosure { coefficients: coefficients.to_vec(), below, above })
            }
            _ => None,
        }
    }
}
