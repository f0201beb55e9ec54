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
use crate::scene::input::schema::load::{CentrifugalSpec, ForceSpec, LoadSpec, MomentSpec, PressureSpec, TractionSpec};
use crate::scene::input::schema::profile::ProfileSpec;
use crate::scene::input::schema::{ModelSpec, Scene};

impl Scene {
    pub(crate) fn load(&self, body: &ElasticBody) -> Result<Vec<f64>, Error> {
        let mut load = vec![0.0; body.nodal_dofs()];
        for index in 0..self.loads.len() {
            self.add_load(body, index, &mut load)?;
        }
        match load.iter().all(|value| value.is_finite()) {
            true => Ok(load),
            false => Err(wrong("loads", "the loads add up to a force that is not finite")),
        }
    }

    /// Adds load number `index` to the nodal load.
    pub(crate) fn add_load(&self, body: &ElasticBody, index: usize, load: &mut [f64]) -> Result<(), Error> {
        let placed = |kind: &str| PlacedLoad { body, path: format!("loads[{index}].{kind}"), model: self.model };
        match &self.loads[index] {
            LoadSpec::Traction(spec) => placed("traction").add_traction(spec, load),
            LoadSpec::Pressure(spec) => placed("pressure").add_pressure(spec, load),
            LoadSpec::Force(spec) => placed("force").add_force(spec, load),
            LoadSpec::NodalForces(forces) => placed("nodal-forces").add_nodal(forces, load),
            LoadSpec::Moment(spec) => placed("moment").add_moment(spec, load),
            LoadSpec::BodyForce(value) => {
                let placed = placed("body-force");
                add_body_force(body, placed.vector("", value)?, load);
                Ok(())
            }
            LoadSpec::Gravity(value) => {
                let placed = placed("gravity");
                let acceleration = placed.vector("", value)?;
                placed.check_density()?;
                add_gravity(body, acceleration, load)
            }
            LoadSpec::Centrifugal(spec) => placed("centrifugal").add_centrifugal(spec, load),
        }
    }
}

/// The constant traction of a force on a boundary, in force per area.
///
/// # Errors
/// [`Error::Scene`] at the JSON path of the boundary if its area is zero.
pub(crate) fn spread(body: &ElasticBody, boundary: &Boundary, force: [f64; 3], path: &str) -> Result<[f64; 3], Error> {
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

impl PlacedLoad<'_> {
    fn at(&self, field: &str) -> String {
        if field.is_empty() { self.path.clone() } else { format!("{}.{field}", self.path) }
    }

    fn vector(&self, field: &str, entries: &[f64]) -> Result<[f64; 3], Error> {
        vector(&self.at(field), entries, self.body.dimension())
    }

    fn boundary(&self, name: &str) -> Result<&Boundary, Error> {
        boundary(self.body.mesh(), name, &self.at("boundary"))
    }

    fn profile(&self, spec: Option<&ProfileSpec>) -> Result<Option<Profile>, Error> {
        spec.map(|spec| Profile::of(spec, &self.at("profile"), self.body.dimension())).transpose()
    }

    fn add_traction(&self, spec: &TractionSpec, load: &mut [f64]) -> Result<(), Error> {
        let boundary = self.boundary(&spec.boundary)?;
        let traction = self.vector("value", &spec.value)?;
        match self.profile(spec.profile.as_ref())? {
            None => add_traction(self.body, boundary, traction, load),
            Some(profile) => {
                let field = |at, _| traction.map(|component| profile.at(at) * component);
                add_traction_with_kinks(self.body, boundary, profile.kinks(), field, load);
            }
        }
        Ok(())
    }

    fn add_pressure(&self, spec: &PressureSpec, load: &mut [f64]) -> Result<(), Error> {
        let boundary = self.boundary(&spec.boundary)?;
        finite(self.at("value"), spec.value)?;
        match self.profile(spec.profile.as_ref())? {
            None => add_pressure(self.body, boundary, spec.value, load),
            Some(profile) => {
                let field = |at, normal: [f64; 3]| normal.map(|component| -spec.value * profile.at(at) * component);
                add_traction_with_kinks(self.body, boundary, profile.kinks(), field, load);
            }
        }
        Ok(())
    }

    fn add_force(&self, spec: &ForceSpec, load: &mut [f64]) -> Result<(), Error> {
        let dimension = self.body.dimension();
        match (&spec.at, &spec.boundary) {
            (Some(at), None) => {
                let node = node_at(self.body.mesh(), at, &self.at("at"))?;
                let force = self.vector("value", &spec.value)?;
                let entries = &mut load[dimension * node..dimension * (node + 1)];
                entries.iter_mut().zip(force).for_each(|(entry, component)| *entry += component);
                Ok(())
            }
            (None, Some(name)) => {
                let boundary = self.boundary(name)?;
                let force = self.vector("value", &spec.value)?;
                add_traction(self.body, boundary, spread(self.body, boundary, force, &self.at("boundary"))?, load);
                Ok(())
            }
            (None, None) => Err(wrong(&*self.path, "acts nowhere; give `at`, a point, or a `boundary`")),
            (Some(_), Some(_)) => Err(wrong(&*self.path, "acts at a point and on a boundary; give only one")),
        }
    }

    fn add_nodal(&self, forces: &BTreeMap<String, Vec<f64>>, load: &mut [f64]) -> Result<(), Error> {
        let dimension = self.body.dimension();
        if forces.is_empty() {
            return Err(wrong(
                &*self.path,
                "acts nowhere; give a set of nodes, or the number of a node, with its force",
            ));
        }
        for (name, force) in forces {
            let nodes = nodes_named(self.body.mesh(), name, &self.at(name))?;
            let force = self.vector(name, force)?;
            for node in nodes {
                let entries = &mut load[dimension * node..dimension * (node + 1)];
                entries.iter_mut().zip(force).for_each(|(entry, component)| *entry += component);
            }
        }
        Ok(())
    }

    fn add_moment(&self, spec: &MomentSpec, load: &mut [f64]) -> Result<(), Error> {
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
        add_moment(self.body, boundary, moment, load).ok_or_else(|| {
            let name = &boundary.name;
            let message = format!(
                "no turning traction on `{name}` has this moment: its facets lie on a straight line, or its size is \
                 not finite"
            );
            wrong(self.at("boundary"), message)
        })
    }

    fn add_centrifugal(&self, spec: &CentrifugalSpec, load: &mut [f64]) -> Result<(), Error> {
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
        add_centrifugal(self.body, spec.omega, (axis, point), load)
    }

    /// Checks that every material has a density.
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
