//! The boundaries of the mesh of a deck: its surfaces.

use super::card::key;
use super::content::Deck;
use crate::error::Error;
use crate::fem::mesh::outline::chained;
use crate::fem::mesh::{Boundary, Mesh};

impl Deck {
    /// Returns `true` if a line of one of these cards names a surface.
    fn is_in(&self, keywords: &[&str], surface: &str) -> bool {
        let cards = self.source.cards.iter().filter(|card| keywords.iter().any(|keyword| card.is(keyword)));
        cards.flat_map(|card| &card.lines).any(|line| {
            let mut fields = self.source.fields(line);
            std::iter::from_fn(|| fields.next()).any(|field| key(&String::from_utf8_lossy(field)) == key(surface))
        })
    }

    /// The mesh with the surfaces that have facets on it; `elements` are its elements in the deck, increasing. Of a
    /// surface under a pressure only the faces on the outside are kept.
    pub(super) fn with_boundaries(&self, mut mesh: Mesh, elements: &[usize]) -> Result<Mesh, Error> {
        let (facet, faces) = (mesh.kind_of(0).facet(), mesh.kind_of(0).reference().faces);
        let mut boundaries = Vec::new();
        for surface in &self.surfaces.all {
            let boundary_of = |all: &[(usize, usize)]| {
                let own =
                    all.iter().filter_map(|&(element, face)| Some((elements.binary_search(&element).ok()?, face)));
                let nodes = own.flat_map(|(element, face)| faces[face].iter().map(move |&local| (element, local)));
                let connectivity: Vec<usize> = nodes.map(|(element, local)| mesh.element(element)[local]).collect();
                Boundary::new(surface.name.as_str(), facet, connectivity)
            };
            let mut boundary = boundary_of(&surface.faces);
            if let Some(within) = mesh.inner_facet(&boundary) {
                let is_pressed = self.pressures.iter().any(|pressure| pressure.surface == surface.name);
                if self.is_in(&["CONTACTPAIR", "TIE"], &surface.name) {
                    let mut own = surface.faces.iter().filter(|face| elements.binary_search(&face.0).is_ok());
                    let &(element, face) = own.nth(within).unwrap_or(&surface.faces[0]);
                    let message = format!(
                        "face {} of element {} in the surface `{}` lies within the body: two elements share it",
                        face + 1,
                        self.elements.numbers[element],
                        surface.name
                    );
                    return Err(self.source.fault(surface.place, message));
                } else if !is_pressed && !self.is_in(&["DSLOAD"], &surface.name) {
                    continue;
                }
                boundary = boundary_of(&self.outside_and_inside(surface).0);
            }
            if !boundary.connectivity.is_empty() {
                boundaries.push(Boundary { connectivity: chained(facet, boundary.connectivity), ..boundary });
            }
        }
        mesh.boundaries = boundaries;
        Ok(mesh)
    }
}
