//! The embedded typeface: the width of texts, and fitting them into a width.

use std::sync::LazyLock;

use tiny_skia::PathBuilder;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// The family of the embedded fonts, then the substitutes for a viewer of the SVG.
pub(crate) const FAMILY: &str = "'Signorini Sans','DejaVu Sans',Verdana,sans-serif";

/// The two faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weight {
    Regular,
    Bold,
}

/// The faces in the order of [`Weight`]. They have no tables for kerning and ligatures: a text is its letters side by
/// side.
static FACES: LazyLock<[Option<Face<'static>>; 2]> = LazyLock::new(|| FILES.map(|file| Face::parse(file, 0).ok()));

static FILES: [&[u8]; 2] = [include_bytes!("font/signorini-sans.ttf"), include_bytes!("font/signorini-sans-bold.ttf")];

/// Metrics of an embedded face in a document; lengths in thousandths of the size.
pub struct About {
    pub file: &'static [u8],
    /// The width of each glyph, from 0.
    pub widths: Vec<f32>,
    /// Left, bottom, right and top of all letters.
    pub bounds: [f32; 4],
    pub ascent: f32,
    pub descent: f32,
    /// Glyphs with the letters that they show.
    pub letters: Vec<(u16, char)>,
}

/// Metrics of a face in a document; `None` if the face cannot be read.
pub(crate) fn about(weight: Weight) -> Option<About> {
    let face = face(weight)?;
    let unit = 1000.0 / f32::from(face.units_per_em());
    let width = |glyph: u16| unit * f32::from(face.glyph_hor_advance(GlyphId(glyph)).unwrap_or(0));
    let bounds = face.global_bounding_box();
    let mut letters: Vec<(u16, char)> = Vec::new();
    for table in face.tables().cmap.iter().flat_map(|cmap| cmap.subtables).filter(|table| table.is_unicode()) {
        table.codepoints(|code| {
            if let (Some(letter), Some(glyph)) = (char::from_u32(code), table.glyph_index(code)) {
                letters.push((glyph.0, letter));
            }
        });
    }
    letters.sort_unstable();
    letters.dedup_by_key(|letter| letter.0);
    Some(About {
        file: FILES[weight as usize],
        widths: (0..face.number_of_glyphs()).map(width).collect(),
        bounds: [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(|end| unit * f32::from(end)),
        ascent: unit * f32::from(face.ascender()),
        descent: unit * f32::from(face.descender()),
        letters,
    })
}

pub(crate) fn file(weight: Weight) -> &'static [u8] {
    FILES[weight as usize]
}

pub(crate) fn glyphs(text: &str, weight: Weight) -> Vec<u16> {
    face(weight).map_or_else(Vec::new, |face| letters(face, text).map(|(glyph, _)| glyph.0).collect())
}

fn face(weight: Weight) -> Option<&'static Face<'static>> {
    FACES[weight as usize].as_ref()
}

/// The letters of a text, one after another, each with its width in units of the face; a missing letter is the box of
/// the face.
fn letters<'a>(face: &'a Face<'static>, text: &'a str) -> impl Iterator<Item = (GlyphId, f64)> + 'a {
    text.chars().map(|character| {
        let glyph = face.glyph_index(character).unwrap_or_default();
        (glyph, f64::from(face.glyph_hor_advance(glyph).unwrap_or(0)))
    })
}

/// Width of `text` at `size`, in the units of `size`.
pub(crate) fn width(text: &str, size: f64, weight: Weight) -> f64 {
    let Some(face) = face(weight) else { return 0.0 };
    letters(face, text).map(|letter| letter.1).sum::<f64>() * size / f64::from(face.units_per_em())
}

/// Adds the outlines of the letters of `text` to `path`; `place(along, above)` gives the position of a point, measured
/// from the start of the baseline.
pub(crate) fn outline(
    text: &str,
    size: f64,
    weight: Weight,
    path: &mut PathBuilder,
    place: impl Fn(f64, f64) -> [f32; 2],
) {
    let Some(face) = face(weight) else { return };
    let unit = size / f64::from(face.units_per_em());
    let mut start = 0.0;
    for (glyph, width) in letters(face, text) {
        let place = |x: f32, y: f32| place(unit * (start + f64::from(x)), unit * f64::from(y));
        face.outline_glyph(glyph, &mut Outline { path, place });
        start += width;
    }
}

/// Moves the outline of one letter to its place.
struct Outline<'a, F> {
    path: &'a mut PathBuilder,
    place: F,
}

impl<F: Fn(f32, f32) -> [f32; 2]> OutlineBuilder for Outline<'_, F> {
    fn move_to(&mut self, x: f32, y: f32) {
        let [x, y] = (self.place)(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let [x, y] = (self.place)(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ([x1, y1], [x, y]) = ((self.place)(x1, y1), (self.place)(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ([x1, y1], [x2, y2], [x, y]) = ((self.place)(x1, y1), (self.place)(x2, y2), (self.place)(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

/// `text` and the size at which it fits into `available`: first smaller, then cut with an ellipsis.
pub(crate) fn fitted(text: &str, size: f64, weight: Weight, available: f64) -> (String, f64) {
    /// Below this share of its size a text is cut rather than shrunk.
    const SMALLEST: f64 = 0.75;
    let needed = width(text, size, weight);
    if needed <= available {
        return (text.to_owned(), size);
    }
    let size = size * (available / needed).max(SMALLEST);
    if width(text, size, weight) <= available * 1.001 {
        return (text.to_owned(), size);
    }
    let characters: Vec<char> = text.chars().collect();
    let cut = |count: usize| characters[..count].iter().collect::<String>().trim_end().to_owned() + "…";
    let (mut fits, mut too_long) = (0, characters.len());
    while fits + 1 < too_long {
        let middle = fits.midpoint(too_long);
        if width(&cut(middle), size, weight) <= available { fits = middle } else { too_long = middle }
    }
    (cut(fits), size)
}

/// `text` in lines that fit into `available`, broken at spaces; a single word that is too long is cut.
pub(crate) fn wrapped(text: &str, size: f64, weight: Weight, available: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if width(&longer, size, weight) <= available {
                *line = longer;
                continue;
            }
        }
        lines.push(word.to_owned());
    }
    lines
        .into_iter()
        .map(
            |line| {
                if width(&line, size, weight) > available { fitted_at(&line, size, weight, available) } else { line }
            },
        )
        .collect()
}

/// `text` cut to `available` without changing its size.
fn fitted_at(text: &str, size: f64, weight: Weight, available: f64) -> String {
    // `fitted` may shrink a text to three quarters; a size larger by a third prevents that.
    fitted(text, size / 0.75, weight, available).0
}
