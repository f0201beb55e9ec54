//! A body from an input deck of CalculiX.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::shape::{About, Block, BodyShape, Site};
use crate::error::Error;
use crate::fem::mesh::deck::Deck;
use crate::fem::{Integration, Mesh};
use crate::scene::input::entry::{refused, wrong};
use crate::scene::input::files::Files;
use crate::scene::input::names;

/// The mesh of an input deck of CalculiX, a `.inp` file: nodes, elements, sets and surfaces. Its other cards are not
/// read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckSpec {
    /// The input deck, inside the folder of the scene unless reading outside is allowed; a relative name starts in that
    /// folder.
    pub file: String,
    /// Factor of the coordinates of the deck, positive.
    #[serde(default = "crate::scene::input::schema::cells::one")]
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

pub(super) const ABOUT: About = About { name: "deck", dimensions: &[2, 3] };

impl BodyShape for DeckSpec {
    fn integration(&self) -> Integration {
        self.integration
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
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

    fn block(&self, files: Option<Files>) -> Block {
        super::gmsh::block_of_file(&self.file, files)
    }

    fn refine(&mut self, _: usize) -> Result<(), Error> {
        Err(wrong("body.deck", "a mesh from a file cannot be refined here; mesh the body again with smaller cells"))
    }
}
