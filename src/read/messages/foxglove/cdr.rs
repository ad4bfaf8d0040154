//! `foxglove_msgs` over CDR: the same types as ROS 2 packages them.
//!
//! Source: `foxglove_msgs/msg/*.msg` (foxglove/foxglove-sdk, ros/src/foxglove_msgs).

use super::wanted::Kind;
use crate::read::messages::content::{Body, Content, LaserScan, Pose};
use crate::read::messages::format::Format;
use crate::read::messages::header::Header;
use crate::read::messages::tf::Transform;
use crate::read::messages::{Cursor, DecodeError};

/// Whether a type is read here: transforms by their published layout, others by a definition that begins with a time and
/// a frame.
pub(super) fn is_read(format: &Format<'_>, kind: Kind) -> bool {
    let is_ours = format.message_type.starts_with("foxglove_msgs/");
    let is_transform = matches!(kind, Kind::Transform | Kind::Transforms);
    is_ours
        && (is_transform || kind != Kind::LaserScan && begins_with_frame(format, &[]) || is_laser_scan(format, kind))
}

/// Whether it is a scan with the fields that are published.
fn is_laser_scan(format: &Format<'_>, kind: Kind) -> bool {
    let fields: [(&[&str], &str); 4] = [
        (&["geometry_msgs/Pose", "geometry_msgs/msg/Pose"], "pose"),
        (&["float64"], "start_angle"),
        (&["float64"], "end_angle"),
        (&["float64[]"], "ranges"),
    ];
    kind == Kind::LaserScan && begins_with_frame(format, &fields)
}

/// Whether the first fields are `builtin_interfaces/Time timestamp`, `string frame_id` and these.
fn begins_with_frame(format: &Format<'_>, further: &[(&[&str], &str)]) -> bool {
    let text = std::str::from_utf8(format.schema).unwrap_or_default();
    let mut fields = text
        .lines()
        .take_while(|line| !line.starts_with("==="))
        .map(|line| line.split('#').next().unwrap_or_default().trim())
        .filter(|line| !line.is_empty() && !line.contains('='));
    let mut is = |types: &[&str], name: &str| {
        let mut words = fields.next().unwrap_or_default().split_whitespace();
        words.next().is_some_and(|word| types.contains(&word)) && words.next() == Some(name)
    };
    format.schema_encoding == "ros2msg"
        && is(&["builtin_interfaces/Time", "builtin_interfaces/msg/Time"], "timestamp")
        && is(&["string"], "frame_id")
        && further.iter().all(|(types, name)| is(types, name))
}

/// Reads one message.
pub(super) fn decode(kind: Kind, message: &[u8]) -> Result<Content<'_>, DecodeError> {
    let mut cdr = Cursor::cdr(message)?;
    let count = match kind {
        Kind::Transform => 1,
        Kind::Transforms => cdr.u32()?,
        Kind::LaserScan => {
            let header = Header::read(&mut cdr)?;
            let body = Body::LaserScan(Box::new(laser_scan(&mut cdr)?));
            return Ok(Content::new(Some(header), body));
        }
        _ => {
            return Ok(Content::new(Some(Header::read(&mut cdr)?), Body::Nothing));
        }
    };
    // No memory is reserved for the number that a message claims.
    let mut transforms = Vec::new();
    for _ in 0..count {
        // A time and a name come first, as in a header.
        let parent = Header::read(&mut cdr)?;
        transforms.push(Transform {
            stamp_ns: parent.stamp_ns,
            parent: parent.frame_id,
            child: cdr.name()?.into(),
            translation: cdr.f64s()?,
            rotation: cdr.f64s()?,
        });
    }
    Ok(Content::new(None, Body::Transforms(transforms)))
}

/// Reads the rest of a `foxglove_msgs/LaserScan` after its frame, as far as its ranges.
fn laser_scan(cdr: &mut Cursor<'_>) -> Result<LaserScan, DecodeError> {
    let pose = Pose {
        position: cdr.f64s()?,
        orientation: cdr.f64s()?,
        covariance: None,
    };
    let [start, end] = cdr.f64s()?;
    let count = cdr.u32()?;
    // No memory is reserved for the number that a message claims.
    let ranges = (0..count).map(|_| cdr.f64()).collect::<Result<_, DecodeError>>()?;
    Ok(LaserScan::spread(start, end, ranges, Some(pose)))
}
