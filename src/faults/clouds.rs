//! Mistakes of point clouds: their axes, their unit, and the times of their points.
//!
//! The evidence has a part of the clouds with a part of their points, and of every cloud of a run the points near the plane of its x
//! and y. A change that keeps this plane changes all of that as the same clouds would be collected. For the axes of a camera, which
//! turn it, the points near the other plane are collected, too, where mistakes are tried; of saved evidence, which has none, the new
//! plane is cut from the kept points. Rows and columns stay.

use std::sync::Arc;

use crate::world::World;
use crate::world::bag::TopicEvidence;
use crate::world::cloud::{CloudEvidence, CloudSample, CloudSlice, PlaneCut, PointTimes, optical};

use super::{Change, Fault, Subject, SubjectPlace};

/// A mistake of a cloud: which clouds can have it, and how it changes them. False where that changes nothing.
struct Cloud {
    has: fn(&World, &TopicEvidence, &CloudEvidence) -> bool,
    change: fn(&mut TopicEvidence) -> bool,
}

impl Change for Cloud {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let mut subjects = Vec::new();
        for (bag, evidence) in world.bags.iter().enumerate() {
            for topic in evidence.topics.values() {
                let clouds = topic.content.clouds.as_ref().filter(|clouds| is_seen(topic, clouds));
                if clouds.is_some_and(|clouds| (self.has)(world, topic, clouds)) {
                    subjects.push(Subject::of_topic(bag, topic));
                }
            }
        }
        subjects
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Topic { bag, topic } = &subject.at else {
            return false;
        };
        let topic = world.bags.get_mut(*bag).and_then(|bag| bag.topics.get_mut(topic));
        topic.is_some_and(self.change)
    }
}

/// Whether points of a lidar or a camera are seen; those of a radar have mistakes of their own.
fn is_seen(topic: &TopicEvidence, clouds: &CloudEvidence) -> bool {
    topic.content.radar.is_none() && clouds.samples.iter().any(|sample| !sample.points.is_empty())
}

fn any(_: &World, _: &TopicEvidence, _: &CloudEvidence) -> bool {
    true
}

/// Whether a driver published the times of the points: those of packets are in the unit and the field of the decoder.
fn published_times(world: &World, topic: &TopicEvidence, clouds: &CloudEvidence) -> bool {
    clouds.packets.is_none() && timed(world, topic, clouds)
}

fn timed(_: &World, _: &TopicEvidence, clouds: &CloudEvidence) -> bool {
    let mut times = clouds.samples.iter().filter_map(|sample| sample.times.as_ref());
    times.any(|times| times.distinct > 2)
}

/// Whether the clouds are those of an Ouster, by the fields of their points.
fn of_an_ouster(world: &World, _: &TopicEvidence, clouds: &CloudEvidence) -> bool {
    clouds.layouts.first().is_some_and(|layout| {
        let fields = layout.fields.iter();
        let fields = fields.map(|field| (field.name.as_str(), field.datatype.as_str()));
        world
            .tables
            .cloud_driver(fields)
            .is_some_and(|driver| driver.name == "Ouster")
    })
}

/// Expresses the points in other axes with the same plane of x and y, or the same turned over.
fn turned(topic: &mut TopicEvidence, axes: fn([f64; 3]) -> [f64; 3]) -> bool {
    let Some(clouds) = &mut topic.content_mut().clouds else {
        return false;
    };
    let points = clouds.samples.iter_mut().flat_map(|sample| &mut sample.points);
    points.for_each(|point| point.xyz = axes(point.xyz));
    for slice in clouds.runs.iter_mut().flatten() {
        let mut cut = PlaneCut::default();
        // Points without times have none afterwards, either.
        for (at, point) in slice.points.iter().enumerate() {
            cut.push(axes(*point), || slice.after.get(at).copied().unwrap_or(f64::NAN));
        }
        (slice.points, slice.after) = cut.finish();
    }
    true
}

/// Expresses the points in the axes of a camera.
fn forward(topic: &mut TopicEvidence) -> bool {
    let Some(clouds) = &mut topic.content_mut().clouds else {
        return false;
    };
    let points = clouds.samples.iter_mut().flat_map(|sample| &mut sample.points);
    points.for_each(|point| point.xyz = optical(point.xyz));
    for slice in clouds.runs.iter_mut().flatten() {
        let collected = slice.optical.take().map(Arc::unwrap_or_clone);
        (slice.points, slice.after) = collected.unwrap_or_else(|| {
            let mut cut = PlaneCut::default();
            let sample = clouds.samples.iter().find(|sample| is_of(sample, slice));
            for point in sample.iter().flat_map(|sample| &sample.points) {
                cut.push(point.xyz, || point.time);
            }
            cut.finish()
        });
    }
    true
}

/// Whether a sample is of the same cloud as a slice.
fn is_of(sample: &CloudSample, slice: &CloudSlice) -> bool {
    sample.at.log_ns == slice.log_ns && sample.at.stamp_ns.filter(|stamp| *stamp != 0) == slice.stamp_ns
}

/// Expresses the points in another unit of length.
fn scaled(topic: &mut TopicEvidence, factor: f64) -> bool {
    let Some(clouds) = &mut topic.content_mut().clouds else {
        return false;
    };
    let points = clouds.samples.iter_mut().flat_map(|sample| &mut sample.points);
    points.for_each(|point| point.xyz = point.xyz.map(|value| value * factor));
    let points = clouds.runs.iter_mut().flatten().flat_map(|slice| &mut slice.points);
    points.for_each(|point| *point = point.map(|value| value * factor));
    if let Some((_, farthest)) = &mut clouds.farthest {
        *farthest *= factor;
    }
    true
}

/// Leaves out the times of the points, and the field that holds them.
fn untimed(topic: &mut TopicEvidence) -> bool {
    let Some(clouds) = &mut topic.content_mut().clouds else {
        return false;
    };
    let times = clouds.samples.iter_mut().filter_map(|sample| sample.times.take());
    let fields: Vec<String> = times.map(|times| times.field).collect();
    for layout in &mut clouds.layouts {
        layout.fields.retain(|field| !fields.contains(&field.name));
    }
    let points = clouds.samples.iter_mut().flat_map(|sample| &mut sample.points);
    points.for_each(|point| point.time = f64::NAN);
    clouds.runs.iter_mut().flatten().for_each(|slice| slice.after.clear());
    !fields.is_empty()
}

/// Changes the times of the points; `of_slice` those after the earliest in a slice, of which the last is given.
fn retimed(
    topic: &mut TopicEvidence,
    time: impl Fn(f64, &PointTimes) -> f64,
    of_slice: impl Fn(f64, f64, &PointTimes) -> f64,
) -> bool {
    let Some(clouds) = &mut topic.content_mut().clouds else {
        return false;
    };
    let mut known = None;
    for sample in &mut clouds.samples {
        let Some(times) = sample.times.take() else { continue };
        for point in &mut sample.points {
            point.time = held(time(point.time, &times), &times.datatype);
        }
        let changed = times.clone().of(sample.points.iter().map(|point| point.time).collect());
        sample.times = changed;
        known.get_or_insert(times);
    }
    let Some(times) = known else { return false };
    for slice in clouds.runs.iter_mut().flatten() {
        let last = slice.after.iter().copied().fold(0.0, f64::max);
        for after in &mut slice.after {
            *after = held(of_slice(*after, last, &times), &times.datatype);
        }
        if slice.after.iter().all(|after| *after == 0.0) {
            slice.after.clear();
        }
    }
    true
}

/// A number as a field of this type holds it.
#[allow(clippy::cast_possible_truncation)] // that is meant
fn held(value: f64, datatype: &str) -> f64 {
    match datatype {
        "float64" => value,
        "float32" => f64::from(value as f32),
        _ => value.trunc(),
    }
}

/// What a time is multiplied by where its unit is a thousand times as large, or as small where the numbers are large.
fn other_unit(times: &PointTimes) -> f64 {
    let [first, last] = times.quantiles;
    if last - first > 1e3 { 1e-3 } else { 1e3 }
}

/// A mistake of a cloud.
macro_rules! cloud {
    ($name:literal, $has:expr, $change:expr, $sentence:literal, $($named:tt)*) => {
        fault!(Cloud, $name, $sentence, Cloud { has: $has, change: $change }, $($named)*)
    };
}

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[
    cloud!(
        "cloud-mirrored",
        any,
        |topic| turned(topic, |[x, y, z]| [x, -y, z]),
        "A cloud is mirrored: y has the opposite sign.",
        ["mirrored"],
        [],
        ["AXES11", "TIME07"],
        "30 s of driving with turns, with this cloud and a gyro or odometry, and per-point times in the cloud"
    ),
    cloud!(
        "cloud-z-down",
        any,
        |topic| turned(topic, |[x, y, z]| [x, -y, -z]),
        "A cloud is upside down: it is expressed in x forward, y right, z down.",
        ["x180"],
        [],
        ["AXES10", "TIME07"],
        "flat ground in view of the lidar, and its transform to the base"
    ),
    cloud!(
        "cloud-z-forward",
        any,
        forward,
        "A cloud is expressed in the axes of a camera: x right, y down, z forward.",
        ["optical"],
        [],
        ["AXES10"],
        "flat ground in view of the lidar, and its transform to the base"
    ),
    cloud!(
        "cloud-ouster-half-turn",
        of_an_ouster,
        |topic| turned(topic, |[x, y, z]| [-x, -y, z]),
        "The clouds of an Ouster are expressed in the other one of its two frames, half a turn about z away.",
        ["z180", "z180-extra", "z180-missing", "z180-twice"],
        [],
        ["SENSOR01", "SENSOR03", "AXES12"],
        "organised clouds with rows and columns, or 30 s of driving with turns, with this cloud and odometry"
    ),
    cloud!(
        "cloud-yaw-90",
        any,
        |topic| turned(topic, |[x, y, z]| [-y, x, z]),
        "A cloud is turned by a quarter turn about z, as a driver with azimuth zero on y publishes it.",
        ["z90", "z-90"],
        [],
        ["AXES12", "SENSOR04", "CROSS05"],
        "30 s of driving with turns, with this cloud and odometry"
    ),
    cloud!(
        "cloud-millimetres",
        any,
        |topic| scaled(topic, 1000.0),
        "The points of a cloud are in millimetres.",
        ["millimetres"],
        ["in millimetres"],
        ["AXES09", "PREC01", "CROSS05"],
        "flat ground in view of the lidar, and its height over the base in /tf_static or the URDF"
    ),
    cloud!(
        "cloud-times-missing",
        published_times,
        untimed,
        "The points of a cloud have no times.",
        ["missing"],
        [],
        ["TIME05"],
        "10 s of driving with this cloud and odometry or a gyro"
    ),
    cloud!(
        "cloud-times-constant",
        published_times,
        |topic| retimed(topic, |_, times| times.range[0], |_, _, _| 0.0),
        "All points of a cloud have one time.",
        ["constant"],
        [],
        ["TIME05"],
        "10 s of driving with this cloud and odometry or a gyro"
    ),
    cloud!(
        "cloud-times-unit",
        published_times,
        |topic| {
            retimed(
                topic,
                |time, times| time * other_unit(times),
                |after, _, times| after * other_unit(times),
            )
        },
        "The times of the points of a cloud are in another unit than its driver has: milliseconds for seconds, or microseconds for nanoseconds.",
        ["unit"],
        [],
        ["TIME06"],
        "clouds at the full rate of the sensor, with stamps in their headers"
    ),
    cloud!(
        "cloud-times-reversed",
        timed,
        |topic| {
            retimed(
                topic,
                |time, times| times.range[0] + (times.range[1] - time),
                |after, last, _| last - after,
            )
        },
        "The times of the points of a cloud run backwards.",
        ["times-reversed"],
        [],
        ["TIME07"],
        "30 s of driving with turns, with this cloud and a gyro, and flat ground in view: both exclude a mirrored cloud and z down"
    ),
];
