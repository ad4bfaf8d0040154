//! The configuration at the edge of the process: where it is found, what it may say, and how a fault in it is told.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fs;
use std::path::Path;

use crate::support;
use crate::support::program::{CallResult, run};

const NED: &str = "\
duration_s: 60
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /imu, from_drive: imu, rate_hz: 50, frame_id: base_link, errors: [ned_frd]}
  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps}
";

const DECLARED: &str = "conventions:\n  - topic: /imu\n    world: NED\n    body: FRD\n";

/// A folder `data` with a drive in NED, and this configuration beside `data`.
fn folder(configuration: Option<&str>) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("data")).unwrap();
    support::write(NED, &folder.path().join("data/drive.mcap"));
    if let Some(text) = configuration {
        fs::write(folder.path().join("frames-lint.yaml"), text).unwrap();
    }
    folder
}

fn check(folder: &Path, arguments: &[&str]) -> CallResult {
    run(folder, [&["check", "--format", "json"], arguments].concat())
}

/// Paths of the inputs, and the rules that found errors.
fn said(ran: &CallResult) -> (Vec<String>, Vec<String>) {
    let report = ran.report();
    let texts = |list: &str, key: &str| -> Vec<String> {
        let items = report[list].as_array().unwrap().iter();
        items.map(|item| item[key].as_str().unwrap().to_owned()).collect()
    };
    (texts("inputs", "path"), texts("findings", "rule"))
}

#[test]
fn the_configuration_above_the_input_is_found_and_listed() {
    let plain = folder(None);
    let ran = check(plain.path(), &["data"]);
    assert_eq!((ran.code, said(&ran).1), (1, vec!["AXES03".to_owned()]));
    let declared = folder(Some(DECLARED));
    let ran = check(declared.path(), &["data"]);
    let (inputs, rules) = said(&ran);
    assert_eq!((ran.code, rules), (0, Vec::new()), "{}", ran.text());
    assert!(inputs[1].ends_with("frames-lint.yaml"), "{inputs:?}");
}

#[test]
fn a_configuration_can_be_named_and_holds_for_evidence_as_well() {
    let folder = folder(None);
    fs::write(folder.path().join("ours.yaml"), DECLARED).unwrap();
    assert_eq!(check(folder.path(), &["data", "--config", "ours.yaml"]).code, 0);
    let saved = run(folder.path(), ["collect", "data", "-o", "evidence.json"]);
    assert_eq!(saved.code, 0, "{}", saved.err);
    assert_eq!(check(folder.path(), &["--evidence", "evidence.json"]).code, 1);
    assert_eq!(
        check(folder.path(), &["--evidence", "evidence.json", "--config", "ours.yaml"]).code,
        0
    );
}

#[test]
fn what_the_data_contradict_points_at_the_declaration() {
    let folder = folder(Some(
        "conventions:\n  - topic: /imu\n    world: ENU\n  - topic: /imu\n    body: FLU\n",
    ));
    let ran = check(folder.path(), &["data"]);
    assert_eq!((ran.code, said(&ran).1), (1, vec!["AXES03".to_owned()]));
    // NED is declared, and the data are expressed in ENU.
    let other = NED.replace(", errors: [ned_frd]", "");
    support::write(&other, &folder.path().join("data/drive.mcap"));
    fs::write(folder.path().join("frames-lint.yaml"), DECLARED).unwrap();
    let ran = run(folder.path(), ["check", "data"]);
    assert_eq!(ran.code, 1);
    let text = ran.text().split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("frames-lint.yaml:2"), "{text}");
    assert!(text.contains("expressed in ENU/FLU axes"), "{text}");
    assert!(text.contains("declared here"), "{text}");
}

#[test]
fn a_fault_in_the_configuration_is_a_fault_of_the_call_with_its_place() {
    let folder = folder(Some("conventions:\n  - topic: /imu\n    wrold: NED\n"));
    let ran = check(folder.path(), &["data"]);
    assert_eq!((ran.code, ran.out.len()), (2, 0));
    assert!(
        ran.err.contains("frames-lint.yaml:3:5: unknown key `wrold`"),
        "{}",
        ran.err
    );
    for (text, why) in [
        (&b"\xff\xfe\x00"[..], "not UTF-8"),
        (b"conventions: [\n", "frames-lint.yaml:"),
        (
            b"conventions:\n  - topic: /imu\n    world: UP\n",
            "one of ENU, NED, NWU",
        ),
    ] {
        fs::write(folder.path().join("frames-lint.yaml"), text).unwrap();
        let ran = check(folder.path(), &["data"]);
        assert_eq!(ran.code, 2);
        assert!(ran.err.contains(why), "{}", ran.err);
    }
    let ran = check(folder.path(), &["data", "--config", "none.yaml"]);
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("`none.yaml` cannot be read"), "{}", ran.err);
}

/// A robot with two mistakes in its calibrations: a mirror image (ROT01), and the name of a frame in another case (NAME01).
fn robot(folder: &Path) {
    fs::create_dir_all(folder.join("calib")).unwrap();
    let urdf = r#"<robot name="car"><link name="base_link"/><link name="lidar"/><link name="radar"/>
  <joint name="lidar_joint" type="fixed"><parent link="base_link"/><child link="lidar"/><origin xyz="1.2 0.3 1.8"/></joint>
  <joint name="radar_joint" type="fixed"><parent link="base_link"/><child link="radar"/><origin xyz="3.4 0.2 0.5"/></joint></robot>"#;
    fs::write(folder.join("car.urdf"), urdf).unwrap();
    let matrix =
        "base_link_from_lidar:\n  - [1, 0, 0, 1.2]\n  - [0, -1, 0, 0.3]\n  - [0, 0, 1, 1.8]\n  - [0, 0, 0, 1]\n";
    fs::write(folder.join("calib/lidar.yaml"), matrix).unwrap();
    let radar = "extrinsics:\n  - {parent: base_link, child: Radar, xyz: [3.4, 0.2, 0.5], rpy: [0, 0, 0]}\n";
    fs::write(folder.join("calib/radar.yaml"), radar).unwrap();
}

/// The rules that found something, with the folder of the robot in which they found it.
fn found(ran: &CallResult) -> Vec<String> {
    let report = ran.report();
    let findings = report["findings"].as_array().unwrap().iter();
    let mut found: Vec<String> = findings
        .map(|finding| {
            let file = finding["places"][0]["path"].as_str().unwrap();
            format!(
                "{} {}",
                file.split('/').next().unwrap(),
                finding["rule"].as_str().unwrap()
            )
        })
        .collect();
    found.sort();
    found.dedup();
    found
}

#[test]
fn each_configuration_counts_for_its_folder_and_below() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a", "b", "c"] {
        robot(&folder.path().join(name));
    }
    let config = |path: &str, text: &str| fs::write(folder.path().join(path), text).unwrap();
    let all = found(&check(folder.path(), &["."]));
    assert_eq!(
        all,
        ["a NAME01", "a ROT01", "b NAME01", "b ROT01", "c NAME01", "c ROT01"]
    );
    // One on top, and one deeper, which does not extend it.
    config("frames-lint.yaml", "rules: {ignore: [NAME01]}\n");
    config("b/frames-lint.yaml", "rules: {ignore: [ROT01]}\n");
    // One beside a calibration alone: what it says of files counts there.
    config(
        "c/calib/frames-lint.yaml",
        "waivers:\n  - {rule: ROT01, reason: being replaced}\n",
    );
    for paths in [["."].as_slice(), &["a", "b", "c"], &["c", "b", "a"]] {
        let ran = check(folder.path(), paths);
        assert_eq!(found(&ran), ["a ROT01", "b NAME01", "c ROT01"], "{paths:?}");
        let waived: Vec<_> = ran.report()["findings"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|finding| !finding["waived"].is_null())
            .map(|finding| finding["places"][0]["path"].as_str().unwrap().to_owned())
            .collect();
        assert_eq!(waived, ["c/calib/lidar.yaml"], "{paths:?}");
    }
    // Each folder by itself says the same.
    assert_eq!(found(&check(folder.path(), &["b"])), ["b NAME01"]);
    // What is named is for everything.
    let named = check(folder.path(), &[".", "--config", "frames-lint.yaml"]);
    assert_eq!(found(&named), ["a ROT01", "b ROT01", "c ROT01"]);
}

#[test]
fn a_configuration_that_governs_no_platform_says_what_has_no_effect() {
    let folder = tempfile::tempdir().unwrap();
    robot(folder.path());
    let text = "limits: {CROSS02: {mount_m: 12 m}}\nwaivers: [{rule: ROT01, reason: being replaced}]\n";
    fs::write(folder.path().join("calib/frames-lint.yaml"), text).unwrap();
    let said = run(folder.path(), ["check", "."]).text();
    assert!(
        said.contains("calib/frames-lint.yaml: no effect of `limits`: the platform"),
        "{said}"
    );
}

#[test]
fn a_configuration_above_those_of_all_platforms_says_what_has_no_effect() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir(root.join("drive")).unwrap();
    fs::write(root.join("frames-lint.yaml"), "require: [ROT01]\n").unwrap();
    fs::write(
        root.join("drive/robot.urdf"),
        "<robot name=\"r\"><link name=\"base_link\"/></robot>",
    )
    .unwrap();
    assert_eq!(run(root, ["check", "."]).code, 3);
    let waiver = "waivers: [{rule: NAME01, reason: old names}]\n";
    fs::write(root.join("drive/frames-lint.yaml"), waiver).unwrap();
    let said = run(root, ["check", "."]).text();
    assert!(
        said.contains("frames-lint.yaml: no effect of `require`: configurations in deeper"),
        "{said}"
    );
}

/// What one folder's configuration calls its frames, and declares of its files, is not another's.
#[test]
fn aliases_and_declarations_of_a_folder_stay_there() {
    let robot = |name: &str| {
        format!(
            "<robot name=\"{name}\"><link name=\"base_link\"/><link name=\"lidar\"/>\
         <joint name=\"lidar_joint\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"lidar\"/><origin xyz=\"1 0.2 1.7\" rpy=\"0.02 -0.03 0.25\"/></joint></robot>"
        )
    };
    // The inverse of the joint: what `velo` is, only the configuration of `a` says.
    let calibration = "base_link_from_velo:\n  - [0.968476, 0.247293, 0.029996, -1.068929]\n  - [-0.247936, 0.96857, 0.01999, 0.020239]\n  \
                       - [-0.024109, -0.026796, 0.99935, -1.669427]\n  - [0, 0, 0, 1]\n";
    let folder = tempfile::tempdir().unwrap();
    for name in ["a", "old/a"] {
        let there = folder.path().join(name);
        fs::create_dir_all(&there).unwrap();
        fs::write(there.join("car.urdf"), robot(name)).unwrap();
        fs::write(there.join("velo.yaml"), calibration).unwrap();
    }
    let config =
        "aliases: {lidar: [velo]}\nconventions:\n  - {file: '*.yaml', quaternion: {order: wxyz, algebra: hamilton}}\n";
    fs::write(folder.path().join("a/frames-lint.yaml"), config).unwrap();
    fs::create_dir(folder.path().join("drive")).unwrap();
    support::write(NED, &folder.path().join("drive/drive.mcap"));
    let alone: Vec<String> = found(&check(&folder.path().join("old"), &["."]));
    let ran = check(folder.path(), &["."]);
    let of = |prefix: &str| -> Vec<String> { found(&ran).into_iter().filter(|one| one.starts_with(prefix)).collect() };
    assert_eq!(of("a "), ["a CROSS02"]);
    assert_eq!(
        of("old"),
        alone.iter().map(|one| one.replace("a ", "old ")).collect::<Vec<_>>()
    );
    assert!(!of("drive").contains(&"drive AUTH04".to_owned()), "{:?}", of("drive"));
    let shown = run(folder.path(), ["check", "--show-settings", "a/velo.yaml"]).text();
    assert!(
        shown.contains("alias          `velo` is `lidar` (a/frames-lint.yaml:1)"),
        "{shown}"
    );
}

#[test]
fn limits_and_requirements_are_those_of_the_configuration_above_the_recording() {
    let folder = folder(Some("require: [AXES03]\nfail-on: never\n"));
    let other = folder.path().join("other");
    fs::create_dir(&other).unwrap();
    support::write(NED, &other.join("drive.mcap"));
    fs::write(
        other.join("frames-lint.yaml"),
        format!("{DECLARED}require: [CROSS04]\n"),
    )
    .unwrap();
    let ran = check(folder.path(), &["."]);
    let headings: Vec<String> = found(&ran).into_iter().filter(|one| one.ends_with("AXES03")).collect();
    assert_eq!(headings, ["data AXES03"]);
    let report = ran.report();
    let unmet: Vec<_> = report["required"].as_array().unwrap().iter().collect();
    assert_eq!(unmet.len(), 1, "{unmet:?}");
    assert_eq!(unmet[0]["rule"], "CROSS04");
    let recordings = report["recordings"].as_array().unwrap();
    let codes: Vec<_> = recordings
        .iter()
        .map(|one| one["exit_code"].as_i64().unwrap())
        .collect();
    assert_eq!(codes, [1, 3], "the strictest `fail-on` is for all");
}

#[test]
fn the_settings_of_a_file_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join(".git")).unwrap();
    robot(&folder.path().join("a"));
    let show = |file: &str| run(folder.path(), ["check", "--show-settings", file]);
    let none = show("a/car.urdf").text();
    assert!(
        none.starts_with("configuration  none\n") && none.contains("the nearest configuration above their recordings"),
        "{none}"
    );
    fs::write(folder.path().join("frames-lint.yaml"), "rules: {ignore: [NAME01]}\n").unwrap();
    fs::write(
        folder.path().join("a/frames-lint.yaml"),
        "extends: ../frames-lint.yaml\nlimits:\n  CROSS02: {mount_m: 12 m}\nrequire: [TREE01]\n",
    )
    .unwrap();
    let shown = show("a/calib/lidar.yaml").text();
    for line in [
        "configuration  a/frames-lint.yaml, which extends a/../frames-lint.yaml",
        "ignore         NAME01 (a/../frames-lint.yaml:1:18)",
        "limit          CROSS02 mount_m: 12 m (a/frames-lint.yaml:3:",
        "require        TREE01 (a/frames-lint.yaml:4)",
        "above          frames-lint.yaml, for platforms that extend beyond this folder",
    ] {
        assert!(shown.contains(line), "{line} is not in\n{shown}");
    }
    assert_eq!(show("none.yaml").code, 2);
}

/// Metadata of an Ouster, firmware 2.x, shortened.
const OUSTER: &str = r#"{"prod_line": "OS-1-64", "image_rev": "ousteros-image-prod-aries-v2.4.0", "lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1]}"#;

/// Rows of SENSOR02 with their outcome.
fn of_the_ouster(ran: &CallResult) -> Vec<String> {
    let report = ran.report();
    let rows = report["outcomes"].as_array().unwrap().iter();
    let of = rows.filter(|row| row["rule"] == "SENSOR02");
    of.map(|row| row["outcome"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn metadata_on_a_topic_of_a_ros_1_bag_are_a_source_of_statements() {
    use support::rosbag1::{Connection, Layout, Rosbag1};
    let written = |text: &str| {
        let mut bag = Rosbag1::new(Layout::default());
        let connection = bag.connection(&Connection {
            topic: "/ouster/metadata",
            message_type: "std_msgs/String",
            definition: "string data\n",
            latching: true,
            ..Connection::default()
        });
        let length = u32::try_from(text.len()).unwrap().to_le_bytes();
        bag.message(
            connection,
            1_500_000_000_000_000_000,
            &[&length[..], text.as_bytes()].concat(),
        );
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("drive.bag"), bag.finish().bytes).unwrap();
        folder
    };
    let whole = written(OUSTER);
    let ran = check(whole.path(), &["drive.bag"]);
    assert!(of_the_ouster(&ran).contains(&"pass".to_owned()), "{}", ran.text());
    let report = ran.report();
    assert_eq!(report["inputs"][1]["kind"], "sensor-metadata");
    // Cut off, and no Ouster's: neither is a fault of the call, and the recording is judged.
    for text in [&OUSTER[..OUSTER.len() - 20], "{\"prod_line\": ", "hello"] {
        let other = written(text);
        let ran = check(other.path(), &["drive.bag"]);
        assert!(ran.code == 0 || ran.code == 3, "{} {}", ran.code, ran.text());
        assert!(said(&ran).1.is_empty(), "{}", ran.text());
    }
}

#[test]
fn the_users_rows_tell_the_times_of_points_and_win() {
    let drive = "\
duration_s: 3
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /points, from_drive: lidar, rate_hz: 10, frame_id: lidar, xyz: [0, 0, 1.8], lidar: {beams: 8, columns: 64, driver: unknown}}
";
    let rows = "tables:\n  lidar-clouds:\n    - {name: Ours, fields: {time_offset: float32}, \
                time: {field: time_offset, unit_s: 1.0e-3, counts_from: header}}\n";
    let folder = tempfile::tempdir().unwrap();
    support::write(drive, &folder.path().join("drive.mcap"));
    let plain = check(folder.path(), &["drive.mcap"]);
    assert!(!said(&plain).1.contains(&"TIME06".to_owned()), "{}", plain.text());
    fs::write(folder.path().join("frames-lint.yaml"), rows).unwrap();
    let ran = check(folder.path(), &["drive.mcap"]);
    assert!(said(&ran).1.contains(&"TIME06".to_owned()), "{}", ran.text());
    let text = ran.report().to_string();
    assert!(text.contains("Ours"), "{text}");
}

#[test]
fn a_fault_in_a_table_has_its_place_in_its_own_file() {
    let folder = folder(Some("tables:\n  lidars: lidars.yaml\n"));
    fs::write(
        folder.path().join("lidars.yaml"),
        "rows:\n  - name: Ours\n    words: [ours]\n    sensor: z\n    driver: x\n",
    )
    .unwrap();
    let ran = check(folder.path(), &["data"]);
    assert_eq!(ran.code, 2);
    assert!(
        ran.err
            .contains("lidars.yaml:4:5: row of `lidars`: `sensor`: unknown variant `z`"),
        "{}",
        ran.err
    );
}

/// Everything that a configuration may say.
const WHOLE: &str = "\
extends: [ci]
fail-on: note
rules: {select: [tree, CROSS02], ignore: NAME01, severity: {NAME02: error, TREE: off}}
limits: {CROSS02: {exact_deg: 0.02 deg}}
paths: [{file: sim/**, ignore: [urdf], severity: {TREE01: note}}]
waivers: [{rule: CROSS02, subject: '*lidar*', file: a.yaml, reason: remounted, until: '2027-01-31', by: J. Doe}]
require: [TREE01, {rule: AXES03, subject: '*imu*', if: applicable}, {rule: GEO01, lifted: indoors}, {share: 0.8}]
conventions:
  - {topic: /imu, frame: imu, file: a.mcap, world: NED, body: frd, quaternion: {order: wxyz, algebra: JPL}, time: gps, fields: confirmed}
dataset: KITTI
tables: {lidar-imus: [{name: Ours, words: [ours], lever_mm: [1, 2, 3]}]}
aliases: {velodyne: [lidar, velo], base_link: body}
transforms: [{file: a.yaml, key: extrinsic, is: imu from lidar}]
projections:
  - topic: /points
    range_image: {width: 1024, height: 64, fov_up_deg: 22.5, fov_down_deg: -22.5, azimuth: clockwise, seam: clamp, beam_offset_mm: 15.8}
  - {topic: /bev, grid: {frame: base_link, resolution_m: 0.1, origin: [-50, -50], cell: corner, columns: +x, rows: +y, ego_motion: raw}}
  - {topic: /pano, panorama: {width: 4096, height: 2048, azimuth: clockwise}}
contract:
  topics:
    - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, tolerance_percent: 20, frame: imu_link, optional: true}
    - {topic: /odom, frame: [odom, ''], child_frame: base_link}
  transforms:
    - {parent: base_link, child: imu_link, xyz_m: [0.3, 0, 1.2], rpy_deg: [0, 0, 90], tolerance_mm: 5, tolerance_deg: 0.2}
";

#[test]
fn the_schema_and_the_reader_take_and_refuse_the_same() {
    let schema: serde_json::Value =
        serde_json::from_str(include_str!("../../schema/frames-lint-config-1.json")).unwrap();
    let validator = jsonschema::draft202012::new(&schema).unwrap();
    let keys: Vec<&str> = schema["properties"]
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    let mut sorted = keys.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, frames_lint::config::KEYS);
    let by_schema = |text: &str| {
        let value: serde_json::Value = serde_yaml::from_str(text).unwrap();
        let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
        errors
    };
    let by_reader = |text: &str| frames_lint::config::parse("c.yaml", text.to_owned(), Path::new("")).err();
    assert_eq!((by_schema(WHOLE), by_reader(WHOLE)), (Vec::new(), None));
    for text in [
        "require: {detects: [imu-wxyz, {fault: time-offset, smaller-than: 50 ms}]}\n",
        "require: [{detects: yaw, smaller-than: 3 deg}, TREE01]\n",
    ] {
        assert_eq!((by_schema(text), by_reader(text)), (Vec::new(), None), "{text}");
    }
    for (name, text) in frames_lint::config::PROFILES {
        assert_eq!((by_schema(text), by_reader(text)), (Vec::new(), None), "{name}");
    }
    // Every key of it spoiled in turn: unknown keys are errors on every level.
    let mut spoiled: Vec<String> = [
        "rool: 1\n",
        "fail-on: errors\n",
        "rules: []\n",
        "rules: {severity: {TREE01: fatal}}\n",
        "limits: {TREE01: 3}\n",
        "limits: {TREE01: {a: three}}\n",
        "paths: [{file: a}]\n",
        "paths: [{ignore: [tree]}]\n",
        "waivers: [{rule: TREE01}]\n",
        "waivers: [{rule: TREE01, reason: a, until: soon}]\n",
        "waivers: {rule: TREE01, reason: a}\n",
        "require: TREE01\n",
        "require: [{subject: a}]\n",
        "require: [{rule: TREE01, if: maybe}]\n",
        "require: [{rule: TREE01, if: applicable, lifted: a}]\n",
        "require: [{share: 80}]\n",
        "require: {detect: yaw}\n",
        "require: [{detects: [{fault: yaw, size: 3 deg}]}]\n",
        "require: [{share: 0.8, rule: TREE01}]\n",
        "conventions: [{world: NED}]\n",
        "transforms: [{file: a}]\n",
        "projections: [{topic: a}]\n",
        "contract: []\n",
        "contract: {topics: {}}\n",
        "contract: {topics: [{type: a}]}\n",
        "contract: {topics: [{topic: a, rate_hz: -1}]}\n",
        "contract: {topics: [{topic: a, rate_hz: .nan}]}\n",
        "contract: {topics: [{topic: a, optional: perhaps}]}\n",
        "contract: {transforms: [{parent: a}]}\n",
        "contract: {transforms: [{parent: a, child: b, xyz_m: [1, 2]}]}\n",
        "contract: {transforms: [{parent: a, child: b, xyz_m: [1, 2, 1e9]}]}\n",
        "contract: {transforms: [{parent: a, child: b, tolerance_mm: -5}]}\n",
    ]
    .map(str::to_owned)
    .to_vec();
    for key in [
        "select",
        "exact_deg: 0.02 deg",
        "file",
        "ignore: [urdf]",
        "reason",
        "until",
        "subject",
        "topic",
        "order",
        "is",
        "range_image",
        "width",
        "resolution_m",
        "panorama",
        "lidar-imus",
        "topics",
        "rate_hz",
        "tolerance_mm",
    ] {
        let text = match key.split_once(':') {
            Some((before, _)) => WHOLE.replacen(key, &format!("{before}: {{no: no}}"), 1),
            None => WHOLE.replacen(&format!("{key}:"), &format!("{key}x:"), 1),
        };
        assert_ne!(text, WHOLE, "{key}");
        spoiled.push(text);
    }
    for text in spoiled {
        assert!(!by_schema(&text).is_empty(), "the schema takes\n{text}");
        assert!(by_reader(&text).is_some(), "the reader takes\n{text}");
    }
}

#[test]
fn what_an_alias_confirms_stays_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "robot.urdf",
        "<robot name='r'><link name='base_link'/><link name='lidar'/><joint name='j' type='fixed'><parent link='base_link'/>\
         <child link='lidar'/><origin xyz='0.5334 -0.0213 0.8671' rpy='0.0113 -0.0231 0.3517'/></joint></robot>\n",
    );
    // The inverse.
    write(
        "sensors.yaml",
        "extrinsics:\n  lidar:\n    xyz: [-0.51331, 0.19407, -0.85772]\n    rpy: [-0.018569, 0.017791, -0.351996]\n",
    );
    let found = || {
        let ran = check(folder.path(), &["."]);
        assert_eq!(ran.code, 1, "{}", ran.text());
        ran.report()["findings"][0].clone()
    };
    let before = found();
    assert_eq!(before["rule"], "CROSS07");
    assert!(
        before["help"]
            .as_str()
            .unwrap()
            .contains("aliases: {base_link: [base]}"),
        "{before:#}"
    );
    write("frames-lint.yaml", "aliases: {base_link: [base]}\n");
    let after = found();
    assert_eq!(
        (&after["rule"], &after["confidence"]),
        (&"CROSS02".into(), &"likely".into())
    );
}

#[test]
fn a_matrix_whose_key_and_frames_contradict_each_other_is_not_rewritten() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "robot.urdf",
        "<robot name='r'><link name='base_link'/><link name='velo'/><joint name='j' type='fixed'><parent link='base_link'/>\
         <child link='velo'/><origin xyz='0.5334 -0.0213 0.8671' rpy='0.0113 -0.0231 0.3517'/></joint></robot>\n",
    );
    let matrix = "ego_T_lidar:\n  - [0.938537967, -0.344717276, -0.017789998, 0.533400000]\n  - [0.344402336, 0.938638580, -0.018564685, -0.021300000]\n  - [0.023097946, 0.011296745, 0.999669380, 0.867100000]\n  - [0, 0, 0, 1]\n";
    let text = format!("parent_frame: velo\nchild_frame: base_link\n{matrix}");
    write("velo.yaml", &text);
    let ran = run(folder.path(), ["check", ".", "--unsafe-fixes"]);
    assert!(ran.text().contains("contradict each other"), "{}", ran.text());
    assert_eq!(fs::read_to_string(folder.path().join("velo.yaml")).unwrap(), text);
}

#[test]
fn a_hint_that_rests_on_names_says_which_alias_makes_it_more() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("car")).unwrap();
    write(
        "car/robot.urdf",
        "<robot name='r'><link name='imu'/><link name='lidar'/><joint name='j' type='fixed'><parent link='imu'/><child link='lidar'/>\
         <origin xyz='0.3 0.2 0.1' rpy='0.1 0.2 0.3'/></joint></robot>\n",
    );
    write(
        "car/fast_livo.yaml",
        "preprocess: {lidar_type: 1}\nmapping:\n  extrinsic_T: [0.05, 0.02, 0.03]\n  extrinsic_R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n",
    );
    let found = || {
        let report = run(folder.path(), ["check", "--format", "json", "car"]).report();
        let all = report["findings"].as_array().unwrap().iter();
        let cross = all.filter(|finding| finding["rule"] == "CROSS01").map(|finding| {
            let text = |key: &str| finding[key].as_str().unwrap().to_owned();
            (text("confidence"), text("help"))
        });
        cross.collect::<Vec<_>>()
    };
    let hint = found();
    let entry = "aliases: {imu: [imu], lidar: [lidar]}";
    assert!(
        hint[0].0 == "hint" && hint[0].1.contains(&format!("`{entry}`")),
        "{hint:?}"
    );
    write("car/frames-lint.yaml", &format!("{entry}\n"));
    let confirmed = found();
    assert!(
        confirmed[0].0 == "likely" && !confirmed[0].1.contains("aliases"),
        "{confirmed:?}"
    );
}

#[test]
fn a_configuration_that_is_found_reads_files_of_its_own_repository_only() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write("repo/.git/HEAD", "");
    write("repo/base.yaml", "fail-on: note\n");
    write(
        "repo/robot/robot.urdf",
        "<robot name=\"r\"><link name=\"base_link\"/></robot>",
    );
    write("elsewhere/secret.yaml", "hunter2: 1\n");
    let told = |config: &str, arguments: &[&str]| {
        write("repo/robot/frames-lint.yaml", config);
        run(&folder.path().join("repo/robot"), [&["check"], arguments].concat())
    };
    assert_eq!(told("extends: ../base.yaml\n", &["."]).code, 0);
    for config in [
        "extends: ../../elsewhere/secret.yaml\n",
        "tables: {lidars: ../../elsewhere/secret.yaml}\n",
        "extends: ../../elsewhere/none.yaml\n",
    ] {
        let ran = told(config, &["."]);
        assert_eq!(ran.code, 2, "{config}");
        assert!(
            ran.err.contains("is outside of the repository") && ran.err.contains("--outside"),
            "{}",
            ran.err
        );
        assert!(!ran.err.contains("hunter2"), "{}", ran.err);
        for allowed in [&[".", "--outside"][..], &[".", "--config", "frames-lint.yaml"]] {
            let ran = told(config, allowed);
            assert!(
                ran.code == 2 && !ran.err.contains("is outside of the repository"),
                "{}",
                ran.err
            );
        }
    }
}

#[test]
fn the_order_of_paths_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for (robot, child) in [("a", "lidar"), ("b", "Lidar"), ("c", "camera")] {
        let at = folder.path().join(robot);
        fs::create_dir(&at).unwrap();
        let urdf = format!(
            "<robot name=\"{robot}\"><link name=\"base_link\"/><link name=\"{child}\"/><joint name=\"j\" type=\"fixed\">\
             <parent link=\"base_link\"/><child link=\"{child}\"/><origin xyz=\"0 0 1\" rpy=\"0 0 1.5708\"/></joint></robot>"
        );
        fs::write(at.join("robot.urdf"), urdf).unwrap();
        support::write(&NED.replace("60", "6"), &at.join("drive.mcap"));
    }
    let orders: [&[&str]; 4] = [
        &["a", "b/robot.urdf", "c/drive.mcap", "b/drive.mcap"],
        &["c/drive.mcap", "b/drive.mcap", "a", "b/robot.urdf"],
        &["b/robot.urdf", "a", "c/drive.mcap", "b/drive.mcap"],
        &["b/drive.mcap", "a", "a", "c/drive.mcap", "b/robot.urdf"],
    ];
    let reports = orders.map(|order| check(folder.path(), order).text());
    for report in &reports {
        assert_eq!(report, &reports[0]);
    }
}
