//! SENSOR09: poses of a simulator whose world is left-handed.

use crate::analysis::motion::{BagMotion, Imu, Motion, Stream, Track};
use crate::analysis::{axes::causes::Base, axes::sensors::Sensors};
use crate::rules::prelude::*;
use crate::tables::Simulator;
use crate::world::motion::{FixRow, PoseRow};

pub(crate) struct LeftHandedSimulator;

/// One measurement of the handedness of a track.
struct Handedness {
    is_left_handed: bool,
    words: String,
    measured: Measured,
}

impl Rule for LeftHandedSimulator {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _: &NoLimits, out: &mut Judge) {
        let (tracks, turns) = (
            world.limits::<crate::analysis::axes::handedness::Limits>(),
            world.limits::<crate::analysis::axes::gyro_vs_track::Limits>(),
        );
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (index, bag) in motion.bags.iter().enumerate() {
            let Some(simulator) = &bag.simulator else { continue };
            // Only an upright gyro shows the handedness of the track.
            let upright = bag
                .imus
                .iter()
                .zip(sensors.of_bag(index))
                .filter(|(_, sensor)| sensor.stands() == Some(Base::Up));
            let imus: Vec<&Imu> = upright.map(|(imu, _)| imu).collect();
            for poses in bag
                .poses
                .iter()
                .filter(|poses| poses.is_of_world() && !poses.is_earth_centred())
            {
                let track = poses.track();
                let handed = by_satellites(bag, &track, &tracks)
                    .into_iter()
                    .chain(by_gyros(&imus, &track, &turns))
                    .collect();
                judge_track(poses, simulator, handed, out);
            }
        }
    }
}

fn by_satellites(
    bag: &BagMotion,
    track: &Track,
    limits: &crate::analysis::axes::handedness::Limits,
) -> Vec<Handedness> {
    let handedness = |fixes: &Stream<FixRow>| {
        let hand = crate::analysis::axes::hand::hand(fixes, track, limits)?;
        Some(Handedness {
            is_left_handed: hand.is_mirrored,
            words: format!("the poses mirror the GNSS track on `{}`", fixes.topic),
            measured: hand.measured,
        })
    };
    bag.fixes.iter().filter_map(handedness).collect()
}

fn by_gyros(imus: &[&Imu], track: &Track, limits: &crate::analysis::axes::gyro_vs_track::Limits) -> Vec<Handedness> {
    let handedness = |imu: &&Imu| {
        let gain = crate::analysis::axes::gyro_vs_track::gain(imu, track, limits)?;
        Some(Handedness {
            is_left_handed: gain < 0.0,
            words: format!("the upright gyro of `{}` turns the opposite way", imu.stream.topic),
            measured: Measured::new("yaw rate of the gyro / turn rate of the course", gain, "1"),
        })
    };
    imus.iter().filter_map(handedness).collect()
}

fn judge_track(poses: &Stream<PoseRow>, simulator: &Simulator, handed: Vec<Handedness>, out: &mut Judge) {
    let subject = format!("{} ({})", poses.subject, simulator.name);
    if handed.is_empty() {
        let why = "neither GNSS fixes nor an upright gyro show its handedness, or it does not turn enough";
        return out.too_little(subject, why);
    }
    let (left, right): (Vec<Handedness>, Vec<Handedness>) = handed.into_iter().partition(|one| one.is_left_handed);
    if left.is_empty() {
        return out.pass(subject, right.into_iter().map(|one| one.measured));
    }
    if !right.is_empty() {
        let why = format!(
            "only {} of {} measurements show that it is left-handed",
            left.len(),
            left.len() + right.len()
        );
        return out.too_little(subject, why);
    }
    let words: Vec<&str> = left.iter().map(|one| one.words.as_str()).collect();
    let message = format!("`{}`: the poses are left-handed, as in {}", poses.topic, simulator.name);
    let finding = Finding::error(subject, message, poses.place())
        .likely()
        .relation("left-handed")
        .detail(format!("Evidence: {}.", words.join("; ")))
        .help(format!(
            "convert the poses to ROS: {}. {} is {}",
            simulator.conversion, simulator.name, simulator.axes
        ));
    let finding = poses.expressed_in.annotate(finding);
    out.fail(finding.measured(left.into_iter().map(|one| one.measured)));
}
