//! NAME03: a frame that is not in the tree, with a name similar to one that is.

use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::near::{Names, Reach, SimilarName};
use crate::analysis::{names, spelling};
use crate::rules::prelude::*;
use crate::world::{FrameId, FrameRole, FrameUse, World};

pub(crate) struct FrameNearDuplicate;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Edits (insert, delete, replace, swap neighbours) that still count as a typo.
    pub max_edits: usize,
    /// Shortest name, in characters, for which edits are counted.
    pub min_length: usize,
}

impl Rule for FrameNearDuplicate {
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let tree = &world.graph().frames;
        let folded: BTreeSet<String> = tree.iter().map(names::fold).collect();
        let reach = Reach {
            max_edits: limits.max_edits,
            min_length: limits.min_length,
        };
        let index = LazyCell::new(|| Names::new(tree));
        let mut named: BTreeMap<FrameId, Vec<&FrameUse>> = BTreeMap::new();
        let refers = |role| {
            matches!(
                role,
                FrameRole::Header | FrameRole::OdometryChild | FrameRole::Calibration
            )
        };
        for used in world.frames.iter().filter(|used| refers(used.role)) {
            named.entry(used.frame.canonical()).or_default().push(used);
        }
        for (frame, uses) in &named {
            // Case is NAME01's, stray characters are NAME02's, an empty name is TREE07's.
            let cleaned = FrameId::new(spelling::clean(frame.as_str()));
            let is_other = folded.contains(&names::fold(frame)) || folded.contains(&names::fold(&cleaned));
            if frame.as_str().is_empty() || (is_other && !tree.contains(frame)) {
                continue;
            }
            let subject = format!("frame `{frame}`");
            let near = if tree.contains(frame) {
                None
            } else {
                index.nearest(frame, reach)
            };
            if let Some(near) = near {
                out.fail(judge_near(world, frame, uses, &near, limits));
            } else if !tree.contains(frame) && index.is_spent() {
                out.too_little(
                    subject,
                    "there are too many unknown names to compare each with the tree",
                );
            } else {
                let names = Measured::count("similar names", 0).limit(0.0);
                out.pass(subject, [names.samples(tree.len() as u64)]);
            }
        }
    }
}

fn judge_near(world: &World, frame: &FrameId, uses: &[&FrameUse], near: &SimilarName, limits: &Limits) -> Finding {
    let used = uses.iter().min_by_key(|used| (used.role, &used.place));
    let words = used.map_or("frame", |used| used.role.words());
    let place = used.map(|used| used.place.clone());
    let place = place.or_else(|| crate::analysis::places::first(world, frame));
    let topic = place.as_ref().and_then(Place::topic);
    let of = topic.map_or_else(String::new, |topic| format!("`{topic}`: "));
    let message = format!("{of}`{frame}` is not in the tree, but `{}` is", near.frame);
    let field = match used.map(|used| used.role) {
        Some(FrameRole::OdometryChild) => "child_frame_id",
        _ => "frame_id",
    };
    let set = match topic {
        Some(topic) => format!("set the {field} of `{topic}` to `{}`", near.frame),
        None => format!("write `{}` instead of `{frame}`", near.frame),
    };
    let help = format!("{set}; if `{frame}` is another frame, publish the transform of `{frame}`");
    let edits = Measured::count(
        "edits between the names, without separators, namespace and ending",
        near.edits,
    )
    .limit(limits.max_edits as f64);
    let place = place.unwrap_or_else(|| crate::source::Place::whole(crate::source::SourceId(0)));
    let finding = Finding::warning(format!("frame `{frame}`"), message, place)
        .likely()
        .detail(format!("`{frame}` ({words}) {} from `{}`.", near.how, near.frame))
        .help(help)
        .measured(edits);
    match crate::analysis::places::first(world, near.frame) {
        Some(place) => finding.related(place, format!("`{}`", near.frame)),
        None => finding,
    }
}
