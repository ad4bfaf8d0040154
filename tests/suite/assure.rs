//! `frames-lint assure`: what it says, in every format, and that it tells the truth.
//!
//! The truth is `check` on files that have the mistake: for every relation, written into a joint and into calibration files.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use frames_lint::engine::{self, Options, Rules};
use frames_lint::faults::{Family, catalogue};
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
    let (_, mut worlds) = engine::check_worlds(&Options {
        paths: vec![folder.path().to_owned()],
        ..Options::default()
    })
    .unwrap();
    let (world, _) = worlds.pop().unwrap();
    assert!(worlds.is_empty() && !world.claims.is_empty(), "{form:?}");
    world
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
    let options = Options {
        paths: vec![root().join("fixtures/first-finding")],
        ..Options::default()
    };
    let plain = engine::check(&options).unwrap().verdict;
    let (kept, worlds) = engine::check_worlds(&options).unwrap();
    assert_eq!(kept.verdict.findings, plain.findings);
    let (world, rules) = &worlds[0];
    let before = rules.judge(world).findings;
    let faults: Vec<_> = catalogue().collect();
    let progress = frames_lint::progress::Progress::new(false);
    assert!(
        !frames_lint::assure::assure(&worlds, &faults, &progress)
            .trials
            .is_empty()
    );
    assert_eq!(rules.judge(world).findings, before);
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
        text.contains(&format!("\n{count} mistakes of {}.", catalogue().count())),
        "{text}"
    );
}
