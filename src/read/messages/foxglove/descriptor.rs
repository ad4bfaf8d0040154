//! Finds the numbers of the wanted fields in a type's descriptor.
//!
//! Of `google.protobuf.FileDescriptorSet` only names, numbers and types are decoded: a hostile one stays within some
//! forty times its size. Source: `google/protobuf/descriptor.proto`.

use prost::Message as _;

use super::wanted::FieldSelection;
use crate::read::messages::format::Format;

/// Bound on a descriptor, bytes; the largest of Foxglove's has some ten thousand.
const MAX_DESCRIPTOR: usize = 2 << 20;

/// The wanted fields of a type.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) fields: Vec<Field>,
}

/// One wanted field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field {
    pub(super) number: u32,
    pub(super) name: &'static str,
    pub(super) is_repeated: bool,
    pub(super) holds: FieldType,
}

/// The type of a field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum FieldType {
    Double,
    Float,
    /// `int32`, `int64`, `uint32`, `uint64`.
    Varint,
    /// `sint32`, `sint64`.
    Zigzag,
    Fixed64,
    Fixed32,
    Sfixed64,
    Sfixed32,
    Text,
    Message(Layout),
}

#[derive(Clone, PartialEq, prost::Message)]
struct Set {
    #[prost(message, repeated, tag = "1")]
    files: Vec<File>,
}

#[derive(Clone, PartialEq, prost::Message)]
struct File {
    #[prost(string, tag = "2")]
    package: String,
    #[prost(message, repeated, tag = "4")]
    types: Vec<Type>,
}

#[derive(Clone, PartialEq, prost::Message)]
struct Type {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(message, repeated, tag = "2")]
    fields: Vec<FieldProto>,
    #[prost(message, repeated, tag = "3")]
    nested: Vec<Type>,
}

#[derive(Clone, PartialEq, prost::Message)]
struct FieldProto {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(int32, tag = "3")]
    number: i32,
    #[prost(int32, tag = "4")]
    label: i32,
    #[prost(int32, tag = "5")]
    kind: i32,
    #[prost(string, tag = "6")]
    type_name: String,
}

/// `LABEL_REPEATED`.
const REPEATED: i32 = 3;

/// The layout of a channel's type, or why its descriptor does not contain one.
pub(super) fn layout(format: &Format<'_>, wanted: &FieldSelection) -> Result<Layout, String> {
    let (name, bytes) = (format.message_type, format.schema);
    if bytes.is_empty() {
        return Err(format!("the recording holds no descriptor of `{name}`"));
    }
    if format.schema_encoding != "protobuf" {
        let encoding = format.schema_encoding;
        return Err(format!("definitions of protobuf messages in `{encoding}` are not read"));
    }
    if bytes.len() > MAX_DESCRIPTOR {
        let (length, most) = (bytes.len(), MAX_DESCRIPTOR);
        return Err(format!(
            "the descriptor of `{name}` has {length} bytes; at most {most} are read"
        ));
    }
    let set = Set::decode(bytes).map_err(|error| format!("the descriptor of `{name}` cannot be decoded: {error}"))?;
    let found = find(&set, name).ok_or_else(|| format!("the descriptor of `{name}` does not contain that type"))?;
    Ok(of(&set, found, wanted))
}

/// No deeper than `wanted`, even if types refer to each other, and each wanted field once.
fn of(set: &Set, declared: &Type, wanted: &FieldSelection) -> Layout {
    let field = |(name, inside): &(&'static str, &'static FieldSelection)| {
        let field = declared.fields.iter().find(|field| field.name == *name)?;
        let holds = match field.kind {
            1 => FieldType::Double,
            2 => FieldType::Float,
            3 | 4 | 5 | 13 => FieldType::Varint,
            6 => FieldType::Fixed64,
            7 => FieldType::Fixed32,
            9 => FieldType::Text,
            11 if !inside.is_plain() => FieldType::Message(of(set, find(set, &field.type_name)?, inside)),
            15 => FieldType::Sfixed32,
            16 => FieldType::Sfixed64,
            17 | 18 => FieldType::Zigzag,
            _ => return None,
        };
        Some(Field {
            number: u32::try_from(field.number).ok()?,
            name,
            is_repeated: field.label == REPEATED,
            holds,
        })
    };
    Layout {
        fields: wanted.0.iter().filter_map(field).collect(),
    }
}

/// A type by its full name, with or without the leading dot.
fn find<'s>(set: &'s Set, name: &str) -> Option<&'s Type> {
    let name = name.strip_prefix('.').unwrap_or(name);
    set.files.iter().find_map(|file| {
        let mut rest = match file.package.as_str() {
            "" => name,
            package => name.strip_prefix(package)?.strip_prefix('.')?,
        };
        let mut types = &file.types;
        loop {
            if let Some(found) = types.iter().find(|one| one.name == rest) {
                return Some(found);
            }
            let (outer, inner) = rest.split_once('.')?;
            types = &types.iter().find(|one| one.name == outer)?.nested;
            rest = inner;
        }
    })
}
