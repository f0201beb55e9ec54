//! The JSON values that a field accepts; further values that serde would accept are refused.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error as _, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// The format of scenes that this program reads.
const FORMAT: u32 = 1;

/// Accepts only an object for a struct; serde itself would also accept an array.
pub(in crate::scene) fn object<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<T, D::Error> {
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

/// Accepts an object with a single key that chooses the kind of its value: the parser itself has no message for another form.
pub(in crate::scene) fn choice<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<T, D::Error> {
    struct OfSingleKey<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for OfSingleKey<T> {
        type Value = T;
        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str("an object with a single key")
        }
        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<T, A::Error> {
            let chosen = T::deserialize(MapAccessDeserializer::new(&mut map))?;
            match map.next_key::<String>()? {
                None => Ok(chosen),
                Some(second) => Err(A::Error::custom(format_args!(
                    "must be an object with a single key, but has a second one, `{second}`"
                ))),
            }
        }
    }
    deserializer.deserialize_map(OfSingleKey(PhantomData))
}

/// Accepts an array of choices.
pub(in crate::scene) fn choices<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    struct OneChoice<T>(T);
    impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneChoice<T> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            choice(deserializer).map(OneChoice)
        }
    }
    let items = Vec::<OneChoice<T>>::deserialize(deserializer)?;
    Ok(items.into_iter().map(|OneChoice(item)| item).collect())
}

/// Accepts a word from a list, and no other JSON value.
pub(in crate::scene) fn word<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<T, D::Error> {
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
pub(in crate::scene) fn words<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
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
pub(in crate::scene) fn objects<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
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

/// Accepts a number, but not `null`: some programs write `null` for a number that they could not compute.
pub(in crate::scene) fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    match Option::<f64>::deserialize(deserializer)? {
        Some(value) => Ok(Some(value)),
        None => Err(D::Error::custom("null is not a number; remove the key to leave the direction free")),
    }
}

/// Accepts the number of the one format of scenes.
pub(in crate::scene) fn format<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u32>, D::Error> {
    match u32::deserialize(deserializer)? {
        FORMAT => Ok(Some(FORMAT)),
        other => Err(D::Error::custom(format_args!(
            "format {other} of scenes is not known; this program reads format {FORMAT}"
        ))),
    }
}

/// Accepts a value, but not `null`.
pub(in crate::scene) fn given<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

/// Accepts an object, but not `null`.
pub(in crate::scene) fn given_object<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    object(deserializer).map(Some)
}
