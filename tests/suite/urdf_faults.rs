//! Forty-one faults that real URDF files have, each put into a healthy robot by one edit of its text: the right rule must
//! say so at the right line, and one cause must not give a shower of findings.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use frames_lint::engine::{self, Options};
use frames_lint::run::Run;
use frames_lint::verdict::{Finding, Outcome, Severity};

/// A fault: edits of a healthy text, and what is said of it.
struct Fault {
    name: &'static str,
    robot: &'static str,
    /// What is replaced, and by what. Each text stands exactly once in the robot.
    edits: &'static [(&'static str, &'static str)],
    /// `rule severity confidence` of the finding that names the cause.
    expect: &'static str,
    /// Text of the line that the finding points to.
    at: &'static str,
    /// Everything else that is said, as `rule severity confidence`.
    also: &'static [&'static str],
}

const fn fault(
    name: &'static str,
    robot: &'static str,
    edits: &'static [(&'static str, &'static str)],
    expect: &'static str,
    at: &'static str,
    also: &'static [&'static str],
) -> Fault {
    Fault {
        name,
        robot,
        edits,
        expect,
        at,
        also,
    }
}

/// Places in the texts that more than one fault is put into.
const LIFT: &str = r#"<origin xyz="0 0.119 0" rpy="0 1.5707963267948966 0"/>"#;
const OPTICAL: &str = r#"<origin xyz="0 0 0" rpy="-1.5707963267948966 0 -1.5707963267948966"/>"#;
const ELBOW: &str = r#"<origin xyz="0 -0.093 0.425" rpy="0 0 0"/>"#;
const SHOULDER_MESH: &str = r#"<mesh filename="shoulder.stl" scale="0.001 0.001 0.001"/>"#;
const INERTIA: &str = r#"<inertia ixx="0.0112" ixy="0" ixz="0" iyy="0.0112" iyz="0" izz="0.0091"/>"#;
const ELBOW_LIMIT: &str = r#"lower="-2.6" upper="2.6""#;
const FINGER_AXIS: &str = r#"<axis xyz="0 -1 0"/>"#;
const FLANGE: &str = r#"<link name="flange"/>"#;
const FLANGE_JOINT: &str = r#"    <parent link="wrist_link"/>
    <child link="flange"/>"#;
const END: &str = "</robot>";

const FAULTS: &[Fault] = &[
    fault(
        "01 mesh scale mirrors",
        "arm",
        &[(
            SHOULDER_MESH,
            r#"<mesh filename="shoulder.stl" scale="0.001 -0.001 0.001"/>"#,
        )],
        "URDF01 note certain",
        "shoulder.stl",
        &[],
    ),
    fault(
        "02 rpy in degrees",
        "arm",
        &[(LIFT, r#"<origin xyz="0 0.119 0" rpy="0 37.5 0"/>"#)],
        "ROT08 error likely",
        "37.5",
        &[],
    ),
    fault(
        "03 roll of 180 degrees",
        "arm",
        &[(LIFT, r#"<origin xyz="0 0.119 0" rpy="180 0 0"/>"#)],
        "ROT08 error likely",
        "180",
        &[],
    ),
    fault(
        "04 nan in xyz",
        "arm",
        &[(LIFT, r#"<origin xyz="0 nan 0" rpy="0 0 0"/>"#)],
        "ROT05 error certain",
        "nan",
        &[],
    ),
    fault(
        "05 nan in rpy",
        "arm",
        &[(LIFT, r#"<origin xyz="0 0.119 0" rpy="0 nan 0"/>"#)],
        "ROT05 error certain",
        "nan",
        &[],
    ),
    fault(
        "06 inf in xyz",
        "arm",
        &[(LIFT, r#"<origin xyz="0 inf 0" rpy="0 0 0"/>"#)],
        "ROT05 error certain",
        "inf",
        &[],
    ),
    fault(
        "07 orphan link",
        "arm",
        &[(END, "<link name=\"tool\"/>\n</robot>")],
        "TREE12 error certain",
        r#"<link name="tool"/>"#,
        &["TREE01 error certain"],
    ),
    fault(
        "08 two roots with a subtree",
        "arm",
        &[(
            END,
            r#"<link name="stand"/><link name="lamp"/>
<joint name="lamp_joint" type="fixed"><parent link="stand"/><child link="lamp"/></joint></robot>"#,
        )],
        "TREE12 error certain",
        r#"<link name="stand"/>"#,
        &["TREE01 error certain"],
    ),
    fault(
        "09 reference in another case",
        "arm",
        &[(
            FLANGE_JOINT,
            "    <parent link=\"Wrist_link\"/>\n    <child link=\"flange\"/>",
        )],
        "NAME01 error certain",
        "Wrist_link",
        &["TREE01 error certain"],
    ),
    fault(
        "10 links that are twins but for case",
        "arm",
        &[(
            END,
            r#"<link name="Flange"/>
<joint name="twin_joint" type="fixed"><parent link="wrist_link"/><child link="Flange"/></joint></robot>"#,
        )],
        "NAME01 warning certain",
        r#"<link name="Flange"/>"#,
        &[],
    ),
    fault(
        "11 axis not of length one",
        "arm",
        &[(FINGER_AXIS, r#"<axis xyz="0 -1 1"/>"#)],
        "URDF03 warning certain",
        "0 -1 1",
        &[],
    ),
    fault(
        "12 axis of zero",
        "arm",
        &[(FINGER_AXIS, r#"<axis xyz="0 0 0"/>"#)],
        "URDF03 error certain",
        "axis",
        &[],
    ),
    fault(
        "13 quaternion not of length one",
        "arm",
        &[
            (r#"<robot name="arm">"#, r#"<robot name="arm" version="1.2">"#),
            (LIFT, r#"<origin xyz="0 0.119 0" quat_xyzw="0 0.5 0 0.5"/>"#),
        ],
        "ROT04 error certain",
        "quat_xyzw",
        &["URDF13 note certain"],
    ),
    fault(
        "14 quaternion of zero",
        "arm",
        &[
            (r#"<robot name="arm">"#, r#"<robot name="arm" version="1.2">"#),
            (LIFT, r#"<origin xyz="0 0.119 0" quat_xyzw="0 0 0 0"/>"#),
        ],
        "ROT05 error certain",
        "quat_xyzw",
        &["URDF13 note certain"],
    ),
    fault(
        "15 two links of one name",
        "arm",
        &[(END, "<link name=\"finger_left\" ></link></robot>")],
        "URDF05 error certain",
        r#"<link name="finger_left" >"#,
        &[],
    ),
    fault(
        "16 two joints of one name",
        "arm",
        &[(r#"<joint name="wrist_joint""#, r#"<joint name="elbow_joint""#)],
        "URDF05 error certain",
        // The second of the two.
        r#"<joint name="elbow_joint""#,
        &[],
    ),
    fault(
        "17 cycle",
        "arm",
        &[(
            END,
            r#"<joint name="loop_joint" type="fixed"><parent link="flange"/><child link="world"/></joint></robot>"#,
        )],
        "TREE03 error certain",
        "loop_joint",
        &[],
    ),
    fault(
        "18 two parents",
        "arm",
        &[(
            END,
            r#"<joint name="second_joint" type="fixed"><parent link="base_link"/><child link="flange"/></joint></robot>"#,
        )],
        "TREE02 error certain",
        "second_joint",
        &[],
    ),
    fault(
        "19 joint of a link with itself",
        "arm",
        &[(
            END,
            r#"<joint name="self_joint" type="fixed"><parent link="flange"/><child link="flange"/></joint></robot>"#,
        )],
        "URDF02 error certain",
        "self_joint",
        &[],
    ),
    fault(
        "20 child link that is not there",
        "arm",
        &[(FLANGE, "")],
        "TREE12 error certain",
        r#"<child link="flange"/>"#,
        &[],
    ),
    fault(
        "21 leading slash",
        "car",
        &[
            (r#"<link name="imu_link"/>"#, r#"<link name="/imu_link"/>"#),
            (r#"<child link="imu_link"/>"#, r#"<child link="/imu_link"/>"#),
        ],
        "NAME02 error certain",
        r#"<link name="/imu_link"/>"#,
        &[],
    ),
    fault(
        "22 trailing space",
        "car",
        &[(r#"<child link="imu_link"/>"#, r#"<child link="imu_link "/>"#)],
        "NAME02 error certain",
        r#"link="imu_link ""#,
        &["TREE01 error certain"],
    ),
    fault(
        "23 link without a name",
        "car",
        &[(r#"<link name="imu_link"/>"#, r#"<link name=""/>"#)],
        "TREE12 error certain",
        r#"<link name=""/>"#,
        &[],
    ),
    fault(
        "24 optical frame not turned",
        "arm",
        &[(OPTICAL, r#"<origin xyz="0 0 0" rpy="0 0 0" />"#)],
        "NAME06 error certain",
        r#"rpy="0 0 0" />"#,
        &[],
    ),
    fault(
        "25 optical frame turned the wrong way",
        "arm",
        &[(
            OPTICAL,
            r#"<origin xyz="0 0 0" rpy="1.5707963267948966 -1.5707963267948966 0"/>"#,
        )],
        "NAME06 error certain",
        "-1.5707963267948966 0\"",
        &[],
    ),
    fault(
        "26 xyz in millimetres",
        "arm",
        &[(ELBOW, r#"<origin xyz="0 -93 425" rpy="0 0 0"/>"#)],
        "ROT06 error likely",
        "425",
        &[],
    ),
    fault(
        "27 pi cut short",
        "arm",
        &[(LIFT, r#"<origin xyz="0 0.119 0" rpy="0 1.57 0"/>"#)],
        "ROT09 note certain",
        "1.57 ",
        &[],
    ),
    fault(
        "28 limits in degrees",
        "arm",
        &[(ELBOW_LIMIT, r#"lower="-150" upper="150""#)],
        "URDF04 error likely",
        "-150",
        &[],
    ),
    fault(
        "29 limits the wrong way round",
        "arm",
        &[(ELBOW_LIMIT, r#"lower="2.6" upper="-2.6""#)],
        "URDF04 error certain",
        "upper=\"-2.6\"",
        &[],
    ),
    fault(
        "30 commas between numbers",
        "arm",
        &[(ELBOW, r#"<origin xyz="0, -0.093, 0.425" rpy="0 0 0"/>"#)],
        "URDF10 error certain",
        "0.425",
        &["URDF13 note certain"],
    ),
    fault(
        "31 two numbers for three",
        "arm",
        &[(ELBOW, r#"<origin xyz="-0.093 0.425" rpy="0 0 0"/>"#)],
        "URDF10 error certain",
        "0.425",
        &["URDF13 note certain"],
    ),
    fault(
        "32 decimal comma",
        "arm",
        &[(ELBOW, r#"<origin xyz="0 -0,093 0,425" rpy="0 0 0"/>"#)],
        "URDF10 error certain",
        "0,425",
        &["URDF13 note certain"],
    ),
    fault(
        "33 misspelt attribute",
        "arm",
        &[(LIFT, r#"<origin xyz="0 0.119 0" ryp="0 1.5707963267948966 0"/>"#)],
        "URDF11 warning likely",
        "ryp",
        &[],
    ),
    fault(
        "34 misspelt element",
        "arm",
        &[(LIFT, r#"<orgin xyz="0 0.119 0" rpy="0 1.5707963267948966 0"/>"#)],
        "URDF11 warning likely",
        "orgin",
        &[],
    ),
    fault(
        "35 two origins",
        "arm",
        &[(
            ELBOW,
            "<origin xyz=\"0 -0.093 0.425\" rpy=\"0 0 0\"/>\n<origin xyz=\"0 -0.093 0.5\" rpy=\"0 0 0\"/>",
        )],
        "URDF07 error certain",
        "0 -0.093 0.5",
        &["URDF13 note certain"],
    ),
    fault(
        "36 joint type that does not exist",
        "arm",
        &[(
            r#"<joint name="elbow_joint" type="revolute">"#,
            r#"<joint name="elbow_joint" type="hinge">"#,
        )],
        "URDF12 error certain",
        "hinge",
        &["URDF13 note hint"],
    ),
    fault(
        "37 mimicked joint that is not there",
        "arm",
        &[(
            r#"<mimic joint="finger_left_joint"/>"#,
            r#"<mimic joint="finger_joint"/>"#,
        )],
        "URDF06 error certain",
        "mimic",
        &[],
    ),
    fault(
        "38 inertia that is not positive",
        "arm",
        &[(
            INERTIA,
            r#"<inertia ixx="0.0112" ixy="0.05" ixz="0" iyy="0.0112" iyz="0" izz="0.0091"/>"#,
        )],
        "URDF08 warning certain",
        "ixy=\"0.05\"",
        &[],
    ),
    fault(
        "39 inertia against the triangle inequality",
        "arm",
        &[(
            INERTIA,
            r#"<inertia ixx="0.0112" ixy="0" ixz="0" iyy="0.0112" iyz="0" izz="0.091"/>"#,
        )],
        "URDF08 warning certain",
        "izz=\"0.091\"",
        &[],
    ),
    fault(
        "40 mesh that is not there",
        "arm",
        &[(
            SHOULDER_MESH,
            r#"<mesh filename="sholder.stl" scale="0.001 0.001 0.001"/>"#,
        )],
        "URDF09 warning certain",
        "sholder.stl",
        &[],
    ),
    fault(
        "41 mesh scale of 1000",
        "arm",
        &[(
            SHOULDER_MESH,
            r#"<mesh filename="shoulder.stl" scale="1000 1000 1000"/>"#,
        )],
        "URDF01 warning likely",
        "1000",
        &[],
    ),
];

/// Checks a text beside the meshes of its robot.
fn check(robot: &str, text: &str) -> Run {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fixtures/robots")
        .join(robot);
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(fixture).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "stl") {
            fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
        }
    }
    let path = folder.path().join("robot.urdf");
    fs::write(&path, text).unwrap();
    engine::check(&Options {
        paths: vec![path],
        ..Options::default()
    })
    .unwrap()
}

fn healthy(robot: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/robots/{robot}/{robot}.urdf"));
    fs::read_to_string(path).unwrap()
}

fn said(finding: &Finding) -> String {
    format!(
        "{} {} {}",
        finding.rule,
        finding.severity.word(),
        finding.confidence.word()
    )
}

/// The line of the text that the finding points to.
fn line<'a>(finding: &Finding, text: &'a str) -> &'a str {
    let start = finding.places[0].place.span().unwrap_or_default().start;
    let from = text[..start].rfind('\n').map_or(0, |at| at + 1);
    text[from..].lines().next().unwrap_or_default()
}

/// What is wrong with the answer to a fault.
fn judge(fault: &Fault) -> Vec<String> {
    let mut text = healthy(fault.robot);
    for (from, to) in fault.edits {
        assert_eq!(text.matches(from).count(), 1, "{}: `{from}`", fault.name);
        text = text.replace(from, to);
    }
    let run = check(fault.robot, &text);
    let findings = &run.verdict.findings;
    let all: Vec<String> = findings
        .iter()
        .map(|finding| format!("{} | {} | {}", said(finding), finding.message, line(finding, &text)))
        .collect();
    let mut wrong = Vec::new();
    let (named, others): (Vec<&Finding>, Vec<&Finding>) =
        findings.iter().partition(|finding| said(finding) == fault.expect);
    match named.as_slice() {
        [one] if !line(one, &text).contains(fault.at) => wrong.push(format!("`{}` points elsewhere", fault.expect)),
        [_] => {}
        _ => wrong.push(format!("`{}` is said {} times", fault.expect, named.len())),
    }
    let others: Vec<String> = others.into_iter().map(said).collect();
    if others != fault.also {
        wrong.push(format!("beside it {others:?} instead of {:?}", fault.also));
    }
    let errors = findings
        .iter()
        .filter(|finding| finding.severity == Severity::Error)
        .count();
    if errors > 2 {
        wrong.push(format!("{errors} errors of one cause"));
    }
    if run.verdict.count(Outcome::Crashed) > 0 {
        wrong.push("a rule crashed".to_owned());
    }
    if !wrong.is_empty() {
        wrong.push(format!("all findings:\n    {}", all.join("\n    ")));
    }
    wrong
        .into_iter()
        .map(|what| format!("{}: {what}", fault.name))
        .collect()
}

#[test]
fn each_fault_is_found_by_the_right_rule() {
    let names: BTreeSet<&str> = FAULTS.iter().map(|fault| fault.name).collect();
    assert_eq!(names.len(), 41);
    let wrong: Vec<String> = FAULTS.iter().flat_map(judge).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn the_healthy_robots_are_silent_without_their_other_files() {
    for robot in ["arm", "car"] {
        let run = check(robot, &healthy(robot));
        let all: Vec<String> = run.verdict.findings.iter().map(said).collect();
        assert!(all.is_empty(), "{robot}: {all:?}");
    }
}

#[test]
fn joints_below_conditions_of_a_xacro_are_alternatives() {
    let joint = |name: &str, parent: &str| {
        format!("<joint name=\"{name}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"lidar\"/></joint>")
    };
    let robot = |joints: &str| {
        format!(
            "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:include filename=\"$(find nowhere)/a.xacro\"/><link name=\"base_link\"/><link name=\"mast\"/><link name=\"lidar\"/>{joints}</robot>\n"
        )
    };
    let (a, b) = (joint("a", "base_link"), joint("b", "mast"));
    let tall = "value=\"$(arg tall)\"";
    for (joints, expected) in [
        (
            format!("<xacro:unless {tall}>{a}</xacro:unless><xacro:if {tall}>{b}</xacro:if>"),
            0,
        ),
        (format!("{a}<xacro:if {tall}>{b}</xacro:if>"), 0),
        (format!("{a}{b}"), 1),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("robot.xacro"), robot(&joints)).unwrap();
        let run = frames_lint::engine::check(&frames_lint::engine::Options {
            paths: vec![folder.path().to_path_buf()],
            select: vec!["TREE02".to_owned()],
            ..frames_lint::engine::Options::default()
        })
        .unwrap();
        assert_eq!(run.verdict.findings.len(), expected, "{joints}");
    }
}
