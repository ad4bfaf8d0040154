//! Every known mistake is shown by some rule, on data that are good enough: one that no rule could ever show does not belong into the catalogue.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;

use frames_lint::assure::{TrialOutcome, assure};
use frames_lint::engine::Rules;
use frames_lint::faults::{Selection, catalogue};
use frames_lint::progress::Progress;
use frames_lint::rules::RULES;
use frames_lint::world::World;

use crate::faults_motion::{DRIVE, collected};
use crate::faults_placed::{Platform, platform};

/// What these drives do not show, and why: of each the rules say so themselves.
const UNSHOWN: &[(&str, &str)] = &[
    (
        "imu-sides",
        "to the course the sensor looks mounted otherwise: on real recordings AXES04 names it",
    ),
    ("imu-gyro-x-negated", "needs rotation about more axes"),
    ("imu-gyro-y-negated", "needs rotation about more axes"),
    (
        "imu-accel-y-negated",
        "no rule holds the lateral acceleration against the speed and the yaw rate",
    ),
    ("imu-covariance-degrees", "these covariances do not change"),
    ("imu-covariance-deviations", "these covariances do not change"),
    ("pose-covariance-in-body", "this noise has no direction"),
    ("pose-utm-grid", "needs poses over 200 m"),
    ("pose-altitude-as-z", "needs poses far from the origin"),
    ("pose-correction-held", "needs a longer drive"),
    ("fix-radians", "needs a track with more turns"),
    ("fix-origin-moved", "no file states an origin"),
    ("fix-origin-swapped", "no file states an origin"),
];

#[test]
fn the_rules_that_should_see_a_mistake_exist() {
    for fault in catalogue() {
        for seer in fault.seen_by.codes() {
            assert!(
                RULES.iter().any(|rule| rule.code.as_str() == seer),
                "{}: {seer}",
                fault.name
            );
        }
    }
}

/// A platform with left and right parts, and with a camera whose delay two files state.
fn with_sides() -> World {
    let folder = tempfile::tempdir().unwrap();
    let mut urdf = "<robot name=\"rover\">\n<link name=\"base_link\"/>\n".to_owned();
    for (part, xyz) in [
        ("front_left_bumper", "0.5 0.3 0.2"),
        ("front_right_bumper", "0.5 -0.3 0.2"),
        ("rear_left_bumper", "-0.5 0.3 0.2"),
        ("rear_right_bumper", "-0.5 -0.3 0.2"),
    ] {
        let _ = writeln!(
            urdf,
            "<link name=\"{part}\"/>\n<joint name=\"{part}_joint\" type=\"fixed\">\
             <parent link=\"base_link\"/><child link=\"{part}\"/><origin xyz=\"{xyz}\"/></joint>"
        );
    }
    fs::write(folder.path().join("rover.urdf"), urdf + "</robot>\n").unwrap();
    let kalibr = "cam0:\n  camera_model: pinhole\n  timeshift_cam_imu: 0.0187\n";
    fs::write(folder.path().join("camchain-imucam.yaml"), kalibr).unwrap();
    fs::write(folder.path().join("vins.yaml"), "imu: 1\nestimate_td: 0\ntd: 0.0187\n").unwrap();
    platform(folder.path())
}

#[test]
fn every_mistake_is_shown_by_some_rule() {
    let rules = Rules::select(&[]).unwrap();
    let selection = Selection {
        faults: catalogue().collect(),
        ..Selection::default()
    };
    let worlds = [
        collected(DRIVE, None),
        collected(&DRIVE.replace("vehicle: car", "vehicle: drone"), None),
        Platform::healthy(30).world(),
        with_sides(),
    ];
    let mut best: BTreeMap<&str, (TrialOutcome, String)> = BTreeMap::new();
    for world in &worlds {
        for trial in assure(world, &rules, &selection, &Progress::new(false)).trials {
            let why = trial.miss.map_or_else(|| trial.rules.join(", "), |miss| miss.reason);
            let one = (trial.outcome, why);
            let known = best.entry(trial.fault.name).or_insert_with(|| one.clone());
            *known = one.max(known.clone());
        }
    }
    let mut unshown = Vec::new();
    for fault in catalogue() {
        let is_excused = UNSHOWN.iter().any(|(name, _)| *name == fault.name);
        let is_shown = best
            .get(fault.name)
            .is_some_and(|(outcome, _)| *outcome > TrialOutcome::Missed);
        if is_shown == is_excused {
            unshown.push(format!("{}: {:?}", fault.name, best.get(fault.name)));
        }
    }
    assert!(unshown.is_empty(), "{}:\n{}", unshown.len(), unshown.join("\n"));
}
