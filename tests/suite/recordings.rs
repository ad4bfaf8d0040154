//! Several recordings in one run: a verdict each, the same as if each had been checked alone; what their files share is told once; what
//! compares them is asked of all together.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use frames_lint::engine::{self, Options};
use frames_lint::run::{FailOn, Run, VerdictWord};
use frames_lint::verdict::waiver::plain_subject;
use frames_lint::verdict::{Finding, Outcome, Row};
use serde_json::Value;

use crate::support;
use crate::support::program::{self, CallResult};

const ROBOT: &str = r#"<robot name="car">
  <link name="base_link"/>
  <link name="imu"/>
  <link name="lidar"/>
  <joint name="imu_joint" type="fixed">
    <parent link="base_link"/><child link="imu"/><origin xyz="0.42 0.11 0.27"/>
  </joint>
  <joint name="lidar_joint" type="fixed">
    <parent link="base_link"/><child link="lidar"/><origin xyz="0.95 0.04 1.85"/>
  </joint>
</robot>
"#;

/// A drive that begins so many minutes after the first one, with the lidar at this height.
fn drive(minutes: u32, lidar_z: f64) -> String {
    format!(
        "\
start_s: {start}
duration_s: 20
topics:
  - topic: /tf_static
    transforms:
      - {{parent: base_link, child: imu, xyz: [0.42, 0.11, 0.27]}}
      - {{parent: base_link, child: lidar, xyz: [0.95, 0.04, {lidar_z}]}}
  - topic: /tf
    rate_hz: 20
    transforms:
      - {{parent: odom, child: base_link, velocity: [3, 0, 0], yaw_rate_deg_s: 4}}
  - {{topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 50, frame_id: imu}}
",
        start = 1_700_000_000 + 60 * minutes
    )
}

/// The same with all stamps 18 s ahead.
fn late(drive: &str) -> String {
    drive.replace("frame_id: imu}", "frame_id: imu, stamp_offset_s: 18}")
}

fn folder(recordings: &[(&str, &str)], files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, recipe) in recordings {
        support::write(recipe, &folder.path().join(name));
    }
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn check(paths: &[&Path]) -> Run {
    engine::check(&Options {
        paths: paths.iter().map(|path| path.to_path_buf()).collect(),
        ..Options::default()
    })
    .unwrap()
}

fn program(folder: &Path, arguments: &[&str]) -> CallResult {
    program::run(folder, [&["check", "."], arguments].concat())
}

/// Whether a waiver or an entry of a baseline accepts nothing.
fn is_stale(ran: &CallResult) -> bool {
    let report = ran.report();
    let mut findings = report["findings"].as_array().unwrap().iter();
    findings.any(|one| one["rule"] == "GATE01")
}

/// Outcomes in words, without the name of the platform.
fn rows<'a>(rows: impl IntoIterator<Item = &'a Row>, platforms: &[String]) -> BTreeSet<String> {
    let words = |row: &Row| {
        let subject = plain_subject(&row.subject, platforms);
        let (outcome, measured) = (row.outcome.word(), &row.measured);
        // "explained by RULE of SUBJECT" names a subject too.
        let reason = row.reason.as_deref().map(|reason| match reason.split_once(" of ") {
            Some((rule, of)) if row.outcome == Outcome::Explained => {
                format!("{rule} of {}", plain_subject(of, platforms))
            }
            _ => reason.to_owned(),
        });
        format!("{} {subject}: {outcome} {reason:?} {measured:?}", row.rule)
    };
    rows.into_iter().map(words).collect()
}

fn verdicts(run: &Run) -> Vec<(String, VerdictWord, u8)> {
    let short = |label: &str| label.rsplit('/').next().unwrap().to_owned();
    let words = run.recordings.iter();
    words
        .map(|one| (short(&one.label), one.summary.verdict, one.code))
        .collect()
}

#[test]
fn each_recording_has_the_verdict_that_it_has_alone() {
    let (first, second) = (drive(0, 1.85), late(&drive(10, 1.85)));
    let folder = folder(&[("a.mcap", &first), ("b.mcap", &second)], &[("car.urdf", ROBOT)]);
    let path = |name: &str| folder.path().join(name);
    let all = check(&[folder.path()]);
    assert_eq!(
        verdicts(&all),
        [
            ("a.mcap".to_owned(), VerdictWord::Clean, 0),
            ("b.mcap".to_owned(), VerdictWord::Findings, 1)
        ]
    );
    assert_eq!(all.exit_code(FailOn::Error), 1);
    for (at, name) in ["a.mcap", "b.mcap"].into_iter().enumerate() {
        let alone = check(&[&path("car.urdf"), &path(name)]);
        assert!(alone.recordings.is_empty(), "one recording is the run itself");
        let label = &all.recordings[at].label;
        let own: Vec<Row> = all
            .verdict
            .rows
            .iter()
            .filter(|row| row.subject.starts_with(&format!("{label}: ")))
            .cloned()
            .collect();
        // What is said of waivers is of the run.
        let robot = alone.verdict.rows.iter().filter(|row| !row.rule.starts_with("GATE"));
        assert_eq!(rows(&own, &all.platforms), rows(robot, &alone.platforms), "{name}");
        assert!(own.len() > 100);
        let summary = alone.summary(FailOn::Error);
        let told = all.recordings[at].summary;
        assert_eq!(
            (told.errors, told.warnings, told.notes, told.passed, told.verdict),
            (
                summary.errors,
                summary.warnings,
                summary.notes,
                summary.passed,
                summary.verdict
            )
        );
        let because = all.recordings[at].because.as_deref();
        assert_eq!(because, alone.because(FailOn::Error).as_deref());
    }
}

#[test]
fn a_mount_that_moved_between_two_drives_is_found_once() {
    let folder = folder(
        &[
            ("a.mcap", &drive(0, 1.85)),
            ("b.mcap", &drive(10, 1.85)),
            ("c.mcap", &drive(20, 1.95)),
        ],
        &[],
    );
    let run = check(&[folder.path()]);
    let across: Vec<&Finding> = run.verdict.findings.iter().filter(|one| one.rule == "TREE11").collect();
    assert_eq!(across.len(), 1, "{across:#?}");
    let files: Vec<&str> = across[0]
        .places
        .iter()
        .map(|label| {
            run.sources[label.place.source.0 as usize]
                .path
                .rsplit('/')
                .next()
                .unwrap()
        })
        .collect();
    assert_eq!(files, ["c.mcap", "a.mcap"]);
    // It is of none of them by itself.
    assert!(
        run.recordings
            .iter()
            .all(|one| one.summary.verdict == VerdictWord::Clean)
    );
    let rows: Vec<&Row> = run.verdict.rows.iter().filter(|row| row.rule == "TREE11").collect();
    let of = |outcome: Outcome| rows.iter().filter(|row| row.outcome == outcome).count();
    // One for each recording, and one for the transforms that all of them share.
    assert_eq!((of(Outcome::Pass), of(Outcome::Fail)), (4, 1), "{rows:#?}");

    let calm = self::folder(&[("a.mcap", &drive(0, 1.85)), ("b.mcap", &drive(10, 1.85))], &[]);
    let run = check(&[calm.path()]);
    assert!(run.verdict.findings.iter().all(|one| one.rule != "TREE11"));
}

#[test]
fn what_was_recorded_at_the_same_time_is_of_one_drive() {
    // The transforms in one file, the sensor in the other: alone each lacks something.
    let whole = drive(0, 1.85);
    let at = whole.find("  - {topic: /imu").unwrap();
    let imu = whole[..whole.find("  - topic").unwrap()].to_owned() + &whole[at..];
    let folder = folder(
        &[
            ("imu.mcap", &imu),
            ("tf.mcap", &whole[..at]),
            ("z.mcap", &drive(60, 1.85)),
        ],
        &[],
    );
    let run = check(&[folder.path()]);
    let names: Vec<usize> = run.recordings.iter().map(|one| one.sources.len()).collect();
    assert_eq!(names, [2, 1], "{:?}", verdicts(&run));
    let frames: Vec<&Row> = run
        .verdict
        .rows
        .iter()
        .filter(|row| row.rule == "TREE07" && row.outcome == Outcome::Pass)
        .collect();
    assert_eq!(
        frames.len(),
        2,
        "the frame of the sensor is found in the other file: {frames:#?}"
    );
}

#[test]
fn clouds_of_one_file_are_held_against_the_odometry_of_the_other() {
    // The one begins 2 s after the other.
    let head = "duration_s: 14\ndrive: {vehicle: car, motion: turning, seed: 3}\ntopics:\n";
    let odometry = "  - {topic: /tf_static, transforms: [{parent: base_link, child: velodyne, xyz: [0, 0, 1.8]}]}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}\n";
    for (yaw_deg, wanted) in [(0, Outcome::Pass), (60, Outcome::Fail)] {
        let clouds = format!(
            "  - {{topic: /points, from_drive: lidar, rate_hz: 10, from_s: 2, frame_id: velodyne, xyz: [0, 0, 1.8], rpy_deg: [0, 0, {yaw_deg}], lidar: {{beams: 16, columns: 180, driver: velodyne}}}}\n"
        );
        let folder = folder(
            &[
                ("clouds.mcap", &(head.to_owned() + &clouds)),
                ("odometry.mcap", &(head.to_owned() + odometry)),
            ],
            &[],
        );
        let run = check(&[folder.path()]);
        assert!(run.recordings.is_empty(), "one drive: {:?}", verdicts(&run));
        let rows = run.verdict.rows.iter().filter(|row| row.rule == "AXES12");
        let outcomes: Vec<_> = rows.map(|row| (&row.outcome, &row.reason)).collect();
        assert!(
            matches!(outcomes[..], [(outcome, _)] if *outcome == wanted),
            "{yaw_deg} deg: {outcomes:#?}"
        );
    }
}

#[test]
fn recordings_of_one_time_in_folders_side_by_side_are_each_judged() {
    let folder = tempfile::tempdir().unwrap();
    for (name, drive) in [("a", drive(0, 1.85)), ("b", late(&drive(0, 1.85)))] {
        fs::create_dir(folder.path().join(name)).unwrap();
        support::write(&drive, &folder.path().join(name).join("drive.mcap"));
    }
    let run = check(&[folder.path()]);
    let labels: Vec<&str> = run.recordings.iter().map(|one| one.label.as_str()).collect();
    assert_eq!(labels.len(), 2, "{labels:?}");
    for (name, one) in ["a", "b"].iter().zip(&run.recordings) {
        assert!(one.label.ends_with(&format!("{name}/drive.mcap")), "{labels:?}");
        let alone = check(&[&folder.path().join(name)]);
        assert_eq!(
            one.summary.passed,
            alone.summary(FailOn::default()).passed,
            "{}",
            one.label
        );
        assert_eq!(one.code, alone.exit_code(FailOn::default()), "{}", one.label);
    }
    let codes: Vec<u8> = run.recordings.iter().map(|one| one.code).collect();
    assert_eq!(codes, [0, 1], "the second one's sensor is 18 s ahead");
    for (of, other) in [("a", "b"), ("b", "a")] {
        let source = run
            .sources
            .iter()
            .find(|source| source.path.ends_with(&format!("{of}/drive.mcap")));
        let notes = &source.unwrap().notes;
        let is_said =
            |note: &String| note.contains("at the same time") && note.contains(&format!("{other}/drive.mcap"));
        assert!(notes.iter().any(is_said), "{notes:?}");
    }
}

#[test]
fn what_is_wrong_in_a_file_counts_for_every_recording_and_is_told_once() {
    let robot = ROBOT.replace("<link name=\"imu\"/>", "<link name=\"imu\"/><link name=\"imu\"/>");
    let folder = folder(
        &[("a.mcap", &drive(0, 1.85)), ("b.mcap", &drive(10, 1.85))],
        &[("car.urdf", &robot)],
    );
    let run = check(&[folder.path()]);
    let twice: Vec<&Finding> = run.verdict.findings.iter().filter(|one| one.rule == "URDF05").collect();
    assert_eq!(twice.len(), 1, "{:#?}", run.verdict.findings);
    assert!(run.recordings.iter().all(|one| one.code == 1), "{:?}", verdicts(&run));
    let failed: Vec<&Row> = run
        .verdict
        .rows
        .iter()
        .filter(|row| row.outcome == Outcome::Fail)
        .collect();
    for row in &failed {
        let is_told = |finding: &Finding| finding.rule == row.rule && finding.subject == row.subject;
        assert!(run.verdict.findings.iter().any(is_told), "no finding says why: {row:?}");
    }
}

#[test]
fn a_recording_in_which_nothing_could_be_checked_is_no_pass() {
    let folder = folder(&[("a.mcap", &drive(0, 1.85)), ("empty.mcap", "topics: []")], &[]);
    let ran = program(folder.path(), &[]);
    assert_eq!(ran.code, 3, "{}", ran.text());
    let text = ran.text();
    assert!(text.contains("incomplete       0         0       0"), "{text}");
    assert!(
        text.contains("Of 2 recordings 1 is clean and 1 is incomplete."),
        "{text}"
    );
    fs::write(folder.path().join("broken.bag"), "#ROSBAG V2.0\n").unwrap();
    let ran = program(folder.path(), &[]);
    assert_eq!(ran.code, 3, "{}", ran.text());
    assert!(
        ran.text().contains("Of 3 recordings 1 is clean and 2 are incomplete."),
        "{}",
        ran.text()
    );
}

#[test]
fn what_is_required_is_required_of_each_recording() {
    let whole = drive(10, 1.85);
    let (before, behind) = (
        whole.find("  - topic: /tf\n").unwrap(),
        whole.find("  - {topic: /imu").unwrap(),
    );
    let without = whole[..before].to_owned() + &whole[behind..];
    let config = "require: [TREE10, URDF05]\n";
    let folder = folder(
        &[("a.mcap", &drive(0, 1.85)), ("b.mcap", &without)],
        &[("car.urdf", ROBOT), ("frames-lint.yaml", config)],
    );
    let ran = program(folder.path(), &["--format", "json"]);
    assert_eq!(ran.code, 3, "{}", ran.text());
    let report = ran.report();
    let required = report["required"].as_array().unwrap();
    assert_eq!(required.len(), 1, "{required:#?}");
    assert_eq!(required[0]["rule"], "TREE10");
    assert_eq!(required[0]["recordings"], serde_json::json!(["b.mcap"]));
    assert!(required[0]["record"].as_str().is_some(), "{required:#?}");
    let codes: Vec<&Value> = report["recordings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| &one["exit_code"])
        .collect();
    assert_eq!(codes, [0, 3]);
    assert!(program(folder.path(), &[]).text().contains("in b.mcap"));

    // A waiver for the rule accepts it, and has been of use.
    let config = "require: [TREE10]\nwaivers:\n  - {rule: TREE10, reason: the second drive stood}\n";
    fs::write(folder.path().join("frames-lint.yaml"), config).unwrap();
    let ran = program(folder.path(), &["--format", "json"]);
    assert_eq!(ran.code, 0, "{}", ran.text());
    assert!(!is_stale(&ran), "{}", ran.text());
}

#[test]
fn waivers_and_baselines_hold_for_the_recording_that_they_are_for() {
    let recordings = [
        ("a.mcap", drive(0, 1.85)),
        ("b.mcap", late(&drive(10, 1.85))),
        ("c.mcap", late(&drive(20, 1.85))),
    ];
    let recordings: Vec<(&str, &str)> = recordings.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let waiver = "waivers:\n  - {rule: TIME01, file: b.mcap, reason: known}\n";
    let folder = folder(&recordings, &[("frames-lint.yaml", waiver)]);
    let codes = |ran: &CallResult| -> Vec<u64> {
        let report = ran.report();
        let recordings = report["recordings"].as_array().unwrap();
        recordings
            .iter()
            .map(|one| one["exit_code"].as_u64().unwrap())
            .collect()
    };
    let ran = program(folder.path(), &["--format", "json"]);
    assert_eq!((ran.code, codes(&ran)), (1, vec![0, 0, 1]), "{}", ran.text());
    assert!(!is_stale(&ran), "{}", ran.text());

    let known = program(folder.path(), &["--write-baseline", "known.json", "--format", "json"]);
    assert_eq!(known.code, 0, "{}", known.text());
    let ran = program(folder.path(), &["--baseline", "known.json", "--format", "json"]);
    assert_eq!((ran.code, codes(&ran)), (0, vec![0, 0, 0]), "{}", ran.text());
    assert!(!is_stale(&ran), "{}", ran.text());
    // What was fixed is no longer to be accepted.
    support::write(&drive(20, 1.85), &folder.path().join("c.mcap"));
    let ran = program(folder.path(), &["--baseline", "known.json", "--format", "json"]);
    assert!(is_stale(&ran), "{}", ran.text());
}

/// The lines of `--format json-lines`.
fn parsed(ran: &CallResult) -> Vec<Value> {
    let text = ran.text();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// A line or a part of a document, without the type that lines have.
fn without_type(part: &Value) -> String {
    let mut keys: BTreeMap<String, Value> = serde_json::from_value(part.clone()).unwrap();
    keys.remove("type");
    format!("{keys:?}")
}

#[test]
fn lines_come_recording_by_recording_and_are_those_of_the_document() {
    let folder = folder(
        &[
            ("a.mcap", &drive(0, 1.85)),
            ("b.mcap", &late(&drive(10, 1.85))),
            ("c.mcap", &drive(20, 1.95)),
        ],
        &[("car.urdf", ROBOT)],
    );
    let ran = program(folder.path(), &["--format", "json-lines"]);
    assert_eq!(ran.code, 1, "{}", ran.text());
    let lines = parsed(&ran);
    let kinds: Vec<&str> = lines.iter().map(|line| line["type"].as_str().unwrap()).collect();
    assert_eq!((kinds[0], *kinds.last().unwrap()), ("run", "summary"));
    let labels: Vec<&Value> = lines
        .iter()
        .filter(|line| line["type"] == "recording")
        .map(|line| &line["label"])
        .collect();
    assert_eq!(labels, ["a.mcap", "b.mcap", "c.mcap"]);
    // Of the second nothing is told before the verdict of the first, and that of the second before anything of the third.
    let at = |label: &str| {
        let is_of = |line: &&Value| {
            line["subject"]
                .as_str()
                .is_some_and(|subject| subject.starts_with(label))
        };
        lines.iter().position(|line| is_of(&line)).unwrap()
    };
    let end = |label: &str| lines.iter().position(|line| line["label"] == label).unwrap();
    assert!(end("a.mcap") < at("b.mcap") && end("b.mcap") < at("c.mcap"));

    let document = program(folder.path(), &["--format", "json"]).report();
    for (kind, key) in [
        ("input", "inputs"),
        ("outcome", "outcomes"),
        ("finding", "findings"),
        ("recording", "recordings"),
    ] {
        let mut told: Vec<String> = lines
            .iter()
            .filter(|line| line["type"] == kind)
            .map(without_type)
            .collect();
        let mut known: Vec<String> = document[key].as_array().unwrap().iter().map(without_type).collect();
        told.sort();
        known.sort();
        assert_eq!(told, known, "{kind}");
    }
    let mut summary = lines.last().unwrap().clone();
    summary.as_object_mut().unwrap().remove("type");
    for (key, count) in summary.as_object().unwrap() {
        assert_eq!(count, &document["summary"][key], "{key}");
    }
    // The file has the same bytes, whatever the number of threads.
    for threads in ["1", "7"] {
        let arguments = ["check", ".", "--output", "json-lines=lines"];
        program::run_with(folder.path(), arguments, &[("RAYON_NUM_THREADS", threads)]);
        assert_eq!(fs::read_to_string(folder.path().join("lines")).unwrap(), ran.text());
    }
}

#[test]
fn what_a_configuration_asks_is_answered_the_same_in_lines() {
    let recordings = [
        ("a.mcap", &*drive(0, 1.85)),
        ("b.mcap", &late(&drive(10, 1.85))),
        ("c.mcap", &drive(20, 1.95)),
    ];
    for config in [
        "require: [AXES02, TIME03]\n",
        "require: [{share: 0.9}]\n",
        "require: [TREE01, {rule: TREE03, subject: 'nobody*'}]\n",
        "waivers: [{rule: TIME01, reason: known}]\nrequire: [TIME01]\n",
        "waivers: [{rule: TIME01, subject: '/imu*', reason: known}, {rule: GEO01, reason: nothing has it}]\n",
        "fail-on: warning\nwaivers: [{rule: CROSS06, reason: it was moved}]\n",
    ] {
        let folder = folder(&recordings, &[("car.urdf", ROBOT), ("frames-lint.yaml", config)]);
        let document = program(folder.path(), &["--format", "json"]);
        let lines = program(folder.path(), &["--format", "json-lines"]);
        assert_eq!(document.code, lines.code, "{config}");
        let document = document.report();
        let told = parsed(&lines);
        for (kind, key) in [
            ("required", "required"),
            ("finding", "findings"),
            ("recording", "recordings"),
        ] {
            let mut of_kind: Vec<String> = told
                .iter()
                .filter(|line| line["type"] == kind)
                .map(without_type)
                .collect();
            let mut known: Vec<String> = document[key].as_array().unwrap().iter().map(without_type).collect();
            of_kind.sort();
            known.sort();
            assert_eq!(of_kind, known, "{config} {kind}");
        }
        assert_eq!(
            without_type(told.last().unwrap()),
            without_type(&document["summary"]),
            "{config}"
        );
    }
}

#[test]
fn lines_of_ten_times_as_many_recordings_take_hardly_more_memory() {
    // A map over fixes: where it begins is compared, and that alone is kept.
    let drive = drive(0, 1.85)
        + "  - {topic: /pose, from_drive: pose, rate_hz: 10, frame_id: map}\n  - {topic: /fix, from_drive: fix, rate_hz: 10, frame_id: gps}\n";
    let drive = drive.replace("topics:", "drive: {vehicle: car, motion: turning, seed: 5}\ntopics:");
    let drive = support::build(&drive);
    let peak = |count: usize| {
        let folder = tempfile::tempdir().unwrap();
        for number in 0..count {
            fs::write(folder.path().join(format!("{number:03}.mcap")), &drive).unwrap();
        }
        let ran = program(
            folder.path(),
            &["--format", "json-lines", "--output", "json-lines=lines"],
        );
        assert!(ran.code < 2, "{}", ran.err);
        ran.peak_mb
    };
    let (few, many) = (peak(60), peak(600));
    assert!(many <= few + 20, "{few} MB, then {many} MB");
}

#[test]
fn a_recording_is_told_before_the_next_ones_are_read() {
    let recordings: Vec<(String, String)> = (0..4).map(|at| (format!("{at}.mcap"), drive(10 * at, 1.85))).collect();
    let recordings: Vec<(&str, &str)> = recordings
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_str()))
        .collect();
    let folder = folder(&recordings, &[]);
    let options = Options {
        paths: vec![folder.path().to_path_buf()],
        ..Options::default()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let last = folder.path().join("3.mcap");
    let run = pool.install(|| {
        engine::check_each(&options, &mut |_, grown| {
            // Behind the first verdict the last recording is no more.
            if grown.recording == Some(0) {
                fs::remove_file(&last).unwrap();
            }
        })
        .unwrap()
    });
    let codes: Vec<u8> = run.recordings.iter().map(|one| one.code).collect();
    assert_eq!(codes, [0, 0, 0, 3]);
}

#[test]
fn documents_of_evidence_have_a_verdict_each() {
    let folder = folder(&[("a.mcap", &drive(0, 1.85)), ("b.mcap", &late(&drive(10, 1.85)))], &[]);
    for name in ["a", "b"] {
        let arguments = [
            "collect".to_owned(),
            format!("{name}.mcap"),
            "-o".to_owned(),
            format!("{name}.json"),
        ];
        assert_eq!(program::run(folder.path(), arguments).code, 0);
    }
    let ran = program::run(
        folder.path(),
        [
            "check",
            "--evidence",
            "a.json",
            "--evidence",
            "b.json",
            "--format",
            "json",
        ],
    );
    let report = ran.report();
    let told: Vec<(&Value, &Value)> = report["recordings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| (&one["label"], &one["exit_code"]))
        .collect();
    assert_eq!(
        format!("{told:?}"),
        r#"[(String("a.mcap"), Number(0)), (String("b.mcap"), Number(1))]"#
    );
}

#[test]
fn pages_and_comments_have_the_table() {
    let folder = folder(&[("a.mcap", &drive(0, 1.85)), ("b.mcap", &late(&drive(10, 1.85)))], &[]);
    for (form, row) in [
        ("markdown", "| :white_check_mark: clean | `a.mcap` |"),
        ("html", "<th scope=\"row\"><code>a.mcap</code></th>"),
        ("human", "  clean            0"),
    ] {
        let ran = program(folder.path(), &["--format", form]);
        assert!(ran.text().contains(row), "{form}: {}", ran.text());
    }
}
