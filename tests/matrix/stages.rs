//! What no recording at hand says by itself, staged beside its evidence: rightly, and then wrong.
//!
//! The numbers are the recording's own: its origin lies beside its first fix, its sensor's orientation is the heading.

use frames_lint::source::{MessageRef, Place as At};
use frames_lint::world::bag::{HeaderFrame, TfEdge, TfSample, TopicEvidence};
use frames_lint::world::claim::Pose;
use frames_lint::world::motion::{OrientationRow, Row, Series};
use frames_lint::world::{EarthOrigin, FrameId, World};

use crate::errors::{as_imu_rows, as_odometry_rows, edges};
use crate::places::Place;
use crate::streams::{At as StreamAt, Kind, Stream};
use crate::support::drive::errors::{Error as Known, rotation, slots};
use crate::support::drive::pose::earth_from_enu;

/// Something staged.
pub struct Stage {
    /// The streams that it is staged beside.
    pub kind: Kind,
    /// Words in a row's subject that say that it is of this, beside the stream's own.
    pub words: &'static [&'static str],
    /// Stages it; false where it cannot be.
    pub put: fn(&mut World, &Stream) -> bool,
}

/// A map and a datum whose origin was surveyed beside the first fix.
pub static EARTH: Stage = Stage {
    kind: Kind::Fixes,
    words: &["`map`", "datum", "origin"],
    put: |world, stream| {
        let Some(first) = surveyed(world, stream) else {
            return false;
        };
        let bag = &mut world.bags[stream.bag];
        let at = message("/tf_static", bag.start_ns.unwrap_or_default());
        let sample = TfSample {
            at,
            pose: on_earth(first, None),
        };
        bag.tf
            .push(TfEdge::once(FrameId::new("earth"), FrameId::new("map"), sample));
        bag.tf
            .sort_by(|a, b| (&a.child, &a.parent, &a.topic).cmp(&(&b.child, &b.parent, &b.topic)));
        world.origins.push(EarthOrigin {
            format: "robot_localization".to_owned(),
            label: "navsat_transform.datum".to_owned(),
            latitude_longitude_deg: Some([first.latitude, first.longitude]),
            altitude_m: None,
            decimals: 9,
            projection: None,
            place: At::whole(world.bags[stream.bag].source),
        });
        true
    },
};

/// A lidar's cloud in a frame of its own.
pub static CLOUD: Stage = Stage {
    kind: Kind::Imu,
    words: &[],
    put: |world, stream| {
        put_topic(
            world,
            stream,
            "/livox/lidar",
            "sensor_msgs/msg/PointCloud2",
            "livox_lidar",
        );
        true
    },
};

/// An Xsens as the one that publishes the sensor.
pub static XSENS: Stage = Stage {
    kind: Kind::Imu,
    words: &["(Xsens)"],
    put: |world, stream| {
        for at in &stream.at {
            let StreamAt::Topic(topic, _) = at else { continue };
            let topic = world.bags[stream.bag].topics.get_mut(topic).unwrap();
            topic.writers = [("xsens_driver".to_owned(), topic.count)].into();
        }
        has_orientation(world, stream)
    },
};

/// The sensor's orientation on a topic of its own.
pub static HEADING: Stage = Stage {
    kind: Kind::Imu,
    words: &["`/heading`"],
    put: |world, stream| {
        let mut rows = Vec::new();
        stream.contents(world, |content| {
            let stretches = content.motion.inertial.iter().flat_map(|series| &series.stretches);
            rows.extend(stretches.map(|stretch| {
                let told = stretch.iter().map(|row| OrientationRow {
                    stamp_ns: row.stamp_ns(),
                    log_ns: row.log_ns(),
                    orientation: row.orientation,
                });
                told.collect::<Vec<_>>()
            }));
        });
        let frame = stream.frames.first().cloned().unwrap_or_default();
        if has_orientation(world, stream) {
            let kind = "geometry_msgs/msg/QuaternionStamped";
            let topic = put_topic(world, stream, "/heading", kind, &frame);
            let count = rows.iter().map(Vec::len).sum::<usize>() as u64;
            topic.content.motion.orientations = Some(Series { count, stretches: rows });
        }
        has_orientation(world, stream)
    },
};

/// A simulator with a left-handed world as what publishes.
pub static CARLA: Stage = Stage {
    kind: Kind::Poses,
    words: &["(CARLA)"],
    put: |world, stream| {
        put_topic(world, stream, "/carla/status", "carla_msgs/msg/CarlaStatus", "");
        true
    },
};

/// A map beside the correction that a recording has.
pub static CORRECTION: Stage = Stage {
    kind: Kind::Poses,
    words: &["`odom`"],
    put: |world, stream| {
        let is_it = |at: &StreamAt| matches!(at, StreamAt::Edge(map, odom, _) if map == "map" && odom == "odom");
        stream.at.iter().any(is_it) && {
            put_topic(world, stream, "/map", "nav_msgs/msg/OccupancyGrid", "map");
            true
        }
    },
};

/// Tells where the map lies on the Earth, with an error.
pub fn add_earth(world: &mut World, stream: &Stream, error: Option<Known>) {
    let first = surveyed(world, stream).unwrap();
    set_earth(world, stream, on_earth(first, error));
}

/// Moves the map's origin to the south, with its right rotation there; the datum with it.
pub fn move_earth(world: &mut World, stream: &Stream, degrees: f64) {
    let first = surveyed(world, stream).unwrap();
    let away = Place {
        latitude: first.latitude - degrees,
        ..first
    };
    set_earth(world, stream, on_earth(away, None));
    move_datum(world, |[_, longitude]| [away.latitude, longitude]);
}

/// Moves the datum alone.
pub fn move_datum(world: &mut World, change: impl Fn([f64; 2]) -> [f64; 2]) {
    let origin = world.origins.last_mut().unwrap();
    origin.latitude_longitude_deg = origin.latitude_longitude_deg.map(change);
}

/// Tells the cloud in the sensor's frame.
pub fn share_frame(world: &mut World, stream: &Stream) {
    let frame = stream.frames.first().cloned().unwrap_or_default();
    put_topic(world, stream, "/livox/lidar", "sensor_msgs/msg/PointCloud2", &frame);
}

/// A yaw that is zero in the north.
pub fn zero_north(world: &mut World, stream: &Stream) {
    as_imu_rows(world, Some(stream), |row| {
        row.apply(Known::ZeroNorth, crate::errors::GRAVITY);
    });
}

/// A compass heading as the yaw of the orientation on its own topic.
pub fn compass_heading(world: &mut World, stream: &Stream) {
    let topic = world.bags[stream.bag].topics.get_mut("/heading").unwrap();
    let rows = topic.content.motion.orientations.iter_mut();
    for row in rows.flat_map(|series| series.stretches.iter_mut().flatten()) {
        let (roll, pitch, yaw) = rotation(row.orientation).euler_angles();
        let heading = std::f64::consts::FRAC_PI_2 - yaw;
        row.orientation = slots(nalgebra::UnitQuaternion::from_euler_angles(roll, pitch, heading));
    }
}

/// Poses of a left-handed world.
pub fn left_handed(world: &mut World, stream: &Stream) {
    as_odometry_rows(world, stream, |row| row.apply(Known::LeftHanded));
}

/// Nobody publishes the correction.
pub fn remove_correction(world: &mut World, stream: &Stream) {
    world.bags[stream.bag].tf.retain(|edge| {
        let at = StreamAt::Edge(
            edge.parent.canonical().as_str().to_owned(),
            edge.child.canonical().as_str().to_owned(),
            edge.topic.clone(),
        );
        !stream.at.contains(&at)
    });
}

/// The correction stays at its first value.
pub fn hold_correction(world: &mut World, stream: &Stream) {
    for edge in edges(world, stream) {
        edge.extreme = None;
        let first = edge.samples[0].pose;
        edge.samples.iter_mut().for_each(|sample| sample.pose = first);
        for row in edge
            .motion
            .iter_mut()
            .flat_map(|series| series.stretches.iter_mut().flatten())
        {
            (row.position, row.orientation) = (first.translation_m, first.rotation_xyzw);
        }
    }
}

/// The map is expressed in odom.
pub fn map_in_odom(world: &mut World, stream: &Stream) {
    put_topic(world, stream, "/map", "nav_msgs/msg/OccupancyGrid", "odom");
}

/// Puts a topic of a frame beside a stream.
pub fn put_topic<'w>(
    world: &'w mut World,
    stream: &Stream,
    name: &str,
    kind: &str,
    frame: &str,
) -> &'w mut TopicEvidence {
    let bag = &mut world.bags[stream.bag];
    let first = message(name, bag.start_ns.unwrap_or_default());
    let used = HeaderFrame {
        count: 10,
        first: first.clone(),
    };
    let topic = TopicEvidence {
        topic: name.to_owned(),
        message_type: kind.to_owned(),
        count: 10,
        first_log_ns: bag.start_ns,
        last_log_ns: bag.end_ns,
        header_frames: [(FrameId::new(frame), used)].into(),
        ..TopicEvidence::default()
    };
    bag.topics.insert(name.to_owned(), topic);
    bag.topics.get_mut(name).unwrap()
}

pub fn message(topic: &str, log_ns: i64) -> MessageRef {
    MessageRef {
        topic: topic.to_owned(),
        index: 0,
        stamp_ns: Some(log_ns),
        log_ns,
        field: None,
    }
}

fn set_earth(world: &mut World, stream: &Stream, pose: Pose) {
    let edges = world.bags[stream.bag].tf.iter_mut();
    for edge in edges.filter(|edge| edge.parent.as_str() == "earth") {
        edge.samples.iter_mut().for_each(|sample| sample.pose = pose);
    }
}

fn on_earth(place: Place, error: Option<Known>) -> Pose {
    let errors: Vec<Known> = error.into_iter().collect();
    Pose {
        translation_m: place.ecef().into(),
        rotation_xyzw: slots(earth_from_enu(place, &errors).into()),
    }
}

/// A point 33 m to the north of the first fix: the first fix itself would be an origin of its own kind (GEO07).
fn surveyed(world: &mut World, stream: &Stream) -> Option<Place> {
    let mut first = None;
    stream.contents(world, |content| {
        let rows = content.motion.fixes.iter().flat_map(Series::rows);
        first = first.or_else(|| {
            rows.map(|fix| Place {
                latitude: fix.latitude_deg,
                longitude: fix.longitude_deg,
                altitude: if fix.altitude_m.is_finite() {
                    fix.altitude_m
                } else {
                    0.0
                },
            })
            .find(|place| place.latitude != 0.0 && place.ecef().norm().is_finite())
        });
    });
    first.map(|first| Place {
        latitude: first.latitude + 3e-4,
        ..first
    })
}

fn has_orientation(world: &World, stream: &Stream) -> bool {
    crate::errors::has(world, stream, crate::errors::Requirement::Orientation)
}
