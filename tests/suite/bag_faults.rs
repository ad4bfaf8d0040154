//! One healthy recording of a minute, and the faults that people suffer from, one at a time: each is found by the rule it
//! belongs to, at its topic, and by no other rule than those named here. The healthy one is silent.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::collections::BTreeSet;
use std::fs;

use crate::support;
use frames_lint::run::{FailOn, Run};
use frames_lint::source::{Confidence, ReadStatus, SourcePart};
use frames_lint::verdict::{Finding, Outcome, Severity};

/// A car that drives a wide left turn: dynamic TF at 50 Hz, an IMU at 100 Hz, GNSS at 1 Hz, a lidar at 10 Hz.
const HEALTHY: &str = "\
duration_s: 60
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: imu, xyz: [0.42, 0.11, 0.27]}
      - {parent: base_link, child: gnss, xyz: [0.12, -0.31, 1.55]}
      - {parent: base_link, child: lidar, xyz: [0.95, 0.04, 1.85], rpy_deg: [0.3, 1.2, 4]}
      - {parent: base_link, child: camera, xyz: [1.42, 0.03, 1.38], rpy_deg: [0, 2, 0.6]}
      - {parent: camera, child: camera_optical_frame, quaternion: [-0.5, 0.5, -0.5, 0.5]}
  - topic: /tf
    rate_hz: 50
    transforms:
      - {parent: map, child: odom, xyz: [12.5, -3.1, 0], rpy_deg: [0, 0, 14]}
      - {parent: odom, child: base_link, velocity: [3, 0, 0], yaw_rate_deg_s: 4}
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}
  - {topic: /gps/fix, type: sensor_msgs/msg/NavSatFix, rate_hz: 1, frame_id: gnss, stamp_offset_s: -0.08}
  - {topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 10, frame_id: lidar, stamp_offset_s: -0.05}
";

/// The same car as the file beside the recording.
const URDF: &str = r#"<robot name="car">
  <link name="base_link"/>
  <link name="imu"/>
  <link name="gnss"/>
  <link name="lidar"/>
  <link name="camera"/>
  <link name="camera_optical_frame"/>
  <joint name="imu_joint" type="fixed">
    <parent link="base_link"/><child link="imu"/>
    <origin xyz="0.42 0.11 0.27"/>
  </joint>
  <joint name="gnss_joint" type="fixed">
    <parent link="base_link"/><child link="gnss"/>
    <origin xyz="0.12 -0.31 1.55"/>
  </joint>
  <joint name="lidar_joint" type="fixed">
    <parent link="base_link"/><child link="lidar"/>
    <origin xyz="0.95 0.04 1.85" rpy="0.005235987755983 0.020943951023932 0.069813170079773"/>
  </joint>
  <joint name="camera_joint" type="fixed">
    <parent link="base_link"/><child link="camera"/>
    <origin xyz="1.42 0.03 1.38" rpy="0 0.034906585039887 0.010471975511966"/>
  </joint>
  <joint name="optical_joint" type="fixed">
    <parent link="camera"/><child link="camera_optical_frame"/>
    <origin rpy="-1.570796326794897 0 -1.570796326794897"/>
  </joint>
</robot>
"#;

const IMU: &str = "      - {parent: base_link, child: imu, xyz: [0.42, 0.11, 0.27]}\n";
const LIDAR: &str = "      - {parent: base_link, child: lidar, xyz: [0.95, 0.04, 1.85], rpy_deg: [0.3, 1.2, 4]}\n";
const CAMERA: &str = "      - {parent: base_link, child: camera, xyz: [1.42, 0.03, 1.38], rpy_deg: [0, 2, 0.6]}\n";
const ODOM: &str = "      - {parent: odom, child: base_link, velocity: [3, 0, 0], yaw_rate_deg_s: 4}\n";
const MAP: &str = "      - {parent: map, child: odom, xyz: [12.5, -3.1, 0], rpy_deg: [0, 0, 14]}\n";
const IMU_TOPIC: &str = "  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}\n";
const TF: &str = "  - topic: /tf\n    rate_hz: 50\n";
const GNSS_TOPIC: &str = "frame_id: gnss, stamp_offset_s: -0.08";

/// A fault: what is written in place of what.
struct Fault {
    name: &'static str,
    /// Texts of the recipe and what stands there instead; an empty one is added at the end.
    changes: Vec<(&'static str, String)>,
    with_urdf: bool,
    /// Every finding: rule, severity, topic of its primary place, relation.
    expected: &'static [&'static str],
}

fn fault(name: &'static str, from: &'static str, to: impl Into<String>, expected: &'static [&'static str]) -> Fault {
    Fault {
        name,
        changes: vec![(from, to.into())],
        with_urdf: false,
        expected,
    }
}

/// A static transform more.
fn also(name: &'static str, line: &str, expected: &'static [&'static str]) -> Fault {
    fault(name, LIDAR, format!("{LIDAR}      - {line}\n"), expected)
}

/// A topic more.
fn topic(name: &'static str, text: &str, expected: &'static [&'static str]) -> Fault {
    fault(name, "", text, expected)
}

impl Fault {
    fn beside_a_urdf(mut self) -> Self {
        self.with_urdf = true;
        self
    }

    fn recipe(&self) -> String {
        self.changes.iter().fold(HEALTHY.to_owned(), |recipe, (from, to)| {
            if from.is_empty() {
                return recipe + to;
            }
            assert_eq!(
                recipe.matches(from).count(),
                1,
                "{}: `{from}` stands once in the recipe",
                self.name
            );
            recipe.replace(from, to)
        })
    }
}

fn without_static() -> (&'static str, String) {
    let start = HEALTHY.find("  - topic: /tf_static").unwrap();
    (
        &HEALTHY[start..HEALTHY.find("  - topic: /tf\n").unwrap()],
        String::new(),
    )
}

#[allow(clippy::too_many_lines)] // One table.
fn faults() -> Vec<Fault> {
    vec![
        topic(
            "NaN in one /tf in the middle",
            "  - topic: /tf\n    at_s: 30.01\n    transforms:\n      - {parent: odom, child: base_link, quaternion: [0, 0, .nan, 1]}\n",
            &["ROT05 error /tf"],
        ),
        fault(
            "quaternion of norm 1.05, static",
            IMU,
            IMU.replace(
                "xyz: [0.42, 0.11, 0.27]",
                "xyz: [0.42, 0.11, 0.27], quaternion: [0, 0, 0, 1.05]",
            ),
            &["ROT04 error /tf_static"],
        ),
        fault(
            "quaternion of zeros, static",
            IMU,
            IMU.replace(
                "xyz: [0.42, 0.11, 0.27]",
                "xyz: [0.42, 0.11, 0.27], quaternion: [0, 0, 0, 0]",
            ),
            &["ROT05 error /tf_static"],
        ),
        also(
            "cycle, static",
            "{parent: lidar, child: base_link, xyz: [-1, 0, -1.8]}",
            &["TREE03 error /tf_static"],
        ),
        also(
            "cycle of leaves, static",
            "{parent: b, child: a, xyz: [-1, 0, -1.8]}\n      - {parent: a, child: b, xyz: [1, 0, 1.8]}",
            &["TREE03 error /tf_static"],
        ),
        also(
            "two parents, static",
            "{parent: camera, child: lidar, xyz: [-0.5, 0, 0.5]}",
            &["TREE02 error /tf_static"],
        ),
        fault(
            "disconnected sensor",
            LIDAR,
            LIDAR.replace("base_link", "roof"),
            &["TREE01 error /tf_static"],
        ),
        fault(
            "disconnected camera",
            CAMERA,
            CAMERA.replace("base_link", "windscreen"),
            &["TREE01 error /tf_static"],
        ),
        Fault {
            name: "no /tf_static",
            changes: vec![without_static()],
            with_urdf: false,
            expected: &["TREE08 error /gps/fix"],
        },
        Fault {
            name: "no /tf_static, beside a URDF",
            changes: vec![without_static()],
            with_urdf: true,
            expected: &["TREE08 error /gps/fix"],
        },
        fault(
            "leading slash in a sensor's frame_id",
            "frame_id: lidar",
            "frame_id: /lidar",
            &["NAME02 error /points"],
        ),
        fault(
            "other case in a sensor's frame_id",
            "frame_id: lidar",
            "frame_id: Lidar",
            &["NAME01 error /points"],
        ),
        fault(
            "unknown frame_id of a sensor",
            "frame_id: lidar",
            "frame_id: velodyne_front",
            &["TREE07 error /points"],
        ),
        also(
            "transform from a frame to itself",
            "{parent: lidar, child: lidar}",
            &["TREE04 error /tf_static"],
        ),
        topic(
            "stamp of /tf a second back, once",
            "  - topic: /tf\n    at_s: 30.01\n    stamp_offset_s: -1\n    transforms:\n      - {parent: odom, child: base_link, velocity: [3, 0, 0], yaw_rate_deg_s: 4}\n",
            &["TIME03 warning /tf"],
        ),
        topic(
            "a stamp of /tf again, with another place",
            "  - topic: /tf\n    at_s: 30.01\n    stamp_offset_s: -0.01\n    transforms:\n      - {parent: odom, child: base_link, xyz: [0.4, 0, 0], velocity: [3, 0, 0], yaw_rate_deg_s: 4}\n",
            &["TIME03 warning /tf"],
        ),
        fault(
            "12 s without odom -> base_link",
            ODOM,
            ODOM.replace("4}", "4, until_s: 20}") + &ODOM.replace("4}", "4, from_s: 32}"),
            &["TIME03 warning /tf"],
        ),
        Fault {
            name: "12 s without anything but GNSS",
            changes: vec![
                (
                    MAP,
                    MAP.replace("14]}", "14], until_s: 20}") + &MAP.replace("14]}", "14], from_s: 32}"),
                ),
                (
                    ODOM,
                    ODOM.replace("4}", "4, until_s: 20}") + &ODOM.replace("4}", "4, from_s: 32}"),
                ),
                (
                    IMU_TOPIC,
                    IMU_TOPIC.replace('}', ", until_s: 20}") + &IMU_TOPIC.replace('}', ", from_s: 32}"),
                ),
            ],
            with_urdf: false,
            expected: &["TIME03 warning /tf"],
        },
        Fault {
            name: "a TAI grandmaster for the IMU and the lidar",
            changes: vec![
                ("frame_id: imu}", "frame_id: imu, stamp_offset_s: 37}".to_owned()),
                ("stamp_offset_s: -0.05", "stamp_offset_s: 36.95".to_owned()),
            ],
            with_urdf: false,
            expected: &["TIME01 error /imu"],
        },
        fault(
            "GNSS 18 s ahead",
            GNSS_TOPIC,
            "frame_id: gnss, stamp_offset_s: 17.92",
            &["TIME01 error /gps/fix"],
        ),
        fault(
            "one edge static and dynamic",
            ODOM,
            format!("{ODOM}      - {{parent: base_link, child: imu, xyz: [0.42, 0.11, 0.27]}}\n"),
            &["TREE05 error /tf"],
        ),
        fault(
            "optical frame with identity",
            "quaternion: [-0.5, 0.5, -0.5, 0.5]",
            "quaternion: [0, 0, 0, 1]",
            &["NAME06 error /tf_static optical"],
        ),
        fault(
            "optical frame with identity, beside a URDF",
            "quaternion: [-0.5, 0.5, -0.5, 0.5]",
            "quaternion: [0, 0, 0, 1]",
            &[
                "CROSS02 error /tf_static rotation-lost",
                "NAME06 error /tf_static optical",
            ],
        )
        .beside_a_urdf(),
        also(
            "empty child id",
            "{parent: lidar, child: \"\"}",
            &["TREE04 error /tf_static"],
        ),
        fault(
            "stamps of /tf in TAI",
            TF,
            format!("{TF}    stamp_offset_s: 37\n"),
            &["TIME01 error /tf"],
        ),
        fault(
            "map -> base_link as well",
            ODOM,
            format!(
                "{ODOM}      - {{parent: map, child: base_link, xyz: [12.5, -3.1, 0], velocity: [3, 0, 0], yaw_rate_deg_s: 4, rpy_deg: [0, 0, 14]}}\n"
            ),
            &["TREE02 error /tf"],
        ),
        fault(
            "lidar turned by 180 deg",
            LIDAR,
            LIDAR.replace("[0.3, 1.2, 4]", "[-0.3, -1.2, -176]"),
            &["CROSS02 error /tf_static z180"],
        )
        .beside_a_urdf(),
        fault(
            "lidar 30 cm lower and 21 deg off",
            LIDAR,
            LIDAR.replace("1.85], rpy_deg: [0.3, 1.2, 4]", "1.55], rpy_deg: [0.3, 1.2, 25]"),
            &["CROSS01 error /tf_static", "ROT10 note /tf_static"],
        )
        .beside_a_urdf(),
        topic(
            "static extrinsic changes in the middle",
            "  - topic: /tf_static\n    at_s: 30\n    transforms:\n      - {parent: base_link, child: lidar, xyz: [0.95, 0.04, 1.85], rpy_deg: [0.3, 1.2, 6]}\n",
            &["TREE11 error /tf_static", "ROT10 note /tf_static"],
        ),
        fault(
            "map -> odom jumps 5 m",
            MAP,
            MAP.replace("14]", "14], jumps: [{at_s: 30, by: [5, 0, 0]}]"),
            &["TREE14 note /tf"],
        ),
        fault(
            "odom -> base_link jumps 1 m",
            ODOM,
            ODOM.replace("deg_s: 4", "deg_s: 4, jumps: [{at_s: 30, by: [1, 0, 0]}]"),
            &["TREE15 error /tf"],
        ),
        topic(
            "image in the camera's link",
            "  - {topic: /image, type: sensor_msgs/msg/Image, rate_hz: 10, frame_id: camera, stamp_offset_s: -0.05}\n",
            &["NAME07 error /image optical"],
        ),
    ]
}

/// A fault: its name, what is written in place of what, and every finding: rule, severity, topic of its primary place, relation.
pub(crate) type DriveFault = (&'static str, [&'static str; 2], &'static [&'static str]);

/// Every fault, put into a healthy recipe alone, gives just its findings.
pub(crate) fn each_is_found(healthy: &str, faults: &[DriveFault]) {
    let mut wrong = Vec::new();
    for (name, [from, to], expected) in faults {
        assert_eq!(
            healthy.matches(from).count(),
            1,
            "{name}: `{from}` stands once in the recipe"
        );
        let (_folder, run) = check(&healthy.replace(from, to), false);
        let found: Vec<String> = run.verdict.findings.iter().map(describe).collect();
        if found != *expected {
            wrong.push(format!("{name}: found {found:?}, expected {expected:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

pub(crate) fn check(recipe: &str, with_urdf: bool) -> (tempfile::TempDir, Run) {
    let folder = tempfile::tempdir().unwrap();
    support::write(recipe, &folder.path().join("drive.mcap"));
    if with_urdf {
        fs::write(folder.path().join("car.urdf"), URDF).unwrap();
    }
    let run = support::checked(folder.path());
    (folder, run)
}

/// A finding in one line: rule, severity, topic and relation.
pub(crate) fn describe(finding: &Finding) -> String {
    let topic = match &finding.places[0].place.at {
        SourcePart::Message(message) => message.topic.clone(),
        other => format!("{other:?}"),
    };
    let relation = finding
        .relation
        .as_deref()
        .map(|word| format!(" {word}"))
        .unwrap_or_default();
    format!("{} {} {topic}{relation}", finding.rule, finding.severity.word())
}

#[test]
fn every_fault_is_found_by_its_rule_and_by_no_other() {
    let mut wrong = Vec::new();
    for fault in faults() {
        let (_folder, run) = check(&fault.recipe(), fault.with_urdf);
        let found: Vec<String> = run.verdict.findings.iter().map(describe).collect();
        if found != fault.expected {
            wrong.push(format!(
                "{}: found {found:?}, expected {:?}",
                fault.name, fault.expected
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The worst that is said of stamps that run by so much: a finding by its severity and its confidence.
fn worst_of_offset(offset_s: f64) -> Option<(Severity, Confidence)> {
    let recipe = format!(
        "topics:\n  - {{topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 50, frame_id: imu}}\n  \
         - {{topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 10, frame_id: lidar, stamp_offset_s: {offset_s}}}\n"
    );
    let (_folder, run) = check(&recipe, false);
    let of_clocks = run.verdict.open().filter(|finding| finding.rule.starts_with("TIME0"));
    of_clocks
        .filter(|finding| finding.subject.contains("/points") && finding.rule != "TIME05")
        .map(|finding| (finding.severity, finding.confidence))
        .max()
}

#[test]
fn a_name_for_an_offset_never_makes_it_weigh_less() {
    // Beside each: an offset of about that size that nothing explains.
    let offsets = [
        (7200.0, 7100.0),
        (3600.0, 3500.0),
        (19_800.0, 19_500.0),
        (86_400.0, 85_000.0),
        (604_800.0, 604_000.0),
        (18.0, 14.3),
        (37.0, 33.6),
        (1.0, 1.4),
    ];
    for (named, unnamed) in offsets.into_iter().flat_map(|(a, b)| [(a, b), (-a, -b)]) {
        let (with_name, without) = (worst_of_offset(named), worst_of_offset(unnamed));
        assert!(without.is_some(), "{unnamed} s");
        assert!(
            with_name >= without,
            "{named} s: {with_name:?}, {unnamed} s: {without:?}"
        );
    }
}

#[test]
fn the_healthy_recording_is_silent_and_much_was_judged() {
    for with_urdf in [false, true] {
        let (_folder, run) = check(HEALTHY, with_urdf);
        assert!(
            run.sources.iter().all(|source| source.status == ReadStatus::Read),
            "{:?}",
            run.sources
        );
        let said: Vec<String> = run.verdict.findings.iter().map(describe).collect();
        assert!(said.is_empty(), "{said:?}");
        assert_eq!(run.exit_code(FailOn::Note), 0);
        let passed: BTreeSet<&str> = run
            .verdict
            .rows
            .iter()
            .filter(|row| row.outcome == Outcome::Pass)
            .map(|row| row.rule.as_ref())
            .collect();
        let beside = ["CROSS01", "CROSS02", "CROSS06", "TREE12"];
        let alone = [
            "TREE01", "TREE02", "TREE03", "TREE04", "TREE05", "TREE06", "TREE07", "TREE08", "NAME01", "NAME02",
            "NAME06", "ROT04", "ROT05", "TIME01", "TIME03", "TIME04",
        ];
        for rule in alone.iter().chain(beside.iter().filter(|_| with_urdf)) {
            assert!(passed.contains(rule), "{rule} judged nothing, with a URDF: {with_urdf}");
        }
    }
}
