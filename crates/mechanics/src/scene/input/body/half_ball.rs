//! The lower half of a ball, or its mirror image: a fan of bricks.

use super::fan::{fan, fan_block};
use super::shape::{BodyShape, BodySite, CellBlock, Sides};
use crate::error::Error;
use crate::fem::Integration;
use crate::fem::mesh::{ElementKind, Mesh, Zone};
use crate::scene::input::entry::{Files, wrong};
use crate::scene::input::schema::model::{HalfSpec, SolidElementSpec};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Half of a ball, the lower half by default, of `hex8` or `hex20`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HalfBallSpec {
    /// The centre [x, y, z].
    #[serde(default)]
    pub centre: [f64; 3],
    /// The half of the ball; the upper half is the mirror image of the lower half, graded towards its highest point.
    #[serde(default, skip_serializing_if = "HalfSpec::is_lower")]
    pub half: HalfSpec,
    /// Radius of the half ball, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// The finely meshed zone around the lowest (highest) point of the half ball.
    pub zone: Zone,
    /// Axes along which only the part beyond the centre is meshed; the planes through the centre become the boundaries
    /// `symmetry-x` and `symmetry-y`.
    #[serde(default)]
    pub symmetric: Vec<SymmetrySpec>,
    /// The element: `hex8`, or `hex20` with edges that follow the sphere.
    #[serde(default, skip_serializing_if = "SolidElementSpec::is_default")]
    pub element: SolidElementSpec,
    /// The integration of the stiffness of the half ball.
    #[serde(default)]
    pub integration: Integration,
}

/// The axis normal to a plane of symmetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SymmetrySpec {
    /// A plane of symmetry normal to x.
    X,
    /// A plane of symmetry normal to y.
    Y,
}

impl HalfBallSpec {
    fn sides(&self) -> [Sides; 2] {
        [SymmetrySpec::X, SymmetrySpec::Y].map(|axis| Sides::of(self.symmetric.contains(&axis)))
    }
}

impl BodyShape for HalfBallSpec {
    fn is_round(&self) -> bool {
        true
    }

    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error> {
        site.check_estimate(&self.block(None))?;
        let kind = self.element.kind();
        if !kind.is_product() {
            let message = format!("a half ball cannot have a mesh of {}; take `hex8` or `hex20`", kind.name());
            return Err(wrong(format!("{}.element", site.path), message));
        }
        let mut lower = half_ball(self.centre, self.radius, &self.zone, self.sides())?;
        if kind.is_quadratic() {
            lower = lower.elevated(kind)?.onto_sphere("round", self.centre, self.radius);
        }
        Ok(self.half.of(lower, 2, self.centre[2]))
    }

    fn block(&self, _: Option<Files>) -> CellBlock {
        fan_block(self.radius, &self.zone, &self.sides(), self.element.kind())
    }

    fn refine(&mut self, times: usize) -> Result<(), Error> {
        self.zone.refine(times);
        Ok(())
    }
}

/// The lower half of the ball of `radius` about `centre` ([x, y, z], in length), of bricks, graded towards its lowest
/// point; with [`Sides::Beyond`] along x or y a quarter or an eighth of the ball.
///
/// The boundaries are `cut` (the flat side, z = centre), `round` and, with [`Sides::Beyond`], `symmetry-x` (x = centre)
/// and `symmetry-y` (y = centre).
///
/// # Errors
/// [`Error::Fem`] for a centre that is not finite, more than `MAX_NODES` nodes;
/// [`qp::LinearError::Setting`](signorini_qp::LinearError::Setting) for a radius or a zone out of its range.
pub fn half_ball(centre: [f64; 3], radius: f64, zone: &Zone, sides: [Sides; 2]) -> Result<Mesh, Error> {
    fan(centre, (radius, zone), &sides, ElementKind::Hex8)
}
