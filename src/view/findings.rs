//! Each finding as a line of a log at its time, as a page, and as a mark at its frame.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::math::stats::rounded;
use crate::run::Run;
use crate::source::SourcePart;
use crate::tables::views::{self, View};
use crate::verdict::{Finding, Measured, Outcome, Severity};
use crate::world::{BagEvidence, FrameId};

use super::Labels;
use super::look::{TRACK, WorstFinding};
use super::placed::FrameEntities;
use super::scene::{Color, Content, Level, Path, Points, Scene};

/// The root of the findings.
pub(super) const FINDINGS: &str = "findings";

/// Maximum number of findings shown; more are only counted.
const MAX_FINDINGS: usize = 500;

/// The place that shows what the rule of a finding judges.
pub(super) fn view_of(run: &Run, finding: &Finding) -> Option<&'static View> {
    let rule = run.rules.iter().find(|rule| rule.code == finding.rule)?;
    views::of(rule.view)
}

/// Shows every finding.
pub(super) fn findings(run: &Run, placed: &[FrameEntities], labels: &Labels, scene: &mut Scene) -> WorstFinding {
    let top = Path::top(FINDINGS);
    let mut page = summary(run);
    let mut marked: BTreeMap<Path, u8> = BTreeMap::new();
    let mut worst = WorstFinding {
        at_ns: None,
        frame: None,
        is_of_a_track: false,
    };
    for (number, finding) in run.verdict.findings.iter().take(MAX_FINDINGS).enumerate() {
        let (level, color) = loudness(finding);
        let text = finding_text(number, finding);
        let words = line(finding);
        let stamp_ns = finding.places.iter().find_map(|label| match &label.place.at {
            SourcePart::Message(message) => {
                Some(message.stamp_ns.filter(|stamp| *stamp != 0).unwrap_or(message.log_ns))
            }
            _ => None,
        });
        let number_of_world = labels.number(&finding.subject);
        let own = number_of_world.map_or(placed, |of| placed.get(of..=of).unwrap_or_default());
        let size_m = own.first().map_or(1.0, |placed| placed.size_m);
        let frame = frame_of(finding, run, own);
        if number == 0 {
            worst = WorstFinding {
                at_ns: stamp_ns,
                frame: frame.clone(),
                is_of_a_track: view_of(run, finding).is_some_and(|view| view.named == TRACK),
            };
        }
        let path = top.then("log").then(format!("{} {}", number + 1, finding.rule));
        let line = Content::Log(level, words);
        match stamp_ns {
            Some(stamp_ns) => scene.at(&path, stamp_ns, line),
            None => scene.always(&path, line),
        }
        if let Some(at) = frame {
            let nth = marked.entry(at.clone()).or_default();
            *nth = nth.saturating_add(1);
            let mark = at.then(format!("finding {}", number + 1));
            scene.always(&mark, Content::Page(text.clone()));
            scene.always(
                &mark,
                Content::Points(Points {
                    // The labels are below the frame, one below the other.
                    xyz_m: vec![[0.0; 3], [0.0, 0.0, -0.5 * f32::from(*nth) * size_m]],
                    colors: vec![color],
                    radius: -6.0,
                    labels: vec![String::new(), format!("{} {}", finding.rule, finding.name)],
                }),
            );
        }
        page.push_str(&text);
    }
    let more = run.verdict.findings.len().saturating_sub(MAX_FINDINGS);
    if more > 0 {
        let _ = writeln!(page, "\n... and {more} more findings");
    }
    scene.always(&top.then("page"), Content::Page(page));
    worst
}

/// What was checked: no findings mean little without it.
fn summary(run: &Run) -> String {
    let count = |outcome: Outcome| run.verdict.count(outcome);
    format!(
        "Findings: {}. Checks passed: {}. Checks not evaluated: {}.\n\n",
        run.verdict.findings.len(),
        count(Outcome::Pass),
        count(Outcome::NotEvaluated)
    )
}

/// A finding as a line: the rule, the message and what was measured.
fn line(finding: &Finding) -> String {
    let measured: Vec<String> = finding.measured.iter().map(number_of).collect();
    let measured = if measured.is_empty() {
        String::new()
    } else {
        format!(" [{}]", measured.join("; "))
    };
    format!("{} {}: {}{measured}", finding.rule, finding.name, finding.message)
}

/// What was measured, with its limit.
fn number_of(measured: &Measured) -> String {
    let four = |value: f64| format!("{:.4}", rounded(value, 4));
    let unit = if measured.unit == "1" {
        ""
    } else {
        measured.unit.as_str()
    };
    let limit = measured
        .limit
        .map_or_else(String::new, |limit| format!(", limit {}", four(limit)));
    format!("{} {} {unit}", measured.what, four(measured.value))
        .trim_end()
        .to_owned()
        + &limit
}

/// A finding as a part of a page.
fn finding_text(number: usize, finding: &Finding) -> String {
    let mut page = String::new();
    let _ = writeln!(page, "### {}. {} {}\n", number + 1, finding.rule, finding.name);
    let _ = writeln!(
        page,
        "**{}**, {}: {}\n",
        finding.severity.word(),
        finding.confidence.word(),
        finding.text().replace('\n', "\n\n")
    );
    for measured in &finding.measured {
        let _ = writeln!(page, "- {}", number_of(measured));
    }
    if !finding.help.is_empty() {
        let _ = writeln!(page, "\n*What to do*: {}", finding.help);
    }
    if let Some(waived) = &finding.waived {
        let _ = writeln!(page, "\n*Waived*: {}", waived.words());
    }
    page.push('\n');
    page
}

fn loudness(finding: &Finding) -> (Level, Color) {
    match finding.loudness() {
        _ if finding.waived.is_some() => (Level::Info, [150, 150, 150]),
        Severity::Note => (Level::Info, [110, 160, 250]),
        Severity::Warning => (Level::Warning, [250, 190, 60]),
        Severity::Error => (Level::Error, [250, 70, 70]),
    }
}

/// The frame of a finding: the one that a rule corrects, else the last one named between backticks that is in a tree, else that of the
/// messages that it points at.
fn frame_of(finding: &Finding, run: &Run, placed: &[FrameEntities]) -> Option<Path> {
    let path = |frame: FrameId| placed.iter().find_map(|placed| placed.path(&frame));
    let moved = finding.prefers.iter().map(|prefers| prefers.source.clone());
    let is_topic = |word: &String| {
        let mut bags = placed.iter().flat_map(|placed| &placed.world().bags);
        bags.any(|bag| bag.topics.contains_key(word))
    };
    let named = |text: &str| {
        let words: Vec<String> = text.split('`').skip(1).step_by(2).map(str::to_owned).collect();
        words.into_iter().rev().filter(|word| !is_topic(word))
    };
    let words = moved.chain(named(&finding.subject)).chain(named(&finding.message));
    let mut paths = words.filter_map(|word| path(FrameId::new(&word)));
    paths
        .next()
        .or_else(|| frame_of_messages(finding, run, placed))
        .cloned()
}

fn frame_of_messages<'p>(finding: &Finding, run: &Run, placed: &'p [FrameEntities]) -> Option<&'p Path> {
    finding.places.iter().find_map(|label| {
        let SourcePart::Message(message) = &label.place.at else {
            return None;
        };
        let path = run.sources.get(label.place.source.0 as usize)?.path.as_str();
        placed.iter().find_map(|placed| {
            let is_it = |bag: &&BagEvidence| {
                placed
                    .world()
                    .source(bag.source)
                    .is_some_and(|source| source.path == path)
            };
            let bag = placed.world().bags.iter().find(is_it)?;
            let frame = bag.topics.get(&message.topic)?.header_frames.keys().next()?;
            placed.path(frame)
        })
    })
}
