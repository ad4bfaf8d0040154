//! `std_msgs/msg/Header`.
//!
//! Source: `std_msgs/msg/Header.msg`, `builtin_interfaces/msg/Time.msg` (common_interfaces, rcl_interfaces);
//! `std_msgs/Header.msg` (std_msgs of ROS 1).

use std::borrow::Cow;

use super::{Cursor, DecodeError, Wire};

/// The header of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header<'a> {
    /// `stamp`, nanoseconds of the sender's clock.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_before_1970_and_long_nanoseconds_are_kept_as_numbers() {
        let message = [0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0xca, 0x9a, 0x3b, 1, 0, 0, 0, 0];
        let header = Header::read(&mut Cursor::cdr(&message).unwrap()).unwrap();
        assert_eq!((header.stamp_ns, header.frame_id.as_ref()), (0, ""));
    }
}
