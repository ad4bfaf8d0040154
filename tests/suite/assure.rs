//! `frames-lint assure`: what it says, in every format, and that it tells the truth.
//!
//! The truth is `check` on files that have the mistake: for every relation, written into a joint and into calibration files.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use frames_lint::engine::{self, Options, Retention, Rules};
use frames_lint::faults::{Family, SIZED_FAULTS, catalogue};
use frames_lint::math::relation::Relation;
use frames_lint::math::rotation::{from_rpy, to_rpy};
use frames_lint::verdict::Verdict;
use frames_lint::world::World;
use nalgebra::{Isometry3, Translation3};
use serde_json::Value;

use crate::support::program::run;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// `base_link_from_lidar`, without symmetries.
fn truth() -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::new(1.2, 0.31, 1.83), from_rpy(0.21, -0.13, 0.62))
}

/// How a transform is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Form {
    Joint,
    Quaternion,
    Matrix,
    Angles,
}

fn numbers(values: impl IntoIterator<Item = f64>) -> Vec<String> {
    values.into_iter().map(|value| format!("{value:.9}")).collect()
}

fn urdf(pose: &Isometry3<f64>, rpy: [f64; 3]) -> String {
    let xyz = numbers(pose.translation.vector.iter().copied()).join(" ");
    let rpy = numbers(rpy).join(" ");
    format!(
        "<robot name=\"r\">\n  <link name=\"base_link\"/>\n  <link name=\"lidar\"/>\n  <joint name=\"lidar_joint\" type=\"fixed\">\n    \
         <parent link=\"base_link\"/><child link=\"lidar\"/>\n    <origin xyz=\"{xyz}\" rpy=\"{rpy}\"/>\n  </joint>\n</robot>\n"
    )
}

/// The file of a form with a transform, by its name and its text.
fn file(form: Form, pose: &Isometry3<f64>, rpy: [f64; 3]) -> (&'static str, String) {
    let [x, y, z] = <[String; 3]>::try_from(numbers(pose.translation.vector.iter().copied())).unwrap();
    let mut text = "base_link_from_lidar:\n".to_owned();
    match form {
        Form::Joint => return ("car.urdf", urdf(pose, rpy)),
        Form::Quaternion => {
            let q = numbers(pose.rotation.coords.iter().copied());
            let _ = write!(
                text,
                "  translation: {{x: {x}, y: {y}, z: {z}}}\n  rotation: {{x: {}, y: {}, z: {}, w: {}}}\n",
                q[0], q[1], q[2], q[3]
            );
        }
        Form::Matrix => {
            for row in pose.to_homogeneous().row_iter() {
                writeln!(text, "  - [{}]", numbers(row.iter().copied()).join(", ")).unwrap();
            }
        }
        Form::Angles => {
            let [roll, pitch, yaw] = <[String; 3]>::try_from(numbers(rpy)).unwrap();
            let _ = write!(
                text,
                "  x: {x}\n  y: {y}\n  z: {z}\n  roll: {roll}\n  pitch: {pitch}\n  yaw: {yaw}\n"
            );
        }
    }
    ("lidar.yaml", text)
}

/// A platform whose joint and whose calibration file, in a form, state the same transform; one of the files may be replaced.
fn read(form: Form, replaced: Option<(&str, String)>) -> World {
    let folder = tempfile::tempdir().unwrap();
    let angles = to_rpy(&truth().rotation).into();
    let stated = if form == Form::Joint { Form::Quaternion } else { form };
    for (name, text) in [file(Form::Joint, &truth(), angles), file(stated, &truth(), angles)]
        .into_iter()
        .chain(replaced)
    {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let mut worlds = worlds(folder.path());
    let world = worlds.pop().unwrap();
    assert!(worlds.is_empty() && !world.claims.is_empty(), "{form:?}");
    world
}

/// The judged worlds of a folder.
fn worlds(folder: &Path) -> Vec<World> {
    let run = engine::check(&Options {
        paths: vec![folder.to_owned()],
        sights: Retention::Everything,
        ..Options::default()
    });
    run.unwrap().seen
}

/// What is found, without paths of temporary folders.
fn found(verdict: &Verdict) -> BTreeSet<(String, String, Option<String>)> {
    let subject = |subject: &str| {
        let words = subject.split(' ').map(|word| word.rsplit('/').next().unwrap_or(word));
        words.collect::<Vec<_>>().join(" ")
    };
    let findings = verdict.findings.iter();
    findings
        .map(|finding| {
            (
                finding.rule.clone(),
                subject(&finding.subject),
                finding.relation.clone(),
            )
        })
        .collect()
}

#[test]
fn altered_evidence_and_altered_files_agree_on_every_relation() {
    let rules = Rules::select(&[]).unwrap();
    let (mut cells, mut wrong) = (0, Vec::new());
    for form in [Form::Joint, Form::Quaternion, Form::Matrix, Form::Angles] {
        let healthy = read(form, None);
        let name = if form == Form::Joint {
            "joint `lidar_joint`"
        } else {
            "lidar.yaml"
        };
        for fault in catalogue().filter(|fault| fault.name.starts_with("stated-")) {
            let relation = Relation::from_word(fault.relations[0]).unwrap();
            let held = relation.apply(&truth()).unwrap();
            let rpy: [f64; 3] = to_rpy(&truth().rotation).into();
            let rpy = match relation {
                Relation::Degrees => rpy.map(f64::to_degrees),
                Relation::Radians => rpy.map(f64::to_radians),
                _ => to_rpy(&held.rotation).into(),
            };
            let of_files = found(&rules.judge(&read(form, Some(file(form, &held, rpy)))));
            let mut altered = healthy.clone();
            let subjects = fault.change.subjects(&healthy);
            let subject = subjects.iter().find(|subject| subject.name.contains(name)).unwrap();
            assert!(fault.change.apply(&mut altered, subject));
            altered.forget();
            let of_evidence = found(&rules.judge(&altered));
            cells += 1;
            if of_files != of_evidence {
                wrong.push(format!(
                    "{} in {form:?}: {of_files:?}, altered {of_evidence:?}",
                    fault.name
                ));
            }
        }
    }
    assert_eq!(cells, 4 * 42);
    assert!(wrong.is_empty(), "{} of {cells}: {wrong:#?}", wrong.len());
}

#[test]
fn every_relation_of_two_statements_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let angles = to_rpy(&truth().rotation).into();
    for (name, text) in [
        file(Form::Joint, &truth(), angles),
        file(Form::Quaternion, &truth(), angles),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let ran = run(
        folder.path(),
        ["assure", ".", "--select", "statement", "--format", "json"],
    );
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    let document: Value = serde_json::from_slice(&ran.out).unwrap();
    let stated: Vec<&Value> = document["faults"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|trial| trial["fault"].as_str().unwrap().starts_with("stated-"))
        .collect();
    assert_eq!(stated.len(), 2 * 42);
    for trial in stated {
        assert_eq!(trial["outcome"], "named", "{trial}");
    }
}

/// The document must be valid, its totals right, and the findings of the run must be those of `check`.
#[test]
fn the_document_is_valid_and_nothing_altered_leaks() {
    let ran = run(
        root(),
        [
            "assure",
            "fixtures/first-finding",
            "fixtures/robots/car",
            "--format",
            "json",
        ],
    );
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    let document: Value = serde_json::from_slice(&ran.out).unwrap();
    let schema = fs::read_to_string(root().join("schema/frames-lint-assure-1.json")).unwrap();
    let validator = jsonschema::validator_for(&serde_json::from_str(&schema).unwrap()).unwrap();
    let errors: Vec<String> = validator
        .iter_errors(&document)
        .map(|error| error.to_string())
        .collect();
    assert!(errors.is_empty(), "{errors:?}");
    let trials = document["faults"].as_array().unwrap();
    for outcome in ["named", "noticed", "missed", "present"] {
        let count = trials.iter().filter(|trial| trial["outcome"] == outcome).count();
        assert_eq!(document["summary"][outcome], count, "{outcome}");
        assert!(count > 0, "{outcome}");
    }
    assert_eq!(document["summary"]["tried"], trials.len());
    for trial in trials {
        let is_missed = trial["outcome"] == "missed";
        assert_eq!(trial["reason"].is_string(), is_missed, "{trial}");
        assert_eq!(trial["rules"].as_array().unwrap().is_empty(), is_missed, "{trial}");
    }
    let check = |assured: bool| {
        let mut arguments = vec!["check", "fixtures/first-finding", "--format", "json"];
        arguments.extend(assured.then_some("--assure"));
        let ran = run(root(), arguments);
        let mut report = ran.report();
        (ran.code, report["assurance"].take(), report)
    };
    let (code, assurance, plain) = check(false);
    assert!(assurance.is_null());
    let (assured_code, assurance, assured) = check(true);
    assert_eq!((code, plain), (assured_code, assured), "nothing altered leaks");
    assert!(!assurance["faults"].as_array().unwrap().is_empty());
    assert_eq!(
        assurance["summary"]["tried"],
        assurance["faults"].as_array().unwrap().len()
    );
}

/// A mistake whose finding the user accepts, or turns off, would not be found.
#[test]
fn what_is_accepted_is_not_found() {
    let folder = tempfile::tempdir().unwrap();
    let angles = to_rpy(&truth().rotation).into();
    for (name, text) in [Form::Joint, Form::Quaternion].map(|form| file(form, &truth(), angles)) {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let why = || {
        let report = run(folder.path(), ["check", ".", "--format", "json"]).report();
        let unmet = report["required"].as_array().unwrap().first();
        unmet.map(|one| one["why"].to_string())
    };
    let require = "require: [{detects: stated-inverse, subject: '*lidar.yaml*'}]\n";
    let configure = |more: &str| fs::write(folder.path().join("frames-lint.yaml"), format!("{require}{more}")).unwrap();
    configure("");
    assert_eq!(why(), None);
    configure("waivers: [{rule: CROSS02, reason: two versions}]\n");
    let accepted = why().unwrap();
    assert!(accepted.contains("which is accepted: two versions"), "{accepted}");
    configure("waivers: [{rule: CROSS02, subject: '*camera*', reason: another}]\n");
    assert_eq!(why(), None);
    configure("paths: [{file: '*.urdf', ignore: cross}, {file: '*.yaml', ignore: cross}]\n");
    let off = why().unwrap();
    assert!(off.contains("off for this file"), "{off}");
    configure("");
    let stated = file(Form::Quaternion, &truth(), angles).1;
    let commented = format!("# frames-lint: allow-file CROSS02 two versions\n{stated}");
    fs::write(folder.path().join("lidar.yaml"), commented).unwrap();
    let accepted = why().unwrap();
    assert!(accepted.contains("which is accepted: two versions"), "{accepted}");
}

/// A mistake that is there and accepted is not found.
#[test]
fn what_is_there_and_accepted_is_not_found() {
    let folder = tempfile::tempdir().unwrap();
    let inverse = truth().inverse();
    let angles = |pose: &Isometry3<f64>| to_rpy(&pose.rotation).into();
    for (form, pose) in [(Form::Joint, truth()), (Form::Quaternion, inverse)] {
        let (name, text) = file(form, &pose, angles(&pose));
        fs::write(folder.path().join(name), text).unwrap();
    }
    let tried = |config: &str| {
        fs::write(folder.path().join("frames-lint.yaml"), config).unwrap();
        let ran = run(
            folder.path(),
            ["assure", ".", "--select", "stated-inverse", "--format", "json"],
        );
        let document: Value = serde_json::from_slice(&ran.out).unwrap();
        let trials = document["faults"].as_array().unwrap().iter();
        let mut outcomes: Vec<(String, String)> = trials
            .map(|trial| {
                (
                    trial["outcome"].as_str().unwrap().to_owned(),
                    trial["reason"].to_string(),
                )
            })
            .collect();
        outcomes.sort();
        outcomes
    };
    let there = tried("waivers: []\n");
    assert!(there.iter().any(|(outcome, _)| outcome == "present"), "{there:?}");
    let accepted = tried("waivers: [{rule: CROSS02, reason: known}]\n");
    for (outcome, reason) in accepted {
        assert_eq!(outcome, "missed");
        assert!(reason.contains("which is accepted: known"), "{reason}");
    }
}

/// A gate: a mistake that would have been missed leaves the run incomplete, with the place, the reason and what to record.
#[test]
fn what_must_be_found_is_a_requirement() {
    let folder = tempfile::tempdir().unwrap();
    let angles = to_rpy(&truth().rotation).into();
    let [joint, stated] = [Form::Joint, Form::Quaternion].map(|form| file(form, &truth(), angles));
    let config = folder.path().join("frames-lint.yaml");
    fs::write(folder.path().join(joint.0), joint.1).unwrap();
    let check = |require: &str| {
        fs::write(&config, format!("require:\n  - {require}\n")).unwrap();
        run(folder.path(), ["check", "."])
    };
    // The joint alone: nothing contradicts it.
    let ran = check("{detects: stated-inverse}");
    let text = ran.text();
    assert_eq!(ran.code, 3, "{text}");
    for words in [
        "stated-inverse The transform is inverted",
        "missed in `car.urdf`: joint `lidar_joint`",
        "needed: a second statement of the transform",
        "`require: [{detects: stated-inverse, lifted: REASON}]`",
        "1 requirement is not met.",
    ] {
        assert!(text.contains(words), "`{words}` is not in:\n{text}");
    }
    assert_eq!(
        check("{detects: stated-inverse, subject: '*camera*', if: applicable}").code,
        0
    );
    assert_eq!(check("{detects: stated-inverse, subject: '*camera*'}").code, 3);
    assert_eq!(
        check("{detects: [stated-inverse]}\n  - {detects: stated-inverse, lifted: no second source}").code,
        0
    );
    // As for rules: lifting counts for its subject, and for the entries before it.
    let of_another = "{detects: stated-inverse}\n  - {detects: stated-inverse, subject: '*camera*', lifted: no camera}";
    assert_eq!(check(of_another).code, 3);
    let again = "{detects: stated-inverse}\n  - {detects: stated-inverse, lifted: no}\n  - {detects: stated-inverse}";
    assert_eq!(check(again).code, 3);
    fs::write(folder.path().join(stated.0), stated.1).unwrap();
    let ran = check("{detects: [stated-inverse, stated-z180]}");
    assert_eq!(ran.code, 0, "{}", ran.text());
    let ran = check("{detects: [stated-invers]}");
    assert_eq!(ran.code, 2);
    assert!(
        ran.err.contains(
            "frames-lint.yaml:2:16: no known mistake is called `stated-invers`; did you mean `stated-inverse`?"
        ),
        "{}",
        ran.err
    );
    let report: Value = {
        check("{detects: imu-wxyz}");
        run(folder.path(), ["check", ".", "--format", "json"]).report()
    };
    assert_eq!(report["required"][0]["rule"], "imu-wxyz");
    assert_eq!(
        report["required"][0]["why"][0],
        "nothing in the data can have this mistake"
    );
}

#[test]
fn the_page_has_blind_spots_and_a_matrix() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("assured.html");
    let ran = run(root(), ["assure", "fixtures/robots/amr", "-o", page.to_str().unwrap()]);
    assert_eq!((ran.code, ran.out.len()), (0, 0), "{}", ran.err);
    let page = fs::read_to_string(page).unwrap();
    for words in [
        "What these data would have shown",
        "Blind spot",
        "<table class=\"matrix\">",
        "What to record or add",
    ] {
        assert!(page.contains(words), "`{words}` is not in the page");
    }
    let accepted = folder.path().join("report.html");
    run(
        root(),
        [
            "check",
            "fixtures/robots/amr",
            "--assure",
            "-o",
            accepted.to_str().unwrap(),
        ],
    );
    let accepted = fs::read_to_string(accepted).unwrap();
    let at = |words: &str| accepted.find(words).unwrap();
    assert!(at("id=\"decision\"") < at("id=\"assurance\"") && at("id=\"assurance\"") < at("id=\"findings\""));
}

#[test]
fn the_same_bytes_every_time_and_from_evidence() {
    let arguments = ["assure", "fixtures/robots/amr", "--format", "json"];
    let first = run(root(), arguments);
    assert_eq!(first.out, run(root(), arguments).out);
    let folder = tempfile::tempdir().unwrap();
    let saved = folder.path().join("evidence.json");
    let saved = saved.to_str().unwrap();
    assert_eq!(run(root(), ["collect", "fixtures/robots/amr", "-o", saved]).code, 0);
    let of_evidence = run(root(), ["assure", "--evidence", saved, "--format", "json"]);
    assert_eq!((of_evidence.code, of_evidence.out), (0, first.out));
}

#[test]
fn people_read_blind_spots_first() {
    let ran = run(root(), ["assure", "fixtures/first-finding"]);
    let text = String::from_utf8(ran.out).unwrap();
    let at = |words: &str| {
        text.find(words)
            .unwrap_or_else(|| panic!("`{words}` is not in:\n{text}"))
    };
    assert!(at("Missed: no finding would have shown these mistakes") < at("Noticed: a finding would have shown them"));
    assert!(at("record or add: a second statement of the transform") < at("Of "));
    assert!(!text.contains("Named:"));
    let all = run(root(), ["assure", "fixtures/first-finding", "--all"]);
    assert!(
        String::from_utf8(all.out)
            .unwrap()
            .contains("Named: a finding would have named them")
    );
    let markdown = run(root(), ["assure", "fixtures/first-finding", "--format", "markdown"]);
    let markdown = String::from_utf8(markdown.out).unwrap();
    assert!(markdown.starts_with("## frames-lint assure\n\nOf "), "{markdown}");
    assert!(markdown.contains("| subject | mistakes | why | record or add |"));
}

#[test]
fn wrong_calls_and_empty_inputs_say_what_is_wrong() {
    let ran = run(
        root(),
        ["assure", "fixtures/first-finding", "--select", "stated-invers"],
    );
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("did you mean `stated-inverse`?"), "{}", ran.err);
    let folder = tempfile::tempdir().unwrap();
    let ran = run(folder.path(), ["assure", "."]);
    assert_eq!(ran.code, 3);
    let text = String::from_utf8(ran.out).unwrap();
    assert!(text.contains("nothing was tried. This is no assurance."), "{text}");
    fs::write(folder.path().join("bad.urdf"), "<robot name=\"r\"><link").unwrap();
    let ran = run(folder.path(), ["assure", "."]);
    assert_eq!(ran.code, 3);
    assert!(ran.err.contains("bad.urdf"), "{}", ran.err);
    let own = folder.path().join("car.urdf");
    fs::write(&own, urdf(&truth(), [0.0; 3])).unwrap();
    let ran = run(folder.path(), ["assure", "car.urdf", "-o", "car.urdf"]);
    assert_eq!(ran.code, 2, "an output overwrites no input");
    assert!(fs::read_to_string(own).unwrap().starts_with("<robot"));
}

#[test]
fn the_list_has_every_mistake_and_a_family_selects() {
    let text = String::from_utf8(run(root(), ["assure", "--list"]).out).unwrap();
    for fault in catalogue() {
        assert!(text.contains(&format!("  {}: ", fault.name)), "{}", fault.name);
    }
    let text = String::from_utf8(run(root(), ["assure", "--list", "--select", "statement"]).out).unwrap();
    let count = catalogue().filter(|fault| fault.family == Family::Statement).count();
    assert!(
        text.contains(&format!(
            "\n{count} mistakes of {}.",
            catalogue().count() + SIZED_FAULTS.len()
        )),
        "{text}"
    );
}
