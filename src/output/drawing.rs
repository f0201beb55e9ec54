//! A drawing: shapes and texts in pixels, written as SVG and rasterised to PNG.

use std::fmt::Write;

use resvg::{tiny_skia, usvg};

pub use super::paint::{Anchor, Paint};
use super::{
    colour::INK,
    paint::{hex, hundredths, number},
    typeface,
};
use crate::error::Error;

/// Largest number of pixels of a PNG: 400 MB of memory while it is drawn.
const MOST_PIXELS: f64 = 1e8;

/// Coordinates beyond this are no part of a picture; renderers compute in single precision.
const FARTHEST: f64 = 1e6;

/// A drawing in pixels, x to the right and y downwards, on white.
#[derive(Clone, Debug)]
pub struct Drawing {
    width: f64,
    height: f64,
    body: String,
    clips: usize,
}

impl Drawing {
    /// An empty drawing of `width` times `height` pixels; at least one pixel each way.
    pub fn new(width: f64, height: f64) -> Self {
        let side = |length: f64| if length.is_finite() { length.clamp(1.0, 20_000.0).round() } else { 1.0 };
        Drawing { width: side(width), height: side(height), body: String::new(), clips: 0 }
    }

    /// Width in pixels.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// A rectangle with its upper left corner at `(x, y)`.
    pub fn rect(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], paint: &Paint) {
        self.polygon(&[[x, y], [x + width, y], [x + width, y + height], [x, y + height]], paint);
    }

    /// A circle.
    pub fn circle(&mut self, centre: [f64; 2], radius: f64, paint: &Paint) {
        if drawable(centre) && radius.is_finite() && radius > 0.0 {
            let [x, y] = centre.map(number);
            let _ =
                writeln!(self.body, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"{}/>", number(radius), paint.attributes());
        }
    }

    /// A straight line.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], paint: &Paint) {
        self.polyline(&[from, to], paint);
    }

    /// An open line through the points, interrupted where a coordinate is not a finite number.
    pub fn polyline(&mut self, points: &[[f64; 2]], paint: &Paint) {
        let pieces: Vec<&[[f64; 2]]> =
            points.split(|&point| !drawable(point)).filter(|piece| piece.len() > 1).collect();
        self.path(&pieces, false, paint);
    }

    /// A closed polygon; points that are not finite numbers are left out.
    pub fn polygon(&mut self, points: &[[f64; 2]], paint: &Paint) {
        self.polygons(&[points], paint);
    }

    /// Polygons that are filled together by the even-odd rule: a polygon inside another is a hole.
    pub fn polygons<P: AsRef<[[f64; 2]]>>(&mut self, polygons: &[P], paint: &Paint) {
        self.path(polygons, true, paint);
    }

    /// Open lines that share one paint.
    pub fn polylines<P: AsRef<[[f64; 2]]>>(&mut self, lines: &[P], paint: &Paint) {
        self.path(lines, false, paint);
    }

    fn path<P: AsRef<[[f64; 2]]>>(&mut self, pieces: &[P], closed: bool, paint: &Paint) {
        let data: String = pieces.iter().map(|piece| path_data(piece.as_ref(), closed)).collect();
        if data.is_empty() {
            return;
        }
        let rule = if closed && pieces.len() > 1 { " fill-rule=\"evenodd\"" } else { "" };
        // Round joins: a mitre would make a spike of every sharp corner of a contour.
        let join = if paint.stroke.is_some() { " stroke-linejoin=\"round\"" } else { "" };
        let _ = writeln!(self.body, "<path d=\"{data}\"{rule}{join}{}/>", paint.attributes());
    }

    /// A text in the colour of axes with its baseline at `position`.
    pub fn text(&mut self, position: [f64; 2], text: &str, size: f64, anchor: Anchor) {
        self.any_text(position, text, size, anchor, false, 0.0);
    }

    /// A bold text with its baseline at `position`.
    pub fn bold_text(&mut self, position: [f64; 2], text: &str, size: f64, anchor: Anchor) {
        self.any_text(position, text, size, anchor, true, 0.0);
    }

    /// A text that reads upwards, with its baseline through `position`.
    pub fn upward_text(&mut self, position: [f64; 2], text: &str, size: f64, anchor: Anchor) {
        self.any_text(position, text, size, anchor, false, -90.0);
    }

    fn any_text(&mut self, position: [f64; 2], text: &str, size: f64, anchor: Anchor, bold: bool, turn: f64) {
        if text.trim().is_empty() || !drawable(position) {
            return;
        }
        let [x, y] = position.map(number);
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let weight = if bold { " font-weight=\"bold\"" } else { "" };
        let place = if turn == 0.0 {
            format!(" x=\"{x}\" y=\"{y}\"")
        } else {
            format!(" transform=\"translate({x} {y}) rotate({turn})\"")
        };
        let (ink, size, text) = (hex(INK), number(size), typeface::escape(text));
        let _ = writeln!(self.body, "<text{place} font-size=\"{size}\"{anchor}{weight} fill=\"{ink}\">{text}</text>");
    }

    /// Draws what `content` draws, cut to the rectangle with its upper left corner at `corner`.
    pub fn clipped(&mut self, corner: [f64; 2], size: [f64; 2], content: impl FnOnce(&mut Drawing)) {
        self.clips += 1;
        let (id, [x, y], [width, height]) = (self.clips, corner.map(number), size.map(|side| number(side.max(0.0))));
        let _ = writeln!(
            self.body,
            "<clipPath id=\"clip{id}\"><rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/></clipPath>\n\
             <g clip-path=\"url(#clip{id})\">"
        );
        content(self);
        self.body.push_str("</g>\n");
    }

    /// The drawing as SVG text, with a white background.
    pub fn svg(&self) -> String {
        let (width, height) = (self.width, self.height);
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"{}\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            typeface::FAMILY,
            self.body
        )
    }

    /// The same picture as PNG, with `scale` pixels of the image for one pixel of the drawing.
    ///
    /// # Errors
    /// [`Error::Setting`] where the scale is not positive or makes an image of more than 1e8 pixels,
    /// [`Error::Numerical`] where the rasteriser fails.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, Error> {
        let failed = |reason: String| Error::Numerical { step: "rasterising a picture", reason };
        self.pixels(scale)?.encode_png().map_err(|error| failed(error.to_string()))
    }

    /// The same picture as pixels.
    pub(super) fn pixels(&self, scale: f64) -> Result<tiny_skia::Pixmap, Error> {
        let [width, height] = [self.width, self.height].map(|side| (side * scale).round());
        if !(scale > 0.0 && width >= 1.0 && height >= 1.0 && width * height <= MOST_PIXELS) {
            let allowed = "positive, and an image of at least one and at most 1e8 pixels must come of it";
            return Err(Error::Setting { name: "scale of the picture", value: scale, allowed });
        }
        let failed = |reason: String| Error::Numerical { step: "rasterising a picture", reason };
        let tree =
            usvg::Tree::from_str(&self.svg(), &typeface::options()).map_err(|error| failed(error.to_string()))?;
        let mut pixels = tiny_skia::Pixmap::new(width as u32, height as u32)
            .ok_or_else(|| failed(format!("no image of {width} x {height} pixels")))?;
        let transform = tiny_skia::Transform::from_scale((width / self.width) as f32, (height / self.height) as f32);
        resvg::render(&tree, transform, &mut pixels.as_mut());
        Ok(pixels)
    }
}

/// Is a point finite and near enough to be drawn?
fn drawable(point: [f64; 2]) -> bool {
    point.iter().all(|coordinate| coordinate.abs() <= FARTHEST)
}

/// The points as SVG path data: an absolute start and relative steps, exact in hundredths of a pixel.
fn path_data(points: &[[f64; 2]], closed: bool) -> String {
    let mut data = String::new();
    let mut last: Option<[i64; 2]> = None;
    for &point in points.iter().filter(|&&point| drawable(point)) {
        let here = point.map(|coordinate| (coordinate * 100.0).round() as i64);
        if let Some(before) = last {
            let step = [here[0] - before[0], here[1] - before[1]];
            match step {
                [0, 0] => continue,
                [along, 0] => data += &format!("h{}", hundredths(along)),
                [0, along] => data += &format!("v{}", hundredths(along)),
                [along, down] => {
                    let down = hundredths(down);
                    let space = if down.starts_with('-') { "" } else { " " };
                    data += &format!("l{}{space}{down}", hundredths(along));
                }
            }
        } else {
            data += &format!("M{} {}", hundredths(here[0]), hundredths(here[1]));
        }
        last = Some(here);
    }
    if closed && last.is_some() {
        data.push('z');
    }
    data
}
