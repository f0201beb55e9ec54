//! The bodies of a mesh file: groups of elements that share nodes are glued, and are one body.

use crate::error::Error;
use crate::fem::geometry::distance;
use crate::fem::mesh::gmsh::Glued;
use crate::fem::mesh::{Mesh, extent, fail};
use crate::fem::{ElasticBody, Formulation, GmshFile, Material};
use crate::scene::models::elastic::STEEL;

/// A body larger than this is assumed to be given in millimetres: few parts are larger in metres.
const LARGEST_IN_METRES: f64 = 5.0;

/// The bodies of a file, of steel.
pub(super) struct Bodies {
    /// The groups of each body; without a group one body has all elements.
    pub sets: Vec<Glued>,
    /// The name of each body in the scene: that of its first group; empty for the first body.
    pub names: Vec<String>,
    pub separate: Vec<ElasticBody>,
    /// All in one.
    pub joined: ElasticBody,
    /// `true` if the mesh is taken to be in millimetres.
    pub are_in_millimetres: bool,
    /// Young's modulus, in force per area.
    pub young: f64,
}

impl Bodies {
    pub fn of(file: &GmshFile) -> Result<Self, Error> {
        let mut sets = file.glued();
        if let [Glued { groups, .. }] = &mut sets[..]
            && groups.len() == 1
        {
            groups.clear();
        }
        if sets.is_empty() {
            sets.push(Glued::default());
        }
        let mesh = |set: &Glued| file.mesh(&set.groups.iter().map(String::as_str).collect::<Vec<_>>(), 1.0);
        let meshes: Vec<Mesh> = sets.iter().map(mesh).collect::<Result<_, Error>>()?;
        let corners: Vec<[f64; 3]> = meshes.iter().map(Mesh::extent).flat_map(|(low, high)| [low, high]).collect();
        let (low, high) = extent(&corners);
        let are_in_millimetres = distance(low, high) > LARGEST_IN_METRES;
        let young = if are_in_millimetres { STEEL / 1e6 } else { STEEL };
        let mut separate = Vec::with_capacity(meshes.len());
        for mesh in meshes {
            let formulation = match mesh.dimension() {
                1 => Formulation::Bar { area: 1.0 },
                2 => Formulation::PlaneStrain { thickness: 1.0 },
                _ => Formulation::Space,
            };
            separate.push(ElasticBody::new(mesh, Material::new(young, 0.3)?, formulation)?);
        }
        let Some(mut joined) = separate.first().cloned() else { return fail("the file has no body".into()) };
        let mut names = vec![String::new()];
        for (body, set) in separate.iter().zip(&sets).skip(1) {
            // A boundary of this name would hide the surface of the body.
            let mut name = set.groups.first().cloned().unwrap_or_default();
            while joined.mesh().boundary(&name).is_some() {
                name += "-body";
            }
            joined = joined.beside(body, &name)?;
            names.push(name);
        }
        Ok(Bodies { sets, names, separate, joined, are_in_millimetres, young })
    }
}
