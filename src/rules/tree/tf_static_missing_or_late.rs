//! TREE08: latched transforms that are missing, late or not latched.

mod split;

use std::collections::BTreeSet;

use crate::analysis::tf;
use crate::rules::prelude::*;
use crate::source::MessageRef;
use crate::world::bag::{TopicEvidence, is_static_topic};
use crate::world::{BagEvidence, FrameId, World};

pub(crate) struct TfStaticMissingOrLate;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Largest delay of a latched transform after the first message that needs it, seconds.
    pub max_late_s: f64,
}

impl Rule for TfStaticMissingOrLate {
    const NEEDS: &'static [Need] = &[Need::Tf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in world.bags.iter().filter(|bag| !bag.tf.is_empty()) {
            let subject = format!("latched transforms of {}", world.path(bag.source));
            let missing = absent(bag, &subject).or_else(|| unpublished(world, bag, &subject));
            let others = [
                late(bag, &subject, limits),
                volatile(bag, &subject),
                split::split(bag, &subject),
            ];
            let mut findings: Vec<Finding> = others.into_iter().flatten().collect();
            if missing.is_some() && bag.truncated {
                out.too_little(
                    subject.as_str(),
                    "a part of the recording was not read, so a missing transform proves nothing",
                );
            } else if missing.is_none() && findings.is_empty() {
                let latched = bag.tf.iter().filter(|edge| edge.is_static).count();
                let faults = Measured::count("missing, late or volatile", 0).limit(0.0);
                out.pass(subject, [faults.samples(latched as u64)]);
            } else {
                findings.extend(missing);
            }
            for finding in findings {
                out.fail(finding);
            }
        }
    }
}

/// No latched transform at all, and none of the sensors' frames in TF.
fn absent(bag: &BagEvidence, subject: &str) -> Option<Finding> {
    let unknown = tf::without_static(bag);
    let first = unknown.values().min_by_key(|at| at.log_ns)?;
    let message = "the recording has TF but no latched transforms, and no sensor frame is in TF";
    let finding = Finding::error(subject, message, Place::message(bag.source, (*first).clone()))
        .label("its frame cannot be looked up")
        .detail(format!("The sensor frames are {}.", tf::listed(unknown.keys())))
        .help("record `/tf_static` too (every split file needs it), or publish the URDF's transforms during playback")
        .measured(Measured::count("sensor frames without a transform", unknown.len()).limit(0.0));
    Some(finding)
}

/// Fixed joints of a URDF whose link is in no transform of a recording of the same robot.
fn unpublished(world: &World, bag: &BagEvidence, subject: &str) -> Option<Finding> {
    let missing = tf::unpublished_joints(world, bag);
    // One robot may be described twice: in a file and in the recording.
    let names: BTreeSet<&FrameId> = missing.iter().map(|(child, _)| child).collect();
    let (_, joint) = missing.first()?;
    let needed = tf::sensor_frames(bag).map(|(frame, _, _)| frame);
    let children = tf::by_child(bag);
    let hangs_on_one = |frame: &FrameId| {
        tf::upward(&children, frame)
            .last()
            .is_some_and(|root| names.contains(&root))
    };
    let blind: BTreeSet<FrameId> = needed.filter(hangs_on_one).collect();
    let message = match names.len() {
        1 => "1 fixed joint of the URDF is missing from TF".to_owned(),
        n => format!("{n} fixed joints of the URDF are missing from TF"),
    };
    let links = format!("Missing child links: {}.", tf::listed(names.iter().copied()));
    let finding = if blind.is_empty() {
        Finding::warning(subject, message, joint.place.clone()).detail(links)
    } else {
        let message = format!("{message}, but needed by sensor data");
        let detail = format!(
            "{links} Sensor frames without a mounting transform: {}.",
            tf::listed(&blind)
        );
        Finding::error(subject, message, joint.place.clone()).detail(detail)
    };
    let finding = finding
        .label("not in TF")
        .help("start robot_state_publisher with this URDF, and record `/tf_static`")
        .measured(Measured::count("fixed joints missing from TF", names.len()).limit(0.0));
    Some(missing.iter().skip(1).take(5).fold(finding, |finding, (_, joint)| {
        finding.related(joint.place.clone(), "not in TF")
    }))
}

/// Latched transforms that come after the first messages that need them.
fn late(bag: &BagEvidence, subject: &str, limits: &Limits) -> Option<Finding> {
    let mut late: Vec<(f64, FrameId, &MessageRef, &MessageRef)> = Vec::new();
    for (frame, _, needed) in tf::sensor_frames(bag) {
        let of_frame = || bag.tf.iter().filter(|edge| edge.child.canonical() == frame);
        let first = of_frame().map(|edge| &edge.first_at).min_by_key(|at| at.log_ns);
        if let Some(first) = first.filter(|_| of_frame().any(|edge| edge.is_static)) {
            let late_s = first.log_ns.saturating_sub(needed.log_ns) as f64 / 1e9;
            if late_s > limits.max_late_s {
                late.push((late_s, frame, first, needed));
            }
        }
    }
    late.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    let (late_s, frame, first, needed) = late.first()?;
    let names: BTreeSet<&FrameId> = late.iter().map(|(_, frame, _, _)| frame).collect();
    let message = format!("`{frame}` gets its latched transform {late_s:.1} s after its first message");
    let finding = Finding::warning(subject, message, Place::message(bag.source, (*first).clone()))
        .label("first transform")
        .detail(format!("Late frames: {}.", tf::listed(names)))
        .help("start the broadcaster before the sensors, and the recorder before both")
        .measured(Measured::new("delay", *late_s, "s").limit(limits.max_late_s))
        .related(
            Place::message(bag.source, (*needed).clone()),
            "first message that needs it",
        );
    Some(finding)
}

/// A static topic that was offered with durability volatile.
fn volatile(bag: &BagEvidence, subject: &str) -> Option<Finding> {
    let is_volatile = |topic: &&TopicEvidence| is_static_topic(&topic.topic) && tf::is_volatile(topic);
    let topic = bag.topics.values().find(is_volatile)?;
    let first = bag
        .tf
        .iter()
        .find(|edge| edge.topic == topic.topic)
        .map(|edge| edge.first_at.clone());
    let place = first.map_or_else(|| Place::whole(bag.source), |at| Place::message(bag.source, at));
    let message = format!(
        "`{}` is published with durability volatile instead of transient_local",
        topic.topic
    );
    let finding = Finding::error(subject, message, place)
        .detail("Listeners that start later never receive it.")
        .help("publish it with durability transient_local, as StaticTransformBroadcaster does")
        .measured(Measured::count("volatile publishers", 1).limit(0.0));
    Some(finding)
}
