//! A body from a mesh file of Gmsh.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::shape::{About, Block, BodyShape, Site};
use crate::error::Error;
use crate::fem::{ElementKind, Integration, Mesh};
use crate::scene::input::entry::{refused, wrong};
use crate::scene::input::files::Files;
use crate::scene::input::names;

/// Approximate bytes of a mesh file for one node and its elements: files of Gmsh of either version, ASCII or binary,
/// have 87 to 237.
const OF_MESH_FILE: f64 = 150.0;

/// A mesh written by Gmsh: a `.msh` file of version 4.1 or 2.2, ASCII or binary. A bar has the cross-section 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GmshSpec {
    /// The mesh file, inside the folder of the scene unless reading outside is allowed; a relative name starts in that
    /// folder.
    pub file: String,
    /// Factor of the coordinates of the mesh file, positive.
    #[serde(default = "crate::scene::input::schema::cells::one")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
    /// The physical group of the body, or a list of groups, which are glued where they share nodes. May be left out if
    /// at most one group has elements of the highest dimension, or if `materials` name the groups.
    #[serde(default, with = "names", skip_serializing_if = "Vec::is_empty")]
    #[schemars(schema_with = "names::schema")]
    pub group: Vec<String>,
    /// The integration of the stiffness of the elements of the mesh file.
    #[serde(default)]
    pub integration: Integration,
}

pub(super) const ABOUT: About = About { name: "gmsh", dimensions: &[1, 2, 3] };

impl BodyShape for GmshSpec {
    fn integration(&self) -> Integration {
        self.integration
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
        let file = site.read.gmsh(site.files.named(&self.file, format!("{}.file", site.path))?)?;
        let bodies = file.bodies();
        if self.group.is_empty() && bodies.len() > 1 && !site.names_groups {
            let names = bodies.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            let message = format!(
                "the mesh has {} groups of elements, {names}; without `group` they would be one body of one \
                 material; name one or a list by `group`, or give `materials`",
                bodies.len()
            );
            return Err(refused("several-groups", format!("{}.group", site.path), message));
        }
        let groups: Vec<&str> = self.group.iter().map(String::as_str).collect();
        site.fitting(file.mesh(&groups, self.scale)?)
    }

    fn block(&self, files: Option<Files>) -> Block {
        block_of_file(&self.file, files)
    }

    fn refine(&mut self, _: usize) -> Result<(), Error> {
        Err(wrong("body.gmsh", "a mesh from a file cannot be refined here; mesh the body again with smaller cells"))
    }
}

/// The block for a mesh file, by its length.
pub(super) fn block_of_file(file: &str, files: Option<Files>) -> Block {
    let bytes = files.map_or(0.0, |files| files.length(file));
    // A plane mesh has fewer elements per node; the estimate of its size hardly depends on that.
    let side = (bytes / OF_MESH_FILE).sqrt();
    Block { cells: vec![side; 2], lengths: Vec::new(), counts: ElementKind::T3.reference().counts }
}
