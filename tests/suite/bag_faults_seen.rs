//! The same for what shows only in what sensors measure: one healthy drive of a car, and the faults that people suffer from, one at a
//! time: each is found by the rule it belongs to, and by no other than those named here. The healthy one is silent.

use crate::bag_faults::{DriveFault, check, describe, each_is_found};
use frames_lint::run::FailOn;

/// Half a minute in streets: odometry, fixes, an inertial sensor, and a lidar on the roof.
const HEALTHY: &str = "\
duration_s: 30
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_footprint, child: base_link}
      - {parent: base_link, child: imu_link, xyz: [0.1, 0.05, 0.3]}
      - {parent: base_link, child: gps, xyz: [-0.1, 0, 0.8]}
      - {parent: base_link, child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]}
  - topic: /tf
    rate_hz: 20
    transforms:
      - {parent: odom, child: base_footprint, from_drive: odometry}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_footprint}
  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps, xyz: [-0.1, 0, 0.8], stamp_offset_s: -0.1, late_s: 0.1}
  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu_link, xyz: [0.1, 0.05, 0.3]}
  - {topic: /points, from_drive: lidar, rate_hz: 10, frame_id: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30], lidar: {driver: velodyne, table: vlp16, beams: 16, columns: 360}}
";

const FAULTS: &[DriveFault] = &[
    (
        "gravity -9.81: the accelerometer of a NED convention",
        [
            "xyz: [0.1, 0.05, 0.3]}\n  - {topic: /points",
            "xyz: [0.1, 0.05, 0.3], errors: [gravity_sign]}\n  - {topic: /points",
        ],
        &["AXES01 error /imu gravity-sign"],
    ),
    (
        "accelerations in g",
        [
            "xyz: [0.1, 0.05, 0.3]}\n  - {topic: /points",
            "xyz: [0.1, 0.05, 0.3], errors: [g]}\n  - {topic: /points",
        ],
        &["AXES02 error /imu"],
    ),
    (
        "gyro in degrees a second",
        [
            "xyz: [0.1, 0.05, 0.3]}\n  - {topic: /points",
            "xyz: [0.1, 0.05, 0.3], errors: [deg_s]}\n  - {topic: /points",
        ],
        &["AXES02 error /imu"],
    ),
    (
        "the lidar turned by 180 deg, and nothing else tells it",
        [
            "child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]",
            "child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, -150]",
        ],
        &["AXES12 error /points z180"],
    ),
    (
        "the ground above the lidar: its z points down",
        [
            "frame_id: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]",
            "frame_id: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [180, 0, 30]",
        ],
        &["AXES10 error /points x180"],
    ),
    (
        "the cloud mirrored",
        ["table: vlp16", "mirrored: true, table: vlp16"],
        &["AXES11 error /points mirrored"],
    ),
];

#[test]
fn every_fault_of_a_drive_is_found_by_its_rule_and_by_no_other() {
    each_is_found(HEALTHY, FAULTS);
}

#[test]
fn the_healthy_drive_is_silent() {
    let (_folder, run) = check(HEALTHY, false);
    let said: Vec<String> = run.verdict.findings.iter().map(describe).collect();
    assert!(said.is_empty(), "{said:?}");
    assert_eq!(run.exit_code(FailOn::Note), 0);
    for rule in [
        "AXES01", "AXES09", "AXES10", "AXES11", "AXES12", "CROSS04", "TIME05", "TIME07",
    ] {
        let passes = run
            .verdict
            .rows
            .iter()
            .any(|row| row.rule == rule && row.outcome.word() == "pass");
        assert!(passes, "{rule} judged nothing");
    }
}
