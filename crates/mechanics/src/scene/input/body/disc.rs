//! The disc: a half disc and its mirror image, joined along the cut; the half disc; the ring.

use std::collections::HashSet;

use super::fan::{fan, fan_block};
use super::lattice::{Key, LatticeCells, places, points, steps};
use super::shape::{BodyShape, BodySite, CellBlock, Sides};
use crate::error::Error;
use crate::fem::mesh::{Boundary, ElementKind, Mesh, Zone, check_lines, fail};
use crate::fem::{Axis, Integration};
use crate::scene::input::entry::Files;
use crate::scene::input::schema::model::{ElementSpec, HalfSpec};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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

impl BodyShape for DiscSpec {
    fn circles(&self) -> Vec<(&'static str, [f64; 2], f64)> {
        ["lower", "upper"].map(|name| (name, self.centre, self.radius)).to_vec()
    }

    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error> {
        site.check_estimate(&self.block(None))?;
        disc(self.centre, self.radius, &self.zone, Sides::of(self.symmetric), self.element.kind())
    }

    fn block(&self, _: Option<Files>) -> CellBlock {
        let mut halves = fan_block(self.radius, &self.zone, &[Sides::of(self.symmetric)], self.element.kind());
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
pub fn disc(centre: [f64; 2], radius: f64, zone: &Zone, sides: Sides, kind: ElementKind) -> Result<Mesh, Error> {
    let lower = half_disc(centre, radius, zone, sides, kind)?;
    let upper = lower.clone().mirrored(1, centre[1]);
    let cut: HashSet<usize> = lower.boundary("cut").map(Boundary::nodes).into_iter().flatten().collect();
    let count = lower.nodes().len();
    let mut further = count..;
    let number = (0..count).filter_map(|node| if cut.contains(&node) { Some(node) } else { further.next() });
    let number: Vec<usize> = number.collect();
    let beyond = upper.nodes().iter().enumerate().filter(|(node, _)| !cut.contains(node)).map(|(_, at)| at);
    let nodes = lower.nodes().iter().chain(beyond).copied().collect();
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
    Ok(Mesh::new(nodes, kind, connectivity, boundaries)?)
}

/// Half of a disc, the lower half by default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HalfDiscSpec {
    /// The centre [x, y] of the whole disc.
    #[serde(default)]
    pub centre: [f64; 2],
    /// The half of the disc; the upper half is the mirror image of the lower half, graded towards its highest point.
    #[serde(default, skip_serializing_if = "HalfSpec::is_lower")]
    pub half: HalfSpec,
    /// Radius of the half disc, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// The finely meshed zone around the lowest (highest) point of the half disc.
    pub zone: Zone,
    /// Only the quarter of the disc right of its centre; the plane x = centre becomes the boundary `symmetry-x`.
    #[serde(default)]
    pub symmetric: bool,
    /// The element of the half disc.
    #[serde(default)]
    pub element: ElementSpec,
    /// The integration of the stiffness of the half disc.
    #[serde(default)]
    pub integration: Integration,
}

impl BodyShape for HalfDiscSpec {
    fn circles(&self) -> Vec<(&'static str, [f64; 2], f64)> {
        vec![("arc", self.centre, self.radius)]
    }

    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error> {
        site.check_estimate(&self.block(None))?;
        let lower = half_disc(self.centre, self.radius, &self.zone, Sides::of(self.symmetric), self.element.kind())?;
        Ok(self.half.of(lower, 1, self.centre[1]))
    }

    fn block(&self, _: Option<Files>) -> CellBlock {
        fan_block(self.radius, &self.zone, &[Sides::of(self.symmetric)], self.element.kind())
    }

    fn refine(&mut self, times: usize) -> Result<(), Error> {
        self.zone.refine(times);
        Ok(())
    }
}

/// The lower half of the disc of `radius` about `centre` ([x, y], in length), of a plane element, graded towards its
/// lowest point; with [`Sides::Beyond`] only the part right of the centre.
///
/// The boundaries are `cut` (the flat side, y = centre), `arc` and, with [`Sides::Beyond`], `symmetry-x` (x = centre).
/// Quadratic elements have their mid-sides on the arc.
///
/// ```
/// use signorini_mechanics::fem::{ElementKind, Zone};
/// use signorini_mechanics::scene::{Sides, half_disc};
///
/// let zone = Zone { width: 0.1, divisions: 4, growth: 1.5 };
/// let mesh = half_disc([0.0, 1.0], 1.0, &zone, Sides::Both, ElementKind::Q8)?;
/// let (node, distance) = mesh.nearest_node([0.0, 0.0, 0.0]).expect("a mesh has nodes");
/// assert!(distance == 0.0 && mesh.boundary("arc").is_some_and(|arc| arc.nodes().contains(&node)));
/// # Ok::<(), signorini_mechanics::Error>(())
/// ```
///
/// # Errors
/// [`Error::Fem`] for an element that is not plane, a centre that is not finite, more than `MAX_NODES` nodes;
/// [`qp::LinearError::Setting`](signorini_qp::LinearError::Setting) for a radius or a zone out of its range.
pub fn half_disc(centre: [f64; 2], radius: f64, zone: &Zone, sides: Sides, kind: ElementKind) -> Result<Mesh, Error> {
    if kind.dimension() != 2 {
        return fail(format!("a half disc cannot have a mesh of {}", kind.name()));
    }
    fan([centre[0], centre[1], 0.0], (radius, zone), &[sides], kind)
}

/// A ring or a sector of a ring: the product of a radial axis and an angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingSpec {
    /// The centre [x, y] of the ring.
    #[serde(default)]
    pub centre: [f64; 2],
    /// The radial axis, from the inner to the outer radius.
    pub radius: Axis,
    /// The angle in degrees, counterclockwise from x; the ring is closed if the angle spans 360.
    pub angle: Axis,
    /// The element of the ring.
    #[serde(default)]
    pub element: ElementSpec,
    /// The integration of the stiffness of the ring.
    #[serde(default)]
    pub integration: Integration,
}

impl BodyShape for RingSpec {
    fn circles(&self) -> Vec<(&'static str, [f64; 2], f64)> {
        let ends = [self.radius.points.first(), self.radius.points.last()];
        let named = ["inner", "outer"].into_iter().zip(ends);
        named.filter_map(|(name, radius)| Some((name, self.centre, *radius?))).collect()
    }

    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error> {
        let [radii, angles] = site.lines([("radius", &self.radius), ("angle", &self.angle)])?;
        ring(self.centre, &radii, &angles, self.element.kind())
    }

    fn block(&self, _: Option<Files>) -> CellBlock {
        // An angle is not a length.
        CellBlock { lengths: Vec::new(), ..CellBlock::product(&[&self.radius, &self.angle], self.element.kind()) }
    }

    fn refine(&mut self, times: usize) -> Result<(), Error> {
        [&mut self.radius, &mut self.angle].into_iter().for_each(|axis| axis.refine(times));
        Ok(())
    }
}

/// The mesh of the circles of radius `radii` (in length) and the rays at `angles` (degrees, counterclockwise from x),
/// both strictly increasing, about `centre` ([x, y], in length), of a plane element, the mid-sides on the circles.
///
/// The boundaries are `inner` and `outer`, and, if the ring is not closed, `start` (first angle) and `end` (last
/// angle). It is closed if the angles span 360 degrees.
///
/// # Errors
/// [`Error::Fem`] for an element that is not plane, fewer than two radii or angles, values that do not increase, an
/// inner radius that is not positive, angles of more than 360 degrees or steps of 180 or more, more than
/// `MAX_NODES` nodes.
pub fn ring(centre: [f64; 2], radii: &[f64], angles: &[f64], kind: ElementKind) -> Result<Mesh, Error> {
    if kind.dimension() != 2 {
        return fail(format!("a ring cannot have a mesh of {}", kind.name()));
    }
    check_lines(&[("radius", radii), ("angle", angles)], steps(kind.reference()))?;
    if radii[0] <= 0.0 {
        return fail(format!("the inner radius is {}; it must be positive", radii[0]));
    }
    let span = angles[angles.len() - 1] - angles[0];
    if span > 360.0 {
        return fail(format!("the angles span {span} degrees; at most 360 are allowed"));
    }
    if let Some(wide) = angles.windows(2).find(|pair| pair[1] - pair[0] >= 180.0) {
        return fail(format!("a cell from {} to {} degrees is too wide; it must be below 180", wide[0], wide[1]));
    }
    let (layers, sectors) = (radii.len() - 1, angles.len() - 1);
    let is_closed = span == 360.0;
    let step = steps(kind.reference());
    let mut cells = LatticeCells::of(kind);
    for [layer, sector, _] in places([0; 3], [layers, sectors, 1]) {
        cells.add(|[outward, around, _]| {
            let angle = step * sector + around;
            [step * layer + outward, if is_closed && angle == step * sectors { 0 } else { angle }, 0, 0]
        });
    }
    let (radii, angles) = (points(radii, kind), points(angles, kind));
    let place = |[layer, angle, ..]: Key| {
        let (sine, cosine) = sine_cosine(angles[angle]);
        [centre[0] + radii[layer] * cosine, centre[1] + radii[layer] * sine, 0.0]
    };
    let sides = [("inner", 0, 0), ("outer", 0, step * layers), ("start", 1, 0), ("end", 1, step * sectors)];
    cells.mesh(place, if is_closed { &sides[..2] } else { &sides })
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
fn sine_cosine(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    let (sine, cosine) = (degrees - 90.0 * quarters).to_radians().sin_cos();
    match quarters.rem_euclid(4.0) as u8 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}
