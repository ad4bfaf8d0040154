//! Walks over the bytes of a message by its definition: fields without a name here are only skipped.
//!
//! Owns what a definition's fields take up. Nothing is copied. Bounded against definitions that nest without end: the
//! steps of a message are a multiple of its bytes.

use super::definition::{Count, Field, Kind, Schema};
use super::{Cursor, DecodeError, Wire};

/// Bound on nested types.
const MAX_DEPTH: usize = 64;
/// Steps a message may take for each of its bytes, and in any case. A byte of a real message takes one step for each
/// type that contains it.
const STEPS_PER_BYTE: usize = 8;
const STEPS: usize = 256;

/// One walk over one message.
pub(super) struct Walk<'s> {
    schema: &'s Schema,
    steps: usize,
}

/// A type that is being skipped.
struct Frame {
    index: usize,
    /// Its next field.
    field: usize,
    /// How often it is still to be skipped, this time included.
    left: u32,
}

impl<'s> Walk<'s> {
    /// A walk from the begin of a message, over fields whose types are in `schema`.
    pub(super) fn new(schema: &'s Schema, cursor: &Cursor<'_>) -> Self {
        let steps = cursor
            .message_len()
            .saturating_mul(STEPS_PER_BYTE)
            .saturating_add(STEPS);
        Self { schema, steps }
    }

    /// Skips a field of any depth.
    pub(super) fn pass(&mut self, cursor: &mut Cursor<'_>, field: &Field) -> Result<(), DecodeError> {
        let mut stack = Vec::new();
        Self::begin(cursor, field, &mut stack)?;
        while let Some(top) = stack.last_mut() {
            self.step(cursor)?;
            let fields = self.schema.types.get(top.index).map(|one| one.fields.as_slice());
            let fields = fields.unwrap_or_default();
            if let Some(field) = fields.get(top.field) {
                top.field += 1;
                Self::begin(cursor, field, &mut stack)?;
                continue;
            }
            // ROS 2 gives a type without fields one byte, because IDL has no empty structs.
            if fields.is_empty() && cursor.wire() == Wire::Cdr {
                cursor.skip_numbers(1, 1)?;
            }
            top.field = 0;
            top.left -= 1;
            if top.left == 0 {
                stack.pop();
            }
        }
        Ok(())
    }

    /// Skips a field at once, or puts its type on the stack.
    fn begin(cursor: &mut Cursor<'_>, field: &Field, stack: &mut Vec<Frame>) -> Result<(), DecodeError> {
        let is_number = matches!(field.kind, Kind::Number(_));
        let count = match field.count {
            Count::One => 1,
            Count::Sequence if is_number => cursor.u32()?,
            Count::Sequence => cursor.sequence()?,
            Count::Fixed(count) => {
                if !is_number {
                    cursor.delimiter()?;
                }
                count
            }
        };
        let times = usize::try_from(count).unwrap_or(usize::MAX);
        match &field.kind {
            Kind::Number(number) => cursor.skip_numbers(number.size(), times),
            Kind::Time => cursor.skip_numbers(4, times.saturating_mul(2)),
            Kind::Text => (0..count).try_for_each(|_| cursor.skip_str()),
            Kind::Header { has_seq } => (0..count).try_for_each(|_| {
                cursor.skip_numbers(4, if *has_seq { 3 } else { 2 })?;
                cursor.skip_str()
            }),
            Kind::Nested(_) if stack.len() >= MAX_DEPTH => Err(DecodeError(format!(
                "types are nested more than {MAX_DEPTH} deep at byte {}",
                cursor.position()
            ))),
            Kind::Nested(index) => {
                if count > 0 {
                    stack.push(Frame {
                        index: *index,
                        field: 0,
                        left: count,
                    });
                }
                Ok(())
            }
            Kind::Unsupported(what) => Err(DecodeError(format!("at byte {}: {what}", cursor.position()))),
        }
    }

    /// Counts a step.
    pub(super) fn step(&mut self, cursor: &Cursor<'_>) -> Result<(), DecodeError> {
        self.steps = self.steps.checked_sub(1).ok_or_else(|| {
            let at = cursor.position();
            DecodeError(format!(
                "the definition requires more at byte {at} than the message can contain"
            ))
        })?;
        Ok(())
    }
}
