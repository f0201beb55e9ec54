//! The crossings of a line along an axis with a surface, without leaks: the line is moved aside by two infinitely small
//! steps, so that it meets no edge and no corner; the side of an edge on which it runs is decided exactly.

use robust::{Coord, orient2d};

use super::closed::ClosedSurface;

/// A crossing of a line with a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// The coordinate along the axis.
    pub at: f64,
    /// Change of the number of solids around the line at the crossing, in the direction of the axis: 1 into a solid, -1
    /// out of a solid.
    pub turns: i32,
}

impl ClosedSurface {
    /// The crossings of the line along `axis` through a point, increasing.
    pub(crate) fn crossings(&self, axis: usize, point: [f64; 3]) -> Vec<Crossing> {
        let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
        let across = |at: [f64; 3]| Coord { x: at[first], y: at[second] };
        let mut crossings = Vec::new();
        self.tree.along(axis, point, |triangle| {
            let corners = self.triangle(triangle).0;
            let sides = [0, 1, 2].map(|corner| {
                side(across(corners[(corner + 1) % 3]), across(corners[(corner + 2) % 3]), across(point))
            });
            let turns = match sides.map(|side| side.0) {
                [1, 1, 1] => -1,
                [-1, -1, -1] => 1,
                _ => return,
            };
            // The area on each side is the weight of the opposite corner.
            let sum: f64 = sides.iter().map(|side| side.1).sum();
            let share = |corner: usize| if sum == 0.0 { 0.0 } else { sides[corner].1 / sum };
            let [a, b, c] = corners.map(|corner| corner[axis]);
            crossings.push(Crossing { at: a + share(1) * (b - a) + share(2) * (c - a), turns });
        });
        crossings.sort_by(|a, b| a.at.total_cmp(&b.at));
        crossings
    }

    /// Returns `true` for a point inside a solid.
    pub(super) fn contains(&self, point: [f64; 3]) -> bool {
        // The choice of the axis does not matter.
        let before = self.crossings(2, point).into_iter().filter(|crossing| crossing.at < point[2]);
        before.map(|crossing| crossing.turns).sum::<i32>() > 0
    }
}

/// The side of the line from `a` to `b` on which the point lies after an infinitely small step along x and an
/// infinitely smaller step along y: 1 left, -1 right, 0 if `a` and `b` are the same; and twice the area of their
/// triangle before these steps.
fn side(a: Coord<f64>, b: Coord<f64>, point: Coord<f64>) -> (i32, f64) {
    let area = orient2d(a, b, point);
    let moved = if area != 0.0 {
        area
    } else if a.y != b.y {
        a.y - b.y
    } else {
        b.x - a.x
    };
    (i32::from(moved > 0.0) - i32::from(moved < 0.0), area)
}
