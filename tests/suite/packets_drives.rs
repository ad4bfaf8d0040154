//! Drives of a car whose lidar is recorded as packets: the faults that people suffer from are named by the rules that name them for clouds of
//! its driver (`bag_faults_seen`), and by no other. The healthy one is silent.

use crate::bag_faults::{DriveFault, check, describe, each_is_found};
use frames_lint::run::FailOn;

/// Half a minute in streets: odometry, an inertial sensor, and the packets of a lidar on the roof.
const HEALTHY: &str = "\
duration_s: 30
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_footprint, child: base_link}
      - {parent: base_link, child: imu_link, xyz: [0.1, 0.05, 0.3]}
      - {parent: base_link, child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]}
  - topic: /tf
    rate_hz: 20
    transforms:
      - {parent: odom, child: base_footprint, from_drive: odometry}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_footprint}
  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu_link, xyz: [0.1, 0.05, 0.3]}
  - {topic: /velodyne_packets, from_drive: lidar, rate_hz: 10, frame_id: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30], lidar: {driver: velodyne_packets, table: vlp16, columns: 360}}
";

const FAULTS: &[DriveFault] = &[
    (
        "the lidar mounted upside down",
        [
            "frame_id: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]",
            "frame_id: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [180, 0, 30]",
        ],
        &["AXES10 error /velodyne_packets x180"],
    ),
    (
        "a quarter turn of the mounting",
        [
            "child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]",
            "child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 120]",
        ],
        &["SENSOR04 error /velodyne_packets z-90"],
    ),
    (
        "half a turn of the mounting",
        [
            "child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]",
            "child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, -150]",
        ],
        &["AXES12 error /velodyne_packets z180"],
    ),
    (
        "y mirrored",
        ["table: vlp16", "mirrored: true, table: vlp16"],
        &["AXES11 error /velodyne_packets mirrored"],
    ),
    (
        "the clock of the sensor backwards",
        ["table: vlp16", "times: reversed, table: vlp16"],
        &["TIME07 warning /velodyne_packets times-reversed"],
    ),
];

#[test]
fn every_fault_of_packets_is_found_by_the_rule_for_clouds() {
    each_is_found(HEALTHY, FAULTS);
}

#[test]
fn the_healthy_drive_of_packets_is_silent() {
    let (_folder, run) = check(HEALTHY, false);
    let said: Vec<String> = run.verdict.findings.iter().map(describe).collect();
    assert!(said.is_empty(), "{said:?}");
    assert_eq!(run.exit_code(FailOn::Note), 0);
    let judged = |rule: &str| {
        let mut rows = run.verdict.rows.iter();
        rows.any(|row| row.rule == rule && row.outcome.word() == "pass" && row.subject.contains("/velodyne_packets"))
    };
    for rule in ["AXES09", "AXES10", "AXES11", "AXES12", "CROSS04", "TIME07"] {
        assert!(judged(rule), "{rule} judged nothing");
    }
    // What a driver publishes is not judged where none did.
    for rule in ["PREC01", "PREC02", "PREC03", "TIME05", "TIME06", "TIME08"] {
        assert!(!judged(rule), "{rule} judged a cloud that no driver published");
    }
}

#[test]
fn a_lidar_with_packets_and_clouds_has_one_finding() {
    let packets = HEALTHY.lines().last().unwrap_or_default();
    let clouds = packets
        .replace("/velodyne_packets", "/points")
        .replace("velodyne_packets", "velodyne");
    let (from, to) = (
        "child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]",
        "child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, -150]",
    );
    let (_folder, run) = check(&format!("{HEALTHY}{clouds}\n").replace(from, to), false);
    let found: Vec<String> = run.verdict.findings.iter().map(describe).collect();
    assert_eq!(found, ["AXES12 error /points z180"]);
}
