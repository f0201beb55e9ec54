//! The lower half of a ball, or its mirror image: a core of bricks, and shells of bricks around it out to the sphere.

use super::shape::{Block, BodyShape, RoundCells, Sides, Site};
use crate::error::Error;
use crate::fem::Integration;
use crate::fem::geometry::plus;
use crate::fem::mesh::axis::{Grading, Lattice};
use crate::fem::mesh::{ElementKind, MAX_NODES, Mesh, Zone, fail};
use crate::scene::input::entry::{Files, wrong};
use crate::scene::input::schema::model::{HalfSpec, SolidElementSpec};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Corners of a face of the core, in steps along its two directions, counterclockwise seen from outside.
const AROUND: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

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

impl BodyShape for HalfBallSpec {
    fn integration(&self) -> Integration {
        self.integration
    }

    fn is_round(&self) -> bool {
        true
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
        site.check_estimate(&self.block(None))?;
        let sides = [SymmetrySpec::X, SymmetrySpec::Y].map(|axis| Sides::of(self.symmetric.contains(&axis)));
        let kind = self.element.kind();
        if !kind.is_product() {
            let message = format!("a half ball cannot have a mesh of {}; take `hex8` or `hex20`", kind.name());
            return Err(wrong(format!("{}.element", site.path), message));
        }
        let mut lower = half_ball(self.centre, self.radius, &self.zone, sides)?;
        if kind.is_quadratic() {
            lower = lower.elevated(kind)?.onto_sphere("round", self.centre, self.radius);
        }
        Ok(self.half.of(lower, 2, self.centre[2]))
    }

    fn block(&self, _: Option<Files>) -> Block {
        let RoundCells { aside, down, shells } = RoundCells::of(&self.zone, self.radius);
        let halves = self.symmetric.len().min(2) as i32;
        // Top and four sides of the core, without the parts that symmetry leaves out.
        let around = (4.0 * aside * aside + 8.0 * aside * down) / 2.0_f64.powi(halves);
        let core = 4.0 * aside * aside * down / 2.0_f64.powi(halves);
        let side = around.sqrt();
        let counts = self.element.kind().reference().counts;
        Block { cells: vec![side, side, shells + core / around], lengths: Vec::new(), counts }
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
    let graded = Grading::new(radius, zone)?;
    let across = sides.map(|sides| sides.lines(&graded.aside));
    let count = [across[0].len() - 1, across[1].len() - 1, graded.down.len() - 1];
    let shells = graded.shells.len() - 1;
    let [i, j, k] = count;
    let faces = i.saturating_mul(j).saturating_add(2 * k.saturating_mul(i.saturating_add(j)));
    let cells = i.saturating_mul(j).saturating_mul(k).saturating_add(faces.saturating_mul(shells));
    if cells > MAX_NODES {
        return fail(format!("{cells} cells make more than the {MAX_NODES} nodes that are allowed"));
    }

    // Keys are [shell, line along x, along y, down]: shell 0 is the core.
    let mut lattice = Lattice::default();
    let mut connectivity = Vec::new();
    for down in 0..k {
        for y in 0..j {
            for x in 0..i {
                for level in [down + 1, down] {
                    connectivity.extend(AROUND.map(|[a, b]| lattice.node([0, x + a, y + b, level])));
                }
            }
        }
    }
    for [a, b, c, d] in faces_of_core(count, sides) {
        for shell in 0..shells {
            for level in [shell, shell + 1] {
                connectivity.extend([a, b, c, d].map(|[x, y, down]| lattice.node([level, x, y, down])));
            }
        }
    }

    let place = |&[shell, x, y, down]: &[usize; 4]| {
        let direction =
            [graded.tangent(across[0][x]), graded.tangent(across[1][y]), -graded.tangent(graded.down[down])];
        let at = graded.place(direction, graded.shells[shell]);
        plus(centre, at)
    };
    let nodes = lattice.keys.iter().map(place).collect();
    let mesh = Mesh::new(nodes, ElementKind::Hex8, connectivity, Vec::new())?;
    let keys = &lattice.keys;
    let (cut, round) = (|node: usize| keys[node][3] == 0, |node: usize| keys[node][0] == shells);
    let symmetry = [1, 2].map(|axis| move |node: usize| keys[node][axis] == 0);
    let mut boundaries: Vec<(&str, &dyn Fn(usize) -> bool)> = vec![("cut", &cut), ("round", &round)];
    for (axis, name) in
        ["symmetry-x", "symmetry-y"].into_iter().enumerate().filter(|&(axis, _)| sides[axis] == Sides::Beyond)
    {
        boundaries.push((name, &symmetry[axis]));
    }
    Ok(mesh.with_sides(&boundaries))
}

/// A corner of a cell of the core: lines along x, along y, down.
type Corner = [usize; 3];

/// The outer faces of the core, without the cut and the planes of symmetry, counterclockwise seen from outside.
fn faces_of_core([i, j, k]: Corner, sides: [Sides; 2]) -> Vec<[Corner; 4]> {
    let mut faces = Vec::new();
    let mut add = |along: usize, across: usize, corner: &dyn Fn(usize, usize) -> Corner| {
        for b in 0..across {
            for a in 0..along {
                faces.push(AROUND.map(|[p, q]| corner(a + p, b + q)));
            }
        }
    };
    // The first direction, the second direction and the outside are right-handed; lines down run against z.
    add(j, i, &|y, x| [x, y, k]);
    add(k, j, &|down, y| [i, y, down]);
    add(i, k, &|x, down| [x, j, down]);
    if sides[0] == Sides::Both {
        add(j, k, &|y, down| [0, y, down]);
    }
    if sides[1] == Sides::Both {
        add(k, i, &|down, x| [x, 0, down]);
    }
    faces
}
