//! A type with all its parts: names looked up, times and headers recognised.

use std::collections::BTreeMap;

use super::{Bundle, Count, Definitions, Number, StructSpelling, TypeSpelling, idl, plain_name};

/// A message type and the types of its fields; the first one is the message's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Schema {
    /// The types, each once.
    pub types: Vec<Struct>,
}

/// A type made of fields.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Struct {
    /// `package/Type`.
    pub name: String,
    /// Its fields in order, up to the fault if there is one.
    pub fields: Vec<Field>,
    /// Where its definition was not understood.
    pub fault: Option<String>,
}

/// A field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// How often it occurs.
    pub count: Count,
}

/// What a field is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number(Number),
    /// A text.
    Text,
    /// A time or a duration: seconds and nanoseconds, four bytes each.
    Time,
    /// A `std_msgs/Header` as published.
    Header {
        /// Whether it begins with a sequence number, as in ROS 1.
        has_seq: bool,
    },
    /// Another type, by its place in [`Schema::types`].
    Nested(usize),
    /// Something whose size is not known: the reason.
    Unsupported(String),
}

/// Bound on names for names for a type.
const MAX_ALIASES: usize = 16;

impl Schema {
    /// The type as the standard packages publish it, even if folders were added.
    pub fn published(name: &str) -> Option<Self> {
        Self::link(name, None, &Definitions::builtin())
    }

    /// Puts together the type `root`: from the definitions that came with it, else from those available. `None` if
    /// neither has it.
    pub fn link(root: &str, carried: Option<&Bundle>, definitions: &Definitions) -> Option<Self> {
        let mut linker = Linker {
            carried,
            definitions,
            place: BTreeMap::new(),
            found: Vec::new(),
        };
        linker.place_of(&plain_name(root))?;
        let mut schema = Self::default();
        while let Some((name, spelled)) = linker.found.get(schema.types.len()).cloned() {
            let mut fields = Vec::with_capacity(spelled.fields.len());
            for field in &spelled.fields {
                let (kind, count) = linker.kind(&field.spelled, field.count);
                let name = field.name.clone();
                fields.push(Field { name, kind, count });
            }
            let fault = spelled.fault.clone();
            schema.types.push(Struct { name, fields, fault });
        }
        schema.recognise(Struct::as_time);
        schema.recognise(Struct::as_header);
        Some(schema)
    }

    /// The message's own type.
    pub fn root(&self) -> Option<&Struct> {
        self.types.first()
    }

    /// Replaces each type that is known under another kind.
    fn recognise(&mut self, known: fn(&Struct) -> Option<Kind>) {
        let kinds: Vec<Option<Kind>> = self.types.iter().map(known).collect();
        for field in self.types.iter_mut().flat_map(|one| &mut one.fields) {
            if let Kind::Nested(index) = field.kind
                && let Some(Some(kind)) = kinds.get(index)
            {
                field.kind = kind.clone();
            }
        }
    }
}

impl Struct {
    fn kinds(&self) -> Option<Vec<&Kind>> {
        let is_plain = self.fault.is_none() && self.fields.iter().all(|field| field.count == Count::One);
        is_plain.then(|| self.fields.iter().map(|field| &field.kind).collect())
    }

    fn as_time(&self) -> Option<Kind> {
        let is_time = matches!(
            self.name.as_str(),
            "builtin_interfaces/Time" | "builtin_interfaces/Duration"
        );
        let four = [Number::Signed(4), Number::Unsigned(4)].map(Kind::Number);
        let is_two_numbers = self.kinds()? == four.iter().collect::<Vec<_>>();
        (is_time && is_two_numbers).then_some(Kind::Time)
    }

    /// What this type is, if it is a header as published.
    pub fn as_header(&self) -> Option<Kind> {
        let has_seq = match *self.kinds()? {
            [Kind::Time, Kind::Text] => false,
            [Kind::Number(Number::Unsigned(4)), Kind::Time, Kind::Text] => true,
            _ => return None,
        };
        let ends_right = self.fields.last().is_some_and(|last| last.name == "frame_id");
        (self.is_called_header() && ends_right).then_some(Kind::Header { has_seq })
    }

    /// Whether this is a header by its name.
    pub fn is_called_header(&self) -> bool {
        self.name == "std_msgs/Header"
    }
}

struct Linker<'d> {
    carried: Option<&'d Bundle>,
    definitions: &'d Definitions,
    /// The place of each type found so far.
    place: BTreeMap<String, usize>,
    found: Vec<(String, &'d StructSpelling)>,
}

impl<'d> Linker<'d> {
    fn bundles(&self) -> impl Iterator<Item = &'d Bundle> + use<'d> {
        self.carried.into_iter().chain(self.definitions.bundles())
    }

    fn place_of(&mut self, name: &str) -> Option<usize> {
        if let Some(place) = self.place.get(name) {
            return Some(*place);
        }
        let spelled = self.bundles().find_map(|bundle| bundle.types.get(name))?;
        let place = self.found.len();
        self.place.insert(name.to_owned(), place);
        self.found.push((name.to_owned(), spelled));
        Some(place)
    }

    fn kind(&mut self, spelled: &TypeSpelling, count: Count) -> (Kind, Count) {
        let (mut spelled, mut count) = (spelled.clone(), count);
        for _ in 0..MAX_ALIASES {
            let names = match spelled {
                TypeSpelling::Number(number) => return (Kind::Number(number), count),
                TypeSpelling::Text => return (Kind::Text, count),
                TypeSpelling::Time => return (Kind::Time, count),
                TypeSpelling::Unsupported(what) => return (Kind::Unsupported(what), Count::One),
                TypeSpelling::Named(names) => names,
            };
            if let Some(place) = names.iter().find_map(|name| self.place_of(name)) {
                return (Kind::Nested(place), count);
            }
            let alias = names
                .iter()
                .find_map(|name| self.bundles().find_map(|bundle| bundle.aliases.get(name)));
            let Some(alias) = alias else {
                let name = names.last().map(String::as_str).unwrap_or_default();
                return (
                    Kind::Unsupported(format!("there is no definition of {name}")),
                    Count::One,
                );
            };
            (spelled, count) = match (count, alias.count) {
                (Count::One, inner) => (alias.spelled.clone(), inner),
                (outer, Count::One) => (alias.spelled.clone(), outer),
                _ => (idl::arrays_of_arrays(), Count::One),
            };
        }
        let what = format!("more than {MAX_ALIASES} names for one type");
        (Kind::Unsupported(what), Count::One)
    }
}
