//! A robot made from any bytes: read as it was made, the same as urdf-rs reads it; damaged, a problem or a robot.

use std::fmt::Write;

use frames_lint::read::urdf;
use frames_lint::source::{ReadStatus, Source, SourceKind};
use frames_lint::world::Facts;
use frames_lint::world::robot::ConsumerOpinion;

use super::choices::Choices;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let mut choices = Choices::new(bytes);
    let joints = joints(&mut choices);
    let written = written(&joints, &mut choices);
    let (source, facts) = read(written.as_bytes()).expect("UTF-8");
    assert_eq!(source.status, ReadStatus::Read, "{source:?}\n{written}");
    let [robot] = facts.robots.as_slice() else {
        panic!("no robot in {written}")
    };
    assert_eq!(robot.links.len(), joints.len() + 1, "{written}");
    let ours = robot.joints.iter().zip(&facts.claims);
    assert_eq!(robot.joints.len(), joints.len(), "{written}");
    for ((joint, claim), made) in ours.zip(&joints) {
        assert_eq!(joint.name.value, made.name);
        let pose = claim.pose.as_ref().expect("a joint has a pose");
        assert_eq!(pose.translation_m, made.xyz, "{written}");
    }
    let ConsumerOpinion::Loads(theirs) = &robot.consumer else {
        panic!("urdf-rs says {:?} of {written}", robot.consumer);
    };
    assert_eq!(theirs.len(), joints.len());
    for made in &joints {
        let joint = theirs.iter().find(|joint| joint.name == made.name);
        let read = joint.map(|joint| (joint.xyz, joint.rpy));
        assert_eq!(read, Some((made.xyz, made.rpy)), "{written}");
    }
    let mut bent = written.into_bytes();
    choices.bend(&mut bent);
    if let Some((source, facts)) = read(&bent) {
        assert!(!facts.robots.is_empty() || !source.problems.is_empty());
    }
}

struct Joint {
    name: String,
    parent: usize,
    kind: &'static str,
    xyz: [f64; 3],
    rpy: [f64; 3],
}

/// Up to 20 joints, each with its own child.
fn joints(choices: &mut Choices<'_>) -> Vec<Joint> {
    let number = choices.below(20);
    (0..number)
        .map(|at| Joint {
            name: format!("joint {at}"),
            parent: choices.below(at + 1),
            kind: choices.of(&["fixed", "continuous"]),
            xyz: choices.vector(),
            rpy: choices.vector(),
        })
        .collect()
}

fn written(joints: &[Joint], choices: &mut Choices<'_>) -> String {
    let quote = choices.of(&['"', '\'']);
    let mut out = choices
        .of(&["", "\u{feff}", "<?xml version=\"1.0\"?>\n", "<!-- a robot -->"])
        .to_owned();
    let _ = write!(out, "<robot name={quote}r{quote}>");
    let mut parts: Vec<String> = (0..=joints.len())
        .map(|link| match choices.below(4) {
            0 => format!("<link name='l{link}'><visual><geometry><box size='1 1 1'/></geometry></visual></link>"),
            1 => format!("<link name='l{link}'></link>"),
            _ => format!("<link name={quote}l{link}{quote}/>"),
        })
        .collect();
    for (at, joint) in joints.iter().enumerate() {
        let [x, y, z] = joint.xyz;
        let [roll, pitch, yaw] = joint.rpy;
        let blank = choices.of(&[" ", "  "]);
        parts.push(format!(
            "<joint name={quote}{}{quote} type='{}'>{}<parent link='l{}'/><child link='l{}'/><origin \
             xyz='{x}{blank}{y} {z}' rpy='{roll} {pitch}{blank}{yaw}'/></joint>",
            joint.name,
            joint.kind,
            choices.of(&["", "\n", "<!-- & -->"]),
            joint.parent,
            at + 1,
        ));
    }
    for part in parts {
        out.push_str(choices.of(&["", "\n", "\r\n  ", "<!-- -->"]));
        out.push_str(&part);
    }
    out + "</robot>"
}

/// What is read of a description; `None` if it is not a text.
fn read(bytes: &[u8]) -> Option<(Source, Facts)> {
    let mut source = super::source(bytes, "made.urdf", SourceKind::Urdf)?;
    let facts = urdf::read(&mut source, &urdf::MeshLookup::default());
    Some((source, facts))
}
