//! The lower half of a disc, or its mirror image: a core of straight lines, and shells around it out to the arc.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::shape::{About, Block, BodyShape, RoundCells, Sides, Site};
use crate::error::Error;
use crate::fem::Integration;
use crate::fem::mesh::lattice::{Lattice, half_steps};
use crate::fem::mesh::round::Grading;
use crate::fem::mesh::{ElementKind, MAX_NODES, Mesh, Zone, fail};
use crate::scene::input::files::Files;
use crate::scene::input::schema::cells::{ElementSpec, HalfSpec};

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

pub(super) const ABOUT: About = About { name: "half-disc", dimensions: &[2] };

impl BodyShape for HalfDiscSpec {
    fn integration(&self) -> Integration {
        self.integration
    }

    fn circles(&self) -> Vec<(&'static str, [f64; 2], f64)> {
        vec![("arc", self.centre, self.radius)]
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
        site.check_estimate(&self.block(None))?;
        let lower = half_disc(self.centre, self.radius, &self.zone, Sides::of(self.symmetric), self.element.kind())?;
        Ok(self.half.of(lower, 1, self.centre[1]))
    }

    fn block(&self, _: Option<Files>) -> Block {
        half_disc_block(&self.zone, self.radius, Sides::of(self.symmetric), self.element.kind())
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
/// [`Error::Mesh`] for an element that is not plane, a centre that is not finite, more than `MAX_NODES` nodes;
/// [`qp::LinearError::Setting`](signorini_qp::LinearError::Setting) for a radius or a zone out of its range.
pub fn half_disc(centre: [f64; 2], radius: f64, zone: &Zone, sides: Sides, kind: ElementKind) -> Result<Mesh, Error> {
    if kind.dimension() != 2 {
        return fail(format!("a half disc cannot have a mesh of {}", kind.name()));
    }
    let graded = Grading::new(radius, zone)?;
    let across = sides.lines(&graded.aside);
    let (columns, rows, shells) = (across.len() - 1, graded.down.len() - 1, graded.shells.len() - 1);
    let cells = columns.saturating_mul(rows).saturating_add((columns + 2 * rows).saturating_mul(shells));
    if cells > MAX_NODES / 4 {
        return fail(format!("{cells} cells make more than the {MAX_NODES} nodes that are allowed"));
    }

    // Keys are [shell, column, row] in half steps. Shell 0 is the core, in which columns run right and rows run down.
    let mut lattice = Lattice::new();
    let mut connectivity = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let key = |right: usize, up: usize| [0, 2 * column + right, 2 * row + 2 - up];
            lattice.add_cell(kind, key, &mut connectivity);
        }
    }
    // Around the core, with its inside on the left: down its left side, along its bottom, up its right side.
    let left = (0..2 * rows).map(|row| [0, row]).filter(|_| sides == Sides::Both);
    let bottom = (0..2 * columns).map(|column| [column, 2 * rows]);
    let right = (0..=2 * rows).rev().map(|row| [2 * columns, row]);
    let around: Vec<[usize; 2]> = left.chain(bottom).chain(right).collect();
    for ends in around.windows(3).step_by(2) {
        for shell in 0..shells {
            // From the outside of the shell inwards.
            let key = |along: usize, inward: usize| [2 * shell + 2 - inward, ends[along][0], ends[along][1]];
            lattice.add_cell(kind, key, &mut connectivity);
        }
    }

    let (across, down, outward) = (half_steps(&across), half_steps(&graded.down), half_steps(&graded.shells));
    let place = |&[shell, column, row]: &[usize; 3]| {
        let direction = [graded.tangent(across[column]), -graded.tangent(down[row]), 0.0];
        let at = graded.place(direction, outward[shell]);
        [centre[0] + at[0], centre[1] + at[1], 0.0]
    };
    let mesh = Mesh::new(lattice.keys.iter().map(place).collect(), kind, connectivity, Vec::new())?;
    let keys = &lattice.keys;
    let (cut, arc) = (|node: usize| keys[node][2] == 0, |node: usize| keys[node][0] == 2 * shells);
    let symmetry = |node: usize| keys[node][1] == 0;
    let boundaries: [(&str, &dyn Fn(usize) -> bool); 3] = [("cut", &cut), ("arc", &arc), ("symmetry-x", &symmetry)];
    Ok(mesh.with_sides(match sides {
        Sides::Both => &boundaries[..2],
        Sides::Beyond => &boundaries,
    }))
}

/// The estimated cells of half a disc: around the core, and from its middle to the arc.
pub(super) fn half_disc_block(zone: &Zone, radius: f64, sides: Sides, kind: ElementKind) -> Block {
    let RoundCells { aside, down, shells } = RoundCells::of(zone, radius);
    let count = if sides == Sides::Both { 2.0 } else { 1.0 };
    let around = count * (aside + down);
    let core = count * aside * down;
    Block { cells: vec![around, shells + core / around], lengths: Vec::new(), counts: kind.reference().counts }
}
