//! `frames-lint diff`: two platforms and two recordings, and what is said of what changed.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fmt::Write as _;
use std::fs;

use serde_json::Value;

use crate::support;
use crate::support::program::{CallResult, run};

/// Fixed joints `(parent, child, xyz, rpy)`.
type Joint<'a> = (&'a str, &'a str, &'a str, &'a str);

fn urdf(joints: &[Joint]) -> String {
    let mut text = "<robot name=\"r\">\n".to_owned();
    let mut links: Vec<&str> = joints
        .iter()
        .flat_map(|(parent, child, ..)| [*parent, *child])
        .collect();
    links.sort_unstable();
    links.dedup();
    for link in links {
        writeln!(text, "  <link name=\"{link}\"/>").unwrap();
    }
    for (parent, child, xyz, rpy) in joints {
        writeln!(
            text,
            "  <joint name=\"{child}_joint\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/><origin xyz=\"{xyz}\" rpy=\"{rpy}\"/></joint>"
        )
        .unwrap();
    }
    text + "</robot>\n"
}

const CAR: &[Joint] = &[
    ("base_link", "lidar", "1.2 0.1 1.8", "0.01 0.02 0.35"),
    ("base_link", "camera_link", "1.5 0 1.4", "0 0.05 0"),
    ("base_link", "imu", "0.1 0 0.5", "0 0 0"),
];

/// The changes between two robots: the exit code and the document.
fn diff(before: &str, after: &str) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.urdf"), before).unwrap();
    fs::write(folder.path().join("b.urdf"), after).unwrap();
    document(&run(folder.path(), ["diff", "--format", "json", "a.urdf", "b.urdf"]))
}

fn document(ran: &CallResult) -> (i32, Value) {
    assert_eq!(ran.err, "");
    (ran.code, serde_json::from_slice(&ran.out).unwrap())
}

/// Of each change that is about no check: the subject, the relation and the explanation.
fn changes(document: &Value) -> Vec<(String, Option<String>, String)> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let all = document["changes"].as_array().unwrap().iter();
    all.filter(|change| change["kind"] != "check")
        .map(|change| {
            (
                text(&change["subject"]),
                change["relation"].as_str().map(str::to_owned),
                text(&change["explanation"]),
            )
        })
        .collect()
}

#[test]
fn the_same_robot_has_no_change() {
    let (code, document) = diff(&urdf(CAR), &urdf(CAR));
    assert_eq!((code, changes(&document)), (0, vec![]), "{document:#}");
    assert_eq!(document["compared"]["transforms"], 3);
}

#[test]
fn a_sensor_that_was_mounted_otherwise_is_told_from_a_convention_error_and_from_a_new_calibration() {
    let with = |xyz, rpy| {
        let mut joints = CAR.to_vec();
        joints[0] = ("base_link", "lidar", xyz, rpy);
        urdf(&joints)
    };
    // Six degrees of yaw and 30 cm: remounted. Half a degree: calibrated.
    let (code, remounted) = diff(&urdf(CAR), &with("1.2 0.4 1.8", "0.01 0.02 0.45"));
    let said = changes(&remounted);
    assert_eq!((code, said.len()), (1, 1), "{remounted:#}");
    assert!(
        said[0].1.is_none() && said[0].2.contains("`lidar` was probably remounted"),
        "{said:?}"
    );
    let measured = &remounted["changes"][0]["measured"];
    assert!((measured[1]["value"].as_f64().unwrap() - 0.3).abs() < 1e-9);
    // The turn of Rz(0.45) Ry(0.02) Rx(0.01) against Rz(0.35) Ry(0.02) Rx(0.01) is one of 0.1 rad about z of the base.
    assert!((measured[0]["value"].as_f64().unwrap() - 0.1_f64.to_degrees()).abs() < 1e-9);
    let (_, calibrated) = diff(&urdf(CAR), &with("1.21 0.1 1.8", "0.01 0.02 0.36"));
    assert!(
        changes(&calibrated)[0].2.contains("a small correction"),
        "{calibrated:#}"
    );
    // Rz(pi) of the mounting.
    let (_, turned) = diff(&urdf(CAR), &with("1.2 0.1 1.8", "-0.01 -0.02 3.4915926535897932"));
    assert_eq!(changes(&turned)[0].1.as_deref(), Some("z180"), "{turned:#}");
}

#[test]
fn where_all_that_hangs_on_a_frame_moves_alike_that_frame_moved() {
    let map: &[Joint] = &[
        ("map", "gate", "10 5 0", "0 0 0.3"),
        ("map", "dock", "-20 7 0", "0 0 1"),
        ("map", "tower", "3 90 12", "0 0 0"),
    ];
    let moved: &[Joint] = &[
        ("map", "gate", "110 5 0", "0 0 0.3"),
        ("map", "dock", "80 7 0", "0 0 1"),
        ("map", "tower", "103 90 12", "0 0 0"),
    ];
    let (code, document) = diff(&urdf(map), &urdf(moved));
    let said = changes(&document);
    assert_eq!((code, said.len()), (1, 1), "{document:#}");
    assert_eq!(said[0].0, "`map`");
    assert!(said[0].2.starts_with("the map origin moved"), "{said:?}");
    assert!((document["changes"][0]["measured"][1]["value"].as_f64().unwrap() - 100.0).abs() < 1e-6);
    // One of them alone: that one moved.
    let mut one = map.to_vec();
    one[1] = moved[1];
    assert_eq!(changes(&diff(&urdf(map), &urdf(&one)).1)[0].0, "`map` from `dock`");
}

#[test]
fn frames_that_come_go_and_hang_elsewhere_are_told() {
    let after: &[Joint] = &[
        ("base_link", "lidar", "1.2 0.1 1.8", "0.01 0.02 0.35"),
        ("lidar", "imu", "0 0 0.1", "0 0 0"),
        ("base_link", "radar", "2 0 0.5", "0 0 0"),
    ];
    let (_, document) = diff(&urdf(CAR), &urdf(after));
    let messages: Vec<&str> = document["changes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["message"].as_str().unwrap())
        .collect();
    for words in [
        "`camera_link` is gone (parent `base_link`)",
        "`radar` is new (parent `base_link`)",
        "`imu` has the parent `lidar` (was `base_link`)",
    ] {
        assert!(messages.contains(&words), "{words}: {messages:#?}");
    }
}

#[test]
fn calibration_files_are_held_against_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write(
        "a/lidar.yaml",
        "base_link_from_lidar:\n  translation: [0.42, -0.27, 0.61]\n  rpy: [0.1, -0.2, 1.2]\n",
    );
    // The inverse: the rotation's columns, and -R^T t, computed apart.
    let pose = nalgebra::Isometry3::from_parts(
        nalgebra::Translation3::new(0.42, -0.27, 0.61),
        nalgebra::UnitQuaternion::from_euler_angles(0.1, -0.2, 1.2),
    )
    .inverse();
    let (t, (r, p, y)) = (pose.translation.vector, pose.rotation.euler_angles());
    write(
        "b/lidar.yaml",
        &format!(
            "base_link_from_lidar:\n  translation: [{}, {}, {}]\n  rpy: [{r}, {p}, {y}]\n",
            t.x, t.y, t.z
        ),
    );
    let (code, document) = document(&run(folder.path(), ["diff", "--format", "json", "a", "b"]));
    assert_eq!(
        (code, changes(&document)[0].1.as_deref()),
        (1, Some("inverse")),
        "{document:#}"
    );
    assert!(
        document["changes"][0]["before"][0]
            .as_str()
            .unwrap()
            .contains("a/lidar.yaml:1")
    );
    let text = run(folder.path(), ["diff", "a", "b"]).text();
    assert!(
        text.contains("before: `base_link_from_lidar`, a/lidar.yaml:1") && text.contains("inverse: "),
        "{text}"
    );
}

/// The messages of all changes between two folders with these files.
fn between(before: &[(&str, &str)], after: &[(&str, &str)]) -> (i32, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    for (side, files) in [("a", before), ("b", after)] {
        fs::create_dir(folder.path().join(side)).unwrap();
        for (name, text) in files {
            let path = folder.path().join(side).join(name);
            if path.extension().is_some_and(|ending| ending == "mcap") {
                support::write(text, &path);
            } else {
                fs::write(path, text).unwrap();
            }
        }
    }
    let (code, document) = document(&run(folder.path(), ["diff", "--format", "json", "a", "b"]));
    let changes = document["changes"].as_array().unwrap().iter();
    let messages = changes.map(|change| change["message"].as_str().unwrap().to_owned());
    (code, messages.collect())
}

#[test]
fn what_a_file_states_of_a_sensor_that_nothing_else_knows_is_compared() {
    let robot = urdf(CAR);
    let calibration = "base_link:\n  lidar: {x: 1.2, y: 0.1, z: 1.8, roll: 0.01, pitch: 0.02, yaw: 0.35}\n";
    let more = format!("{calibration}  radar: {{x: 3.5, y: 0, z: 0.5, roll: 0, pitch: 0, yaw: 0}}\n");
    let moved = more.replace("x: 3.5", "x: 3.2");
    let with = |calibration: &str| {
        [
            ("robot.urdf", robot.clone()),
            ("calibration.yaml", calibration.to_owned()),
        ]
    };
    let between = |before: &str, after: &str| {
        let (before, after) = (with(before), with(after));
        let [before, after] =
            [&before, &after].map(|files| files.each_ref().map(|(name, text)| (*name, text.as_str())));
        self::between(&before, &after)
    };
    assert_eq!(between(&more, &more), (0, vec![]));
    let new = vec!["`base_link` from `radar` is new in the files".to_owned()];
    assert_eq!(between(calibration, &more), (1, new));
    let (code, gone) = between(&more, calibration);
    assert_eq!(
        (code, gone[0].as_str()),
        (1, "`base_link` from `radar` is gone from the files")
    );
    let (code, messages) = between(&more, &moved);
    assert_eq!(
        (code, messages[0].as_str()),
        (1, "`base_link` from `radar` in files is moved by 0.3000 m")
    );
}

#[test]
fn a_sensor_that_moved_in_tf_alone_is_told_beside_a_robot_that_stays() {
    let drive = |x: f64, again: &str| {
        format!(
            "topics:\n  - topic: /tf_static\n    transforms: [{{parent: base_link, child: lidar, xyz: [{x}, 0.1, 1.8], rpy_deg: [0, 0, 20]}}]\n{again}"
        )
    };
    let robot = urdf(&[("base_link", "lidar", "1.2 0.1 1.8", "0 0 0.3490658503988659")]);
    let again = "  - topic: /tf_static\n    at_s: 5\n    transforms: [{parent: base_link, child: lidar, xyz: [1.5, 0.1, 1.8], rpy_deg: [0, 0, 20]}]\n";
    let before = drive(1.2, "");
    let (_, messages) = between(
        &[("robot.urdf", &robot), ("drive.mcap", &before)],
        &[("robot.urdf", &robot), ("drive.mcap", &drive(1.5, ""))],
    );
    assert!(
        messages.contains(&"`lidar` is moved by 0.3000 m".to_owned()),
        "{messages:#?}"
    );
    // Moved during the second drive: that is a finding on a subject that the first does not have.
    let (code, messages) = between(&[("drive.mcap", &before)], &[("drive.mcap", &drive(1.2, again))]);
    assert!(
        code == 1
            && messages
                .iter()
                .any(|message| message.starts_with("TREE11 on ") && message.contains("fail (was absent)")),
        "{messages:#?}"
    );
}

#[test]
fn findings_on_what_only_one_has_came_or_went() {
    let robot = urdf(CAR);
    let loose = robot.replace("</robot>", "  <link name=\"radar\"/>\n</robot>");
    let (code, came) = between(&[("robot.urdf", &robot)], &[("robot.urdf", &loose)]);
    assert_eq!(code, 1);
    assert!(came.contains(&"`radar` is new".to_owned()), "{came:#?}");
    let tree = |messages: &[String]| {
        messages
            .iter()
            .any(|one| one.starts_with("TREE01 on ") && one.contains("radar"))
    };
    assert!(tree(&came), "{came:#?}");
    let (_, went) = between(&[("robot.urdf", &loose)], &[("robot.urdf", &robot)]);
    assert!(tree(&went) && went.contains(&"`radar` is gone".to_owned()), "{went:#?}");
}

fn recordings(before: &str, after: &str) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    support::write(before, &folder.path().join("a.mcap"));
    support::write(after, &folder.path().join("b.mcap"));
    document(&run(folder.path(), ["diff", "--format", "json", "a.mcap", "b.mcap"]))
}

#[test]
fn clocks_rates_frames_and_types_of_recordings_are_compared() {
    let before = "topics:\n  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 50, frame_id: imu}\n  \
                  - {topic: /fix, type: sensor_msgs/msg/NavSatFix, rate_hz: 5, frame_id: gps}\n";
    let (code, same) = recordings(before, before);
    assert_eq!((code, changes(&same)), (0, vec![]), "{same:#}");
    let after = "topics:\n  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 25, frame_id: imu_link}\n  \
                 - {topic: /fix, type: sensor_msgs/msg/NavSatFix, rate_hz: 5, frame_id: gps, stamp_offset_s: 18}\n  \
                 - {topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 10, frame_id: lidar}\n";
    let (code, document) = recordings(before, after);
    assert_eq!(code, 1);
    let messages: Vec<&str> = document["changes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["message"].as_str().unwrap())
        .collect();
    for words in [
        "/imu: frame is `imu_link` (was `imu`)",
        "/points is new (sensor_msgs/msg/PointCloud2)",
        "/imu: rate is 25.00 Hz (was 50.00 Hz)",
    ] {
        assert!(messages.contains(&words), "{words}: {messages:#?}");
    }
    let clock = changes(&document)
        .into_iter()
        .find(|change| change.0 == "/fix")
        .unwrap();
    assert_eq!(clock.2, "matches the offset between GPS time and UTC");
    // What the rules say changed with it.
    assert!(
        messages
            .iter()
            .any(|message| message.starts_with("TIME01 on ") && message.contains("fail (was pass)")),
        "{messages:#?}"
    );
}

#[test]
fn nothing_in_common_is_no_agreement_and_what_cannot_be_read_is_said() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.urdf"), urdf(CAR)).unwrap();
    fs::write(folder.path().join("b.yaml"), "name: nothing\n").unwrap();
    fs::write(folder.path().join("broken.urdf"), "<robot name=\"r\"><link").unwrap();
    let apart = run(folder.path(), ["diff", "--format", "json", "b.yaml", "b.yaml"]);
    assert_eq!(apart.code, 3, "{}", apart.text());
    let other = run(folder.path(), ["diff", "--format", "json", "a.urdf", "b.yaml"]);
    assert_eq!(other.code, 3, "{}", other.text());
    let broken = run(folder.path(), ["diff", "a.urdf", "broken.urdf"]);
    assert!(
        broken.code != 0 && broken.err.contains("broken.urdf"),
        "{} {}",
        broken.code,
        broken.err
    );
    let none = run(folder.path(), ["diff", "a.urdf", "nobody.urdf"]);
    assert_ne!(none.code, 0, "{}", none.text());
}

#[test]
fn each_of_several_robots_is_compared_with_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let mut moved = CAR.to_vec();
    moved[2].2 = "0.6 0 0.5";
    for (side, name, joints) in [
        ("a", "one", CAR),
        ("a", "two", CAR),
        ("b", "one", CAR),
        ("b", "two", &moved),
    ] {
        let there = folder.path().join(side).join(name);
        fs::create_dir_all(&there).unwrap();
        fs::write(there.join("car.urdf"), urdf(joints)).unwrap();
    }
    let (code, document) = document(&run(folder.path(), ["diff", "--format", "json", "a", "b"]));
    let subjects: Vec<String> = changes(&document).into_iter().map(|(subject, ..)| subject).collect();
    assert_eq!(
        (code, subjects.as_slice()),
        (1, ["two/car.urdf: `base_link` from `imu`".to_owned()].as_slice())
    );
    assert_eq!(run(folder.path(), ["diff", "a", "a"]).code, 0);
}
