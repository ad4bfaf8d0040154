//! Definitions of message types: which fields, in which order, of which sizes.
//!
//! Owns the model and the messages about what a definition leaves open. Must not know the bytes of messages.

mod idl;
mod layout;
mod library;
mod link;
mod msg;
mod standard;
#[cfg(test)]
mod tests;
mod tokens;

use std::collections::BTreeMap;

pub use layout::Layout;
pub use library::Definitions;
pub use link::{Field, Kind, Schema, Struct};

/// Longest definition that is read, bytes. The largest types that are published have some 100 KB with all they use.
pub const MAX_DEFINITION: usize = 1 << 20;

/// How often a field occurs in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// Once.
    One,
    /// A fixed number of times.
    Fixed(u32),
    /// As often as the length before it states.
    Sequence,
}

/// A number of a message by its form; truth values, bytes and characters are unsigned numbers of one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// Unsigned, with its size in bytes.
    Unsigned(u8),
    /// Signed, with its size in bytes.
    Signed(u8),
    /// IEEE 754, with its size in bytes.
    Float(u8),
}

impl Number {
    /// Size in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::Unsigned(size) | Self::Signed(size) | Self::Float(size) => usize::from(size),
        }
    }
}

/// A type as spelled in a definition, before its name is looked up.
#[derive(Clone, Debug, PartialEq, Eq)]
enum TypeSpelling {
    Number(Number),
    Text,
    /// `time` and `duration` of ROS 1.
    Time,
    /// Another type: the names it may have, the likeliest first, each as `package/Type`.
    Named(Vec<String>),
    /// What cannot be read: the reason.
    Unsupported(String),
}

/// A field as spelled.
#[derive(Clone, Debug, PartialEq, Eq)]
struct FieldSpelling {
    name: String,
    spelled: TypeSpelling,
    count: Count,
}

/// A type as spelled: its fields up to the first place that was not understood.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct StructSpelling {
    fields: Vec<FieldSpelling>,
    /// What was not understood, with its line.
    fault: Option<String>,
}

/// Another name for a type, or for an array of it (`typedef` of IDL).
#[derive(Clone, Debug, PartialEq, Eq)]
struct Alias {
    spelled: TypeSpelling,
    count: Count,
}

/// The types of one text, by name (`package/Type`).
#[derive(Clone, Debug, Default)]
pub struct Bundle {
    types: BTreeMap<String, StructSpelling>,
    aliases: BTreeMap<String, Alias>,
}

/// What a recording says about a type: its definition, or why there is none that can be used.
#[derive(Clone, Debug)]
pub enum TypeDefinition {
    /// Nothing.
    Nothing,
    /// The type and what it is made of.
    Types(Bundle),
    /// Something that cannot be used: the reason.
    Unread(String),
}

impl TypeDefinition {
    /// Reads the definition of the type `name` as stored in a recording.
    pub fn read(name: &str, schema: &[u8], encoding: &str) -> Self {
        if schema.iter().all(u8::is_ascii_whitespace) {
            return Self::Nothing;
        }
        if schema.len() > MAX_DEFINITION {
            let len = schema.len();
            return Self::Unread(format!(
                "its definition of {len} bytes is too long; at most {MAX_DEFINITION} are read"
            ));
        }
        let Ok(text) = std::str::from_utf8(schema) else {
            return Self::Unread("its definition is not UTF-8".to_owned());
        };
        match encoding {
            "ros2msg" | "ros1msg" => Self::Types(msg::bundle(name, text)),
            "ros2idl" | "omgidl" => {
                let (bundle, fault) = idl::bundle(text);
                if bundle.types.contains_key(&plain_name(name)) {
                    return Self::Types(bundle);
                }
                Self::Unread(match fault {
                    Some(fault) => format!("its definition is not understood: {fault}"),
                    None => "its definition does not contain the type itself".to_owned(),
                })
            }
            "" => Self::Unread("definitions in an unnamed encoding are not read".to_owned()),
            other => Self::Unread(format!("definitions in {other} are not read")),
        }
    }
}

/// The name of a type in one spelling: `package/Type` for `package/msg/Type`, `package::msg::Type` and the mangled
/// `package::msg::dds_::Type_` of DDS.
pub fn plain_name(name: &str) -> String {
    let name = name.trim();
    let mangled = name.contains("::dds_::");
    let mut parts: Vec<&str> = name.split("::").flat_map(|part| part.split('/')).collect();
    parts.retain(|part| !(part.is_empty() || mangled && *part == "dds_"));
    if parts.len() >= 3 && parts.get(parts.len() - 2) == Some(&"msg") {
        parts.remove(parts.len() - 2);
    }
    if let Some(last) = parts.last_mut().filter(|_| mangled) {
        *last = last.strip_suffix('_').unwrap_or(last);
    }
    parts.join("/")
}
