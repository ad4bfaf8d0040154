//! URDF13: another parser rejects the description, or reads a different robot from it.

use std::collections::BTreeMap;

use crate::advice::subject;
use crate::rules::prelude::*;
use crate::source::SourceValue;
use crate::world::World;
use crate::world::robot::{ConsumerJoint, ConsumerOpinion, Joint, NumberList, Robot};

pub(crate) struct ConsumerDisagrees;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Difference of a number that only its parsing can explain, metres or radians.
    pub number: f64,
}

/// The parser that the description is compared with.
const CONSUMER: &str = "urdf-rs";

impl Rule for ConsumerDisagrees {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for robot in subject::whole_robots(world, out) {
            match &robot.consumer {
                ConsumerOpinion::Loads(joints) => judge_loaded(world, robot, joints, limits, out),
                ConsumerOpinion::Refuses(why) => out.fail(refused(world, robot, why)),
                ConsumerOpinion::NotAsked(why) => {
                    out.missing(crate::analysis::urdf::called::robot(world, robot), why);
                }
            }
        }
    }
}

/// One parser's refusal is no proof: urdfdom accepts files that it rejects, and vice versa.
fn refused(world: &World, robot: &Robot, why: &str) -> Finding {
    let malformed = robot
        .malformed
        .iter()
        .map(|list| (&list.text.place, list.malformed.clone().unwrap_or_default()));
    let repeated = robot.repeated.iter().flat_map(|item| {
        let why = format!("<{}> is written {} times", item.element, item.places.len());
        item.places.iter().map(move |place| (place, why.clone()))
    });
    let causes: Vec<(&Place, String)> = malformed.chain(repeated).collect();
    let (probably, help) = match causes.first() {
        None => (
            "",
            "compare the file with the specification of URDF: the parser gives no place",
        ),
        Some((_, why)) if why.contains("unexpanded") => (
            ", probably because an expression is not expanded",
            "expand the file with `xacro`, or write numbers at the marked places",
        ),
        Some(_) if !robot.malformed.is_empty() => (
            ", probably because numbers are malformed",
            "write plain numbers, separated by spaces, at the marked places",
        ),
        Some(_) => (
            ", probably because an element is repeated",
            "delete the repeated element at one of the marked places",
        ),
    };
    let message = format!("the parser {CONSUMER} rejects robot `{}`{probably}", robot.name.value);
    let finding = Finding::note(
        crate::analysis::urdf::called::robot(world, robot),
        message,
        robot.name.place.clone(),
    )
    .label("rejected")
    .detail(format!(
        "Programs in Rust that use {CONSUMER} cannot load the robot. Error of {CONSUMER}: {}.",
        why.trim_start_matches("custom: ")
    ))
    .help(help)
    .measured(Measured::count("parsers that reject the file", 1).limit(0.0));
    let finding = causes.iter().take(3).fold(finding, |finding, (place, why)| {
        let note = match causes.first() {
            Some((_, first)) if first == why && finding.places.len() > 1 => "the same cause".to_owned(),
            _ => format!("probable cause: {why}"),
        };
        finding.related((*place).clone(), note)
    });
    if causes.is_empty() { finding.hint() } else { finding }
}

fn judge_loaded(world: &World, robot: &Robot, loaded: &[ConsumerJoint], limits: &Limits, out: &mut Judge) {
    let mut by_name: BTreeMap<&str, Vec<&ConsumerJoint>> = BTreeMap::new();
    for joint in loaded {
        by_name.entry(joint.name.as_str()).or_default().push(joint);
    }
    let mut compared = 0;
    let mut differing = 0;
    for joint in &robot.joints {
        // Joints of one name are URDF05's: they cannot be matched.
        let [read] = by_name.get(joint.name.value.as_str()).map_or(&[][..], Vec::as_slice) else {
            continue;
        };
        compared += 1;
        if let Some(finding) = compare(world, robot, joint, read, limits) {
            differing += 1;
            out.fail(finding);
        }
    }
    let (written, read) = (robot.joints.len(), loaded.len());
    if written != read {
        let message = format!("{CONSUMER} reads {read} joints, but the file has {written}");
        let finding = Finding::error(
            crate::analysis::urdf::called::robot(world, robot),
            message,
            robot.name.place.clone(),
        )
        .label("a different tree is read")
        .help("look for joints nested where a parser does not read them, or joints with the same name");
        out.fail(finding.measured(Measured::count("joints read", read).expected(written as f64)));
    } else if differing == 0 {
        let measured = Measured::count("joints read differently", 0).limit(0.0);
        out.pass(
            crate::analysis::urdf::called::robot(world, robot),
            [measured, Measured::count("joints compared", compared)],
        );
    }
}

fn compare(world: &World, robot: &Robot, joint: &Joint, read: &ConsumerJoint, limits: &Limits) -> Option<Finding> {
    let name = &joint.name.value;
    let owner = || crate::analysis::urdf::called::joint(world, robot, joint);
    if let Some((written, read)) = other_link(joint, read) {
        let message = format!(
            "{CONSUMER} reads link `{read}` at joint `{name}`, but the file names `{}`",
            written.value
        );
        let finding = Finding::error(owner(), message, written.place.clone())
            .label("read differently")
            .help("write the name without whitespace or entities");
        return Some(finding.measured(Measured::count("links read differently", 1).limit(0.0)));
    }
    // With several origins it is URDF07 that says so.
    let origin = match joint.origins.as_slice() {
        [] => None,
        [origin] => Some(origin),
        _ => return None,
    };
    if let Some(quaternion) = origin.and_then(|origin| origin.quat_xyzw.as_ref()) {
        let message = format!("{CONSUMER} ignores `quat_xyzw`: it reads joint `{name}` without rotation");
        let finding = Finding::note(owner(), message, quaternion.text.place.clone())
            .label("ignored by older parsers")
            .help("write `rpy` as long as parsers of URDF 1.0 and 1.1 read the file");
        return Some(finding.measured(Measured::count("attributes ignored", 1).limit(0.0)));
    }
    let lists = [
        ("xyz", origin.and_then(|origin| origin.xyz.as_ref()), read.xyz),
        ("rpy", origin.and_then(|origin| origin.rpy.as_ref()), read.rpy),
    ];
    lists.into_iter().find_map(|(attribute, written, read)| {
        let difference = difference(written, read).filter(|difference| *difference > limits.number)?;
        let place = written.map_or_else(|| joint.place.clone(), |list| list.text.place.clone());
        let message = format!("{CONSUMER} reads a different `{attribute}` at joint `{name}`, off by {difference:.3e}");
        let measured = Measured::new(format!("difference of {attribute}"), difference, "m or rad");
        let finding = Finding::error(owner(), message, place)
            .label("read differently")
            .detail(format!("It reads {read:?}."))
            .help("write numbers such as `-1.57`");
        Some(finding.measured(measured.limit(limits.number)))
    })
}

/// An end of the joint that the parser reads as another link.
fn other_link<'a>(joint: &'a Joint, read: &'a ConsumerJoint) -> Option<(&'a SourceValue<String>, &'a str)> {
    let ends = [(&joint.parent, &read.parent), (&joint.child, &read.child)];
    ends.into_iter().find_map(|(written, read)| {
        let written = written.as_ref()?;
        (written.value != *read).then_some((written, read.as_str()))
    })
}

/// Largest difference of a component; `None` where the text is malformed or not finite, which other rules report.
fn difference(written: Option<&NumberList>, read: [f64; 3]) -> Option<f64> {
    let written = written.map_or(Some([0.0; 3]), NumberList::array::<3>)?;
    let differences = written.iter().zip(read).map(|(a, b)| (a - b).abs());
    differences.reduce(f64::max).filter(|largest| largest.is_finite())
}
