//! The structured ring, or a sector of a ring: the product of a radial axis and an angle.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::shape::{About, Block, BodyShape, Site};
use crate::error::Error;
use crate::fem::mesh::lattice::{Lattice, half_steps};
use crate::fem::mesh::{ElementKind, Mesh, check_lines, fail};
use crate::fem::{Axis, Integration};
use crate::scene::input::files::Files;
use crate::scene::input::schema::cells::ElementSpec;

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

pub(super) const ABOUT: About = About { name: "ring", dimensions: &[2] };

impl BodyShape for RingSpec {
    fn integration(&self) -> Integration {
        self.integration
    }

    fn circles(&self) -> Vec<(&'static str, [f64; 2], f64)> {
        let ends = [self.radius.points.first(), self.radius.points.last()];
        let named = ["inner", "outer"].into_iter().zip(ends);
        named.filter_map(|(name, radius)| Some((name, self.centre, *radius?))).collect()
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
        site.check_product(&[&self.radius, &self.angle])?;
        ring(self.centre, &site.lines(&self.radius, "radius")?, &site.lines(&self.angle, "angle")?, self.element.kind())
    }

    fn block(&self, _: Option<Files>) -> Block {
        // An angle is not a length.
        Block { lengths: Vec::new(), ..Block::product(&[&self.radius, &self.angle], self.element.kind()) }
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
/// [`Error::Mesh`] for an element that is not plane, fewer than two radii or angles, values that do not increase, an
/// inner radius that is not positive, angles of more than 360 degrees or steps of 180 or more, more than
/// `MAX_NODES` nodes.
pub fn ring(centre: [f64; 2], radii: &[f64], angles: &[f64], kind: ElementKind) -> Result<Mesh, Error> {
    if kind.dimension() != 2 {
        return fail(format!("a ring cannot have a mesh of {}", kind.name()));
    }
    check_lines(&[("radius", radii), ("angle", angles)], if kind.is_quadratic() { 2 } else { 1 })?;
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
    let (radii, angles) = (half_steps(radii), half_steps(angles));
    let mut lattice = Lattice::new();
    let mut connectivity = Vec::new();
    for sector in 0..sectors {
        for layer in 0..layers {
            let key = |outward: usize, around: usize| {
                let angle = 2 * sector + around;
                [2 * layer + outward, if is_closed && angle == 2 * sectors { 0 } else { angle }]
            };
            lattice.add_cell(kind, key, &mut connectivity);
        }
    }
    let place = |&[layer, angle]: &[usize; 2]| {
        let (sine, cosine) = sine_cosine(angles[angle]);
        [centre[0] + radii[layer] * cosine, centre[1] + radii[layer] * sine, 0.0]
    };
    let mesh = Mesh::new(lattice.keys.iter().map(place).collect(), kind, connectivity, Vec::new())?;
    let keys = &lattice.keys;
    let (inner, outer) = (|node: usize| keys[node][0] == 0, |node: usize| keys[node][0] == 2 * layers);
    let (start, end) = (|node: usize| keys[node][1] == 0, |node: usize| keys[node][1] == 2 * sectors);
    let sides: [(&str, &dyn Fn(usize) -> bool); 4] =
        [("inner", &inner), ("outer", &outer), ("start", &start), ("end", &end)];
    Ok(mesh.with_sides(if is_closed { &sides[..2] } else { &sides }))
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
