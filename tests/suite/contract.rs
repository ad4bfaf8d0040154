//! `init --from` and `check` with its contract: a good drive keeps its own contract, and each alteration is found, and nothing else.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fs;
use std::path::Path;

use crate::support;
use crate::support::program::run;
use serde_json::Value;

/// A healthy drive: steady sensors, mounts, a map's origin, and what comes by chance.
const GOOD: &str = "\
duration_s: 20
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: imu_link, xyz: [0.1, 0.02, 0.3], rpy_deg: [1, 2, 30]}
      - {parent: base_link, child: lidar, xyz: [0.3, 0, 1.2]}
      - {parent: earth, child: map, xyz: [1000, 20, 0]}
  - topic: /tf
    rate_hz: 20
    transforms:
      - {parent: odom, child: base_link, velocity: [1, 0, 0]}
      - {parent: base_link, child: antenna, xyz: [-0.4, 0, 1.5]}
  - {topic: /camera/camera_info, type: sensor_msgs/msg/CameraInfo, rate_hz: 10, frame_id: camera, camera: {size: [640, 480], k: [500, 500, 320, 240]}}
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu_link}
  - {topic: /odom, type: nav_msgs/msg/Odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link, velocity: [1, 0, 0]}
  - {topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 10, frame_id: lidar}
  - {topic: /clicked_point, type: geometry_msgs/msg/PointStamped, at_s: 3, frame_id: map}
  - {topic: /rosout, type: rcl_interfaces/msg/Log, rate_hz: 1, until_s: 5}
";

/// The folder of a good drive and its contract.
fn agreed() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    support::write(GOOD, &folder.path().join("good.mcap"));
    let made = run(folder.path(), ["init", "--from", "good.mcap", "-o", "contract.yaml"]);
    assert_eq!(made.code, 0, "{}", made.err);
    folder
}

/// The rows and findings of the contract's rules on some input.
fn held(folder: &Path, input: &str) -> Value {
    let arguments = [
        "check",
        "--config",
        "contract.yaml",
        "--select",
        "contract",
        "--format",
        "json",
        input,
    ];
    run(folder, arguments).report()
}

/// Rule, severity and headline of each finding.
fn findings(report: &Value) -> Vec<String> {
    let words = |finding: &Value, key: &str| finding[key].as_str().unwrap().to_owned();
    let findings = report["findings"].as_array().unwrap().iter();
    let mut findings: Vec<String> = findings
        .map(|finding| ["rule", "severity", "message"].map(|key| words(finding, key)).join(" "))
        .collect();
    findings.sort();
    findings
}

/// The findings in a drive that differs from the good one by one text.
fn altered(folder: &Path, from: &str, to: &str) -> Vec<String> {
    assert!(GOOD.contains(from), "{from}");
    support::write(&GOOD.replace(from, to), &folder.join("next.mcap"));
    findings(&held(folder, "next.mcap"))
}

#[test]
fn a_contract_says_what_the_drive_holds() {
    let folder = agreed();
    let text = fs::read_to_string(folder.path().join("contract.yaml")).unwrap();
    for line in [
        "    - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, tolerance_percent: 20, frame: imu_link}\n",
        "    - {topic: /odom, type: nav_msgs/msg/Odometry, rate_hz: 20, tolerance_percent: 20, frame: odom, child_frame: base_link}\n",
        "    - {topic: /camera/camera_info, type: sensor_msgs/msg/CameraInfo, rate_hz: 10, tolerance_percent: 20, frame: camera, image: [640, 480]}\n",
        "    - {parent: base_link, child: antenna, xyz_m: [-0.4, 0, 1.5], rpy_deg: [0, 0, 0], tolerance_mm: 5, tolerance_deg: 0.2}  # on /tf, with one value in this recording: remove it if it can move\n",
        "    - {topic: /clicked_point, type: geometry_msgs/msg/PointStamped, frame: map, optional: true}\n",
        "    - {parent: base_link, child: imu_link, xyz_m: [0.1, 0.02, 0.3], rpy_deg: [1, 2, 30], tolerance_mm: 5, tolerance_deg: 0.2}\n",
    ] {
        assert!(text.contains(line), "{line}{text}");
    }
    // What differs from drive to drive, and what nodes say about themselves.
    for word in ["rosout", "earth"] {
        let contract = text
            .split("\ncontract:")
            .nth(1)
            .unwrap()
            .split("\nrequire:")
            .next()
            .unwrap();
        assert!(!contract.contains(word), "{text}");
    }
    assert!(text.contains("  - {detects: ["), "{text}");
    frames_lint::config::parse("contract.yaml", text, Path::new("")).unwrap();
}

#[test]
fn a_good_drive_keeps_its_own_contract() {
    let folder = agreed();
    let report = held(folder.path(), "good.mcap");
    assert_eq!(findings(&report), [""; 0]);
    let rows = report["outcomes"].as_array().unwrap();
    let passed = rows.iter().filter(|row| row["outcome"] == "pass").count();
    // Six topics, of them four with a rate; five with frames, one with a child; one camera; three mounts.
    assert_eq!(passed, 6 + 4 + 5 + 1 + 1 + 3, "{rows:#?}");
    // With all rules, and with what it requires.
    let whole = run(
        folder.path(),
        ["check", "--config", "contract.yaml", "--fail-on", "error", "good.mcap"],
    );
    assert!(!whole.text().contains("CONTRACT"), "{}", whole.text());
    assert!(!whole.text().contains("would not have been found"), "{}", whole.text());
}

/// A text of the good drive, what stands in its place, and all that is found.
const ALTERED: &[(&str, &str, &[&str])] = &[
    (
        "topic: /imu,",
        "topic: /imu/data,",
        &[
            "CONTRACT01 error `/imu` of the contract is not in the recording",
            "CONTRACT01 note `/imu/data` is recorded, but is not in the contract",
        ],
    ),
    (
        "sensor_msgs/msg/Imu",
        "geometry_msgs/msg/PoseStamped",
        &["CONTRACT01 error `/imu` has type `geometry_msgs/msg/PoseStamped` instead of `sensor_msgs/msg/Imu`"],
    ),
    (
        "rate_hz: 100",
        "rate_hz: 50",
        &["CONTRACT02 warning `/imu` has 50.00 Hz instead of 100 Hz: -50 %, tolerance 20 %"],
    ),
    ("rate_hz: 100", "rate_hz: 90", &[]),
    // A topic that starts late has its rate; one that ends early has not: the recording goes on to 19.95 s.
    ("rate_hz: 100", "rate_hz: 100, from_s: 4", &[]),
    (
        "rate_hz: 100",
        "rate_hz: 100, until_s: 10",
        &["CONTRACT02 warning `/imu` stops after 10.0 s of 19.9 s of the recording; it should go on with 100 Hz"],
    ),
    (
        "frame_id: lidar",
        "frame_id: velodyne",
        &["CONTRACT03 error `/points` has frame_id `velodyne` instead of `lidar`"],
    ),
    (
        "child_frame_id: base_link",
        "child_frame_id: base_footprint",
        &["CONTRACT03 error `/odom` has child_frame_id `base_footprint` instead of `base_link`"],
    ),
    // By three times the tolerance, and by half of it.
    (
        "xyz: [0.3, 0, 1.2]",
        "xyz: [0.3, 0.015, 1.2]",
        &[
            "CONTRACT04 error `base_link` -> `lidar` is 15.0 mm and 0.00 deg from the contract (tolerance 5 mm, 0.2 deg)",
        ],
    ),
    ("xyz: [0.3, 0, 1.2]", "xyz: [0.3, 0.0025, 1.2]", &[]),
    (
        "rpy_deg: [1, 2, 30]",
        "rpy_deg: [1, 2, 30.6]",
        &[
            "CONTRACT04 error `base_link` -> `imu_link` is 0.0 mm and 0.60 deg from the contract (tolerance 5 mm, 0.2 deg)",
        ],
    ),
    ("rpy_deg: [1, 2, 30]", "rpy_deg: [1, 2, 30.1]", &[]),
    (
        "child: lidar,",
        "child: velodyne,",
        &[
            "CONTRACT04 error `base_link` -> `lidar` of the contract is not in the recording: `velodyne` has this transform there",
        ],
    ),
    (
        "xyz: [-0.4, 0, 1.5]",
        "xyz: [-0.4, 0.05, 1.5]",
        &[
            "CONTRACT04 error `base_link` -> `antenna` is 50.0 mm and 0.00 deg from the contract (tolerance 5 mm, 0.2 deg)",
        ],
    ),
    (
        "size: [640, 480]",
        "size: [1280, 720]",
        &["CONTRACT05 error `/camera/camera_info` has images of 1280 x 720 instead of 640 x 480"],
    ),
    // What may differ in a healthy drive.
    ("xyz: [1000, 20, 0]", "xyz: [2000, 10, 0]", &[]),
    ("at_s: 3,", "at_s: 9,", &[]),
    ("topic: /rosout", "topic: /diagnostics", &[]),
];

#[test]
fn each_alteration_is_found_and_nothing_else() {
    let folder = agreed();
    let wrong: Vec<String> = ALTERED
        .iter()
        .filter_map(|(from, to, expected)| {
            let found = altered(folder.path(), from, to);
            (found != *expected).then(|| format!("{to}: {found:#?}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn findings_point_to_the_line_of_the_contract_and_to_the_recording() {
    let folder = agreed();
    support::write(
        &GOOD.replace("frame_id: lidar", "frame_id: velodyne"),
        &folder.path().join("next.mcap"),
    );
    let report = held(folder.path(), "next.mcap");
    let places = report["findings"][0]["places"].to_string();
    let text = fs::read_to_string(folder.path().join("contract.yaml")).unwrap();
    let line = text.lines().position(|line| line.contains("topic: /points")).unwrap() + 1;
    assert!(
        places.contains("contract.yaml") && places.contains(&format!("\"line\":{line}")),
        "{places}"
    );
    assert!(places.contains("/points"), "{places}");
}

#[test]
fn each_drive_is_held_to_it_and_nothing_unseen_passes() {
    let folder = agreed();
    let root = folder.path();
    let drives = root.join("drives");
    fs::create_dir(&drives).unwrap();
    support::write(GOOD, &drives.join("a.mcap"));
    let second = format!(
        "start_s: 1700086400\n{}",
        GOOD.replace("topic: /imu,", "topic: /other,")
    );
    support::write(&second, &drives.join("b.mcap"));
    let report = held(root, "drives");
    let missing: Vec<String> = findings(&report)
        .into_iter()
        .filter(|finding| finding.contains("error"))
        .collect();
    assert_eq!(missing.len(), 1, "{missing:?}");
    assert!(
        missing[0].contains("`/imu` of the contract is not in the recording"),
        "{missing:?}"
    );

    let outcomes = |input: &str| {
        let report = held(root, input);
        assert_eq!(findings(&report), [""; 0], "{input}");
        let rows = report["outcomes"].as_array().unwrap().clone();
        let passed = rows.iter().filter(|row| row["outcome"] == "pass").count();
        (passed, rows)
    };
    fs::write(
        root.join("robot.urdf"),
        "<robot name='r'><link name='base_link'/></robot>",
    )
    .unwrap();
    let (passed, rows) = outcomes("robot.urdf");
    assert_eq!(passed, 0, "{rows:#?}");
    // What is behind the cut may hold the rest.
    let whole = fs::read(root.join("good.mcap")).unwrap();
    fs::write(root.join("cut.mcap"), &whole[..whole.len() / 3]).unwrap();
    let (_, rows) = outcomes("cut.mcap");
    assert!(
        rows.iter()
            .all(|row| row["rule"] != "CONTRACT02" || row["outcome"] != "pass"),
        "{rows:#?}"
    );
}

#[test]
fn several_good_drives_make_one_contract() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir(root.join("good")).unwrap();
    support::write(GOOD, &root.join("good/a.mcap"));
    let second = GOOD
        .replace("rate_hz: 100", "rate_hz: 50")
        .replace("topic: /points", "topic: /scan");
    let second = format!(
        "start_s: 1700086400\n{}",
        second.replace("xyz: [0.3, 0, 1.2]", "xyz: [0.4, 0, 1.2]")
    );
    support::write(&second, &root.join("good/b.mcap"));
    let made = run(root, ["init", "--from", "good", "-o", "contract.yaml"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let text = fs::read_to_string(root.join("contract.yaml")).unwrap();
    // Another rate in each, a topic in one of them, a mount that was changed.
    for line in [
        "{topic: /imu, type: sensor_msgs/msg/Imu, frame: imu_link}\n",
        "{topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 10, tolerance_percent: 20, frame: lidar, optional: true}\n",
    ] {
        assert!(text.contains(line), "{line}{text}");
    }
    assert!(!text.contains("child: lidar"), "{text}");
    assert_eq!(findings(&held(root, "good")), [""; 0]);
}

#[test]
fn a_contract_needs_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("robot.urdf"),
        "<robot name='r'><link name='base_link'/></robot>",
    )
    .unwrap();
    let made = run(folder.path(), ["init", "--from", "robot.urdf"]);
    assert_eq!(made.code, 2, "{}", made.err);
    assert!(made.err.contains("--from robot.urdf: no recording"), "{}", made.err);
    assert!(!folder.path().join("frames-lint.yaml").exists());
    assert_eq!(run(folder.path(), ["init"]).code, 2);
}

/// A recording of an arm that is held, on a robot that this URDF describes.
fn terms_of_an_arm(urdf: Option<&str>, has_joint_states: bool) -> String {
    let folder = tempfile::tempdir().unwrap();
    let states = "  - {topic: /joint_states, type: sensor_msgs/msg/JointState, rate_hz: 50}\n";
    let recipe = format!(
        "duration_s: 10\ntopics:\n  - topic: /tf\n    rate_hz: 20\n    transforms:\n      - {{parent: base_link, child: mast, xyz: [0.4, 0, 0.5]}}\n{}",
        if has_joint_states { states } else { "" }
    );
    support::write(&recipe, &folder.path().join("good.mcap"));
    if let Some(urdf) = urdf {
        fs::write(folder.path().join("robot.urdf"), urdf).unwrap();
    }
    let made = run(
        folder.path(),
        ["init", "--from", "good.mcap", ".", "-o", "contract.yaml"],
    );
    assert_eq!(made.code, 0, "{}", made.err);
    fs::read_to_string(folder.path().join("contract.yaml")).unwrap()
}

#[test]
fn a_held_joint_is_no_fixed_part() {
    let robot = |kind: &str| {
        format!(
            "<robot name='r'><link name='base_link'/><link name='mast'/><joint name='j' type='{kind}'><parent link='base_link'/>\
             <child link='mast'/><origin xyz='0.4 0 0.5'/><axis xyz='0 0 1'/></joint></robot>"
        )
    };
    let (fixed, turning) = (robot("fixed"), robot("continuous"));
    for (urdf, has_joint_states, is_fixed) in [
        (None, false, true),
        (None, true, false),
        (Some(fixed.as_str()), true, true),
        (Some(turning.as_str()), false, false),
    ] {
        let text = terms_of_an_arm(urdf, has_joint_states);
        assert_eq!(
            text.contains("child: mast"),
            is_fixed,
            "{urdf:?} {has_joint_states}: {text}"
        );
    }
}
