//! Real reports, from the real program, against the schema; and every exit code once.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::fs;
use std::path::Path;

use crate::support;
use crate::support::program;
use crate::support::recipe::DRIVE;
use serde_json::Value;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The report on a path, which must be valid, and the exit code that goes with it.
fn report(folder: &Path, path: &str) -> (i32, Value) {
    let ran = program::run(folder, ["check", "--format", "json", path]);
    assert_eq!(ran.err, "");
    (ran.code, ran.report())
}

#[test]
fn the_first_finding() {
    let (code, report) = report(root(), "fixtures/first-finding");
    assert_eq!((code, &report["summary"]["verdict"]), (1, &Value::from("findings")));
    let rules: Vec<&str> = report["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f["rule"].as_str().unwrap())
        .collect();
    assert_eq!(rules, ["CROSS02", "NAME06"]);
    let place = &report["findings"][0]["places"][0];
    assert_eq!(
        (&place["path"], &place["line"]),
        (&Value::from("fixtures/first-finding/lidar.yaml"), &Value::from(2))
    );
    assert!(!report["findings"][1]["fix"]["edits"].as_array().unwrap().is_empty());
}

#[test]
fn healthy_platforms_with_recordings() {
    let robots: Vec<_> = fs::read_dir(root().join("fixtures/robots"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    assert!(robots.len() >= 3);
    for robot in robots {
        let folder = tempfile::tempdir().unwrap();
        support::copy_platform(&robot, folder.path());
        let (code, report) = report(folder.path(), ".");
        assert_eq!(
            (code, &report["summary"]["verdict"]),
            (0, &Value::from("clean")),
            "{}",
            robot.display()
        );
        let inputs = report["inputs"].as_array().unwrap();
        let bag = inputs.iter().find(|input| input["kind"] == "mcap").unwrap();
        assert!(bag["examined"]["messages"].as_u64().unwrap() > 100);
    }
}

#[test]
fn a_finding_in_a_recording_names_its_message() {
    let folder = tempfile::tempdir().unwrap();
    let late = DRIVE.replace("frame_id: imu}", "frame_id: imu, stamp_offset_s: 18}");
    support::write(&late, &folder.path().join("drive.mcap"));
    let (_, report) = report(folder.path(), "drive.mcap");
    let findings = report["findings"].as_array().unwrap();
    let places = || {
        findings
            .iter()
            .map(|finding| &finding["places"][0])
            .filter(|place| place["topic"] == "/imu")
    };
    let place = places().next().unwrap_or_else(|| panic!("{findings:#?}"));
    assert_eq!(place["path"], "drive.mcap");
    let index = place["index"].as_i64().unwrap();
    // The recipe: message n at n / 100 s, stamped 18 s ahead of the log.
    assert_eq!(
        place["stamp_ns"].as_i64().unwrap(),
        1_700_000_018_000_000_000 + index * 10_000_000
    );
    assert!(place["line"].is_null());
}

#[test]
fn parts_that_were_not_understood_are_said_in_every_form_of_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let text = "T_a_b: [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0]\nmounts:\n  radar: [1, 2, 3, 0, 0, 0.5]\n";
    fs::write(folder.path().join("some.yaml"), text).unwrap();
    fs::write(
        folder.path().join("none.yaml"),
        "mounts:\n  radar: [1, 2, 3, 0, 0, 0.5]\n",
    )
    .unwrap();
    let (code, report) = report(folder.path(), ".");
    assert_eq!(code, 3, "one file was not read");
    let input = |name: &str| {
        let inputs = report["inputs"].as_array().unwrap();
        inputs.iter().find(|input| input["path"] == name).unwrap().clone()
    };
    let part = |line: u32| serde_json::json!([{"part": "mounts/radar", "line": line, "column": 3}]);
    let (some, none) = (input("some.yaml"), input("none.yaml"));
    assert_eq!(
        (&some["status"], &some["taken"], &some["not_understood"]),
        (&Value::from("read"), &Value::from("1 transform"), &part(3))
    );
    assert_eq!(
        (&none["status"], &none["not_understood"]),
        (&Value::from("partial"), &part(2))
    );
    assert_eq!(none["problems"][0]["line"], 2);
    let said = program::run(folder.path(), ["check", "."]).text();
    assert!(
        said.contains("some.yaml: 1 transform; not understood: `mounts/radar`"),
        "{said}"
    );
    program::run(folder.path(), ["check", ".", "--output", "html=report.html"]);
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("not understood: <code>mounts/radar</code>"));
}

#[test]
fn every_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("good.urdf", "<robot name='r'><link name='base_link'/></robot>");
    write("bad.urdf", "<robot name='r'><link name='a'/><link name='b'/></robot>");
    write("broken.urdf", "<robot name='r'>");
    write("nothing.yaml", "speed: 3\n");
    let code = |arguments: &[&str]| program::run(folder.path(), arguments).code;
    assert_eq!(code(&["check", "good.urdf"]), 0);
    assert_eq!(code(&["check", "bad.urdf"]), 1);
    assert_eq!(code(&["check", "bad.urdf", "--fail-on", "never"]), 0);
    assert_eq!(code(&["check", "--no-such-option"]), 2);
    assert_eq!(code(&["check", "good.urdf", "--select", "NOSUCH"]), 2);
    assert_eq!(code(&["check", "broken.urdf"]), 3);
    assert_eq!(code(&["check", "nothing.yaml"]), 3);
    assert_eq!(code(&["check", "good.urdf", "broken.urdf"]), 3);
}
