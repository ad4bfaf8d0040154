//! TREE07: frames of messages that are in no transform.

use std::cell::OnceCell;
use std::collections::BTreeSet;

use crate::analysis::near::{Names, Reach};
use crate::analysis::tf::{BagFrameUse, HeaderUse};
use crate::analysis::{names, names::Standard, spelling, tf};
use crate::rules::prelude::*;
use crate::world::{BagEvidence, FrameId, World};

pub(crate) struct MessageFrameUnresolved;

impl Rule for MessageFrameUnresolved {
    const NEEDS: &'static [Need] = &[Need::RobotOrTf, Need::Bag];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let recorded: BTreeSet<FrameId> = world.bags.iter().flat_map(tf::frames).collect();
        let has_tf = world.bags.iter().any(|bag| !bag.tf.is_empty());
        for bag in &world.bags {
            let uses = tf::header_frames(bag);
            let tree = &world.graph().frames;
            // The TF of another recording in the same folder may be of another robot.
            let strange = bag.tf.is_empty() && !uses.keys().any(|frame| tree.contains(frame));
            if strange && !uses.is_empty() {
                let why =
                    "no TF was recorded, and no frame of the messages is in the tree: record `/tf` and `/tf_static`";
                out.too_little(subject_of(world, bag), why);
                continue;
            }
            let odoms = tf::moving_odoms(bag);
            let uncorrected = odoms
                .iter()
                .flat_map(|odom| tf::without_correction(bag, odom).into_keys());
            let uncorrected = uncorrected.collect();
            let context = Context {
                tree,
                index: OnceCell::new(),
                recorded: &recorded,
                folded: tree.iter().map(names::fold).collect(),
                unlatched: tf::without_static(bag).into_keys().collect(),
                uncorrected,
                has_tf,
                path: world.path(bag.source),
            };
            judge_base(world, bag, tree, out);
            for (frame, used) in &uses {
                judge_frame(bag, frame, used, &context, out);
            }
        }
    }
}

struct Context<'a> {
    tree: &'a BTreeSet<FrameId>,
    index: OnceCell<Names<'a>>,
    /// The frames of recorded TF.
    recorded: &'a BTreeSet<FrameId>,
    folded: BTreeSet<String>,
    unlatched: BTreeSet<FrameId>,
    uncorrected: BTreeSet<FrameId>,
    has_tf: bool,
    /// Path of the recording in reports.
    path: &'a str,
}

fn subject_of(world: &World, bag: &BagEvidence) -> String {
    format!("messages of {}", world.path(bag.source))
}

fn judge_frame(bag: &BagEvidence, frame: &FrameId, used: &[BagFrameUse], context: &Context, out: &mut Judge) {
    // The most important use first: sensor data, then the order of topics.
    let Some(main) = used.iter().rev().max_by_key(|used| used.kind) else {
        return;
    };
    let count = crate::math::stats::total(used.iter().map(|used| used.count));
    let subject = format!("frame `{frame}`");
    let place = Place::message(bag.source, main.first.clone());
    let messages = Measured::new("messages", count as f64, "count").samples(count);
    if frame.as_str().is_empty() {
        let message = format!("`{}`: {count} messages have an empty frame_id", main.topic.topic);
        let help = "set the driver's frame_id to the frame in which its data are expressed";
        let finding = Finding::warning(subject, message, place).help(help);
        return out.fail(finding.measured(messages.limit(0.0)));
    }
    if context.tree.contains(frame) {
        // tf2 knows no URDF: where there is TF, consumers of sensor data depend on it.
        let is_blind =
            main.kind == HeaderUse::Sensor && !context.recorded.is_empty() && !context.recorded.contains(frame);
        if !is_blind {
            return out.pass(subject, [messages]);
        }
        if bag.truncated || !bag.share.whole {
            let why = "it is in the URDF, but its transform may be in the part of TF that was not read";
            return out.too_little(subject, why);
        }
        let message = format!(
            "`{frame}` is in the URDF but not in TF; {count} messages on `{}` use it",
            main.topic.topic
        );
        let finding = Finding::error(subject, message, place)
            .likely()
            .detail("tf2 knows published transforms only, so look-ups of these messages fail.")
            .help("start robot_state_publisher with this URDF, and record its TF")
            .measured(messages.limit(0.0))
            .unless_about(codes::TREE08, context.path.to_owned());
        return out.fail(finding);
    }
    let cleaned = FrameId::new(spelling::clean(frame.as_str()));
    // Reports show names as published, with or without a leading slash.
    let quoted = format!("{frame}`");
    let better = if context.folded.contains(&names::fold(frame)) {
        Some((codes::NAME01, quoted))
    } else if context.tree.contains(&cleaned) {
        Some((codes::NAME02, quoted))
    } else if context.uncorrected.contains(frame) {
        Some((codes::TREE16, quoted))
    } else if context.unlatched.contains(frame) {
        Some((codes::TREE08, context.path.to_owned()))
    } else {
        None
    };
    let unproven = if bag.truncated {
        Some("a part of the recording was not read, so a missing transform proves nothing")
    } else if !context.has_tf && names::is_world(frame) {
        Some("no TF was recorded, and a URDF does not contain world frames: record `/tf`")
    } else {
        None
    };
    // A similar name was read, which is evidence; a missing transform may only be in the part that was not read.
    let is_absence = match &better {
        None => true,
        Some((code, _)) => bag.truncated && [codes::TREE08, codes::TREE16].contains(code),
    };
    if let Some(reason) = unproven.filter(|_| is_absence) {
        return out.too_little(subject, reason);
    }
    let topics: BTreeSet<&str> = used.iter().map(|used| used.topic.topic.as_str()).collect();
    let shown: Vec<String> = topics.iter().take(3).map(|topic| format!("`{topic}`")).collect();
    let (absent, detail) = if context.has_tf {
        ("not in TF or any URDF", "Look-ups in tf2 fail (LookupException).")
    } else {
        (
            "not a link of the URDF",
            "No TF was recorded: something else may have published the frame.",
        )
    };
    let message = format!("`{frame}` is {absent}, but is the frame of {count} messages");
    let detail = format!("The messages are on {}. {detail}", shown.join(", "));
    let near = context
        .index
        .get_or_init(|| Names::new(context.tree))
        .nearest(frame, Reach::SUGGESTION);
    let help = how_to_tie(frame, near.as_ref().map(|near| near.frame.to_string()));
    // Poses may be of another object, or in the frame of a tracker outside of the robot.
    let is_foreign = main.kind == HeaderUse::Spatial && near.is_none() && !names::is_base(frame);
    let is_soft = names::is_world(frame) || main.kind == HeaderUse::Possible || is_foreign;
    let finding = if is_soft {
        Finding::warning(subject, message, place).likely()
    } else {
        Finding::error(subject, message, place)
    };
    let finding = if context.has_tf { finding } else { finding.likely() };
    let finding = match better {
        Some((rule, about)) => finding.unless_about(rule, about),
        None => finding,
    };
    out.fail(finding.detail(detail).help(help).measured(messages.limit(0.0)));
}

/// A tree with `odom` or `map` in it is a vehicle's, and a vehicle has a base frame.
fn judge_base(world: &World, bag: &BagEvidence, tree: &BTreeSet<FrameId>, out: &mut Judge) {
    let is_above_base = |frame: FrameId| names::standard(&frame).is_some_and(|(_, kind)| kind != Standard::Base);
    let Some(root) = bag.tf.iter().find(|edge| is_above_base(edge.parent.canonical())) else {
        return;
    };
    // A hand-held camera or lidar has none.
    if tree
        .iter()
        .any(|frame| names::is_base(frame) || names::is_device(frame))
    {
        return;
    }
    let message = format!(
        "TF contains `{}`, but no frame that is named like a vehicle's base",
        root.parent
    );
    let place = Place::message(bag.source, root.first_at.clone());
    let finding = Finding::warning(subject_of(world, bag), message, place)
        .hint()
        .help("name the vehicle's base frame `base_link` (REP-105), so that tools find it")
        .measured(Measured::count("base frames", 0).at_least(1.0));
    out.fail(finding);
}

/// What to do about a frame that is in no tree; `near` is one of a similar name.
fn how_to_tie(frame: &FrameId, near: Option<String>) -> String {
    match near {
        Some(near) => format!("use `{near}` if that is meant; otherwise publish the transform that mounts `{frame}`"),
        None if names::is_world(frame) => format!(
            "publish the transform from `{frame}` to the base (odometry, localization), or set the driver's frame_id to a frame of the tree"
        ),
        None => {
            format!("publish the transform that mounts `{frame}`, or set the driver's frame_id to a frame of the tree")
        }
    }
}
