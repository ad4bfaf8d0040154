//! Mistakes in the stamps of messages.

use std::sync::Arc;

use crate::faults::mountings::is_of_a_sensor;
use crate::faults::{Change, Subject, SubjectPlace};
use crate::source::MessageRef;
use crate::tables::leap_seconds;
use crate::world::World;
use crate::world::bag::{StampEvidence, TopicEvidence};
use crate::world::content::{ContentEvidence, StepEvidence};
use crate::world::motion::{MotionEvidence, Series};

/// The GPS epoch after the Unix epoch, seconds.
const GPS_EPOCH_S: f64 = 315_964_800.0;
const NS_PER_S: f64 = 1e9;

/// A mistake in the stamps of a topic.
pub(in crate::faults) enum StampChange {
    /// GPS time in place of UTC.
    GpsTime,
    /// TAI in place of UTC.
    Tai,
    /// GPS time since the GPS epoch, as if that were the Unix epoch.
    GpsEpoch,
    /// This many seconds more.
    Ahead(f64),
    /// The same, for what shows small offsets: motion and scans.
    Offset(f64),
    /// Stamped on arrival, this many seconds after the measurement.
    OnArrival(f64),
    /// Not filled in.
    Zero,
}

impl Change for StampChange {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let bags = world.bags.iter().enumerate();
        let topics = bags.flat_map(|(bag, evidence)| evidence.topics.values().map(move |topic| (bag, topic)));
        topics
            .filter(|(_, topic)| self.applies_to(topic))
            .map(|(bag, topic)| Subject::of_topic(bag, topic))
            .collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Topic { bag, topic } = &subject.at else {
            return false;
        };
        let topic = world.bags.get_mut(*bag).and_then(|bag| bag.topics.get_mut(topic));
        let Some(topic) = topic.filter(|topic| self.applies_to(topic)) else {
            return false;
        };
        let log_s = topic.first_log_ns.unwrap_or_default() as f64 / NS_PER_S;
        let leap = leap_seconds();
        match self {
            Self::GpsTime => shift(topic, leap.gps_minus_utc_s(log_s), 0.0),
            Self::Tai => shift(topic, leap.tai_minus_utc_s(log_s), 0.0),
            Self::GpsEpoch => shift(topic, leap.gps_minus_utc_s(log_s) - GPS_EPOCH_S, 0.0),
            Self::Ahead(seconds) | Self::Offset(seconds) => shift(topic, *seconds, 0.0),
            Self::OnArrival(seconds) => shift(topic, *seconds, *seconds),
            Self::Zero => clear(topic),
        }
        true
    }
}

impl StampChange {
    /// Whether a topic has stamps that are not zero, and what shows the mistake: an offset of less than a second shows in motion only.
    fn applies_to(&self, topic: &TopicEvidence) -> bool {
        let is_small = match self {
            Self::Ahead(seconds) => seconds.abs() < 1.0,
            Self::OnArrival(_) | Self::Offset(_) => true,
            Self::GpsTime | Self::Tai | Self::GpsEpoch | Self::Zero => false,
        };
        // A clock that counts from a start has no epoch and no time scale.
        let needs_calendar = matches!(self, Self::GpsTime | Self::Tai | Self::GpsEpoch);
        let is_calendar = |stamp_ns: i64| stamp_ns as f64 >= GPS_EPOCH_S * NS_PER_S;
        let first = topic.stamps.samples.first();
        let has_clock = !needs_calendar || first.is_some_and(|(stamp_ns, _)| is_calendar(*stamp_ns));
        let has_stamps = topic.stamps.count > topic.stamps.zero && has_clock;
        let shows_it = if is_small {
            has_scans(topic)
        } else {
            is_of_a_sensor(topic)
        };
        has_stamps && (has_motion(topic) || shows_it)
    }
}

/// Whether neighbouring scans of a topic are kept, whose motion shows when they were measured.
fn has_scans(topic: &TopicEvidence) -> bool {
    let clouds = topic.content.clouds.as_ref();
    let has_runs = clouds.is_some_and(|clouds| !clouds.runs.is_empty()) && topic.content.radar.is_none();
    has_runs || topic.content.lasers.is_some()
}

/// Whether a topic has rows of motion.
fn has_motion(topic: &TopicEvidence) -> bool {
    topic.contents().any(|said| {
        let MotionEvidence {
            inertial,
            poses,
            twists,
            fixes,
            orientations,
            vectors: _,
            nmea: _,
        } = &said.content.motion;
        inertial.is_some() || poses.is_some() || twists.is_some() || fixes.is_some() || orientations.is_some()
    })
}

/// Changes both times of every row: stamp and log time, nanoseconds.
macro_rules! each_row {
    ($motion:expr, $change:expr, [$($series:ident),*]) => {
        $(for row in $motion.$series.iter_mut().flat_map(rows) {
            $change(&mut row.stamp_ns, &mut row.log_ns);
        })*
    };
}

fn rows<T>(series: &mut Series<T>) -> impl Iterator<Item = &mut T> {
    series.stretches.iter_mut().flatten()
}

/// Changes stamp and log time wherever a topic's evidence has them.
fn change_times(topic: &mut TopicEvidence, change: impl Fn(&mut i64, &mut i64)) {
    let members = topic.members.values_mut();
    let mut frames: Vec<&mut MessageRef> = Vec::new();
    let mut contents: Vec<&mut ContentEvidence> = vec![Arc::make_mut(&mut topic.content)];
    for member in members {
        contents.push(Arc::make_mut(&mut member.content));
        let used = member
            .header_frames
            .values_mut()
            .chain(member.child_frames.values_mut());
        frames.extend(used.map(|used| &mut used.first));
        frames.extend(&mut member.first);
    }
    for content in contents {
        each_row!(
            content.motion,
            change,
            [inertial, poses, twists, fixes, orientations, vectors, nmea]
        );
        change_sweeps(content, &change);
    }
    let used = topic.header_frames.values_mut().chain(topic.child_frames.values_mut());
    frames.extend(used.map(|used| &mut used.first));
    let StampEvidence {
        samples,
        first_zero,
        largest_backward,
        first_repeated,
        largest_gap,
        first,
        last,
        ..
    } = &mut topic.stamps;
    for (stamp_ns, log_ns) in samples {
        change(stamp_ns, log_ns);
    }
    let with_steps = [largest_backward, largest_gap].into_iter().flatten();
    frames.extend(with_steps.map(|(_, at)| at));
    frames.extend([first_zero, first_repeated, first, last].into_iter().flatten());
    for at in frames {
        if let Some(stamp_ns) = &mut at.stamp_ns {
            change(stamp_ns, &mut at.log_ns);
        }
    }
}

/// Changes stamp and log time of what is kept of clouds and of scans of a radar.
fn change_sweeps(content: &mut ContentEvidence, change: impl Fn(&mut i64, &mut i64)) {
    let lasers = content.lasers.iter_mut().map(|laser| &mut laser.projected);
    let clouds = content.clouds.iter_mut().chain(lasers);
    let slices = clouds.flat_map(|clouds| clouds.runs.iter_mut().flatten());
    let slices = slices.map(|slice| (&mut slice.stamp_ns, &mut slice.log_ns));
    let radars = content.radar.iter_mut();
    let sweeps = radars.flat_map(|radar| radar.runs.iter_mut().flatten());
    let sweeps = sweeps.map(|sweep| (&mut sweep.stamp_ns, &mut sweep.log_ns));
    for (stamp, log_ns) in slices.chain(sweeps) {
        let mut stamp_ns = stamp.unwrap_or_default();
        change(&mut stamp_ns, log_ns);
        *stamp = stamp.is_some().then_some(stamp_ns).filter(|stamp_ns| *stamp_ns != 0);
    }
    let samples = content.clouds.iter_mut().flat_map(|clouds| &mut clouds.samples);
    for at in samples.map(|sample| &mut sample.at) {
        if let Some(stamp_ns) = &mut at.stamp_ns {
            change(stamp_ns, &mut at.log_ns);
        }
    }
}

/// Nanoseconds.
fn nanoseconds(seconds: f64) -> i64 {
    #[allow(
        clippy::cast_possible_truncation,
        reason = "the offsets of this file are below 292 years"
    )]
    let whole = (seconds * NS_PER_S).round() as i64;
    whole
}

/// Shifts stamps that are not zero, and log times, seconds.
fn shift(topic: &mut TopicEvidence, stamps_s: f64, logs_s: f64) {
    let (stamps_ns, logs_ns) = (nanoseconds(stamps_s), nanoseconds(logs_s));
    change_times(topic, |stamp_ns, log_ns| {
        if *stamp_ns != 0 {
            *stamp_ns = stamp_ns.saturating_add(stamps_ns);
        }
        *log_ns = log_ns.saturating_add(logs_ns);
    });
    for log_ns in [&mut topic.first_log_ns, &mut topic.last_log_ns].into_iter().flatten() {
        *log_ns = log_ns.saturating_add(logs_ns);
    }
}

/// Makes every stamp zero.
fn clear(topic: &mut TopicEvidence) {
    change_times(topic, |stamp_ns, _| *stamp_ns = 0);
    let stamps = &mut topic.stamps;
    stamps.zero = stamps.count;
    stamps.first_zero = stamps.first.clone();
    (stamps.backward, stamps.repeated, stamps.long_gaps) = (0, 0, 0);
    (stamps.largest_backward, stamps.largest_gap) = (None, None);
    (stamps.first_repeated, stamps.median_step_ns) = (None, None);
    // Steps between messages without a stamp are not taken.
    for content in topic.contents_mut() {
        if let Some(imu) = &mut content.imu {
            imu.turned_rad = 0.0;
        }
        if let Some(odometry) = &mut content.odometry {
            odometry.steps = StepEvidence::default();
        }
    }
}
