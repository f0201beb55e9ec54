//! The paint of shapes, the anchors of texts, and numbers in the form of SVG.

use std::fmt::Write;

use super::colour::Colour;

/// The fill and the stroke of a shape.
#[derive(Clone, Copy, Debug, Default)]
pub struct Paint {
    /// Colour of the inside, if it has one.
    pub fill: Option<Colour>,
    /// Transparency of the fill: 0 opaque, 1 invisible.
    pub transparency: f64,
    /// Colour of the line, if it has one.
    pub stroke: Option<Colour>,
    /// Width of the line in pixels.
    pub width: f64,
    /// Lengths of dashes and gaps in pixels; empty for a solid line.
    pub dash: &'static [f64],
}

impl Paint {
    /// A filled shape without a line.
    pub fn fill(colour: Colour) -> Self {
        Paint { fill: Some(colour), ..Paint::default() }
    }

    /// A line of `width` pixels.
    pub fn stroke(colour: Colour, width: f64) -> Self {
        Paint { stroke: Some(colour), width, ..Paint::default() }
    }

    /// The same with a line of `width` pixels around it.
    pub fn with_stroke(self, colour: Colour, width: f64) -> Self {
        Paint { stroke: Some(colour), width, ..self }
    }

    /// The same with a dashed line.
    pub fn dashed(self, dash: &'static [f64]) -> Self {
        Paint { dash, ..self }
    }

    pub(crate) fn attributes(&self) -> String {
        let mut text = match self.fill {
            Some(colour) => format!(" fill=\"{}\"", hex(colour)),
            None => " fill=\"none\"".to_owned(),
        };
        if self.fill.is_some() && self.transparency > 0.0 {
            let _ = write!(text, " fill-opacity=\"{}\"", number(1.0 - self.transparency));
        }
        if let Some(colour) = self.stroke {
            let _ = write!(text, " stroke=\"{}\" stroke-width=\"{}\"", hex(colour), number(self.width));
            if !self.dash.is_empty() {
                let dash: Vec<String> = self.dash.iter().map(|&length| number(length)).collect();
                let _ = write!(text, " stroke-dasharray=\"{}\"", dash.join(" "));
            }
        }
        text
    }
}

/// The point of a text at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// The text is centred there.
    Middle,
    /// The text ends there.
    End,
}

/// A coordinate to a hundredth of a pixel, in its shortest form.
pub(crate) fn number(value: f64) -> String {
    hundredths((value * 100.0).round() as i64)
}

/// The same for a number of hundredths.
pub(crate) fn hundredths(value: i64) -> String {
    let (sign, value) = (if value < 0 { "-" } else { "" }, value.unsigned_abs());
    let (whole, rest) = (value / 100, value % 100);
    match (whole, rest) {
        (_, 0) => format!("{sign}{whole}"),
        (0, rest) if rest % 10 == 0 => format!("{sign}.{}", rest / 10),
        (0, rest) => format!("{sign}.{rest:02}"),
        (whole, rest) if rest % 10 == 0 => format!("{sign}{whole}.{}", rest / 10),
        (whole, rest) => format!("{sign}{whole}.{rest:02}"),
    }
}

/// A colour as SVG writes it.
pub(crate) fn hex(Colour(red, green, blue): Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
