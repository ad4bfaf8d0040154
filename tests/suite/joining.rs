//! Platforms side by side in one tree of folders: what `check .` says of each is what a check of its folder alone says.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use frames_lint::engine::{self, Options};
use frames_lint::run::Run;
use frames_lint::source::Confidence;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use proptest::prelude::*;

use crate::support;

/// A platform: where its lidar is, how its files lie, and its mistake.
#[derive(Clone, Debug)]
struct Platform {
    lidar: [f64; 6],
    layout: Layout,
    has_drive: bool,
}

#[derive(Clone, Copy, Debug)]
enum Layout {
    /// Description and calibration in one folder.
    Flat,
    /// Each kind of file in a folder of its own.
    ByKind,
    /// No description.
    WithoutRobot,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    None,
    /// The calibration is the inverse.
    Inverse,
    /// The calibration is the mirror image.
    Mirrored,
    /// The frame has another case in the calibration of a second sensor.
    Case,
    /// The clock of the recording's sensor is off by leap seconds; without a recording, as [`Mistake::Mirrored`].
    Late,
}

impl Platform {
    fn base_from_lidar(&self) -> Isometry3<f64> {
        let [x, y, z, roll, pitch, yaw] = self.lidar;
        Isometry3::from_parts(
            Translation3::new(x, y, z),
            UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        )
    }

    fn urdf(&self) -> String {
        let [x, y, z, roll, pitch, yaw] = self.lidar;
        format!(
            r#"<robot name="car">
  <link name="base_link"/><link name="lidar"/><link name="radar"/>
  <joint name="lidar_joint" type="fixed">
    <parent link="base_link"/><child link="lidar"/><origin xyz="{x} {y} {z}" rpy="{roll} {pitch} {yaw}"/>
  </joint>
  <joint name="radar_joint" type="fixed">
    <parent link="base_link"/><child link="radar"/><origin xyz="3.4 {y} 0.5"/>
  </joint>
</robot>
"#
        )
    }

    fn calibration(&self, mistake: Mistake) -> String {
        let base_from_lidar = self.base_from_lidar();
        let mut matrix = match mistake {
            Mistake::Inverse => base_from_lidar.inverse(),
            _ => base_from_lidar,
        }
        .to_homogeneous();
        if mistake == Mistake::Mirrored || mistake == Mistake::Late && !self.has_drive {
            for row in 0..3 {
                matrix[(row, 1)] = -matrix[(row, 1)];
            }
        }
        let rows: Vec<String> = (0..4)
            .map(|row| {
                let row: Vec<String> = (0..4).map(|column| format!("{:.9}", matrix[(row, column)])).collect();
                format!("  - [{}]\n", row.join(", "))
            })
            .collect();
        format!("base_link_from_lidar:\n{}", rows.concat())
    }

    /// Another file of the platform, which states where the radar is.
    fn radar(&self, mistake: Mistake) -> String {
        let radar = if mistake == Mistake::Case { "Radar" } else { "radar" };
        stated(radar, [3.4, self.lidar[1], 0.5])
    }

    fn drive(&self, mistake: Mistake) -> String {
        let [x, y, z, ..] = self.lidar;
        let [roll, pitch, yaw] = [3, 4, 5].map(|at| self.lidar[at].to_degrees());
        let offset = if mistake == Mistake::Late { 18 } else { 0 };
        format!(
            "\
start_s: 1700000000
duration_s: 10
topics:
  - topic: /tf_static
    transforms:
      - {{parent: base_link, child: lidar, xyz: [{x}, {y}, {z}], rpy_deg: [{roll}, {pitch}, {yaw}]}}
      - {{parent: base_link, child: radar, xyz: [3.4, {y}, 0.5]}}
  - topic: /tf
    rate_hz: 20
    transforms:
      - {{parent: odom, child: base_link, velocity: [3, 0, 0], yaw_rate_deg_s: 4}}
  - {{topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 50, frame_id: base_link, stamp_offset_s: {offset}}}
"
        )
    }

    fn write(&self, folder: &Path, mistake: Mistake) {
        let at = |kind: &str| match self.layout {
            Layout::ByKind => folder.join(kind),
            Layout::Flat | Layout::WithoutRobot => folder.to_path_buf(),
        };
        for kind in ["urdf", "config", "bags"] {
            fs::create_dir_all(at(kind)).unwrap();
        }
        if !matches!(self.layout, Layout::WithoutRobot) {
            fs::write(at("urdf").join("car.urdf"), self.urdf()).unwrap();
        }
        fs::write(at("config").join("lidar.yaml"), self.calibration(mistake)).unwrap();
        fs::write(at("config").join("radar.yaml"), self.radar(mistake)).unwrap();
        if self.has_drive || matches!(self.layout, Layout::WithoutRobot) {
            support::write(&self.drive(mistake), &at("bags").join("drive.mcap"));
        }
    }
}

/// A statement of where a sensor is, unturned.
fn stated(sensor: &str, [x, y, z]: [f64; 3]) -> String {
    format!("extrinsics:\n  - parent: base_link\n    child: {sensor}\n    xyz: [{x}, {y}, {z}]\n    rpy: [0, 0, 0]\n")
}

fn check(folder: &Path) -> Run {
    engine::check(&Options {
        paths: vec![folder.to_path_buf()],
        ..Options::default()
    })
    .unwrap()
}

/// Rule, file and message of what counts, of the files below a folder.
fn found(run: &Run, below: &Path) -> BTreeSet<(String, String, String)> {
    let counts = run
        .verdict
        .open()
        .filter(|finding| finding.confidence > Confidence::Hint);
    let key = counts.filter_map(|finding| {
        let place = finding.places.first()?;
        let path = &run.sources.get(place.place.source.0 as usize)?.path;
        let relative = Path::new(path).strip_prefix(below).ok()?;
        Some((
            finding.rule.clone(),
            relative.to_string_lossy().into_owned(),
            finding.message.clone(),
        ))
    });
    key.collect()
}

fn platform() -> impl Strategy<Value = Platform> {
    let part = |from: f64, to: f64| from..to;
    let lidar = (
        part(0.4, 2.0),
        part(-0.5, 0.5),
        part(1.0, 2.5),
        part(-0.04, 0.04),
        part(-0.04, 0.04),
        part(0.2, 1.2),
    );
    let layout = prop_oneof![Just(Layout::Flat), Just(Layout::ByKind), Just(Layout::WithoutRobot)];
    (lidar, layout, any::<bool>()).prop_map(|((x, y, z, roll, pitch, yaw), layout, has_drive)| Platform {
        lidar: [x, y, z, roll, pitch, yaw],
        layout,
        has_drive,
    })
}

fn mistake() -> impl Strategy<Value = Mistake> {
    prop_oneof![
        Just(Mistake::None),
        Just(Mistake::Inverse),
        Just(Mistake::Mirrored),
        Just(Mistake::Case),
        Just(Mistake::Late)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_found_in_one_of_several_platforms_is_what_is_found_there(
        platforms in proptest::collection::vec(platform(), 2..5),
        which in any::<prop::sample::Index>(),
        mistake in mistake(),
    ) {
        let root = tempfile::tempdir().unwrap();
        let wrong = which.index(platforms.len());
        for (number, platform) in platforms.iter().enumerate() {
            let mistake = if number == wrong { mistake } else { Mistake::None };
            platform.write(&root.path().join(format!("robot_{number}")), mistake);
        }
        let all = check(root.path());
        for number in 0..platforms.len() {
            let folder = root.path().join(format!("robot_{number}"));
            let (there, here) = (found(&check(&folder), &folder), found(&all, &folder));
            prop_assert_eq!(there.is_empty(), number != wrong || mistake == Mistake::None, "{:?}", there);
            prop_assert_eq!(here, there);
        }
    }
}

/// Two robots of one make whose lidars stand elsewhere, and a file in the folder above.
fn two_robots(above: &str) -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    for (name, x) in [("a", 0.9), ("b", 1.4)] {
        let platform = Platform {
            lidar: [x, 0.1, 1.8, 0.0, 0.0, 0.0],
            layout: Layout::Flat,
            has_drive: false,
        };
        platform.write(&root.path().join(name), Mistake::None);
    }
    fs::write(root.path().join("above.yaml"), above).unwrap();
    root
}

/// The notes on a file in the folder above two robots, and the rules that find something.
fn above(x: f64) -> (Vec<String>, Vec<String>) {
    let root = two_robots(&stated("lidar", [x, 0.1, 1.8]));
    let run = check(root.path());
    let is_above = |source: &&std::sync::Arc<frames_lint::source::Source>| source.path.ends_with("above.yaml");
    let above = run.sources.iter().find(is_above).unwrap();
    let rules = run.verdict.open().map(|finding| finding.rule.clone());
    (above.notes.clone(), rules.collect())
}

#[test]
fn what_states_the_transforms_of_one_robot_is_of_it() {
    let (notes, rules) = above(0.9);
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].contains("a/car.urdf`, whose transforms"), "{notes:?}");
    assert_eq!(rules, Vec::<String>::new());
}

#[test]
fn what_may_be_of_either_robot_is_judged_with_both_and_says_so() {
    let (notes, rules) = above(2.9);
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(
        notes[0].contains("a/car.urdf") && notes[0].contains("b/car.urdf"),
        "{notes:?}"
    );
    assert_eq!(rules, ["CROSS01", "CROSS01"], "metres off both");
}

/// Three robots of one make, sorted by kinds of files. Their lidars are nearly at one place, closer than a drawing is to a calibration.
/// `calibration_of` says whose numbers stand in the calibration that is called after a robot.
fn fleet(calibration_of: impl Fn(usize) -> usize) -> (tempfile::TempDir, Run) {
    let root = tempfile::tempdir().unwrap();
    let robot = |at: usize| Platform {
        lidar: [0.9 + 0.02 * at as f64, 0.11, 1.8, 0.01, 0.02, 0.3],
        layout: Layout::ByKind,
        has_drive: false,
    };
    for kind in ["urdf", "calibration"] {
        fs::create_dir(root.path().join(kind)).unwrap();
    }
    for (at, name) in ["alpha", "beta", "gamma"].iter().enumerate() {
        let file = |kind: &str, ending: &str| root.path().join(kind).join(format!("{name}{ending}"));
        fs::write(file("urdf", ".urdf"), robot(at).urdf()).unwrap();
        let calibration = robot(calibration_of(at)).calibration(Mistake::None);
        fs::write(file("calibration", "_lidar.yaml"), calibration).unwrap();
    }
    let run = check(root.path());
    (root, run)
}

#[test]
fn a_calibration_is_of_the_robot_that_it_is_called_after() {
    let (_root, healthy) = fleet(|at| at);
    let rules: Vec<&str> = healthy.verdict.open().map(|finding| finding.rule.as_str()).collect();
    assert_eq!(rules, Vec::<&str>::new());
    assert!(healthy.sources.iter().all(|source| source.notes.is_empty()));
    // The numbers of another robot do not make it that one's.
    let (_root, exchanged) = fleet(|at| 2 - at);
    let found: Vec<String> = exchanged.verdict.open().map(|finding| finding.rule.clone()).collect();
    assert_eq!(found, ["CROSS01", "CROSS01"], "4 cm off, where 5 mm may be");
}

#[test]
fn of_robots_that_are_nearly_alike_the_one_with_the_very_numbers_is_taken() {
    let (root, _) = fleet(|at| at);
    for (name, other) in [("alpha", "eins"), ("beta", "zwei"), ("gamma", "drei")] {
        let file = |name: &str| root.path().join(format!("calibration/{name}_lidar.yaml"));
        fs::rename(file(name), file(other)).unwrap();
    }
    let run = check(root.path());
    let notes: Vec<&String> = run.sources.iter().flat_map(|source| &source.notes).collect();
    assert!(
        notes.len() == 3 && notes.iter().all(|note| note.contains("whose transforms")),
        "{notes:?}"
    );
    assert_eq!(run.verdict.open().count(), 0);
}

/// Keys that may be names of frames count where nothing else tells.
#[test]
fn a_file_that_names_frames_by_its_keys_alone_is_judged_with_the_robots_beside_it() {
    let root = tempfile::tempdir().unwrap();
    for (name, x) in [("a", 0.9), ("b", 1.4)] {
        let platform = Platform {
            lidar: [x, 0.1, 1.8, 0.02, 0.03, 0.4],
            layout: Layout::Flat,
            has_drive: false,
        };
        fs::write(root.path().join(format!("{name}.urdf")), platform.urdf()).unwrap();
        if name == "b" {
            let inverse = platform.base_from_lidar().inverse().to_homogeneous();
            let rows: Vec<String> = inverse
                .row_iter()
                .map(|row| format!("[{}, {}, {}, {}]", row[0], row[1], row[2], row[3]))
                .collect();
            let text = format!("base_link_from_lidar: [{}]\n", rows.join(", "));
            fs::write(root.path().join("lidar.yaml"), text).unwrap();
        }
    }
    let run = check(root.path());
    let file = run
        .sources
        .iter()
        .find(|source| source.path.ends_with("lidar.yaml"))
        .unwrap();
    assert!(
        file.notes[0].ends_with("b.urdf`, whose transforms it states"),
        "{:?}",
        file.notes
    );
    let rules: BTreeSet<&str> = run.verdict.open().map(|finding| finding.rule.as_str()).collect();
    assert_eq!(rules, BTreeSet::from(["CROSS02"]));
}

#[test]
fn a_folder_beside_a_robot_that_has_its_own_calibration_is_not_its() {
    let root = two_robots("");
    fs::remove_file(root.path().join("above.yaml")).unwrap();
    let other = root.path().join("c");
    fs::create_dir(&other).unwrap();
    fs::write(other.join("sensors.yaml"), stated("lidar", [0.2, 0.0, 0.3])).unwrap();
    let run = check(root.path());
    assert_eq!(run.verdict.open().count(), 0);
    let alone = run
        .sources
        .iter()
        .find(|source| source.path.ends_with("c/sensors.yaml"))
        .unwrap();
    assert!(alone.notes[0].starts_with("checked without"), "{:?}", alone.notes);
}

/// A table of sensors has a row for each car, and these are calibrated one by one.
#[test]
fn the_rows_of_several_cars_do_not_contradict_each_other() {
    let root = tempfile::tempdir().unwrap();
    let sensors = r#"[{"token": "s1", "channel": "LIDAR_TOP", "modality": "lidar"}, {"token": "s2", "channel": "CAM_FRONT", "modality": "camera"}]"#;
    let row = |token: &str, sensor: &str, x: f64, rotation: &str| {
        format!(
            r#"{{"token": "{token}", "sensor_token": "{sensor}", "translation": [{x}, 0.01, 1.8], "rotation": [{rotation}], "camera_intrinsic": []}}"#
        )
    };
    let lidar = "0.7077955119, -0.0064922421, 0.0106462147, -0.7063073143";
    let camera = "0.4998015430, -0.5030316162, 0.4997798114, -0.4973708382";
    let rows = [
        row("a1", "s1", 0.94, lidar),
        row("b1", "s1", 0.99, lidar),
        row("a2", "s2", 1.70, camera),
        row("b2", "s2", 1.75, camera),
    ];
    fs::write(root.path().join("sensor.json"), sensors).unwrap();
    fs::write(
        root.path().join("calibrated_sensor.json"),
        format!("[{}]", rows.join(",\n")),
    )
    .unwrap();
    let run = check(root.path());
    let rules: Vec<&str> = run.verdict.open().map(|finding| finding.rule.as_str()).collect();
    assert!(rules.is_empty(), "{rules:?}");
}
