//! Names beside the lines of a plot, where they cover least.

use super::axes::{Frame, SMALL};
use crate::draw::colour::{Colour, WHITE};
use crate::draw::drawing::{Anchor, Drawing, Paint};
use crate::draw::typeface::{self, Weight};

/// Possible positions of a name beside a point: pixels to the right (negative to the left, zero centred), and the
/// distance of its upper edge below the point in multiples of its height.
const BESIDE: [(f64, f64); 14] = [
    (12.0, -0.5),
    (-12.0, -0.5),
    (0.0, -1.6),
    (0.0, 0.6),
    (12.0, -1.5),
    (-12.0, -1.5),
    (12.0, 0.5),
    (-12.0, 0.5),
    (8.0, -2.6),
    (-8.0, -2.6),
    (8.0, 1.6),
    (-8.0, 1.6),
    (24.0, 2.7),
    (-24.0, 2.7),
];

/// The same hue, dark enough for letters on white.
pub(crate) fn darker(Colour(red, green, blue): Colour) -> Colour {
    let part = |channel: u8| (f64::from(channel) * 0.72) as u8;
    Colour(part(red), part(green), part(blue))
}

/// The areas that lines and names already cover.
pub(crate) struct Taken {
    low: [f64; 2],
    high: [f64; 2],
    points: Vec<[f64; 2]>,
    marks: Vec<[f64; 2]>,
    boxes: Vec<[[f64; 2]; 2]>,
}

impl Taken {
    pub fn new(frame: &Frame) -> Self {
        let high = [0, 1].map(|axis| frame.corner[axis] + frame.size[axis]);
        Taken { low: frame.corner, high, points: Vec::new(), marks: Vec::new(), boxes: Vec::new() }
    }

    pub fn add_line(&mut self, places: &[[f64; 2]]) {
        self.marks.extend(places);
        for pair in places.windows(2).filter(|pair| pair.iter().all(|place| place[0].is_finite())) {
            let step = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let parts = (step[0].hypot(step[1]) / 8.0).ceil().min(500.0) as usize;
            self.points
                .extend((1..parts).map(|k| [0, 1].map(|axis| pair[0][axis] + step[axis] * k as f64 / parts as f64)));
        }
    }

    /// Writes a name beside one of the points of its line, at the position that covers the least.
    pub fn label(&mut self, drawing: &mut Drawing, name: &str, colour: Colour, places: &[[f64; 2]]) {
        let (text, size) = typeface::fitted(name, SMALL, Weight::Regular, 0.6 * (self.high[0] - self.low[0]));
        let (width, height) = (typeface::width(&text, size, Weight::Regular), 1.15 * size);
        let mut best: Option<(f64, [f64; 2])> = None;
        for &[x, y] in places.iter().filter(|place| place[0].is_finite()) {
            for (right, down) in BESIDE {
                let left = match right {
                    right if right > 0.0 => x + right,
                    right if right < 0.0 => x + right - width,
                    _ => x - 0.5 * width,
                };
                let low = [left, y + down * height];
                let cost = self.cost(low, [left + width, low[1] + height]);
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, low));
                }
            }
        }
        let Some((_, low)) = best else { return };
        let high = [low[0] + width, low[1] + height];
        self.boxes.push([low, high]);
        drawing.rect(
            [low[0] - 3.0, low[1]],
            [width + 6.0, height],
            &Paint { transparency: 0.25, ..Paint::fill(WHITE) },
        );
        drawing.coloured_text([low[0], high[1] - 0.28 * size], &text, size, Anchor::Start, colour);
    }

    fn cost(&self, low: [f64; 2], high: [f64; 2]) -> f64 {
        let outside = (0..2).any(|axis| low[axis] < self.low[axis] + 4.0 || high[axis] > self.high[axis] - 4.0);
        let crosses = |other: &&[[f64; 2]; 2]| {
            // A line of text includes white space: texts may touch vertically, but not horizontally.
            let apart = [4.0, -2.0];
            (0..2).all(|axis| low[axis] < other[1][axis] + apart[axis] && other[0][axis] < high[axis] + apart[axis])
        };
        let covers = |point: &&[f64; 2]| (0..2).all(|axis| (low[axis] - 5.0..high[axis] + 5.0).contains(&point[axis]));
        let boxes = self.boxes.iter().filter(crosses).count();
        let points = self.points.iter().filter(covers).count();
        let marks = self.marks.iter().filter(covers).count();
        if outside { 1e6 } else { 1e3 * boxes as f64 + 60.0 * marks as f64 + points as f64 }
    }
}
