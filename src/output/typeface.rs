//! The embedded typeface: what a text measures, and how one is made to fit.

use std::sync::{Arc, LazyLock};

use resvg::usvg;

/// The family of the embedded fonts, then what a viewer of the SVG may take instead.
pub(crate) const FAMILY: &str = "'Signorini Sans','DejaVu Sans',Verdana,sans-serif";

const REGULAR: &[u8] = include_bytes!("font/signorini-sans.ttf");
const BOLD: &[u8] = include_bytes!("font/signorini-sans-bold.ttf");

static FONTS: LazyLock<Arc<usvg::fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(REGULAR.to_vec());
    fonts.load_font_data(BOLD.to_vec());
    fonts.set_sans_serif_family("Signorini Sans");
    Arc::new(fonts)
});

/// Parsing options that know only the embedded fonts, so that the machine's fonts do not matter.
pub(crate) fn options() -> usvg::Options<'static> {
    usvg::Options { font_family: "Signorini Sans".to_owned(), fontdb: FONTS.clone(), ..usvg::Options::default() }
}

/// `text` as XML character data: markup escaped, characters that XML forbids replaced.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\0'..='\u{1f}' | '\u{7f}'..='\u{9f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Width of `text` at `size`, in the units of `size`.
pub(crate) fn width(text: &str, size: f64, bold: bool) -> f64 {
    if text.trim().is_empty() {
        return 0.0;
    }
    // Laid out by the same code that draws it, at a fixed size: widths are proportional, for there are no hints.
    let weight = if bold { "bold" } else { "normal" };
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\"><text font-family=\"{FAMILY}\" \
         font-size=\"100\" font-weight=\"{weight}\" xml:space=\"preserve\">{}</text></svg>",
        escape(text)
    );
    let measured = usvg::Tree::from_str(&svg, &options())
        .ok()
        .and_then(|tree| tree.root().children().first().map(|node| f64::from(node.bounding_box().width())));
    // Six tenths of the size is the mean width of a letter.
    measured.unwrap_or(60.0 * text.chars().count() as f64) * size / 100.0
}

/// `text` and the size at which it fits into `available`: first smaller, then cut with an ellipsis.
pub(crate) fn fitted(text: &str, size: f64, bold: bool, available: f64) -> (String, f64) {
    /// Below this share of its size a text is cut rather than shrunk.
    const SMALLEST: f64 = 0.75;
    let needed = width(text, size, bold);
    if needed <= available {
        return (text.to_owned(), size);
    }
    let size = size * (available / needed).max(SMALLEST);
    if width(text, size, bold) <= available * 1.001 {
        return (text.to_owned(), size);
    }
    let characters: Vec<char> = text.chars().collect();
    let cut = |count: usize| characters[..count].iter().collect::<String>().trim_end().to_owned() + "…";
    let (mut fits, mut too_long) = (0, characters.len());
    while fits + 1 < too_long {
        let middle = fits.midpoint(too_long);
        if width(&cut(middle), size, bold) <= available { fits = middle } else { too_long = middle }
    }
    (cut(fits), size)
}

/// `text` in lines that fit into `available`, broken at spaces; a single word that is too long is cut.
pub(crate) fn wrapped(text: &str, size: f64, bold: bool, available: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if width(&longer, size, bold) <= available {
                *line = longer;
                continue;
            }
        }
        lines.push(word.to_owned());
    }
    lines
        .into_iter()
        .map(|line| if width(&line, size, bold) > available { fitted_at(&line, size, bold, available) } else { line })
        .collect()
}

/// `text` cut to `available` without changing its size.
fn fitted_at(text: &str, size: f64, bold: bool, available: f64) -> String {
    // A size that shrinks to three quarters makes room for a third more; ask for what fits without shrinking.
    fitted(text, size / 0.75, bold, available).0
}
