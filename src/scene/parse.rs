//! From text to a typed scene: every failure has a path, a line and a column.

use std::fmt;
use std::marker::PhantomData;
use std::path::Path;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};

use super::Scene;
use crate::error::Error;

impl Scene {
    /// Reads a scene from JSON text; `source_name` stands in the error's first words.
    ///
    /// # Errors
    /// [`Error::SceneSyntax`] for text that is no JSON, or does not have the form of a scene.
    pub fn from_json(text: &str, source_name: &str) -> Result<Scene, Error> {
        // Some editors put a byte order mark in front.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut json = serde_json::Deserializer::from_str(text);
        let mut track = serde_path_to_error::Track::new();
        let scene = object(serde_path_to_error::Deserializer::new(&mut json, &mut track));
        let fail = |path: String, trailing: &str, error: serde_json::Error| Error::SceneSyntax {
            source_name: source_name.into(),
            line: error.line(),
            column: error.column().max(1),
            path,
            message: in_words(&error, text).replace("trailing characters", trailing),
        };
        // The parser knows one word for an array that is too long and for text behind the end.
        let scene = scene.map_err(|error| fail(track.path().to_string(), "the array has too many entries", error))?;
        json.end().map_err(|error| fail(".".into(), "there is more text behind the scene", error))?;
        Ok(scene)
    }

    /// Reads a scene from a JSON file; names of further files in it start from its folder.
    ///
    /// # Errors
    /// [`Error::File`] for a file that cannot be read, and as [`Scene::from_json`].
    pub fn read(path: impl AsRef<Path>) -> Result<Scene, Error> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| Error::File {
            action: "read",
            path: path.into(),
            source,
        })?;
        let scene = Self::from_json(&text, &path.display().to_string())?;
        Ok(Scene { folder: path.parent().map(Path::to_path_buf), ..scene })
    }

    /// The JSON Schema of scenes.
    pub fn json_schema() -> serde_json::Value {
        schemars::schema_for!(Scene).to_value()
    }
}

/// The parser's message without its position, and in the words of JSON instead of the words of Rust.
fn in_words(error: &serde_json::Error, text: &str) -> String {
    const WORDS: [(&str, &str); 9] = [
        ("invalid type: map", "invalid type: object"),
        ("invalid type: sequence", "invalid type: array"),
        ("expected f64", "expected a number"),
        ("expected usize", "expected a whole number that is not negative"),
        ("expected a sequence", "expected an array"),
        ("unknown variant", "unknown choice"),
        ("EOF while parsing", "the text ends within"),
        ("expected string or map", "expected a string or an object"),
        ("expected map with a single key", "expected an object with a single key"),
    ];
    let position = format!(" at line {} column {}", error.line(), error.column());
    let mut message = error.to_string().replace(&position, "");
    for (rust, json) in WORDS {
        message = message.replace(rust, json);
    }
    // The parser asks for a value where it finds a second key in an object that takes one.
    let line = text.lines().nth(error.line().saturating_sub(1)).unwrap_or_default();
    let at_comma = line.as_bytes().get(error.column()) == Some(&b',');
    let expected = if at_comma {
        "found a comma where an object with a single key ends, or a value stands"
    } else {
        "expected a JSON value"
    };
    message.replace("expected value", expected)
}

/// Accepts an object where a struct is expected, and nothing else: serde itself would take an array for it too.
pub(super) fn object<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<T, D::Error> {
    struct OfObject<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for OfObject<T> {
        type Value = T;
        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str("an object")
        }
        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
            T::deserialize(MapAccessDeserializer::new(map))
        }
    }
    deserializer.deserialize_map(OfObject(PhantomData))
}

/// Accepts an array of objects.
pub(super) fn objects<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    struct OneObject<T>(T);
    impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneObject<T> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            object(deserializer).map(OneObject)
        }
    }
    struct OfObjects<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for OfObjects<T> {
        type Value = Vec<T>;
        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str("an array of objects")
        }
        fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Vec<T>, A::Error> {
            let mut items = Vec::new();
            while let Some(OneObject(item)) = sequence.next_element()? {
                items.push(item);
            }
            Ok(items)
        }
    }
    deserializer.deserialize_seq(OfObjects(PhantomData))
}

/// Accepts a number, and no `null`: some writers put `null` for a number that they could not compute.
pub(super) fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    match Option::<f64>::deserialize(deserializer)? {
        Some(value) => Ok(Some(value)),
        None => Err(D::Error::custom("null is no number; leave the field out to leave the direction free")),
    }
}
