//! The lower half of a disc: a core of straight lines, and shells around it out to the arc, fine at the lowest point.

use super::lattice::{Lattice, half_steps};
use super::{ElementKind, MAX_NODES, Mesh, Zone, fail};
use crate::error::Error;
use crate::fem::geometry::length;

/// Half the width of the core over the radius: cells neither flat at its corners nor small in its middle.
pub(super) const CORE: f64 = 0.4;

/// The lower half of the disc of `radius` about `centre`, of T3, T6, Q4 or Q8, graded towards its lowest point; only
/// the part right of the centre where `symmetric`.
///
/// The boundaries are `cut` (the flat side, y = centre), `arc` and, where `symmetric`, `symmetry-x` (x = centre). The
/// mid-sides of quadratic elements stand on the arc.
///
/// ```
/// use signorini::fem::{ElementKind, Zone, half_disc};
///
/// let zone = Zone { width: 0.1, divisions: 4, growth: 1.5 };
/// let mesh = half_disc([0.0, 1.0], 1.0, &zone, false, ElementKind::Q8)?;
/// let (node, distance) = mesh.nearest_node([0.0, 0.0, 0.0]).expect("a mesh has nodes");
/// assert!(distance == 0.0 && mesh.boundary("arc").is_some_and(|arc| arc.nodes().contains(&node)));
/// # Ok::<(), signorini::Error>(())
/// ```
///
/// # Errors
/// [`Error::Mesh`] for an element that is not plane, a centre that is not finite, more than `MAX_NODES` nodes;
/// [`Error::Setting`] for a radius or a zone out of its range.
pub fn half_disc(
    centre: [f64; 2],
    radius: f64,
    zone: &Zone,
    symmetric: bool,
    kind: ElementKind,
) -> Result<Mesh, Error> {
    if kind.dimension() != 2 {
        return fail(format!("a half disc is no mesh of {}", kind.name()));
    }
    zone.check(radius)?;
    let graded = Grading::new(radius, zone)?;
    let across = if symmetric { graded.aside.clone() } else { mirrored(&graded.aside) };
    let (columns, rows, shells) = (across.len() - 1, graded.down.len() - 1, graded.shells.len() - 1);
    let cells = columns.saturating_mul(rows).saturating_add((columns + 2 * rows).saturating_mul(shells));
    if cells > MAX_NODES / 4 {
        return fail(format!("{cells} cells make more than the {MAX_NODES} nodes that are allowed"));
    }

    // Keys are [shell, column, row] in half steps: shell 0 is the core, where columns run right and rows run down.
    let mut lattice = Lattice::new();
    let mut connectivity = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let key = |right: usize, up: usize| [0, 2 * column + right, 2 * row + 2 - up];
            lattice.add_cell(kind, key, &mut connectivity);
        }
    }
    // Around the core, its inside to the left: down its left side, along its bottom, up its right side.
    let left = (0..2 * rows).map(|row| [0, row]).filter(|_| !symmetric);
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
    let mut mesh = Mesh::new(lattice.keys().iter().map(place).collect(), kind, connectivity, Vec::new())?;
    let keys = lattice.keys();
    let mut boundaries = vec![
        mesh.boundary_where("cut", |node| keys[node][2] == 0),
        mesh.boundary_where("arc", |node| keys[node][0] == 2 * shells),
    ];
    if symmetric {
        boundaries.push(mesh.boundary_where("symmetry-x", |node| keys[node][1] == 0));
    }
    mesh.boundaries = boundaries.into_iter().flatten().collect();
    Ok(mesh)
}

/// The lines of a round body around its core.
pub(super) struct Grading {
    radius: f64,
    /// Arc lengths from the lowest point to the corner of the core, fine at 0.
    pub aside: Vec<f64>,
    /// Arc lengths from the cut to the corner of the core.
    pub down: Vec<f64>,
    /// Where the shells lie, from 0 at the core to 1 at the surface, fine at 1.
    pub shells: Vec<f64>,
}

impl Grading {
    pub fn new(radius: f64, zone: &Zone) -> Result<Self, Error> {
        let quarter = radius * std::f64::consts::FRAC_PI_4;
        let aside = zone.lines(quarter)?;
        // About as wide as the last cell beside them.
        let last = quarter - aside[aside.len() - 2];
        let rows = (quarter / last).round().max(2.0);
        let down = (0..=rows as usize).map(|row| quarter * row as f64 / rows).collect();
        let depth = radius * (1.0 - CORE);
        let mut shells: Vec<f64> = zone.lines(depth)?.iter().map(|line| 1.0 - line / depth).collect();
        shells.reverse();
        Ok(Grading { radius, aside, down, shells })
    }

    /// The tangent of the angle of an arc length from an axis; exact at the corner of the core, where it is 1.
    pub fn tangent(&self, arc: f64) -> f64 {
        let angle = arc / self.radius;
        if angle.abs() >= std::f64::consts::FRAC_PI_4 { angle.signum() } else { angle.tan() }
    }

    /// The place, seen from the centre, of a point of the core, given in halves of its width, that is moved `outward`
    /// from there (0) to the surface (1) along its ray.
    pub fn place(&self, core: [f64; 3], outward: f64) -> [f64; 3] {
        if outward == 0.0 {
            return core.map(|value| value * CORE * self.radius);
        }
        let stretch = (1.0 - outward) * CORE + outward / length(core);
        core.map(|value| value * stretch * self.radius)
    }
}

/// The lines from 0 on, and their mirror images.
pub(super) fn mirrored(lines: &[f64]) -> Vec<f64> {
    lines.iter().skip(1).rev().map(|line| -line).chain(lines.iter().copied()).collect()
}
