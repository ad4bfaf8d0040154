//! The content of radar messages: detections, each with its position and radial speed.
//!
//! Owns the names that drivers give to the parts of a detection, and the order of the standard types' fields. What is found by
//! names only is a guess. Sources: radar_msgs (RadarScan, RadarReturn, RadarTracks, RadarTrack); ti_mmwave_rospkg (RadarScan, one
//! message a point); delphi_esr_msgs (EsrTrack: degrees, clockwise); continental_msgs of Nebula (detection lists); nuscenes2bag
//! (vx, vy); smartmicro_ros2_radars (radial_speed); reve (v_doppler_mps).

use std::sync::Arc;

use super::cloud::{Cloud, Column};
use super::definition::{Count, Field, Kind, Number, Schema, Struct};
use super::walk::Walk;
use super::words::words;
use super::{Cursor, DecodeError};

/// Detections of a message that are kept: of more, every second, third, ... one. Radars have some hundred.
pub const MAX_ECHOES: u32 = 2048;

/// Detections of one message.
#[derive(Clone, Debug, PartialEq)]
pub struct Radar {
    /// What the message is.
    pub form: Form,
    /// The names of their speeds: `doppler_velocity`; `vx, vy`.
    pub field: Arc<str>,
    /// What the speeds are.
    pub speeds: Speeds,
    /// How many there are.
    pub total: u32,
    /// Those that are kept, in order.
    pub echoes: Vec<Echo>,
}

/// The kind of message that contains the detections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `radar_msgs/RadarScan`, or a driver's own list.
    Scan,
    /// `radar_msgs/RadarTracks`: objects that a tracker made.
    Tracks,
    /// One detection a message, with its number in the scan where it has one.
    Single(Option<u64>),
    /// The points of a cloud.
    Cloud,
}

/// The meaning of a number that is named a speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Speeds {
    /// Along the line of sight, by its name.
    Radial,
    /// Named `velocity` or similar: along the line of sight, if it is a radar's.
    Plain,
    /// Components along axes.
    Components,
}

/// One detection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Echo {
    /// x, y, z in the frame of the message, metres.
    pub place: [f64; 3],
    /// Its speed along the line of sight, or its components, m/s.
    pub speed: Speed,
}

/// How fast a detection moves, as published.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// Along the line of sight.
    Radial(f64),
    /// Along x, y and z.
    Components([f64; 3]),
}

/// Along the line of sight, as their names say.
const RADIAL: &[&str] = &[
    "doppler",
    "doppler_velocity",
    "doppler_speed",
    "doppler_mps",
    "v_doppler",
    "v_doppler_mps",
    "velocity_doppler",
    "radial_velocity",
    "radial_speed",
    "radial_vel",
    "speed_radial",
    "velocity_radial",
    "vel_radial",
    "v_radial",
    "v_r",
    "vel_r",
    "vr",
    "v_rad",
    "vrel_rad",
    "f_vrel_rad",
    "range_rate",
    "track_range_rate",
];
/// Along the line of sight where they are a radar's.
const PLAIN: &[&str] = &["velocity", "vel", "speed"];
const RANGE: &[&str] = &["range", "radial_distance", "f_range", "track_range"];
const AZIMUTH: &[&str] = &["azimuth", "azimuth_angle", "az", "azi", "f_az_ang0"];
const ELEVATION: &[&str] = &["elevation", "elevation_angle", "el", "ele", "f_el_ang"];
const X: &[&str] = &["x", "pos_x", "position_x", "dist_long", "longitude_dist", "dist_x"];
const Y: &[&str] = &["y", "pos_y", "position_y", "dist_lat", "lateral_dist", "dist_y"];
const Z: &[&str] = &["z", "pos_z", "position_z"];
const VX: &[&str] = &[
    "vx",
    "v_x",
    "vel_x",
    "velocity_x",
    "vrel_long",
    "longitude_vel",
    "rel_vel_x",
];
const VY: &[&str] = &[
    "vy",
    "v_y",
    "vel_y",
    "velocity_y",
    "vrel_lat",
    "lateral_vel",
    "rel_vel_y",
];
const VZ: &[&str] = &["vz", "v_z", "vel_z", "velocity_z"];
const NUMBER: &[&str] = &["id", "point_id", "track_id", "detection_id", "esr_track_id"];
/// Fields of radars and of hardly anything else.
const OF_A_RADAR: &[&str] = &[
    "rcs",
    "snr",
    "snr_db",
    "noise",
    "noise_db",
    "power",
    "amplitude",
    "doppler_bin",
    "dyn_prop",
    "ambig_state",
    "ambiguity_flag",
    "pdh0",
    "pdh00",
    "bearing",
    "vx_comp",
];

/// Fields of radars only: a velocity next to these is not a vehicle's.
const OF_RADARS_ALONE: &[&str] = &["rcs", "snr", "doppler_bin", "dyn_prop", "ambig_state", "pdh0", "pdh00"];

/// A name in small letters, its words apart: `rangeRate` is `range_rate`.
fn plain(name: &str) -> String {
    words(name).join("_")
}

fn is_one_of(name: &str, known: &[&str]) -> bool {
    known.contains(&name)
}

/// Whether a field of this name belongs to the points of a radar.
pub fn is_of_a_radar(name: &str) -> bool {
    is_one_of(&plain(name), OF_A_RADAR)
}

/// Reads the rest of a `radar_msgs/RadarScan` after its header.
pub(super) fn scan(cursor: &mut Cursor<'_>) -> Result<Radar, DecodeError> {
    let total = cursor.sequence()?;
    let every = total.div_ceil(MAX_ECHOES).max(1);
    let mut echoes = Vec::new();
    for number in 0..total {
        let mut of = || cursor.f32().map(f64::from);
        let (range, azimuth, elevation, doppler) = (of()?, of()?, of()?, of()?);
        let _amplitude = of()?;
        if number % every == 0 {
            echoes.push(Echo {
                place: spherical(range, azimuth, elevation),
                speed: Speed::Radial(doppler),
            });
        }
    }
    Ok(radar(
        Form::Scan,
        "doppler_velocity".into(),
        Speeds::Radial,
        total,
        echoes,
    ))
}

/// Reads the rest of a `radar_msgs/RadarTracks` after its header.
pub(super) fn tracks(cursor: &mut Cursor<'_>) -> Result<Radar, DecodeError> {
    let total = cursor.sequence()?;
    let every = total.div_ceil(MAX_ECHOES).max(1);
    let mut echoes = Vec::new();
    for number in 0..total {
        cursor.skip_numbers(1, 16)?;
        let (place, velocity) = (cursor.f64s()?, cursor.f64s()?);
        // Acceleration and size; class; four covariances.
        cursor.skip_numbers(8, 6)?;
        cursor.skip_numbers(2, 1)?;
        cursor.skip_numbers(4, 24)?;
        if number % every == 0 {
            echoes.push(Echo {
                place,
                speed: Speed::Components(velocity),
            });
        }
    }
    Ok(radar(
        Form::Tracks,
        "velocity".into(),
        Speeds::Components,
        total,
        echoes,
    ))
}

fn radar(form: Form, field: Arc<str>, speeds: Speeds, total: u32, echoes: Vec<Echo>) -> Radar {
    Radar {
        form,
        field,
        speeds,
        total,
        echoes,
    }
}

/// x forward, y left, z up of a range with an azimuth from x towards y and an elevation from there up, radians.
fn spherical(range: f64, azimuth: f64, elevation: f64) -> [f64; 3] {
    let flat = range * elevation.cos();
    [flat * azimuth.cos(), flat * azimuth.sin(), range * elevation.sin()]
}

/// The columns of a cloud whose points have a speed.
#[derive(Clone, Debug)]
pub struct Columns {
    /// The names of the speeds.
    pub field: Arc<str>,
    /// What they are.
    pub speeds: Speeds,
    place: [Column; 3],
    speed: [Option<Column>; 3],
}

impl Columns {
    /// Those of a cloud; `None` if its points have no position or no speed.
    pub fn of(cloud: &Cloud<'_>) -> Option<Self> {
        let place = [cloud.column("x")?, cloud.column("y")?, cloud.column("z")?];
        let named = |known: &[&str]| {
            let mut fields = cloud.fields.iter();
            fields
                .find(|field| is_one_of(&plain(&field.name), known))
                .map(|field| &*field.name)
        };
        let one = |name: &str| Some([cloud.column(name), None, None]);
        let (field, speeds, speed): (Arc<str>, _, _) = if let Some(name) = named(RADIAL) {
            (name.into(), Speeds::Radial, one(name)?)
        } else if let (Some(x), Some(y)) = (named(VX), named(VY)) {
            let z = named(VZ).and_then(|z| cloud.column(z));
            let speed = [cloud.column(x), cloud.column(y), z];
            (format!("{x}, {y}").into(), Speeds::Components, speed)
        } else {
            let name = named(PLAIN)?;
            (name.into(), Speeds::Plain, one(name)?)
        };
        let is_known = speed[0].is_some() && (speeds != Speeds::Components || speed[1].is_some());
        is_known.then_some(Self {
            field,
            speeds,
            place,
            speed,
        })
    }

    /// The detection in these bytes of a point; `None` where they end before it.
    pub fn echo(&self, point: &[u8]) -> Option<Echo> {
        let [x, y, z] = self.place.map(|column| column.of(point));
        let [a, b, c] = self.speed.map(|column| column.map(|column| column.of(point)));
        let speed = match self.speeds {
            Speeds::Components => Speed::Components([a??, b??, c.map_or(Some(0.0), |c| c)?]),
            Speeds::Radial | Speeds::Plain => Speed::Radial(a??),
        };
        Some(Echo {
            place: [x?, y?, z?],
            speed,
        })
    }
}

/// How the fields of a detection are read one after the other: nothing beyond the last that is wanted, of a message; all of
/// it, of an element of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Detection {
    field: Arc<str>,
    speeds: Speeds,
    is_polar: bool,
    /// Multiplies angles: to radians, counter-clockwise.
    angle: Angle,
    /// The fields by their place, each with where its number belongs.
    pub(super) slots: Vec<(usize, Slot)>,
}

/// How angles are expressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Angle {
    Radians,
    Degrees,
    /// Degrees clockwise: Delphi's.
    ClockwiseDegrees,
}

/// Where a number of a detection belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot {
    at: usize,
    number: Number,
}

/// Range, azimuth and elevation, or x, y, z; then the speeds; then the number of the detection.
const NUMBERS: usize = 7;
const ID: usize = 6;

/// The numbers of a detection while it is read.
pub(super) type Numbers = [f64; NUMBERS];

impl Detection {
    /// The parts of a detection among the fields of a type; `None` if parts are missing, or if there are several of one kind.
    pub(super) fn of(one: &Struct) -> Option<Self> {
        let names: Vec<String> = one.fields.iter().map(|field| plain(&field.name)).collect();
        let is_delphi = one.name == "delphi_esr_msgs/EsrTrack";
        let is_float =
            |field: &Field| matches!(field.kind, Kind::Number(Number::Float(_))) && field.count == Count::One;
        let find = |known: &[&str], unit: &str| {
            let is_it = |(at, name): &(usize, &String)| {
                let bare = name.strip_suffix(unit).unwrap_or(name);
                is_one_of(bare, known) && one.fields.get(*at).is_some_and(is_float)
            };
            let mut found = names.iter().enumerate().filter(is_it).map(|(at, _)| at);
            let first = found.next();
            first.filter(|_| found.next().is_none())
        };
        let slot = |at: usize, to: usize| {
            let Kind::Number(number) = one.fields.get(at)?.kind else {
                return None;
            };
            Some((at, Slot { at: to, number }))
        };
        let azimuths: &[&str] = if is_delphi { &["angle", "track_angle"] } else { AZIMUTH };
        let place = [find(X, "_m"), find(Y, "_m"), find(Z, "_m")];
        let in_degrees = [find(azimuths, "_deg"), find(ELEVATION, "_deg")];
        let in_radians = [find(azimuths, "_rad"), find(ELEVATION, "_rad")];
        let is_degrees = in_radians[0].is_none() && in_degrees[0].is_some();
        let [azimuth, elevation] = if is_degrees { in_degrees } else { in_radians };
        let polar = [find(RANGE, "_m"), azimuth, elevation];
        let (is_polar, place) = match (place, polar) {
            ([Some(_), Some(_), _], _) => (false, place),
            (_, [Some(_), Some(_), _]) => (true, polar),
            _ => return None,
        };
        let radial = find(RADIAL, "_mps");
        let has_more = || names.iter().any(|name| is_one_of(name, OF_RADARS_ALONE));
        let single = find(PLAIN, "_mps").filter(|_| has_more());
        let parts = [find(VX, "_mps"), find(VY, "_mps"), find(VZ, "_mps")];
        let (speeds, speed) = match (radial, parts, single) {
            (Some(_), ..) => (Speeds::Radial, [radial, None, None]),
            (_, [Some(_), Some(_), _], _) if has_more() => (Speeds::Components, parts),
            (_, _, Some(_)) => (Speeds::Plain, [single, None, None]),
            _ => return None,
        };
        let named = speed.iter().flatten().filter_map(|at| one.fields.get(*at));
        let field = named.map(|field| field.name.as_str()).collect::<Vec<_>>().join(", ");
        let wanted = place.into_iter().chain(speed).enumerate();
        let mut slots: Vec<(usize, Slot)> = wanted.filter_map(|(to, at)| slot(at?, to)).collect();
        let is_whole = |field: &Field| {
            let is_number = matches!(field.kind, Kind::Number(Number::Signed(_) | Number::Unsigned(_)));
            is_number && field.count == Count::One && is_one_of(&plain(&field.name), NUMBER)
        };
        slots.extend(one.fields.iter().position(is_whole).and_then(|at| slot(at, ID)));
        slots.sort_by_key(|(at, _)| *at);
        Some(Self {
            field: field.into(),
            speeds,
            is_polar,
            angle: match (is_delphi, is_degrees) {
                (true, _) => Angle::ClockwiseDegrees,
                (_, true) => Angle::Degrees,
                _ => Angle::Radians,
            },
            slots,
        })
    }

    /// The name of its speed.
    pub(super) fn field(&self) -> &Arc<str> {
        &self.field
    }

    /// Reads a list of them, whose type is `one`.
    pub(super) fn list(
        &self,
        cursor: &mut Cursor<'_>,
        walk: &mut Walk<'_>,
        fields: &[Field],
    ) -> Result<Radar, DecodeError> {
        let total = cursor.sequence()?;
        let every = total.div_ceil(MAX_ECHOES).max(1);
        let mut echoes = Vec::new();
        for number in 0..total {
            let mut numbers = Self::numbers();
            for (at, field) in fields.iter().enumerate() {
                walk.step(cursor)?;
                match self.slots.iter().find(|(place, _)| *place == at) {
                    Some((_, slot)) => slot.read(&mut numbers, cursor)?,
                    None => walk.pass(cursor, field)?,
                }
            }
            if number % every == 0 {
                echoes.push(self.echo(&numbers));
            }
        }
        Ok(radar(Form::Scan, Arc::clone(&self.field), self.speeds, total, echoes))
    }

    /// Nothing read yet: what a type does not have is zero, but for its number.
    pub(super) fn numbers() -> Numbers {
        let mut numbers = [0.0; NUMBERS];
        if let Some(id) = numbers.last_mut() {
            *id = f64::NAN;
        }
        numbers
    }

    /// The one detection of a message.
    pub(super) fn single(&self, numbers: &Numbers) -> Radar {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // whole and not negative
        let id = numbers.last().filter(|id| **id >= 0.0).map(|id| *id as u64);
        let echoes = vec![self.echo(numbers)];
        radar(Form::Single(id), Arc::clone(&self.field), self.speeds, 1, echoes)
    }

    fn echo(&self, [a, b, c, x, y, z, _]: &Numbers) -> Echo {
        let radians = |angle: f64| match self.angle {
            Angle::Radians => angle,
            Angle::Degrees => angle.to_radians(),
            Angle::ClockwiseDegrees => -angle.to_radians(),
        };
        Echo {
            place: if self.is_polar {
                spherical(*a, radians(*b), radians(*c))
            } else {
                [*a, *b, *c]
            },
            speed: match self.speeds {
                Speeds::Components => Speed::Components([*x, *y, *z]),
                Speeds::Radial | Speeds::Plain => Speed::Radial(*x),
            },
        }
    }
}

impl Slot {
    /// Reads a field at the cursor.
    pub(super) fn read(self, numbers: &mut Numbers, cursor: &mut Cursor<'_>) -> Result<(), DecodeError> {
        let value = match self.number {
            Number::Float(8) => cursor.f64()?,
            Number::Float(_) => f64::from(cursor.f32()?),
            Number::Unsigned(1) => f64::from(cursor.i8()?.cast_unsigned()),
            Number::Signed(1) => f64::from(cursor.i8()?),
            Number::Unsigned(2) => f64::from(cursor.u16()?),
            Number::Signed(2) => f64::from(cursor.u16()?.cast_signed()),
            Number::Unsigned(4) => f64::from(cursor.u32()?),
            Number::Signed(4) => f64::from(cursor.i32()?),
            Number::Unsigned(_) | Number::Signed(_) => cursor.u64()? as f64,
        };
        if let Some(number) = numbers.get_mut(self.at) {
            *number = value;
        }
        Ok(())
    }
}

impl Schema {
    /// The type of a list's elements, and how a detection is read from one; `None` if they are not detections.
    pub(super) fn detections(&self, field: &Field) -> Option<(Detection, Vec<Field>)> {
        let Kind::Nested(index) = field.kind else { return None };
        let one = self.types.get(index).filter(|one| one.fault.is_none())?;
        if field.count != Count::Sequence || one.fields.len() > MAX_FIELDS {
            return None;
        }
        Some((Detection::of(one)?, one.fields.clone()))
    }
}

/// Fields of a detection that is read; Nebula's has 23.
const MAX_FIELDS: usize = 200;
