//! Shapes as SVG text.

use std::fmt::Write;

use super::paint::{Anchor, hex, hundredths, number};
use super::shape::{Line, Shape, Text};
use super::typeface::{self, Weight};
use crate::text::escape;

/// The SVG text of a picture of `width` times `height` pixels, on white; on paper of this width in millimetres, with
/// the typeface.
pub(crate) fn written([width, height]: [f64; 2], shapes: &[Shape], millimetres: Option<f64>) -> String {
    let mut body = String::new();
    write_shapes(&mut body, shapes, &mut 0);
    let size = match millimetres {
        Some(wide) => format!("width=\"{wide}mm\" height=\"{}mm\"", number(wide * height / width)),
        None => format!("width=\"{width}\" height=\"{height}\""),
    };
    if millimetres.is_some() {
        body = typeface_style() + &body;
    }
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" {size} viewBox=\"0 0 {width} {height}\" font-family=\"{}\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n",
        typeface::FAMILY,
    )
}

/// Both faces of the typeface, for a viewer that does not have them.
fn typeface_style() -> String {
    let face = |weight: Weight, name: &str| {
        let file = base64(typeface::file(weight));
        format!("@font-face{{font-family:'Signorini Sans';font-weight:{name};src:url(data:font/ttf;base64,{file})}}\n")
    };
    format!("<style>\n{}{}</style>\n", face(Weight::Regular, "normal"), face(Weight::Bold, "bold"))
}

/// Bytes in the 64 letters of base64.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(4 * bytes.len().div_ceil(3));
    for chunk in bytes.chunks(3) {
        let bits = (0..3).fold(0_u32, |bits, place| bits << 8 | u32::from(chunk.get(place).copied().unwrap_or(0)));
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place)) as usize & 63];
            text.push(if place <= chunk.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

/// Writes the shapes; `clips` counts the clip paths, because their names must differ.
fn write_shapes(body: &mut String, shapes: &[Shape], clips: &mut usize) {
    for shape in shapes {
        match shape {
            Shape::Path { pieces, line, paint } => {
                let data: String = pieces.iter().map(|piece| path_data(piece, *line)).collect();
                let rule = if *line == Line::Closed && pieces.len() > 1 { " fill-rule=\"evenodd\"" } else { "" };
                // Round joins: a mitre would make a spike at every sharp corner of a contour.
                let join = if paint.stroke.is_some() { " stroke-linejoin=\"round\"" } else { "" };
                let _ = writeln!(body, "<path d=\"{data}\"{rule}{join}{}/>", paint.attributes());
            }
            Shape::Circle { centre, radius, paint } => {
                let ([x, y], radius) = (centre.map(number), number(*radius));
                let _ = writeln!(body, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{}/>", paint.attributes());
            }
            Shape::Text(text) => write_text(body, text),
            Shape::Clipped { corner, size, shapes } => {
                *clips += 1;
                let (id, [x, y], [width, height]) = (*clips, corner.map(number), size.map(number));
                let _ = writeln!(
                    body,
                    "<clipPath id=\"clip{id}\"><rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/></clipPath>\n\
                     <g clip-path=\"url(#clip{id})\">"
                );
                write_shapes(body, shapes, clips);
                body.push_str("</g>\n");
            }
        }
    }
}

fn write_text(body: &mut String, text: &Text) {
    let [x, y] = text.position.map(number);
    let anchor = match text.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let weight = if text.weight == Weight::Bold { " font-weight=\"bold\"" } else { "" };
    let place = match text.upward {
        false => format!(" x=\"{x}\" y=\"{y}\""),
        true => format!(" transform=\"translate({x} {y}) rotate(-90)\""),
    };
    let (ink, size, words) = (hex(text.ink), number(text.size), escape(&text.text));
    let _ = writeln!(body, "<text{place} font-size=\"{size}\"{anchor}{weight} fill=\"{ink}\">{words}</text>");
}

/// The points as SVG path data: an absolute start and relative steps.
fn path_data(points: &[[i64; 2]], line: Line) -> String {
    let mut data = String::new();
    let mut last: Option<[i64; 2]> = None;
    for &here in points {
        match last.map(|before| [here[0] - before[0], here[1] - before[1]]) {
            None => data += &format!("M{} {}", hundredths(here[0]), hundredths(here[1])),
            Some([along, 0]) => data += &format!("h{}", hundredths(along)),
            Some([0, down]) => data += &format!("v{}", hundredths(down)),
            Some([along, down]) => {
                let down = hundredths(down);
                let space = if down.starts_with('-') { "" } else { " " };
                data += &format!("l{}{space}{down}", hundredths(along));
            }
        }
        last = Some(here);
    }
    if line == Line::Closed {
        data.push('z');
    }
    data
}
