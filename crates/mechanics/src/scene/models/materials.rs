//! The materials of a body of a scene, and elements chosen by group or by place.

use crate::error::{Error, nearly};
use crate::fem::body::ElasticBody;
use crate::fem::{self, Formulation, Material};
use crate::scene::input::entry::{located, number, point, vector, wrong};
use crate::scene::input::schema::body::PartBoxSpec;
use crate::scene::input::schema::{MaterialPartSpec, MaterialSpec, ModelSpec, OrthotropicSpec};
use signorini_qp as qp;

/// The materials of a body as a scene describes them.
pub struct BodyMaterials<'a> {
    /// The material of all elements outside the parts.
    pub material: Option<&'a MaterialSpec>,
    pub parts: &'a [MaterialPartSpec],
    /// The prefix of the JSON paths of the body.
    pub place: String,
    pub model: ModelSpec,
    /// `true` if the analysis is dynamic and needs densities.
    pub has_mass: bool,
}

impl BodyMaterials<'_> {
    /// The materials in the order of the scene with their JSON paths; the material of all other elements comes first.
    fn given(&self) -> impl Iterator<Item = (&MaterialSpec, String)> {
        let rest = self.material.map(|spec| (spec, format!("{}material", self.place)));
        let parts = self.parts.iter().enumerate();
        let of_part = |(index, part)| -> (&MaterialSpec, String) {
            let part: &MaterialPartSpec = part;
            (&part.material, format!("{}materials[{index}].material", self.place))
        };
        rest.into_iter().chain(parts.map(of_part))
    }

    /// The first material: that of all other elements, or of the first part.
    pub fn first(&self) -> Result<Material, Error> {
        let missing = || wrong(format!("{}material", self.place), "is missing; a body needs a material");
        let (spec, path) = self.given().next().ok_or_else(missing)?;
        self.material(spec, &path)
    }

    /// Checks all materials, also those without elements.
    pub fn check(&self, formulation: &Formulation) -> Result<(), Error> {
        for (spec, path) in self.given() {
            self.material(spec, &path)?.law(formulation).map_err(|error| self.in_material(error, &path))?;
        }
        Ok(())
    }

    /// The body with the materials of its parts; given is the body with the first material everywhere.
    pub fn placed(&self, mut body: ElasticBody) -> Result<ElasticBody, Error> {
        let mut has_material = vec![self.material.is_some(); body.mesh().element_count()];
        for (index, part) in self.parts.iter().enumerate() {
            let path = format!("{}materials[{index}]", self.place);
            let selection = Selection { group: part.group.as_deref(), cuboid: part.cuboid.as_ref() };
            if selection.group.is_none() && selection.cuboid.is_none() {
                return Err(wrong(path, "has no place; give a `group`, a `box`, or both"));
            }
            let elements = selection.elements(&body, &path)?;
            elements.iter().for_each(|&element| has_material[element] = true);
            let material = self.material(&part.material, &format!("{path}.material"))?;
            body = body.with_material(&elements, material)?;
        }
        match has_material.iter().position(|has| !has) {
            None => Ok(body),
            Some(first) => Err(self.without_material(&body, first, &has_material)),
        }
    }

    /// The error for elements without a material; `first` is one of these elements.
    fn without_material(&self, body: &ElasticBody, first: usize, has_material: &[bool]) -> Error {
        let groups = body.mesh().groups().iter();
        let of_group = groups.filter(|group| group.elements.contains(&first)).map(|group| format!("`{}`", group.name));
        let of_group: Vec<String> = of_group.collect();
        let count = has_material.iter().filter(|has| !**has).count();
        let named = match of_group.is_empty() {
            true => String::new(),
            false => format!(" of the group {}", of_group.join(" and ")),
        };
        let at = centroids(body)[first];
        let message = format!(
            "{count} elements have no material, the first one{named} with its centroid at {}; name them in `materials`, or give a \
             `material` for all the rest",
            point(&at[..body.dimension()])
        );
        wrong(format!("{}materials", self.place), message)
    }

    /// The material at the JSON path `path`.
    fn material(&self, spec: &MaterialSpec, path: &str) -> Result<Material, Error> {
        let at = |error| self.in_material(error, path);
        let material = match (spec.young, spec.poisson, &spec.orthotropic) {
            (Some(young), Some(poisson), None) => Material::new(young, poisson).map_err(at)?,
            (None, None, Some(orthotropic)) => self.orthotropic(orthotropic, path)?,
            (None, None, None) => return Err(wrong(path, "needs `young` and `poisson`, or `orthotropic`; give them")),
            (_, _, Some(_)) => {
                let message = "has `orthotropic` beside `young` or `poisson`; give either the one or the others";
                return Err(wrong(path, message));
            }
            (young, ..) => {
                let [missing, given] = if young.is_none() { ["young", "poisson"] } else { ["poisson", "young"] };
                return Err(wrong(path, format!("`{missing}` is missing beside `{given}`; give both")));
            }
        };
        let material = match spec.expansion {
            Some(_) if spec.orthotropic.as_ref().is_some_and(|own| own.expansion.is_some()) => {
                return Err(wrong(path, "has an `expansion` beside that of `orthotropic`; give only one"));
            }
            Some(along) => material.with_expansion([along; 3]).map_err(at)?,
            None => material,
        };
        match spec.density {
            Some(density) => material.with_density(density).map_err(at),
            None if self.has_mass => Err(wrong(path, "an analysis needs a `density`; give it")),
            None => Ok(material),
        }
    }

    fn orthotropic(&self, spec: &OrthotropicSpec, path: &str) -> Result<Material, Error> {
        let at = |error| self.in_material(error, path);
        let mut material = Material::orthotropic(spec.young, spec.poisson, spec.shear).map_err(at)?;
        if let Some(along) = spec.expansion {
            material =
                material.with_expansion(along).map_err(|error| located(error, &format!("{path}.orthotropic.")))?;
        }
        let (in_plane, in_space) = (self.model.dimension() == 2, self.model == ModelSpec::Space);
        let [angle_path, axes_path] = ["angle", "axes"].map(|field| format!("{path}.orthotropic.{field}"));
        let model = self.model.name();
        if let Some(line) = &spec.around {
            let around = format!("{path}.orthotropic.around");
            if spec.angle.is_some() || spec.axes.is_some() {
                return Err(wrong(around, "stands beside `angle` or `axes`; give one of them"));
            }
            if self.model == ModelSpec::Axisymmetric || !(in_plane || in_space) {
                return Err(wrong(
                    around,
                    format!("the axes of the model `{model}` turn around no line; leave it out"),
                ));
            }
            let place = vector(&format!("{around}.point"), &line.point, self.model.dimension())?;
            let along = match &line.along {
                Some(_) if in_plane => {
                    return Err(wrong(
                        format!("{around}.along"),
                        "the line of a plane model is across the plane; leave it out",
                    ));
                }
                Some(along) => vector(&format!("{around}.along"), along, 3)?,
                None => [0.0, 0.0, 1.0],
            };
            return material.around(place, along).map_err(at);
        }
        match (spec.angle, &spec.axes) {
            (None, None) => Ok(material),
            (Some(_), _) if !in_plane => {
                let instead = if in_space { "; give `axes`" } else { "; leave it out" };
                Err(wrong(angle_path, format!("the model `{model}` has no plane to turn in{instead}")))
            }
            (_, Some(_)) if !in_space => {
                let instead = if in_plane { "give an `angle`" } else { "leave them out" };
                Err(wrong(axes_path, format!("axes are for the model `space`; in `{model}` {instead}")))
            }
            (Some(angle), _) => {
                if !angle.is_finite() {
                    return Err(wrong(angle_path, format!("{angle} is not finite")));
                }
                let (sine, cosine) = angle.to_radians().sin_cos();
                material.along([cosine, sine, 0.0], [-sine, cosine, 0.0]).map_err(at)
            }
            (None, Some([first, second])) => {
                let first = vector(&format!("{axes_path}[0]"), first, 3)?;
                material.along(first, vector(&format!("{axes_path}[1]"), second, 3)?).map_err(at)
            }
        }
    }

    /// An error of the material at the JSON path `path`; the allowed range is that of the model.
    fn in_material(&self, error: fem::Error, path: &str) -> Error {
        let prefix = format!("{path}.");
        let allowed = match self.model {
            ModelSpec::Bar => "above -1 and at most 0.5 in a bar",
            ModelSpec::PlaneStrain => "above -1 and below 0.5 in plane strain",
            ModelSpec::PlaneStress => "above -1 and at most 0.5 in plane stress",
            ModelSpec::Axisymmetric => "above -1 and below 0.5 in an axisymmetric body",
            ModelSpec::Space => "above -1 and below 0.5 in space",
        };
        match error {
            fem::Error::Linear(qp::LinearError::Setting { name: "poisson", value, .. }) => {
                located(qp::LinearError::Setting { name: "poisson", value, allowed }, &prefix)
            }
            fem::Error::Linear(qp::LinearError::Setting { name: "orthotropic.poisson", value, .. }) => {
                let message = format!(
                    "the ratios make no positive definite stiffness: 1 - nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13 is {}; it \
                     must be positive",
                    number(value)
                );
                wrong(format!("{prefix}orthotropic.poisson"), message)
            }
            other => located(other, &prefix),
        }
    }
}

/// The selected elements of a body: those of a group, those with the centroid in a box, those in both; all if neither
/// is given.
pub struct Selection<'a> {
    pub group: Option<&'a str>,
    pub cuboid: Option<&'a PartBoxSpec>,
}

impl Selection<'_> {
    /// The elements, numbered from 0, of the selection at the JSON path `path`.
    pub fn elements(&self, body: &ElasticBody, path: &str) -> Result<Vec<usize>, Error> {
        let mut elements: Vec<usize> = match self.group {
            None => (0..body.mesh().element_count()).collect(),
            Some(name) => of_group(body, name, path)?,
        };
        if let Some(cuboid) = self.cuboid {
            let [low, high] = cuboid.corners(path, body.dimension())?;
            let centroids = centroids(body);
            let is_in = |at: &[f64; 3]| (0..3).all(|axis| low[axis] <= at[axis] && at[axis] <= high[axis]);
            elements.retain(|&element| is_in(&centroids[element]));
        }
        if elements.is_empty() {
            return Err(wrong(path, "no element has its centroid there; change the box, or refine the mesh"));
        }
        Ok(elements)
    }
}

fn of_group(body: &ElasticBody, name: &str, path: &str) -> Result<Vec<usize>, Error> {
    let groups = body.mesh().groups();
    let own = groups.iter().filter(|group| group.name == name);
    let elements: Vec<usize> = own.flat_map(|group| group.elements.iter().copied()).collect();
    if elements.is_empty() {
        let names: Vec<String> = groups.iter().map(|group| format!("`{}`", group.name)).collect();
        let there = match names.is_empty() {
            true => "the body has none".to_string(),
            false => format!("there are {}", names.join(", ")),
        };
        let meant = nearly(name, groups.iter().map(|group| group.name.as_str()));
        return Err(wrong(format!("{path}.group"), format!("there is no group of elements `{name}`; {there}{meant}")));
    }
    Ok(elements)
}

pub(crate) fn centroids(body: &ElasticBody) -> Vec<[f64; 3]> {
    let tables = body.tabulated();
    body.elements().map(|element| element.cell.place(&tables.at(element.kind).centroid.shape)).collect()
}
