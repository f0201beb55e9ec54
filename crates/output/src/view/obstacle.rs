//! Obstacles as they are shown: a line in the plane, the part that faces the body in space, and the eye that sees the
//! contact.

use signorini_mechanics::fem::geometry::{length, minus};
use signorini_mechanics::scene::Model;
use signorini_qp::dot;

/// Pieces of the line of an obstacle.
const OUTLINE_SEGMENTS: usize = 400;
/// Half of the height of a wall before a bar, over its length.
const WALL: f64 = 0.12;
/// The direction to the eye: from the front, above and a little from the right; contact faces turn it to their side.
const EYE: [f64; 3] = [0.5, -0.8, 0.55];
/// Slope of the line of sight against the contact of two bodies.
const TILT: f64 = 0.35;

/// The line of an obstacle that is shifted along its approach direction; before a bar a wall. Empty in space and for
/// another body.
pub(crate) fn outline(model: &Model, obstacle: usize, shift: f64) -> Vec<[f64; 2]> {
    match model.mesh().dimension() {
        1 => wall(model, obstacle),
        _ => model.obstacles()[obstacle].outline(shift, OUTLINE_SEGMENTS),
    }
}

/// The wall that a bar meets: a line across the bar at the point at which the row of its end meets the obstacle. Empty
/// for another body.
fn wall(model: &Model, index: usize) -> Vec<[f64; 2]> {
    let rigid = model.obstacles()[index].rigid();
    let row = model.rows().iter().find(|row| row.obstacle == index).filter(|_| rigid.is_some());
    row.map_or_else(Vec::new, |row| {
        let (x, half) = (model.mesh().nodes()[row.node][0] + row.gap * row.normal[0], WALL * model.mesh().size());
        vec![[x, -half], [x, half]]
    })
}

/// The nodes of the rows of an obstacle, each with the vector from its undeformed position to the obstacle, which has
/// moved by `travel` against its approach direction.
pub(crate) fn ways_to_obstacle(model: &Model, obstacle: usize, travel: f64) -> Vec<(usize, [f64; 3])> {
    let approach = model.obstacles()[obstacle].approach();
    let rows = model.rows().iter().filter(|row| row.obstacle == obstacle && length(row.normal) > 0.0);
    rows.map(|row| (row.node, row.normal.map(|part| (row.gap - travel * dot(&row.normal, &approach)) * part))).collect()
}

/// Direction from the body to the eye: on the side of the obstacle in view. Another body would hide the contact from
/// there: the eye is then beside the contact, a little on the side of the smaller of the two bodies.
pub(crate) fn eye(model: &Model, obstacle: Option<usize>) -> [f64; 3] {
    let Some(placed) = obstacle.and_then(|obstacle| model.obstacles().get(obstacle)) else { return EYE };
    let approach = placed.approach();
    if placed.rigid().is_some() {
        let side = |axis: usize| if approach[axis].abs() > 0.3 { approach[axis] } else { EYE[axis] };
        return [0, 1, 2].map(|axis| EYE[axis].abs().copysign(side(axis)));
    }
    let along = dot(&EYE, &approach);
    let aside = [0, 1, 2].map(|axis| EYE[axis] - along * approach[axis]);
    let tilt = if stands_on(model, obstacle) { -TILT } else { TILT };
    [0, 1, 2].map(|axis| aside[axis] / length(aside) + tilt * approach[axis])
}

/// Returns `true` if the body of the candidates of a pair is the smaller one.
fn stands_on(model: &Model, obstacle: Option<usize>) -> bool {
    let size = |node: usize| {
        let region = model.body().region_at(node).map(|region| &model.body().regions()[region]);
        let (low, high) = model.mesh().extent_of(region.map_or(0..0, |region| region.nodes()));
        length(minus(high, low))
    };
    let row = model.rows().iter().find(|row| Some(row.obstacle) == obstacle);
    let sizes = row.map(|row| row.ends.iter().map(|end| size(end.0)).collect::<Vec<f64>>());
    sizes.is_some_and(|sizes| sizes.len() > 1 && sizes[0] < sizes[1])
}
