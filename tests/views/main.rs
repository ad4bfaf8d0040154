//! Views as they are written for the viewer: read back with the viewer's own library, of the same version.
//!
//! Needs Python with `rerun-sdk`: `FRAMES_LINT_PYTHON` names it, else `target/ci-python/bin/python`. Without it the tests are noted as
//! left out.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

mod pictures;
#[path = "../support/mod.rs"]
mod support;

/// The version of the viewer's library that the program is built with.
const VERSION: &str = "0.36.3";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frames-lint"))
        .args(arguments)
        .current_dir(root())
        .output()
        .unwrap()
}

fn python() -> Option<PathBuf> {
    let named = std::env::var_os("FRAMES_LINT_PYTHON").map(PathBuf::from);
    let python = named.unwrap_or_else(|| root().join("target/ci-python/bin/python"));
    let known = Command::new(&python).args(["-c", "import rerun.experimental"]).output();
    known.is_ok_and(|known| known.status.success()).then_some(python)
}

/// What a file of views holds; `None` where there is nothing to read it with.
fn read(file: &Path) -> Option<Value> {
    let Some(python) = python() else {
        support::left_out(&format!("no Python with rerun-sdk {VERSION}"));
        return None;
    };
    let read = Command::new(python)
        .arg(root().join("tests/views/read.py"))
        .arg(file)
        .env("RERUN_ANALYTICS", "0")
        .output()
        .unwrap();
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    let held: Value = serde_json::from_slice(&read.stdout).unwrap();
    assert_eq!(held["version"], VERSION);
    Some(held["entities"].clone())
}

/// The views of a folder with this recipe, and the program's answer.
fn views(folder: &Path, arguments: &[&str]) -> (Output, PathBuf) {
    let file = folder.join("out.rrd");
    let (path, out) = (folder.to_string_lossy(), file.to_string_lossy());
    let ran = program(&[&["view", &*path, "-o", &*out], arguments].concat());
    (ran, file)
}

fn has(entity: &Value, component: &str) -> bool {
    entity["components"]
        .as_array()
        .is_some_and(|all| all.iter().any(|one| one == component))
}

#[test]
fn frames_of_files_are_static_and_stand_where_they_are_stated() {
    let folder = tempfile::tempdir().unwrap();
    for file in ["car.urdf", "lidar.yaml"] {
        std::fs::copy(
            root().join("fixtures/first-finding").join(file),
            folder.path().join(file),
        )
        .unwrap();
    }
    let (ran, file) = views(folder.path(), &[]);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let Some(held) = read(&file) else { return };
    let lidar = &held["/world/base_link/lidar"];
    assert_eq!(lidar["static"], true);
    assert!(
        has(lidar, "Transform3D:translation") && has(lidar, "TransformAxes3D:axis_length"),
        "{lidar}"
    );
    let at: Vec<f64> = lidar["last"]["Transform3D:translation"][0]
        .as_array()
        .unwrap()
        .iter()
        .map(|value| value.as_f64().unwrap())
        .collect();
    let run = support::checked(folder.path());
    let stated = run.worlds[0]
        .claims
        .iter()
        .find(|claim| claim.label.contains("lidar"))
        .unwrap();
    let stated = stated.pose.as_ref().unwrap().translation_m;
    assert!(
        at.iter().zip(stated).all(|(seen, right)| (seen - right).abs() < 1e-6),
        "{at:?} {stated:?}"
    );
    // What the other source says, what the rule would have, the finding in the log and at the frame.
    for entity in [
        "/world/base_link/lidar\\ by\\ lidar.yaml",
        "/world/base_link/lidar\\ as\\ CROSS02\\ corrects\\ it",
        "/world/base_link/lidar/finding\\ 1",
        "/findings/log/1\\ CROSS02",
        "/findings/page",
    ] {
        assert!(
            !held[entity].is_null(),
            "{entity}: {:#?}",
            held.as_object().unwrap().keys().collect::<Vec<_>>()
        );
    }
    let line = held["/findings/log/1\\ CROSS02"]["last"]["TextLog:text"].to_string();
    assert!(line.contains("extrinsic-relation"), "{line}");
}

/// A car that drives for ten seconds, with transforms that are told twenty times a second.
const DRIVE: &str = "\
duration_s: 10
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: imu, xyz: [0.42, 0.11, 0.27]}
  - topic: /tf
    rate_hz: 20
    transforms:
      - {parent: odom, child: base_link, velocity: [3, 0, 0], yaw_rate_deg_s: 4}
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 50, frame_id: imu}
";

#[test]
fn what_moves_has_a_row_for_each_moment_on_the_timeline_of_stamps() {
    let folder = tempfile::tempdir().unwrap();
    support::write(DRIVE, &folder.path().join("drive.mcap"));
    let (ran, file) = views(folder.path(), &[]);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let Some(held) = read(&file) else { return };
    let base = &held["/world/odom/base_link"];
    assert_eq!(base["timelines"], serde_json::json!(["stamp"]), "{base}");
    // One row for each of 201 transforms, and a static one with axes and a label.
    let rows = base["rows"].as_u64().unwrap();
    assert!((200..=210).contains(&rows), "{rows}");
    let at = base["last"]["Transform3D:translation"][0].as_array().unwrap();
    let way = at
        .iter()
        .map(|value| value.as_f64().unwrap().powi(2))
        .sum::<f64>()
        .sqrt();
    // Thirty metres on an arc that turns by forty degrees: the chord is 2 r sin(20 deg).
    let right = 2.0 * (3.0 / 4f64.to_radians()) * 20f64.to_radians().sin();
    assert!((way - right).abs() < 0.2, "{way} {right}");
    assert!(base["first_time"].as_str().unwrap().starts_with("2023-11-14"), "{base}");
    let curve = &held["/time/inertial/\\/imu/acceleration/z"];
    assert!(
        has(curve, "Scalars:scalars") && has(curve, "SeriesLines:names"),
        "{curve}"
    );
    assert!(curve["rows"].as_u64().unwrap() > 100);
}

#[test]
fn views_are_no_larger_than_they_may_be() {
    let folder = tempfile::tempdir().unwrap();
    let long = DRIVE.replace("duration_s: 10", "duration_s: 200");
    support::write(&long, &folder.path().join("drive.mcap"));
    let (_, file) = views(folder.path(), &[]);
    let whole = std::fs::metadata(&file).unwrap().len();
    let (ran, file) = views(folder.path(), &["--max-size", "250kB"]);
    let small = std::fs::metadata(&file).unwrap().len();
    let words = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(whole > 300_000 && small <= 250_000, "{whole} {small} {words}");
    assert!(words.contains("to stay below --max-size, only one in"), "{words}");
}

#[test]
fn a_report_and_views_come_from_one_run_and_what_cannot_be_written_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a.rrd");
    let ran = program(&["check", "fixtures/first-finding", "--rrd", &out.to_string_lossy()]);
    assert_eq!(ran.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&ran.stderr).contains("wrote views to"));
    assert!(std::fs::metadata(&out).unwrap().len() > 1000);
    let nowhere = folder.path().join("no/such/folder.rrd");
    let ran = program(&["view", "fixtures/first-finding", "-o", &nowhere.to_string_lossy()]);
    assert_eq!(ran.status.code(), Some(2), "{}", String::from_utf8_lossy(&ran.stderr));
    let ran = program(&["view", "fixtures/first-finding"]);
    assert_eq!(ran.status.code(), Some(2), "a place to write to is needed");
}
