//! Evidence saved and judged again: the same report, byte for byte, and clear words where a document is no good.

#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::print_stderr,
    clippy::string_slice
)]

use std::fs;
use std::path::{Path, PathBuf};

use crate::support;
use crate::support::program;
use frames_lint::engine::{self, Options, evidence};
use frames_lint::report::{Style, json, terminal};
use frames_lint::run::{FailOn, Run};
use frames_lint::source::ReadStatus;

fn options(paths: &[&Path]) -> Options {
    Options {
        paths: paths.iter().map(|path| path.to_path_buf()).collect(),
        ..Options::default()
    }
}

fn check(options: &Options) -> Run {
    engine::check(options).unwrap()
}

fn report(run: &Run) -> String {
    json::render(run, FailOn::Error).unwrap()
}

fn human(run: &Run) -> String {
    let options = terminal::Options {
        style: Style::PLAIN,
        fail_on: FailOn::Error,
        verbose: true,
        all: true,
        parts: terminal::Parts::All,
    };
    terminal::render(run, &options)
}

/// Saves what is read of the paths.
fn save(paths: &[&Path], file: &Path) -> Run {
    let run = engine::collect(&options(paths)).unwrap();
    fs::write(file, evidence::write(&run).unwrap()).unwrap();
    run
}

/// Judges the paths, if that was not done, and again what was saved of them: nothing may differ.
pub(crate) fn is_the_same(paths: &[&Path], what: &str, judged: Option<&Run>) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("evidence.json");
    let read = save(paths, &file);
    let text = fs::read(&file).unwrap();

    let saved = evidence::parse(&text).unwrap_or_else(|why| panic!("{what}: {why}"));
    let mut sources = read.sources.clone();
    for source in sources.iter_mut().map(std::sync::Arc::make_mut) {
        // Where the files lie is a matter of this machine.
        source.files.clear();
        source.meshes.clear();
    }
    assert_eq!(format!("{:?}", saved.sources), format!("{sources:?}"), "{what}");
    assert_eq!(saved.worlds.len(), read.worlds.len(), "{what}");
    for (saved, read) in saved.worlds.iter().zip(&read.worlds) {
        assert_eq!((&saved.label, &saved.members), (&read.label, &read.members), "{what}");
        assert_eq!(format!("{:?}", saved.claims), format!("{:?}", read.claims), "{what}");
        assert_eq!(format!("{:?}", saved.robots), format!("{:?}", read.robots), "{what}");
        assert_eq!(format!("{:?}", saved.frames), format!("{:?}", read.frames), "{what}");
        assert!(format!("{:?}", saved.bags) == format!("{:?}", read.bags), "{what}");
        assert_eq!(format!("{:?}", saved.chains), format!("{:?}", read.chains), "{what}");
        assert_eq!(
            format!("{:?}", saved.references),
            format!("{:?}", read.references),
            "{what}"
        );
    }
    let again = Run {
        worlds: saved.worlds,
        sources: saved.sources.to_vec(),
        skipped: saved.skipped,
        ..Run::default()
    };
    assert!(
        evidence::write(&again).unwrap().as_bytes() == text,
        "{what}: written twice"
    );

    let own = judged.is_none().then(|| check(&options(paths)));
    let direct = judged.or(own.as_ref()).unwrap();
    let judged = check(&Options {
        evidence: vec![file],
        // Evidence is saved elsewhere; what was declared beside the files is handed along.
        config: paths
            .iter()
            .map(|path| path.join("frames-lint.yaml"))
            .find(|path| path.is_file()),
        ..Options::default()
    });
    let (expected, given) = (report(direct), report(&judged));
    if let Some((line, (expected, given))) = expected
        .lines()
        .zip(given.lines())
        .enumerate()
        .find(|(_, (a, b))| a != b)
    {
        panic!("{what}, line {}:\n{expected}\n{given}", line + 1);
    }
    assert_eq!(expected.len(), given.len(), "{what}");
    assert_eq!(human(direct), human(&judged), "{what}");
    assert_eq!(direct.exit_code(FailOn::Error), judged.exit_code(FailOn::Error));
}

#[test]
fn evidence_from_before_members_and_sentences_were_kept_is_judged() {
    fn strip(value: &mut serde_json::Value) {
        match value {
            serde_json::Value::Object(fields) => {
                for later in ["members", "orientations", "vectors", "nmea"] {
                    // The platform's own list of sources has that name, too.
                    if !fields.get(later).is_some_and(serde_json::Value::is_array) {
                        fields.remove(later);
                    }
                }
                fields.values_mut().for_each(strip);
            }
            serde_json::Value::Array(all) => all.iter_mut().for_each(strip),
            _ => {}
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let (bag, file) = (folder.path().join("drive.mcap"), folder.path().join("evidence.json"));
    let recipe = "
        drive: {motion: turning}
        topics:
          - {topic: /ins, from_drive: ins, rate_hz: 20, frame_id: imu}
          - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps}
          - {topic: /nmea, from_drive: nmea, rate_hz: 5, frame_id: gps, sentences: [GGA]}
        ";
    support::write(recipe, &bag);
    save(&[&bag], &file);
    let mut saved: serde_json::Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    strip(&mut saved);
    let text = serde_json::to_vec(&saved).unwrap();
    assert!(!String::from_utf8_lossy(&text).contains("geoid_separation_m"));
    let loaded = evidence::parse(&text).unwrap();
    let topics = &loaded.worlds[0].bags[0].topics;
    assert!(topics["/ins"].members.is_empty() && topics["/fix"].content.motion.fixes.is_some());
    assert!(topics["/nmea"].content.motion.nmea.is_none());
}

#[test]
fn every_robot_is_judged_the_same() {
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/robots");
    let all = tempfile::tempdir().unwrap();
    for robot in fs::read_dir(robots).unwrap() {
        let robot = robot.unwrap().path();
        let folder = all.path().join(robot.file_name().unwrap());
        fs::create_dir(&folder).unwrap();
        support::copy_platform(&robot, &folder);
        is_the_same(&[&folder], &robot.display().to_string(), None);
    }
    // Several platforms in one document, and a file that cannot be read.
    fs::write(all.path().join("broken.mcap"), "\u{89}MCAP?").unwrap();
    is_the_same(&[all.path()], "all robots", None);
}

const FAULTY: &str = "
metadata: {run: {driver: Ada}}
topics:
  - topic: /tf
    rate_hz: 20
    transforms:
      - {parent: odom, child: base_link, quaternion: [.nan, .inf, -.inf, 1]}
      - {parent: base_link, child: imu, xyz: [.nan, 0, 1e308]}
      - {parent: base_link, child: gps, xyz: [1e308, -1e308, 0], alternate: {by: [-1e308, 0, 0]}}
  - {topic: /odom, type: nav_msgs/msg/Odometry, rate_hz: 20, twist: {linear: [.nan, 0, 0], angular: [.inf, 0, 0]}}
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 20, angular_velocity: [.nan, 0, 0],
     orientation_covariance: [.nan, 0, 0, 0, .inf, 0, 0, 0, -.inf]}
  - {topic: /gps, type: sensor_msgs/msg/NavSatFix, rate_hz: 20, nan_from_s: 4, altitude: -.inf}
";

/// A robot whose numbers are none.
const NO_NUMBERS: &str = "<robot name='r'><link name='a'><inertial><mass value='nan'/>
<inertia ixx='inf' ixy='0' ixz='0' iyy='nan' iyz='0' izz='-inf'/></inertial></link><link name='b'/>
<joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='nan inf 0' rpy='-inf x 1e400'/></joint></robot>";

const CALIBRATION: &str =
    "cam0:\n  T_cam_imu:\n  - [.nan, 0, 0, 1]\n  - [0, .inf, 0, 0]\n  - [0, 0, -.inf, 0]\n  - [0, 0, 0, 1]\n";

#[test]
fn numbers_that_are_none_come_back() {
    let folder = tempfile::tempdir().unwrap();
    support::write(FAULTY, &folder.path().join("drive.mcap"));
    fs::write(folder.path().join("robot.urdf"), NO_NUMBERS).unwrap();
    fs::write(folder.path().join("camera.yaml"), CALIBRATION).unwrap();
    is_the_same(&[folder.path()], "no numbers", None);
    is_the_same(
        &[&folder.path().join("drive.mcap"), &folder.path().join("robot.urdf")],
        "named",
        None,
    );
}

#[test]
fn every_real_recording_is_judged_the_same() {
    let Some(folder) = support::real_bags() else { return };
    let mut count = 0;
    for ending in [".mcap", ".bag", ".db3"] {
        for bag in support::files(&folder, ending) {
            let is_small = fs::metadata(&bag).is_ok_and(|meta| meta.len() < 32 << 20);
            if bag.to_string_lossy().ends_with(ending) && is_small {
                is_the_same(&[&bag], &bag.display().to_string(), None);
                count += 1;
            }
        }
    }
    // A folder with its metadata is one recording, however many files it has.
    for metadata in support::files(&folder, "metadata.yaml") {
        let recording = metadata.parent().unwrap();
        is_the_same(&[recording], &recording.display().to_string(), None);
        count += 1;
    }
    eprintln!("{count} recordings");
}

#[test]
fn documents_and_paths_are_judged_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let orphan = |frame: &str| format!("topics: [{{topic: /{frame}, type: sensor_msgs/msg/Imu, frame_id: {frame}}}]");
    for name in ["a", "b", "c"] {
        fs::create_dir(path(name)).unwrap();
        support::write(&orphan(name), &path(name).join("drive.mcap"));
        fs::write(
            path(name).join("robot.urdf"),
            format!("<robot name='r'><link name='{name}'/><link name='{name}'/></robot>"),
        )
        .unwrap();
    }
    save(&[&path("a")], &path("a.json"));
    save(&[&path("b")], &path("b.json"));
    let run = check(&Options {
        paths: vec![path("c")],
        evidence: vec![path("a.json"), path("b.json")],
        ..Options::default()
    });
    let text = human(&run);
    let names: Vec<&str> = run.sources.iter().map(|source| source.path.as_str()).collect();
    assert_eq!(names.len(), 6, "{names:?}");
    for (at, source) in run.sources.iter().enumerate() {
        assert_eq!(source.id.0 as usize, at);
    }
    for finding in &run.verdict.findings {
        let place = &finding.places[0].place;
        let source = &run.sources[place.source.0 as usize];
        let robot = Path::new(&source.path)
            .parent()
            .unwrap()
            .file_name()
            .unwrap()
            .to_string_lossy();
        assert!(
            finding.subject.contains(&format!("/{robot}/")),
            "{}: {}",
            finding.subject,
            source.path
        );
    }
    for name in ["a", "b", "c"] {
        let twice = run
            .verdict
            .findings
            .iter()
            .filter(|finding| finding.subject.contains(&format!("/{name}/")));
        assert!(twice.count() > 0, "{name}\n{text}");
    }
}

fn program(folder: &Path, arguments: &[&str]) -> program::CallResult {
    program::run(folder, arguments)
}

#[test]
fn the_program_saves_and_judges() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    support::write(FAULTY, &at.join("drive.mcap"));
    let saved = program(at, &["collect", "drive.mcap", "-o", "evidence.json"]);
    assert_eq!((saved.code, saved.out.len()), (0, 0), "{}", saved.err);
    let printed = program(at, &["collect", "drive.mcap"]);
    assert!(printed.out == fs::read(at.join("evidence.json")).unwrap());
    let direct = program(at, &["check", "drive.mcap", "--format", "json"]);
    // The document stands for itself.
    fs::rename(at.join("drive.mcap"), at.join("elsewhere")).unwrap();
    let judged = program(at, &["check", "--evidence", "evidence.json", "--format", "json"]);
    assert_eq!(judged.code, 1);
    assert!(direct.out == judged.out);
    judged.report();
    assert_eq!(program(at, &["collect", "missing.mcap"]).code, 3);
    assert_eq!(program(at, &["collect"]).code, 2);
    assert_eq!(program(at, &["check", "--evidence"]).code, 2);
    assert_eq!(program(at, &["collect", "elsewhere", "-o", "no/such/folder"]).code, 2);
    // In place of a path it is not taken for a calibration.
    let confused = program(at, &["check", "evidence.json"]);
    assert_eq!(confused.code, 3);
    assert!(confused.text().contains("--evidence"), "{}", confused.text());
}

#[test]
fn what_is_no_evidence_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    support::write(
        "topics: [{topic: /tf, transforms: [{parent: a, child: b}]}]",
        &at.join("drive.mcap"),
    );
    save(&[&at.join("drive.mcap")], &at.join("good.json"));
    let good = fs::read_to_string(at.join("good.json")).unwrap();
    let table = [
        ("empty", String::new(), "line 1 column 0"),
        ("garbage", "\u{7f}ELF".to_owned(), "line 1 column 1"),
        ("list", "[1, 2]".to_owned(), "line 1 column"),
        ("other", "{\"a\": 1}".to_owned(), "is missing"),
        (
            "newer",
            good.replace("evidence/1", "evidence/2"),
            "`frames-lint-evidence/2` (written by frames-lint 0.",
        ),
        (
            "cut",
            good[..good.len() / 2].to_owned(),
            &format!("line 1 column {}", good.len() / 2),
        ),
        (
            "missing",
            good.replace("\"truncated\"", "\"trunc\""),
            "missing field `truncated`",
        ),
        (
            "ids",
            good.replace("\"members\":[0]", "\"members\":[7]"),
            "there is no source 7",
        ),
        ("deep", "[".repeat(1_000_000), "line 1 column"),
    ];
    for (name, text, says) in table {
        fs::write(at.join("bad.json"), text).unwrap();
        for arguments in [
            vec!["check", "--evidence", "bad.json"],
            vec!["check", "drive.mcap", "--evidence", "bad.json"],
        ] {
            let ran = program(at, &arguments);
            assert_eq!(ran.code, 3, "{name}: {}", ran.err);
            let text = ran.text().split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(
                text.contains(says) && text.contains("bad.json"),
                "{name}: {says}\n{text}"
            );
        }
    }
    assert_eq!(program(at, &["check", "--evidence", "nowhere.json"]).code, 3);
    assert_eq!(program(at, &["check", "--evidence", "."]).code, 3);
}

/// Whatever is changed in a document: an answer, no panic.
#[test]
fn altered_documents_are_judged_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("evidence.json");
    let (bag, robot): (PathBuf, PathBuf) = (folder.path().join("drive.mcap"), folder.path().join("robot.urdf"));
    support::write(&FAULTY.replace("rate_hz: 20", "rate_hz: 2"), &bag);
    fs::write(&robot, NO_NUMBERS).unwrap();
    save(&[folder.path()], &file);
    let good = fs::read(&file).unwrap();
    let mut random: u64 = 7;
    let mut judged = 0;
    for round in 0..400 {
        let mut bytes = good.clone();
        for _ in 0..=round % 4 {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let at = (random >> 33) as usize % bytes.len();
            if bytes[at].is_ascii_digit() {
                bytes[at] = b'0' + random.to_be_bytes()[2] % 10;
            } else if round % 3 == 0 {
                bytes[at] = random.to_be_bytes()[1];
            }
        }
        fs::write(&file, bytes).unwrap();
        let run = check(&Options {
            evidence: vec![file.clone()],
            ..Options::default()
        });
        let crashed: Vec<_> = run
            .verdict
            .rows
            .iter()
            .filter(|row| row.outcome.word() == "crashed")
            .collect();
        assert!(crashed.is_empty(), "round {round}: {crashed:?}");
        human(&run);
        report(&run);
        judged += u32::from(run.sources.iter().all(|source| source.status == ReadStatus::Read));
    }
    assert!(judged > 100, "{judged}");
}
