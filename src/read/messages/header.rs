//! `std_msgs/msg/Header`, and which types begin with one.
//!
//! Source: `std_msgs/msg/Header.msg`, `builtin_interfaces/msg/Time.msg` (common_interfaces, rcl_interfaces);
//! `std_msgs/Header.msg` (std_msgs of ROS 1).

use std::borrow::Cow;

use super::{Cursor, DecodeError, Wire};

/// The header of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header<'a> {
    /// `stamp`, nanoseconds of whatever clock the sender used.
    pub stamp_ns: i64,
    /// `frame_id` as spelled.
    pub frame_id: Cow<'a, str>,
}

impl<'a> Header<'a> {
    /// Reads a header at the cursor. In ROS 1 it begins with a sequence number.
    pub fn read(cursor: &mut Cursor<'a>) -> Result<Self, DecodeError> {
        Self::read_as(cursor, cursor.wire() == Wire::Ros1)
    }

    /// Reads a header at the cursor, with or without a sequence number in front.
    pub fn read_as(cursor: &mut Cursor<'a>, has_seq: bool) -> Result<Self, DecodeError> {
        if has_seq {
            cursor.u32()?;
        }
        Ok(Self {
            stamp_ns: cursor.time()?,
            frame_id: cursor.name()?.into(),
        })
    }
}

/// Whether the first field of a type is a `std_msgs/msg/Header`, by its definition in the `ros2msg` encoding: the
/// type's own text, then a line of `=` and `MSG: package/Type` before the text of every type it uses.
pub fn comes_first(schema_text: &str) -> bool {
    let mut lines = schema_text.lines();
    let Some(field_type) = lines
        .by_ref()
        .take_while(|line| !is_separator(line))
        .find_map(field_type)
    else {
        return false;
    };
    match field_type {
        "std_msgs/Header" | "std_msgs/msg/Header" => true,
        // A bare name means the type's own package, unless that has none: then it is the old short form.
        "Header" => !lines.any(|line| {
            line.trim()
                .strip_prefix("MSG:")
                .map(str::trim)
                .is_some_and(|name| name.ends_with("/Header") && !name.starts_with("std_msgs/"))
        }),
        _ => false,
    }
}

fn is_separator(line: &str) -> bool {
    line.starts_with("===")
}

/// The type of the field a line declares; `None` for blank lines, comments and constants (`type NAME = value`).
fn field_type(line: &str) -> Option<&str> {
    let line = line.split('#').next().unwrap_or_default().trim();
    let (field_type, rest) = line.split_once(char::is_whitespace)?;
    let after_name = rest
        .trim_start()
        .trim_start_matches(|c: char| c.is_ascii_alphanumeric() || c == '_');
    (!after_name.trim_start().starts_with('=')).then_some(field_type)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_is_seen_only_as_the_first_field() {
        assert!(comes_first("std_msgs/Header header\nfloat64 x\n"));
        assert!(comes_first("std_msgs/msg/Header h"));
        assert!(comes_first("Header header"));
        assert!(comes_first(
            "# comment\n\n  uint8 A=1\nuint8 B = 2 # two\nstring C=\"std_msgs/Header\"\n  std_msgs/Header   header # here\n"
        ));
        assert!(!comes_first("float64 x\nstd_msgs/Header header\n"));
        assert!(!comes_first("std_msgs/Header[] headers\n"));
        assert!(!comes_first("std_msgs/Header[2] headers\n"));
        assert!(!comes_first("# std_msgs/Header header\nuint8 x"));
        assert!(!comes_first("string<=10 name \"a=b\"\nstd_msgs/Header header\n"));
        assert!(!comes_first(""));
    }

    #[test]
    fn fields_of_types_used_do_not_count() {
        let empty = format!(
            "uint8 A=1\n{}\nMSG: std_msgs/Header\nstd_msgs/Header h\n",
            "=".repeat(80)
        );
        assert!(!comes_first(&empty));
    }

    #[test]
    fn a_bare_header_of_another_package_is_another_type() {
        let rule = "=".repeat(80);
        assert!(!comes_first(&format!(
            "Header header\n{rule}\nMSG: acme_msgs/Header\nint64 t\n"
        )));
        assert!(comes_first(&format!(
            "Header header\n{rule}\nMSG: std_msgs/Header\nstring frame_id\n"
        )));
    }

    #[test]
    fn stamps_before_1970_and_long_nanoseconds_are_kept_as_numbers() {
        let message = [0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0xca, 0x9a, 0x3b, 1, 0, 0, 0, 0];
        let header = Header::read(&mut Cursor::cdr(&message).unwrap()).unwrap();
        assert_eq!((header.stamp_ns, header.frame_id.as_ref()), (0, ""));
    }
}
