//! TREE16: a correction `map` -> `odom` that is missing, constant, or not applied to a topic that is named a map.

use crate::analysis::motion::{BagMotion, Motion};
use crate::analysis::tree::drift::{Limits, drift};
use crate::analysis::tree::held::Held;
use crate::analysis::{names::Standard, tf, tf::BagFrameUse};
use crate::rules::prelude::*;
use crate::source::MessageRef;
use crate::world::bag::{TfEdge, TopicEvidence};
use crate::world::{BagEvidence, FrameId};

pub(crate) struct MapOdomNotApplied;

impl Rule for MapOdomNotApplied {
    const NEEDS: &'static [Need] = &[Need::Tf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for (bag, motion) in world.bags.iter().zip(&Motion::of(world).bags) {
            for odom in tf::moving_odoms(bag) {
                let subject = format!("correction of `{odom}` in {}", world.path(bag.source));
                judge_odom(bag, motion, &odom, subject, limits, out);
            }
        }
    }
}

fn judge_odom(
    bag: &BagEvidence,
    motion: &BagMotion,
    odom: &FrameId,
    subject: String,
    limits: &Limits,
    out: &mut Judge,
) {
    let correction = bag
        .tf
        .iter()
        .find(|edge| edge.child.canonical() == *odom && tf::is_standard(&edge.parent.canonical(), Standard::Map));
    let change = correction.map_or((0.0, 0.0), |edge| {
        edge.extreme
            .as_ref()
            .map_or((0.0, 0.0), |(_, rad, m)| (*m, rad.to_degrees()))
    });
    let moves = change.0 > limits.constant_m || change.1 > limits.constant_deg;
    let shift = Measured::new("change of the correction, position", change.0, "m").limit(limits.constant_m);
    let turn = Measured::new("change of the correction, rotation", change.1, "deg").limit(limits.constant_deg);
    let misnamed = bag
        .topics
        .values()
        .find_map(|topic| Some((topic, map_in(topic, odom)?)));
    if let Some((edge, (topic, place))) = correction.zip(misnamed) {
        let finding = misnamed_map(bag, edge, odom, subject, topic, place, moves);
        return out.fail(finding.measured(shift).measured(turn));
    }
    let Some(edge) = correction else {
        return without_map(bag, odom, subject, out);
    };
    let map = edge.parent.canonical();
    if moves {
        let same = [limits.constant_deg.to_radians(), limits.constant_m];
        return match Held::of(motion, odom, &map, same).filter(|held| is_left_behind(held, limits)) {
            Some(held) => out.fail(stopped(bag, edge, odom, subject, &held, limits)),
            None => out.pass(subject, [shift.samples(edge.count), turn.samples(edge.count)]),
        };
    }
    let value = if is_identity(edge, limits) {
        "the identity"
    } else {
        "the same"
    };
    let seen = format!("`{map}` -> `{odom}` is {value} in all {} transforms", edge.count);
    let drift = match drift(motion, odom, &map, limits) {
        Ok(drift) => drift,
        Err(why) => return out.missing(subject, format!("{seen}; {why}")),
    };
    match drift.is_significant(limits) {
        Some(true) => {
            let message = format!(
                "`{map}` -> `{odom}` is constant, but the odometry drifts by {:.2} m in {:.0} m of driving",
                drift.by_m, drift.way_m
            );
            let finding =
                Finding::warning(subject, message, Place::message(bag.source, edge.first_at.clone())).likely();
            let finding = finding.detail(format!(
                "{seen}. The drift is relative to {}; the limit is {} % of the path, and at least {} m.",
                drift.against,
                100.0 * limits.drift_share,
                limits.drift_m
            ));
            let finding = finding.help(format!(
                "run the localizer that publishes `{map}` -> `{odom}`: with a constant transform, `{map}` drifts like `{odom}`"
            ));
            out.fail(finding.measured(drift.measured(limits)));
        }
        Some(false) => out.pass(subject, drift.measured(limits)),
        None => {
            let why = format!(
                "{seen}; relative to {}, the odometry drifts by {:.1} +- {:.1} m, which is too uncertain: record a longer drive",
                drift.against, drift.by_m, drift.sigma_m
            );
            out.too_little(subject, why);
        }
    }
}

/// Whether the poses in `map` have moved away from TF since the correction stands still.
fn is_left_behind(held: &Held, limits: &Limits) -> bool {
    let [first_m, last_m] = held.apart_m;
    held.lasts_s >= limits.held_s && last_m >= limits.held_m.max(limits.sigmas * first_m)
}

fn stopped(bag: &BagEvidence, edge: &TfEdge, odom: &FrameId, subject: String, held: &Held, limits: &Limits) -> Finding {
    let map = edge.parent.canonical();
    let [first_m, last_m] = held.apart_m;
    let message = format!(
        "`{map}` -> `{odom}` stands still from {:.0} s on, while the poses in `{map}` move {last_m:.2} m away from TF",
        held.since_s
    );
    Finding::warning(subject, message, Place::message(bag.source, edge.first_at.clone()))
        .likely()
        .detail(format!(
            "For the last {:.0} s the correction is the same in every message. In the first quarter of that time TF is {first_m:.2} m from {}.",
            held.lasts_s, held.against
        ))
        .help(format!(
            "find why the localizer's transform `{map}` -> `{odom}` is no longer updated while its poses are: a second node that repeats the last one?"
        ))
        .measured(Measured::new("distance of TF from the poses at the end", last_m, "m").limit(limits.held_m))
        .measured(Measured::new("time without a change of the correction", held.lasts_s, "s").limit(limits.held_s))
}

fn is_identity(edge: &TfEdge, limits: &Limits) -> bool {
    edge.first().map(|sample| sample.pose.isometry()).is_some_and(|pose| {
        pose.translation.vector.norm() <= limits.constant_m && pose.rotation.angle().to_degrees() <= limits.constant_deg
    })
}

/// The first message of a cloud or grid whose topic is named a map, and which is expressed in `odom`.
fn map_in<'a>(topic: &'a TopicEvidence, odom: &FrameId) -> Option<&'a MessageRef> {
    const NEAR: &[&str] = &[
        "local",
        "odom",
        "rolling",
        "elevation",
        "height",
        "voxel",
        "obstacle",
        "submap",
        "sub",
    ];
    let kind = topic.message_type.rsplit('/').next().unwrap_or_default();
    let words = FrameId::new(topic.topic.as_str()).tokens();
    let is_map = words.iter().any(|word| word == "map") && !words.iter().any(|word| NEAR.contains(&word.as_str()));
    let used = topic
        .header_frames
        .iter()
        .find(|(frame, _)| frame.canonical() == *odom)?;
    (is_map && matches!(kind, "PointCloud2" | "OccupancyGrid")).then_some(&used.1.first)
}

fn misnamed_map(
    bag: &BagEvidence,
    edge: &TfEdge,
    odom: &FrameId,
    subject: String,
    topic: &TopicEvidence,
    first: &MessageRef,
    moves: bool,
) -> Finding {
    let map = edge.parent.canonical();
    let place = Place::message(bag.source, first.clone());
    let message = format!(
        "`{}` is named a map, but expressed in `{odom}` instead of `{map}`",
        topic.topic
    );
    let finding = Finding::warning(subject, message, place)
        .detail(format!(
            "The correction `{map}` -> `{odom}` is not applied to its data."
        ))
        .help(format!(
            "build the map in `{map}`, with `{map}` -> `{odom}` at the time of each scan; or name the topic a local map"
        ))
        .related(Place::message(bag.source, edge.first_at.clone()), "the correction");
    if moves { finding.likely() } else { finding.hint() }
}

/// No correction at all: a fault only where messages are expressed in `map`.
fn without_map(bag: &BagEvidence, odom: &FrameId, subject: String, out: &mut Judge) {
    let named = tf::without_correction(bag, odom).into_iter().next();
    let main = named.as_ref().and_then(|(map, used)| Some((map, used, used.first()?)));
    let Some((map, used, main)) = main else {
        let why = format!("nothing is expressed in `map`, and `{odom}` has no parent of that name");
        return out.not_applicable(subject, why);
    };
    let count = crate::math::stats::total(used.iter().map(|used: &BagFrameUse| used.count));
    let message = format!("{count} messages are expressed in `{map}`, but no transform connects it to `{odom}`");
    let detail = format!(
        "The messages are on `{}`{}.",
        main.topic.topic,
        if used.len() > 1 { ", ..." } else { "" }
    );
    let place = Place::message(bag.source, main.first.clone());
    let finding = Finding::warning(subject, message, place).likely();
    let finding = finding.detail(detail).help(format!(
        "run the localizer that publishes `{map}` -> `{odom}`, and record its TF"
    ));
    out.fail(finding.measured(Measured::new("messages", count as f64, "count").limit(0.0)));
}
