//! From text to a typed scene: every failure has a path, a line and a column.

use std::fmt;
use std::io;
use std::marker::PhantomData;
use std::path::Path;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error as _, IgnoredAny, IntoDeserializer, MapAccess, SeqAccess, Visitor};

use super::Scene;
use crate::error::Error;
use crate::file::{MOST_OF_SCENE, read_text_capped};

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
            message: in_words(&error).replace("trailing characters", trailing),
        };
        // The parser knows one word for an array that is too long and for text behind the end.
        let scene = scene.map_err(|error| fail(known_path(track), "the array has too many entries", error))?;
        json.end().map_err(|error| fail(".".into(), "there is more text behind the scene", error))?;
        Ok(scene)
    }

    /// Reads a scene from a JSON file; names of further files in it start from its folder.
    ///
    /// # Errors
    /// [`Error::File`] for a file that cannot be read, and as [`Scene::from_json`].
    pub fn read(path: impl AsRef<Path>) -> Result<Scene, Error> {
        let path = path.as_ref();
        if path.is_dir() {
            let source = io::Error::new(io::ErrorKind::IsADirectory, "it is a folder, but a scene is a JSON file");
            return Err(Error::File { action: "read", path: path.into(), source });
        }
        let text = read_text_capped(path, MOST_OF_SCENE)?;
        let scene = Self::from_json(&text, &path.display().to_string())?;
        Ok(Scene { folder: path.parent().map(Path::to_path_buf), ..scene })
    }

    /// The JSON Schema of scenes.
    #[cfg(feature = "cli")]
    pub fn json_schema() -> serde_json::Value {
        schemars::schema_for!(Scene).to_value()
    }
}

/// Where the parser stood, without the key that it could not read.
fn known_path(track: serde_path_to_error::Track) -> String {
    match track.path().to_string().trim_end_matches('?').trim_end_matches('.') {
        "" => ".".into(),
        path => path.into(),
    }
}

/// The parser's message without its position, and in the words of JSON instead of the words of Rust.
fn in_words(error: &serde_json::Error) -> String {
    const WORDS: [(&str, &str); 10] = [
        ("invalid type: map, expected enum", "the object is empty, expected a single key"),
        ("invalid type: map", "invalid type: object"),
        ("invalid type: sequence", "invalid type: array"),
        ("expected f64", "expected a number"),
        ("expected usize", "expected a whole number that is not negative"),
        ("expected a sequence", "expected an array"),
        ("unknown variant", "unknown choice"),
        ("EOF while parsing", "the text ends within"),
        ("expected string or map", "expected a string or an object"),
        ("expected value", "expected a JSON value"),
    ];
    let position = format!(" at line {} column {}", error.line(), error.column());
    let mut message = error.to_string().replace(&position, "");
    for (rust, json) in WORDS {
        message = message.replace(rust, json);
    }
    message
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

/// Accepts an object with a single key that chooses what its value is: the parser itself has no words for another form.
pub(super) fn choice<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<T, D::Error> {
    struct OfSingleKey<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for OfSingleKey<T> {
        type Value = T;
        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str("an object with a single key")
        }
        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<T, A::Error> {
            let chosen = T::deserialize(MapAccessDeserializer::new(&mut map))?;
            match map.next_key::<IgnoredAny>()? {
                None => Ok(chosen),
                Some(_) => Err(A::Error::custom("a second key, expected an object with a single key")),
            }
        }
    }
    deserializer.deserialize_map(OfSingleKey(PhantomData))
}

/// Accepts an array of choices.
pub(super) fn choices<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    struct OneChoice<T>(T);
    impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneChoice<T> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            choice(deserializer).map(OneChoice)
        }
    }
    let items = Vec::<OneChoice<T>>::deserialize(deserializer)?;
    Ok(items.into_iter().map(|OneChoice(item)| item).collect())
}

/// Accepts a word out of a list, and no other JSON value.
pub(super) fn word<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<T, D::Error> {
    struct OfWord<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for OfWord<T> {
        type Value = T;
        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str("a string")
        }
        fn visit_str<E: serde::de::Error>(self, word: &str) -> Result<T, E> {
            T::deserialize(word.into_deserializer())
        }
    }
    deserializer.deserialize_str(OfWord(PhantomData))
}

/// Accepts an array of words.
pub(super) fn words<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    struct OneWord<T>(T);
    impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneWord<T> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            word(deserializer).map(OneWord)
        }
    }
    let items = Vec::<OneWord<T>>::deserialize(deserializer)?;
    Ok(items.into_iter().map(|OneWord(item)| item).collect())
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

/// Accepts a value, and no `null`.
pub(super) fn given<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}
