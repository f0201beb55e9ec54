//! Obstacles in a picture: their visible part and their drawing.

use crate::draw::colour::Colour;
use crate::draw::drawing::{Drawing, Paint};
use crate::plots::axes::Frame;
use crate::plots::ticks::Scale;

const EDGE: Colour = Colour(0x3c, 0x40, 0x48);
const INSIDE: Colour = Colour(0x80, 0x86, 0x90);

/// The visible edge of an obstacle and the side on which it is solid.
#[derive(Clone, Copy, Debug)]
pub struct ObstacleLine<'a> {
    /// Points of the edge, in the unit of length of the nodes; a closed line (its last point is its first) is a solid
    /// figure.
    pub points: &'a [[f64; 2]],
    /// A direction into the obstacle, of any length; not used for a closed line.
    pub inside: [f64; 2],
}

impl ObstacleLine<'_> {
    fn is_closed(&self) -> bool {
        self.points.len() > 3 && self.points.first() == self.points.last()
    }

    /// The unit vector into the obstacle; for a closed figure from the middle of the body to the middle of the figure.
    /// Zero if it is not defined.
    fn direction(&self, body: [[f64; 2]; 2]) -> [f64; 2] {
        let into = if self.is_closed() {
            let share = 1.0 / self.points.len() as f64;
            let mean = |axis: usize| self.points.iter().map(|point| share * point[axis]).sum::<f64>();
            [0, 1].map(|axis| mean(axis) - 0.5 * (body[axis][0] + body[axis][1]))
        } else {
            self.inside
        };
        let length = into[0].hypot(into[1]);
        if length > 0.0 && length.is_finite() { into.map(|part| part / length) } else { [0.0; 2] }
    }

    /// Returns `true` if the edge passes through the frame.
    pub(crate) fn is_seen(&self, frame: &Frame) -> bool {
        let places: Vec<[f64; 2]> = self.points.iter().map(|&point| frame.place(point)).collect();
        let far = [0, 1].map(|axis| frame.corner[axis] + frame.size[axis]);
        !visible(&places, frame.corner, far).is_empty()
    }

    /// The fill of a solid obstacle, and the edge.
    pub(crate) fn draw(&self, drawing: &mut Drawing, frame: &Frame) {
        let places: Vec<[f64; 2]> = self.points.iter().map(|&point| frame.place(point)).collect();
        let ([left, top], [width, height]) = (frame.corner, frame.size);
        // Points far outside the frame are cut off here: renderers compute in single precision.
        let far = 3.0 * (width + height);
        let pieces = visible(&places, [left - far, top - far], [left + width + far, top + height + far]);
        if self.is_closed() {
            drawing.polygon(&places, &inside_paint());
        } else {
            let [right, up] = self.direction([[0.0; 2]; 2]);
            let offset = [8.0 * far * right, -8.0 * far * up];
            for piece in &pieces {
                let shifted = piece.iter().rev().map(|point| [point[0] + offset[0], point[1] + offset[1]]);
                let region: Vec<[f64; 2]> = piece.iter().copied().chain(shifted).collect();
                drawing.polygon(&region, &inside_paint());
            }
        }
        drawing.polylines(&pieces, &edge_paint());
    }
}

pub(crate) fn draw_key(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    drawing.rect([x - 14.0, y - 4.0], [28.0, 10.0], &inside_paint());
    drawing.line([x - 14.0, y - 4.0], [x + 14.0, y - 4.0], &edge_paint());
}

fn inside_paint() -> Paint {
    // Transparent, so that a body inside the obstacle is visible.
    Paint { transparency: 0.55, ..Paint::fill(INSIDE) }
}

fn edge_paint() -> Paint {
    Paint::stroke(EDGE, 1.8)
}

/// The box of the picture: the body, a margin, and room on its side for each obstacle that is near.
pub(crate) fn window(points: impl Iterator<Item = [f64; 2]> + Clone, obstacles: &[ObstacleLine]) -> [[f64; 2]; 2] {
    let body = [0, 1].map(|axis| Scale::Linear.range(points.clone().map(|point| point[axis]), 0.0));
    let side = (body[0][1] - body[0][0]).max(body[1][1] - body[1][0]);
    let (margin, reach, strip) = (0.05 * side, 0.16 * side, 0.04 * side);
    let near = body.map(|[low, high]| [low - margin, high + margin]);
    let mut window = near;
    for obstacle in obstacles {
        let towards = obstacle.direction(body);
        let shift = towards.map(|part| reach * part);
        let low = [0, 1].map(|axis| near[axis][0] + shift[axis].min(0.0));
        let high = [0, 1].map(|axis| near[axis][1] + shift[axis].max(0.0));
        for point in visible(obstacle.points, low, high).into_iter().flatten() {
            for axis in 0..2 {
                // Only on the side of the obstacle: a long edge runs out of the picture at both ends.
                if towards[axis] > 0.2 {
                    window[axis][1] = window[axis][1].max(point[axis] + strip);
                } else if towards[axis] < -0.2 {
                    window[axis][0] = window[axis][0].min(point[axis] - strip);
                }
            }
        }
    }
    window
}

/// The pieces of a line within a box; broken if a coordinate is not finite.
fn visible(points: &[[f64; 2]], low: [f64; 2], high: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut connected = false;
    for pair in points.windows(2) {
        let Some((from, to)) = clipped(pair[0], pair[1], low, high) else {
            connected = false;
            continue;
        };
        match pieces.last_mut() {
            Some(piece) if connected && from == pair[0] => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
        connected = to == pair[1];
    }
    pieces
}

/// The part of a segment within a box.
///
/// # Source
/// Liang and Barsky, 1984, "A new concept and method for line clipping".
fn clipped(a: [f64; 2], b: [f64; 2], low: [f64; 2], high: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        let step = b[axis] - a[axis];
        if !step.is_finite() {
            return None;
        }
        let (to_low, to_high) = (low[axis] - a[axis], high[axis] - a[axis]);
        if step == 0.0 {
            if to_low > 0.0 || to_high < 0.0 {
                return None;
            }
            continue;
        }
        let (first, last) = if step > 0.0 { (to_low / step, to_high / step) } else { (to_high / step, to_low / step) };
        enter = enter.max(first);
        leave = leave.min(last);
    }
    let at = |part: f64| [0, 1].map(|axis| a[axis] + part * (b[axis] - a[axis]));
    let (from, to) = (if enter > 0.0 { at(enter) } else { a }, if leave < 1.0 { at(leave) } else { b });
    (enter < leave).then_some((from, to))
}
