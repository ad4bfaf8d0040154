//! SENSOR08: a compass heading in the yaw of a quaternion.

use serde::Deserialize;

use crate::rules::axes::heading_convention::{self, HeadingConvention};
use crate::rules::axes::sensors::{Sensor, Sensors};
use crate::rules::axes::worlds::Worlds;
use crate::rules::motion::{Compass, Imu, Motion, Stream, Track, Yaws, mount};
use crate::rules::{Evidence, Judge, Need, Rule, names};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;
use crate::world::motion::{OrientationRow, PoseRow};

use super::yaw_zero::{Found, by_compass, by_track};

/// SENSOR08.
pub struct CompassInQuaternion;

/// Limits of SENSOR08.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    pub(super) min_samples: usize,
    pub(super) same_deg: f64,
    pub(super) apart_deg: f64,
    max_offset_deg: f64,
}

/// What a yaw can be held against, and the limits.
struct Against<'a> {
    compasses: &'a [Compass],
    tracks: &'a [Track],
    turns: &'a heading_convention::Limits,
    limits: &'a Limits,
}

impl Rule for CompassInQuaternion {
    const PAGE: &'static str = include_str!("../../../rules/sensor/compass-in-quaternion.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let Some(turns) = crate::rules::limits_of::<HeadingConvention>() else {
            return;
        };
        let (motion, sensors, worlds) = (Motion::of(world), Sensors::of(world), Worlds::of(world));
        for (index, bag) in motion.bags.iter().enumerate() {
            let tracks = bag.tracks(|frame| worlds.is_down(index, frame));
            let compasses = bag.compasses();
            let against = Against {
                compasses: &compasses,
                tracks: &tracks,
                turns: &turns,
                limits,
            };
            for stream in &bag.orientations {
                against.judge_orientation(world, stream, out);
            }
            for (imu, sensor) in bag.imus.iter().zip(sensors.of_bag(index)) {
                against.judge_imu(imu, sensor, out);
            }
            for stream in bag.poses.iter().filter(|stream| is_way(stream)) {
                against.judge_pose(stream, out);
            }
        }
    }
}

/// Whether a stream is of poses on a topic that tell a way; of odometry AXES08 judges the turning.
fn is_way(stream: &Stream<PoseRow>) -> bool {
    let has_twist = stream.rows().any(|timed| timed.row.twist.is_some());
    stream.child.is_none() && !has_twist && stream.frame.as_ref().is_none_or(names::is_world)
}

impl Against<'_> {
    fn by_compasses(&self, yaws: &Yaws, needs_turn: bool) -> Option<Found> {
        let mut all = self.compasses.iter();
        all.find_map(|compass| by_compass(yaws, compass, needs_turn, self.turns, self.limits))
    }

    fn judge_orientation(&self, world: &World, stream: &Stream<OrientationRow>, out: &mut Judge) {
        let subject = format!("yaw of {}", stream.subject);
        let mounted = stream.frame.as_ref().and_then(|frame| mount(world, frame));
        let base_from_sensor = mounted.map(|mount| mount.base_from_sensor.rotation);
        let yaws = Yaws::of(stream, &base_from_sensor.unwrap_or_default());
        let by_tracks = || {
            let mut tracks = self.tracks.iter();
            tracks.find_map(|track| by_track(&yaws, track, track.is_geodetic, self.turns))
        };
        match self.by_compasses(&yaws, false).or_else(by_tracks) {
            Some(found) if found.is_clockwise => out.fail(self.finding(stream, &subject, &found)),
            Some(found) => out.pass(subject, self.measured(&found)),
            None => self.undecided(subject, out),
        }
    }

    /// Of inertial sensors AXES04 holds the yaw against the course; here it is held against what other devices state.
    fn judge_imu(&self, imu: &Imu, sensor: &Sensor, out: &mut Judge) {
        let subject = format!("yaw of {}", imu.stream.subject);
        if let Some(why) = imu.no_orientation {
            return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
        }
        if self.compasses.is_empty() {
            let why = "no other device states a heading; AXES04 holds it against the course";
            return out.not_evaluated(subject, NotEvaluated::MissingInput, why);
        }
        // Where the zero of a gyro's yaw lies is chance.
        let yaws = Yaws::of(&imu.stream, &imu.base_from_imu());
        let Some(found) = self.by_compasses(&yaws, true) else {
            return self.undecided(subject, out);
        };
        if !found.is_clockwise {
            return out.pass(subject, self.measured(&found));
        }
        let seen = format!("the yaw grows with the {}", found.other);
        match sensor.diagnosis.reported_elsewhere("SENSOR08", &seen) {
            Some(why) => out.not_evaluated(subject, NotEvaluated::NotApplicable, why),
            None => out.fail(self.finding(&imu.stream, &subject, &found)),
        }
    }

    /// Poses tell their own way: yaw and position stand in one frame, wherever its zero is.
    fn judge_pose(&self, stream: &Stream<PoseRow>, out: &mut Judge) {
        let subject = format!("yaw of {}", stream.subject);
        let yaws = Yaws::of(stream, &nalgebra::UnitQuaternion::identity());
        match by_track(&yaws, &Track::of_poses(stream), true, self.turns) {
            Some(found) if found.is_clockwise => out.fail(self.finding(stream, &subject, &found)),
            Some(found) => out.pass(subject, self.measured(&found)),
            None => self.undecided(subject, out),
        }
    }

    fn undecided(&self, subject: String, out: &mut Judge) {
        let why = format!(
            "no heading from north and no course goes with it long enough, turns by {} deg, and follows it clearly one way",
            self.turns.min_turn_deg
        );
        out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
    }

    fn measured(&self, found: &Found) -> Vec<Measured> {
        let samples = found.samples as u64;
        let [best, other] = found.resultants;
        let mut measured = vec![
            Measured::new("resultant of the better sense", best, "1")
                .limit(self.turns.min_resultant)
                .samples(samples),
            Measured::new("resultant of the other sense", other, "1").samples(samples),
        ];
        let zero = found.zero_rad.map(f64::to_degrees);
        let what = if found.is_clockwise {
            "yaw minus compass heading"
        } else {
            "yaw minus pi/2 - heading"
        };
        measured.extend(zero.map(|zero| Measured::new(what, zero, "deg").samples(samples)));
        measured
    }

    fn finding<R: crate::world::motion::Row>(&self, stream: &Stream<R>, subject: &str, found: &Found) -> Finding {
        let zero = found.zero_rad.map(f64::to_degrees);
        let (relation, what) = match zero {
            Some(zero) if zero.abs() <= self.limits.max_offset_deg => (
                "compass-yaw",
                format!("it is a compass heading, clockwise from north, off by {zero:.1} deg"),
            ),
            Some(zero) if (zero + 90.0).abs() <= self.limits.max_offset_deg => (
                "clockwise-yaw",
                "it counts from east as REP-103 does, but clockwise: the quaternion is the inverse one, or its yaw is negated"
                    .to_owned(),
            ),
            Some(zero) => ("clockwise-yaw", format!("its zero is {zero:.0} deg from north")),
            None => ("clockwise-yaw", "where its zero is cannot be told from that".to_owned()),
        };
        let message = format!(
            "the yaw of `{}` grows clockwise with {}: {what} ({} samples)",
            stream.topic, found.other, found.samples
        );
        let finding = Finding::error(subject, message, stream.place())
            .likely()
            .relation(relation)
            .related(found.other_at.clone(), "what it was held against")
            .help(
                "REP-103 counts yaw counter-clockwise from east: publish `yaw_ros = pi/2 - heading` (the topic `heading` of \
                 nmea_navsat_driver holds the compass heading itself)",
            );
        let finding = stream.told_in.tell(finding);
        self.measured(found).into_iter().fold(finding, Finding::measured)
    }
}
