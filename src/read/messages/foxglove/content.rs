//! Converts wanted values to content.

use std::borrow::Cow;
use std::collections::BTreeSet;

use super::time;
use super::value::{Object, Value};
use super::wanted::{Kind, RANGES};
use crate::read::messages::content::{Body, Content, Fix, LaserScan, Odometry, Pose};
use crate::read::messages::header::Header;
use crate::read::messages::tf::Transform;
use crate::read::messages::{DecodeError, MAX_NAME};

/// The content of a message of a kind.
pub(super) fn of(kind: Kind, value: Value<'_>) -> Result<Content<'_>, DecodeError> {
    let nothing = |header| Content::new(header, Body::Nothing);
    let mut object = match value {
        Value::Object(object) => object,
        _ if kind == Kind::Unknown => return Ok(nothing(None)),
        other => return Err(DecodeError(format!("the message is {}, not an object", other.noun()))),
    };
    let object = &mut object;
    Ok(match kind {
        Kind::Transform => Content::new(None, Body::Transforms(vec![transform(object)?])),
        Kind::Transforms => {
            let transforms = elements(object, "transforms")?.map(|element| transform(&mut element?));
            Content::new(None, Body::Transforms(transforms.collect::<Result<_, _>>()?))
        }
        Kind::Fix => located(object)?,
        Kind::Fixes => match elements(object, "fixes")?.next() {
            Some(first) => located(&mut first?)?,
            None => nothing(None),
        },
        Kind::Pose => Content::new(None, Body::Pose(Box::new(pose(object)?))),
        Kind::PoseInFrame => {
            let body = Body::Pose(Box::new(pose(&mut nested(object, "pose")?)?));
            Content::new(header(object)?, body)
        }
        Kind::Odometry => {
            let body = Body::Odometry(Box::new(odometry(object)?));
            Content::new(header(object)?, body)
        }
        Kind::Scene => scene(object)?,
        Kind::LaserScan => {
            let body = Body::LaserScan(Box::new(laser_scan(object)?));
            Content::new(header(object)?, body)
        }
        Kind::Header => nothing(header(object)?),
        Kind::Unknown => nothing(header(object).ok().flatten()),
    })
}

/// The header of a message, where it has one: `timestamp` and `frame_id`, or the same inside `header`.
fn header<'m>(object: &mut Object<'m>) -> Result<Option<Header<'m>>, DecodeError> {
    if let (Some(stamp), true) = (object.get("timestamp"), object.get("frame_id").is_some()) {
        let stamp_ns = stamp_of("timestamp", stamp)?;
        let frame_id = name(object, "frame_id")?;
        return Ok(Some(Header { stamp_ns, frame_id }));
    }
    let Some(Value::Object(mut inner)) = object.take("header") else {
        return Ok(None);
    };
    let stamp = inner.get("stamp").or_else(|| inner.get("timestamp"));
    let (Some(stamp), true) = (stamp, inner.get("frame_id").is_some()) else {
        return Ok(None);
    };
    let stamp_ns = stamp_of("header.stamp", stamp)?;
    let frame_id = name(&mut inner, "frame_id")?;
    Ok(Some(Header { stamp_ns, frame_id }))
}

/// A transform as Foxglove writes it, or nested as ROS does.
fn transform<'m>(object: &mut Object<'m>) -> Result<Transform<'m>, DecodeError> {
    let child = name(object, "child_frame_id")?;
    let (stamp_ns, parent, mut numbers) = if object.get("parent_frame_id").is_some() {
        let stamp = object.get("timestamp").ok_or_else(|| lacks("timestamp"))?;
        let stamp_ns = stamp_of("timestamp", stamp)?;
        (stamp_ns, name(object, "parent_frame_id")?, std::mem::take(object))
    } else {
        let Some(Header { stamp_ns, frame_id }) = header(object)? else {
            return Err(lacks("parent_frame_id"));
        };
        (stamp_ns, frame_id, nested(object, "transform")?)
    };
    Ok(Transform {
        stamp_ns,
        parent,
        child,
        translation: vector(&mut numbers, "translation")?,
        rotation: quaternion(&mut numbers, "rotation")?,
    })
}

fn located<'m>(object: &mut Object<'m>) -> Result<Content<'m>, DecodeError> {
    let fix = Fix {
        status: 0,
        latitude: number(object, "latitude")?,
        longitude: number(object, "longitude")?,
        altitude: number(object, "altitude")?,
        covariance: matrix(object, "position_covariance")?,
        velocity: None,
    };
    Ok(Content::new(header(object)?, Body::Fix(fix)))
}

fn odometry<'m>(object: &mut Object<'m>) -> Result<Odometry<'m>, DecodeError> {
    let Pose {
        position, orientation, ..
    } = pose(&mut nested(object, "pose")?)?;
    Ok(Odometry {
        child: name(object, "body_frame_id")?,
        position,
        orientation,
        pose_covariance: matrix(object, "pose_covariance")?,
        linear: vector(object, "linear_velocity")?,
        angular: vector(object, "angular_velocity")?,
        twist_covariance: matrix(object, "velocity_covariance")?,
    })
}

/// A scan of a plane. A missing pose is the identity: JSON may omit it.
fn laser_scan(object: &mut Object<'_>) -> Result<LaserScan, DecodeError> {
    let ranges = match object.take(RANGES) {
        Some(Value::List(list)) => list.iter().map(as_number).collect::<Option<Vec<f64>>>(),
        found => return Err(not_a(RANGES, "a list", found.as_ref())),
    };
    let ranges = ranges.ok_or_else(|| DecodeError(format!("`{RANGES}` has values that are not numbers")))?;
    let pose = match object.take("pose") {
        Some(Value::Object(mut inner)) => Some(pose(&mut inner)?),
        None | Some(Value::Null) => None,
        found => return Err(not_a("pose", "an object", found.as_ref())),
    };
    let (start, end) = (number(object, "start_angle")?, number(object, "end_angle")?);
    Ok(LaserScan::spread(start, end, ranges, pose))
}

/// The frames of a scene's entities. The header is that of the first entity; the frames of the others are listed separately,
/// each once.
fn scene<'m>(object: &mut Object<'m>) -> Result<Content<'m>, DecodeError> {
    let mut first = None;
    let mut others = BTreeSet::new();
    for entity in elements(object, "entities")? {
        match (header(&mut entity?)?, &first) {
            (Some(header), None) => first = Some(header),
            (Some(header), Some(known)) if header.frame_id != known.frame_id => {
                others.insert(header.frame_id);
            }
            _ => {}
        }
    }
    let body = if others.is_empty() {
        Body::Nothing
    } else {
        Body::Frames(others.into_iter().collect())
    };
    Ok(Content::new(first, body))
}

fn pose(object: &mut Object<'_>) -> Result<Pose, DecodeError> {
    Ok(Pose {
        position: vector(object, "position")?,
        orientation: quaternion(object, "orientation")?,
        covariance: None,
    })
}

/// The messages of a list.
fn elements<'m>(
    object: &mut Object<'m>,
    field: &'static str,
) -> Result<impl Iterator<Item = Result<Object<'m>, DecodeError>>, DecodeError> {
    let list = match object.take(field) {
        Some(Value::List(list)) => list,
        found => return Err(not_a(field, "a list", found.as_ref())),
    };
    Ok(list.into_iter().map(move |element| match element {
        Value::Object(object) => Ok(object),
        other => Err(DecodeError(format!(
            "an element of `{field}` is {}, not an object",
            other.noun()
        ))),
    }))
}

fn nested<'m>(object: &mut Object<'m>, field: &str) -> Result<Object<'m>, DecodeError> {
    match object.take(field) {
        Some(Value::Object(inner)) => Ok(inner),
        found => Err(not_a(field, "an object", found.as_ref())),
    }
}

/// A frame name.
fn name<'m>(object: &mut Object<'m>, field: &str) -> Result<Cow<'m, str>, DecodeError> {
    match object.take(field) {
        Some(Value::Text(text)) if text.len() <= MAX_NAME => Ok(text),
        Some(Value::Text(text)) => {
            let length = text.len();
            Err(DecodeError(format!("the frame name `{field}` has {length} bytes")))
        }
        found => Err(not_a(field, "a text", found.as_ref())),
    }
}

fn vector(object: &mut Object<'_>, field: &str) -> Result<[f64; 3], DecodeError> {
    let inner = nested(object, field)?;
    Ok([number(&inner, "x")?, number(&inner, "y")?, number(&inner, "z")?])
}

fn quaternion(object: &mut Object<'_>, field: &str) -> Result<[f64; 4], DecodeError> {
    let inner = nested(object, field)?;
    Ok([
        number(&inner, "x")?,
        number(&inner, "y")?,
        number(&inner, "z")?,
        number(&inner, "w")?,
    ])
}

fn number(object: &Object<'_>, field: &str) -> Result<f64, DecodeError> {
    let found = object.get(field);
    found.and_then(as_number).ok_or_else(|| not_a(field, "a number", found))
}

/// JSON cannot express numbers that are not finite: JavaScript writes `null`, Protocol Buffers write text.
fn as_number(value: &Value<'_>) -> Option<f64> {
    match value {
        Value::Number(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        Value::Null => Some(f64::NAN),
        Value::Text(text) => match text.as_ref() {
            "NaN" => Some(f64::NAN),
            "Infinity" => Some(f64::INFINITY),
            "-Infinity" => Some(f64::NEG_INFINITY),
            digits => digits.parse().ok(),
        },
        _ => None,
    }
}

/// A matrix, row by row; zeros if it is missing or empty, which in these schemas means that it is unknown.
fn matrix<const N: usize>(object: &Object<'_>, field: &str) -> Result<[f64; N], DecodeError> {
    let list = match object.get(field) {
        None | Some(Value::Null) => return Ok([0.0; N]),
        Some(Value::List(list)) if list.is_empty() => return Ok([0.0; N]),
        Some(Value::List(list)) => list,
        found => return Err(not_a(field, "a list", found)),
    };
    let numbers: Option<Vec<f64>> = list.iter().map(as_number).collect();
    let numbers = numbers.ok_or_else(|| DecodeError(format!("`{field}` has values that are not numbers")))?;
    numbers
        .try_into()
        .map_err(|_| DecodeError(format!("`{field}` does not have {N} numbers")))
}

fn stamp_of(field: &str, value: &Value<'_>) -> Result<i64, DecodeError> {
    time::nanoseconds(value).map_err(|why| DecodeError(format!("`{field}` {why}")))
}

fn lacks(field: &str) -> DecodeError {
    DecodeError(format!("`{field}` is missing"))
}

fn not_a(field: &str, wanted: &str, found: Option<&Value<'_>>) -> DecodeError {
    match found {
        None => lacks(field),
        Some(found) => DecodeError(format!("`{field}` is {}, not {wanted}", found.noun())),
    }
}
