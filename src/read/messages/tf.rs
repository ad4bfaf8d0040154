//! `tf2_msgs/msg/TFMessage`, `tf/tfMessage`: transforms, one after the other.
//!
//! Source: `tf2_msgs/msg/TFMessage.msg`, `geometry_msgs/msg/TransformStamped.msg` (geometry2, common_interfaces).

use std::borrow::Cow;

use super::header::Header;
use super::{Cursor, DecodeError};

/// One `geometry_msgs/msg/TransformStamped`: `parent_from_child` with the numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Transform<'a> {
    /// `header.stamp`, nanoseconds.
    pub stamp_ns: i64,
    /// `header.frame_id` as spelled.
    pub parent: Cow<'a, str>,
    /// `child_frame_id` as spelled.
    pub child: Cow<'a, str>,
    /// `[tx, ty, tz]`, metres.
    pub translation: [f64; 3],
    /// `[x, y, z, w]`, not normalised.
    pub rotation: [f64; 4],
}

/// The transforms of a message, in order. No memory is reserved for the number that a message claims; the first error
/// ends the sequence.
#[derive(Clone, Debug)]
pub struct Transforms<'a> {
    cursor: Cursor<'a>,
    left: u32,
}

/// Reads a TF message, from its begin.
pub fn transforms(mut cursor: Cursor<'_>) -> Result<Transforms<'_>, DecodeError> {
    let left = cursor.sequence()?;
    Ok(Transforms { cursor, left })
}

impl<'a> Iterator for Transforms<'a> {
    type Item = Result<Transform<'a>, DecodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        let transform = read(&mut self.cursor);
        if transform.is_err() {
            self.left = 0;
        }
        Some(transform)
    }
}

/// Reads one transform at the cursor.
pub fn read<'a>(cursor: &mut Cursor<'a>) -> Result<Transform<'a>, DecodeError> {
    let header = Header::read(cursor)?;
    Ok(Transform {
        stamp_ns: header.stamp_ns,
        parent: header.frame_id,
        child: cursor.name()?.into(),
        translation: cursor.f64s()?,
        rotation: cursor.f64s()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lying_count_ends_with_one_error() {
        let mut message = vec![0, 1, 0, 0];
        message.extend(u32::MAX.to_le_bytes());
        let all: Vec<_> = transforms(Cursor::cdr(&message).unwrap()).unwrap().collect();
        assert_eq!(all.len(), 1);
        assert!(all[0].as_ref().unwrap_err().0.contains("run past the end"));
    }
}
