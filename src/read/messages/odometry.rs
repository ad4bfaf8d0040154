//! `nav_msgs/msg/Odometry`: the frames it names.
//!
//! Source: `nav_msgs/msg/Odometry.msg` (common_interfaces): a header, then `string child_frame_id`.

use super::header::Header;
use super::{Cdr, DecodeError};

/// Header and `child_frame_id` of an odometry message.
pub fn frames(message: &[u8]) -> Result<(Header<'_>, &str), DecodeError> {
    let mut cdr = Cdr::new(message)?;
    let header = Header::read(&mut cdr)?;
    Ok((header, cdr.name()?))
}
