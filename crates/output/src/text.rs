//! The texts of a scene (its title, units, names of boundaries and groups) on terminals, in pages and in files of XML.

/// Returns `true` for characters without a sign of their own that change what is seen around them: the control
/// characters, and those that turn the direction of the text after them.
pub(super) fn is_unseen(character: char) -> bool {
    let turns =
        matches!(character, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || character.is_control()
}

/// Text on one line of a terminal: unseen characters as their escapes.
pub fn printable(text: &str) -> String {
    text.chars().map(|c| if is_unseen(c) { c.escape_default().to_string() } else { c.to_string() }).collect()
}

/// Text between tags and in attributes of XML and HTML: markup escaped, unseen and forbidden characters replaced.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            unseen if is_unseen(unseen) => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_is_text_and_no_markup() {
        assert_eq!(
            escape("<b a='1'>\"&\t\u{0}\u{1b}\u{9b}ß"),
            "&lt;b a=&#39;1&#39;&gt;&quot;&amp; \u{fffd}\u{fffd}\u{fffd}ß"
        );
    }

    /// The twelve characters with the property Bidi_Control of Unicode; words from right to left keep theirs.
    #[test]
    fn no_character_turns_the_direction_of_the_text_after_it() {
        let turning = "\u{61c}\u{200e}\u{200f}\u{202a}\u{202b}\u{202c}\u{202d}\u{202e}\u{2066}\u{2067}\u{2068}\u{2069}";
        assert!(turning.chars().all(is_unseen));
        assert_eq!(escape(turning), "\u{fffd}".repeat(12));
        assert_eq!(printable("a\u{202e}b"), "a\\u{202e}b");
        let words = "Größe 接触 مجال תחום \u{200d}\u{2028}";
        assert_eq!((escape(words), printable(words)), (words.to_string(), words.to_string()));
    }
}
