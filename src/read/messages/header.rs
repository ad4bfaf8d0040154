//! `std_msgs/msg/Header`, and which types begin with one.
//!
//! Source: `std_msgs/msg/Header.msg`, `builtin_interfaces/msg/Time.msg` (common_interfaces, rcl_interfaces).

use std::borrow::Cow;

use super::{Cdr, DecodeError};

/// The header of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header<'a> {
    /// `stamp`, nanoseconds of whatever clock the sender used.
    pub stamp_ns: i64,
    /// `frame_id` as spelled.
    pub frame_id: Cow<'a, str>,
}

impl<'a> Header<'a> {
    /// Reads a header at the cursor.
    pub fn read(cdr: &mut Cdr<'a>) -> Result<Self, DecodeError> {
        let seconds = cdr.i32()?;
        let nanoseconds = cdr.u32()?;
        Ok(Self {
            stamp_ns: i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds),
            frame_id: cdr.name()?.into(),
        })
    }

    /// Reads the header of a message whose type begins with one.
    pub fn of(message: &'a [u8]) -> Result<Self, DecodeError> {
        Self::read(&mut Cdr::new(message)?)
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
        let header = Header::of(&message).unwrap();
        assert_eq!((header.stamp_ns, header.frame_id.as_ref()), (0, ""));
    }
}
