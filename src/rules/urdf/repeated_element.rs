//! URDF07: a repeated element where parsers read only one.

use crate::advice::subject;
use crate::rules::prelude::*;
use crate::world::World;
use crate::world::robot::{RepeatedItem, Robot};

pub(crate) struct RepeatedElement;

/// Elements that place or move frames: the one that is read decides where a link is.
const PLACING: &[&str] = &["origin", "parent", "child", "axis", "limit", "mimic"];

impl Rule for RepeatedElement {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        // In a fragment both may be in alternative branches.
        for robot in subject::whole_robots(world, out) {
            if robot.repeated.is_empty() {
                out.pass(
                    crate::analysis::urdf::called::robot(world, robot),
                    [
                        Measured::count("repeated elements", 0).limit(0.0),
                        Measured::count("joints", robot.joints.len()),
                    ],
                );
            }
            for repeated in &robot.repeated {
                if let Some(finding) = finding(world, robot, repeated) {
                    out.fail(finding);
                }
            }
        }
    }
}

fn finding(world: &World, robot: &Robot, repeated: &RepeatedItem) -> Option<Finding> {
    let (first, second) = repeated.places.first().zip(repeated.places.get(1))?;
    let same = repeated
        .places
        .iter()
        .all(|place| text(world, place) == text(world, first));
    let places_frames = PLACING.contains(&repeated.element.as_str());
    let severity = match (same, places_frames) {
        (true, _) => Severity::Note,
        (false, true) => Severity::Error,
        (false, false) => Severity::Warning,
    };
    let (element, owner, count) = (&repeated.element, &repeated.owner, repeated.places.len());
    let verb = if same { "all equal" } else { "which differ" };
    let message = format!("{owner} has {count} <{element}> elements, {verb}: parsers read only one");
    let subject = format!("<{element}> of {owner} of {}", world.path(robot.source));
    Some(
        Finding::new(severity, subject, message, second.clone())
            .label("second")
            .related(first.clone(), "first")
            .help(if same {
                "delete the repeated one"
            } else {
                "delete all but the intended one: which one is read depends on the parser"
            })
            .measured(Measured::count(format!("<{element}> elements"), count).limit(1.0)),
    )
}

/// The text of an element with whitespace collapsed, as far as its place covers it; empty where there is no text.
fn text(world: &World, place: &Place) -> String {
    let source = world.source(place.source);
    let text = source
        .zip(place.span())
        .and_then(|(source, span)| source.text.get(span.start..span.end));
    text.unwrap_or_default()
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}
