//! The lower half of a ball: a core of bricks, and shells of bricks around it out to the sphere, fine at the lowest
//! point.

use super::half_disc::{Grading, mirrored};
use super::lattice::Lattice;
use super::{ElementKind, MAX_NODES, Mesh, Zone, fail};
use crate::error::Error;

/// Corners of a face of the core, in steps along its two directions, counterclockwise seen from outside.
const AROUND: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// The lower half of the ball of `radius` about `centre`, of Hex8, graded towards its lowest point; with `symmetric` x
/// or y only the part beyond the centre along that axis: a quarter or an eighth of the ball.
///
/// The boundaries are `cut` (the flat side, z = centre), `round` and, where `symmetric`, `symmetry-x` (x = centre) and
/// `symmetry-y` (y = centre).
///
/// # Errors
/// [`Error::Mesh`] for a centre that is not finite, more than `MAX_NODES` nodes; [`Error::Setting`] for a radius or a
/// zone out of its range.
pub fn half_ball(centre: [f64; 3], radius: f64, zone: &Zone, symmetric: [bool; 2]) -> Result<Mesh, Error> {
    zone.check(radius)?;
    let graded = Grading::new(radius, zone)?;
    let across = symmetric.map(|half| if half { graded.aside.clone() } else { mirrored(&graded.aside) });
    let count = [across[0].len() - 1, across[1].len() - 1, graded.down.len() - 1];
    let shells = graded.shells.len() - 1;
    let [i, j, k] = count;
    let sides = i.saturating_mul(j).saturating_add(2 * k.saturating_mul(i.saturating_add(j)));
    let cells = i.saturating_mul(j).saturating_mul(k).saturating_add(sides.saturating_mul(shells));
    if cells > MAX_NODES {
        return fail(format!("{cells} cells make more than the {MAX_NODES} nodes that are allowed"));
    }

    // Keys are [shell, line along x, along y, down]: shell 0 is the core.
    let mut lattice = Lattice::new();
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
    for [a, b, c, d] in faces_of_core(count, symmetric) {
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
        [0, 1, 2].map(|axis| centre[axis] + at[axis])
    };
    let nodes = lattice.keys().iter().map(place).collect();
    let mut mesh = Mesh::new(nodes, ElementKind::Hex8, connectivity, Vec::new())?;
    let keys = lattice.keys();
    let mut boundaries = vec![
        mesh.boundary_where("cut", |node| keys[node][3] == 0),
        mesh.boundary_where("round", |node| keys[node][0] == shells),
    ];
    for (axis, name) in ["symmetry-x", "symmetry-y"].into_iter().enumerate().filter(|&(axis, _)| symmetric[axis]) {
        boundaries.push(mesh.boundary_where(name, |node| keys[node][axis + 1] == 0));
    }
    mesh.boundaries = boundaries.into_iter().flatten().collect();
    Ok(mesh)
}

/// A corner of a cell of the core: lines along x, along y, down.
type Corner = [usize; 3];

/// The outer faces of the core, without the cut and the planes of symmetry, counterclockwise seen from outside.
fn faces_of_core([i, j, k]: Corner, symmetric: [bool; 2]) -> Vec<[Corner; 4]> {
    let mut faces = Vec::new();
    let mut add = |along: usize, across: usize, corner: &dyn Fn(usize, usize) -> Corner| {
        for b in 0..across {
            for a in 0..along {
                faces.push(AROUND.map(|[p, q]| corner(a + p, b + q)));
            }
        }
    };
    // The first direction, the second one and the outside are right-handed; lines down run against z.
    add(j, i, &|y, x| [x, y, k]);
    add(k, j, &|down, y| [i, y, down]);
    add(i, k, &|x, down| [x, j, down]);
    if !symmetric[0] {
        add(j, k, &|y, down| [0, y, down]);
    }
    if !symmetric[1] {
        add(k, i, &|down, x| [x, 0, down]);
    }
    faces
}
