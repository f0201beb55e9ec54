//! A body from a mesh file of Gmsh, or from an input deck of CalculiX.

use super::shape::{BodyShape, BodySite, CellBlock};
use crate::error::Error;
use crate::fem::mesh::deck::Deck;
use crate::fem::{ElementKind, Integration, Mesh};
use crate::scene::input::entry::{Files, refused, wrong};
use crate::scene::input::names;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    #[serde(default = "crate::scene::input::schema::model::one")]
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

impl BodyShape for GmshSpec {
    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error> {
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

    fn block(&self, files: Option<Files>) -> CellBlock {
        block_of_file(&self.file, files)
    }

    fn refine(&mut self, _: usize) -> Result<(), Error> {
        Err(wrong("body.gmsh", "a mesh from a file cannot be refined here; mesh the body again with smaller cells"))
    }
}

/// The block for a mesh file, by its length.
pub(super) fn block_of_file(file: &str, files: Option<Files>) -> CellBlock {
    let bytes = files.map_or(0.0, |files| files.length(file));
    // A plane mesh has fewer elements per node; the estimate of its size hardly depends on that.
    let side = (bytes / OF_MESH_FILE).sqrt();
    CellBlock { cells: vec![side; 2], lengths: Vec::new(), counts: ElementKind::T3.reference().counts }
}

/// The mesh of an input deck of CalculiX, a `.inp` file: nodes, elements, sets and surfaces. Its other cards are not
/// read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckSpec {
    /// The input deck, inside the folder of the scene unless reading outside is allowed; a relative name starts in that
    /// folder.
    pub file: String,
    /// Factor of the coordinates of the deck, positive.
    #[serde(default = "crate::scene::input::schema::model::one")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
    /// The body: `body-1`, `body-2`, ... in the order of their first elements, which are all elements joined by common
    /// nodes; or a set of elements, or a list of both. May be left out in a deck of one body.
    #[serde(default, with = "names", skip_serializing_if = "Vec::is_empty")]
    #[schemars(schema_with = "names::schema")]
    pub group: Vec<String>,
    /// The step up to which the deck is read, from 1: pressures of its cards are surfaces. The last step if it is left
    /// out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<usize>,
    /// The integration of the stiffness of the elements of the deck.
    #[serde(default)]
    pub integration: Integration,
}

impl BodyShape for DeckSpec {
    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error> {
        let file = site.files.named(&self.file, format!("{}.file", site.path))?;
        let folder = Some(site.files.folder).filter(|_| !site.files.reads_outside);
        let deck = site.read.deck(file, folder, self.step)?;
        if self.group.is_empty() && deck.bodies > 1 {
            let message = format!(
                "the deck has {} bodies that share no node; name one by `group`: {}",
                deck.bodies,
                (0..deck.bodies.min(20))
                    .map(|body| format!("`{}`", Deck::body_name(body)))
                    .collect::<Vec<_>>()
                    .join(", ")
            );
            return Err(refused("several-groups", format!("{}.group", site.path), message));
        }
        let groups: Vec<&str> = self.group.iter().map(String::as_str).collect();
        site.fitting(deck.mesh(&groups, self.scale)?)
    }

    fn block(&self, files: Option<Files>) -> CellBlock {
        block_of_file(&self.file, files)
    }

    fn refine(&mut self, _: usize) -> Result<(), Error> {
        Err(wrong("body.deck", "a mesh from a file cannot be refined here; mesh the body again with smaller cells"))
    }
}
