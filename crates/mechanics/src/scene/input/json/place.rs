//! The place of a value in the text of a scene.

use jsonc_parser::ast::Value;
use jsonc_parser::common::Ranged;

/// The place of the value at `path` as `supports[0].on.boundary`, in bytes; if it is missing, of the value that should
/// contain it.
pub(crate) fn start_of(scene: &Value, path: &str) -> usize {
    let keys = path.split(['.', '[']).map(|key| key.trim_end_matches(']')).filter(|key| !key.is_empty());
    let found = keys.into_iter().try_fold(scene, |value, key| {
        let inner = match value {
            Value::Object(object) => object.get(key).map(|field| &field.value),
            Value::Array(array) => key.parse().ok().and_then(|index: usize| array.elements.get(index)),
            _ => None,
        };
        inner.ok_or(value)
    });
    found.unwrap_or_else(|container| container).start()
}

/// Line and column, from 1, of a place in bytes.
pub(crate) fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    let before = &text[..at];
    let line = before.rsplit('\n').next().unwrap_or_default();
    (before.matches('\n').count() + 1, line.chars().count() + 1)
}
