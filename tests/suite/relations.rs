//! Every word of the relation dictionary, end to end: a URDF, and a second source that states the same mount with that
//! convention error, in every spelling. The tool must name the word once, at the place of the second source.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::fmt::Write as _;
use std::fs;

use crate::support;
use frames_lint::math::relation::Relation;
use frames_lint::run::Run;
use frames_lint::source::{LineIndex, SourcePart};
use frames_lint::verdict::{Finding, Outcome};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// The mount as the URDF states it: nothing about it is symmetric.
const XYZ: [f64; 3] = [1.3, -0.4, 1.7];
const RPY: [f64; 3] = [0.21, -0.34, 0.83];

const URDF: &str = r#"<robot name="car">
  <link name="base_link"/>
  <link name="lidar"/>
  <joint name="lidar_joint" type="fixed">
    <parent link="base_link"/>
    <child link="lidar"/>
    <origin xyz="1.3 -0.4 1.7" rpy="0.21 -0.34 0.83"/>
  </joint>
</robot>
"#;

fn base_link_from_lidar() -> Isometry3<f64> {
    let [x, y, z] = XYZ;
    let [roll, pitch, yaw] = RPY;
    Isometry3::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}

/// How the second source spells it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Nested,
    Flat,
    OpenCv,
    Keyed,
    Autoware,
    Bag,
}

const FORMS: [Form; 6] = [
    Form::Nested,
    Form::Flat,
    Form::OpenCv,
    Form::Keyed,
    Form::Autoware,
    Form::Bag,
];

impl Form {
    fn file(self) -> &'static str {
        if self == Self::Bag {
            "drive.mcap"
        } else {
            "calibration.yaml"
        }
    }

    /// The line of the statement, or the topic.
    fn place(self) -> &'static str {
        match self {
            Self::Nested | Self::Flat | Self::Keyed => "1",
            Self::OpenCv => "3",
            Self::Autoware => "2",
            Self::Bag => "/tf_static",
        }
    }

    /// The text of the second source for `base_link_from_lidar`.
    fn text(self, pose: &Isometry3<f64>) -> String {
        let q = pose.rotation.coords;
        let t = pose.translation.vector;
        match self {
            Self::Nested => {
                let mut text = "base_link_from_lidar:\n".to_owned();
                for row in rows(pose) {
                    writeln!(text, "  - [{}]", row.join(", ")).unwrap();
                }
                text
            }
            Self::Flat => format!("base_link_from_lidar: [{}]\n", rows(pose).concat().join(", ")),
            Self::OpenCv => format!(
                "%YAML:1.0\n---\nbase_link_from_lidar: !!opencv-matrix\n  rows: 4\n  cols: 4\n  dt: d\n  data: [ {} ]\n",
                rows(pose).concat().join(", ")
            ),
            Self::Keyed => format!(
                "base_link_from_lidar:\n  translation: [{:.9}, {:.9}, {:.9}]\n  rotation: {{x: {:.12}, y: {:.12}, z: {:.12}, w: {:.12}}}\n",
                t.x, t.y, t.z, q.x, q.y, q.z, q.w
            ),
            Self::Autoware => {
                let (roll, pitch, yaw) = pose.rotation.euler_angles();
                autoware([t.x, t.y, t.z], [roll, pitch, yaw])
            }
            Self::Bag => format!(
                "topics:\n  - topic: /tf_static\n    transforms:\n      - {{parent: base_link, child: lidar, xyz: [{}, {}, {}], quaternion: [{}, {}, {}, {}]}}\n",
                t.x, t.y, t.z, q.x, q.y, q.z, q.w
            ),
        }
    }
}

fn rows(pose: &Isometry3<f64>) -> Vec<Vec<String>> {
    let matrix = pose.to_homogeneous();
    matrix
        .row_iter()
        .map(|row| row.iter().map(|v| format!("{v:.12}")).collect())
        .collect()
}

fn autoware(xyz: [f64; 3], rpy: [f64; 3]) -> String {
    let [x, y, z] = xyz;
    let [roll, pitch, yaw] = rpy;
    format!(
        "base_link:\n  lidar:\n    x: {x:.9}\n    y: {y:.9}\n    z: {z:.9}\n    roll: {roll:.12}\n    pitch: {pitch:.12}\n    yaw: {yaw:.12}\n"
    )
}

fn check(urdf: &str, file: &str, text: &str) -> (tempfile::TempDir, Run) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("car.urdf"), urdf).unwrap();
    if file == Form::Bag.file() {
        support::write(text, &folder.path().join(file));
    } else {
        fs::write(folder.path().join(file), text).unwrap();
    }
    let run = support::checked(folder.path());
    (folder, run)
}

/// The findings of the rules that compare sources.
fn cross(run: &Run) -> Vec<&Finding> {
    run.verdict
        .findings
        .iter()
        .filter(|f| ["CROSS01", "CROSS02", "QUAT03"].contains(&f.rule.as_str()))
        .collect()
}

/// The primary place: file name, and line or topic.
fn place(run: &Run, finding: &Finding) -> String {
    let place = &finding.places[0].place;
    let source = &run.sources[place.source.0 as usize];
    let file = source.path.rsplit('/').next().unwrap();
    match &place.at {
        SourcePart::Text(span) => format!(
            "{file}:{}",
            LineIndex::new(&source.text).locate(&source.text, span.start).line
        ),
        SourcePart::Message(message) => format!("{file}:{}", message.topic),
        SourcePart::Whole => format!("{file}: whole"),
    }
}

/// Whether the finding names the word, or says that it is one of those that can't be told apart.
fn names(finding: &Finding, word: &str) -> bool {
    let named = finding.relation.as_deref() == Some(word);
    let text = finding.text();
    let listed = text
        .split_once("ndistinguishable here: ")
        .and_then(|(_, list)| list.split([')', '.', '\n']).next())
        .is_some_and(|list| list.split(", ").any(|other| other == word));
    named || listed
}

/// What is wrong with the answer for this error, if anything is.
fn judge_word(relation: Relation, form: Form) -> Option<String> {
    let held = relation.apply(&base_link_from_lidar()).unwrap();
    let text = match (form, relation) {
        (Form::Autoware, Relation::Degrees) => autoware(XYZ, RPY.map(f64::to_degrees)),
        _ => form.text(&held),
    };
    let (_folder, run) = check(URDF, form.file(), &text);
    let found = cross(&run);
    let case = format!("{} as {form:?}", relation.word());
    let [finding] = found.as_slice() else {
        let said: Vec<String> = found.iter().map(|f| format!("{} {}", f.rule, f.message)).collect();
        return Some(format!("{case}: {} findings: {said:?}", found.len()));
    };
    if relation == Relation::Radians {
        // Larger angles in degrees are the far likelier reading of the same two: the URDF is to blame, and both are said.
        let text = finding.text();
        let said = text.contains("in degrees") && text.contains("its radians were converted");
        return (!said || place(&run, finding) != "car.urdf:7").then(|| format!("{case}: {}", finding.message));
    }
    // The order of angles is QUAT03's where the angles are written down: here always those of the URDF.
    let rule = match (relation, form) {
        (Relation::RpyRotating | Relation::Ypr, _) | (Relation::RpyFixed, Form::Autoware) => "QUAT03",
        _ => "CROSS02",
    };
    if finding.rule != rule || !names(finding, relation.word()) {
        return Some(format!(
            "{case}: {} {:?}: {}",
            finding.rule, finding.relation, finding.message
        ));
    }
    let (place, expected) = (place(&run, finding), format!("{}:{}", form.file(), form.place()));
    (place != expected).then(|| format!("{case}: at {place}, expected {expected}: {}", finding.message))
}

#[test]
fn every_word_is_named_in_every_spelling() {
    let mut wrong = Vec::new();
    for relation in Relation::all()
        .iter()
        .copied()
        .filter(|relation| *relation != Relation::Equal)
    {
        for form in FORMS {
            wrong.extend(judge_word(relation, form));
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

/// Turned about an axis along nothing, and moved by 4 cm.
fn miscalibrated(degrees: f64) -> Isometry3<f64> {
    let axis = nalgebra::Unit::new_normalize(Vector3::new(0.5, -0.7, 0.4));
    let mut held = base_link_from_lidar() * UnitQuaternion::from_axis_angle(&axis, degrees.to_radians());
    held.translation.vector += Vector3::new(0.02, -0.03, 0.02);
    held
}

#[test]
fn a_genuine_miscalibration_is_no_convention_error() {
    for degrees in [1.0, 3.0, 5.0, 8.0, 15.0] {
        for form in FORMS {
            let (_folder, run) = check(URDF, form.file(), &form.text(&miscalibrated(degrees)));
            let found = cross(&run);
            let [finding] = found.as_slice() else {
                panic!("{degrees} deg as {form:?}: {found:?}");
            };
            assert_eq!(
                (finding.rule.as_str(), &finding.relation),
                ("CROSS01", &None),
                "{degrees} deg as {form:?}"
            );
            assert_eq!(place(&run, finding), format!("{}:{}", form.file(), form.place()));
        }
    }
}

fn agrees(run: &Run, case: &str) {
    assert!(cross(run).is_empty(), "{case}: {:?}", cross(run));
    for rule in ["CROSS01", "CROSS02"] {
        let passed = run
            .verdict
            .rows
            .iter()
            .filter(|row| row.rule == rule && row.outcome == Outcome::Pass)
            .count();
        assert_eq!(passed, 1, "{case}: {rule}");
    }
}

#[test]
fn the_same_transform_agrees_in_every_spelling_and_direction() {
    for form in FORMS {
        let (_folder, run) = check(URDF, form.file(), &form.text(&base_link_from_lidar()));
        agrees(&run, &format!("{form:?}"));
        if form == Form::Autoware {
            // A sensor that carries its vehicle is no such file.
            continue;
        }
        let inverse = form.text(&base_link_from_lidar().inverse());
        let turned = match form {
            Form::Bag => inverse.replace("parent: base_link, child: lidar", "parent: lidar, child: base_link"),
            _ => inverse.replace("base_link_from_lidar", "lidar_from_base_link"),
        };
        let (_folder, run) = check(URDF, form.file(), &turned);
        agrees(&run, &format!("{form:?}, turned round"));
    }
}

/// A URDF whose own numbers show that it is the one to blame.
#[test]
fn the_source_with_impossible_numbers_is_to_blame() {
    let truth = Form::Keyed.text(&base_link_from_lidar());
    let case = |from: &str, to: &str, word: &str, file: &str, text: &str| {
        let urdf = URDF.replace(from, to);
        assert_ne!(urdf, URDF);
        let (_folder, run) = check(&urdf, file, text);
        let found = cross(&run);
        assert_eq!(found.len(), 1, "{word}: {found:?}");
        assert_eq!(found[0].rule, "CROSS02", "{word}: {}", found[0].message);
        assert_eq!(found[0].relation.as_deref(), Some(word));
        assert_eq!(place(&run, found[0]), "car.urdf:7");
    };
    case(
        "1.3 -0.4 1.7",
        "1300 -400 1700",
        "millimetres",
        "calibration.yaml",
        &truth,
    );
    case(
        "1.3 -0.4 1.7",
        "0.0013 -0.0004 0.0017",
        "metres",
        "calibration.yaml",
        &truth,
    );
    case(
        "0.21 -0.34 0.83",
        "12.0321 -19.4806 47.5555",
        "degrees",
        "calibration.yaml",
        &truth,
    );
    case("0.21 -0.34 0.83", "0 0 0", "rotation-lost", "calibration.yaml", &truth);
    let bag = Form::Bag.text(&base_link_from_lidar());
    case("1.3 -0.4 1.7", "1300 -400 1700", "millimetres", "drive.mcap", &bag);
    case(
        "0.21 -0.34 0.83",
        "12.0321 -19.4806 47.5555",
        "degrees",
        "drive.mcap",
        &bag,
    );
}

/// Degrees in a file are seen in the file alone and against the URDF: two findings, and the second says so.
#[test]
fn degrees_in_a_file_are_told_as_one_cause() {
    let text = autoware(XYZ, RPY.map(f64::to_degrees));
    let (_folder, run) = check(URDF, "calibration.yaml", &text);
    let rules: Vec<&str> = run
        .verdict
        .findings
        .iter()
        .map(|finding| finding.rule.as_str())
        .collect();
    assert_eq!(rules, ["CROSS02", "ROT08"]);
    assert!(cross(&run)[0].help.contains("ROT08"));
}

/// A URDF, a file and a recording: whichever is the odd one is named, once.
#[test]
fn one_odd_source_of_three_is_told_once() {
    let truth = base_link_from_lidar();
    let odd = Relation::Z180.apply(&truth).unwrap();
    let (roll, pitch, yaw) = odd.rotation.euler_angles();
    let odd_urdf = URDF.replace("0.21 -0.34 0.83", &format!("{roll:.9} {pitch:.9} {yaw:.9}"));
    let cases = [
        (odd_urdf.as_str(), &truth, &truth, "car.urdf:7"),
        (URDF, &odd, &truth, "calibration.yaml:2"),
        (URDF, &truth, &odd, "drive.mcap:/tf_static"),
    ];
    for (urdf, in_file, in_bag, expected) in cases {
        for turned in [false, true] {
            let file = if turned {
                Form::Nested
                    .text(&in_file.inverse())
                    .replace("base_link_from_lidar", "lidar_from_base_link")
            } else {
                Form::Autoware.text(in_file)
            };
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("car.urdf"), urdf).unwrap();
            fs::write(folder.path().join("calibration.yaml"), file).unwrap();
            support::write(&Form::Bag.text(in_bag), &folder.path().join("drive.mcap"));
            let run = support::checked(folder.path());
            let found = cross(&run);
            assert_eq!(found.len(), 1, "{expected}: {found:?}");
            assert_eq!(
                (found[0].rule.as_str(), found[0].relation.as_deref()),
                ("CROSS02", Some("z180"))
            );
            let expected = if turned {
                expected.replace("yaml:2", "yaml:1")
            } else {
                expected.to_owned()
            };
            assert_eq!(place(&run, found[0]), expected);
            assert_eq!(
                found[0].places.len(),
                3,
                "all three are pointed at: {:?}",
                found[0].places
            );
        }
    }
}

#[test]
fn of_very_many_files_each_is_compared_with_some_and_the_report_says_so() {
    let pose = base_link_from_lidar();
    let many = |odd: usize| {
        let folder = tempfile::tempdir().unwrap();
        for number in 0..100 {
            let pose = if number == odd { pose.inverse() } else { pose };
            fs::write(
                folder.path().join(format!("car{number:03}.yaml")),
                Form::Nested.text(&pose),
            )
            .unwrap();
        }
        support::checked(folder.path())
    };
    for odd in [0, 3, 50, 99] {
        let run = many(odd);
        let found = cross(&run);
        assert_eq!(found.len(), 1, "{odd}: {found:?}");
        assert_eq!(found[0].rule, "CROSS02");
        assert_eq!(found[0].relation.as_deref(), Some("inverse"));
        assert!(place(&run, found[0]).ends_with(&format!("car{odd:03}.yaml:1")));
    }
    // Of cars that all differ, one is stated as another one's inverse.
    let folder = tempfile::tempdir().unwrap();
    for number in 0..100_u32 {
        let of_car = |number: u32| {
            let mut pose = base_link_from_lidar();
            pose.translation.vector.x += 0.2 * f64::from(number);
            pose.rotation *= UnitQuaternion::from_euler_angles(0.0, 0.0, 0.05 * f64::from(number));
            pose
        };
        let pose = if number == 57 {
            of_car(50).inverse()
        } else {
            of_car(number)
        };
        fs::write(
            folder.path().join(format!("car{number:03}.yaml")),
            Form::Nested.text(&pose),
        )
        .unwrap();
    }
    let run = support::checked(folder.path());
    let found = cross(&run);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].relation.as_deref(), Some("inverse"));
    assert!(place(&run, found[0]).ends_with("car057.yaml:1"));
    for rule in ["CROSS01", "CROSS02"] {
        let run = many(100);
        let rows = run.verdict.rows.iter().filter(|row| row.rule == rule);
        let cut: Vec<_> = rows.filter(|row| row.subject.contains("each with each")).collect();
        assert_eq!(cut.len(), 1, "{rule}");
        assert_eq!(cut[0].outcome, Outcome::NotEvaluated);
        assert!(
            cut[0]
                .reason
                .as_ref()
                .unwrap()
                .contains("of 100 statements (more than 64)")
        );
    }
}
