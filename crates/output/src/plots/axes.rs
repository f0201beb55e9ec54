//! A rectangle of the drawing with axes: maps numbers to pixels, with ticks outside and labels that fit.

use super::ticks::{Quantity, Scale, Ticks, common_exponent};
use crate::draw::colour::{FAINT, GRID, INK};
use crate::draw::drawing::{Anchor, Drawing, Paint};
use crate::draw::typeface::{self, Weight};

/// Size of tick labels and legends in pixels.
pub(crate) const SMALL: f64 = 16.0;
/// Size of axis labels.
pub(crate) const NORMAL: f64 = 17.0;
/// Size of panel titles.
pub(crate) const LARGE: f64 = 18.0;
/// Size of the title of a picture.
pub(crate) const TITLE: f64 = 21.0;
/// Height of a line of text in multiples of its size.
pub(crate) const LINE: f64 = 1.35;
/// Space around a picture on a screen, in pixels.
pub(crate) const MARGIN: f64 = 24.0;

const TICK: f64 = 6.0;
const MINOR_TICK: f64 = 3.5;
const GAP: f64 = 5.0;

/// One axis: its quantity, scale, range and ticks.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub label: String,
    pub scale: Scale,
    pub range: [f64; 2],
    pub ticks: Ticks,
}

impl Axis {
    /// A horizontal axis of `length` pixels, with as many ticks as there is room for their labels.
    pub fn horizontal(quantity: &Quantity, scale: Scale, range: [f64; 2], length: f64) -> Self {
        let most = (length / 75.0).clamp(1.0, 8.0) as usize;
        let fits = |ticks: &Ticks| {
            let places = ticks.positions.iter().map(|&position| length * scale.fraction(position, range));
            let halves = ticks.labels.iter().map(|label| 0.5 * typeface::width(label, SMALL, Weight::Regular));
            let spans: Vec<[f64; 2]> = places.zip(halves).map(|(at, half)| [at - half, at + half]).collect();
            spans.windows(2).all(|pair| pair[0][1] + 0.6 * SMALL < pair[1][0])
        };
        // A single tick does not define a scale: a few more are tried before one is accepted.
        let counts = (1..=most).rev().chain(most + 1..most + 4);
        let fitting: Vec<Ticks> = counts.map(|count| Ticks::new(scale, range, count)).filter(fits).collect();
        let best = fitting.iter().find(|ticks| ticks.positions.len() > 1).or(fitting.first());
        let ticks = best.cloned().unwrap_or_default();
        Axis { label: quantity.label(ticks.exponent), scale, range, ticks }
    }

    /// A vertical axis of `length` pixels.
    pub fn vertical(quantity: &Quantity, scale: Scale, range: [f64; 2], length: f64) -> Self {
        let count = (length / 55.0).clamp(2.0, 8.0) as usize;
        let mut tried = (count..count + 4).map(|count| Ticks::new(scale, range, count));
        let ticks = tried.find(|ticks| ticks.positions.len() > 1).unwrap_or_else(|| Ticks::new(scale, range, count));
        Axis { label: quantity.label(ticks.exponent), scale, range, ticks }
    }

    /// The same linear axis, labelled in multiples of ten to another exponent.
    pub fn in_powers_of(mut self, quantity: &Quantity, exponent: i32) -> Self {
        self.ticks = self.ticks.in_powers_of(exponent);
        self.label = quantity.label(exponent);
        self
    }

    /// Room that a vertical axis needs left of its frame for ticks, their labels and its own label.
    pub fn room_left(&self) -> f64 {
        TICK + GAP + self.widest() + GAP + NORMAL * LINE
    }

    /// The largest overhang of the outermost labels of a horizontal axis beyond its frame.
    pub fn overhang(&self) -> f64 {
        0.5 * self.widest()
    }

    fn widest(&self) -> f64 {
        self.ticks.labels.iter().map(|label| typeface::width(label, SMALL, Weight::Regular)).fold(0.0, f64::max)
    }

    fn fraction(&self, value: f64) -> f64 {
        self.scale.fraction(value, self.range)
    }
}

/// Room that a horizontal axis needs below its frame.
pub(crate) const ROOM_BELOW: f64 = TICK + GAP + SMALL * LINE + NORMAL * LINE;

/// The axes of a frame that have labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Labels {
    Both,
    Horizontal,
}

/// A frame with its two axes.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    /// Upper left corner in pixels.
    pub corner: [f64; 2],
    /// Width and height of the frame, in pixels.
    pub size: [f64; 2],
    pub x: Axis,
    pub y: Axis,
}

impl Frame {
    /// The pixel at which a point of the axes lies; not a number if an axis cannot show it.
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        if !(self.x.scale.shows(x) && self.y.scale.shows(y)) {
            return [f64::NAN; 2];
        }
        let [along, up] = [self.x.fraction(x), self.y.fraction(y)];
        [self.corner[0] + along * self.size[0], self.corner[1] + (1.0 - up) * self.size[1]]
    }

    /// Grid lines at the ticks.
    pub fn draw_grid(&self, drawing: &mut Drawing) {
        let ([left, top], [width, height]) = (self.corner, self.size);
        let paint = Paint::stroke(GRID, 1.0);
        for &position in &self.x.ticks.positions {
            let x = left + width * self.x.fraction(position);
            drawing.line([x, top], [x, top + height], &paint);
        }
        for &position in &self.y.ticks.positions {
            let y = top + height * (1.0 - self.y.fraction(position));
            drawing.line([left, y], [left + width, y], &paint);
        }
    }

    /// The frame, its ticks and the labels of its axes.
    pub fn draw_axes(&self, drawing: &mut Drawing, labels: Labels) {
        let ([x0, y0], [width, height]) = (self.corner, self.size);
        let bottom = y0 + height;
        drawing.rect(self.corner, self.size, &Paint::stroke(FAINT, 1.0));
        let (ink, faint) = (Paint::stroke(INK, 1.2), Paint::stroke(FAINT, 1.0));
        for (position, label) in self.x.ticks.positions.iter().zip(&self.x.ticks.labels) {
            let x = x0 + width * self.x.fraction(*position);
            drawing.line([x, bottom], [x, bottom + TICK], &ink);
            drawing.text([x, bottom + TICK + GAP + 0.75 * SMALL], label, SMALL, Anchor::Middle);
        }
        for &position in &self.x.ticks.minor {
            let x = x0 + width * self.x.fraction(position);
            drawing.line([x, bottom], [x, bottom + MINOR_TICK], &faint);
        }
        let (label, size) = typeface::fitted(&self.x.label, NORMAL, Weight::Regular, width.max(150.0));
        let baseline = bottom + TICK + GAP + SMALL * LINE + 0.8 * NORMAL;
        drawing.text([x0 + 0.5 * width, baseline], &label, size, Anchor::Middle);

        for (position, label) in self.y.ticks.positions.iter().zip(&self.y.ticks.labels) {
            let y = y0 + height * (1.0 - self.y.fraction(*position));
            drawing.line([x0 - TICK, y], [x0, y], &ink);
            if labels == Labels::Both {
                drawing.text([x0 - TICK - GAP, y + 0.36 * SMALL], label, SMALL, Anchor::End);
            }
        }
        for &position in &self.y.ticks.minor {
            let y = y0 + height * (1.0 - self.y.fraction(position));
            drawing.line([x0 - MINOR_TICK, y], [x0, y], &faint);
        }
        if labels == Labels::Both {
            let (label, size) = typeface::fitted(&self.y.label, NORMAL, Weight::Regular, height.max(100.0));
            let baseline = x0 - TICK - GAP - self.y.widest() - 2.0 * GAP;
            drawing.upward_text([baseline, y0 + 0.5 * height], &label, size, Anchor::Middle);
        }
    }
}

/// The axes of a plane that is drawn with the same scale in both directions.
pub(crate) struct Plane {
    /// Width and height of the plane, in pixels.
    pub size: [f64; 2],
    pub x: Axis,
    pub y: Axis,
}

impl Plane {
    /// The axes of a window `[[x from, x to], [y from, y to]]`, as large as the larger of two sizes in pixels allows;
    /// white space fills what is missing to the smaller one.
    pub fn of([mut x, mut y]: [[f64; 2]; 2], [most, least]: [[f64; 2]; 2], names: &[Quantity; 2]) -> Self {
        let scale = (most[0] / (x[1] - x[0])).min(most[1] / (y[1] - y[0]));
        for (range, smallest) in [(&mut x, least[0]), (&mut y, least[1])] {
            let missing = 0.5 * (smallest / scale - (range[1] - range[0])).max(0.0);
            *range = [range[0] - missing, range[1] + missing];
        }
        let size = [x, y].map(|range| scale * (range[1] - range[0]));
        // One factor for both axes; otherwise one length would have two different numbers.
        let exponent = common_exponent([x, y].as_flattened().iter().fold(0.0, |largest, end| end.abs().max(largest)));
        let x = Axis::horizontal(&names[0], Scale::Linear, x, size[0]).in_powers_of(&names[0], exponent);
        let y = Axis::vertical(&names[1], Scale::Linear, y, size[1]).in_powers_of(&names[1], exponent);
        Plane { size, x, y }
    }
}

/// Lines of text one below the other, centred at `x`; the first begins at `top`.
pub(crate) fn draw_heading(drawing: &mut Drawing, lines: &[String], x: f64, top: f64) {
    for (k, line) in lines.iter().enumerate() {
        drawing.bold_text([x, top + TITLE * (0.85 + LINE * k as f64)], line, TITLE, Anchor::Middle);
    }
}
