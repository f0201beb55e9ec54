//! How a displacement is magnified beside rigid obstacles.
//!
//! The displacement of the body is drawn `m` times as large. An obstacle is rigid: it is shifted as a whole by `m - 1`
//! times the mean displacement of the nodes that it touches, and keeps its shape. Body and obstacle then touch in the
//! picture at the centre of their contact. Beside it they touch to within `m - 1` times the differences of the
//! displacement, and `m` is at most so large that nobody sees them.

use signorini_mechanics::fem::geometry::{length, minus};
use signorini_mechanics::scene::{Answer, Model};
use signorini_qp::dot;

/// The largest displacement is drawn at about this share of the size of the body.
const SEEN: f64 = 0.05;
/// The distance between a closed node and the drawn obstacle, and the depth of an open node in it, are at most this
/// share of the size of the body: less than a dot.
const UNSEEN: f64 = 0.01;
/// The same as a share of the extent of the contact, which may be drawn enlarged.
const UNSEEN_IN_CONTACT: f64 = 0.05;

/// Magnification that makes the displacement visible: 1, 2 or 5 times a power of ten, at least 1. It is 1 if another
/// body is an obstacle, because that body is displaced by itself.
pub(crate) fn magnification(answer: &Answer) -> f64 {
    let (model, dimension) = (answer.model(), answer.model().mesh().dimension());
    if has_pairs(model) {
        return 1.0;
    }
    let (low, high) = model.mesh().extent();
    let size = (0..dimension).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let moved = answer.displacement().chunks_exact(dimension).map(|u| length(in_space(u)));
    let most = SEEN * size / moved.filter(|moved| moved.is_finite()).fold(0.0, f64::max);
    let fits = (0..model.obstacles().len()).map(|obstacle| most_beside(answer, obstacle, size));
    rounded_down(fits.fold(most, f64::min))
}

/// The mean displacement of the nodes that touch an obstacle, weighted with their forces, in the unit of length.
/// Without contact it is that of the surface at the deepest node in the obstacle, as in the first steps of a search;
/// zero if no node is inside.
pub(crate) fn carried(answer: &Answer, obstacle: usize) -> [f64; 3] {
    let dimension = answer.model().mesh().dimension();
    let rows = answer.model().rows().iter().zip(answer.multiplier());
    let (mut sum, mut force) = ([0.0; 3], 0.0);
    for (row, lambda) in rows.filter(|(row, _)| row.obstacle == obstacle) {
        let moved = displacement(answer, dimension, row.node);
        (0..3).for_each(|axis| sum[axis] -= lambda * moved[axis]);
        force -= lambda;
    }
    if force > 0.0 {
        return sum.map(|part| part / force);
    }
    let remaining = answer.remaining_gaps();
    let inside =
        answer.model().rows().iter().zip(remaining).filter(|(row, gap)| row.obstacle == obstacle && *gap < 0.0);
    let deepest = inside.min_by(|(_, a), (_, b)| a.total_cmp(b));
    deepest.map_or([0.0; 3], |(row, gap)| {
        let moved = displacement(answer, dimension, row.node);
        [0, 1, 2].map(|axis| moved[axis] + gap * row.normal[axis])
    })
}

/// The shift by which an obstacle is drawn beside a body whose displacement is magnified.
pub(crate) fn drawn_shift(answer: &Answer, obstacle: usize, magnification: f64) -> [f64; 3] {
    carried(answer, obstacle).map(|part| (magnification - 1.0) * part)
}

/// The name of obstacles in a legend.
pub(crate) fn obstacle_name(magnification: f64) -> &'static str {
    if magnification == 1.0 { "obstacle" } else { "obstacle, rigid, shifted with its contact" }
}

/// The largest magnification at which contact looks like contact: closed nodes lie on the drawn obstacle, open nodes
/// outside.
fn most_beside(answer: &Answer, obstacle: usize, size: f64) -> f64 {
    let (model, dimension) = (answer.model(), answer.model().mesh().dimension());
    let (carried, remaining) = (carried(answer, obstacle), answer.remaining_gaps());
    let is_closed = |index: usize| answer.contact_set().contains(index);
    let unseen = (UNSEEN * size).min(match extent_of_contact(answer, obstacle) {
        extent if extent > 0.0 => UNSEEN_IN_CONTACT * extent,
        _ => f64::INFINITY,
    });
    let rows = model.rows().iter().enumerate().filter(|(_, row)| row.obstacle == obstacle);
    let fits = rows.map(|(index, row)| {
        let leaves = dot(&row.normal, &minus(carried, displacement(answer, dimension, row.node)));
        match is_closed(index) {
            true => unseen / leaves.abs(),
            false if leaves < 0.0 => (unseen + remaining[index].max(0.0)) / -leaves,
            false => f64::INFINITY,
        }
    });
    1.0 + fits.fold(f64::INFINITY, f64::min)
}

/// The largest extent of the closed nodes of an obstacle along a coordinate.
fn extent_of_contact(answer: &Answer, obstacle: usize) -> f64 {
    let rows = answer.model().rows().iter().enumerate().filter(|(_, row)| row.obstacle == obstacle);
    let closed = rows.filter(|(index, _)| answer.contact_set().contains(*index));
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for (_, row) in closed {
        let at = answer.model().mesh().nodes()[row.node];
        (0..3).for_each(|axis| ends[axis] = [ends[axis][0].min(at[axis]), ends[axis][1].max(at[axis])]);
    }
    ends.into_iter().map(|[low, high]| high - low).fold(0.0, f64::max)
}

fn displacement(answer: &Answer, dimension: usize, node: usize) -> [f64; 3] {
    answer.displacement().get(dimension * node..dimension * (node + 1)).map_or([0.0; 3], in_space)
}

fn in_space(components: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|axis| components.get(axis).copied().unwrap_or(0.0))
}

/// Returns `true` if an obstacle of the model is another of its bodies.
pub(crate) fn has_pairs(model: &Model) -> bool {
    model.obstacles().iter().any(|obstacle| obstacle.rigid().is_none())
}

/// 1, 2 or 5 times a power of ten, at most `value`; 1 if the result is less than 1 or not a number.
fn rounded_down(value: f64) -> f64 {
    if value.is_finite() && value >= 2.0 { rounded_length(value) } else { 1.0 }
}

/// 1, 2 or 5 times a power of ten, at most `value`, which is positive.
pub(crate) fn rounded_length(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let factor = [5.0, 2.0, 1.0].into_iter().find(|factor| factor * power <= value * 1.000001).unwrap_or(1.0);
    factor * power
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::{UNSEEN, drawn_shift, magnification};
    use signorini_mechanics::scene::{Answer, Scene};
    use signorini_qp::{Settings, solve};

    /// A block of size 4 under a circle of radius 4 around (2, 5.98); the circle is checked by its equation.
    #[test]
    fn contact_looks_like_contact_at_the_chosen_magnification_and_not_far_beyond_it() {
        let text = r#"{
            "body": {"rectangle": {"x": {"points": [0, 4], "divisions": [40]}, "y": {"points": [0, 2], "divisions": [10]}}},
            "material": {"young": 100, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": [2, 1.98], "radius": 4}}}]
        }"#;
        let scene: Scene = serde_json::from_str(text).unwrap();
        let model = Arc::new(scene.build().unwrap());
        let solution = solve(model.problem(), &Settings::default()).unwrap();
        let answer = Answer::of(model.clone(), &solution).unwrap();
        // The largest depth of a node in the circle, and the largest distance of a closed node from it.
        let misfit = |times: f64| {
            let shift = drawn_shift(&answer, 0, times);
            let mut largest: f64 = 0.0;
            for (index, row) in model.rows().iter().enumerate() {
                let (at, u) = (model.mesh().nodes()[row.node], &answer.displacement()[2 * row.node..]);
                let away = [0, 1].map(|axis| at[axis] + times * u[axis] - [2.0, 5.98][axis] - shift[axis]);
                let outside = away[0].hypot(away[1]) - 4.0;
                let is_closed = answer.contact_set().contains(index);
                largest = largest.max(if is_closed { outside.abs() } else { -outside });
            }
            largest
        };
        let times = magnification(&answer);
        // The rows are linear: the true displacement itself is off by its square over the radius.
        assert!(times >= 2.0 && misfit(times) < 1.1 * UNSEEN * 4.0, "{times}: {}", misfit(times));
        assert!(misfit(5.0 * times) > UNSEEN * 4.0, "{}", misfit(5.0 * times));
        // Before the first contact the overlap of 0.02 is magnified as well.
        let mut free = solution;
        free.displacement.fill(0.0);
        free.multiplier.fill(0.0);
        let answer = Answer::of(model, &free).unwrap();
        let [x, y, _] = drawn_shift(&answer, 0, 3.0);
        assert!(x == 0.0 && (y + 2.0 * 0.02).abs() < 1e-12, "{x} {y}");
    }
}
