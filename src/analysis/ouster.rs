//! The frames of Ouster sensors and what is stated of them.
//!
//! Owns which frame a name means, and which metadata belong to what. Must not judge.

use std::f64::consts::PI;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::analysis::{cross::pair::Statement, cross::statements::statements, lidar::Clouds};
use crate::source::SourceId;
use crate::tables::OusterPart;
use crate::world::{FrameId, OusterMetadata, World};

/// The two frames that clouds of the sensor are expressed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axes {
    /// x towards the connector, as the encoder counts.
    Lidar,
    /// x away from the connector.
    Sensor,
}

impl Axes {
    pub(crate) const BOTH: [Self; 2] = [Self::Lidar, Self::Sensor];

    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Lidar => "Lidar",
            Self::Sensor => "Sensor",
        }
    }

    /// The azimuth of the first column of a cloud.
    pub(crate) fn azimuth_rad(self) -> f64 {
        match self {
            Self::Lidar => 0.0,
            Self::Sensor => PI,
        }
    }

    /// The one that a frame's name states: `os_lidar`, `os1_sensor`, `ouster/os_lidar`. A plain `lidar` may be either.
    pub(crate) fn of(frame: &FrameId) -> Option<Self> {
        let tokens = frame.tokens();
        match tokens.last().map(String::as_str)? {
            "lidar" if is_ouster(&tokens) => Some(Self::Lidar),
            "sensor" if is_ouster(&tokens) => Some(Self::Sensor),
            _ => None,
        }
    }
}

/// Whether words of a frame or a topic name an Ouster.
pub(crate) fn is_ouster(tokens: &[String]) -> bool {
    let names = |token: &String| {
        let rest = token.strip_prefix("os");
        token == "ouster" || rest.is_some_and(|rest| rest.chars().all(|letter| letter.is_ascii_digit()))
    };
    tokens.iter().any(names)
}

/// What a name means.
#[derive(Clone, Copy)]
enum NameMeaning {
    /// The Sensor frame.
    Sensor,
    /// That of a part.
    Of(OusterPart),
}

/// What a frame's name means.
fn meant(frame: &FrameId, is_metadata: bool) -> Option<NameMeaning> {
    let tokens = frame.tokens();
    if !is_metadata && !is_ouster(&tokens) {
        return None;
    }
    match tokens.last().map(String::as_str)? {
        "sensor" => Some(NameMeaning::Sensor),
        "lidar" => Some(NameMeaning::Of(OusterPart::Lidar)),
        "imu" => Some(NameMeaning::Of(OusterPart::Imu)),
        "beam" if is_metadata => Some(NameMeaning::Of(OusterPart::Beam)),
        _ => None,
    }
}

/// A statement of where a part is: in the Sensor frame, of a beam in the Lidar frame.
pub(crate) struct Part<'w> {
    pub(crate) kind: OusterPart,
    /// `sensor_from_part`, or `lidar_from_beam`.
    pub(crate) pose: Isometry3<f64>,
    /// The metadata that it is part of.
    pub(crate) metadata: Option<&'w OusterMetadata>,
    pub(crate) statement: Statement,
}

impl<'w> Part<'w> {
    /// All that a world states, metadata in files and in recordings included.
    pub(crate) fn all(world: &'w World) -> Vec<Self> {
        statements(world)
            .into_iter()
            .filter_map(|statement| Self::of(world, statement))
            .collect()
    }

    fn of(world: &'w World, statement: Statement) -> Option<Self> {
        let is_key = statement.is_of_a_file()
            && ["_to_sensor_transform", "beam_to_lidar_transform"]
                .iter()
                .any(|key| statement.label.ends_with(key));
        if !statement.has_rotation || !statement.has_translation {
            return None;
        }
        let known = [&statement.target, &statement.source_frame].map(|name| meant(name, is_key));
        let (part, pose) = match known {
            [
                Some(NameMeaning::Of(OusterPart::Lidar)),
                Some(NameMeaning::Of(OusterPart::Beam)),
            ] => (OusterPart::Beam, statement.pose),
            [Some(NameMeaning::Sensor), Some(NameMeaning::Of(part))] if part != OusterPart::Beam => {
                (part, statement.pose)
            }
            [Some(NameMeaning::Of(part)), Some(NameMeaning::Sensor)] if part != OusterPart::Beam => {
                (part, statement.pose.inverse())
            }
            _ => return None,
        };
        let metadata = is_key.then(|| metadata_in(world, statement.place.source)).flatten();
        Some(Self {
            kind: part,
            pose,
            metadata,
            statement,
        })
    }

    /// The rotation that it should have.
    pub(crate) fn turn(&self) -> UnitQuaternion<f64> {
        match self.kind {
            OusterPart::Lidar => UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI),
            OusterPart::Imu | OusterPart::Beam => UnitQuaternion::identity(),
        }
    }
}

/// The metadata in a source.
fn metadata_in(world: &World, source: SourceId) -> Option<&OusterMetadata> {
    world.ousters.iter().find(|metadata| metadata.place.source == source)
}

/// The metadata of the sensor whose clouds these are: those of its own recording, else all; the only ones with as many rows and
/// columns, and none where several have.
pub(crate) fn metadata_of<'w>(world: &'w World, clouds: &Clouds) -> Option<&'w OusterMetadata> {
    let path = world.path(clouds.bag.source);
    let is_own = |metadata: &&OusterMetadata| world.path(metadata.place.source) == path;
    let own: Vec<&OusterMetadata> = world.ousters.iter().filter(is_own).collect();
    let of = if own.is_empty() {
        world.ousters.iter().collect()
    } else {
        own
    };
    let [height, width] = clouds.evidence.samples.first()?.size;
    let is_sized = |metadata: &&OusterMetadata| {
        let is = |said: Option<u32>, seen: u32| said.is_none_or(|said| said == seen);
        height <= 1 || (is(metadata.rows, height) && is(metadata.columns, width))
    };
    let mut fitting = of.into_iter().filter(is_sized);
    let first = fitting.next()?;
    fitting.next().is_none().then_some(first)
}

/// Whether these are clouds of an Ouster: by the fields of the points; or, with any fields, where the frame or the topic names it and
/// metadata of a sensor with as many rows and columns as the organised cloud are available.
pub(crate) fn is_of_an_ouster(world: &World, clouds: &Clouds) -> bool {
    if clouds.driver.is_some_and(|driver| driver.name == "Ouster") {
        return true;
    }
    let is_named = clouds.frame().is_some_and(|frame| is_ouster(&frame.tokens())) || is_ouster(&clouds.topic.words());
    is_named && metadata_of(world, clouds).is_some_and(|metadata| metadata.columns.is_some())
}
