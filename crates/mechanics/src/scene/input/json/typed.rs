//! From a tree of JSON to typed values: the type alone says what it accepts, and nothing else is read in its place.

use std::collections::HashSet;
use std::slice::{Iter, from_ref};
use std::str::FromStr;

use jsonc_parser::ast::{NullKeyword, ObjectProp, Value};
use jsonc_parser::common::{Range, Ranged};
use serde::de::value::BorrowedStrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, EnumAccess, Expected, MapAccess, SeqAccess, VariantAccess, Visitor};
use serde::forward_to_deserialize_any;

use super::fault::{ARRAY, Fault, NUMBER, OBJECT, What};

const SINGLE_KEY: &str = "an object with a single key";

/// The names that an object or a choice may have.
type Names = &'static [&'static str];

/// A value of JSON that becomes a typed one.
#[derive(Clone, Copy)]
pub(crate) struct Typed<'a>(pub &'a Value<'a>);

impl<'a> Typed<'a> {
    fn fault<T>(self, what: What) -> Result<T, Fault> {
        Err(Fault::at(self.0.start(), what))
    }

    fn not<T>(self, expected: &str) -> Result<T, Fault> {
        let found = match self.0 {
            Value::StringLit(text) => format!("the string {:?}", text.value),
            Value::NumberLit(number) => format!("the number {}", number.value),
            Value::BooleanLit(boolean) => format!("`{}`", boolean.value),
            Value::Object(_) => "an object".into(),
            Value::Array(_) => "an array".into(),
            Value::NullKeyword(_) => "null".into(),
        };
        self.fault(What::Type { expected: expected.into(), found })
    }

    fn whole<T: FromStr>(self) -> Result<T, Fault> {
        let whole = self.0.as_number_lit().and_then(|number| number.value.parse().ok());
        whole.map_or_else(|| self.not("a whole number that is not negative, in digits alone"), Ok)
    }
}

impl<'de> Deserializer<'de> for Typed<'de> {
    type Error = Fault;

    /// A string or an array; no type of a scene accepts any value.
    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.0 {
            Value::StringLit(text) => visitor.visit_str(&text.value),
            Value::Array(_) => self.deserialize_seq(visitor),
            _ => self.not(&(&visitor as &dyn Expected).to_string()),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.0 {
            Value::BooleanLit(boolean) => visitor.visit_bool(boolean.value),
            _ => self.not("a boolean"),
        }
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_u32(self.whole()?)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_u64(self.whole()?)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.0.as_number_lit().and_then(|number| number.value.parse().ok()) {
            Some(number) if f64::is_finite(number) => visitor.visit_f64(number),
            Some(_) => self.fault(What::OutOfRange),
            None => self.not(NUMBER),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.0 {
            Value::StringLit(text) => visitor.visit_str(&text.value),
            _ => self.not("a string"),
        }
    }

    /// A field that is left out is absent, and never `null`: some programs write `null` for a number that they could
    /// not compute.
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        static NULL: Value = Value::NullKeyword(NullKeyword { range: Range { start: 0, end: 0 } });
        if let Value::Array(array) = self.0 {
            return visitor.visit_seq(Items(array.elements.iter().enumerate()));
        }
        // The type tells what it has in the array when it refuses a null there.
        let refused = visitor.visit_seq(Items(from_ref(&NULL).iter().enumerate())).err().map(|fault| fault.what);
        let has_objects = matches!(refused, Some(What::Type { expected, .. }) if expected == OBJECT);
        self.not(if has_objects { "an array of objects" } else { ARRAY })
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, expected: usize, visitor: V) -> Result<V::Value, Fault> {
        match self.0.as_array().map(|array| array.elements.len()) {
            Some(found) if found == expected => self.deserialize_seq(visitor),
            Some(found) => self.fault(What::Length { expected, found }),
            None => self.not(&format!("an array of length {expected}")),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(self, _: &'static str, _: Names, visitor: V) -> Result<V::Value, Fault> {
        let Value::Object(object) = self.0 else { return self.not(OBJECT) };
        let mut fields = ObjectFields { rest: object.properties.iter(), last: None };
        // A fault without a place is one of a key that has come before, or of one that may stand before the closing
        // bracket.
        visitor.visit_map(&mut fields).map_err(|fault| match (&fault.what, fields.last) {
            (&What::KeyTwice(key), Some(last)) if fault.at.is_none() => fault.inside(key, last.start()),
            _ => fault.placed(self.0.end() - 1),
        })
    }

    /// An object whose keys are names of the user.
    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let Value::Object(object) = self.0 else { return self.not(OBJECT) };
        let mut names = HashSet::new();
        if let Some(twice) = object.properties.iter().find(|field| !names.insert(field.name.as_str())) {
            let name = twice.name.as_str();
            return Err(Fault::at(twice.start(), What::Other(format!("the key `{name}` stands twice"))));
        }
        visitor.visit_map(ObjectFields { rest: object.properties.iter(), last: None })
    }

    fn deserialize_enum<V: Visitor<'de>>(self, _: &'static str, known: Names, visitor: V) -> Result<V::Value, Fault> {
        let first = self.0.as_object().and_then(|object| object.properties.first());
        let name = first.map(|first| first.name.as_str()).or(self.0.as_string_lit().map(|text| &*text.value));
        visitor.visit_enum(Choice { value: self, name: name.unwrap_or_default(), known })
    }

    forward_to_deserialize_any! {
        i8 i16 i32 i64 u8 u16 f32 char str bytes byte_buf unit unit_struct newtype_struct tuple_struct identifier ignored_any
    }
}

struct Items<'a>(std::iter::Enumerate<Iter<'a, Value<'a>>>);

impl<'a> SeqAccess<'a> for Items<'a> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'a>>(&mut self, seed: T) -> Result<Option<T::Value>, Fault> {
        let Some((index, item)) = self.0.next() else { return Ok(None) };
        seed.deserialize(Typed(item)).map(Some).map_err(|fault| fault.inside(&format!("[{index}]"), item.start()))
    }
}

struct ObjectFields<'a> {
    rest: Iter<'a, ObjectProp<'a>>,
    last: Option<&'a ObjectProp<'a>>,
}

impl<'a> MapAccess<'a> for ObjectFields<'a> {
    type Error = Fault;

    fn next_key_seed<K: DeserializeSeed<'a>>(&mut self, seed: K) -> Result<Option<K::Value>, Fault> {
        self.last = self.rest.next();
        let Some(field) = self.last else { return Ok(None) };
        let key = field.name.as_str();
        let read = seed.deserialize(BorrowedStrDeserializer::<Fault>::new(key));
        read.map(Some).map_err(|fault| fault.inside(key, field.start()))
    }

    fn next_value_seed<T: DeserializeSeed<'a>>(&mut self, seed: T) -> Result<T::Value, Fault> {
        let without_key = || Fault::from(What::Other("a value stands without a key".into()));
        value_of(self.last.ok_or_else(without_key)?, seed)
    }
}

fn value_of<'a, T: DeserializeSeed<'a>>(field: &'a ObjectProp<'a>, seed: T) -> Result<T::Value, Fault> {
    let read = seed.deserialize(Typed(&field.value));
    read.map_err(|fault| fault.inside(field.name.as_str(), field.value.start()))
}

/// A word, or the single key of an object, that chooses a variant. Only the variants tell which of both they are: if
/// the name is unknown, or there is none, the first variant is asked, and refuses the value.
struct Choice<'a> {
    value: Typed<'a>,
    name: &'a str,
    known: Names,
}

impl Choice<'_> {
    fn is_known(&self) -> bool {
        self.known.contains(&self.name)
    }

    fn unknown(&self, at: usize) -> Fault {
        Fault::at(at, What::UnknownChoice { name: self.name.into(), known: self.known })
    }
}

impl<'a> EnumAccess<'a> for Choice<'a> {
    type Error = Fault;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'a>>(self, seed: V) -> Result<(V::Value, Self), Fault> {
        let asked = if self.is_known() { self.name } else { self.known[0] };
        Ok((seed.deserialize(BorrowedStrDeserializer::<Fault>::new(asked))?, self))
    }
}

impl<'a> VariantAccess<'a> for Choice<'a> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        match self.value.0 {
            Value::StringLit(_) if self.is_known() => Ok(()),
            Value::StringLit(text) => Err(self.unknown(text.start())),
            _ => self.value.not("a string"),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'a>>(self, seed: T) -> Result<T::Value, Fault> {
        let Value::Object(object) = self.value.0 else { return self.value.not(SINGLE_KEY) };
        let Some(first) = object.properties.first() else {
            return self.value.fault(What::Other("must be an object with a single key, but is empty".into()));
        };
        if !self.is_known() {
            return Err(self.unknown(first.start()).inside(self.name, first.start()));
        }
        let chosen = value_of(first, seed)?;
        match object.properties.get(1) {
            None => Ok(chosen),
            Some(second) => {
                let name = second.name.as_str();
                let words = format!("must be an object with a single key, but has a second one, `{name}`");
                Err(Fault::at(second.start(), What::Other(words)))
            }
        }
    }

    fn tuple_variant<V: Visitor<'a>>(self, _: usize, _: V) -> Result<V::Value, Fault> {
        self.value.not(SINGLE_KEY)
    }

    fn struct_variant<V: Visitor<'a>>(self, _: Names, _: V) -> Result<V::Value, Fault> {
        self.value.not(SINGLE_KEY)
    }
}
