//! Loads of a scene, at the nodes.

use std::collections::BTreeMap;

use crate::error::Error;
use crate::fem::assembly::{
    add_body_force, add_centrifugal, add_gravity, add_moment, add_pressure, add_traction, add_traction_with_kinks,
    tributary_areas,
};
use crate::fem::{Boundary, ElasticBody, Region};
use crate::scene::input::entry::{
    COORDINATE_ROUNDING, boundary, direction, finite, node_at, nodes_named, vector, wrong,
};
use crate::scene::input::profile::Profile;
use crate::scene::input::schema::condition::{
    CentrifugalSpec, ForceSpec, LoadSpec, MomentSpec, PressureSpec, ProfileSpec, TractionSpec,
};
use crate::scene::input::schema::{ModelSpec, Scene};

/// A load of a scene, checked.
pub enum Acting<'a> {
    /// A traction, in force per area, times a factor over space.
    Traction { boundary: &'a Boundary, traction: [f64; 3], profile: Option<Profile> },
    /// A pressure, in force per area, times a factor over space.
    Pressure { boundary: &'a Boundary, pressure: f64, profile: Option<Profile> },
    /// A force that is spread evenly over the area of a boundary.
    Spread { boundary: &'a Boundary, force: [f64; 3] },
    /// Forces at nodes.
    AtNodes(Vec<(usize, [f64; 3])>),
    /// A moment.
    Moment { boundary: &'a Boundary, moment: [f64; 3] },
    /// A force per volume.
    BodyForce([f64; 3]),
    /// An acceleration of bodies that all have a density.
    Gravity([f64; 3]),
    /// A rotation by `omega` about an axis, a unit vector and a point, of bodies that all have a density.
    Centrifugal { omega: f64, axis: ([f64; 3], [f64; 3]) },
}

pub(crate) fn load(scene: &Scene, body: &ElasticBody) -> Result<Vec<f64>, Error> {
    let mut load = vec![0.0; body.nodal_dofs()];
    for index in 0..scene.loads.len() {
        add_load(scene, body, index, &mut load)?;
    }
    match load.iter().all(|value| value.is_finite()) {
        true => Ok(load),
        false => Err(wrong("loads", "the loads add up to a force that is not finite")),
    }
}

/// Adds load number `index` to the nodal load.
pub(crate) fn add_load(scene: &Scene, body: &ElasticBody, index: usize, load: &mut [f64]) -> Result<(), Error> {
    match acting(scene, body, index)? {
        Acting::Traction { boundary, traction, profile: None } => add_traction(body, boundary, traction, load),
        Acting::Traction { boundary, traction, profile: Some(profile) } => {
            let field = |at, _| traction.map(|component| profile.at(at) * component);
            add_traction_with_kinks(body, boundary, profile.kinks(), field, load);
        }
        Acting::Pressure { boundary, pressure, profile: None } => add_pressure(body, boundary, pressure, load),
        Acting::Pressure { boundary, pressure, profile: Some(profile) } => {
            let field = |at, normal: [f64; 3]| normal.map(|component| -pressure * profile.at(at) * component);
            add_traction_with_kinks(body, boundary, profile.kinks(), field, load);
        }
        Acting::Spread { boundary, force } => {
            let path = format!("loads[{index}].force.boundary");
            add_traction(body, boundary, spread(body, boundary, force, &path)?, load);
        }
        Acting::AtNodes(forces) => {
            let dimension = body.dimension();
            for (node, force) in forces {
                let entries = &mut load[dimension * node..dimension * (node + 1)];
                entries.iter_mut().zip(force).for_each(|(entry, component)| *entry += component);
            }
        }
        Acting::Moment { boundary, moment } => add_moment(body, boundary, moment, load).ok_or_else(|| {
            let name = &boundary.name;
            let message = format!(
                "no turning traction on `{name}` has this moment: its facets lie on a straight line, or its size is \
                 not finite"
            );
            wrong(format!("loads[{index}].moment.boundary"), message)
        })?,
        Acting::BodyForce(force) => add_body_force(body, force, load),
        Acting::Gravity(acceleration) => add_gravity(body, acceleration, load)?,
        Acting::Centrifugal { omega, axis } => add_centrifugal(body, omega, axis, load)?,
    }
    Ok(())
}

/// Load number `index` on a body.
pub fn acting<'a>(scene: &Scene, body: &'a ElasticBody, index: usize) -> Result<Acting<'a>, Error> {
    let placed = |kind: &str| PlacedLoad { body, path: format!("loads[{index}].{kind}"), model: scene.model };
    match &scene.loads[index] {
        LoadSpec::Traction(spec) => placed("traction").traction(spec),
        LoadSpec::Pressure(spec) => placed("pressure").pressure(spec),
        LoadSpec::Force(spec) => placed("force").force(spec),
        LoadSpec::NodalForces(forces) => placed("nodal-forces").nodal(forces),
        LoadSpec::Moment(spec) => placed("moment").moment(spec),
        LoadSpec::BodyForce(value) => Ok(Acting::BodyForce(placed("body-force").vector("", value)?)),
        LoadSpec::Gravity(value) => {
            let placed = placed("gravity");
            let acceleration = placed.vector("", value)?;
            placed.check_density()?;
            Ok(Acting::Gravity(acceleration))
        }
        LoadSpec::Centrifugal(spec) => placed("centrifugal").centrifugal(spec),
    }
}

/// The constant traction of a force on a boundary, in force per area.
pub fn spread(body: &ElasticBody, boundary: &Boundary, force: [f64; 3], path: &str) -> Result<[f64; 3], Error> {
    let area: f64 = tributary_areas(body, boundary).into_iter().map(|(_, area)| area).sum();
    let largest = body.mesh().size().powi(2);
    if body.formulation().is_axisymmetric() && area <= COORDINATE_ROUNDING * largest {
        let message = format!("`{}` lies on the axis and has no area that could carry a force", boundary.name);
        return Err(wrong(path, message));
    }
    Ok(force.map(|component| component / area))
}

/// A load at its JSON path, with the bodies.
struct PlacedLoad<'a> {
    body: &'a ElasticBody,
    path: String,
    model: ModelSpec,
}

impl<'a> PlacedLoad<'a> {
    fn at(&self, field: &str) -> String {
        if field.is_empty() { self.path.clone() } else { format!("{}.{field}", self.path) }
    }

    fn vector(&self, field: &str, entries: &[f64]) -> Result<[f64; 3], Error> {
        vector(&self.at(field), entries, self.body.dimension())
    }

    fn boundary(&self, name: &str) -> Result<&'a Boundary, Error> {
        boundary(self.body.mesh(), name, &self.at("boundary"))
    }

    fn profile(&self, spec: Option<&ProfileSpec>) -> Result<Option<Profile>, Error> {
        spec.map(|spec| Profile::of(spec, &self.at("profile"), self.body.dimension())).transpose()
    }

    fn traction(&self, spec: &TractionSpec) -> Result<Acting<'a>, Error> {
        let boundary = self.boundary(&spec.boundary)?;
        let traction = self.vector("value", &spec.value)?;
        Ok(Acting::Traction { boundary, traction, profile: self.profile(spec.profile.as_ref())? })
    }

    fn pressure(&self, spec: &PressureSpec) -> Result<Acting<'a>, Error> {
        let boundary = self.boundary(&spec.boundary)?;
        finite(self.at("value"), spec.value)?;
        Ok(Acting::Pressure { boundary, pressure: spec.value, profile: self.profile(spec.profile.as_ref())? })
    }

    fn force(&self, spec: &ForceSpec) -> Result<Acting<'a>, Error> {
        match (&spec.at, &spec.boundary) {
            (Some(at), None) => {
                let node = node_at(self.body.mesh(), at, &self.at("at"))?;
                Ok(Acting::AtNodes(vec![(node, self.vector("value", &spec.value)?)]))
            }
            (None, Some(name)) => {
                let boundary = self.boundary(name)?;
                Ok(Acting::Spread { boundary, force: self.vector("value", &spec.value)? })
            }
            (None, None) => Err(wrong(&*self.path, "acts nowhere; give `at`, a point, or a `boundary`")),
            (Some(_), Some(_)) => Err(wrong(&*self.path, "acts at a point and on a boundary; give only one")),
        }
    }

    fn nodal(&self, forces: &BTreeMap<String, Vec<f64>>) -> Result<Acting<'a>, Error> {
        if forces.is_empty() {
            return Err(wrong(
                &*self.path,
                "acts nowhere; give a set of nodes, or the number of a node, with its force",
            ));
        }
        let mut at_nodes = Vec::new();
        for (name, force) in forces {
            let nodes = nodes_named(self.body.mesh(), name, &self.at(name))?;
            let force = self.vector(name, force)?;
            at_nodes.extend(nodes.into_iter().map(|node| (node, force)));
        }
        Ok(Acting::AtNodes(at_nodes))
    }

    fn moment(&self, spec: &MomentSpec) -> Result<Acting<'a>, Error> {
        if spec.at.is_some() {
            let message = "a node of a solid has no rotation and carries no moment; give a `boundary`, over which a traction turns";
            return Err(wrong(self.at("at"), message));
        }
        let Some(name) = &spec.boundary else { return Err(wrong(&*self.path, "acts nowhere; give a `boundary`")) };
        let boundary = self.boundary(name)?;
        let carries = match self.model {
            ModelSpec::Bar | ModelSpec::Axisymmetric => 0,
            ModelSpec::PlaneStrain | ModelSpec::PlaneStress => 1,
            ModelSpec::Space => 3,
        };
        if carries == 0 {
            let message = format!("the model `{}` carries no moment: it has no rotation", self.model.name());
            return Err(wrong(&*self.path, message));
        }
        if spec.value.len() != carries {
            let (found, names) = (spec.value.len(), if carries == 1 { "[m], about z" } else { "[m_x, m_y, m_z]" });
            let message = format!("the array has {found} entries; in this model it has {carries}: {names}");
            return Err(wrong(self.at("value"), message));
        }
        let mut moment = [0.0; 3];
        for (index, (place, &entry)) in moment[3 - carries..].iter_mut().zip(&spec.value).enumerate() {
            finite(format!("{}[{index}]", self.at("value")), entry)?;
            *place = entry;
        }
        Ok(Acting::Moment { boundary, moment })
    }

    fn centrifugal(&self, spec: &CentrifugalSpec) -> Result<Acting<'a>, Error> {
        finite(self.at("omega"), spec.omega)?;
        let given = spec.axis.as_ref().filter(|_| self.model == ModelSpec::Space);
        let axis = match (self.model, given) {
            (ModelSpec::Space, Some(axis)) => direction(&self.at("axis"), axis, self.body.dimension())?,
            (ModelSpec::Space, None) => return Err(wrong(&*self.path, "in space it needs an `axis`; give it")),
            (model, _) if spec.axis.is_some() => {
                let message = format!("the model `{}` has one axis of rotation; leave it out", model.name());
                return Err(wrong(self.at("axis"), message));
            }
            (ModelSpec::Axisymmetric, _) => [0.0, 1.0, 0.0],
            _ => [0.0, 0.0, 1.0],
        };
        let point = match &spec.point {
            Some(_) if self.model == ModelSpec::Axisymmetric => {
                return Err(wrong(self.at("point"), "the axis of an axisymmetric model is x = 0; leave the point out"));
            }
            Some(point) => self.vector("point", point)?,
            None => [0.0; 3],
        };
        self.check_density()?;
        Ok(Acting::Centrifugal { omega: spec.omega, axis: (axis, point) })
    }

    fn check_density(&self) -> Result<(), Error> {
        let lacks = |region: &Region| self.body.materials(region).any(|material| material.density().is_none());
        let without = self.body.regions().iter().position(lacks);
        let place = match without {
            None => return Ok(()),
            Some(0) => String::new(),
            Some(body) => format!("further-bodies[{}].", body - 1),
        };
        Err(wrong(format!("{place}material"), format!("{} needs a `density`; give it", self.path)))
    }
}
