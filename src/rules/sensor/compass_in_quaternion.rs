//! SENSOR08: a compass heading in the yaw of a quaternion.

mod clockwise;

use crate::advice::diagnosis::defer;
use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{Compass, Imu, Motion, Stream, Tracks, Yaws};
use crate::analysis::sensor::yaw_zero::{Limits, YawZero, by_compass, by_track};
use crate::analysis::{axes::worlds::Worlds, motion::mount::mount};
use crate::math::{level::level, readings::Reading};
use crate::rules::prelude::*;
use crate::world::World;
use crate::world::motion::{OrientationRow, PoseRow, Row};

pub(crate) struct CompassInQuaternion;

/// What a yaw can be compared with, and the limits.
struct YawReferences<'a> {
    compasses: &'a [Compass],
    tracks: &'a Tracks,
    turns: &'a crate::analysis::axes::heading::Limits,
    limits: &'a Limits,
}

impl Rule for CompassInQuaternion {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let turns = world.limits::<crate::analysis::axes::heading::Limits>();
        let (motion, sensors, worlds) = (Motion::of(world), Sensors::of(world), Worlds::of(world));
        for (index, bag) in motion.bags.iter().enumerate() {
            let tracks = bag.tracks(|frame| worlds.is_off(index, frame));
            let compasses = bag.compasses();
            let against = YawReferences {
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

/// Whether a stream is of poses that form a track; the turning of odometry is judged by AXES08.
fn is_way(stream: &Stream<PoseRow>) -> bool {
    let has_twist = stream.rows().any(|timed| timed.row.twist.is_some());
    stream.child.is_none() && !has_twist && stream.is_of_world() && !stream.is_earth_centred()
}

impl YawReferences<'_> {
    fn by_compasses(&self, yaws: &Yaws, needs_turn: bool) -> Option<YawZero> {
        let mut all = self.compasses.iter();
        all.find_map(|compass| by_compass(yaws, compass, needs_turn, self.turns, self.limits))
    }

    fn judge_orientation(&self, world: &World, stream: &Stream<OrientationRow>, out: &mut Judge) {
        let subject = format!("yaw of {}", stream.subject);
        let mounted = stream.frame.as_ref().and_then(|frame| mount(world, frame));
        let base_from_sensor = mounted.map(|mount| mount.base_from_sensor.rotation);
        let yaws = Yaws::of(stream, &base_from_sensor.unwrap_or_default());
        let by_tracks = || {
            let mut tracks = self.tracks.asked.iter();
            tracks.find_map(|track| by_track(&yaws, track, track.is_geodetic, self.turns))
        };
        match self.by_compasses(&yaws, false).or_else(by_tracks) {
            Some(found) if found.is_clockwise => out.fail(found.finding(stream, &subject, self.turns, self.limits)),
            Some(found) => out.pass(subject, found.measured(self.turns)),
            None => out.too_little(subject, self.tracks.why(self.undecided())),
        }
    }

    /// AXES04 compares the yaw of inertial sensors with the course; here it is compared with headings of other devices.
    fn judge_imu(&self, imu: &Imu, sensor: &Sensor, out: &mut Judge) {
        let subject = format!("yaw of {}", imu.stream.subject);
        if let Some(why) = imu.no_orientation {
            return out.not_applicable(subject, why);
        }
        if self.compasses.is_empty() {
            return out.missing(
                subject,
                "no other device states a heading: record the NMEA sentences of a receiver or compass",
            );
        }
        // The zero of a yaw that is integrated from a gyro is arbitrary.
        let yaws = Yaws::of(&imu.stream, &imu.base_from_imu());
        let Some(found) = self.by_compasses(&yaws, true) else {
            return out.too_little(subject, self.undecided());
        };
        if !found.is_clockwise {
            return out.pass(subject, found.measured(self.turns));
        }
        let better = |finding| defer(&sensor.diagnosis, imu, None, finding);
        self.fail_known(&imu.stream, subject, &found, better, out);
    }

    /// Poses have their own track: yaw and position are in one frame, wherever its zero is.
    fn judge_pose(&self, stream: &Stream<PoseRow>, out: &mut Judge) {
        let subject = format!("yaw of {}", stream.subject);
        let straight = nalgebra::UnitQuaternion::identity();
        let slots = stream.rows().map(|timed| timed.row.orientation);
        let tilt_deg = level(slots, &straight, Reading::Xyzw).map_or(0.0, |level| level.tilt_rad.to_degrees());
        if tilt_deg > self.limits.max_tilt_deg {
            let why = format!("it is tilted by {tilt_deg:.0} deg from z of its frame, so its yaw is not defined");
            return out.not_applicable(subject, why);
        }
        let yaws = Yaws::of(stream, &straight);
        match by_track(&yaws, &stream.track(), true, self.turns) {
            Some(found) if found.is_clockwise => self.fail_known(stream, subject, &found, |finding| finding, out),
            Some(found) => out.pass(subject, found.measured(self.turns)),
            None => out.too_little(subject, self.undecided()),
        }
    }

    /// A yaw that grows clockwise, where its zero is that of a known convention.
    fn fail_known<R: Row>(
        &self,
        stream: &Stream<R>,
        subject: String,
        found: &YawZero,
        better: impl FnOnce(Finding) -> Finding,
        out: &mut Judge,
    ) {
        match found.stray(self.limits) {
            Some(why) => out.too_little(subject, why),
            None => out.fail(better(found.finding(stream, &subject, self.turns, self.limits))),
        }
    }

    fn undecided(&self) -> String {
        format!(
            "no heading and no course overlaps it long enough, turns by {} deg, and clearly shows the direction of the yaw",
            self.turns.min_turn_deg
        )
    }
}
