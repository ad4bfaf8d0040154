//! The wanted part of a message as a small tree.

use std::borrow::Cow;

use super::wanted::RANGES;
use crate::read::messages::DecodeError;

/// Numbers of a list that are kept: one more than the longest list that is wanted (6x6), so that a longer one is noticed.
pub(super) const MAX_NUMBERS: usize = 37;
/// Ranges of a scan that are kept; planar scanners have some thousand rays.
pub(super) const MAX_RANGES: usize = 20_000;
/// Bound on the messages within a list (`transforms`, `entities`); real ones hold some hundred. Without a bound, empty
/// messages of two bytes each would grow a hundredfold in memory.
pub(super) const MAX_ELEMENTS: usize = 20_000;

/// A value that is wanted, or the fact that it is something else.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'m> {
    Text(Cow<'m, str>),
    Integer(i64),
    Number(f64),
    /// `null`, which is also what JavaScript writes for a number that is not finite.
    Null,
    Object(Object<'m>),
    List(Vec<Value<'m>>),
    /// Something that is wanted nowhere, such as a truth value.
    Other,
}

/// Fields by name; few enough to be searched one by one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Object<'m>(pub(super) Vec<(&'static str, Value<'m>)>);

impl Value<'_> {
    /// What it is, for messages.
    pub(super) fn noun(&self) -> &'static str {
        match self {
            Self::Text(_) => "a text",
            Self::Integer(_) | Self::Number(_) => "a number",
            Self::Null => "null",
            Self::Object(_) => "an object",
            Self::List(_) => "a list",
            Self::Other => "something else",
        }
    }

    /// Adds an element to a list; an error where it has too many messages.
    pub(super) fn push_into(self, list: &mut Vec<Self>, name: &str) -> Result<(), DecodeError> {
        if !matches!(self, Self::Object(_)) {
            let most = if name == RANGES { MAX_RANGES } else { MAX_NUMBERS };
            if list.len() < most {
                list.push(self);
            }
            return Ok(());
        }
        if list.len() >= MAX_ELEMENTS {
            return Err(DecodeError(format!("`{name}` has more than {MAX_ELEMENTS} elements")));
        }
        list.push(self);
        Ok(())
    }
}

impl<'m> Object<'m> {
    /// A field, where it is there.
    pub(super) fn get(&self, name: &str) -> Option<&Value<'m>> {
        self.0.iter().find(|(known, _)| *known == name).map(|(_, value)| value)
    }

    /// A field to change.
    pub(super) fn get_mut(&mut self, name: &str) -> Option<&mut Value<'m>> {
        self.0
            .iter_mut()
            .find(|(known, _)| *known == name)
            .map(|(_, value)| value)
    }

    /// Takes a field out.
    pub(super) fn take(&mut self, name: &str) -> Option<Value<'m>> {
        let at = self.0.iter().position(|(known, _)| *known == name)?;
        Some(self.0.swap_remove(at).1)
    }

    /// Sets a field; of a repeated name the last value counts, as in JavaScript and in Protocol Buffers.
    pub(super) fn set(&mut self, name: &'static str, value: Value<'m>) {
        match self.get_mut(name) {
            Some(known) => *known = value,
            None => self.0.push((name, value)),
        }
    }
}
