//! The shapes of a drawing.

use super::colour::Colour;
use super::paint::{Anchor, Paint};
use super::typeface::Weight;

/// A shape of a drawing; each shape is drawn over those before it.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// Lines in hundredths of a pixel; closed ones are filled together by the even-odd rule.
    Path {
        pieces: Vec<Vec<[i64; 2]>>,
        line: Line,
        paint: Paint,
    },
    Circle {
        centre: [f64; 2],
        radius: f64,
        paint: Paint,
    },
    Text(Text),
    /// Shapes cut to the rectangle with its upper left corner at `corner`.
    Clipped {
        corner: [f64; 2],
        size: [f64; 2],
        shapes: Vec<Shape>,
    },
}

/// Open or closed line: a closed line returns to its first point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Line {
    Open,
    Closed,
}

/// A text with its baseline at `position`, from left to right or upwards.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    pub position: [f64; 2],
    pub text: String,
    pub size: f64,
    pub anchor: Anchor,
    pub weight: Weight,
    pub upward: bool,
    pub ink: Colour,
}
