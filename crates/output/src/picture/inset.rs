//! A contact that is small beside the body, enlarged in a corner of its panel.

use crate::draw::colour::{Colour, WHITE};
use crate::draw::drawing::{Anchor, Drawing, Paint};
use crate::draw::typeface::{self, Weight};
use crate::plots::axes::{Axis, Frame, SMALL};
use crate::plots::ticks::{Quantity, Scale, amount, brief};

/// A contact below this share of the panel is enlarged.
const SMALL_CONTACT: f64 = 0.05;
/// Side of the enlarged part as a share of the shorter side of the panel, and in pixels at most.
const SIDE: f64 = 0.44;
const MOST_SIDE: f64 = 240.0;
/// Width of the enlarged part, as a multiple of the width of the contact.
const AROUND: f64 = 2.2;
/// Largest magnification (a single node has no width) and smallest one (less would show nothing new).
const MOST_TIMES: f64 = 1e6;
const FEWEST_TIMES: f64 = 2.5;

const BORDER: Colour = Colour(0x5a, 0x64, 0x72);

/// A part of a panel, enlarged.
pub(crate) struct Inset {
    /// The frame of the enlarged part.
    pub frame: Frame,
    /// The same part in the panel: its corner and its side in pixels.
    part: ([f64; 2], f64),
}

impl Inset {
    /// The inset of a contact with these `closed` nodes, if it is small. It should not cover the `open` candidates and
    /// all `moved` nodes.
    pub fn of(
        frame: &Frame,
        closed: &[[f64; 2]],
        open: impl Iterator<Item = [f64; 2]> + Clone,
        moved: &[[f64; 2]],
    ) -> Option<Self> {
        let window = [frame.x.range, frame.y.range].map(|[from, to]| to - from);
        let largest = window[0].max(window[1]);
        let ends = |axis: usize| {
            let values = closed.iter().map(|place| place[axis]).filter(|value| value.is_finite());
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
        };
        let zone = [ends(0), ends(1)];
        let extent = (zone[0][1] - zone[0][0]).max(zone[1][1] - zone[1][0]);
        if !(extent.is_finite() && extent < SMALL_CONTACT * largest) {
            return None;
        }
        let middle = zone.map(|[low, high]| 0.5 * (low + high));
        // A single node: up to the next candidates.
        let near = open.filter_map(|place| {
            let away = (place[0] - middle[0]).hypot(place[1] - middle[1]);
            (away > 0.6 * extent).then_some(away)
        });
        let reach = if extent > 1e-9 * largest { extent } else { 2.0 * near.fold(f64::INFINITY, f64::min) };
        let half = 0.5 * AROUND * reach.max(largest / MOST_TIMES);
        if half >= 0.25 * largest {
            return None;
        }
        let side = (SIDE * frame.size[0].min(frame.size[1])).min(MOST_SIDE);
        if side < FEWEST_TIMES * 2.0 * half / window[0] * frame.size[0] {
            return None;
        }
        let at = frame.place(middle);
        let corner = free_corner(frame, side, at, moved);
        let [x, y] = middle.map(|middle| [middle - half, middle + half]);
        let unnamed = Quantity::default();
        let inner = Frame {
            corner,
            size: [side, side],
            x: Axis::horizontal(&unnamed, Scale::Linear, x, side),
            y: Axis::vertical(&unnamed, Scale::Linear, y, side),
        };
        let small = 2.0 * half / window[0] * frame.size[0];
        Some(Inset { frame: inner, part: ([at[0] - 0.5 * small, at[1] - 0.5 * small], small) })
    }

    /// The white ground, and a mark of the enlarged part in the panel.
    pub fn draw_ground(&self, drawing: &mut Drawing, panel: &Frame) {
        let (corner, small) = self.part;
        let seen = small.max(7.0);
        let mark = [0, 1].map(|axis| corner[axis] + 0.5 * (small - seen));
        let side = self.frame.size[0];
        let paint = Paint::stroke(BORDER, 1.0);
        drawing.clipped(panel.corner, panel.size, |drawing| {
            for share in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
                let from = [0, 1].map(|axis| mark[axis] + share[axis] * seen);
                let to = [0, 1].map(|axis| self.frame.corner[axis] + share[axis] * side);
                drawing.line(from, to, &paint.dashed(&[4.0, 3.0]));
            }
        });
        drawing.rect(mark, [seen, seen], &paint);
        drawing.rect(self.frame.corner, self.frame.size, &Paint::fill(WHITE));
    }

    /// The border, and the size of the enlarged part.
    pub fn draw_frame(&self, drawing: &mut Drawing, length_unit: &str) {
        let ([x, y], [side, _]) = (self.frame.corner, self.frame.size);
        drawing.rect([x, y], [side, side], &Paint::stroke(BORDER, 1.4));
        let [from, to] = self.frame.x.range;
        let times = brief(round_to_two(side / self.part.1));
        let text = format!("× {times}: {} wide", amount(round_to_two(to - from), length_unit));
        let (text, size) = typeface::fitted(&text, SMALL, Weight::Regular, side - 10.0);
        let width = typeface::width(&text, size, Weight::Regular) + 10.0;
        drawing.rect([x, y], [width, 1.4 * SMALL], &Paint::fill(WHITE).with_stroke(BORDER, 1.0));
        drawing.text([x + 5.0, y + 1.05 * SMALL], &text, size, Anchor::Start);
    }
}

/// The corner of a square in the frame that is far from `at` and covers few nodes.
fn free_corner(frame: &Frame, side: f64, at: [f64; 2], moved: &[[f64; 2]]) -> [f64; 2] {
    const INSET: f64 = 8.0;
    let shares = [0.0, 0.5, 1.0];
    let places: Vec<[f64; 2]> = moved.iter().map(|&point| frame.place(point)).collect();
    let corners = shares.iter().flat_map(|&right| shares.iter().map(move |&down| [right, down]));
    let corners = corners.map(|share| {
        [0, 1].map(|axis| frame.corner[axis] + INSET + share[axis] * (frame.size[axis] - side - 2.0 * INSET))
    });
    let covered = |corner: &[f64; 2]| {
        let inside = |place: &[f64; 2]| (0..2).all(|axis| (0.0..=side).contains(&(place[axis] - corner[axis])));
        let count = places.iter().filter(|place| inside(place)).count() as f64 / places.len().max(1) as f64;
        let away = [0, 1].map(|axis| (at[axis] - corner[axis] - 0.5 * side).abs());
        // The contact itself must stay in sight.
        let hides = if away[0].max(away[1]) < 0.5 * side + 12.0 { 1e3 } else { 0.0 };
        let distance = away[0].hypot(away[1]) / (frame.size[0] + frame.size[1]);
        hides + count + 0.2 * distance
    };
    corners.min_by(|a, b| covered(a).total_cmp(&covered(b))).unwrap_or(frame.corner)
}

/// To two significant digits.
fn round_to_two(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return value;
    }
    let unit = 10f64.powf(value.log10().floor() - 1.0);
    (value / unit).round() * unit
}
