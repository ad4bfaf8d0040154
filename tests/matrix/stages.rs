//! What no recording at hand says by itself, staged beside its evidence: rightly, and then wrong.
//!
//! The numbers are the recording's own: its origin lies beside its first fix, its sensor's orientation is the heading.

use frames_lint::faults::Family;
use frames_lint::source::{MessageRef, Place as At};
use frames_lint::world::bag::{HeaderFrame, TfEdge, TfSample, TopicEvidence};
use frames_lint::world::claim::Pose;
use frames_lint::world::motion::{OrientationRow, Row, Series};
use frames_lint::world::{EarthOrigin, FrameId, World};

use crate::errors::{inject, known};
use crate::streams::{Stream, StreamPlace};
use crate::support::drive::Place;
use crate::support::drive::errors::{Error as Known, rotation, slots};
use crate::support::drive::pose::earth_from_enu;

/// Something staged.
pub struct Stage {
    /// The streams that it is staged beside.
    pub family: Family,
    /// Words in a row's subject that say that it is of this, beside the stream's own.
    pub words: &'static [&'static str],
    /// Stages it; false where it cannot be.
    pub put: fn(&mut World, &Stream) -> bool,
}

/// A map and a datum whose origin was surveyed beside the first fix.
pub static EARTH: Stage = Stage {
    family: Family::Fix,
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
    family: Family::Imu,
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
    family: Family::Imu,
    words: &["(Xsens)"],
    put: |world, stream| {
        for place in &stream.places {
            let StreamPlace::Topic { topic, .. } = place else {
                continue;
            };
            let topic = world.bags[stream.bag].topics.get_mut(topic).unwrap();
            topic.writers = [("xsens_driver".to_owned(), topic.count)].into();
        }
        has_orientation(world, stream)
    },
};

/// The sensor's orientation on a topic of its own.
pub static HEADING: Stage = Stage {
    family: Family::Imu,
    words: &["`/heading`"],
    put: |world, stream| {
        let mut rows = Vec::new();
        stream.change_contents(world, |content| {
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
    family: Family::Pose,
    words: &["(CARLA)"],
    put: |world, stream| {
        put_topic(world, stream, "/carla/status", "carla_msgs/msg/CarlaStatus", "");
        true
    },
};

/// A map beside the correction that a recording has.
pub static CORRECTION: Stage = Stage {
    family: Family::Pose,
    words: &["`odom`"],
    put: |world, stream| {
        let is_it = |place: &StreamPlace| matches!(place, StreamPlace::Edge { parent, child, .. } if parent == "map" && child == "odom");
        stream.places.iter().any(is_it) && {
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
    let datum = world.origins.last_mut().unwrap();
    datum.latitude_longitude_deg = Some([away.latitude, away.longitude]);
}

/// Tells the cloud in the sensor's frame.
pub fn share_frame(world: &mut World, stream: &Stream) {
    let frame = stream.frames.first().cloned().unwrap_or_default();
    put_topic(world, stream, "/livox/lidar", "sensor_msgs/msg/PointCloud2", &frame);
}

/// Puts a mistake of the catalogue into the stream.
pub fn put_known(world: &mut World, stream: &Stream, name: &str) {
    assert!(inject(known(name), world, stream), "{name} changes nothing");
}

/// Puts a mistake of the catalogue into the datum.
pub fn change_datum(world: &mut World, name: &str) {
    let change = known(name).change;
    let datum = change.subjects(world).pop().unwrap();
    assert!(change.apply(world, &datum), "{name} changes nothing");
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
    stream.change_contents(world, |content| {
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

/// Whether a sensor states an orientation: the mistakes of orientations say where there is one.
fn has_orientation(world: &World, stream: &Stream) -> bool {
    inject(known("imu-conjugate"), &mut world.clone(), stream)
}
