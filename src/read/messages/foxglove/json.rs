//! Reads the wanted values of a JSON message in one pass; everything else is skipped.

use std::borrow::Cow;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::value::{Object, Value};
use super::wanted::FieldSelection;
use crate::read::messages::DecodeError;

/// The wanted values of a message. Of repeated keys the last one counts.
pub(super) fn read<'m>(wanted: &'static FieldSelection, message: &'m [u8]) -> Result<Value<'m>, DecodeError> {
    let mut reader = serde_json::Deserializer::from_slice(message);
    let top = Place {
        name: "",
        wanted,
        in_list: false,
    };
    top.deserialize(&mut reader)
        .and_then(|value| reader.end().map(|()| value))
        .map_err(|error| DecodeError(format!("not valid JSON: {error}")))
}

/// The place of a value: what is wanted of it decides how deep it is read.
#[derive(Clone, Copy)]
struct Place {
    name: &'static str,
    wanted: &'static FieldSelection,
    in_list: bool,
}

impl<'m> DeserializeSeed<'m> for Place {
    type Value = Value<'m>;

    fn deserialize<D: Deserializer<'m>>(self, reader: D) -> Result<Self::Value, D::Error> {
        reader.deserialize_any(self)
    }
}

impl<'m> Visitor<'m> for Place {
    type Value = Value<'m>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_bool<E>(self, _: bool) -> Result<Self::Value, E> {
        Ok(Value::Other)
    }

    fn visit_i64<E>(self, number: i64) -> Result<Self::Value, E> {
        Ok(Value::Integer(number))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Self::Value, E> {
        Ok(i64::try_from(number).map_or(Value::Number(number as f64), Value::Integer))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Self::Value, E> {
        Ok(Value::Number(number))
    }

    fn visit_str<E>(self, text: &str) -> Result<Self::Value, E> {
        Ok(Value::Text(Cow::Owned(text.to_owned())))
    }

    fn visit_borrowed_str<E>(self, text: &'m str) -> Result<Self::Value, E> {
        Ok(Value::Text(Cow::Borrowed(text)))
    }

    fn visit_unit<E>(self) -> Result<Self::Value, E> {
        Ok(Value::Null)
    }

    fn visit_map<A: MapAccess<'m>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut object = Object::default();
        while let Some(field) = map.next_key_seed(Key(self.wanted))? {
            match field {
                Some((name, wanted)) => {
                    let in_list = false;
                    let value = map.next_value_seed(Place { name, wanted, in_list })?;
                    object.set(name, value);
                }
                None => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        Ok(Value::Object(object))
    }

    fn visit_seq<A: SeqAccess<'m>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        if self.in_list {
            // No list of lists is wanted anywhere.
            while seq.next_element::<IgnoredAny>()?.is_some() {}
            return Ok(Value::Other);
        }
        let mut list = Vec::new();
        let element = Self { in_list: true, ..self };
        while let Some(value) = seq.next_element_seed(element)? {
            value
                .push_into(&mut list, self.name)
                .map_err(|error| A::Error::custom(error.0))?;
        }
        Ok(Value::List(list))
    }
}

/// A key, which is never kept.
struct Key(&'static FieldSelection);

impl<'m> DeserializeSeed<'m> for Key {
    type Value = Option<(&'static str, &'static FieldSelection)>;

    fn deserialize<D: Deserializer<'m>>(self, reader: D) -> Result<Self::Value, D::Error> {
        reader.deserialize_str(self)
    }
}

impl Visitor<'_> for Key {
    type Value = Option<(&'static str, &'static FieldSelection)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E>(self, key: &str) -> Result<Self::Value, E> {
        Ok(self.0.field(key))
    }
}
