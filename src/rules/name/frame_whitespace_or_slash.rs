//! NAME02: blanks, slashes and invisible characters in frame names.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::rules::spelling::{self, Fault};
use crate::rules::{Judge, Need, Rule, places};
use crate::source::{Confidence, SourceKind};
use crate::verdict::{Finding, Measured, Safety, Severity};
use crate::world::{FrameId, FrameRole, FrameUse, World};

use super::many_names::{self, Kind};

/// NAME02.
pub struct FrameWhitespaceOrSlash;

/// Limits of the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// How many names of one source with one fault are told apart.
    pub most_apart: usize,
    /// How many places are shown beside the first one.
    pub shown: usize,
}

impl Rule for FrameWhitespaceOrSlash {
    const PAGE: &'static str = include_str!("../../../rules/name/frame-whitespace-or-slash.md");
    const NEEDS: &'static [Need] = &[Need::Frames];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let mut spelled: BTreeMap<&FrameId, Vec<&FrameUse>> = BTreeMap::new();
        for used in world.frames.iter().filter(|used| is_name(used)) {
            spelled.entry(&used.frame).or_default().push(used);
        }
        let mut failed: Vec<(Kind, Finding)> = Vec::new();
        for (frame, uses) in &spelled {
            let worst = uses
                .iter()
                .filter_map(|used| Some((judge_use(world, used)?, *used)))
                .min_by_key(|((severity, confidence, _), used)| {
                    (std::cmp::Reverse((*severity, *confidence)), used.role, &used.place)
                });
            if let Some(((severity, confidence, fault), used)) = worst {
                let finding = report(world, frame, uses, used, (severity, confidence, fault));
                let kind = (used.place.source, severity, confidence, fault.words());
                failed.push((kind, finding));
            }
        }
        if failed.is_empty() && !spelled.is_empty() {
            let names = Measured::count("names with stray characters", 0).limit(0.0);
            out.pass("frame names", [names.samples(spelled.len() as u64)]);
        }
        for finding in many_names::fold(failed, limits.most_apart, limits.shown) {
            out.fail(finding);
        }
    }
}

/// Empty names are TREE04's, TREE07's and TREE12's.
fn is_name(used: &FrameUse) -> bool {
    !used.frame.as_str().is_empty() && !matches!(used.role, FrameRole::CalibrationLabel | FrameRole::Simulator)
}

fn judge_use(world: &World, used: &FrameUse) -> Option<(Severity, Confidence, Fault)> {
    let fault = Fault::of(used.frame.as_str())?;
    let is_config = used.role == FrameRole::Calibration;
    let is_ros1 = world
        .source(used.place.source)
        .is_some_and(|source| source.kind == SourceKind::Rosbag1);
    let (severity, confidence) = match fault {
        // ROS 1 wrote names with a slash, and configurations still do.
        Fault::LeadingSlash | Fault::BlankInside if is_config => (Severity::Warning, Confidence::Likely),
        Fault::LeadingSlash if is_ros1 => (Severity::Warning, Confidence::Certain),
        Fault::Decomposed => (Severity::Warning, Confidence::Certain),
        _ => (Severity::Error, Confidence::Certain),
    };
    Some((severity, confidence, fault))
}

fn report(
    world: &World,
    frame: &FrameId,
    uses: &[&FrameUse],
    used: &FrameUse,
    (severity, confidence, fault): (Severity, Confidence, Fault),
) -> Finding {
    let count: u64 = uses.iter().map(|used| used.count.max(1)).sum();
    let cleaned = spelling::clean(frame.as_str());
    let shown = frame.as_str().escape_debug();
    let message = format!(
        "the frame name `{shown}` ({}) {}: {}",
        used.role.words(),
        fault.words(),
        fault.why()
    );
    let can_clean = cleaned != frame.as_str() && !cleaned.is_empty() && !cleaned.contains(char::is_whitespace);
    let help = if can_clean {
        format!("write `{cleaned}`")
    } else {
        "write it with letters, digits and `_`".to_owned()
    };
    let finding = Finding::new(severity, format!("frame `{shown}`"), message, used.place.clone())
        .confidence(confidence)
        .label(fault.words())
        .help(help)
        .measured(Measured::new("uses of the name", count as f64, "count").limit(0.0));
    // Where both spellings are links, renaming one would make two links of one name.
    let is_link = |name: &str| {
        world
            .robots
            .iter()
            .any(|robot| robot.links_named(name).next().is_some())
    };
    let merges = is_link(frame.as_str()) && is_link(&cleaned);
    let edits = if can_clean && !merges {
        places::rename_edits(world, frame, &cleaned)
    } else {
        None
    };
    match edits {
        Some(edits) => finding.fix(format!("write `{cleaned}`"), Safety::Safe, edits),
        None => finding,
    }
}
