//! Lower halves of discs and balls: a core between lines, and shells of cells around it out to the circle or sphere.

use std::f64::consts::FRAC_PI_4;

use super::lattice::{Key, LatticeCells, places, points, steps};
use super::shape::{CellBlock, Sides};
use crate::error::Error;
use crate::fem::geometry::plus;
use crate::fem::mesh::axis::Grading;
use crate::fem::mesh::{ElementKind, MAX_NODES, Mesh, Zone, fail};

/// The approximate part of a round body's radius outside the core, along the diagonal.
const SHELLS: f64 = 0.6;

/// The lower half of the disc or ball of `radius` about `centre`, of which these sides are meshed along each horizontal
/// axis.
pub(super) fn fan(
    centre: [f64; 3],
    (radius, zone): (f64, &Zone),
    sides: &[Sides],
    kind: ElementKind,
) -> Result<Mesh, Error> {
    let graded = Grading::new(radius, zone)?;
    let (step, down, is_plane) = (steps(kind.reference()), sides.len(), sides.len() == 1);
    let across = sides.iter().map(|sides| sides.lines(&graded.aside));
    let lines: Vec<Vec<f64>> = across.chain([graded.down.clone()]).collect();
    let count = [0, 1, 2].map(|axis| lines.get(axis).map_or(1, |lines| lines.len() - 1));
    let shells = graded.shells.len() - 1;
    check_count(count, shells, is_plane)?;

    // Keys are a shell, which is 0 in the core, and the lines along the axes, of which the last one leads down.
    let mut cells = LatticeCells::of(kind);
    for cell in places([0; 3], count) {
        cells.add(|at| {
            let mut key = [0, 1, 2].map(|axis| step * cell[axis] + at[axis]);
            key[down] = step * (cell[down] + 1) - at[down];
            [0, key[0], key[1], key[2]]
        });
    }
    add_shells(&mut cells, shells, count, step, sides);
    let lines: Vec<Vec<f64>> = lines.iter().map(|lines| points(lines, kind)).collect();
    let outward = points(&graded.shells, kind);
    let place = |[shell, key @ ..]: Key| {
        let mut direction = [0.0; 3];
        for (axis, lines) in lines.iter().enumerate() {
            let tangent = graded.tangent(lines[key[axis]]);
            direction[axis] = if axis == down { -tangent } else { tangent };
        }
        plus(centre, graded.place(direction, outward[shell]))
    };
    let round = if is_plane { "arc" } else { "round" };
    let mut boundaries = vec![("cut", down + 1, 0), (round, 0, step * shells)];
    let planes = [("symmetry-x", 1, 0), ("symmetry-y", 2, 0)].into_iter().zip(sides);
    boundaries.extend(planes.filter(|(_, sides)| **sides == Sides::Beyond).map(|(plane, _)| plane));
    cells.mesh(place, &boundaries)
}

/// Refuses more cells than the nodes that are allowed.
fn check_count([i, j, k]: [usize; 3], shells: usize, is_plane: bool) -> Result<(), Error> {
    let (faces, most) = match is_plane {
        true => (i + 2 * j, MAX_NODES / 4),
        false => (i.saturating_mul(j).saturating_add(2 * k.saturating_mul(i.saturating_add(j))), MAX_NODES),
    };
    let cells = i.saturating_mul(j).saturating_mul(k).saturating_add(faces.saturating_mul(shells));
    if cells > most {
        return fail(format!("{cells} cells make more than the {MAX_NODES} nodes that are allowed"));
    }
    Ok(())
}

/// Adds the shells around a core: on all its facets but those of the cut and of the planes of symmetry.
fn add_shells(cells: &mut LatticeCells, shells: usize, [i, j, k]: [usize; 3], step: usize, sides: &[Sides]) {
    let is_plane = sides.len() == 1;
    let mut add = |along: usize, across: usize, point: &dyn Fn(usize, usize) -> [usize; 3]| {
        for [shell, a, b] in places([0; 3], [shells, along, across]) {
            cells.add(|[p, q, r]| {
                // In the plane from the outside of the shell inwards.
                let (q, outward) = if is_plane { (0, step - q) } else { (q, r) };
                let [x, y, z] = point(step * a + p, step * b + q);
                [step * shell + outward, x, y, z]
            });
        }
    };
    let is_both = |axis: usize| if sides[axis] == Sides::Both { 1 } else { 0 };
    if is_plane {
        // With the inside on the left.
        add(j, is_both(0), &|down, _| [0, down, 0]);
        add(i, 1, &|x, _| [x, step * j, 0]);
        return add(j, 1, &|up, _| [step * i, step * j - up, 0]);
    }
    // The first direction, the second direction and the outside are right-handed; lines down run against z.
    add(j, i, &|y, x| [x, y, step * k]);
    add(k, j, &|down, y| [step * i, y, down]);
    add(i, k, &|x, down| [x, step * j, down]);
    add(j, k * is_both(0), &|y, down| [0, y, down]);
    add(k, i * is_both(1), &|down, x| [x, 0, down]);
}

/// The estimated cells of a fan: around the core, and from its middle to the circle or sphere.
pub(super) fn fan_block(radius: f64, zone: &Zone, sides: &[Sides], kind: ElementKind) -> CellBlock {
    let quarter = radius * FRAC_PI_4;
    let ((aside, last), (shells, _)) = (zone.count(quarter), zone.count(radius * SHELLS));
    let down = quarter / last;
    // The outside of the whole core and its cells; symmetry leaves out parts of both.
    let (around, core) = match sides {
        [_] => (2.0 * (aside + down), 2.0 * aside * down),
        _ => (4.0 * aside * aside + 8.0 * aside * down, 4.0 * aside * aside * down),
    };
    let share: f64 = sides.iter().map(|sides| if *sides == Sides::Both { 1.0 } else { 0.5 }).product();
    let (around, outward) = (share * around, shells + core / around);
    let cells = match sides {
        [_] => vec![around, outward],
        _ => vec![around.sqrt(), around.sqrt(), outward],
    };
    CellBlock { cells, lengths: Vec::new(), counts: kind.reference().counts }
}
