//! The colour levels of a field, and their colour bar.

use super::axes::{Axis, LINE, NORMAL, SMALL};
use super::ticks::{Quantity, Scale, brief};
use crate::draw::colour::{Colour, FAINT, INK, NO_VALUE, field_colour};
use crate::draw::drawing::{Anchor, Drawing, Paint};
use crate::draw::typeface::{self, Weight};

/// Least number of bands of a colour range: enough to look smooth, few enough to follow a band with the eye.
const BANDS: f64 = 30.0;
const HEIGHT: f64 = 18.0;
const TICK: f64 = 5.0;
const GAP: f64 = 4.0;

/// Room that a bar needs from its top to the end of its label.
const ROOM: f64 = HEIGHT + TICK + GAP + SMALL * LINE + NORMAL * LINE;

/// Room for the note on values outside the range, below the label.
const NOTE: f64 = SMALL * LINE;

/// The smallest value below a range and the largest one above it, if there are any.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outside {
    pub below: Option<f64>,
    pub above: Option<f64>,
    /// `true` if there are values that are not finite.
    pub missing: bool,
}

impl Outside {
    /// Room for a bar with these values outside its range.
    pub fn room(self) -> f64 {
        ROOM + if self.below.is_some() || self.above.is_some() { NOTE } else { 0.0 }
    }
}

/// A range of values with its bands of colour. The edges of the bands include the ticks of the bar.
pub(crate) struct ColourRange {
    axis: Axis,
    /// Every band as its lower level with its colour: it is painted over the lower bands; the first one covers
    /// everything.
    bands: Vec<(f64, Colour)>,
}

impl ColourRange {
    /// The range of `quantity` between `limits`, for a bar of `length` pixels.
    pub fn new(quantity: &Quantity, limits: [f64; 2], length: f64) -> Self {
        let axis = Axis::horizontal(quantity, Scale::Linear, limits, length);
        let ticks = &axis.ticks.positions;
        let span = limits[1] - limits[0];
        let step = match ticks.as_slice() {
            [first, second, ..] => second - first,
            _ => span,
        };
        let parts = (BANDS * step / span).ceil().max(1.0);
        let (origin, width) = (ticks.first().copied().unwrap_or(limits[0]), step / parts);
        let first = ((limits[0] - origin) / width).floor();
        let edges = (1..=3 * BANDS as usize).map(|k| origin + (first + k as f64) * width);
        let slack = 1e-6 * width;
        let edges: Vec<f64> = edges.filter(|edge| (limits[0] + slack..limits[1] - slack).contains(edge)).collect();
        let lower = std::iter::once(limits[0]).chain(edges.iter().copied());
        let upper = edges.iter().copied().chain(std::iter::once(limits[1]));
        let colours = lower.zip(upper).map(|(lower, upper)| {
            let middle = Scale::Linear.fraction(0.5 * lower + 0.5 * upper, limits);
            field_colour(middle)
        });
        let bands = std::iter::once(f64::NEG_INFINITY).chain(edges.iter().copied()).zip(colours).collect();
        ColourRange { axis, bands }
    }

    /// The bands, from low to high.
    pub fn bands(&self) -> &[(f64, Colour)] {
        &self.bands
    }

    /// The colour of the band in which a value lies.
    pub fn colour(&self, value: f64) -> Colour {
        let bands = self.bands.iter();
        bands.rev().find(|band| value >= band.0).map_or(NO_VALUE, |band| band.1)
    }

    /// The values outside the range, in words; empty if there are none.
    fn note(&self, outside: Outside) -> String {
        let shown = |value: f64| self.value_shown(value);
        match (outside.below, outside.above) {
            (Some(low), Some(high)) => format!("beyond the scale: {} to {}", shown(low), shown(high)),
            (Some(low), None) => format!("below the scale: down to {}", shown(low)),
            (None, Some(high)) => format!("above the scale: up to {}", shown(high)),
            (None, None) => String::new(),
        }
    }

    /// A value in the unit of the label.
    fn value_shown(&self, value: f64) -> String {
        brief(value / 10f64.powi(self.axis.ticks.exponent))
    }

    /// Draws the bar with its left end at `corner`.
    pub fn draw(&self, drawing: &mut Drawing, [x, y]: [f64; 2], length: f64, outside: Outside) {
        let range = self.axis.range;
        let at = |value: f64| x + length * Scale::Linear.fraction(value, range);
        let bands = &self.bands;
        for (k, &(level, colour)) in bands.iter().enumerate() {
            // Each band is drawn to the end of the bar, so that no seam shows between neighbours.
            let from = if k == 0 { x } else { at(level) };
            drawing.rect([from, y], [x + length - from, HEIGHT], &Paint::fill(colour));
        }
        let mut outline = vec![[x, y], [x + length, y]];
        if outside.above.is_some() {
            let tip = [[x + length, y], [x + length + 0.7 * HEIGHT, y + 0.5 * HEIGHT], [x + length, y + HEIGHT]];
            drawing.polygon(&tip, &Paint::fill(bands[bands.len() - 1].1));
            outline.push(tip[1]);
        }
        outline.extend([[x + length, y + HEIGHT], [x, y + HEIGHT]]);
        if outside.below.is_some() {
            let tip = [[x, y], [x - 0.7 * HEIGHT, y + 0.5 * HEIGHT], [x, y + HEIGHT]];
            drawing.polygon(&tip, &Paint::fill(bands[0].1));
            outline.push(tip[1]);
        }
        drawing.polygon(&outline, &Paint::stroke(FAINT, 1.0));
        let bottom = y + HEIGHT;
        for (&position, label) in self.axis.ticks.positions.iter().zip(&self.axis.ticks.labels) {
            drawing.line([at(position), bottom], [at(position), bottom + TICK], &Paint::stroke(INK, 1.2));
            drawing.text([at(position), bottom + TICK + GAP + 0.75 * SMALL], label, SMALL, Anchor::Middle);
        }
        let label =
            if outside.missing { format!("{}; grey: no value", self.axis.label) } else { self.axis.label.clone() };
        let (label, size) = typeface::fitted(&label, NORMAL, Weight::Regular, length + 60.0);
        let baseline = bottom + TICK + GAP + SMALL * LINE + 0.8 * NORMAL;
        drawing.text([x + 0.5 * length, baseline], &label, size, Anchor::Middle);
        drawing.text([x + 0.5 * length, baseline + NOTE], &self.note(outside), SMALL, Anchor::Middle);
    }
}
