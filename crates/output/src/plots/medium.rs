//! The medium of a picture: a screen, or the page of a paper.

use super::axes::MARGIN;

/// The medium of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Medium {
    /// SVG and PNG with a title.
    #[default]
    Screen,
    /// PDF and SVG, as wide as one column of a journal (85 mm) or two (170 mm), with letters on the panels and without
    /// a title, which belongs in the caption.
    Paper,
}

/// Pixels in a millimetre of paper: the letters of an axis are then 8 points high.
const PIXELS: f64 = 5.67;

/// Widths of one column of a journal and of two, in millimetres.
const COLUMNS: [f64; 2] = [85.0, 170.0];

impl Medium {
    /// The width on paper in millimetres for this number of panels side by side; `None` on a screen.
    pub fn millimetres(self, panels: usize) -> Option<f64> {
        (self == Medium::Paper).then_some(COLUMNS[usize::from(panels > 1)])
    }

    /// The width of a picture in pixels: on a screen `screen`.
    pub fn width(self, panels: usize, screen: f64) -> f64 {
        self.millimetres(panels).map_or(screen, |millimetres| PIXELS * millimetres)
    }

    /// Space around a picture on this medium, in pixels.
    pub fn margin(self) -> f64 {
        if self == Medium::Paper { 6.0 } else { MARGIN }
    }

    /// The title of the panel of this index, with its letter if several panels are on paper.
    pub fn panel_title(self, index: usize, panels: usize, title: &str) -> String {
        let letter = char::from(b'a' + (index % 26) as u8);
        match self {
            Medium::Paper if panels > 1 => format!("({letter}) {title}").trim_end().to_owned(),
            _ => title.to_owned(),
        }
    }

    /// The lines of the title; empty on paper.
    pub fn title(self, lines: Vec<String>) -> Vec<String> {
        if self == Medium::Paper { Vec::new() } else { lines }
    }
}
