//! NAME02: whitespace, slashes and invisible characters in frame names.

use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};

use crate::advice::places;
use crate::analysis::{spelling, spelling::Fault, tf};
use crate::rules::prelude::*;
use crate::source::{Confidence, SourceId, SourceKind};
use crate::verdict::Safety;
use crate::world::{FrameId, FrameRole, FrameUse, World};

pub(crate) struct FrameWhitespaceOrSlash;

impl Rule for FrameWhitespaceOrSlash {
    const NEEDS: &'static [Need] = &[Need::Frames];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut spelled: BTreeMap<&FrameId, Vec<&FrameUse>> = BTreeMap::new();
        for used in world.frames.iter().filter(|used| is_name(used)) {
            spelled.entry(&used.frame).or_default().push(used);
        }
        let mut groups: BTreeMap<(SourceId, Grade), Vec<FaultyName>> = BTreeMap::new();
        for (frame, uses) in &spelled {
            let worst = uses
                .iter()
                .filter_map(|used| Some((judge_use(world, used)?, *used)))
                .min_by_key(|((severity, confidence, _), used)| {
                    (std::cmp::Reverse((*severity, *confidence)), used.role, &used.place)
                });
            if let Some((grade, used)) = worst {
                let count = crate::math::stats::total(uses.iter().map(|used| used.count.max(1)));
                let wrong = FaultyName { frame, used, count };
                groups.entry((used.place.source, grade)).or_default().push(wrong);
            }
        }
        let texts = LazyCell::new(|| Texts {
            spelled: places::NamePlaces::of(world),
            links: world
                .robots
                .iter()
                .flat_map(|robot| &robot.links)
                .map(|link| link.name.value.as_str())
                .collect(),
        });
        for ((_, grade), names) in &groups {
            if names.len() > MANY {
                out.fail(report((world, &texts), *grade, names));
            } else {
                for name in names {
                    out.fail(report((world, &texts), *grade, std::slice::from_ref(name)));
                }
            }
        }
        if groups.is_empty() && !spelled.is_empty() {
            let names = Measured::count("names with stray characters", 0).limit(0.0);
            out.pass("frame names", [names.samples(spelled.len() as u64)]);
        }
    }
}

/// Up to how many names of one source with one fault are reported one by one.
const MANY: usize = 3;

type Grade = (Severity, Confidence, Fault);

/// A name that is wrong, its most severe use and how often it is used.
struct FaultyName<'a> {
    frame: &'a FrameId,
    used: &'a FrameUse,
    count: u64,
}

/// What renaming needs.
struct Texts<'a> {
    spelled: places::NamePlaces<'a>,
    links: BTreeSet<&'a str>,
}

/// Empty names are TREE04's, TREE07's and TREE12's.
fn is_name(used: &FrameUse) -> bool {
    !used.frame.as_str().is_empty() && !matches!(used.role, FrameRole::CalibrationLabel | FrameRole::Simulator)
}

fn judge_use(world: &World, used: &FrameUse) -> Option<Grade> {
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

/// One finding for a name, or for the many names of one source that share a fault.
fn report((world, texts): (&World, &Texts), (severity, confidence, fault): Grade, names: &[FaultyName]) -> Finding {
    let shown = |wrong: &FaultyName| FrameId::new(wrong.frame.as_str().escape_debug().to_string());
    let first = names.iter().min_by_key(|wrong| (wrong.used.role, &wrong.used.place));
    let place = first.map_or_else(|| Place::whole(SourceId(0)), |wrong| wrong.used.place.clone());
    let listed = tf::listed(&names.iter().map(shown).collect::<Vec<_>>());
    let role = first.map_or("", |wrong| wrong.used.role.words());
    let (subject, message, detail) = if names.len() == 1 {
        let message = format!("frame name {listed} ({role}) {}", fault.words());
        (format!("frame {listed}"), message, fault.why().to_owned())
    } else {
        let path = world.path(place.source);
        let example = first.map_or_else(String::new, |wrong| shown(wrong).to_string());
        let message = format!(
            "{} frame names are misspelt: each {}, such as `{example}`",
            names.len(),
            fault.words()
        );
        (
            format!("frames of {path}"),
            message,
            format!("The names are {listed}. {}", fault.why()),
        )
    };
    let cleaned: Vec<String> = names
        .iter()
        .map(|wrong| spelling::clean(wrong.frame.as_str()))
        .collect();
    let can_clean = |name: &String| !name.is_empty() && !name.contains(char::is_whitespace);
    let help = match (cleaned.first(), names) {
        (Some(name), [one, _, ..]) if can_clean(name) => format!(
            "rename all {} frames in this way wherever they are used: `{}` to `{name}`",
            names.len(),
            shown(one)
        ),
        (Some(name), _) if can_clean(name) => format!("rename the frame to `{name}` wherever the name is used"),
        _ => "use only letters, digits and `_` in the name".to_owned(),
    };
    let count = crate::math::stats::total(names.iter().map(|wrong| wrong.count));
    let finding = Finding::new(severity, subject, message, place)
        .confidence(confidence)
        .label(fault.words())
        .detail(detail)
        .help(help)
        .measured(Measured::new("uses of such names", count as f64, "count").limit(0.0));
    // Where both spellings are links, renaming one would make two links of one name.
    let edits: Option<Vec<_>> = names
        .iter()
        .zip(&cleaned)
        .map(|(wrong, name)| {
            let merges = texts.links.contains(wrong.frame.as_str()) && texts.links.contains(name.as_str());
            let edits = (can_clean(name) && !merges).then(|| texts.spelled.rename_edits(wrong.frame, name));
            edits.flatten()
        })
        .collect();
    match edits {
        Some(edits) => finding.fix("write the clean spelling", Safety::Safe, edits.concat()),
        None => finding,
    }
}
