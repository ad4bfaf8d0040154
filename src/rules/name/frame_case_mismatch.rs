//! NAME01: one frame spelled in two ways that differ only in case.

use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};

use crate::advice::{literal::with_fix, places};
use crate::analysis::names;
use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::verdict::Safety;
use crate::world::{FrameId, FrameRole, FrameUse, World};

pub(crate) struct FrameCaseMismatch;

impl Rule for FrameCaseMismatch {
    const NEEDS: &'static [Need] = &[Need::Frames];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut groups: BTreeMap<String, BTreeMap<FrameId, Vec<&FrameUse>>> = BTreeMap::new();
        for used in world.frames.iter().filter(|used| is_name(used.role)) {
            let frame = used.frame.canonical();
            if !frame.as_str().is_empty() {
                let spellings = groups.entry(names::fold(&used.frame)).or_default();
                spellings.entry(frame).or_default().push(used);
            }
        }
        let mut failed = false;
        let components = LazyCell::new(|| world.graph().components());
        let trees = LazyCell::new(|| -> BTreeMap<&FrameId, usize> {
            let numbered = components.iter().enumerate();
            let members = numbered.map(|(number, tree)| tree.members.iter().map(move |frame| (frame, number)));
            members.flatten().collect()
        });
        let spelled = LazyCell::new(|| places::NamePlaces::of(world));
        for spellings in groups.values().filter(|spellings| spellings.len() > 1) {
            let right = spellings
                .iter()
                .max_by_key(|(frame, uses)| (standing(uses), std::cmp::Reverse(*frame)));
            let Some((right, right_uses)) = right else { continue };
            for (odd, odd_uses) in spellings.iter().filter(|(frame, _)| *frame != right) {
                // Letters that only look the same are NAME02's.
                if odd.as_str().to_lowercase() == right.as_str().to_lowercase()
                    && let Some(finding) = judge_pair((world, &trees, &spelled), (odd, odd_uses), (right, right_uses))
                {
                    failed = true;
                    out.fail(finding);
                }
            }
        }
        if !failed && !groups.is_empty() {
            let twins = Measured::count("names that differ only in case", 0).limit(0.0);
            out.pass("frame names", [twins.samples(groups.len() as u64)]);
        }
    }
}

/// Labels from calibration keys are no frame names, and simulators have names of their own.
fn is_name(role: FrameRole) -> bool {
    !matches!(role, FrameRole::CalibrationLabel | FrameRole::Simulator)
}

/// How reliable a name is as the right spelling: TF before links, before references; then the number of uses.
fn standing(uses: &[&FrameUse]) -> (u8, usize) {
    let of = |role: FrameRole| match role {
        FrameRole::TfParent | FrameRole::TfChild => 4,
        FrameRole::Link => 3,
        FrameRole::JointParent | FrameRole::JointChild => 2,
        FrameRole::Header | FrameRole::OdometryChild => 1,
        _ => 0,
    };
    (uses.iter().map(|used| of(used.role)).max().unwrap_or(0), uses.len())
}

/// Sources in which a name is a frame of its own, not only a reference to one.
fn defined_in(uses: &[&FrameUse]) -> BTreeSet<SourceId> {
    let defines = |role| matches!(role, FrameRole::Link | FrameRole::TfParent | FrameRole::TfChild);
    let defining = uses.iter().filter(|used| defines(used.role));
    defining.map(|used| used.place.source).collect()
}

fn judge_pair(
    (world, trees, spelled_at): (&World, &BTreeMap<&FrameId, usize>, &places::NamePlaces),
    (odd, odd_uses): (&FrameId, &Vec<&FrameUse>),
    (right, right_uses): (&FrameId, &Vec<&FrameUse>),
) -> Option<Finding> {
    let first = odd_uses.iter().min_by_key(|used| (used.role, &used.place))?;
    let witness = right_uses
        .iter()
        .min_by_key(|used| (std::cmp::Reverse(standing(&[used])), &used.place))?;
    let is_connected = trees.get(odd).is_some_and(|tree| trees.get(right) == Some(tree));
    let are_twins = !defined_in(odd_uses).is_disjoint(&defined_in(right_uses));
    let twins = "if they are one frame, delete one of the two; otherwise give them names that differ in more than case";
    let help = (are_twins && is_connected).then(|| twins.to_owned());
    let subject = format!("frame `{odd}`");
    let finding = if are_twins && is_connected {
        let message = format!("`{odd}` and `{right}` are two frames of one tree whose names differ only in case");
        Finding::warning(subject, message, first.place.clone())
    } else {
        let (role, other) = (first.role.words(), witness.role.words());
        let message = format!("`{odd}` ({role}) is spelled `{right}` elsewhere ({other})");
        if [right, odd].iter().any(|frame| world.graph().frames.contains(*frame)) {
            Finding::error(subject, message, first.place.clone())
                .detail("Frame names are case-sensitive: these are two different frames.")
        } else {
            Finding::warning(subject, message, first.place.clone()).likely()
        }
    };
    let finding = finding
        .label(format!("spelled `{odd}`"))
        .related(witness.place.clone(), format!("spelled `{right}`"))
        .help(help.unwrap_or_else(|| format!("spell it `{right}` everywhere")))
        .measured(Measured::count("spellings", 2).expected(1.0));
    // Two links of these names in one file are two frames: renaming one would merge them.
    let spelled = odd_uses.iter().map(|used| &used.frame).collect::<BTreeSet<_>>();
    let only = spelled.first().filter(|_| !are_twins && spelled.len() == 1);
    let edits = only.and_then(|spelled_as| spelled_at.rename_edits(spelled_as, right.as_str()));
    let title = format!("rename `{odd}` to `{right}`");
    Some(with_fix(finding, &title, Safety::Safe, edits))
}
