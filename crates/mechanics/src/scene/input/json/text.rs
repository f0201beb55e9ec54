//! From text to a tree of JSON. What the parser refuses is put into words by the tokens before it.

use std::borrow::Cow;

use jsonc_parser::ast::Value;
use jsonc_parser::errors::{ParseError, ParseErrorKind as Kind};
use jsonc_parser::tokens::Token;
use jsonc_parser::{
    CollectOptions, ParseOptions, ParseStringErrorKind as InString, Scanner, ScannerOptions, parse_to_ast,
};

use super::fault::{Fault, What};

/// Characters of the text that a message quotes.
const QUOTED: usize = 20;

/// Arrays and objects inside each other that a path names; no scene has as many.
const DEEPEST: usize = 10;

const CONTROL_CHARACTER: &str = "a string may contain no line break and no other control character; its closing `\"` is \
                                 missing, or write \\n or \\t";

/// The text without the byte order mark that some editors write at its start, and with empty lines instead of those
/// that begin with `//`, so that all other lines keep their numbers.
pub(crate) fn plain(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let is_comment = |line: &str| line.trim_start().starts_with("//");
    if !text.lines().any(is_comment) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(text.split('\n').map(|line| if is_comment(line) { "" } else { line }).collect::<Vec<_>>().join("\n"))
}

/// The tree of a text that is strict JSON.
pub(crate) fn parsed(text: &str) -> Result<Value<'_>, Fault> {
    let options = ParseOptions {
        allow_comments: false,
        allow_loose_object_property_names: false,
        allow_trailing_commas: false,
        allow_missing_commas: false,
        allow_single_quoted_strings: false,
        allow_hexadecimal_numbers: false,
        allow_unary_plus_numbers: false,
        allow_bare_decimal_point_numbers: false,
        allow_non_finite_numbers: false,
        allow_extended_string_escapes: false,
    };
    let parsed = parse_to_ast(text, &CollectOptions::default(), &options);
    // Up to here the tokens are right: the fault is the next one, or inside of it.
    let right = match &parsed {
        Err(error) => match error.kind() {
            Kind::UnterminatedObject | Kind::UnterminatedArray => text.len(),
            Kind::TrailingCommasNotAllowed => error.range().end,
            _ => error.range().start,
        },
        Ok(_) => text.len(),
    };
    let mut trail = Trail { text, open: Vec::new(), next: Next::Value };
    let at = trail.follow_to(right)?;
    match parsed {
        Ok(tree) => tree.value.ok_or_else(|| trail.unexpected(at)),
        Err(error) => Err(trail.refused(&error, at)),
    }
}

/// The tokens before a place of the text, as far as they say where it is and what may stand there.
struct Trail<'a> {
    text: &'a str,
    open: Vec<Open<'a>>,
    next: Next,
}

/// An array or object that begins before the place and ends after it.
enum Open<'a> {
    /// With its last key, if it has one.
    Object(Option<Cow<'a, str>>),
    /// With the number of its last entry.
    Array(usize),
}

/// What may stand at a place.
#[derive(Clone, Copy, PartialEq)]
enum Next {
    Value,
    Key,
    Colon,
    /// A comma, a bracket or the end.
    Separator,
}

impl<'a> Trail<'a> {
    /// The place of the first token from `right` on, or of the token with `right` inside. A control character in a
    /// string and an unusual space before it, which the parser lets pass, are faults.
    fn follow_to(&mut self, right: usize) -> Result<usize, Fault> {
        let options = ScannerOptions { allow_extended_string_escapes: false, ..ScannerOptions::default() };
        let mut scanner = Scanner::new(self.text, &options);
        loop {
            let end = scanner.token_end();
            let token = scanner.scan();
            let at = scanner.token_start();
            if let Some(unusual) = self.text[end..at].find(|space| !" \t\n\r".contains(space)) {
                return Err(self.unexpected(end + unusual));
            }
            let token = match token {
                Ok(Some(token)) if at < right => token,
                _ => return Ok(at),
            };
            // No other token has one inside.
            if let Some(control) = self.text[at..scanner.token_end()].find(|c| c < ' ') {
                return Err(self.fault(at + control, CONTROL_CHARACTER));
            }
            self.step(token);
        }
    }

    fn step(&mut self, token: Token<'a>) {
        self.next = match (&token, self.open.last(), self.next) {
            (Token::OpenBracket | Token::Colon, ..) | (Token::Comma, Some(Open::Array(_)), _) => Next::Value,
            (Token::OpenBrace | Token::Comma, ..) => Next::Key,
            (Token::String(_), _, Next::Key) => Next::Colon,
            _ => Next::Separator,
        };
        match (token, self.open.last_mut()) {
            (Token::OpenBrace, _) => self.open.push(Open::Object(None)),
            (Token::OpenBracket, _) => self.open.push(Open::Array(0)),
            (Token::CloseBrace | Token::CloseBracket, _) => drop(self.open.pop()),
            (Token::Comma, Some(Open::Array(index))) => *index += 1,
            (Token::String(name), Some(Open::Object(key))) if self.next == Next::Colon => *key = Some(name),
            _ => {}
        }
    }

    /// A fault at a place, with the path as far as it is known.
    fn fault(&self, at: usize, words: impl Into<String>) -> Fault {
        let is_named = matches!(self.next, Next::Value | Next::Colon);
        let known = self.open.len().saturating_sub(usize::from(!is_named)).min(DEEPEST);
        self.open[..known].iter().rev().fold(Fault::at(at, What::Other(words.into())), |fault, open| match open {
            Open::Object(key) => fault.inside(key.as_deref().unwrap_or_default(), at),
            Open::Array(index) => fault.inside(&format!("[{index}]"), at),
        })
    }

    /// The fault that made the parser end.
    fn refused(&mut self, error: &ParseError, at: usize) -> Fault {
        match error.kind() {
            Kind::String(kind) if matches!(self.next, Next::Value | Next::Key) => match kind {
                InString::UnterminatedStringLiteral => match self.text[at..].find(|c| c < ' ') {
                    Some(control) => self.fault(at + control, CONTROL_CHARACTER),
                    None => self.fault(at, "the text ends inside a string; a closing `\"` is missing"),
                },
                InString::ExpectedFourHexDigits | InString::InvalidUnicodeEscapeSequence(_) => self.fault(
                    error.range().start,
                    "`\\u` in a string must be followed by four hexadecimal digits of a character",
                ),
                _ => self.fault(
                    error.range().start,
                    "a backslash in a string must be followed by one of \" \\ / b f n r t u; write \\\\ for itself",
                ),
            },
            Kind::NestingDepthExceeded => {
                self.open.truncate(1);
                self.next = Next::Value;
                self.fault(at, "more than 127 arrays and objects lie inside each other; that is not allowed")
            }
            Kind::TrailingCommasNotAllowed => {
                self.next = Next::Separator;
                let (found, of_key) = (self.found(at), self.of_key());
                self.fault(at, format!("no comma may stand before {found}; remove the comma{of_key}"))
            }
            _ => self.unexpected(at),
        }
    }

    /// The fault of something that may not stand at a place.
    fn unexpected(&mut self, at: usize) -> Fault {
        let (found, rest) = (self.found(at), &self.text[at..]);
        let is_number = |text: &str| text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        let start = self.text[..at].trim_end_matches(is_of_word).len();
        // A number whose first characters alone have the form of JSON.
        if self.next == Next::Separator && start < at && is_number(&self.text[start..]) && rest.starts_with(is_of_word)
        {
            self.next = Next::Value;
            return self.unexpected(start);
        }
        let words = match (self.next, self.open.last()) {
            (_, Some(Open::Array(_))) if rest.is_empty() => {
                self.next = Next::Separator;
                "the text ends inside an array; a closing `]` is missing".into()
            }
            (Next::Value, _) if rest.is_empty() => "the text ends before a value".into(),
            (_, Some(Open::Object(_))) if rest.is_empty() => {
                "the text ends inside an object; a closing `}` is missing".into()
            }
            (Next::Value, _) if is_number(rest) => {
                "a number must have the form of JSON, such as 0.5, -2 or 1e-3".into()
            }
            (Next::Value, _) if rest.starts_with(['t', 'f', 'n']) => {
                "this value must be spelt `true`, `false` or `null`".into()
            }
            (Next::Value, _) => format!(
                "expected a value of JSON (a number such as 0.5, a string in double quotes, true, false, an array or an \
                 object), but found {found}"
            ),
            (Next::Key, _) => format!("expected a key in double quotes, but found {found}"),
            (Next::Colon, _) => format!("expected a colon after a key, but found {found}"),
            (Next::Separator, Some(Open::Object(_))) => {
                format!("expected a comma or `}}`{}, but found {found}", self.of_key())
            }
            (Next::Separator, Some(Open::Array(_))) => {
                format!("expected a comma or `]` after an entry of an array, but found {found}")
            }
            (Next::Separator, None) => format!("there is more text after the end of the scene: {found}; remove it"),
        };
        self.fault(at, words)
    }

    fn of_key(&self) -> String {
        let Some(Open::Object(Some(key))) = self.open.last() else { return String::new() };
        format!(" after the value of `{key}`")
    }

    /// The text at a place, as a person would name it.
    fn found(&self, at: usize) -> String {
        let rest = &self.text[at..];
        let word: String = rest.chars().take_while(|c| is_of_word(*c)).take(QUOTED).collect();
        let quoted = rest.strip_prefix('"').and_then(|rest| rest.split_once('"')).map(|(inside, _)| inside);
        match (quoted, rest.chars().next()) {
            (Some(inside), _) if inside.chars().count() <= QUOTED => format!("`\"{inside}\"`"),
            _ if !word.is_empty() => format!("`{word}`"),
            (_, Some(c)) if c.is_control() => format!("`{}`", c.escape_default()),
            (_, Some(c)) => format!("`{c}`"),
            (_, None) => "the end of the text".to_string(),
        }
    }
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || "+-._".contains(c)
}
