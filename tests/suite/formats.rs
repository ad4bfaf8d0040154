//! Every form of the report from one run with all there is to say, held against readers that others wrote.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use junit_parser::TestStatus;
use serde_json::Value;

use crate::support::program::{self, CallResult};

/// An error, a warning, a waived warning, an input that cannot be read, and a rule that is required and cannot judge; names and
/// words that mean something in every form.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "a robot, 100% <b>.urdf",
        r#"<robot name="r">
  <link name="base_link"/>
  <link name="lidar"/>
  <link name="cam|&quot;era"/>
  <joint name="lidar_joint" type="fixed">
    <parent link="base_link"/>
    <child link="lidar"/>
    <origin xyz="1 0 0.5" rpy="0 0 0.35"/>
  </joint>
  <!-- frames-lint: allow ROT09 drawn so: 90% *sure* -->
  <joint name="cam_joint" type="fixed">
    <parent link="base_link"/>
    <child link="cam|&quot;era"/>
    <origin xyz="1 0 1" rpy="0 0 1.57"/>
  </joint>
</robot>
"#,
    );
    // The inverse of the robot's.
    write(
        "lidar.yaml",
        "base_link_from_lidar:\n  translation: [-0.939372713, 0.342897807, -0.5]\n  rpy: [0.0, 0.0, -0.35]\n",
    );
    write("broken.json", "{\"a\": [1, 2");
    write("frames-lint.yaml", "require: [AXES01]\n");
    folder
}

/// Every form of the report but that for people and the page.
pub(crate) const FORMS: [&str; 8] = [
    "concise",
    "json",
    "json-lines",
    "sarif",
    "github",
    "gitlab",
    "junit",
    "markdown",
];

/// Every form of the report at once; the answer, and the file of each.
fn reports(folder: &tempfile::TempDir) -> CallResult {
    let mut arguments = vec!["check".to_owned(), ".".to_owned()];
    for form in FORMS {
        arguments.extend(["--output".to_owned(), format!("{form}=out/{form}")]);
    }
    fs::create_dir_all(folder.path().join("out")).unwrap();
    fs::write(folder.path().join("out/.ignore"), "*\n").unwrap();
    program::run(folder.path(), arguments)
}

fn text(folder: &tempfile::TempDir, form: &str) -> String {
    fs::read_to_string(folder.path().join("out").join(form)).unwrap()
}

#[test]
fn all_forms_come_from_one_run_and_are_the_same_bytes_again() {
    let folder = folder();
    let ran = reports(&folder);
    assert_eq!(ran.code, 1, "{}{}", ran.err, ran.text());
    assert!(
        ran.text().contains("Not clean"),
        "the report for people is on standard output"
    );
    let read = |form| text(&folder, form);
    let first: Vec<String> = FORMS.iter().map(|form| read(form)).collect();
    for form in FORMS {
        fs::remove_file(folder.path().join("out").join(form)).unwrap();
    }
    for threads in ["1", "7"] {
        let arguments: Vec<String> = ["check", "."]
            .map(str::to_owned)
            .into_iter()
            .chain(FORMS.iter().map(|form| format!("--output={form}=out/{form}")))
            .collect();
        program::run_with(folder.path(), arguments, &[("RAYON_NUM_THREADS", threads)]);
        let again: Vec<String> = FORMS.iter().map(|form| read(form)).collect();
        assert_eq!(first, again, "{threads} threads");
    }
}

/// The schema of the standard, as a crate of another author carries it.
fn sarif_schema() -> Value {
    let cargo = |arguments: &[&str]| {
        let mut cargo = Command::new(env!("CARGO"));
        let ran = cargo.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output();
        let ran = ran.unwrap();
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
        String::from_utf8(ran.stdout).unwrap()
    };
    // The crates of other platforms were never downloaded.
    let version = cargo(&["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let only = ["--offline", "--locked", "--filter-platform", host];
    let metadata = cargo(&[&["metadata", "--format-version", "1"][..], &only].concat());
    let metadata: Value = serde_json::from_str(&metadata).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let carrier = packages
        .iter()
        .find(|package| package["name"] == "serde-sarif")
        .unwrap();
    let manifest = PathBuf::from(carrier["manifest_path"].as_str().unwrap());
    let schema = fs::read_to_string(manifest.with_file_name("src").join("schema.json")).unwrap();
    serde_json::from_str(&schema).unwrap()
}

#[test]
fn sarif_is_valid_and_keeps_suppressions_fixes_and_what_was_not_evaluated() {
    let folder = folder();
    reports(&folder);
    let report: Value = serde_json::from_str(&text(&folder, "sarif")).unwrap();
    let validator = jsonschema::validator_for(&sarif_schema()).unwrap();
    let errors: Vec<String> = validator
        .iter_errors(&report)
        .map(|error| format!("{}: {error}", error.instance_path))
        .collect();
    assert!(errors.is_empty(), "{errors:#?}");
    // Typed as well, by the crate that is made from the schema.
    let typed: serde_sarif::sarif::Sarif = serde_json::from_value(report.clone()).unwrap();
    assert_eq!(typed.runs.len(), 1);
    let run = &report["runs"][0];
    let results = run["results"].as_array().unwrap();
    let of = |rule: &str| results.iter().find(|result| result["ruleId"] == rule).unwrap();
    let error = of("CROSS02");
    assert_eq!(error["level"], "error");
    assert_eq!(error["suppressions"], Value::Array(vec![]));
    assert_eq!(error["locations"][0]["physicalLocation"]["region"]["startLine"], 1);
    let rules = run["tool"]["driver"]["rules"].as_array().unwrap();
    for result in results {
        assert_eq!(
            rules[usize::try_from(result["ruleIndex"].as_u64().unwrap()).unwrap()]["id"],
            result["ruleId"]
        );
        assert_eq!(
            result["partialFingerprints"]["framesLint/v1"].as_str().unwrap().len(),
            64
        );
    }
    let waived = of("ROT09");
    assert_eq!(waived["suppressions"][0]["kind"], "inSource");
    assert!(
        waived["suppressions"][0]["justification"]
            .as_str()
            .unwrap()
            .starts_with("drawn so: 90% *sure*")
    );
    let location = &waived["locations"][0]["physicalLocation"]["artifactLocation"]["uri"];
    assert_eq!(location, "a%20robot,%20100%25%20%3Cb%3E.urdf");
    assert!(!waived["fixes"][0]["artifactChanges"].as_array().unwrap().is_empty());
    let notifications: Vec<&str> = run["invocations"][0]["toolExecutionNotifications"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["message"]["text"].as_str().unwrap())
        .collect();
    assert!(
        notifications
            .iter()
            .any(|text| text.contains("AXES01 is required but was not evaluated")
                && text.contains("sensor_msgs/msg/Imu"))
    );
    assert!(notifications.iter().any(|text| text.starts_with("broken.json: ")));
    assert!(
        rules
            .iter()
            .all(|rule| !rule["help"]["text"].as_str().unwrap().is_empty())
    );
}

#[test]
fn junit_is_read_by_another_reader_with_failures_errors_and_skips() {
    let folder = folder();
    reports(&folder);
    let xml = text(&folder, "junit");
    let suites = junit_parser::from_reader(xml.as_bytes()).unwrap();
    let cases: Vec<_> = suites.suites.iter().flat_map(|suite| &suite.cases).collect();
    let of = |class: &str| -> Vec<&TestStatus> {
        let chosen = cases
            .iter()
            .filter(|case| case.classname.as_deref().is_some_and(|name| name.starts_with(class)));
        chosen.map(|case| &case.status).collect()
    };
    assert!(matches!(of("CROSS02")[..], [TestStatus::Failure(_)]), "{xml}");
    assert!(of("ROT09").iter().any(
        |status| matches!(status, TestStatus::Skipped(skipped) if skipped.message.starts_with("waived: drawn so"))
    ));
    assert!(
        of("TIME01")
            .iter()
            .all(|status| matches!(status, TestStatus::Skipped(_)))
    );
    assert!(of("TREE01").iter().any(|status| matches!(status, TestStatus::Success)));
    assert!(
        of("AXES01")
            .iter()
            .any(|status| matches!(status, TestStatus::Error(error) if error.text.contains("needed:")))
    );
    let broken = cases.iter().find(|case| case.name.ends_with("broken.json")).unwrap();
    assert!(matches!(broken.status, TestStatus::Error(_)));
    let report: Value = serde_json::from_str(&text(&folder, "json")).unwrap();
    let rows = report["outcomes"].as_array().unwrap().len();
    let inputs = suites.suites.iter().find(|suite| suite.name == "inputs").unwrap();
    assert_eq!(cases.len(), rows + 1 + inputs.cases.len());
}

#[test]
fn gitlab_has_the_keys_that_it_asks_for_and_no_fingerprint_twice() {
    let folder = folder();
    reports(&folder);
    let issues: Value = serde_json::from_str(&text(&folder, "gitlab")).unwrap();
    let issues = issues.as_array().unwrap();
    let mut prints: Vec<&str> = Vec::new();
    for issue in issues {
        assert!(
            !issue["description"].as_str().unwrap().is_empty() && !issue["check_name"].as_str().unwrap().is_empty()
        );
        assert!(["info", "minor", "major", "critical", "blocker"].contains(&issue["severity"].as_str().unwrap()));
        assert!(!issue["location"]["path"].as_str().unwrap().starts_with("./"));
        assert!(issue["location"]["lines"]["begin"].as_u64().unwrap() >= 1);
        prints.push(issue["fingerprint"].as_str().unwrap());
    }
    let count = prints.len();
    prints.sort_unstable();
    prints.dedup();
    assert_eq!(prints.len(), count);
    let of = |rule: &str| {
        issues
            .iter()
            .find(|issue| issue["check_name"].as_str().unwrap().starts_with(rule))
            .unwrap()
    };
    assert_eq!(of("CROSS02")["severity"], "critical");
    assert_eq!(of("ROT09")["severity"], "info");
    assert_eq!(of("AXES01")["severity"], "blocker");
}

#[test]
fn github_gets_commands_that_it_can_parse() {
    let folder = folder();
    reports(&folder);
    let text = text(&folder, "github");
    let commands: Vec<&str> = text.lines().filter(|line| line.starts_with("::")).collect();
    // `::level key=value,key=value::words`: no key, value or word may break out of it.
    for command in &commands {
        let rest = command.strip_prefix("::").unwrap();
        let (head, _) = rest.split_once("::").unwrap();
        let (level, properties) = head.split_once(' ').unwrap();
        assert!(["notice", "warning", "error"].contains(&level), "{command}");
        for property in properties.split(',') {
            let (key, value) = property.split_once('=').unwrap();
            assert!(
                ["file", "line", "col", "endLine", "endColumn", "title"].contains(&key),
                "{command}"
            );
            assert!(!value.contains(':'), "{command}");
        }
    }
    let of = |rule: &str| commands.iter().find(|line| line.contains(&format!("{rule} "))).unwrap();
    assert!(of("CROSS02").starts_with("::error file=lidar.yaml,line=1,"));
    assert!(
        of("ROT09").starts_with("::notice file=a robot%2C 100%25 <b>.urdf,line=14,"),
        "{}",
        of("ROT09")
    );
    assert!(of("ROT09").contains("%0Awaived: drawn so: 90%25 *sure*"));
    assert!(of("AXES01").starts_with("::error title=AXES01 not met::AXES01 is required but was not evaluated"));
}

#[test]
fn markdown_has_no_markup_but_ours() {
    let folder = folder();
    reports(&folder);
    let text = text(&folder, "markdown");
    assert!(text.starts_with("## :x: frames-lint\n"));
    let row = text.lines().find(|line| line.starts_with("| error")).unwrap();
    assert_eq!(row.replace("\\|", "").matches('|').count(), 5, "{row}");
    assert!(text.contains("<details><summary>Waived: 1 finding</summary>"));
    assert!(text.contains("drawn so: 90% \\*sure\\*"));
    assert!(!text.contains("<b>"), "{text}");
    assert!(text.contains("### Requirements not met"));
}

#[test]
fn json_lines_are_the_document_in_parts() {
    let folder = folder();
    reports(&folder);
    let document: Value = serde_json::from_str(&text(&folder, "json")).unwrap();
    let lines = text(&folder, "json-lines");
    let lines: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for (list, kind) in [
        ("inputs", "input"),
        ("outcomes", "outcome"),
        ("findings", "finding"),
        ("required", "required"),
    ] {
        let parts: Vec<Value> = lines
            .iter()
            .filter(|line| line["type"] == kind)
            .map(|line| {
                let mut line = line.clone();
                line.as_object_mut().unwrap().shift_remove("type");
                line
            })
            .collect();
        assert_eq!(Value::Array(parts), document[list], "{list}");
    }
    let last = lines.last().unwrap();
    assert_eq!(
        (&last["type"], &last["verdict"]),
        (&Value::from("summary"), &Value::from("findings"))
    );
}

#[test]
fn concise_is_a_line_for_each() {
    let folder = folder();
    reports(&folder);
    let text = text(&folder, "concise");
    assert!(
        text.contains("lidar.yaml:1:1: error[CROSS02 extrinsic-relation]"),
        "{text}"
    );
    assert!(text.contains("waived: a robot, 100% <b>.urdf:14:"), "{text}");
    assert!(text.contains("AXES01 is required but was not evaluated"), "{text}");
    assert!(text.contains("broken.json: "), "{text}");
}

#[test]
fn a_file_whose_name_has_an_equals_sign_is_a_file() {
    let folder = folder();
    let ran = program::run(
        folder.path(),
        ["check", "lidar.yaml", "--format", "json", "-o", "run=3.json"],
    );
    assert!(folder.path().join("run=3.json").is_file(), "{}", ran.err);
    assert!(ran.out.is_empty() && ran.err.contains("inputs read"), "{}", ran.err);
}
