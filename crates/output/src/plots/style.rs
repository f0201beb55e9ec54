//! The styles of lines in a plot: colour, marker and dash differ together, so that each alone is enough.

use crate::draw::colour::{Colour, PALETTE, WHITE};
use crate::draw::drawing::{Drawing, Paint};

/// Width of a key in a legend: enough to see a dash and a marker.
pub(crate) const KEY: f64 = 42.0;

const DASHES: [&[f64]; 5] = [&[], &[9.0, 4.0], &[2.5, 3.5], &[12.0, 4.0, 2.5, 4.0], &[5.0, 3.0]];

/// Colours and widths of nested lines and their markers; the first line is the widest, a fifth repeats the last. The
/// fourth, a formula, has no markers.
const NESTED: [(Colour, f64, f64); 4] = [
    (Colour(0x8c, 0xc9, 0xee), 9.0, 9.0),
    (Colour(0xe0, 0x6c, 0x10), 4.2, 5.2),
    (Colour(0x15, 0x15, 0x15), 1.5, 2.6),
    (Colour(0x00, 0x8a, 0x5e), 2.4, 0.0),
];

/// The look of one line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Style {
    index: usize,
    nested: bool,
}

impl Style {
    /// The look of the line with this index.
    pub fn of(index: usize) -> Self {
        Style { index, nested: false }
    }

    /// The look of the line with this index among lines that become thinner one by one, so that coinciding lines are
    /// all visible.
    pub fn nested(index: usize) -> Self {
        Style { index, nested: true }
    }

    fn colour(self) -> Colour {
        if self.nested { self.nest().0 } else { PALETTE[self.index % PALETTE.len()] }
    }

    fn nest(self) -> (Colour, f64, f64) {
        NESTED[self.index.min(NESTED.len() - 1)]
    }

    fn line(self) -> Paint {
        if self.nested {
            let dash: &[f64] = if self.index == 1 { &[10.0, 6.0] } else { &[] };
            return Paint::stroke(self.colour(), self.nest().1).dashed(dash);
        }
        Paint::stroke(self.colour(), 2.2).dashed(DASHES[self.index % DASHES.len()])
    }

    /// A line with a marker at every `every`-th point, and at the points that no line reaches.
    pub fn draw(self, drawing: &mut Drawing, places: &[[f64; 2]], every: usize) {
        drawing.polyline(places, &self.line());
        let drawn = |k: usize| places.get(k).is_some_and(|place| place[0].is_finite());
        for (k, &place) in places.iter().enumerate() {
            let alone = !(k > 0 && drawn(k - 1) || drawn(k + 1));
            if drawn(k) && (alone || k % every.max(1) == 0) {
                self.marker(drawing, place);
            }
        }
    }

    /// The key of the line in a legend.
    pub fn key(self, drawing: &mut Drawing, [x, y]: [f64; 2]) {
        drawing.line([x - 0.5 * KEY, y], [x + 0.5 * KEY, y], &self.line());
        self.marker(drawing, [x, y]);
    }

    /// The key of marks that no line joins.
    pub fn mark(self, drawing: &mut Drawing, centre: [f64; 2]) {
        self.marker(drawing, centre);
    }

    fn marker(self, drawing: &mut Drawing, [x, y]: [f64; 2]) {
        let colour = self.colour();
        let size = if self.nested { self.nest().2 } else { 5.0 };
        let paint = match (self.nested, self.index) {
            (false, _) => Paint::fill(colour).with_stroke(WHITE, 1.0),
            (true, 0 | 1) => Paint::fill(WHITE).with_stroke(colour, 2.2),
            (true, _) => Paint::fill(colour),
        };
        match self.index % 5 {
            0 => drawing.circle([x, y], size, &paint),
            1 => drawing.polygon(&around([x, y], 1.25 * size, 4, 0.125), &paint),
            2 if self.nested => drawing.circle([x, y], size, &paint),
            2 => drawing.polygon(&around([x, y], 1.35 * size, 3, 0.25), &paint),
            3 => drawing.polygon(&around([x, y], 1.3 * size, 4, 0.25), &paint),
            _ => drawing.polygon(&around([x, y], 1.35 * size, 3, 0.75), &paint),
        }
    }
}

/// Corners of a regular polygon; `turn` is the angle of its first corner in full turns.
fn around([x, y]: [f64; 2], radius: f64, corners: usize, turn: f64) -> Vec<[f64; 2]> {
    let angle = |k: usize| std::f64::consts::TAU * (turn + k as f64 / corners as f64);
    (0..corners).map(|k| [x + radius * angle(k).cos(), y - radius * angle(k).sin()]).collect()
}
