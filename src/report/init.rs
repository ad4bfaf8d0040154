//! An initial configuration from the inputs, with comments and the table of sources of each transform.
//!
//! Checks that could be evaluated now are required from now on: a topic that is no longer recorded then makes the run incomplete
//! instead of being overlooked.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::page::Page;
use crate::run::Run;
use crate::verdict::Severity;
use crate::verdict::waiver::FAMILY;
use crate::world::contract::Contract;
use crate::world::{ClaimKind, FrameId, World};

use super::contract;
use super::place::Locator;
use super::text::{one_line, plural};

/// Maximum number of listed pairs of frames, and of topics.
const MAX_ROWS: usize = 200;

/// The text of a `frames-lint.yaml`; with a contract, if a good recording gave one.
pub fn configuration(run: &Run, contract: Option<&Contract>) -> String {
    let locator = Locator::inside(&run.sources);
    let mut out = String::from(
        "# frames-lint.yaml: configuration for the files in this folder and below. `frames-lint explain RULE` shows what a rule checks;\n\
         # schema/frames-lint-config-1.json of frames-lint describes every key.\n\n\
         # The base of this configuration: ci, pre-survey, dataset-acceptance, or a file.\n\
         extends: ci\n",
    );
    authorities(run, &locator, &mut out);
    conventions(run, &mut out);
    if let Some(contract) = contract {
        contract::terms(contract, run, &mut out);
    }
    required(run, contract, &mut out);
    today(run, &mut out);
    out
}

/// The sources of each transform.
fn authorities(run: &Run, locator: &Locator, out: &mut String) {
    let mut pairs: BTreeMap<(FrameId, FrameId), Vec<String>> = BTreeMap::new();
    for world in &run.worlds {
        for (pair, who) in statements(world, locator) {
            let turned = (pair.1.clone(), pair.0.clone());
            let pair = if pairs.contains_key(&turned) { turned } else { pair };
            let known = pairs.entry(pair).or_default();
            if !known.contains(&who) {
                known.push(who);
            }
        }
    }
    if pairs.is_empty() {
        return;
    }
    out.push_str(
        "\n# Sources of each transform (parent <- child). If there are several, choose one and generate the others from it: frames-lint\n\
         # compares all of them with each other (CROSS01, CROSS02, AUTH01).\n#\n",
    );
    let shown = |(target, source): &(FrameId, FrameId)| one_line(&format!("{target} <- {source}"));
    let width = pairs
        .keys()
        .take(MAX_ROWS)
        .map(|pair| shown(pair).chars().count())
        .max()
        .unwrap_or(0);
    for (pair, who) in pairs.iter().take(MAX_ROWS) {
        for (index, who) in who.iter().enumerate() {
            let pair = if index == 0 { shown(pair) } else { String::new() };
            let _ = writeln!(out, "#   {pair:width$}  {}", one_line(who));
        }
    }
    if pairs.len() > MAX_ROWS {
        let _ = writeln!(out, "#   ... and {}", plural(pairs.len() - MAX_ROWS, "more pair"));
    }
}

/// Every statement of a transform, with its source.
fn statements(world: &World, locator: &Locator) -> Vec<((FrameId, FrameId), String)> {
    let mut found = Vec::new();
    for claim in &world.claims {
        let Some((target, source)) = &claim.frames else {
            continue;
        };
        let place = locator.short(&claim.place);
        let who = match &claim.kind {
            ClaimKind::Joint { joint, fixed: true, .. } => format!("joint {joint}, {place}"),
            ClaimKind::Joint { joint, .. } => format!("moving joint {joint}, {place}"),
            ClaimKind::File { dialect, .. } => format!("`{}` ({dialect}), {place}", claim.label),
        };
        found.push(((target.canonical(), source.canonical()), who));
    }
    for bag in &world.bags {
        for edge in &bag.tf {
            let kind = if edge.is_static { "static" } else { "moving" };
            let who = format!("{kind} on {}, {}", edge.topic, locator.name(bag.source));
            found.push(((edge.parent.canonical(), edge.child.canonical()), who));
        }
    }
    found
}

/// Topics whose conventions should be declared.
fn conventions(run: &Run, out: &mut String) {
    let mut topics: BTreeMap<&str, &str> = BTreeMap::new();
    for bag in run.worlds.iter().flat_map(|world| &world.bags) {
        for (name, topic) in &bag.topics {
            let content = &topic.content;
            if content.imu.is_some() || content.odometry.is_some() || content.fixes.is_some() {
                topics.insert(name, &topic.message_type);
            }
        }
    }
    if topics.is_empty() {
        return;
    }
    out.push_str(
        "\n# Conventions of these topics. The default is that of ROS (REP-103): east, north, up for the world (ENU), forward, left, up for the\n\
         # body (FLU), quaternions as x y z w, UTC. Declare what differs; the data are compared with it.\n# conventions:\n",
    );
    for (topic, type_name) in topics.iter().take(MAX_ROWS) {
        let _ = writeln!(
            out,
            "#   - {{topic: {}, world: ENU, body: FLU}}   # {}",
            one_line(topic),
            one_line(type_name)
        );
    }
}

/// Rules that were evaluated on recordings or several files.
fn required(run: &Run, contract: Option<&Contract>, out: &mut String) {
    let judged = |code: &str| {
        run.verdict
            .rows
            .iter()
            .any(|row| row.rule == code && row.outcome.is_judged())
    };
    let asks_for_more = |page: &Page| page.evidence.iter().any(|kind| *kind != "urdf" && *kind != "names");
    // What is judged here by a hair may not be on the next drive.
    let is_steady = |page: &Page| {
        let assurance = run.assurance.as_ref();
        assurance.is_none_or(|assurance| !assurance.unsteady.contains(page.code))
    };
    let rules: Vec<_> = run
        .rules
        .iter()
        .filter(|rule| rule.family() != FAMILY && judged(rule.code) && asks_for_more(rule) && is_steady(rule))
        .collect();
    let mut shown = String::new();
    if let Some(assurance) = &run.assurance {
        contract::detections(assurance, contract, run, &mut shown);
    }
    if rules.is_empty() && shown.is_empty() {
        return;
    }
    out.push_str(
        "\n# Evaluated when this was written, and required from now on: if one of them can no longer be evaluated, because a topic or a file is\n\
         # missing, the run is incomplete (exit code 3) and the report says what to record.\nrequire:\n",
    );
    for rule in rules {
        let _ = writeln!(out, "  - {:<9} # {}", rule.code, rule.name);
    }
    if !shown.is_empty() {
        let words = "  # Known mistakes that the good recording would have shown; `frames-lint assure --list` says what they are. A recording that is too short\n  \
                     # or too calm to show them is incomplete.\n";
        out.push_str(words);
        out.push_str(&shown);
    }
}

/// The current findings, and how to accept them.
fn today(run: &Run, out: &mut String) {
    let count = |severity| run.verdict.count_findings(severity);
    let found = [
        plural(count(Severity::Error), "error"),
        plural(count(Severity::Warning), "warning"),
        plural(count(Severity::Note), "note"),
    ];
    let _ = write!(
        out,
        "\n# Found when this was written: {}. To accept one for now, add a waiver with a reason and a last day; to accept\n\
         # all of them, write a baseline (`frames-lint check --write-baseline frames-baseline.json`).\n# waivers:\n",
        found.join(", ")
    );
    for finding in run.verdict.open().take(5) {
        let subject = one_line(&finding.subject).replace('\'', "''");
        let _ = writeln!(
            out,
            "#   - {{rule: {}, subject: '{subject}', reason: ..., until: ..., by: ...}}",
            finding.rule
        );
    }
    if run.verdict.open().next().is_none() {
        out.push_str("#   - {rule: CROSS01, subject: '*lidar*', reason: ..., until: ..., by: ...}\n");
    }
    for finding in run
        .verdict
        .open()
        .filter(|finding| finding.rule == "CROSS07")
        .take(MAX_ROWS)
    {
        let _ = writeln!(out, "\n# {}", one_line(&finding.message));
        let _ = writeln!(out, "# {}", one_line(&finding.help));
    }
}
