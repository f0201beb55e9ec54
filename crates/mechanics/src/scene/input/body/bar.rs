//! The structured bar along x.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::shape::{About, Block, BodyShape, Site};
use crate::error::Error;
use crate::fem::mesh::{Boundary, ElementKind, FacetKind, Mesh, check_lines};
use crate::fem::{Axis, Integration};
use crate::scene::input::files::Files;

/// A bar along x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BarSpec {
    /// The axis of the bar along x, with its cells.
    pub x: Axis,
    /// Cross-section, positive.
    #[serde(default = "crate::scene::input::schema::cells::one")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub area: f64,
}

pub(super) const ABOUT: About = About { name: "bar", dimensions: &[1] };

impl BodyShape for BarSpec {
    fn integration(&self) -> Integration {
        Integration::Standard
    }

    fn area(&self) -> f64 {
        self.area
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
        bar(&site.lines(&self.x, "x")?)
    }

    fn block(&self, _: Option<Files>) -> Block {
        Block::product(&[&self.x], ElementKind::Line2)
    }

    fn refine(&mut self, times: usize) -> Result<(), Error> {
        self.x.refine(times);
        Ok(())
    }
}

/// The bar with nodes at `x` (coordinates, in length, strictly increasing, at least two); its boundaries are `left` and
/// `right`.
///
/// # Errors
/// [`Error::Mesh`] for fewer than two nodes, coordinates that do not increase, or more than
/// `MAX_NODES`.
pub fn bar(x: &[f64]) -> Result<Mesh, Error> {
    check_lines(&[("x", x)], 1)?;
    let cells = x.len() - 1;
    let end = |name: &str, node| Boundary::new(name, FacetKind::Point1, vec![node]);
    Mesh::new(
        x.iter().map(|&x| [x, 0.0, 0.0]).collect(),
        ElementKind::Line2,
        (0..cells).flat_map(|cell| [cell, cell + 1]).collect(),
        vec![end("left", 0), end("right", cells)],
    )
}
