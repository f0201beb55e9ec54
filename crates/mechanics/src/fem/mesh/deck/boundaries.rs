//! The boundaries of the mesh of a deck: its surfaces.

use super::card::key;
use super::content::Deck;
use crate::error::Error;
use crate::fem::mesh::outline::chained;
use crate::fem::mesh::{Boundary, Mesh};

/// The cards that name surfaces of the outside in their lines.
const USING: [&str; 3] = ["DSLOAD", "CONTACTPAIR", "TIE"];

impl Deck {
    /// Returns `true` if a card loads a surface, or lets it touch or be tied.
    fn uses(&self, surface: &str) -> bool {
        let cards = self.source.cards.iter().filter(|card| USING.iter().any(|keyword| card.is(keyword)));
        cards.flat_map(|card| &card.lines).any(|line| {
            let mut fields = self.source.fields(line);
            std::iter::from_fn(|| fields.next()).any(|field| key(&String::from_utf8_lossy(field)) == key(surface))
        })
    }

    /// The mesh with the surfaces that have facets on it; `elements` are its elements in the deck, increasing.
    ///
    /// # Errors
    /// [`qp::Error::FileSyntax`](signorini_qp::Error::FileSyntax) with the line for a surface within the body that is
    /// loaded, touched or tied; another one is left out.
    pub(super) fn with_boundaries(&self, mut mesh: Mesh, elements: &[usize]) -> Result<Mesh, Error> {
        let (facet, faces) = (mesh.kind_of(0).facet(), mesh.kind_of(0).reference().faces);
        let mut boundaries = Vec::new();
        for surface in &self.surfaces.all {
            let own = surface
                .faces
                .iter()
                .filter_map(|&(element, face)| Some((elements.binary_search(&element).ok()?, face)));
            let own: Vec<(usize, usize)> = own.collect();
            let nodes = own.iter().flat_map(|&(element, face)| faces[face].iter().map(move |&local| (element, local)));
            let connectivity: Vec<usize> = nodes.map(|(element, local)| mesh.element(element)[local]).collect();
            if connectivity.is_empty() {
                continue;
            }
            let boundary = Boundary::new(surface.name.as_str(), facet, connectivity);
            if let Some(within) = mesh.inner_facet(&boundary) {
                if !self.uses(&surface.name) {
                    continue;
                }
                let number = self.elements.numbers[elements[own[within].0]];
                let message = format!(
                    "face {} of element {number} in the surface `{}` lies within the body: two elements share it",
                    own[within].1 + 1,
                    surface.name
                );
                return Err(self.source.fault(surface.place, message));
            }
            boundaries.push(Boundary { connectivity: chained(facet, boundary.connectivity), ..boundary });
        }
        mesh.boundaries = boundaries;
        Ok(mesh)
    }
}
