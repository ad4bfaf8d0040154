//! How often the rules of motion, and those of what lidars see, are right, wrong and silent, on drives whose truth is known.
//!
//! ```text
//! cargo test --profile rates --test rates -- --ignored --nocapture
//! ```
//!
//! prints the table. `RATES_SEEDS` is how many seeds there are of each line (200), `RATES_FROM` the first of them (1001: limits
//! were looked for on lower ones), `RATES_ONLY` words of the groups, rules, drives and faults that are tried, with commas
//! between them (all), and with `+` between those that must all be there; with `RATES_WHY` some reasons of what was not
//! evaluated follow. A finding is right when it names the fault, alone or among those that it says fit as well; another rule
//! may have it, where the rule says so. The table's references are simulations that others made of such rules, with vehicles
//! and sensors like these.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    unreachable_pub,
    missing_docs
)]

#[path = "../support/mod.rs"]
mod support;

mod answers;
mod cloud_lines;
mod cloud_scenes;
mod cloud_worlds;
mod drives;
mod faults;
mod frame_lines;
mod frame_worlds;
mod lines;
mod place_lines;
mod table;

use std::ops::Range;

use drives::{Kind, base_from_imu};
use faults::Fault;
use frames_lint::world::motion::MotionEvidence;
use frames_lint::world::motion::Series;
use support::drive::description::{Gnss, Grade, Motion, Vehicle};

fn rated(seeds: Range<u64>, only: &[String]) {
    let mut table = lines::table();
    table.only(only);
    table.fill(seeds);
    println!("{}", table.print());
    if std::env::var_os("RATES_WHY").is_some() {
        println!("{}", table.reasons());
    }
    let faults = [table.faults(), table.silent].concat();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
#[ignore = "some minutes, in a release build"]
fn the_rules_reach_their_rates() {
    let number = |name: &str, default: u64| std::env::var(name).map_or(default, |seeds| seeds.parse().unwrap());
    let (from, seeds) = (number("RATES_FROM", 1001), number("RATES_SEEDS", 200));
    let only = std::env::var("RATES_ONLY").unwrap_or_default();
    let only: Vec<String> = only
        .split(',')
        .filter(|word| !word.is_empty())
        .map(str::to_owned)
        .collect();
    rated(from..from + seeds, &only);
}

#[test]
fn a_small_part_of_the_table_is_right() {
    rated(1..2, &["Short".to_owned()]);
}

/// What is judged here is what a recording of the same messages gives.
#[test]
fn worlds_made_in_memory_are_those_of_recordings() {
    let kind = Kind {
        vehicle: Vehicle::Car,
        motion: Motion::Turning,
        seconds: 3,
        imu: Grade::Mems,
        gnss: Gnss::Single,
    };
    let recipe = "
        duration_s: 3
        drive: {vehicle: car, motion: turning, seed: 3, imu: mems, gnss: single}
        topics:
          - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu_link, xyz: [0.1, 0.05, 0.3], rpy_deg: [0, 0, -90], errors: [ned_frd]}
          - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
          - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps, xyz: [-0.1, 0, 0.8], stamp_offset_s: -0.1, late_s: 0.1}
    ";
    let read = support::evidence(recipe);
    let made = kind.messages(3).world(Fault::Imu("NED/FRD"));
    assert!((base_from_imu(3).rotation.euler_angles().2 + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    for topic in ["/imu", "/odom"] {
        let [read, made] = [&read, &made.bags[0]].map(|bag| &bag.topics[topic]);
        assert_eq!(
            read.header_frames.keys().collect::<Vec<_>>(),
            made.header_frames.keys().collect::<Vec<_>>()
        );
        assert_eq!(
            read.child_frames.keys().collect::<Vec<_>>(),
            made.child_frames.keys().collect::<Vec<_>>()
        );
        let [read, made] = [read, made].map(|topic| numbers(&topic.content.motion));
        same(topic, &read, &made);
    }
    // Fixes of a recording are late by what they lag; their rows are of the same form.
    let [read, made] = [&read, &made.bags[0]].map(|bag| bag.topics["/fix"].content.motion.fixes.clone().unwrap());
    assert_eq!(read.count, made.count);
    let delays = |series: &frames_lint::world::motion::Series<frames_lint::world::motion::FixRow>| -> Vec<i64> {
        series.rows().map(|row| row.log_ns - row.stamp_ns).collect()
    };
    assert_eq!(delays(&read), delays(&made));
    let [read, made] = [&read, &made].map(|series| *series.rows().next().unwrap());
    assert_eq!((read.variance_m2, read.status), (made.variance_m2, made.status));
}

/// So are transforms that move, poses, and what is counted of inertial messages.
#[test]
fn frames_made_in_memory_are_those_of_recordings() {
    let kind = Kind {
        vehicle: Vehicle::Robot,
        motion: Motion::Turning,
        seconds: 3,
        imu: Grade::Mems,
        gnss: Gnss::Single,
    };
    let recipe = "
        duration_s: 3
        drive: {vehicle: robot, motion: turning, seed: 4, imu: mems, gnss: single}
        topics:
          - {topic: /tf, rate_hz: 20, transforms: [{parent: map, child: odom}, {parent: odom, child: base_link, from_drive: odometry}]}
          - {topic: /pose, from_drive: pose, rate_hz: 20, frame_id: map}
          - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu_link, xyz: [0.1, 0.05, 0.3]}
          - {topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 10, frame_id: lidar}
    ";
    let read = support::evidence(recipe);
    let messages = kind.messages(4);
    let made = [
        Fault::FrameWorld("stand-in"),
        Fault::FrameWorld("poses"),
        Fault::Healthy,
        Fault::FrameWorld("lidar"),
    ];
    let made = made.map(|fault| messages.world(fault).bags[0].clone());
    let poses = |rows: &Series<frames_lint::world::motion::PoseRow>| -> Vec<f64> {
        let of = |row: &frames_lint::world::motion::PoseRow| [&row.position[..], &row.orientation].concat();
        rows.rows().flat_map(of).collect()
    };
    for child in ["odom", "base_link"] {
        let [read, made] =
            [&read, &made[0]].map(|bag| bag.tf.iter().find(|edge| edge.child.as_str() == child).unwrap());
        assert_eq!(
            (read.count, read.is_static, &read.topic),
            (made.count, made.is_static, &made.topic)
        );
        let change = |edge: &frames_lint::world::bag::TfEdge| edge.extreme.as_ref().map(|(_, rad, m)| [*rad, *m]);
        same(
            child,
            &change(read).unwrap_or_default(),
            &change(made).unwrap_or_default(),
        );
        let [read, made] = [read, made].map(|edge| edge.motion.as_ref().map_or_else(Vec::new, poses));
        same(child, &read, &made);
    }
    let [told, of_memory] =
        [&read, &made[1]].map(|bag| poses(bag.topics["/pose"].content.motion.poses.as_ref().unwrap()));
    same("/pose", &told, &of_memory);
    let [told, of_memory] = [&read, &made[2]].map(|bag| bag.topics["/imu"].content.imu.clone().unwrap());
    let counts =
        |imu: &frames_lint::world::content::ImuEvidence| [imu.count, imu.identity, imu.zero, imu.same_as_first];
    assert_eq!(counts(&told), counts(&of_memory));
    let turning = |imu: &frames_lint::world::content::ImuEvidence| [imu.angular_velocity_rms, imu.turned_rad];
    same("/imu", &turning(&told), &turning(&of_memory));
    let [told, of_memory] = [&read.topics["/points"], &made[3].topics["/livox/lidar"]];
    assert_eq!(told.message_type, of_memory.message_type);
    assert!(told.count > 0 && of_memory.count > 0);
}

/// Whether a recording and what was made in memory have the same numbers.
fn same(what: &str, read: &[f64], made: &[f64]) {
    assert_eq!(read.len(), made.len(), "{what}");
    for (read, made) in read.iter().zip(made) {
        assert!((read - made).abs() < 1e-9, "{what}: {read} and {made}");
    }
}

/// All numbers of the rows of a stream, times among them.
fn numbers(motion: &MotionEvidence) -> Vec<f64> {
    let inertial = motion.inertial.iter().flat_map(Series::rows);
    let inertial = inertial.flat_map(|row| {
        let [a, b] = [row.stamp_ns, row.log_ns].map(|ns| (ns - support::driven_world::START_NS) as f64);
        [
            &[a, b][..],
            &row.orientation,
            &row.angular_velocity,
            &row.linear_acceleration,
        ]
        .concat()
    });
    let poses = motion.poses.iter().flat_map(Series::rows);
    let poses = poses.flat_map(|row| {
        let [a, b] = [row.stamp_ns, row.log_ns].map(|ns| (ns - support::driven_world::START_NS) as f64);
        let twist = row.twist.unwrap();
        [
            &[a, b][..],
            &row.position,
            &row.orientation,
            &twist.linear,
            &twist.angular,
        ]
        .concat()
    });
    inertial.chain(poses).collect()
}
