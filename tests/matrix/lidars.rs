//! A lidar staged on the way that a recording's poses tell, rightly and then wrong: no recording at hand has a cloud with transforms.
//!
//! Its rays are cast along the poses as they are, so that its scans move as the platform of the recording did.

use std::cell::RefCell;
use std::f64::consts::PI;
use std::rc::Rc;

use frames_lint::faults::Family;
use frames_lint::world::bag::{TfEdge, TfSample};
use frames_lint::world::motion::{PoseRow, Row, Series};
use frames_lint::world::{FrameId, Pose, World};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::stages::{Stage, message};
use crate::streams::{MovingFrame, Stream, StreamPlace, name};
use crate::support::clouds::{Driver, Lidar};
use crate::support::drive::errors::slots;
use crate::support::drive::lidar::{Beams, Ray, cast};
use crate::support::drive::scene::{Scene, Surroundings};
use crate::support::scans::{self, SCANS_HZ};

/// Seconds of the recording that the lidar runs for at most: those with the longest way.
const SECONDS: f64 = 30.0;
/// Fewer show nothing.
const LEAST_SECONDS: f64 = 3.0;
/// Longest step between poses that is gone straight over, seconds.
const LONGEST_STEP_S: f64 = 1.0;
/// Seed of what is around.
const SEED: u64 = 5;

/// An Ouster in its Sensor frame.
pub static LIDAR: Stage = Stage {
    family: Family::Pose,
    words: &["`/points`", "`os_lidar`"],
    put: |world, stream| put(world, stream, &RIGHT),
};

/// What is told of the lidar.
pub struct LidarSetup {
    /// What its driver makes of the rays.
    pub cloud: fn(&mut Lidar),
    /// The cloud's axes from the sensor's, `base_from_sensor` given.
    pub axes: fn(&Isometry3<f64>) -> Isometry3<f64>,
    /// `base_from_sensor` as the transforms tell it, from the true one.
    pub mount: fn(Isometry3<f64>) -> Isometry3<f64>,
    /// How far the Lidar frame is turned in the Sensor frame, radians.
    pub half_turn: f64,
}

pub const RIGHT: LidarSetup = LidarSetup {
    cloud: |_| {},
    axes: |_| Isometry3::identity(),
    mount: |mount| mount,
    half_turn: PI,
};

/// Tells the lidar otherwise.
pub fn set_lidar(world: &mut World, stream: &Stream, setup: &LidarSetup) {
    let bag = &mut world.bags[stream.bag];
    bag.topics.remove("/points");
    bag.tf.retain(|edge| !edge.child.as_str().starts_with("os_"));
    put(world, stream, setup);
}

/// z forward, x right, y down from x forward, y left, z up.
pub fn optical() -> Isometry3<f64> {
    let rows = Matrix3::new(0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0);
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rows));
    Isometry3::from_parts(Translation3::identity(), turn)
}

/// A turn about an axis, degrees.
pub fn turn(axis: Vector3<f64>, degrees: f64) -> Isometry3<f64> {
    Isometry3::rotation(axis * degrees.to_radians())
}

/// A part of the way of a platform.
struct PathSection {
    /// Times in seconds after the first of them, and `world_from_base`.
    poses: Vec<(f64, Isometry3<f64>)>,
    /// The first of them: stamp and log time, nanoseconds.
    start_ns: [i64; 2],
}

impl PathSection {
    /// The part of the recording that is used; `None` where there is none.
    fn of(world: &mut World, stream: &Stream) -> Option<Self> {
        let mut stretches: Vec<Vec<PoseRow>> = Vec::new();
        stream.change_contents(world, |content| {
            stretches.extend(of_series(content.motion.poses.as_ref()));
        });
        if stretches.is_empty() {
            let edges = stream.edges_mut(world);
            stretches = edges.flat_map(|edge| of_series(edge.motion.as_ref())).collect();
        }
        let parts = stretches.iter().flat_map(|rows| {
            let step = (rows.len() / 20).max(1);
            (0..rows.len()).step_by(step).map(|from| part(&rows[from..]))
        });
        let length = |part: &Vec<&PoseRow>| -> f64 {
            let steps = part.windows(2);
            let far = |pair: &[&PoseRow]| (Vector3::from(pair[1].position) - Vector3::from(pair[0].position)).norm();
            steps.map(|pair| far(pair).min(1.0)).sum()
        };
        let longest = parts
            .filter(|part| seconds(part) >= LEAST_SECONDS)
            .max_by(|a, b| length(a).total_cmp(&length(b)))?;
        let first = longest[0];
        let pose = |row: &&PoseRow| {
            let [x, y, z, w] = row.orientation;
            let turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            let after_s = (row.log_ns - first.log_ns) as f64 * 1e-9;
            (after_s, Isometry3::from_parts(row.position.into(), turn))
        };
        let start_ns = [
            if first.stamp_ns == 0 {
                first.log_ns
            } else {
                first.stamp_ns
            },
            first.log_ns,
        ];
        let poses: Vec<_> = longest.iter().map(pose).collect();
        poses
            .iter()
            .all(|(_, pose)| pose.rotation.norm().is_finite() && pose.translation.vector.norm().is_finite())
            .then_some(Self { poses, start_ns })
    }

    /// Where the base is, between the poses.
    fn at(&self, t_s: f64) -> Isometry3<f64> {
        let last = self.poses.len() - 1;
        let after = self.poses.partition_point(|(at, _)| *at < t_s).clamp(1, last);
        let [(from_s, from), (to_s, to)] = [&self.poses[after - 1], &self.poses[after]];
        let share = ((t_s - from_s) / (to_s - from_s).max(1e-6)).clamp(0.0, 1.0);
        from.try_lerp_slerp(to, share, 1e-9).unwrap_or(*from)
    }
}

fn of_series(series: Option<&Series<PoseRow>>) -> Vec<Vec<PoseRow>> {
    series.map_or_else(Vec::new, |series| series.stretches.clone())
}

/// As much as is used of rows, up to the first gap.
fn part(rows: &[PoseRow]) -> Vec<&PoseRow> {
    let mut part: Vec<&PoseRow> = Vec::new();
    for row in rows {
        let apart = |other: &PoseRow| (row.log_ns() - other.log_ns()) as f64 * 1e-9;
        if part
            .last()
            .is_some_and(|last| apart(last) > LONGEST_STEP_S || apart(last) <= 0.0)
            || part.first().is_some_and(|first| apart(first) > SECONDS)
        {
            break;
        }
        part.push(row);
    }
    part
}

fn seconds(part: &[&PoseRow]) -> f64 {
    let ends = part.first().zip(part.last());
    ends.map_or(0.0, |(first, last)| (last.log_ns - first.log_ns) as f64 * 1e-9)
}

/// The rays of the last stream, for the next error.
type RayCache = Option<(String, Rc<Vec<Vec<Ray>>>)>;

thread_local! {
    static KEPT: RefCell<RayCache> = const { RefCell::new(None) };
}

fn put(world: &mut World, stream: &Stream, setup: &LidarSetup) -> bool {
    let child = stream.places.iter().find_map(|place| match place {
        StreamPlace::Edge { child, .. } => Some(child.clone()),
        StreamPlace::Topic { topic, field: None } => {
            let frames = &world.bags[stream.bag].topics[topic].child_frames;
            frames.keys().next().map(|frame| frame.canonical().as_str().to_owned())
        }
        StreamPlace::Topic { .. } => None,
    });
    let (Some(child), true) = (child, stream.moving == MovingFrame::Base) else {
        return false;
    };
    let Some(way) = PathSection::of(world, stream) else {
        return false;
    };
    // The ground is where a footprint is, else under the frame itself.
    let ground_m = footprint(world, stream, &child);
    let ground = Isometry3::translation(0.0, 0.0, ground_m);
    let mount = Isometry3::from_parts(
        Translation3::new(0.2, 0.05, 1.0),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 30_f64.to_radians()),
    );
    let mut lidar = Lidar {
        driver: Driver::Ouster,
        table: Beams::Os1,
        beams: 16,
        columns: 256,
        surroundings: Surroundings::Street,
        ..Lidar::default()
    };
    (setup.cloud)(&mut lidar);
    lidar.stated = (setup.axes)(&mount);
    let rays = rays(stream, &way, &ground, &mount, &lidar);
    let [stamp_ns, log_ns] = way.start_ns;
    let topic = scans::collected(&lidar, "os_sensor", &rays, |number| {
        let after_ns = (number as f64 / SCANS_HZ * 1e9).round() as i64;
        [stamp_ns + after_ns, log_ns + after_ns]
    });
    let bag = &mut world.bags[stream.bag];
    bag.topics.insert("/points".to_owned(), topic);
    let mut lidar_in_sensor = turn(Vector3::z(), setup.half_turn.to_degrees());
    lidar_in_sensor.translation.z = 0.03618;
    let mounted = ground * (setup.mount)(mount);
    let at = bag.start_ns.unwrap_or_default();
    for (parent, name, pose) in [
        (child.as_str(), "os_sensor", mounted),
        ("os_sensor", "os_lidar", lidar_in_sensor),
    ] {
        let sample = TfSample {
            at: message("/tf_static", at),
            pose: Pose {
                translation_m: pose.translation.vector.into(),
                rotation_xyzw: slots(pose.rotation),
            },
        };
        bag.tf
            .push(TfEdge::once(FrameId::new(parent), FrameId::new(name), sample));
    }
    bag.tf
        .sort_by(|a, b| (&a.child, &a.parent, &a.topic).cmp(&(&b.child, &b.parent, &b.topic)));
    true
}

/// z of `base_footprint` in a base that is tied to it, metres; else 0.
fn footprint(world: &World, stream: &Stream, base: &str) -> f64 {
    let is = |frame: &FrameId, name: &str| frame.canonical().as_str() == name;
    let is_footprint = |frame: &FrameId| frame.canonical().as_str().ends_with("footprint");
    let edges = world.bags[stream.bag].tf.iter().filter(|edge| !edge.samples.is_empty());
    let mut found = edges.filter_map(|edge| {
        let z = edge.samples[0].pose.translation_m[2];
        if is(&edge.child, base) && is_footprint(&edge.parent) {
            Some(-z)
        } else {
            (is(&edge.parent, base) && is_footprint(&edge.child)).then_some(z)
        }
    });
    found.next().unwrap_or(0.0)
}

fn rays(
    stream: &Stream,
    way: &PathSection,
    ground: &Isometry3<f64>,
    mount: &Isometry3<f64>,
    lidar: &Lidar,
) -> Rc<Vec<Vec<Ray>>> {
    let scanner = lidar.scanner();
    let key = format!("{} {} {scanner:?}", stream.bag, name(stream));
    let kept = KEPT.with_borrow(|kept| kept.clone().filter(|(of, _)| *of == key));
    if let Some((_, rays)) = kept {
        return rays;
    }
    let of_ground = |t_s: f64| way.at(t_s) * ground;
    let places: Vec<Vector3<f64>> = way
        .poses
        .iter()
        .map(|(_, pose)| (pose * ground).translation.vector)
        .collect();
    let scene = Scene::along(&places, SEED, lidar.surroundings, scanner.reach_m);
    let end_s = way.poses.last().map_or(0.0, |(at, _)| *at);
    let count = ((end_s - scanner.period_s) * SCANS_HZ).floor().max(1.0) as u32;
    let scan = |number: u32| cast(&of_ground, SEED, &scene, &scanner, mount, f64::from(number) / SCANS_HZ);
    let rays = Rc::new((0..count).map(scan).collect::<Vec<_>>());
    KEPT.with_borrow_mut(|kept| *kept = Some((key, Rc::clone(&rays))));
    rays
}
