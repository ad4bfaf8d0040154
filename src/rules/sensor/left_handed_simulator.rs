//! SENSOR09: poses of a simulator whose world is left-handed.

use crate::analysis::axes::{causes::Base, gyro_vs_track, hand, handedness, sensors::Sensors};
use crate::analysis::motion::{BagMotion, Imu, Motion, Stream, Track};
use crate::rules::prelude::*;
use crate::tables::Simulator;
use crate::world::motion::{FixRow, PoseRow};

pub(crate) struct LeftHandedSimulator;

/// One measurement of the handedness of a track.
struct Handedness {
    is_left_handed: bool,
    words: String,
    /// What the track was compared with.
    place: Place,
    measured: Measured,
}

impl Rule for LeftHandedSimulator {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _: &NoLimits, out: &mut Judge) {
        let tracks = world.limits::<handedness::Limits>();
        let turns = world.limits::<gyro_vs_track::Limits>();
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (index, bag) in motion.bags.iter().enumerate() {
            let Some(simulator) = &bag.simulator else { continue };
            // Only an upright gyro shows the handedness of the track.
            let placed = bag.imus.iter().zip(sensors.of_bag(index));
            let upright = placed.filter(|(_, sensor)| sensor.stands() == Some(Base::Up));
            let imus: Vec<&Imu> = upright.map(|(imu, _)| imu).collect();
            let of_world = bag.poses.iter().filter(|poses| poses.is_of_world());
            for poses in of_world.filter(|poses| !poses.is_earth_centred()) {
                let track = poses.track();
                let mut handed = by_satellites(world, bag, &track, &tracks);
                handed.extend(by_gyros(&imus, &track, &turns));
                judge_track(poses, simulator, handed, out);
            }
        }
    }
}

fn by_satellites(world: &Estimates, bag: &BagMotion, track: &Track, limits: &handedness::Limits) -> Vec<Handedness> {
    let measure = |fixes: &Stream<FixRow>| {
        let hand = hand::hand(world, fixes, track, limits)?;
        Some(Handedness {
            is_left_handed: hand.is_mirrored,
            words: format!("the poses are a mirror image of the GNSS track on `{}`", fixes.topic),
            place: fixes.place(),
            measured: hand.measured,
        })
    };
    bag.fixes.iter().filter_map(measure).collect()
}

fn by_gyros(imus: &[&Imu], track: &Track, limits: &gyro_vs_track::Limits) -> Vec<Handedness> {
    let measure = |imu: &&Imu| {
        let gain = gyro_vs_track::gain(imu, track, limits)?;
        Some(Handedness {
            is_left_handed: gain < 0.0,
            words: format!(
                "the yaw rate of `{}`, whose z points up, is {gain:.2} times the turn rate of the poses, expected +1",
                imu.stream.topic
            ),
            place: imu.stream.place(),
            measured: Measured::new(
                format!("yaw rate of `{}` / turn rate of the poses", imu.stream.topic),
                gain,
                "1",
            ),
        })
    };
    imus.iter().filter_map(measure).collect()
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
        .detail(format!(
            "Evidence: {}. The axes of {} are {}.",
            words.join("; "),
            simulator.name,
            simulator.axes
        ))
        .help(format!(
            "convert the poses to ROS with the values of {}: {}",
            simulator.name, simulator.conversion
        ));
    let mut finding = poses.expressed_in.annotate(finding);
    for one in left {
        finding = finding
            .related(one.place, "compared with this motion")
            .measured(one.measured);
    }
    out.fail(finding);
}
