//! Plain fields with unambiguous names, in types that no package publishes.
//!
//! Owns those names. What is found by them is a guess: it may be a target, or where another vehicle is.

use std::sync::Arc;

use super::content::{Body, Fix, Imu};
use super::definition::{Count, Field, Kind, Number, Schema};
use super::words::words;
use super::{Cursor, DecodeError, Wire};

const LATITUDE: &[&str] = &["latitude", "lat"];
const LONGITUDE: &[&str] = &["longitude", "lon", "lng", "long"];
const ALTITUDE: &[&str] = &["altitude", "alt"];
/// Ending of a name if a separate field has the direction: then the numbers are `ddmm.mmm` of NMEA 0183.
const DIRECTION: &[&str] = &["dir", "direction", "hemisphere", "hemi", "ns", "ew", "indicator"];
/// The fields of an `Imu` with the type each has; `None` for a matrix.
const INERTIAL: [(&str, Option<&str>, usize); 6] = [
    ("orientation", Some("geometry_msgs/Quaternion"), 4),
    ("orientation_covariance", None, 9),
    ("angular_velocity", Some("geometry_msgs/Vector3"), 3),
    ("angular_velocity_covariance", None, 9),
    ("linear_acceleration", Some("geometry_msgs/Vector3"), 3),
    ("linear_acceleration_covariance", None, 9),
];
const INERTIAL_NUMBERS: usize = 37;

/// What several fields of a type mean together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Guess {
    is_imu: bool,
    /// The names of the fields.
    pub(super) field: Arc<str>,
    /// Each field by its place in the type, in order.
    pub(super) slots: Vec<(usize, Slot)>,
}

/// Where the numbers of a field belong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot {
    at: usize,
    count: usize,
    form: Form,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    F64,
    F32,
    /// Whole numbers of 1e-7.
    E7,
}

/// The numbers of a guess while a message is read.
pub(super) struct Values {
    is_imu: bool,
    numbers: [f64; INERTIAL_NUMBERS],
}

/// What the fields of one type mean, named with `prefix`; the types of the fields are in `schema`.
pub(super) fn of(schema: &Schema, fields: &[Field], prefix: &str, wire: Wire) -> Vec<Guess> {
    [fix(fields), imu(schema, fields, wire)]
        .into_iter()
        .zip([false, true])
        .filter_map(|(slots, is_imu)| {
            let mut slots = slots?;
            let name = |(at, _): &(usize, Slot)| fields.get(*at).map(|field| format!("{prefix}{}", field.name));
            let field = slots.iter().filter_map(name).collect::<Vec<_>>().join(", ").into();
            slots.sort_by_key(|(at, _)| *at);
            Some(Guess { is_imu, field, slots })
        })
        .collect()
}

/// Latitude, longitude and perhaps altitude, each once.
fn fix(fields: &[Field]) -> Option<Vec<(usize, Slot)>> {
    let mut slots = Vec::new();
    for (at, wanted) in [LATITUDE, LONGITUDE, ALTITUDE].into_iter().enumerate() {
        let mut found = None;
        for (place, field) in fields.iter().enumerate() {
            let words = words(&field.name);
            let Some((first, rest)) = words.split_first() else {
                continue;
            };
            if !wanted.contains(&first.as_str()) {
                continue;
            }
            if rest.iter().any(|word| DIRECTION.contains(&word.as_str())) {
                return None;
            }
            let Some(form) = form(field, rest, at == 2) else {
                continue;
            };
            if found.is_some() {
                // Two altitudes are common, above the ellipsoid and above the sea; two latitudes are not.
                found = None;
                break;
            }
            found = Some((place, Slot { at, count: 1, form }));
        }
        match found {
            Some(found) => slots.push(found),
            None if at == 2 => {}
            None => return None,
        }
    }
    Some(slots)
}

/// How a coordinate is written, if its name and its form agree.
fn form(field: &Field, unit: &[String], is_altitude: bool) -> Option<Form> {
    let unit: Vec<&str> = unit.iter().map(String::as_str).collect();
    let is_plain = match unit.as_slice() {
        [] => true,
        ["m" | "meters" | "metres"] => is_altitude,
        ["deg" | "degrees"] => !is_altitude,
        _ => false,
    };
    let is_e7 = !is_altitude && matches!(unit.as_slice(), ["e7" | "1e7"] | ["deg" | "degrees", "e7" | "1e7"]);
    match (&field.kind, field.count) {
        (Kind::Number(Number::Float(8)), Count::One) if is_plain => Some(Form::F64),
        (Kind::Number(Number::Float(4)), Count::One) if is_plain => Some(Form::F32),
        (Kind::Number(Number::Signed(4)), Count::One) if is_e7 => Some(Form::E7),
        _ => None,
    }
}

/// Orientation, angular velocity and linear acceleration as in an `Imu`, perhaps with their covariances.
fn imu(schema: &Schema, fields: &[Field], wire: Wire) -> Option<Vec<(usize, Slot)>> {
    let mut slots = Vec::new();
    let mut at = 0;
    for (name, type_name, count) in INERTIAL {
        let is_it = |field: &Field| {
            let is_type = match (&field.kind, type_name) {
                (Kind::Nested(index), Some(type_name)) => {
                    let is_named = schema.types.get(*index).is_some_and(|one| one.name == type_name);
                    field.count == Count::One && is_named && schema.is_published(*index, wire)
                }
                (Kind::Number(Number::Float(8)), None) => field.count == Count::Fixed(9),
                _ => false,
            };
            is_type && words(&field.name).join("_") == name
        };
        match fields.iter().position(is_it) {
            Some(place) => slots.push((
                place,
                Slot {
                    at,
                    count,
                    form: Form::F64,
                },
            )),
            None if type_name.is_none() => {}
            None => return None,
        }
        at += count;
    }
    Some(slots)
}

impl Guess {
    /// No numbers yet.
    pub(super) fn values(&self) -> Values {
        let mut numbers = [0.0; INERTIAL_NUMBERS];
        if let (false, [_, _, altitude, ..]) = (self.is_imu, &mut numbers) {
            *altitude = f64::NAN;
        }
        Values {
            is_imu: self.is_imu,
            numbers,
        }
    }
}

impl Values {
    /// Reads a field at the cursor.
    pub(super) fn read(&mut self, cursor: &mut Cursor<'_>, slot: Slot) -> Result<(), DecodeError> {
        for value in self.numbers.iter_mut().skip(slot.at).take(slot.count) {
            *value = match slot.form {
                Form::F64 => cursor.f64()?,
                Form::F32 => f64::from(cursor.f32()?),
                Form::E7 => f64::from(cursor.i32()?) * 1e-7,
            };
        }
        Ok(())
    }

    /// What was read.
    pub(super) fn body(self) -> Body<'static> {
        if self.is_imu {
            return Body::Imu(Box::new(Imu {
                orientation: self.part(0),
                orientation_covariance: self.part(4),
                angular_velocity: self.part(13),
                angular_velocity_covariance: self.part(16),
                linear_acceleration: self.part(25),
                linear_acceleration_covariance: self.part(28),
            }));
        }
        let [latitude, longitude, altitude] = self.part(0);
        Body::Fix(Fix {
            status: 0,
            latitude,
            longitude,
            altitude,
            covariance: [0.0; 9],
            velocity: None,
        })
    }

    fn part<const N: usize>(&self, at: usize) -> [f64; N] {
        let rest = self.numbers.get(at..).and_then(|rest| rest.first_chunk());
        rest.copied().unwrap_or([f64::NAN; N])
    }
}
