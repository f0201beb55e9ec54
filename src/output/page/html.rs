//! The file, composed of shell, style, data and scripts, with all text escaped.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::model::Page;
use super::packed::Packer;
use crate::error::Error;
use crate::output::json::compact_json;
use crate::output::{Drawing, write_atomically};

const SHELL: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");

/// In the order of loading.
const SCRIPTS: [&str; 15] = [
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
    include_str!("page.js"),
];

/// Writes the page into `folder`, with a picture for browsers that cannot draw.
///
/// # Errors
/// [`Error::File`]; [`Error::Numerical`] if the picture or the data cannot be encoded.
pub(super) fn write_page(folder: &Path, page: &Page, packer: Packer, still: Option<&Drawing>) -> Result<(), Error> {
    let still = match still {
        Some(drawing) => image(drawing, page.title())?,
        None => String::new(),
    };
    let (data, arrays) = (safe_json(&compact_json(page)?), packer.finished()?);
    let html = filled(SHELL, |name| match name {
        "title" => escaped(page.title()),
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
    Ok(format!("<img id=\"still\" alt=\"{}\" src=\"data:image/png;base64,{png}\">", escaped(title)))
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

/// Text that is valid between tags and in attributes; characters that HTML does not allow are left out.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars().filter(|character| !character.is_control()) {
        match character {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            other => safe.push(other),
        }
    }
    safe
}

/// JSON that no parser of HTML takes for a tag or a comment: these characters occur only in texts, and there their escapes mean the
/// same.
fn safe_json(json: &str) -> String {
    let mut safe = String::with_capacity(json.len());
    for character in json.chars() {
        match character {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => safe += &format!("\\u{:04x}", u32::from(character)),
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
    fn a_title_is_text_and_no_markup() {
        assert_eq!(escaped("<b a='1'>\"&\u{0}\u{1b}ß"), "&lt;b a=&#39;1&#39;&gt;&quot;&amp;ß");
    }
}
