//! The way through the messages of a type that is not known: to its header, its child frame, and the known types
//! in it.
//!
//! Owns what is wanted of such a type. Standard types count at most one type deep inside the message; inside of types
//! that the standard packages publish, nothing is looked for: their packages define their meaning.

use std::sync::Arc;

use super::content::{Body, Content, Member};
use super::definition::{Count, Definitions, Field, Kind, Schema, Struct};
use super::guess::{self, Guess, Slot};
use super::header::Header;
use super::radar::{self, Detection};
use super::standard::Standard;
use super::walk::Walk;
use super::{Cursor, DecodeError, Wire};

/// Bound on the members of a message; real drivers have some five.
const MAX_MEMBERS: usize = 32;
/// Bound on the fields of a type that is read.
const MAX_INNER_FIELDS: usize = 1000;

/// What to do with the fields of a message, one after the other, up to the last one that is wanted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Route {
    schema: Schema,
    items: Vec<Item>,
    guesses: Vec<Guess>,
    /// The one detection of a radar that the message's own fields make.
    detection: Option<Detection>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Item {
    Pass(Field),
    /// The message's own header.
    Header {
        has_seq: bool,
    },
    /// The message's own child frame.
    Child,
    /// A member of a standard type.
    Member(Arc<str>, Standard),
    /// A field of one of the guesses.
    Plain(usize, Slot),
    /// A part of the message's own detection.
    Detected(radar::Slot),
    /// A list of detections: what each is read from.
    Detections(Arc<str>, Arc<(Detection, Vec<Field>)>),
}

impl Route {
    /// Finds the first header among the message's own fields, its first text called `child_frame_id`, and members. `None`
    /// where there is neither header nor member; the error says why a header that is there, or may be, cannot be reached.
    pub(super) fn of(schema: Schema, wire: Wire) -> Result<Option<Self>, String> {
        let Some(root) = schema.root() else { return Ok(None) };
        let is_header = |field: &Field| matches!(field.kind, Kind::Header { .. }) && field.count == Count::One;
        let header = root.fields.iter().position(is_header);
        if header.is_none() {
            let named = schema.types.iter().find(|one| one.is_called_header());
            if let Some(fault) = &root.fault {
                return Err(format!("its definition is not understood: {fault}"));
            }
            if named.is_some_and(|header| schema.holds(&header.name)) {
                return Err("its definition of std_msgs/Header differs from the published one".to_owned());
            }
        }
        let is_child =
            |field: &Field| field.name == "child_frame_id" && field.kind == Kind::Text && field.count == Count::One;
        let child = root.fields.iter().position(is_child).filter(|_| header.is_some());
        // Nothing after a field of unknown size can be read.
        let mut fields = root.fields.as_slice();
        let mut numbered = fields.iter().enumerate();
        if let Some((at, what)) = numbered.find_map(|(at, field)| Some((at, schema.impassable(field)?))) {
            if header.is_some_and(|header| at < header) {
                return Err(format!("its header cannot be read: {what}"));
            }
            fields = fields.get(..at).unwrap_or_default();
        }
        let mut plan = Plan {
            schema: &schema,
            wire,
            items: Vec::new(),
            guesses: Vec::new(),
            detection: None,
            members: 0,
            wanted: 0,
        };
        let looked_into = (!Definitions::is_standard(&root.name)).then(|| plan.guess(fields, ""));
        if looked_into.is_some() && fields.len() <= MAX_INNER_FIELDS {
            // A detection without a header has no frame.
            let whole = || Detection::of(root).filter(|found| found.slots.iter().all(|(at, _)| *at < fields.len()));
            plan.detection = header.and_then(|_| whole());
        }
        for (at, field) in fields.iter().enumerate() {
            match (&field.kind, &looked_into) {
                (Kind::Header { has_seq }, _) if header == Some(at) => plan.want(Item::Header { has_seq: *has_seq }),
                _ if child == Some(at) => plan.want(Item::Child),
                (_, None) => plan.pass(field),
                (_, Some(guessed)) => plan.field(at, field, "", guessed),
            }
        }
        let Plan {
            mut items,
            guesses,
            detection,
            wanted,
            ..
        } = plan;
        items.truncate(wanted);
        Ok((wanted > 0).then(|| Self {
            schema: schema.passed_by(&items),
            items,
            guesses,
            detection,
        }))
    }

    /// How many fields are kept, for a bound on all routes together.
    pub(super) fn fields(&self) -> usize {
        let listed = |item: &Item| match item {
            Item::Detections(_, list) => list.1.len(),
            _ => 0,
        };
        self.items.len()
            + self.items.iter().map(listed).sum::<usize>()
            + self.schema.types.iter().map(|one| one.fields.len()).sum::<usize>()
    }

    /// Whether the message is read by its header alone, which comes first.
    pub(super) fn is_header_alone(&self, wire: Wire) -> bool {
        let has_seq = wire == Wire::Ros1;
        self.items == [Item::Header { has_seq }]
    }

    /// Reads a message up to the last field that is wanted.
    pub(super) fn read<'m>(&self, mut cursor: Cursor<'m>) -> Result<Content<'m>, DecodeError> {
        let mut content = Content::new(None, Body::Nothing);
        let mut guesses: Vec<_> = self.guesses.iter().map(Guess::values).collect();
        let mut walk = Walk::new(&self.schema, &cursor);
        let mut detected = Detection::numbers();
        for item in &self.items {
            walk.step(&cursor)?;
            match item {
                Item::Pass(field) => walk.pass(&mut cursor, field)?,
                Item::Header { has_seq } => content.header = Some(Header::read_as(&mut cursor, *has_seq)?),
                Item::Child => content.body = Body::ChildFrame(cursor.name()?.into()),
                Item::Member(field, standard) => content.members.push(Member {
                    field: Arc::clone(field),
                    header: Some(Header::read(&mut cursor)?),
                    body: standard.body(&mut cursor)?,
                    guessed: false,
                }),
                Item::Plain(guess, slot) => {
                    if let Some(values) = guesses.get_mut(*guess) {
                        values.read(&mut cursor, *slot)?;
                    }
                }
                Item::Detected(slot) => slot.read(&mut detected, &mut cursor)?,
                Item::Detections(field, list) => content.members.push(Member {
                    field: Arc::clone(field),
                    header: None,
                    body: Body::Radar(Box::new(list.0.list(&mut cursor, &mut walk, &list.1)?)),
                    guessed: true,
                }),
            }
        }
        let guessed = self.guesses.iter().zip(guesses).map(|(guess, values)| Member {
            field: Arc::clone(&guess.field),
            header: None,
            body: values.body(),
            guessed: true,
        });
        content.members.extend(guessed);
        if let Some(detection) = &self.detection {
            content.members.push(Member {
                field: Arc::clone(detection.field()),
                header: None,
                body: Body::Radar(Box::new(detection.single(&detected))),
                guessed: true,
            });
        }
        if let Some(outer) = &content.header {
            for member in &mut content.members {
                fill(&mut member.header, outer);
            }
        }
        Ok(content)
    }
}

/// Fills empty parts of a member's header from the message's own: drivers fill in only one of the two.
fn fill<'m>(inner: &mut Option<Header<'m>>, outer: &Header<'m>) {
    let header = inner.get_or_insert_with(|| outer.clone());
    if header.stamp_ns == 0 {
        header.stamp_ns = outer.stamp_ns;
    }
    if header.frame_id.is_empty() {
        header.frame_id.clone_from(&outer.frame_id);
    }
}

/// A route that is being planned.
struct Plan<'s> {
    schema: &'s Schema,
    wire: Wire,
    items: Vec<Item>,
    guesses: Vec<Guess>,
    detection: Option<Detection>,
    members: usize,
    /// How many of the items lead up to the last one that is wanted.
    wanted: usize,
}

/// Which fields of a type belong to guesses: its place, the guess, where the numbers belong.
type Guesses = Vec<(usize, usize, Slot)>;

impl Plan<'_> {
    fn want(&mut self, item: Item) {
        self.items.push(item);
        self.wanted = self.items.len();
    }

    fn pass(&mut self, field: &Field) {
        let Field { kind, count, .. } = field.clone();
        self.items.push(Item::Pass(Field {
            name: String::new(),
            kind,
            count,
        }));
    }

    /// Notes what the plain fields of a type mean together.
    fn guess(&mut self, fields: &[Field], prefix: &str) -> Guesses {
        let mut guessed = Vec::new();
        for guess in guess::of(self.schema, fields, prefix, self.wire) {
            if self.members < MAX_MEMBERS {
                self.members += 1;
                guessed.extend(guess.slots.iter().map(|(at, slot)| (*at, self.guesses.len(), *slot)));
                self.guesses.push(guess);
            }
        }
        guessed
    }

    /// Takes in a field of the message itself, or of a type in it whose name is `prefix`.
    fn field(&mut self, at: usize, field: &Field, prefix: &str, guessed: &Guesses) {
        if let Some((_, guess, slot)) = guessed.iter().find(|(place, ..)| *place == at) {
            return self.want(Item::Plain(*guess, *slot));
        }
        if prefix.is_empty() {
            let mut slots = self.detection.iter().flat_map(|detection| &detection.slots);
            if let Some((_, slot)) = slots.find(|(place, _)| *place == at) {
                let slot = *slot;
                return self.want(Item::Detected(slot));
            }
        }
        if field.count == Count::Sequence
            && self.members < MAX_MEMBERS
            && let Some(list) = self.schema.detections(field)
        {
            self.members += 1;
            let path = format!("{prefix}{}", field.name);
            return self.want(Item::Detections(path.into(), Arc::new(list)));
        }
        let inner = match field.kind {
            Kind::Nested(index) if field.count == Count::One && self.members < MAX_MEMBERS => {
                self.schema.types.get(index).map(|inner| (index, inner))
            }
            _ => None,
        };
        let Some((index, inner)) = inner else {
            return self.pass(field);
        };
        if let Some(standard) = Standard::of_member(&inner.name) {
            if !self.schema.is_published(index, self.wire) {
                return self.pass(field);
            }
            self.members += 1;
            let path = format!("{prefix}{}", field.name);
            return self.want(Item::Member(path.into(), standard));
        }
        if !prefix.is_empty() || Definitions::is_standard(&inner.name) || inner.fields.len() > MAX_INNER_FIELDS {
            return self.pass(field);
        }
        self.inside(inner, field);
    }

    /// Reads a type in the message; skips it as a whole if there is nothing in it.
    fn inside(&mut self, inner: &Struct, field: &Field) {
        let (before, wanted) = (self.items.len(), self.wanted);
        let prefix = format!("{}.", field.name);
        let guessed = self.guess(&inner.fields, &prefix);
        for (at, field) in inner.fields.iter().enumerate() {
            self.field(at, field, &prefix, &guessed);
        }
        if self.wanted == wanted {
            self.items.truncate(before);
            self.pass(field);
        }
    }
}

impl Schema {
    /// Keeps only the types that are skipped, and no names.
    fn passed_by(mut self, items: &[Item]) -> Self {
        let nested = |field: &Field| match field.kind {
            Kind::Nested(index) => Some(index),
            _ => None,
        };
        let passed = items.iter().flat_map(|item| match item {
            Item::Pass(field) => std::slice::from_ref(field),
            Item::Detections(_, list) => list.1.as_slice(),
            _ => &[],
        });
        let mut to_look: Vec<usize> = passed.filter_map(nested).collect();
        let mut reached = vec![false; self.types.len()];
        while let Some(index) = to_look.pop() {
            let (Some(one), Some(seen)) = (self.types.get(index), reached.get_mut(index)) else {
                continue;
            };
            if !std::mem::replace(seen, true) {
                to_look.extend(one.fields.iter().filter_map(nested));
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

    /// Why a field cannot be skipped: something in it has an unknown size.
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
