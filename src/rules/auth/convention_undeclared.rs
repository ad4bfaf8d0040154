//! AUTH04: topics with orientations or velocities that the configuration does not declare.

use std::collections::BTreeSet;

use crate::rules::prelude::*;
use crate::world::{BagEvidence, FrameId, World, bag::TopicEvidence};

pub(crate) struct ConventionUndeclared;

/// Topics that are named in a finding.
const NAMED: usize = 8;

impl Rule for ConventionUndeclared {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        for bag in &world.bags {
            judge_bag(world, bag, out);
        }
    }
}

fn judge_bag(world: &World, bag: &BagEvidence, out: &mut Judge) {
    let subject = format!("conventions of the topics of {}", world.path(bag.source));
    let topics: Vec<(&str, bool, &'static str)> = bag
        .topics
        .values()
        .filter_map(|topic| declaration(world, bag, topic))
        .collect();
    if topics.is_empty() {
        return out.missing(subject, "no topic with IMU or odometry messages");
    }
    if !world.conventions.declare_of(world.path(bag.source)) {
        let why = "nothing is declared: state under `conventions:` in frames-lint.yaml what each topic is expressed in";
        return out.missing(subject, why);
    }
    let open: Vec<&(&str, bool, &str)> = topics.iter().filter(|(_, is_declared, _)| !is_declared).collect();
    let measured = Measured::count("topics without a declaration", open.len())
        .limit(0.0)
        .samples(topics.len() as u64);
    if open.is_empty() {
        return out.pass(subject, [measured]);
    }
    let names: Vec<String> = open
        .iter()
        .take(NAMED)
        .map(|(topic, ..)| format!("`{topic}`"))
        .collect();
    let more = match open.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let lines: Vec<String> = open
        .iter()
        .take(NAMED)
        .map(|(topic, _, line)| format!("- {{topic: {topic}, {line}}}"))
        .collect();
    let (which, detail) = match names.as_slice() {
        [only] => (only.clone(), String::new()),
        _ => (
            format!("{} topics", open.len()),
            format!("Not declared: {}{more}.", names.join(", ")),
        ),
    };
    let message = format!("{which}: conventions are not declared (frames-lint.yaml declares other topics)");
    let help = format!(
        "add this to `conventions:` in frames-lint.yaml. It states the conventions of ROS: change it where the driver has others\n{}",
        lines.join("\n")
    );
    let finding = Finding::note(subject, message, Place::whole(bag.source))
        .hint()
        .detail(detail)
        .help(help);
    out.fail(finding.measured(measured));
}

/// A topic that is expressed in axes of the world or of a body: whether it is declared, and the line that declares the usual convention.
fn declaration<'w>(
    world: &World,
    bag: &BagEvidence,
    topic: &'w TopicEvidence,
) -> Option<(&'w str, bool, &'static str)> {
    let said: Vec<_> = topic.contents().filter(|said| !said.guessed).collect();
    let has = |test: fn(&crate::world::content::ContentEvidence) -> bool| said.iter().any(|said| test(said.content));
    let line = if has(|content| content.odometry.is_some()) {
        "world: ENU, body: FLU"
    } else if has(|content| content.imu.is_some()) {
        "world: ENU, body: FLU, quaternion: {order: xyzw, algebra: hamilton}"
    } else {
        return None;
    };
    let frames: BTreeSet<&FrameId> = topic.header_frames.keys().collect();
    let frames: Vec<&FrameId> = frames.into_iter().collect();
    let is_declared = world.declared(bag.source, &topic.topic, &frames).is_some();
    Some((topic.topic.as_str(), is_declared, line))
}
