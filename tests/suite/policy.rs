//! The gate at the edge of the process: configuration, waivers, comments, baselines and requirements, and what each is worth.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support;
use crate::support::program::{CallResult, run};

/// A robot with one note (ROT09: pi with three digits), and a second link to make mistakes with.
const ROBOT: &str = r#"<robot name="r">
  <link name="base_link"/>
  <link name="lidar"/>
  <joint name="lidar_joint" type="fixed">
    <parent link="base_link"/>
    <child link="lidar"/>
    <origin xyz="1 0 0.5" rpy="0 0 1.57"/>
  </joint>
</robot>
"#;

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn check(folder: &Path, arguments: &[&str]) -> CallResult {
    run(
        folder,
        [&["check", "--format", "json", "--fail-on", "note"], arguments].concat(),
    )
}

/// Rules of the findings that count, and of those that are waived.
fn said(ran: &CallResult) -> (Vec<String>, Vec<String>) {
    let report = ran.report();
    let findings = report["findings"].as_array().unwrap().clone();
    let rules = |is_waived: bool| -> Vec<String> {
        let chosen = findings
            .iter()
            .filter(|finding| finding["waived"].is_null() != is_waived);
        chosen
            .map(|finding| finding["rule"].as_str().unwrap().to_owned())
            .collect()
    };
    (rules(false), rules(true))
}

fn outcomes<'a>(report: &'a Value, rule: &str) -> Vec<&'a str> {
    let rows = report["outcomes"].as_array().unwrap().iter();
    rows.filter(|row| row["rule"] == rule)
        .map(|row| row["outcome"].as_str().unwrap())
        .collect()
}

#[test]
fn the_robot_has_one_note() {
    let folder = folder(&[("robot.urdf", ROBOT)]);
    let ran = check(folder.path(), &["."]);
    assert_eq!(
        (ran.code, said(&ran).0),
        (1, vec!["ROT09".to_owned()]),
        "{}",
        ran.text()
    );
}

#[test]
fn a_waived_finding_stays_in_the_report_and_counts_for_nothing() {
    let waiver = "waivers:\n  - {rule: truncated-literal, subject: '*', file: robot.urdf, reason: drawn so, until: 2999-01-01, by: J. Doe}\n";
    let folder = folder(&[("robot.urdf", ROBOT), ("frames-lint.yaml", waiver)]);
    let ran = check(folder.path(), &["."]);
    assert_eq!(
        (ran.code, said(&ran)),
        (0, (vec![], vec!["ROT09".to_owned()])),
        "{}",
        ran.text()
    );
    let report = ran.report();
    let waived = &report["findings"][0]["waived"];
    assert_eq!(
        (
            waived["reason"].as_str(),
            waived["by"].as_str(),
            waived["until"].as_str()
        ),
        (Some("drawn so"), Some("J. Doe"), Some("2999-01-01"))
    );
    assert!(waived["origin"].as_str().unwrap().ends_with("frames-lint.yaml:2"));
    assert!(outcomes(&report, "ROT09").contains(&"waived"));
    assert_eq!(outcomes(&report, "GATE01"), ["pass"]);
    let human = run(folder.path(), ["check", "."]);
    assert!(
        human.text().contains("Waived (1 finding)") && human.text().contains("drawn so, by J. Doe, until 2999-01-01")
    );
}

#[test]
fn a_waiver_runs_out_by_the_day_that_source_date_epoch_names() {
    let waiver = "waivers:\n  - {rule: ROT09, reason: drawn so, until: 2026-06-30}\n";
    let folder = folder(&[("robot.urdf", ROBOT), ("frames-lint.yaml", waiver)]);
    // 2026-06-30T23:59:59Z and a second later.
    for (epoch, code, open) in [("1782863999", 0, vec![]), ("1782864000", 1, vec!["GATE02", "ROT09"])] {
        let ran = support::program::run_with(
            folder.path(),
            ["check", "--format", "json", "--fail-on", "note", "."],
            &[("SOURCE_DATE_EPOCH", epoch)],
        );
        let mut rules = said(&ran).0;
        rules.sort();
        assert_eq!(
            (ran.code, rules),
            (code, open.into_iter().map(str::to_owned).collect()),
            "{epoch}"
        );
    }
}

#[test]
fn what_accepts_nothing_is_reported_and_what_could_not_be_judged_is_not() {
    let waivers = "waivers:\n  - {rule: ROT09, reason: a}\n  - {rule: ROT09, subject: other*, reason: b}\n  - {rule: TIME01, reason: c}\n";
    let folder = folder(&[("robot.urdf", ROBOT), ("frames-lint.yaml", waivers)]);
    let ran = check(folder.path(), &["."]);
    assert_eq!(
        (ran.code, said(&ran).0),
        (1, vec!["GATE01".to_owned()]),
        "{}",
        ran.text()
    );
    assert_eq!(ran.report()["findings"][0]["places"][0]["line"], 3);
    let mut seen = outcomes(&ran.report(), "GATE01")
        .iter()
        .map(|word| (*word).to_owned())
        .collect::<Vec<_>>();
    seen.sort();
    assert_eq!(seen, ["fail", "not-evaluated", "pass"]);
    // A rule that was not asked says nothing either.
    let ran = check(folder.path(), &["--ignore", "ROT09", "."]);
    assert_eq!((ran.code, said(&ran).0), (0, vec![]), "{}", ran.text());
}

#[test]
fn waivers_alone_are_no_check() {
    let folder = folder(&[
        ("a.yaml", "# frames-lint: allow ROT04 reason\nname: nothing\n"),
        ("frames-lint.yaml", "waivers:\n  - {rule: ROT04, reason: a}\n"),
    ]);
    let ran = check(folder.path(), &["--select", "ROT04,GATE", "a.yaml"]);
    assert_eq!(
        (ran.code, &ran.report()["summary"]["verdict"]),
        (3, &Value::from("incomplete")),
        "{}",
        ran.text()
    );
}

#[test]
fn a_comment_is_for_what_it_stands_beside() {
    let beside = ROBOT.replace(
        "  <joint",
        "  <!-- frames-lint: allow ROT09 the drawing has it so -->\n  <joint",
    );
    let elsewhere = ROBOT.replace(
        "  <link name=\"lidar\"",
        "  <!-- frames-lint: allow ROT09 reason -->\n  <link name=\"lidar\"",
    );
    let whole = format!("<!-- frames-lint: allow-file rot reason -->\n{ROBOT}");
    for (text, code, open) in [
        (&beside, 0, vec![]),
        (&elsewhere, 1, vec!["GATE01", "ROT09"]),
        (&whole, 0, vec![]),
    ] {
        let folder = folder(&[("robot.urdf", text)]);
        let ran = check(folder.path(), &["."]);
        let mut rules = said(&ran).0;
        rules.sort();
        assert_eq!(
            (ran.code, rules),
            (code, open.into_iter().map(str::to_owned).collect()),
            "{text}"
        );
    }
}

#[test]
fn a_comment_accepts_nothing_where_the_configuration_was_given_by_name() {
    let text = format!("<!-- frames-lint: allow-file ROT09 looks fine -->\n{ROBOT}");
    for (gate, code, open) in [
        ("fail-on: note\n", 1, vec!["GATE03", "ROT09"]),
        ("comments: accept\n", 0, vec![]),
    ] {
        let folder = folder(&[
            ("data/robot.urdf", &text),
            ("data/frames-lint.yaml", "rules: {ignore: [ROT09]}\ncomments: accept\n"),
            ("gate.yaml", gate),
        ]);
        let ran = check(folder.path(), &["data", "--config", "gate.yaml"]);
        let mut rules = said(&ran).0;
        rules.sort();
        let open: Vec<String> = open.into_iter().map(str::to_owned).collect();
        assert_eq!((ran.code, rules), (code, open), "{gate}: {}", ran.text());
    }
}

#[test]
fn a_baseline_lets_old_findings_pass_wherever_their_lines_are() {
    let folder = folder(&[("car/robot.urdf", ROBOT)]);
    let ran = check(folder.path(), &["--write-baseline", "base.json", "car"]);
    assert_eq!(
        (ran.code, said(&ran).1),
        (0, vec!["ROT09".to_owned()]),
        "{}",
        ran.text()
    );
    assert!(ran.err.contains("wrote 1 finding to base.json"), "{}", ran.err);
    // Other lines, another working directory, an absolute path.
    fs::write(folder.path().join("car/robot.urdf"), ROBOT.replace('\n', "\n\n")).unwrap();
    let whole = folder.path().join("car");
    for (from, baseline, path) in [
        (folder.path(), "base.json", "car"),
        (whole.as_path(), "../base.json", "."),
        (folder.path(), "base.json", whole.to_str().unwrap()),
    ] {
        let ran = check(from, &["--baseline", baseline, path]);
        assert_eq!(
            (ran.code, said(&ran)),
            (0, (vec![], vec!["ROT09".to_owned()])),
            "{}",
            ran.text()
        );
    }
    // A new finding of the same rule.
    let two = ROBOT.replace("</robot>", "<link name=\"cam\"/><joint name=\"cam_joint\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"cam\"/><origin xyz=\"1 0 1\" rpy=\"0 0 3.14\"/></joint></robot>");
    fs::write(folder.path().join("car/robot.urdf"), two).unwrap();
    let ran = check(folder.path(), &["--baseline", "base.json", "car"]);
    assert_eq!(
        (ran.code, said(&ran).0),
        (1, vec!["ROT09".to_owned()]),
        "{}",
        ran.text()
    );
    // Fixed: the entry is for nothing.
    fs::write(
        folder.path().join("car/robot.urdf"),
        ROBOT.replace("1.57", "1.5707963267948966"),
    )
    .unwrap();
    let ran = check(folder.path(), &["--baseline", "base.json", "car"]);
    assert_eq!(
        (ran.code, said(&ran).0),
        (1, vec!["GATE01".to_owned()]),
        "{}",
        ran.text()
    );
    let place = &ran.report()["findings"][0]["places"][0];
    assert_eq!(
        (place["path"].as_str(), place["line"].as_u64()),
        (Some("base.json"), Some(4))
    );
}

#[test]
fn a_fault_that_has_grown_is_a_new_one() {
    let calibration =
        |yaw: &str| format!("base_link_from_lidar:\n  translation: [1.0, 0.0, 0.5]\n  rpy: [0.0, 0.0, {yaw}]\n");
    let robot = ROBOT.replace("1.57", "0.3");
    let folder = folder(&[("robot.urdf", &robot), ("lidar.yaml", &calibration("0.36"))]);
    let ran = check(folder.path(), &["--write-baseline", "base.json", "."]);
    assert_eq!(
        (ran.code, said(&ran).1),
        (0, vec!["CROSS01".to_owned(), "ROT10".to_owned()]),
        "{}",
        ran.text()
    );
    for (yaw, code) in [("0.365", 0), ("0.355", 0), ("0.42", 1)] {
        fs::write(folder.path().join("lidar.yaml"), calibration(yaw)).unwrap();
        let ran = check(folder.path(), &["--baseline", "base.json", "."]);
        assert_eq!(ran.code, code, "{yaw}: {}", ran.text());
    }
}

#[test]
fn a_baseline_that_is_none_is_a_fault_of_the_call() {
    let folder = folder(&[
        ("robot.urdf", ROBOT),
        ("a.json", "{}"),
        ("b.json", "{\"schema\": \"other/1\", \"findings\": []}"),
    ]);
    for (name, what) in [
        ("a.json", "missing field"),
        ("b.json", "its schema is `other/1`"),
        ("none.json", "No such file"),
    ] {
        let ran = check(folder.path(), &["--baseline", name, "."]);
        assert_eq!(ran.code, 2);
        assert!(
            ran.err.contains(&format!("baseline `{name}`")) && ran.err.contains(what),
            "{}",
            ran.err
        );
    }
}

#[test]
fn a_required_rule_that_could_not_judge_makes_the_run_incomplete_and_says_what_to_record() {
    let folder = tempfile::tempdir().unwrap();
    let recipe = "duration_s: 20\ndrive: {vehicle: car, motion: turning, seed: 3}\ntopics:\n  \
                  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: base_link}\n";
    support::write(recipe, &folder.path().join("drive.mcap"));
    fs::write(folder.path().join("frames-lint.yaml"), "require: [AXES02, TIME03]\n").unwrap();
    let ran = check(folder.path(), &["."]);
    let report = ran.report();
    assert_eq!(
        (ran.code, &report["summary"]["verdict"]),
        (3, &Value::from("incomplete")),
        "{}",
        ran.text()
    );
    let [unmet] = &report["required"].as_array().unwrap()[..] else {
        panic!("{}", report["required"])
    };
    assert_eq!(unmet["rule"], "AXES02");
    assert!(
        unmet["record"].as_str().unwrap().contains("sensor_msgs/msg/Imu"),
        "{unmet}"
    );
    let human = run(folder.path(), ["check", "."]);
    assert!(human.text().contains("Requirements not met (1 requirement)") && human.text().contains("needed: an IMU"));
    // The profiles of the tool ask for it as well.
    fs::remove_file(folder.path().join("frames-lint.yaml")).unwrap();
    let ran = run(
        folder.path(),
        [
            "check",
            "--profile",
            "pre-survey",
            "--format",
            "json",
            "--fail-on",
            "never",
            ".",
        ],
    );
    assert_eq!(ran.code, 3, "{}", ran.text());
    let report = ran.report();
    let rules: Vec<&str> = report["required"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["rule"].as_str().unwrap())
        .collect();
    assert!(rules.contains(&"AXES01") && !rules.contains(&"TIME03"), "{rules:?}");
}

/// The verdict on a recipe under a profile or a configuration, and the requirements that are not met: rule, and whether it is accepted.
fn required(recipe: &str, config: &str) -> (i32, Vec<(String, bool)>) {
    let folder = tempfile::tempdir().unwrap();
    support::write(recipe, &folder.path().join("drive.mcap"));
    fs::write(folder.path().join("frames-lint.yaml"), config).unwrap();
    let ran = check(folder.path(), &["."]);
    let report = ran.report();
    let unmet = report["required"].as_array().unwrap().iter();
    let unmet = unmet.map(|one| (one["rule"].as_str().unwrap().to_owned(), !one["waived"].is_null()));
    (ran.code, unmet.collect())
}

/// A recording with one tree, whose odometry and clocks are sound.
const PLAIN: &str = "\
duration_s: 20
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
  - topic: /tf
    rate_hz: 20
    transforms: [{parent: odom, child: base_link, from_drive: odometry}]
";

#[test]
fn a_dataset_of_a_recording_alone_can_be_accepted() {
    let (code, unmet) = required(PLAIN, "extends: dataset-acceptance\n");
    assert_eq!((code, unmet), (0, vec![]));
    // Satellites without a fix: there is a receiver, so it must be judged, unless that is lifted with a reason.
    let fixless = format!(
        "{PLAIN}  - {{topic: /fix, type: sensor_msgs/msg/NavSatFix, rate_hz: 5, frame_id: base_link, status: -1}}\n"
    );
    let (code, unmet) = required(&fixless, "extends: dataset-acceptance\n");
    assert!(
        code == 3 && unmet.contains(&("GEO01".to_owned(), false)),
        "{code} {unmet:?}"
    );
    let lifted =
        "extends: dataset-acceptance\nrequire: [{rule: GEO, lifted: indoors}, {rule: AXES, lifted: indoors}]\n";
    let (code, unmet) = required(&fixless, lifted);
    assert!(
        code == 0 && unmet.contains(&("GEO01".to_owned(), true)),
        "{code} {unmet:?}"
    );
    // Required again behind what lifted it.
    let again =
        "extends: dataset-acceptance\nrequire: [{rule: GEO, lifted: indoors}, {rule: AXES, lifted: indoors}, GEO01]\n";
    let (code, unmet) = required(&fixless, again);
    assert!(
        code == 3 && unmet.contains(&("GEO01".to_owned(), false)),
        "{code} {unmet:?}"
    );
}

#[test]
fn what_does_not_apply_is_required_only_where_nothing_else_is_said() {
    let config = |force: &str| format!("fail-on: never\nrequire: [{{rule: AXES02{force}}}]\n");
    assert_eq!(required(PLAIN, &config("")), (3, vec![("AXES02".to_owned(), false)]));
    assert_eq!(required(PLAIN, &config(", if: applicable")), (0, vec![]));
    // A rule that was left out was not made, whether it applies or not.
    let left_out = config(", if: applicable") + "rules: {ignore: [AXES02]}\n";
    assert_eq!(required(PLAIN, &left_out).0, 3);
}

#[test]
fn too_few_checks_are_not_accepted() {
    let (code, unmet) = required(PLAIN, "fail-on: never\nrequire: [{share: 1}]\n");
    assert_eq!((code, unmet), (3, vec![("share".to_owned(), false)]));
    // What stands last counts.
    assert_eq!(
        required(PLAIN, "fail-on: never\nrequire: [{share: 1}, {share: 0.1}]\n"),
        (0, vec![])
    );
    let folder = folder(&[
        ("robot.urdf", ROBOT),
        ("frames-lint.yaml", "fail-on: never\nrequire: [{share: 1}]\n"),
    ]);
    let ran = run(folder.path(), ["check", "."]);
    let text = ran.text();
    assert!(
        text.contains("share of the checks that apply (frames-lint.yaml:2)"),
        "{text}"
    );
    assert!(
        text.contains("applicable checks were evaluated (") && text.contains("; 100 % are required"),
        "{text}"
    );
    assert!(text.contains("Incomplete: 1 requirement is not met."), "{text}");
}

#[test]
fn a_waiver_accepts_that_a_required_rule_could_not_judge() {
    let config = "require: [TREE01, GEO01, {rule: TREE01, subject: 'nobody*'}]\nwaivers:\n  - {rule: GEO01, reason: indoors}\n  \
                  - {rule: TREE01, subject: 'nobody*', reason: nobody is there}\n";
    let folder = folder(&[
        ("robot.urdf", &ROBOT.replace("1.57", "0.3")),
        ("frames-lint.yaml", config),
    ]);
    let ran = check(folder.path(), &["."]);
    assert_eq!((ran.code, said(&ran).0), (0, vec![]), "{}", ran.text());
    let report = ran.report();
    assert_eq!(report["required"][0]["waived"]["reason"], "indoors");
    assert_eq!(report["required"][1]["subject"], "nobody*");
}

#[test]
fn severities_paths_and_limits_are_the_users() {
    let cases = [
        ("fail-on: note\n", 1, "note"),
        ("rules: {severity: {ROT09: error}}\n", 1, "error"),
        (
            "rules: {severity: {ROT09: error}}\npaths:\n  - {file: '*.urdf', severity: {ROT09: note}}\n",
            0,
            "note",
        ),
    ];
    for (config, code, severity) in cases {
        let folder = folder(&[("sim/robot.urdf", ROBOT), ("frames-lint.yaml", config)]);
        let ran = run(folder.path(), ["check", "--format", "json", "sim"]);
        assert_eq!(
            (ran.code, &ran.report()["findings"][0]["severity"]),
            (code, &Value::from(severity)),
            "{config}"
        );
    }
    for config in [
        "rules: {ignore: [ROT09]}\n",
        "rules: {severity: {ROT09: off}}\n",
        "paths:\n  - {file: 'sim/**', ignore: [rot]}\n",
        "rules: {select: [TREE]}\n",
        "limits: {ROT09: {nearest_rad: 0.1 mrad}}\n",
    ] {
        let folder = folder(&[("sim/robot.urdf", ROBOT), ("frames-lint.yaml", config)]);
        let ran = check(folder.path(), &["sim"]);
        assert_eq!((ran.code, said(&ran)), (0, (vec![], vec![])), "{config}{}", ran.text());
        assert!(!outcomes(&ran.report(), "ROT09").contains(&"fail"), "{config}");
    }
}

#[test]
fn words_that_name_no_rule_and_no_limit_are_faults_with_a_place() {
    for (config, what) in [
        (
            "rules: {ignore: [ROT99]}\n",
            "frames-lint.yaml:1:18: no rule and no family is called `ROT99`",
        ),
        (
            "waivers:\n  - {rule: tre, reason: a}\n",
            "frames-lint.yaml:2:12: no rule and no family is called `tre`; did you mean `tree`?",
        ),
        (
            "limits: {ROT09: {lateral: 3 m}}\n",
            "frames-lint.yaml:1:27: ROT09 has no limit `lateral`",
        ),
        (
            "limits: {ROT09: {lateral_mm: 3}}\n",
            "frames-lint.yaml:1:30: `lateral_mm` has the unit mm: write it as in `10 mm`",
        ),
        ("limits: {ROT09: {lateral_mm: 3 deg}}\n", "`lateral_mm` has the unit mm"),
        ("limits: {rot: {lateral_mm: 3 m}}\n", "`rot` is a family"),
    ] {
        let folder = folder(&[("robot.urdf", ROBOT), ("frames-lint.yaml", config)]);
        let ran = check(folder.path(), &["."]);
        assert_eq!(ran.code, 2, "{config}");
        assert!(ran.err.contains(what), "{config}{}", ran.err);
    }
}
