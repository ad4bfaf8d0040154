//! Reads the wanted values of a protobuf message by a layout.

use std::borrow::Cow;

use super::descriptor::{Field, FieldType, Layout};
use super::value::{Object, Value};
use super::wire::{RawField, Wire};
use crate::read::messages::DecodeError;

/// The wanted values of a message. A field that is missing has its default, as the format requires: numbers are zero, texts
/// and lists empty.
pub(super) fn read<'m>(layout: &Layout, message: &'m [u8]) -> Result<Value<'m>, DecodeError> {
    let mut object = Object::default();
    if !layout.fields.is_empty() {
        merge(layout, Wire::new(message), &mut object)?;
        complete(layout, &mut object);
    }
    Ok(Value::Object(object))
}

/// Adds the fields of a stretch. Recursion is as deep as the layout, which is finite.
fn merge<'m>(layout: &Layout, mut wire: Wire<'m>, object: &mut Object<'m>) -> Result<(), DecodeError> {
    while let Some((number, raw)) = wire.field()? {
        let Some(field) = layout.fields.iter().find(|field| field.number == number) else {
            continue;
        };
        match (field.is_repeated, &field.holds, raw) {
            (true, _, _) => append(field, raw, object)?,
            // A message in several pieces is the sum of them.
            (false, FieldType::Message(inner), RawField::Bytes(bytes)) => {
                if object.get(field.name).is_none() {
                    object.set(field.name, Value::Object(Object::default()));
                }
                if let Some(Value::Object(known)) = object.get_mut(field.name) {
                    merge(inner, bytes, known)?;
                }
            }
            _ => {
                if let Some(value) = single(field, raw)? {
                    object.set(field.name, value);
                }
            }
        }
    }
    Ok(())
}

/// Adds to a list; numbers may come packed or one by one.
fn append<'m>(field: &Field, raw: RawField<'m>, object: &mut Object<'m>) -> Result<(), DecodeError> {
    if object.get(field.name).is_none() {
        object.set(field.name, Value::List(Vec::new()));
    }
    let Some(Value::List(list)) = object.get_mut(field.name) else {
        return Ok(());
    };
    match (&field.holds, raw) {
        (FieldType::Message(inner), RawField::Bytes(bytes)) => {
            let mut nested = Object::default();
            merge(inner, bytes, &mut nested)?;
            Value::Object(nested).push_into(list, field.name)
        }
        (FieldType::Text | FieldType::Message(_), _)
        | (_, RawField::Varint(_) | RawField::Fixed32(_) | RawField::Fixed64(_)) => match single(field, raw)? {
            Some(value) => value.push_into(list, field.name),
            None => Ok(()),
        },
        (_, RawField::Bytes(mut packed)) => {
            while !packed.is_empty() {
                let raw = match field.holds {
                    FieldType::Double | FieldType::Fixed64 | FieldType::Sfixed64 => RawField::Fixed64(packed.fixed()?),
                    FieldType::Float | FieldType::Fixed32 | FieldType::Sfixed32 => RawField::Fixed32(packed.fixed()?),
                    _ => RawField::Varint(packed.varint()?),
                };
                if let Some(value) = single(field, raw)? {
                    value.push_into(list, field.name)?;
                }
            }
            Ok(())
        }
        (_, RawField::Group) => Ok(()),
    }
}

/// A number or a text; `None` where the bytes are of another wire type, which makes them an unknown field.
fn single<'m>(field: &Field, raw: RawField<'m>) -> Result<Option<Value<'m>>, DecodeError> {
    Ok(Some(match (&field.holds, raw) {
        (FieldType::Double, RawField::Fixed64(bytes)) => Value::Number(f64::from_le_bytes(bytes)),
        (FieldType::Float, RawField::Fixed32(bytes)) => Value::Number(f32::from_le_bytes(bytes).into()),
        (FieldType::Varint, RawField::Varint(bits)) => Value::Integer(bits.cast_signed()),
        (FieldType::Zigzag, RawField::Varint(bits)) => {
            Value::Integer((bits >> 1).cast_signed() ^ -(bits & 1).cast_signed())
        }
        (FieldType::Fixed64 | FieldType::Sfixed64, RawField::Fixed64(bytes)) => {
            Value::Integer(i64::from_le_bytes(bytes))
        }
        (FieldType::Fixed32, RawField::Fixed32(bytes)) => Value::Integer(u32::from_le_bytes(bytes).into()),
        (FieldType::Sfixed32, RawField::Fixed32(bytes)) => Value::Integer(i32::from_le_bytes(bytes).into()),
        (FieldType::Text, RawField::Bytes(wire)) => {
            let text = std::str::from_utf8(wire.bytes()).map_err(|_| {
                let (name, at) = (field.name, wire.position());
                DecodeError(format!("`{name}` at byte {at} is not UTF-8"))
            })?;
            Value::Text(Cow::Borrowed(text))
        }
        _ => return Ok(None),
    }))
}

/// Sets missing fields to their default.
fn complete(layout: &Layout, object: &mut Object<'_>) {
    for field in &layout.fields {
        if object.get(field.name).is_none() {
            object.set(field.name, default_of(field));
        }
        match (&field.holds, object.get_mut(field.name)) {
            (FieldType::Message(inner), Some(Value::Object(nested))) => complete(inner, nested),
            (FieldType::Message(inner), Some(Value::List(list))) => {
                for element in list {
                    if let Value::Object(nested) = element {
                        complete(inner, nested);
                    }
                }
            }
            _ => {}
        }
    }
}

fn default_of(field: &Field) -> Value<'static> {
    match field.holds {
        _ if field.is_repeated => Value::List(Vec::new()),
        FieldType::Message(_) => Value::Object(Object::default()),
        FieldType::Text => Value::Text(Cow::Borrowed("")),
        FieldType::Double | FieldType::Float => Value::Number(0.0),
        _ => Value::Integer(0),
    }
}
