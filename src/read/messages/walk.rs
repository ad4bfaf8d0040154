//! Walks over the bytes of a message by its definition, to the header and the child frame of a type that is not known.
//!
//! Owns what a definition's fields take up. Nothing is copied, and what has no name here is only passed over. Bounded
//! against definitions that nest without end: the steps of a message are a multiple of its bytes.

use super::content::{Body, Content};
use super::definition::{Count, Field, Kind, Schema};
use super::header::Header;
use super::{Cursor, DecodeError, Wire};

/// Bound on types inside each other.
const MAX_DEPTH: usize = 64;
/// Steps a message may take for each of its bytes, and in any case. A byte of a real message takes one step for each
/// type it stands in.
const STEPS_PER_BYTE: usize = 8;
const STEPS: usize = 256;

/// The way to the header of a type, and to the field `child_frame_id` where it has one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Route {
    schema: Schema,
    /// Which of the message's own fields is the header, and whether that begins with a sequence number.
    header: usize,
    has_seq: bool,
    /// Which of the message's own fields is the child frame.
    child: Option<usize>,
}

impl Route {
    /// Finds the first header among the message's own fields, and its first text called `child_frame_id`. `None` where
    /// there is no header; the error says why one that is there, or may be, cannot be reached.
    pub fn of(schema: Schema) -> Result<Option<Self>, String> {
        let Some(root) = schema.root() else { return Ok(None) };
        let is_header = |field: &Field| match field.kind {
            Kind::Header { has_seq } if field.count == Count::One => Some(has_seq),
            _ => None,
        };
        let mut fields = root.fields.iter().enumerate();
        let Some((header, has_seq)) = fields.find_map(|(at, field)| Some((at, is_header(field)?))) else {
            return match (&root.fault, schema.types.iter().find(|one| one.is_called_header())) {
                (Some(fault), _) => Err(format!("its definition is not understood: {fault}")),
                (None, Some(header)) if schema.holds(header.name.as_str()) => {
                    Err("the std_msgs/Header that is defined with it is not the published one".to_owned())
                }
                (None, _) => Ok(None),
            };
        };
        let is_child =
            |field: &Field| field.name == "child_frame_id" && field.kind == Kind::Text && field.count == Count::One;
        let mut child = root.fields.iter().position(is_child);
        let mut to_pass = root.fields.iter().enumerate();
        if let Some((at, what)) = to_pass.find_map(|(at, field)| Some((at, schema.impassable(field)?))) {
            if at < header {
                return Err(format!("its header cannot be reached: {what}"));
            }
            child = child.filter(|child| *child < at);
        }
        Ok(Some(Self {
            schema: schema.up_to(child.unwrap_or(header).max(header)),
            header,
            has_seq,
            child,
        }))
    }

    /// How many fields are kept, for a bound on all routes together.
    pub fn fields(&self) -> usize {
        self.schema.types.iter().map(|one| one.fields.len()).sum()
    }

    /// Whether the message is read by its header alone, which stands first.
    pub fn is_header_alone(&self, wire: Wire) -> bool {
        self.header == 0 && self.child.is_none() && self.has_seq == (wire == Wire::Ros1)
    }

    /// Reads a message up to the last field that is wanted.
    pub fn read<'m>(&self, mut cursor: Cursor<'m>) -> Result<Content<'m>, DecodeError> {
        let mut content = Content {
            header: None,
            body: Body::Nothing,
        };
        let mut walk = Walk {
            schema: &self.schema,
            steps: cursor
                .message_len()
                .saturating_mul(STEPS_PER_BYTE)
                .saturating_add(STEPS),
        };
        let last = self.child.unwrap_or(self.header).max(self.header);
        let fields = self
            .schema
            .root()
            .map(|root| root.fields.as_slice())
            .unwrap_or_default();
        for (at, field) in fields.iter().enumerate().take(last + 1) {
            if at == self.header {
                content.header = Some(Header::read_as(&mut cursor, self.has_seq)?);
            } else if Some(at) == self.child {
                content.body = Body::ChildFrame(cursor.name()?.into());
            } else {
                walk.step(&cursor)?;
                walk.pass(&mut cursor, field)?;
            }
        }
        Ok(content)
    }
}

impl Schema {
    /// Leaves only what is passed over on the way to the message's field `last`, that included, and no names.
    fn up_to(mut self, last: usize) -> Self {
        if let Some(root) = self.types.first_mut() {
            root.fields.truncate(last + 1);
        }
        let mut reached = vec![false; self.types.len()];
        let mut to_look = vec![0];
        while let Some(index) = to_look.pop() {
            let (Some(one), Some(seen)) = (self.types.get(index), reached.get_mut(index)) else {
                continue;
            };
            if !std::mem::replace(seen, true) {
                to_look.extend(one.fields.iter().filter_map(|field| match field.kind {
                    Kind::Nested(nested) => Some(nested),
                    _ => None,
                }));
            }
        }
        for (one, is_reached) in self.types.iter_mut().zip(reached) {
            if !is_reached {
                one.fields = Vec::new();
            }
            one.fields.shrink_to_fit();
            one.fields.iter_mut().for_each(|field| field.name = String::new());
            one.name = String::new();
        }
        self
    }

    /// Whether a field of the message itself is of this type.
    fn holds(&self, name: &str) -> bool {
        let named = |field: &Field| match field.kind {
            Kind::Nested(index) => self.types.get(index).is_some_and(|one| one.name == name),
            _ => false,
        };
        self.root().is_some_and(|root| root.fields.iter().any(named))
    }

    /// Why a field cannot be passed over: something in it has a size that is not known.
    fn impassable(&self, field: &Field) -> Option<String> {
        let mut seen = vec![false; self.types.len()];
        let mut to_look = vec![&field.kind];
        while let Some(kind) = to_look.pop() {
            match kind {
                Kind::Unsupported(what) => return Some(what.clone()),
                Kind::Nested(index) => {
                    let (Some(nested), Some(seen)) = (self.types.get(*index), seen.get_mut(*index)) else {
                        continue;
                    };
                    if std::mem::replace(seen, true) {
                        continue;
                    }
                    if let Some(fault) = &nested.fault {
                        return Some(format!("{} is not understood: {fault}", nested.name));
                    }
                    to_look.extend(nested.fields.iter().map(|field| &field.kind));
                }
                Kind::Number(_) | Kind::Text | Kind::Time | Kind::Header { .. } => {}
            }
        }
        None
    }
}

/// One walk over one message.
struct Walk<'s> {
    schema: &'s Schema,
    steps: usize,
}

/// A type that is being passed over.
struct Frame {
    index: usize,
    /// Its next field.
    field: usize,
    /// How often it is still to be passed, this time included.
    left: u32,
}

impl Walk<'_> {
    /// Passes over a field, however deep it goes.
    fn pass(&mut self, cursor: &mut Cursor<'_>, field: &Field) -> Result<(), DecodeError> {
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
            // ROS 2 gives a type without fields one byte, because IDL knows no empty structs.
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

    /// Passes over a field at once, or puts its type on the stack.
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
                "more than {MAX_DEPTH} types inside each other at byte {}",
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

    fn step(&mut self, cursor: &Cursor<'_>) -> Result<(), DecodeError> {
        self.steps = self.steps.checked_sub(1).ok_or_else(|| {
            let at = cursor.position();
            DecodeError(format!(
                "the definition asks for more at byte {at} than the message can hold"
            ))
        })?;
        Ok(())
    }
}
