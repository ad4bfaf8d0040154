//! Motion: tracks in space, and measurements of sensors and clocks over time.

use nalgebra::Vector3;

use crate::math::geodesy::Geodetic;
use crate::world::bag::{BagEvidence, TfEdge, TfSample, TopicContent};
use crate::world::motion::{FixRow, PoseRow, Series};
use crate::world::{Pose, World};

use super::placed::FrameEntities;
use super::scene::{Color, Content, Lines, Path, Points, Scene, narrow};

/// Maximum number of points of a track, and of a curve.
const MAX_POINTS: usize = 3000;

const OF_POSES: Color = [90, 170, 250];
const OF_FIXES: Color = [250, 190, 60];
/// x, y, z.
const OF_AXES: [Color; 3] = [[235, 80, 80], [90, 200, 90], [90, 130, 250]];
/// The default colour.
const OF_STAMPS: Color = [230, 230, 120];
/// Colours of streams, in turn.
const OF_STREAMS: [Color; 8] = [
    OF_STAMPS,
    [90, 170, 250],
    [120, 210, 120],
    [230, 110, 200],
    [250, 160, 60],
    [120, 220, 220],
    [235, 90, 90],
    [180, 150, 250],
];

/// The root of everything shown over time.
pub(super) const TIME: &str = "time";

/// Draws every stream of a recording.
pub(super) fn streams(bag: &BagEvidence, placed: &FrameEntities, (top, prefix): (&Path, &str), scene: &mut Scene) {
    let mut colors = OF_STREAMS.into_iter().cycle();
    let mut color = || colors.next().unwrap_or(OF_STAMPS);
    for topic in bag.topics.values() {
        let samples = &topic.stamps.samples;
        stamps(&format!("{prefix}{}", topic.topic), samples, color(), scene);
        for said in topic.contents() {
            inertial(&said, prefix, scene);
            orientations(&said, prefix, scene);
            positions(&said, prefix, scene);
            poses(&said, placed, scene);
            fixes(&said, top, scene);
        }
    }
    for edge in bag.tf.iter().filter(|edge| !edge.is_static) {
        let name = format!("{prefix}{} {} from {}", edge.topic, edge.parent, edge.child);
        stamps(&name, &edge.stamps.samples, color(), scene);
        correction(edge, prefix, scene);
    }
}

/// How a localisation moves the odometry frame in the map: shows its jumps.
fn correction(edge: &TfEdge, prefix: &str, scene: &mut Scene) {
    if edge.child.canonical().as_str().rsplit('/').next() != Some("odom") {
        return;
    }
    let path = Path::top(TIME).then(format!("{prefix}{} from {}", edge.parent, edge.child));
    let value = |sample: &TfSample, number: usize| match number {
        0 | 1 => sample.pose.translation_m.get(number).copied().unwrap_or(f64::NAN),
        _ => sample.pose.isometry().rotation.euler_angles().2.to_degrees(),
    };
    for (number, (name, color)) in ["x, m", "y, m", "yaw, deg"].into_iter().zip(OF_AXES).enumerate() {
        let values = every(&edge.samples).map(|sample| {
            let at_ns = moment(sample.at.stamp_ns.unwrap_or(0), sample.at.log_ns);
            (at_ns, value(sample, number))
        });
        curve(&path.then(name), (name, color), values, scene);
    }
}

/// The topic, and the member of its messages.
pub(super) fn name(said: &TopicContent) -> String {
    match said.field {
        None => said.topic.topic.clone(),
        Some(field) => format!("{} {field}", said.topic.topic),
    }
}

/// How far stamps run ahead of the recorder's clock, seconds, over the stamps.
fn stamps(name: &str, samples: &[(i64, i64)], color: Color, scene: &mut Scene) {
    if samples.is_empty() {
        return;
    }
    let path = Path::top(TIME).then("stamp minus log").then(name);
    scene.always(&path, Content::Curve(name.to_owned(), color, false));
    for (stamp_ns, log_ns) in every(samples) {
        let ahead_s = stamp_ns.saturating_sub(*log_ns) as f64 / 1e9;
        scene.at(&path, moment(*stamp_ns, *log_ns), Content::Number(ahead_s));
    }
}

fn inertial(said: &TopicContent, prefix: &str, scene: &mut Scene) {
    let Some(series) = &said.content.motion.inertial else {
        return;
    };
    let rows: Vec<_> = series.rows().collect();
    let name = format!("{prefix}{}", name(said));
    for (what, unit) in [("acceleration", "m/s2"), ("angular velocity", "rad/s")] {
        for (axis, (letter, color)) in ["x", "y", "z"].into_iter().zip(OF_AXES).enumerate() {
            let path = Path::top(TIME)
                .then("inertial")
                .then(name.clone())
                .then(what)
                .then(letter);
            let values = every(&rows).filter_map(|row| {
                let vector = if what == "acceleration" {
                    row.linear_acceleration
                } else {
                    row.angular_velocity
                };
                Some((moment(row.stamp_ns, row.log_ns), *vector.get(axis)?))
            });
            curve(&path, (&format!("{what} {letter}, {unit}"), color), values, scene);
        }
    }
}

/// Numbers over time, as a line.
fn curve(path: &Path, (name, color): (&str, Color), values: impl Iterator<Item = (i64, f64)>, scene: &mut Scene) {
    let mut has_any = false;
    for (at_ns, value) in values.filter(|(_, value)| value.is_finite()) {
        has_any = true;
        scene.at(path, at_ns, Content::Number(value));
    }
    if has_any {
        scene.always(path, Content::Curve(name.to_owned(), color, true));
    }
}

/// Roll, pitch and yaw as published, without conversion between frames.
fn orientations(said: &TopicContent, prefix: &str, scene: &mut Scene) {
    let motion = &said.content.motion;
    let inertial = motion.inertial.iter().flat_map(Series::rows);
    let poses = motion.poses.iter().flat_map(Series::rows);
    let published = motion.orientations.iter().flat_map(Series::rows);
    let rows: Vec<(i64, [f64; 4])> = inertial
        .map(|row| (moment(row.stamp_ns, row.log_ns), row.orientation))
        .chain(poses.map(|row| (moment(row.stamp_ns, row.log_ns), row.orientation)))
        .chain(published.map(|row| (moment(row.stamp_ns, row.log_ns), row.orientation)))
        .collect();
    let path = Path::top(TIME)
        .then("orientation")
        .then(format!("{prefix}{}", name(said)));
    for (number, (angle, color)) in ["roll, deg", "pitch, deg", "yaw, deg"]
        .into_iter()
        .zip(OF_AXES)
        .enumerate()
    {
        let values = every(&rows).filter_map(|(at_ns, xyzw)| {
            let pose = Pose::from_raw([0.0; 3], *xyzw)?;
            let (roll, pitch, yaw) = pose.isometry().rotation.euler_angles();
            Some((*at_ns, [roll, pitch, yaw].get(number)?.to_degrees()))
        });
        curve(&path.then(angle), (angle, color), values, scene);
    }
}

/// Latitude, longitude and altitude as published, even if they are not a position on the Earth.
fn positions(said: &TopicContent, prefix: &str, scene: &mut Scene) {
    let Some(series) = &said.content.motion.fixes else {
        return;
    };
    let rows: Vec<&FixRow> = series.rows().collect();
    let path = Path::top(TIME).then("position").then(format!("{prefix}{}", name(said)));
    let names = ["latitude, deg", "longitude, deg", "altitude, m"];
    for (number, (what, color)) in names.into_iter().zip(OF_AXES).enumerate() {
        let values = every(&rows).filter_map(|row| {
            let coordinates = [row.latitude_deg, row.longitude_deg, row.altitude_m];
            Some((moment(row.stamp_ns, row.log_ns), *coordinates.get(number)?))
        });
        curve(&path.then(what), (what, color), values, scene);
    }
}

/// The track of a pose in the frame that it is expressed in.
fn poses(said: &TopicContent, placed: &FrameEntities, scene: &mut Scene) {
    let (Some(series), Some(frame)) = (&said.content.motion.poses, said.header_frames.keys().next()) else {
        return;
    };
    let Some(path) = placed.path(frame) else { return };
    let position = |row: &&PoseRow| {
        let at = Vector3::from(row.position);
        at.iter().all(|value| value.is_finite()).then(|| narrow(&at))
    };
    let strips = series.stretches.iter().map(|stretch| {
        let rows: Vec<&PoseRow> = stretch.iter().collect();
        every(&rows).filter_map(&position).collect()
    });
    track(
        &path.then(format!("track of {}", name(said))),
        strips.collect(),
        OF_POSES,
        scene,
    );
}

/// The GNSS track, east, north and up of the first fix.
fn fixes(said: &TopicContent, top: &Path, scene: &mut Scene) {
    let Some(series) = &said.content.motion.fixes else {
        return;
    };
    let geodetic = |row: &FixRow| Geodetic::from_degrees(row.latitude_deg, row.longitude_deg, row.altitude_m);
    let Some(origin) = series.rows().find_map(geodetic) else {
        return;
    };
    let strips = series.stretches.iter().map(|stretch| {
        let rows: Vec<&FixRow> = stretch.iter().collect();
        every(&rows)
            .filter_map(|row| Some(narrow(&origin.enu_of(&geodetic(row)?))))
            .collect()
    });
    let path = top.then(format!("GNSS track, {} (east, north, up of the first fix)", name(said)));
    track(&path, strips.collect(), OF_FIXES, scene);
}

/// The stated positions of frame origins on the Earth: east, north and up of the first.
pub(super) fn origins(world: &World, top: &Path, scene: &mut Scene) {
    let stated = world.origins.iter().filter_map(|origin| {
        let [latitude_deg, longitude_deg] = origin.latitude_longitude_deg?;
        let at = Geodetic::from_degrees(latitude_deg, longitude_deg, origin.altitude_m.unwrap_or(0.0));
        Some((at, origin.label.as_str()))
    });
    let stated: Vec<(Option<Geodetic>, &str)> = stated.collect();
    let first = stated.iter().find_map(|(at, _)| at.as_ref());
    let (mut xyz_m, mut labels) = (Vec::new(), Vec::new());
    for (at, label) in &stated {
        let seen = first.zip(at.as_ref()).map(|(first, at)| narrow(&first.enu_of(at)));
        let remark = if seen.is_none() {
            " (not a position on the Earth)"
        } else {
            ""
        };
        labels.push(format!("{label}{remark}"));
        xyz_m.push(seen.unwrap_or_default());
    }
    if !xyz_m.is_empty() {
        let path = top.then("origins (east, north, up of the first)");
        let colors = vec![OF_FIXES];
        let points = Points {
            xyz_m,
            colors,
            radius: -6.0,
            labels,
        };
        scene.always(&path, Content::Points(points));
    }
}

fn track(path: &Path, strips_m: Vec<Vec<[f32; 3]>>, color: Color, scene: &mut Scene) {
    let strips_m: Vec<Vec<[f32; 3]>> = strips_m.into_iter().filter(|strip| strip.len() > 1).collect();
    if !strips_m.is_empty() {
        scene.always(
            path,
            Content::Lines(Lines {
                strips_m,
                color,
                radius: -1.5,
                labels: Vec::new(),
            }),
        );
    }
}

fn moment(stamp_ns: i64, log_ns: i64) -> i64 {
    if stamp_ns == 0 { log_ns } else { stamp_ns }
}

/// Evenly thinned, including the first.
fn every<T>(rows: &[T]) -> impl Iterator<Item = &T> {
    rows.iter().step_by(rows.len().div_ceil(MAX_POINTS).max(1))
}
