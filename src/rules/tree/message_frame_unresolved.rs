//! TREE07: frames of messages that no transform knows.

use std::cell::OnceCell;
use std::collections::BTreeSet;

use crate::analysis::near::{Names, Reach};
use crate::analysis::tf::{HeaderUse, Used};
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
                let why = "no TF was recorded, and no frame of the messages is in the tree";
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
    /// What reports call the recording.
    path: &'a str,
}

fn subject_of(world: &World, bag: &BagEvidence) -> String {
    format!("messages of {}", world.path(bag.source))
}

fn judge_frame(bag: &BagEvidence, frame: &FrameId, used: &[Used], context: &Context, out: &mut Judge) {
    // The most telling use first: sensor data, then the order of topics.
    let Some(main) = used.iter().rev().max_by_key(|used| used.kind) else {
        return;
    };
    let count = crate::math::stats::total(used.iter().map(|used| used.count));
    let subject = format!("frame `{frame}`");
    let place = Place::message(bag.source, main.first.clone());
    let messages = Measured::new("messages", count as f64, "count").samples(count);
    if frame.as_str().is_empty() {
        let message = format!("{count} messages on {} have an empty frame_id", main.topic.topic);
        let help = "set the driver's frame_id to the frame that the sensor is mounted at";
        let finding = Finding::warning(subject, message, place).help(help);
        return out.fail(finding.measured(messages.limit(0.0)));
    }
    if context.tree.contains(frame) {
        // tf2 knows no description: what a sensor's consumers look up is in TF, where there is any.
        let is_blind = main.kind == HeaderUse::Sensor && !context.recorded.is_empty() && !context.recorded.contains(frame);
        if !is_blind {
            return out.pass(subject, [messages]);
        }
        if bag.truncated || !bag.share.whole {
            return out.too_little(subject, "it is in the description, and its transform may stand in what was not read of TF");
        }
        let message = format!(
            "`{frame}`, the frame of {count} messages on {}, is in the description, but never in TF, which is all that tf2 knows: look-ups fail",
            main.topic.topic
        );
        let finding = Finding::error(subject, message, place)
            .likely()
            .help("start robot_state_publisher with this description, and record its TF")
            .measured(messages.limit(0.0))
            .unless_about(codes::TREE08, context.path.to_owned());
        return out.fail(finding);
    }
    let cleaned = FrameId::new(spelling::clean(frame.as_str()));
    // Names stand in reports as they were published, with a slash in front or without.
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
        Some("no TF was recorded, and a URDF does not hold this frame")
    } else {
        None
    };
    // A frame with another name was read; that a transform is missing may be what was not.
    let is_absence = match &better {
        None => true,
        Some((code, _)) => bag.truncated && [codes::TREE08, codes::TREE16].contains(code),
    };
    if let Some(reason) = unproven.filter(|_| is_absence) {
        return out.too_little(subject, reason);
    }
    let topics: BTreeSet<&str> = used.iter().map(|used| used.topic.topic.as_str()).collect();
    let shown = topics.iter().take(3).copied().collect::<Vec<_>>().join(", ");
    let known = if context.has_tf {
        "neither in TF nor in a URDF"
    } else {
        "not a link of the URDF, and no TF was recorded"
    };
    let message = format!("`{frame}`, the frame of {count} messages on {shown}, is {known}: look-ups fail");
    let near = context.index.get_or_init(|| Names::new(context.tree)).nearest(frame, Reach::SUGGESTION);
    let help = match &near {
        Some(near) => format!(
            "was `{}` meant? Otherwise publish the transform that mounts `{frame}`",
            near.frame
        ),
        None => {
            format!("publish the transform that mounts `{frame}`, or set the driver's frame_id to a frame of the tree")
        }
    };
    let is_soft = names::is_world(frame) || main.kind == HeaderUse::Possible;
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
    out.fail(finding.help(help).measured(messages.limit(0.0)));
}

/// A tree with `odom` or `map` in it is a vehicle's, and a vehicle has a frame of its own.
fn judge_base(world: &World, bag: &BagEvidence, tree: &BTreeSet<FrameId>, out: &mut Judge) {
    let is_above_base = |frame: FrameId| names::standard(&frame).is_some_and(|(_, kind)| kind != Standard::Base);
    let Some(root) = bag.tf.iter().find(|edge| is_above_base(edge.parent.canonical())) else {
        return;
    };
    // A camera or a lidar carried by hand has none.
    if tree
        .iter()
        .any(|frame| names::is_base(frame) || names::is_device(frame))
    {
        return;
    }
    let message = format!(
        "TF holds `{}`, and nothing that is called like a platform's own frame",
        root.parent
    );
    let place = Place::message(bag.source, root.first_at.clone());
    let finding = Finding::warning(subject_of(world, bag), message, place)
        .hint()
        .help("call the platform's frame `base_link` (REP-105), so that tools find it")
        .measured(Measured::count("base frames", 0).limit(1.0));
    out.fail(finding);
}
