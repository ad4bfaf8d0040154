//! Lines of the rules on what lidars see: AXES09 to AXES12, TIME05 to TIME08, SENSOR01, SENSOR02, PREC01, CROSS04 and CROSS05.
//!
//! The names of their groups begin with `Clouds`.

use crate::cloud_scenes::{DIRECTION, HAND, OUSTER, SEEN, UP};
use crate::drives::Kind;
use crate::faults::Fault;
use crate::support::drive::description::{Gnss, Grade, Motion, Vehicle};
use crate::table::{ALL, AnswerKey, Reference, Table};

/// How many trials of each line the simulations have.
const S5: u32 = 90;
const S6: u32 = 24;
const S7: u32 = 20;
const S9: u32 = 100;

const CAR: Kind = Kind {
    vehicle: Vehicle::Car,
    motion: Motion::Turning,
    seconds: 30,
    imu: Grade::Tactical,
    gnss: Gnss::Rtk,
};

const SHORT: Kind = Kind { seconds: 3, ..CAR };

const ROBOT: Kind = Kind {
    vehicle: Vehicle::Robot,
    imu: Grade::Mems,
    ..CAR
};

/// Lines of a simulation: kinds of drives and worlds with the share that was right in it.
type SimulatedLine = (Kind, &'static [&'static str], f64, &'static str);

/// Every line.
pub fn lines(table: &mut Table) {
    let straight = Kind {
        motion: Motion::Straight,
        ..CAR
    };
    let still = Kind {
        motion: Motion::Still,
        ..SHORT
    };
    for is_long in [true, false] {
        let (group, kind) = if is_long {
            ("Clouds, turning", CAR)
        } else {
            ("Clouds, short", SHORT)
        };
        for seen in SEEN.iter().filter(|seen| seen.is_long == is_long) {
            ask(table, group, kind, seen.name);
        }
    }
    for name in ["clouds", "y negated", "mounting lacks 180 deg", "mounting inverse"] {
        ask(table, "Clouds, robot", ROBOT, name);
        ask(table, "Clouds, straight", straight, name);
    }
    for name in ["clouds in a warehouse", "clouds in a garage"] {
        ask(table, "Clouds, robot", ROBOT, name);
    }
    for name in ["clouds, short", "no times", "z down", "Lidar fr. as os_sensor"] {
        ask(table, "Clouds, still", still, name);
    }
    simulations(table);
}

/// The rules of a world, and all together.
fn ask(table: &mut Table, group: &'static str, kind: Kind, name: &'static str) {
    let seen = crate::cloud_worlds::world_named(name);
    for (rule, subject) in seen.asked.iter().chain([&(ALL, "")]) {
        table.ask(
            kind,
            &AnswerKey {
                group,
                rule,
                subject,
                fault: Fault::Cloud(seen.name),
                called: None,
                pooled: false,
                reference: None,
            },
        );
    }
}

fn simulations(table: &mut Table) {
    let of = |motion: Motion, seconds: u32| Kind { motion, seconds, ..CAR };
    let ups = [
        (
            SHORT,
            &["clouds, short", "z down", "z forward"][..],
            0.94,
            ".94 of one cloud",
        ),
        (
            SHORT,
            &["warehouse", "warehouse, z down", "warehouse, z forward"],
            0.0,
            ".38 of one cloud, .01 wrong",
        ),
        (SHORT, &["garage", "garage, z down", "garage, z forward"], 0.0, "0"),
    ];
    simulated(table, "Clouds: S5 up axis (AXES10)", UP, S5, &ups);
    let mirrors = &["clouds", "y negated", "x, y swapped", "z negated"][..];
    let hands = [
        // In 3 s runs of 16 clouds have nine of its ten pairs.
        (of(Motion::Turning, 4), mirrors, 0.38, ".38-.58"),
        (of(Motion::Turning, 9), mirrors, 0.67, ".67-.71"),
        (of(Motion::Turning, 30), mirrors, 0.88, ".88-.96"),
        (of(Motion::Straight, 30), &mirrors[..2], 0.0, "0 (not evaluated)"),
    ];
    simulated(table, "Clouds: S6 mirror (AXES11)", HAND, S6, &hands);
    let frames = [(
        SHORT,
        &[
            "Sensor frame",
            "Sensor frame, destaggered, lost",
            "Sensor frame, window",
            "Sensor frame, filtered",
            "Sensor fr. as os_lidar",
            "Lidar fr. as os_sensor",
            "Lidar fr. as os_sensor, destaggered, lost",
            "Lidar fr. as os_sensor, window",
            "Lidar fr. as os_sensor, filtered",
        ][..],
        1.0,
        "1.00",
    )];
    simulated(table, "Clouds: S7 Ouster's frames (SENSOR01)", OUSTER, S7, &frames);
    let window = [(SHORT, &["Sensor frame, filtered, window"][..], 0.0, "0 (not evaluated)")];
    simulated(table, "Clouds: S7 Ouster's frames (SENSOR01)", OUSTER, S7, &window);
    let directions = [
        (
            of(Motion::Turning, 30),
            &["clouds in a street", "mounting inverse in a street"][..],
            0.98,
            ".98-1.00",
        ),
        (
            of(Motion::Turning, 30),
            &["clouds, yaw 180 deg", "mounting inverse, yaw 180 deg"],
            0.0,
            "not evaluated: nearly equal",
        ),
    ];
    simulated(table, "Clouds: S9 direction (CROSS04)", DIRECTION, S9, &directions);
}

fn simulated(
    table: &mut Table,
    group: &'static str,
    (rule, subject): (&'static str, &'static str),
    trials: u32,
    lines: &[SimulatedLine],
) {
    for (kind, worlds, right, words) in lines {
        for name in *worlds {
            table.ask(
                *kind,
                &AnswerKey {
                    group,
                    rule,
                    subject,
                    fault: Fault::Cloud(name),
                    called: None,
                    pooled: false,
                    reference: Some(Reference {
                        right: *right,
                        trials,
                        words,
                    }),
                },
            );
        }
    }
}
