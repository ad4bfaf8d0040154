//! Yaw rate and speed of the platform over time by each stream of a recording, as plain signals.
//!
//! Every rate has the time of the middle of its interval, so that no signal is delayed by its computation. Must not compare.

use nalgebra::{UnitQuaternion, Vector3};

use crate::analysis::Estimates;
use crate::analysis::lidar::Clouds;
use crate::analysis::motion::clock::Clock;
use crate::analysis::motion::{BagMotion, Course, Imu, Stream, TimedRow, Track};
use crate::analysis::names;
use crate::analysis::scan_motion::Steps;
use crate::analysis::time::header::points_after_header_s;
use crate::math::{circular::wrapped, readings::Reading, stats::median};
use crate::source::Place;
use crate::world::{FrameId, motion::Row};

/// Runs of `(seconds after the recording's start, value)` without a hole.
pub(crate) type Runs = Vec<Vec<(f64, f64)>>;

/// Shortest and longest step between two orientations that a rate is taken over, seconds.
const STEP_S: std::ops::RangeInclusive<f64> = 0.005..=0.5;
/// A faster turn is a jump of an estimate, rad/s.
const MAX_RATE_RAD_S: f64 = 10.0;
/// Slower, a course is noise, m/s.
const MIN_COURSE_SPEED_M_S: f64 = 2.0;
/// The mean specific force is gravity where it is at least this share of the median one: else the sensor has no gravity in it.
const GRAVITY_SHARE: f64 = 0.5;

/// What a signal is made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The gyro of an inertial sensor.
    Gyro,
    /// The orientation in the same messages.
    Orientation,
    /// Odometry, a pose or a transform.
    Pose,
    /// A velocity on a topic of its own.
    Twist,
    /// GNSS fixes.
    Fix,
    /// Scans of a lidar matched to each other.
    Scan,
}

/// One signal.
pub(crate) struct Signal {
    pub(crate) kind: Kind,
    /// `topic /odom`, `orientation of topic /imu`.
    pub(crate) subject: String,
    /// The stream it is made from, as [`Stream::subject`].
    pub(crate) stream: String,
    /// The frame that poses are of.
    pub(crate) body: Option<FrameId>,
    /// The frame that it measures the motion of: of poses the same, of sensors their own.
    pub(crate) moving: Option<FrameId>,
    /// Yaw rate, rad/s.
    pub(crate) yaw_rate: Runs,
    /// Speed, m/s; of poses and fixes.
    pub(crate) speed: Runs,
    /// Median of stamp minus log time, seconds; `None` where its times are log times.
    pub(crate) stamp_offset_s: Option<f64>,
    /// Median step between two rows, seconds.
    pub(crate) period_s: f64,
    /// Time that may lie between the stamp and the measurement of a message without a fault, seconds.
    pub(crate) within_s: f64,
    pub(crate) place: Place,
}

/// The signals of a recording: gyros first, then poses, orientations, velocities, fixes.
pub(crate) fn signals(bag: &BagMotion) -> Vec<Signal> {
    let gyros = bag.imus.iter().map(|imu| Signal {
        moving: imu.stream.frame.clone(),
        ..made(Kind::Gyro, &imu.stream, gyro(imu), None)
    });
    let poses = bag.poses.iter().filter(|stream| stream.is_way()).map(|stream| {
        let turns = orientations(stream, |row| row.orientation);
        Signal {
            body: stream.child.clone(),
            moving: stream.child.clone(),
            ..made(Kind::Pose, stream, turns, Some(&stream.track()))
        }
    });
    let filtered = bag.imus.iter().filter(|imu| imu.no_orientation.is_none());
    let filtered = filtered.map(|imu| Signal {
        subject: format!("orientation of {}", imu.stream.subject),
        moving: imu.stream.frame.clone(),
        ..made(
            Kind::Orientation,
            &imu.stream,
            orientations(&imu.stream, |row| row.orientation),
            None,
        )
    });
    let twists = bag.twists.iter().filter(|stream| !names::is_wish(&stream.topic));
    let twists = twists.map(|stream| {
        let turns = runs(stream, |timed| timed.row.twist.angular[2]);
        made(Kind::Twist, stream, turns, None)
    });
    let fixes = bag.fixes.iter().map(|stream| {
        let track = stream.track();
        let turns = turning(&track.courses(MIN_COURSE_SPEED_M_S));
        made(Kind::Fix, stream, turns, Some(&track))
    });
    gyros.chain(poses).chain(filtered).chain(twists).chain(fixes).collect()
}

/// Shortest time between two scans of a rate, seconds: over one step at 40 Hz it is noise.
const SCAN_STEP_S: f64 = 0.09;

/// The signal of a lidar by its own scans: the rate about the level z of its clouds, at the time of their middle.
pub(crate) fn scanned(world: &Estimates, clouds: &Clouds, steps: &Steps) -> Signal {
    let runs = clouds.evidence.runs.iter();
    let times = runs.map(|run| {
        run.iter()
            .map(|slice| (slice.stamp_ns.unwrap_or_default(), slice.log_ns))
    });
    let stamp_offset_s = Clock::of_times(times).stamp_offset_s();
    let period_s = clouds.period_s().unwrap_or(f64::NAN);
    let middle_s = middle_after_header_s(world, clouds).filter(|middle_s| middle_s.abs() < period_s);
    let moved = steps.chained(|moved| moved.lasted_s() >= SCAN_STEP_S);
    let rates = moved.iter().map(|moved| {
        let [from_s, to_s] = [moved.from, moved.to].map(|moment| moment.on(stamp_offset_s));
        let t_s = f64::midpoint(from_s, to_s) + middle_s.unwrap_or_default();
        (t_s, moved.turned_rad() / moved.lasted_s())
    });
    let subject = format!("topic `{}`", clouds.topic.topic);
    Signal {
        kind: Kind::Scan,
        stream: subject.clone(),
        subject,
        body: None,
        moving: clouds.frame(),
        yaw_rate: vec![rates.collect()],
        speed: Runs::default(),
        stamp_offset_s,
        period_s,
        // The stamp is that of the first point, of the last, or of one between them.
        within_s: middle_s.map_or(period_s / 2.0, |_| 0.0),
        place: clouds.place(),
    }
}

/// From the stamp of the header to the middle of the scan, seconds: the median over the clouds.
fn middle_after_header_s(world: &Estimates, clouds: &Clouds) -> Option<f64> {
    let limits = world.limits();
    let middles = clouds.timed().filter_map(|(sample, times)| {
        let [first_s, last_s] = points_after_header_s(clouds, sample, times, &limits)?;
        Some(f64::midpoint(first_s, last_s))
    });
    median(&middles.collect::<Vec<f64>>())
}

fn made<R: Row>(kind: Kind, stream: &Stream<R>, yaw_rate: Runs, track: Option<&Track>) -> Signal {
    let steps = stream.stretches.iter().flat_map(|rows| rows.windows(2));
    let steps: Vec<f64> = steps
        .filter_map(|pair| match pair {
            [a, b] => Some(b.t_s - a.t_s),
            _ => None,
        })
        .collect();
    let period_s = median(&steps).unwrap_or(f64::NAN);
    let speeds = track.map(|track| track.courses(0.0)).unwrap_or_default();
    let speed = |run: &Vec<Course>| run.iter().map(|course| (course.t_s, course.speed_m_s)).collect();
    Signal {
        kind,
        subject: stream.subject.clone(),
        stream: stream.subject.clone(),
        body: None,
        moving: None,
        yaw_rate,
        speed: speeds.iter().map(speed).collect(),
        stamp_offset_s: stream.stamp_offset_s,
        period_s,
        // Receivers compute for a while.
        within_s: if kind == Kind::Fix { period_s } else { 0.0 },
        place: stream.place(),
    }
}

fn runs<R>(stream: &Stream<R>, value: impl Fn(&TimedRow<R>) -> f64) -> Runs {
    let of = |rows: &Vec<TimedRow<R>>| rows.iter().map(|timed| (timed.t_s, value(timed))).collect();
    stream.stretches.iter().map(of).collect()
}

/// The rate about up by the sensor's own acceleration; about z of its base, where that contains no gravity.
fn gyro(imu: &Imu) -> Runs {
    let rows = imu.stream.rows();
    let forces = rows.map(|timed| Vector3::from(timed.row.linear_acceleration));
    let forces: Vec<Vector3<f64>> = forces.filter(|force| force.norm().is_finite()).collect();
    let lengths: Vec<f64> = forces.iter().map(Vector3::norm).collect();
    let mean = forces.iter().sum::<Vector3<f64>>() / forces.len().max(1) as f64;
    let is_gravity = median(&lengths).is_some_and(|length| length > 0.0 && mean.norm() > GRAVITY_SHARE * length);
    let up = if is_gravity {
        mean.normalize()
    } else {
        imu.base_from_imu().inverse() * Vector3::z()
    };
    runs(&imu.stream, |timed| Vector3::from(timed.row.angular_velocity).dot(&up))
}

/// The rate about z of the world from one orientation to the next.
fn orientations<R: Row>(stream: &Stream<R>, slots: impl Fn(&R) -> [f64; 4]) -> Runs {
    let turn = |pair: &[TimedRow<R>]| {
        let [a, b] = pair else { return None };
        let of =
            |timed: &TimedRow<R>| -> Option<UnitQuaternion<f64>> { Reading::Xyzw.world_from_body(slots(&timed.row)) };
        let (from, to) = (of(a)?, of(b)?);
        let step_s = b.t_s - a.t_s;
        let rate = (to * from.inverse()).scaled_axis().z / step_s;
        let is_sound = STEP_S.contains(&step_s) && rate.abs() <= MAX_RATE_RAD_S;
        // Not a number: a cut.
        Some((f64::midpoint(a.t_s, b.t_s), if is_sound { rate } else { f64::NAN }))
    };
    let of = |rows: &Vec<TimedRow<R>>| rows.windows(2).filter_map(turn).collect();
    stream.stretches.iter().map(of).collect()
}

/// The turning of a course.
fn turning(courses: &[Vec<Course>]) -> Runs {
    let turn = |pair: &[Course]| {
        let [a, b] = pair else { return None };
        let rate = wrapped(b.angle_rad - a.angle_rad) / (b.t_s - a.t_s);
        Some((f64::midpoint(a.t_s, b.t_s), rate))
    };
    courses
        .iter()
        .map(|run| run.windows(2).filter_map(turn).collect())
        .collect()
}
