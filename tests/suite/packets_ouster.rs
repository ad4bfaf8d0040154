//! Drives of a car with an Ouster that is recorded as packets, with its metadata: the faults that people suffer from are named by the rules that
//! name them for clouds. Where the mounting of the sensor is wrong, that of its IMU is, too; a clock that runs backwards shifts the scans. The healthy one is
//! silent.

use crate::bag_faults::{DriveFault, check, describe, each_is_found};
use crate::support::clouds::Lidar;
use crate::support::packets_ouster::{SERIAL, metadata};
use frames_lint::run::FailOn;

/// Half a minute in streets: odometry, and the packets of a lidar on the roof with its inertial sensor. The origin of the lidar is 36.18 mm above
/// that of the sensor.
const DRIVE: &str = "\
duration_s: 30
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_footprint, child: base_link}
      - {parent: base_link, child: os_sensor, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]}
      - {parent: os_sensor, child: os_lidar, xyz: [0, 0, 0.03618], rpy_deg: [0, 0, 180]}
      - {parent: os_sensor, child: os_imu, xyz: [0.006253, -0.011775, 0.007645]}
  - topic: /tf
    rate_hz: 20
    transforms:
      - {parent: odom, child: base_footprint, from_drive: odometry}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_footprint}
  - {topic: /ouster/metadata, text: 'METADATA', latched: true}
  - {topic: /ouster/imu_packets, from_drive: ouster_imu, rate_hz: 100, xyz: [0.6113, 0.0929, 1.8076], rpy_deg: [0, 0, 30]}
  - {topic: /ouster/lidar_packets, from_drive: lidar, rate_hz: 10, xyz: [0.6, 0.1, 1.83618], rpy_deg: [0, 0, 30], lidar: {driver: ouster_packets, beams: 16, columns: 256}}
";

const FAULTS: &[DriveFault] = &[
    (
        "the lidar mounted upside down",
        [
            "xyz: [0.6, 0.1, 1.83618], rpy_deg: [0, 0, 30]",
            "xyz: [0.6, 0.1, 1.83618], rpy_deg: [180, 0, 30]",
        ],
        &["AXES10 error /ouster/lidar_packets x180"],
    ),
    (
        "a quarter turn of the mounting",
        [
            "child: os_sensor, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]",
            "child: os_sensor, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 120]",
        ],
        &[
            "AXES12 error /ouster/lidar_packets z-90",
            "AXES06 warning /ouster/imu_packets turned-mount",
        ],
    ),
    (
        "the mounting of os_lidar given to os_sensor",
        [
            "child: os_sensor, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]",
            "child: os_sensor, xyz: [0.6, 0.1, 1.83618], rpy_deg: [0, 0, -150]",
        ],
        &[
            "SENSOR03 error /ouster/lidar_packets z180-extra",
            "AXES06 warning /ouster/imu_packets turned-mount",
        ],
    ),
    (
        "y mirrored",
        ["beams: 16", "beams: 16, mirrored: true"],
        &["AXES11 error /ouster/lidar_packets mirrored"],
    ),
    (
        "the clock of the sensor backwards",
        ["beams: 16", "beams: 16, times: reversed"],
        &[
            "TIME07 warning /ouster/lidar_packets times-reversed",
            "TIME09 warning /ouster/lidar_packets",
        ],
    ),
];

fn healthy() -> String {
    let lidar = Lidar {
        beams: 16,
        columns: 256,
        ..Lidar::default()
    };
    // Where the beams of this model begin: 4 mm of height at most, which the rays of the simulation do not have.
    let stated = "\"beam_to_lidar_transform\":[1.0,0.0,0.0,";
    let told = metadata(&lidar.scanner(), SERIAL).replace(&format!("{stated}0.0"), &format!("{stated}15.806"));
    DRIVE.replace("METADATA", &told)
}

#[test]
fn every_fault_of_an_ousters_packets_is_found_by_the_rule_for_clouds() {
    each_is_found(&healthy(), FAULTS);
}

#[test]
fn the_healthy_drive_of_an_ousters_packets_is_silent() {
    let (_folder, run) = check(&healthy(), false);
    let said: Vec<String> = run.verdict.findings.iter().map(describe).collect();
    assert!(said.is_empty(), "{said:?}");
    assert_eq!(run.exit_code(FailOn::Note), 0);
    let judged = |rule: &str, topic: &str| {
        let mut rows = run.verdict.rows.iter();
        rows.any(|row| row.rule == rule && row.outcome.word() == "pass" && row.subject.contains(topic))
    };
    for rule in ["AXES09", "AXES10", "AXES11", "AXES12", "CROSS04", "TIME07"] {
        assert!(
            judged(rule, "/ouster/lidar_packets"),
            "{rule} judged nothing: {:#?}",
            run.verdict
                .rows
                .iter()
                .filter(|row| row.rule == rule)
                .collect::<Vec<_>>()
        );
    }
}
