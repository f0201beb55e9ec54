//! A drawing: shapes and texts in pixels, written as SVG or painted as PNG.

use tiny_skia::Pixmap;

use super::colour::{Colour, INK};
pub(crate) use super::paint::{Anchor, Paint};
use super::shape::{Line, Shape, Text};
use super::typeface::Weight;
use super::{pdf, raster, svg};
use signorini_mechanics::Error;

/// Coordinates beyond this are not drawn; renderers compute in single precision.
const FARTHEST: f64 = 1e6;

/// A drawing in pixels, x to the right and y downwards, on white.
#[derive(Clone, Debug)]
pub struct Drawing {
    width: f64,
    height: f64,
    /// Width on paper in millimetres; `None` on a screen.
    millimetres: Option<f64>,
    shapes: Vec<Shape>,
}

impl Drawing {
    /// An empty drawing of `width` times `height` pixels; at least one pixel each way.
    pub fn new(width: f64, height: f64) -> Self {
        let side = |length: f64| if length.is_finite() { length.clamp(1.0, 20_000.0).round() } else { 1.0 };
        Drawing { width: side(width), height: side(height), millimetres: None, shapes: Vec::new() }
    }

    /// The same drawing for paper of this width in millimetres; for a screen if it is `None`.
    pub(crate) fn on_paper(self, millimetres: Option<f64>) -> Self {
        Drawing { millimetres, ..self }
    }

    /// Returns `true` if the drawing is for paper, written as PDF and SVG.
    pub(crate) fn is_for_paper(&self) -> bool {
        self.millimetres.is_some()
    }

    /// Width of the whole drawing, in pixels.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Height of the whole drawing, in pixels.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// A rectangle with its upper left corner at `(x, y)`.
    pub(crate) fn rect(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], paint: &Paint) {
        self.polygon(&[[x, y], [x + width, y], [x + width, y + height], [x, y + height]], paint);
    }

    pub(crate) fn circle(&mut self, centre: [f64; 2], radius: f64, paint: &Paint) {
        if drawable(centre) && radius.is_finite() && radius > 0.0 {
            self.shapes.push(Shape::Circle { centre, radius, paint: *paint });
        }
    }

    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], paint: &Paint) {
        self.polyline(&[from, to], paint);
    }

    /// An open line through the points, interrupted if a coordinate is not a finite number.
    pub(crate) fn polyline(&mut self, points: &[[f64; 2]], paint: &Paint) {
        let pieces: Vec<&[[f64; 2]]> =
            points.split(|&point| !drawable(point)).filter(|piece| piece.len() > 1).collect();
        self.path(&pieces, Line::Open, paint);
    }

    /// A closed polygon; points that are not finite numbers are left out.
    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], paint: &Paint) {
        self.polygons(&[points], paint);
    }

    /// Polygons that are filled together by the even-odd rule: a polygon inside another is a hole.
    pub(crate) fn polygons<P: AsRef<[[f64; 2]]>>(&mut self, polygons: &[P], paint: &Paint) {
        self.path(polygons, Line::Closed, paint);
    }

    /// Open lines that share one paint.
    pub(crate) fn polylines<P: AsRef<[[f64; 2]]>>(&mut self, lines: &[P], paint: &Paint) {
        self.path(lines, Line::Open, paint);
    }

    fn path<P: AsRef<[[f64; 2]]>>(&mut self, pieces: &[P], line: Line, paint: &Paint) {
        let pieces: Vec<Vec<[i64; 2]>> =
            pieces.iter().map(|piece| in_hundredths(piece.as_ref())).filter(|piece| !piece.is_empty()).collect();
        if !pieces.is_empty() {
            self.shapes.push(Shape::Path { pieces, line, paint: *paint });
        }
    }

    /// A text in the colour of axes with its baseline at `position`.
    pub(crate) fn text(&mut self, position: [f64; 2], text: &str, size: f64, anchor: Anchor) {
        self.any_text(regular(position, text, size, anchor));
    }

    /// The same in the given colour.
    pub(crate) fn coloured_text(&mut self, position: [f64; 2], text: &str, size: f64, anchor: Anchor, ink: Colour) {
        self.any_text(Text { ink, ..regular(position, text, size, anchor) });
    }

    /// A bold text with its baseline at `position`.
    pub(crate) fn bold_text(&mut self, position: [f64; 2], text: &str, size: f64, anchor: Anchor) {
        self.any_text(Text { weight: Weight::Bold, ..regular(position, text, size, anchor) });
    }

    /// A text that reads upwards, with its baseline through `position`.
    pub(crate) fn upward_text(&mut self, position: [f64; 2], text: &str, size: f64, anchor: Anchor) {
        self.any_text(Text { upward: true, ..regular(position, text, size, anchor) });
    }

    fn any_text(&mut self, text: Text) {
        if !text.text.trim().is_empty() && drawable(text.position) {
            self.shapes.push(Shape::Text(text));
        }
    }

    /// Draws `content`, clipped to the rectangle with its upper left corner at `corner`.
    pub(crate) fn clipped(&mut self, corner: [f64; 2], size: [f64; 2], content: impl FnOnce(&mut Drawing)) {
        let outside = std::mem::take(&mut self.shapes);
        content(self);
        let shapes = std::mem::replace(&mut self.shapes, outside);
        self.shapes.push(Shape::Clipped { corner, size: size.map(|side| side.max(0.0)), shapes });
    }

    /// The drawing as SVG text with a white background; for paper in millimetres and with embedded fonts.
    pub fn svg(&self) -> String {
        svg::written([self.width, self.height], &self.shapes, self.millimetres)
    }

    /// The drawing as a PDF page with embedded fonts, in its width on paper; 170 mm wide if it is for a screen.
    pub fn pdf(&self) -> Vec<u8> {
        pdf::written([self.width, self.height], &self.shapes, self.millimetres.unwrap_or(170.0))
    }

    /// The same picture as PNG, with `scale` pixels of the image for one pixel of the drawing.
    ///
    /// # Errors
    /// [`qp::LinearError::Setting`](signorini_qp::LinearError::Setting) if the scale is not positive or makes an image
    /// of more than 1e8 pixels, [`qp::LinearError::Numerical`](signorini_qp::LinearError::Numerical) if the rasteriser
    /// fails.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, Error> {
        raster::png(&self.pixels(scale)?)
    }

    /// The same picture as pixels.
    pub(crate) fn pixels(&self, scale: f64) -> Result<Pixmap, Error> {
        raster::painted([self.width, self.height], &self.shapes, scale)
    }
}

/// A text from left to right in the colour of axes.
fn regular(position: [f64; 2], text: &str, size: f64, anchor: Anchor) -> Text {
    Text { position, text: text.to_owned(), size, anchor, weight: Weight::Regular, upward: false, ink: INK }
}

/// Returns `true` if a point is finite and near enough to be drawn.
fn drawable(point: [f64; 2]) -> bool {
    point.iter().all(|coordinate| coordinate.abs() <= FARTHEST)
}

/// The drawable points in hundredths of a pixel, without equal neighbours.
fn in_hundredths(points: &[[f64; 2]]) -> Vec<[i64; 2]> {
    let near = points.iter().filter(|&&point| drawable(point));
    let mut rounded: Vec<[i64; 2]> = near.map(|point| point.map(|x| (x * 100.0).round() as i64)).collect();
    rounded.dedup();
    rounded
}
