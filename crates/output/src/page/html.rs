//! The file, composed of shell, style, data and scripts, with all text escaped.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::model::Page;
use super::packed::Packer;
use crate::draw::drawing::Drawing;
use crate::file::write_atomically;
use crate::json::compact_json;
use crate::text::{escape, is_unseen};
use signorini_mechanics::Error;

const SHELL: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");

/// In the order of loading.
const SCRIPTS: [&str; 18] = [
    include_str!("unpack.js"),
    include_str!("numbers.js"),
    include_str!("surface.js"),
    include_str!("painter.js"),
    include_str!("view.js"),
    include_str!("overlay.js"),
    include_str!("plot.js"),
    include_str!("tables.js"),
    include_str!("panel.js"),
    include_str!("frames.js"),
    include_str!("question.js"),
    include_str!("series.js"),
    include_str!("tradeoff.js"),
    include_str!("levels.js"),
    include_str!("along.js"),
    include_str!("sensitivity.js"),
    include_str!("modes.js"),
    include_str!("page.js"),
];

/// Writes the page into `folder`, with pictures for browsers that cannot draw.
pub(super) fn write_page<'a>(
    folder: &Path,
    page: &Page,
    packer: Packer,
    stills: impl IntoIterator<Item = &'a Drawing>,
) -> Result<(), Error> {
    let stills: Vec<String> =
        stills.into_iter().map(|drawing| image(drawing, page.title())).collect::<Result<_, _>>()?;
    let still = format!("<figure id=\"still\">{}</figure>", stills.concat());
    let (data, arrays) = (safe_json(&compact_json(page)?), packer.finished()?);
    let html = filled(SHELL, |name| match name {
        "title" => escape(page.title()),
        "style" => STYLE.to_string(),
        "still" => still.clone(),
        "data" => data.clone(),
        "arrays" => arrays.clone(),
        "script" => SCRIPTS.concat(),
        _ => String::new(),
    });
    write_atomically(&folder.join("report.html"), html.as_bytes())
}

fn image(drawing: &Drawing, title: &str) -> Result<String, Error> {
    let png = STANDARD.encode(drawing.png(1.0)?);
    Ok(format!("<img alt=\"{}\" src=\"data:image/png;base64,{png}\">", escape(title)))
}

/// The shell with each `{{name}}` replaced by its content; names inside the content are not replaced.
fn filled(shell: &str, content: impl Fn(&str) -> String) -> String {
    let mut text = String::new();
    for (index, piece) in shell.split("{{").enumerate() {
        match piece.split_once("}}").filter(|_| index > 0) {
            Some((name, after)) => {
                text += &content(name);
                text += after;
            }
            None => text += piece,
        }
    }
    text
}

/// JSON that no parser of HTML takes for a tag or a comment: these characters occur only in texts, and there their
/// escapes mean the same. Unseen characters are replaced.
fn safe_json(json: &str) -> String {
    let mut safe = String::with_capacity(json.len());
    for character in json.chars() {
        match character {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => safe += &format!("\\u{:04x}", u32::from(character)),
            unseen if is_unseen(unseen) => safe.push('\u{fffd}'),
            other => safe.push(other),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_of_a_scene_ends_the_script_that_it_stands_in() {
        let hostile = "</script><!-- <script> ]]> & \u{2028} {{arrays}} \"quoted\"";
        let json = serde_json::to_string(hostile).unwrap();
        let safe = safe_json(&json);
        assert!(!safe.contains(['<', '>', '&', '\u{2028}']), "{safe}");
        assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), hostile);
        let page = filled("<p>{{data}}</p>{{arrays}}", |name| if name == "data" { safe.clone() } else { "A".into() });
        assert_eq!(page, format!("<p>{safe}</p>A"), "what was put in is not filled again");
    }

    #[test]
    fn no_name_in_the_data_turns_the_text_of_the_page() {
        assert_eq!(safe_json("[\"left\u{202e}\u{9b}\"]"), "[\"left\u{fffd}\u{fffd}\"]");
    }
}
