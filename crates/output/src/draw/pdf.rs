//! Shapes as a PDF page with the letters of the embedded typeface.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, LineJoinStyle, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};

use super::colour::Colour;
use super::paint::{Anchor, Paint};
use super::shape::{Line, Shape, Text};
use super::typeface::{self, Weight};

/// Points in a millimetre.
const POINTS: f64 = 72.0 / 25.4;

/// Distance of the control points of a quarter circle from its ends, in radii.
const QUARTER: f64 = 0.552_284_75;

/// Level of compression: higher levels gain nothing.
const LEVEL: u32 = 6;

const WEIGHTS: [Weight; 2] = [Weight::Regular, Weight::Bold];
const FONTS: [&[u8]; 2] = [b"F0", b"F1"];
const INFO: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// The PDF of a picture of `sides` pixels, `millimetres` wide.
pub(crate) fn written(sides: [f64; 2], shapes: &[Shape], millimetres: f64) -> Vec<u8> {
    let unit = POINTS * millimetres / sides[0];
    let mut page = Page { content: Content::new(), transparencies: Vec::new() };
    // From pixels, downwards, to points, upwards.
    page.content.save_state().transform([unit as f32, 0.0, 0.0, -unit as f32, 0.0, (unit * sides[1]) as f32]);
    page.content.set_line_join(LineJoinStyle::RoundJoin);
    page.draw(shapes);
    page.content.restore_state();
    page.document(sides.map(|side| (unit * side) as f32))
}

struct Page {
    content: Content,
    /// Opacities of fills, in hundredths: a graphics state for each.
    transparencies: Vec<u8>,
}

impl Page {
    fn draw(&mut self, shapes: &[Shape]) {
        for shape in shapes {
            match shape {
                Shape::Path { pieces, line, paint } => {
                    let all = |page: &mut Page| pieces.iter().for_each(|piece| page.piece(piece, *line));
                    self.paint(
                        paint,
                        &all,
                        if *line == Line::Closed && pieces.len() > 1 { Rule::EvenOdd } else { Rule::NonZero },
                    );
                }
                Shape::Circle { centre, radius, paint } => {
                    self.paint(paint, &|page: &mut Page| page.circle(*centre, *radius), Rule::NonZero);
                }
                Shape::Text(text) => self.text(text),
                Shape::Clipped { corner, size, shapes } => {
                    let [[x, y], [width, height]] = [corner, size].map(|pair| pair.map(|value| value as f32));
                    self.content.save_state().rect(x, y, width, height).clip_nonzero().end_path();
                    self.draw(shapes);
                    self.content.restore_state();
                }
            }
        }
    }

    fn paint(&mut self, paint: &Paint, path: &dyn Fn(&mut Page), rule: Rule) {
        if let Some(colour) = paint.fill {
            let is_clear = paint.transparency > 0.0;
            if is_clear {
                let name = self.transparency(paint.transparency);
                self.content.save_state().set_parameters(Name(name.as_bytes()));
            }
            let [red, green, blue] = parts(colour);
            self.content.set_fill_rgb(red, green, blue);
            path(self);
            match rule {
                Rule::EvenOdd => self.content.fill_even_odd(),
                Rule::NonZero => self.content.fill_nonzero(),
            };
            if is_clear {
                self.content.restore_state();
            }
        }
        if let Some(colour) = paint.stroke {
            let [red, green, blue] = parts(colour);
            self.content.set_stroke_rgb(red, green, blue).set_line_width(paint.width as f32);
            self.content.set_dash_pattern(paint.dash.iter().map(|&length| length as f32), 0.0);
            path(self);
            self.content.stroke();
        }
    }

    /// The name of the graphics state of a transparency.
    fn transparency(&mut self, transparency: f64) -> String {
        let opaque = (100.0 * (1.0 - transparency)).round().clamp(0.0, 100.0) as u8;
        let known = self.transparencies.iter().position(|&known| known == opaque);
        let index = known.unwrap_or_else(|| {
            self.transparencies.push(opaque);
            self.transparencies.len() - 1
        });
        format!("G{index}")
    }

    fn piece(&mut self, points: &[[i64; 2]], line: Line) {
        for (place, point) in points.iter().enumerate() {
            let [x, y] = point.map(|hundredths| hundredths as f32 / 100.0);
            if place == 0 {
                self.content.move_to(x, y)
            } else {
                self.content.line_to(x, y)
            };
        }
        if line == Line::Closed {
            self.content.close_path();
        }
    }

    fn circle(&mut self, [x, y]: [f64; 2], radius: f64) {
        let at = |right: f64, down: f64| [(x + radius * right) as f32, (y + radius * down) as f32];
        let [start_x, start_y] = at(1.0, 0.0);
        self.content.move_to(start_x, start_y);
        for [from, to] in
            [[[1.0, 0.0], [0.0, 1.0]], [[0.0, 1.0], [-1.0, 0.0]], [[-1.0, 0.0], [0.0, -1.0]], [[0.0, -1.0], [1.0, 0.0]]]
        {
            let first = at(from[0] + QUARTER * to[0], from[1] + QUARTER * to[1]);
            let second = at(to[0] + QUARTER * from[0], to[1] + QUARTER * from[1]);
            let end = at(to[0], to[1]);
            self.content.cubic_to(first[0], first[1], second[0], second[1], end[0], end[1]);
        }
        self.content.close_path();
    }

    fn text(&mut self, text: &Text) {
        let whole = typeface::width(&text.text, text.size, text.weight);
        let start = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -whole / 2.0,
            Anchor::End => -whole,
        };
        let [x, y] = text.position;
        // Letters are upright although the page is mirrored.
        let matrix = match text.upward {
            false => [1.0, 0.0, 0.0, -1.0, x + start, y],
            true => [0.0, -1.0, -1.0, 0.0, x, y - start],
        };
        let glyphs: Vec<u8> =
            typeface::glyphs(&text.text, text.weight).into_iter().flat_map(u16::to_be_bytes).collect();
        let [red, green, blue] = parts(text.ink);
        self.content.set_fill_rgb(red, green, blue).begin_text();
        self.content.set_font(Name(FONTS[text.weight as usize]), text.size as f32);
        self.content.set_text_matrix(matrix.map(|entry| entry as f32)).show(Str(&glyphs)).end_text();
    }

    /// The document of this one page, `sides` in points.
    fn document(self, sides: [f32; 2]) -> Vec<u8> {
        let [catalog, pages, page_id, content] = [1, 2, 3, 4].map(Ref::new);
        let font = |weight: usize| Ref::new(10 + 10 * weight as i32);
        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([page_id]).count(1);
        let mut page = pdf.page(page_id);
        page.media_box(Rect::new(0.0, 0.0, sides[0], sides[1])).parent(pages).contents(content);
        let mut resources = page.resources();
        let mut fonts = resources.fonts();
        FONTS.iter().enumerate().for_each(|(weight, name)| {
            fonts.pair(Name(name), font(weight));
        });
        fonts.finish();
        let mut states = resources.ext_g_states();
        for (index, opaque) in self.transparencies.iter().enumerate() {
            let name = format!("G{index}");
            states
                .insert(Name(name.as_bytes()))
                .start::<pdf_writer::writers::ExtGraphicsState>()
                .non_stroking_alpha(f32::from(*opaque) / 100.0);
        }
        states.finish();
        resources.finish();
        page.finish();
        let data = deflated(&self.content.finish());
        pdf.stream(content, &data).filter(Filter::FlateDecode);
        for (index, weight) in WEIGHTS.into_iter().enumerate() {
            write_font(&mut pdf, weight, font(index).get());
        }
        pdf.finish()
    }
}

/// Fill rule for overlapping pieces of a path.
#[derive(Clone, Copy)]
enum Rule {
    NonZero,
    EvenOdd,
}

fn parts(Colour(red, green, blue): Colour) -> [f32; 3] {
    [red, green, blue].map(|part| f32::from(part) / 255.0)
}

/// One face of the typeface, whole, as objects from number `first` on.
fn write_font(pdf: &mut Pdf, weight: Weight, first: i32) {
    let Some(about) = typeface::about(weight) else { return };
    let [type0, cid, descriptor, file, unicode] = [0, 1, 2, 3, 4].map(|place| Ref::new(first + place));
    let name = Name(if weight == Weight::Bold { b"SignoriniSans-Bold" } else { b"SignoriniSans" });
    pdf.type0_font(type0)
        .base_font(name)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(cid)
        .to_unicode(unicode);
    let mut font = pdf.cid_font(cid);
    font.subtype(CidFontType::Type2).base_font(name).system_info(INFO).font_descriptor(descriptor);
    font.default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
    font.widths().consecutive(0, about.widths.iter().copied());
    font.finish();
    let [left, bottom, right, top] = about.bounds;
    pdf.font_descriptor(descriptor)
        .name(name)
        .flags(FontFlags::SYMBOLIC)
        .bbox(Rect::new(left, bottom, right, top))
        .italic_angle(0.0)
        .ascent(about.ascent)
        .descent(about.descent)
        .cap_height(about.ascent)
        .stem_v(80.0)
        .font_file2(file);
    let data = deflated(about.file);
    pdf.stream(file, &data).filter(Filter::FlateDecode).pair(Name(b"Length1"), about.file.len() as i32);
    let mut map = UnicodeCmap::new(Name(b"Signorini"), INFO);
    about.letters.iter().for_each(|&(glyph, letter)| map.pair(glyph, letter));
    pdf.cmap(unicode, &map.finish());
}

/// `bytes` in the zlib format of PDF files.
fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
    // Writing to memory cannot fail.
    match encoder.write_all(bytes) {
        Ok(()) => encoder.finish().unwrap_or_default(),
        Err(_) => Vec::new(),
    }
}
