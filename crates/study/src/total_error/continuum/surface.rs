//! The conditions on the facets of a contact problem of the continuum.

use std::collections::{BTreeMap, HashMap};

use signorini_fem::Mesh;
use signorini_fem::assembly::turning_traction;
use signorini_fem::geometry::{COORDINATES, cross, dot, minus, sorted, unit};
use signorini_fem::mesh::pieces::Pieces;
use signorini_guarantee::{Circle, Condition, Held, Linear, Point};
use signorini_mechanics::Error;
use signorini_mechanics::scene::Model;
use signorini_mechanics::scene::input::profile::Profile;
use signorini_mechanics::scene::input::schema::{PlaceSpec, Scene, TieSpec, TiedSurfacesSpec};
use signorini_mechanics::scene::models::load::{Acting, acting, spread};

/// A kink of a profile lies at a corner of a facet if it does up to this share of the facet.
const AT_A_CORNER: f64 = 1e-9;

/// The conditions, and the number of that of each facet with one, by its nodes.
pub(super) fn conditions(
    scene: &Scene,
    model: &Model,
    pieces: &Pieces,
    conditions: &mut Vec<Condition>,
) -> Result<HashMap<Vec<usize>, usize>, WhyNot> {
    let mut surface = Surface::of(model.mesh(), pieces);
    add_supports(model, &mut surface)?;
    surface.change_on_planes(|at| model.parts.conditions.symmetry.axes_at(at));
    for (index, face) in scene.rigid_faces.iter().enumerate() {
        let path = format!("rigid-faces[{index}]");
        let Some(name) = &face.boundary else {
            let message = "single nodes that move as a rigid body have no guaranteed bound: only a boundary has one";
            return Err(none(format!("{path}.nodes"), message));
        };
        surface.change(name, |condition, _| {
            condition.rigid_face = Some(index);
            Ok(())
        })?;
    }
    for (index, springs) in scene.springs.iter().enumerate() {
        let path = format!("springs[{index}]");
        let per_area = model.parts.conditions.springs[index].per_area;
        let (Some(PlaceSpec::Boundary(name)), Some((along, normal))) = (&springs.on, per_area) else {
            let message = "a spring at a point holds nothing in a continuum, so that there is no guaranteed bound; spread it \
                           over a boundary";
            return Err(none(if springs.on.is_some() { format!("{path}.on") } else { path }, message));
        };
        surface.change(name, |condition, _| {
            (0..3).for_each(|axis| condition.springs.along[axis] += along[axis]);
            condition.springs.normal += normal;
            Ok(())
        })?;
    }
    for index in 0..scene.loads.len() {
        add_load_on_surface(scene, model, index, &mut surface)?;
    }
    for (index, obstacle) in model.obstacles().iter().enumerate() {
        let name = obstacle.boundary();
        surface.change(name, |condition, facet| match facet.inner_normal {
            None => {
                condition.obstacles.push(index);
                Ok(())
            }
            Some(_) => {
                let message = format!("`{name}` runs through the body, so that there is no guaranteed bound");
                Err(none(format!("obstacles[{index}].boundary"), message))
            }
        })?;
        if let Some((other, _)) = obstacle.other_body() {
            surface.change_known(other, |condition| condition.faces.push(index));
        }
    }
    for (index, tie) in scene.ties.iter().enumerate() {
        let TieSpec::Surfaces(TiedSurfacesSpec { boundary, to, .. }) = tie else {
            let message = "only tied surfaces have a guaranteed bound, not equations of nodes and no preload";
            return Err(none(format!("ties[{index}]"), message));
        };
        for (side, name) in [boundary, to].into_iter().enumerate() {
            surface.change_known(name, |condition| condition.seams.push(2 * index + side));
        }
    }
    for (index, boundary) in model.mesh().boundaries().iter().enumerate() {
        surface.change_known(&boundary.name, |condition| condition.boundaries.push(index));
    }
    // Edges of two bodies that lie opposite to each other stay so only if they are straight.
    let circles = if scene.further_bodies.is_empty() { scene.body.circles() } else { Vec::new() };
    for (name, centre, radius) in circles {
        surface.change_known(name, |condition| {
            let [x, y] = centre;
            condition.circle = Some(Circle { centre: [x, y, 0.0], radius });
        });
    }
    Ok(surface.numbered(conditions))
}

fn add_supports(model: &Model, surface: &mut Surface) -> Result<(), WhyNot> {
    for (index, support) in model.parts.conditions.held.supports.iter().enumerate() {
        let Some(name) = &support.boundary else {
            let message = "a support at a point holds nothing in a continuum, so that there is no guaranteed bound; \
                           hold a boundary";
            return Err(none(format!("supports[{index}].on"), message));
        };
        let (profile, path) = (support.profile.clone(), format!("supports[{index}].profile"));
        let factor = Factor { counts_radius: false, profile, path };
        surface.change(name, |condition, facet| {
            let factor = factor.on(facet)?;
            let components = support.components.iter();
            condition
                .held
                .extend(components.map(|one| Held { direction: one.direction, value: factor.times(one.value) }));
            Ok(())
        })?;
    }
    Ok(())
}

/// Adds load number `index`, if it acts on facets.
fn add_load_on_surface(scene: &Scene, model: &Model, index: usize, surface: &mut Surface) -> Result<(), WhyNot> {
    let path = |field: &str| format!("loads[{index}].{field}");
    let counts_radius = model.body().formulation().is_axisymmetric();
    match acting(scene, model.body(), index)? {
        Acting::Traction { boundary, traction, profile } => {
            let factor = Factor { counts_radius, profile, path: path("traction.profile") };
            surface.change(&boundary.name, |condition, facet| {
                let factor = factor.on(facet)?;
                condition.pull_along(traction.map(|component| factor.times(component)));
                Ok(())
            })
        }
        Acting::Pressure { boundary, pressure, profile } => {
            let factor = Factor { counts_radius, profile, path: path("pressure.profile") };
            surface.change(&boundary.name, |condition, facet| {
                let pressure = factor.on(facet)?.times(pressure);
                match facet.inner_normal {
                    Some(normal) => condition.pull_along(normal.map(|part| pressure.times(-part))),
                    None => condition.pressure = condition.pressure.plus(pressure),
                }
                Ok(())
            })
        }
        Acting::Spread { boundary, force } => {
            let traction = spread(model.body(), boundary, force, &path("force.boundary"))?;
            surface.change(&boundary.name, |condition, _| {
                condition.pull_along(traction.map(Linear::constant));
                Ok(())
            })
        }
        Acting::Moment { boundary, moment } => {
            // The model is built, so that there is one.
            let Some((omega, centre)) = turning_traction(model.body(), boundary, moment) else { return Ok(()) };
            let along = |axis: usize| Linear::of(|place| cross(omega, minus(place, centre))[axis]);
            surface.change(&boundary.name, |condition, _| {
                condition.pull_along([0, 1, 2].map(along));
                Ok(())
            })
        }
        Acting::AtNodes(_) => Err(none(
            path("nodal-forces"),
            "a force on a node has no guaranteed bound: only loads on boundaries have one",
        )),
        Acting::BodyForce(_) | Acting::Gravity(_) | Acting::Centrifugal { .. } => Ok(()),
    }
}

/// A factor that may change along a boundary, with its JSON path.
struct Factor {
    /// It is that of a load about an axis.
    counts_radius: bool,
    profile: Option<Profile>,
    path: String,
}

impl Factor {
    fn on(&self, facet: &Facet) -> Result<Linear, WhyNot> {
        let Some(profile) = &self.profile else { return Ok(Linear::constant(1.0)) };
        if self.counts_radius && facet.corners.iter().any(|corner| corner[0] != facet.corners[0][0]) {
            let message = "a load that changes along an edge whose radius changes has no guaranteed bound: their product is not linear";
            return Err(none(&*self.path, message));
        }
        let kinks = profile.kinks();
        let along = facet.corners.iter().map(|&corner| (dot(kinks.along, corner), corner));
        let ends = along.clone().min_by(|a, b| a.0.total_cmp(&b.0)).zip(along.max_by(|a, b| a.0.total_cmp(&b.0)));
        let Some(((low, first), (high, last))) = ends else { return Ok(Linear::constant(1.0)) };
        let margin = AT_A_CORNER * (high - low);
        if kinks.at.iter().any(|&kink| low + margin < kink && kink < high - margin) {
            let message = "a profile with a kink inside an edge of the mesh has no guaranteed bound: place nodes of the mesh at the kinks";
            return Err(none(&*self.path, message));
        }
        let [at_low, at_high] = [first, last].map(|corner| profile.at(corner));
        if high - low <= f64::EPSILON * low.abs().max(high.abs()) {
            return Ok(Linear::constant(at_low));
        }
        let steepness = (at_high - at_low) / (high - low);
        Ok(Linear { at_origin: at_low - steepness * low, slope: kinks.along.map(|part| steepness * part) })
    }
}

struct Facet {
    corners: Vec<Point>,
    /// Inside the body, the normal of the boundary.
    inner_normal: Option<Point>,
}

/// The facets of the pieces of a mesh, by their nodes, increasing.
struct Surface<'a> {
    mesh: &'a Mesh,
    pieces: &'a Pieces,
    facets: BTreeMap<Vec<usize>, Entry>,
}

/// The condition of a facet; inside the body it is there once a boundary of the scene runs through the facet.
struct Entry {
    is_inner: bool,
    condition: Option<Condition>,
}

impl<'a> Surface<'a> {
    fn of(mesh: &'a Mesh, pieces: &'a Pieces) -> Self {
        let mut facets = BTreeMap::new();
        for facet in pieces.facets() {
            let inner = |entry: &mut Entry| *entry = Entry { is_inner: true, condition: None };
            facets
                .entry(facet)
                .and_modify(inner)
                .or_insert(Entry { is_inner: false, condition: Some(Condition::default()) });
        }
        Surface { mesh, pieces, facets }
    }

    /// Changes the condition on each facet of a boundary.
    fn change(
        &mut self,
        name: &str,
        mut change: impl FnMut(&mut Condition, &Facet) -> Result<(), WhyNot>,
    ) -> Result<(), WhyNot> {
        for nodes in self.pieces.facets_of(self.mesh, name) {
            // A facet of the other diagonal is missing.
            let Some(entry) = self.facets.get_mut(&sorted(nodes.iter().copied())) else { continue };
            let corners: Vec<Point> = nodes.iter().map(|&node| self.pieces.nodes[node]).collect();
            let inner_normal = entry.is_inner.then(|| normal(&corners));
            change(entry.condition.get_or_insert_default(), &Facet { corners, inner_normal })?;
        }
        Ok(())
    }

    /// Changes the condition on those facets of a boundary that have one.
    fn change_known(&mut self, name: &str, change: impl Fn(&mut Condition)) {
        for facet in self.pieces.facets_of(self.mesh, name) {
            let entry = self.facets.get_mut(&sorted(facet));
            entry.and_then(|entry| entry.condition.as_mut()).into_iter().for_each(&change);
        }
    }

    /// Holds the facets on planes of symmetry along the normals; `axes` says across which axes a place lies on a plane.
    fn change_on_planes(&mut self, axes: impl Fn(&Point) -> [bool; 3]) {
        for (facet, entry) in self.facets.iter_mut().filter(|facet| !facet.1.is_inner) {
            let Some(condition) = &mut entry.condition else { continue };
            let of_corners: Vec<_> = facet.iter().map(|&node| axes(&self.pieces.nodes[node])).collect();
            for axis in (0..3).filter(|&axis| of_corners.iter().all(|axes| axes[axis])) {
                condition.held.push(Held { direction: COORDINATES[axis], value: Linear::default() });
            }
        }
    }

    /// The number of the condition of each facet with one; equal ones have one number.
    fn numbered(self, conditions: &mut Vec<Condition>) -> HashMap<Vec<usize>, usize> {
        let mut number = |condition: Condition| {
            conditions.iter().position(|other| *other == condition).unwrap_or_else(|| {
                conditions.push(condition);
                conditions.len() - 1
            })
        };
        let facets = self.facets.into_iter();
        facets.filter_map(|(facet, entry)| Some((facet, number(entry.condition?)))).collect()
    }
}

/// The unit normal of a facet with its corners in the order of its boundary.
fn normal(corners: &[Point]) -> Point {
    match *corners {
        [from, to] => unit(cross(minus(to, from), COORDINATES[2])),
        [a, b, c, ..] => unit(cross(minus(b, a), minus(c, a))),
        _ => [0.0; 3],
    }
}

/// What of a scene has no guaranteed bound, and what would have one.
#[derive(Clone, Debug, PartialEq)]
pub struct NoGuarantee {
    /// JSON path of what has none.
    pub path: String,
    pub message: String,
}

/// Why there is no problem of the continuum: an answer to the question for a guarantee, or a failure, which answers
/// nothing.
#[derive(Debug)]
pub enum WhyNot {
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

pub(crate) fn none(path: impl Into<String>, message: impl Into<String>) -> WhyNot {
    WhyNot::NoGuarantee(NoGuarantee { path: path.into(), message: message.into() })
}
