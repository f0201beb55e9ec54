//! The bodies of a scene: mesh, materials, formulation, temperatures and initial stresses.

use super::materials::{BodyMaterials, Selection, centroids};
use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::fem::{self, ElementKind, Formulation, Integration, Mesh, Region};
use crate::scene::Warning;
use crate::scene::input::body::{BodySite, BodySpec};
use crate::scene::input::entry::{MeshFiles, finite, located, point, vector, wrong};
use crate::scene::input::parse::files;
use crate::scene::input::schema::{InitialStressSpec, ModelSpec, Scene, TemperatureSpec, Units};
use signorini_qp as qp;

/// Poisson's ratios above which elements lock: linear elements noticeably above the first; measured, quadratic elements
/// above the second.
const LOCKING_POISSON: [f64; 2] = [0.49, 0.499];

/// Young's moduli of one body that differ by more than this leave few digits in the strain of the soft part, and slow
/// down iterations.
const STIFFNESS_JUMP: f64 = 1e4;

/// Young's modulus of steel, in pascals.
pub(crate) const STEEL: f64 = 2.1e11;

/// The largest Young's modulus of diamond by direction, in pascals: no material of engineering is stiffer.
///
/// # Source
/// H. J. McSkimin, P. Andreatch, "Elastic moduli of diamond as a function of pressure and temperature", J. Appl. Phys.
/// 43 (1972) 2944-2948: stiffnesses of 1079, 124 and 578 GPa.
const DIAMOND: f64 = 1.2e12;

/// A modulus above that of diamond by this factor is in another unit: the next unit in use, the pascal, is a factor of
/// 1e6 away.
const OTHER_UNIT: f64 = 2.0;

/// A body as a scene describes it, with its place.
struct DescribedBody<'a> {
    scene: &'a Scene,
    spec: &'a BodySpec,
    materials: BodyMaterials<'a>,
    temperature: &'a [TemperatureSpec],
    stress: &'a [InitialStressSpec],
}

pub fn bodies(scene: &Scene) -> Result<Vec<ElasticBody>, Error> {
    let read = MeshFiles::default();
    described(scene).map(|described| described.elastic_body(&read)).collect()
}

/// The bodies in the order of the scene, combined in one.
pub(crate) fn joined(scene: &Scene, bodies: Vec<ElasticBody>) -> Result<ElasticBody, Error> {
    let (mut bodies, mut described) = (bodies.into_iter(), described(scene));
    let (Some(mut joined), Some(_)) = (bodies.next(), described.next()) else {
        return Err(wrong("body", "there is no body"));
    };
    let further = scene.further_bodies.iter().zip(described).zip(bodies).enumerate();
    for (index, ((spec, described), body)) in further {
        let name = &spec.name;
        if name.is_empty() || scene.further_bodies[..index].iter().any(|other| other.name == *name) {
            let message = format!("`{name}` is not allowed: every further body needs a name of its own");
            return Err(wrong(format!("{}name", described.materials.place), message));
        }
        joined = joined.beside(&body, name).map_err(|error| described.at_body(error))?;
    }
    Ok(joined)
}

fn described(scene: &Scene) -> impl Iterator<Item = DescribedBody<'_>> {
    let (model, has_mass) = (scene.model, scene.analysis.is_some());
    let of_body = move |material, parts, place| BodyMaterials { material, parts, place, model, has_mass };
    let materials = of_body(scene.material.as_ref(), &scene.materials, String::new());
    let (temperature, stress) = (&*scene.temperature, &*scene.initial_stress);
    let first = DescribedBody { scene, spec: &scene.body, materials, temperature, stress };
    let further = scene.further_bodies.iter().enumerate().map(move |(index, further)| {
        let place = format!("further-bodies[{index}].");
        let materials = of_body(further.material.as_ref(), &further.materials, place);
        let (temperature, stress) = (&*further.temperature, &*further.initial_stress);
        DescribedBody { scene, spec: &further.body, materials, temperature, stress }
    });
    std::iter::once(first).chain(further)
}

impl DescribedBody<'_> {
    fn path(&self, field: &str) -> String {
        format!("{}body.{}{field}", self.materials.place, self.spec.about().name)
    }

    /// Returns `true` if groups of elements are named.
    fn names_groups(&self) -> bool {
        let materials = self.materials.parts.iter().map(|part| &part.group);
        let temperature = self.temperature.iter().map(|entry| &entry.group);
        let stress = self.stress.iter().map(|entry| &entry.group);
        materials.chain(temperature).chain(stress).any(Option::is_some)
    }

    /// The mesh of the shape.
    fn mesh(&self, read: &MeshFiles) -> Result<Mesh, Error> {
        let (path, names_groups) = (self.path(""), self.names_groups());
        let site = BodySite { path, model: self.scene.model, files: files(self.scene), read, names_groups };
        self.spec.shape().mesh(&site).map_err(|error| self.at_body(error))
    }

    /// An error of the mesh at its place in the scene; an error with its own file and line keeps them.
    fn at_body(&self, error: impl Into<Error>) -> Error {
        match error.into() {
            Error::Fem(fem::Error::Mesh { message }) => wrong(self.path(""), message),
            other => located(other, &self.path(".")),
        }
    }

    fn formulation(&self) -> Result<Formulation, Error> {
        let (thickness, model) = (self.scene.thickness, self.scene.model);
        let about = self.spec.about();
        if !about.dimensions.contains(&model.dimension()) {
            let (body, fitting, model) = (about.name, BodySpec::fitting(model.dimension()), model.name());
            let message = format!("a {body} does not fit the model `{model}`; a body of this model is a {fitting}");
            return Err(wrong(self.path(""), message));
        }
        let formulation = match model {
            ModelSpec::Bar => Formulation::Bar { area: self.spec.shape().area() },
            ModelSpec::PlaneStrain => Formulation::PlaneStrain { thickness },
            ModelSpec::PlaneStress => Formulation::PlaneStress { thickness },
            ModelSpec::Axisymmetric => Formulation::Axisymmetric,
            ModelSpec::Space => Formulation::Space,
        };
        let plane = matches!(formulation, Formulation::PlaneStrain { .. } | Formulation::PlaneStress { .. });
        if !plane && thickness != 1.0 {
            let message = format!("the model `{}` has no thickness; leave it out", model.name());
            return Err(wrong("thickness", message));
        }
        let prefix = if model == ModelSpec::Bar { self.path(".") } else { String::new() };
        formulation.check().map_err(|error| located(error, &prefix))?;
        Ok(formulation)
    }

    /// The body with its temperatures and initial stresses.
    fn with_own_stress(&self, mut body: ElasticBody) -> Result<ElasticBody, Error> {
        let place = &self.materials.place;
        for (name, count) in [("temperature", self.temperature.len()), ("initial-stress", self.stress.len())] {
            if self.scene.dynamic().is_some() && count > 0 {
                let message = format!("a dynamic analysis has no `{name}`: only an equilibrium has; leave it out");
                return Err(wrong(format!("{place}{name}"), message));
            }
        }
        for (index, spec) in self.temperature.iter().enumerate() {
            body = warmed(body, spec, &format!("{place}temperature[{index}]"))?;
        }
        for (index, spec) in self.stress.iter().enumerate() {
            body = stressed(body, spec, &format!("{place}initial-stress[{index}]"))?;
        }
        Ok(body)
    }

    fn elastic_body(&self, read: &MeshFiles) -> Result<ElasticBody, Error> {
        let first = self.materials.first()?;
        let formulation = self.formulation()?;
        self.materials.check(&formulation)?;
        let at_body = |error| match error {
            // A setting next to the body: the thickness.
            fem::Error::Linear(qp::LinearError::Setting { .. }) => located(error, ""),
            other => self.at_body(other),
        };
        let body = ElasticBody::new(self.mesh(read)?, first, formulation).map_err(at_body)?;
        let body = self.with_own_stress(self.materials.placed(body)?)?;
        body.with_integration(self.spec.integration()).map_err(|error| match error {
            fem::Error::Mesh { message } => wrong(self.path(".integration"), message),
            other => other.into(),
        })
    }
}

pub(crate) fn locking(body: &ElasticBody) -> Option<Warning> {
    let of_region = |region: &Region| {
        let kind = body.mesh().kind_of(region.elements().start);
        let standard = body.phases_of(region).iter().filter(|phase| phase.integration == Integration::Standard);
        let poisson = standard.filter_map(|phase| phase.material().poisson()).reduce(f64::max)?;
        let locks = poisson > LOCKING_POISSON[usize::from(kind.is_quadratic())];
        locks.then_some((poisson, kind.name()))
    };
    let locking = body.regions().iter().filter(|_| body.formulation().can_lock()).filter_map(of_region);
    let (poisson, element) = locking.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let message = format!(
        "Poisson's ratio {poisson} locks {element} elements: pressures can come out several times too large; take \
         `\"integration\": \"mean-dilatation\"` with {} elements, a smaller ratio, or compare with a finer mesh before using them",
        ElementKind::of_mean_dilatation("or").to_lowercase()
    );
    Some(Warning::new("nearly-incompressible", message))
}

/// The warnings for bodies with materials of very different stiffness.
pub(crate) fn stiffness_jumps(body: &ElasticBody) -> Vec<Warning> {
    let jump = |region: &Region| {
        let [soft, stiff] = [f64::min, f64::max].map(|of| {
            let moduli = body.materials(region).flat_map(|material| material.young());
            moduli.reduce(of).unwrap_or(f64::NAN)
        });
        let of = if region.name().is_empty() { String::new() } else { format!("of `{}` ", region.name()) };
        let is_jump = body.materials(region).count() > 1 && stiff > STIFFNESS_JUMP * soft;
        let message = format!(
            "the materials {of}have Young's moduli from {soft:e} to {stiff:e}, a factor of {:.1e}: stresses and strains of the soft one lose \
             digits next to the stiff one, and the error of the mesh gathers at their interface; compare with a finer mesh, or take the \
             stiff part as a support or an obstacle",
            stiff / soft
        );
        is_jump.then_some(Warning::new("stiffness-jump", message))
    };
    body.regions().iter().filter_map(jump).collect()
}

/// The warning for the largest Young's modulus, if no material has it in these units.
pub(crate) fn unit_of_young(body: &ElasticBody, units: &Units) -> Option<Warning> {
    let pascals = units.pascals()?;
    let young = body.phases().iter().flat_map(|phase| phase.material().young()).reduce(f64::max)?;
    let times = young * pascals / DIAMOND;
    let Units { length, force } = units;
    let [meant, steel] = [young, STEEL].map(|value| value / pascals);
    let message = format!(
        "Young's modulus {young:e} is in {force}/{length}2, the units of this scene, {times:.0} times that of diamond: if it is given in \
         Pa, write {meant:e}; steel has {steel:e} {force}/{length}2"
    );
    (times > OTHER_UNIT).then_some(Warning::new("unit-of-young", message))
}

/// The names of the components of a stress, in their order.
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// The body with the temperature at the JSON path `path`.
fn warmed(body: ElasticBody, spec: &TemperatureSpec, path: &str) -> Result<ElasticBody, Error> {
    finite(format!("{path}.value"), spec.value)?;
    let gradient = match spec.gradient.is_empty() {
        true => [0.0; 3],
        false => vector(&format!("{path}.gradient"), &spec.gradient, body.dimension())?,
    };
    let selection = Selection { group: spec.group.as_deref(), cuboid: spec.cuboid.as_ref() };
    let elements = selection.elements(&body, path)?;
    if let Some(&element) = elements.iter().find(|&&element| body.material_of(element).expansion().is_none()) {
        let at = centroids(&body)[element];
        let at = point(&at[..body.dimension()]);
        let message = format!("the material at {at} has no `expansion`, which a temperature needs; give it");
        return Err(wrong(path, message));
    }
    Ok(body.with_temperature(&elements, spec.value, gradient)?)
}

/// The body with the initial stress at the JSON path `path`.
fn stressed(body: ElasticBody, spec: &InitialStressSpec, path: &str) -> Result<ElasticBody, Error> {
    let stress = [spec.xx, spec.yy, spec.zz, spec.xy, spec.yz, spec.zx];
    let own = body.formulation().stresses();
    for (component, (&value, name)) in stress.iter().zip(COMPONENTS).enumerate() {
        finite(format!("{path}.{name}"), value)?;
        if value != 0.0 && !own.contains(&component) {
            let names: Vec<&str> = own.iter().map(|&component| COMPONENTS[component]).collect();
            let message = format!("{} has no such stress; it has {}", body.formulation().name(), names.join(", "));
            return Err(wrong(format!("{path}.{name}"), message));
        }
    }
    let selection = Selection { group: spec.group.as_deref(), cuboid: spec.cuboid.as_ref() };
    let elements = selection.elements(&body, path)?;
    Ok(body.with_initial_stress(&elements, stress)?)
}
