//! The disc: a half disc and its mirror image, joined along the cut.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::half_disc::{half_disc, half_disc_block};
use super::shape::{About, Block, BodyShape, Sides, Site};
use crate::error::Error;
use crate::fem::Integration;
use crate::fem::mesh::{Boundary, ElementKind, Mesh, Zone, fail};
use crate::scene::input::files::Files;
use crate::scene::input::schema::cells::ElementSpec;

/// A disc, graded towards its lowest and its highest point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscSpec {
    /// The centre [x, y] of the disc.
    #[serde(default)]
    pub centre: [f64; 2],
    /// Radius of the disc, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// The finely meshed zone around the lowest and the highest point.
    pub zone: Zone,
    /// Only the half of the disc right of its centre; the plane x = centre becomes the boundary `symmetry-x`.
    #[serde(default)]
    pub symmetric: bool,
    /// The element of the disc.
    #[serde(default)]
    pub element: ElementSpec,
    /// The integration of the stiffness of the disc.
    #[serde(default)]
    pub integration: Integration,
}

pub(super) const ABOUT: About = About { name: "disc", dimensions: &[2] };

impl BodyShape for DiscSpec {
    fn integration(&self) -> Integration {
        self.integration
    }

    fn circles(&self) -> Vec<(&'static str, [f64; 2], f64)> {
        ["lower", "upper"].map(|name| (name, self.centre, self.radius)).to_vec()
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
        site.check_estimate(&self.block(None))?;
        disc(self.centre, self.radius, &self.zone, Sides::of(self.symmetric), self.element.kind())
    }

    fn block(&self, _: Option<Files>) -> Block {
        let mut halves = half_disc_block(&self.zone, self.radius, Sides::of(self.symmetric), self.element.kind());
        halves.cells[0] *= 2.0;
        halves
    }

    fn refine(&mut self, times: usize) -> Result<(), Error> {
        self.zone.refine(times);
        Ok(())
    }
}

/// The disc of `radius` about `centre` ([x, y], in length), of a plane element, graded towards its lowest and its
/// highest point; with [`Sides::Beyond`] only the part right of the centre, which in an axisymmetric model is a ball.
///
/// The boundaries are `lower` and `upper`, the halves of the circle, and, with [`Sides::Beyond`], `symmetry-x` (x =
/// centre).
///
/// ```
/// use signorini_mechanics::fem::{ElementKind, Zone};
/// use signorini_mechanics::scene::{Sides, disc};
///
/// let zone = Zone { width: 0.2, divisions: 3, growth: 1.5 };
/// let mesh = disc([0.0, 1.0], 1.0, &zone, Sides::Both, ElementKind::Q4)?;
/// let (low, high) = mesh.extent();
/// assert!((high[1] - low[1] - 2.0).abs() < 1e-15 && mesh.boundary("lower").is_some());
/// # Ok::<(), signorini_mechanics::Error>(())
/// ```
///
/// # Errors
/// As [`half_disc`].
pub fn disc(centre: [f64; 2], radius: f64, zone: &Zone, sides: Sides, kind: ElementKind) -> Result<Mesh, Error> {
    let lower = half_disc(centre, radius, zone, sides, kind)?;
    let upper = lower.clone().mirrored(1, centre[1]);
    let Some(cut) = lower.boundary("cut").map(Boundary::nodes) else {
        return fail("a half disc without a cut cannot be joined".into());
    };
    let mut nodes = lower.nodes().to_vec();
    let mut number: Vec<usize> = vec![usize::MAX; nodes.len()];
    cut.iter().for_each(|&node| number[node] = node);
    for (node, at) in upper.nodes().iter().enumerate() {
        if number[node] == usize::MAX {
            number[node] = nodes.len();
            nodes.push(*at);
        }
    }
    let mirrored = |nodes: &[usize]| nodes.iter().map(|&node| number[node]).collect::<Vec<usize>>();
    let mut connectivity: Vec<usize> = lower.elements().flatten().copied().collect();
    upper.elements().for_each(|element| connectivity.extend(mirrored(element)));
    let mut boundaries = Vec::new();
    if let Some(arc) = lower.boundary("arc") {
        boundaries.push(Boundary::new("lower", arc.kind, arc.connectivity.clone()));
        boundaries.push(Boundary::new("upper", arc.kind, mirrored(&arc.connectivity)));
    }
    if let Some(side) = lower.boundary("symmetry-x") {
        let both = [side.connectivity.clone(), mirrored(&side.connectivity)].concat();
        boundaries.push(Boundary::new("symmetry-x", side.kind, both));
    }
    Mesh::new(nodes, kind, connectivity, boundaries)
}
