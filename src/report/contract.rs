//! The part of an initial configuration that holds the next recordings to a good one: topics, latched transforms, and the known mistakes
//! that it shows.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::assure::{Assurance, Trial, TrialOutcome};
use crate::faults::{Family, catalogue};
use crate::page::Page;
use crate::run::Run;
use crate::visible::{clean, json_line};
use crate::world::FrameId;
use crate::world::bag::is_static_topic;
use crate::world::contract::{Contract, TopicTerms, TransformTerms};

use super::text::{number, trimmed, wrap};

/// Columns of a line.
const WIDTH: usize = 140;

/// The key `contract`.
pub(super) fn terms(contract: &Contract, run: &Run, out: &mut String) {
    out.push_str(
        "\n# What the good recording holds. `check` compares recordings with it: review it, and correct what may differ. A topic with\n\
         # `optional: true` may be missing; a key that is left out is not compared.\ncontract:\n",
    );
    if !contract.topics.is_empty() {
        out.push_str("  topics:\n");
    }
    let percent = limit(run, "contract-rate", "tolerance_percent");
    for (name, terms) in &contract.topics {
        let _ = writeln!(out, "    - {{{}}}", topic(name, terms, percent).join(", "));
    }
    if !contract.transforms.is_empty() {
        out.push_str("  transforms:\n");
    }
    let tolerance = ["tolerance_mm", "tolerance_deg"].map(|name| (name, limit(run, "contract-transform", name)));
    for (frames, terms) in &contract.transforms {
        let is_latched = terms.place.topic().is_none_or(is_static_topic);
        let mark = if is_latched {
            ""
        } else {
            "  # on /tf, with one value in this recording: remove it if it can move"
        };
        let _ = writeln!(
            out,
            "    - {{{}}}{mark}",
            transform(frames, terms, tolerance).join(", ")
        );
    }
}

/// A limit of the rule with this name.
fn limit(run: &Run, rule: &str, name: &str) -> Option<f64> {
    let page: &Page = run.rules.iter().find(|page| page.name == rule)?;
    let limit = page.limits.iter().find(|limit| limit.name == name)?;
    Some(limit.value.as_f64())
}

fn topic(name: &str, terms: &TopicTerms, percent: Option<f64>) -> Vec<String> {
    let mut parts = vec![format!("topic: {}", scalar(name))];
    parts.extend(terms.message_type.iter().map(|name| format!("type: {}", scalar(name))));
    if let Some(rate_hz) = terms.rate_hz {
        parts.push(format!("rate_hz: {}", number(rate_hz, 4)));
        parts.extend(
            terms
                .tolerance_percent
                .or(percent)
                .map(|percent| format!("tolerance_percent: {percent}")),
        );
    }
    let frames = [("frame", &terms.frames), ("child_frame", &terms.child_frames)];
    for (key, frames) in frames {
        let names: Vec<String> = frames.iter().map(|frame| scalar(frame.as_str())).collect();
        match names.as_slice() {
            [] => {}
            [only] => parts.push(format!("{key}: {only}")),
            names => parts.push(format!("{key}: [{}]", names.join(", "))),
        }
    }
    let sensor = &terms.sensor;
    let image = sensor
        .image
        .map(|[width, height]| format!("image: [{width}, {height}]"));
    let counts = [("rings", sensor.rings), ("rays", sensor.rays)];
    let counts = counts
        .iter()
        .filter_map(|(key, count)| Some(format!("{key}: {}", (*count)?)));
    parts.extend(image.into_iter().chain(counts));
    if !sensor.fields.is_empty() {
        let names: Vec<String> = sensor.fields.iter().map(|name| scalar(name)).collect();
        parts.push(format!("fields: [{}]", names.join(", ")));
    }
    parts.extend(terms.is_optional.then(|| "optional: true".to_owned()));
    parts
}

fn transform(
    (parent, child): &(FrameId, FrameId),
    terms: &TransformTerms,
    tolerance: [(&str, Option<f64>); 2],
) -> Vec<String> {
    let (roll, pitch, yaw) = terms.pose.rotation.euler_angles();
    let three = |numbers: [f64; 3]| numbers.map(|number| trimmed(&format!("{number:.6}"))).join(", ");
    let mut parts = vec![
        format!("parent: {}", scalar(parent.as_str())),
        format!("child: {}", scalar(child.as_str())),
        format!("xyz_m: [{}]", three(terms.pose.translation.vector.into())),
        format!("rpy_deg: [{}]", three([roll, pitch, yaw].map(f64::to_degrees))),
    ];
    parts.extend(
        tolerance
            .iter()
            .filter_map(|(name, value)| Some(format!("{name}: {}", (*value)?))),
    );
    parts
}

/// A text as a scalar in a flow of YAML: plain where it cannot be read as something else.
fn scalar(text: &str) -> String {
    let is_word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '/' | '-' | '.');
    let is_plain = text.starts_with(|c: char| c == '/' || c.is_ascii_alphabetic()) && text.chars().all(is_word);
    let means_more = ["true", "false", "null", "yes", "no", "on", "off", "y", "n"];
    if is_plain && !means_more.contains(&text.to_ascii_lowercase().as_str()) {
        text.to_owned()
    } else if clean(text) == text && !text.contains(['\n', '\t']) {
        format!("'{}'", text.replace('\'', "''"))
    } else {
        json_line(&text).unwrap_or_default().trim_end().to_owned()
    }
}

/// Entries of `require`: the known mistakes that the recording shows in everything that can have them, a line for each family, then those
/// that it shows in some subjects only. A whole family has one word.
pub(super) fn detections(assurance: &Assurance, contract: Option<&Contract>, run: &Run, out: &mut String) {
    // The next recording need not have what is optional.
    let is_optional = |trial: &Trial| {
        let topics = contract.iter().flat_map(|contract| &contract.topics);
        let mut optional = topics.filter(|(_, terms)| terms.is_optional);
        optional.any(|(name, _)| trial.subject.contains(&format!("`{name}`")))
    };
    let is_counted = |trial: &&Trial| {
        !assurance.omitted.contains_key(trial.fault.name) && !is_in_contract(trial) && !is_optional(trial)
    };
    let tried: Vec<&Trial> = assurance.trials.iter().filter(is_counted).collect();
    let everywhere = shown(&tried);
    for words in families(&everywhere) {
        entry("", &words, out);
    }
    let mut subjects: BTreeMap<String, Vec<&Trial>> = BTreeMap::new();
    for trial in tried.iter().filter(|trial| !everywhere.contains(trial.fault.name)) {
        subjects.entry(glob(&trial.subject, run)).or_default().push(trial);
    }
    for (subject, trials) in &subjects {
        let subject = format!("subject: {}, ", scalar(subject));
        entry(&subject, &families(&shown(trials)).concat(), out);
    }
}

fn entry(subject: &str, words: &[&str], out: &mut String) {
    if !words.is_empty() {
        let entry = format!("{{{subject}detects: [{}]}}", words.join(", "));
        let _ = writeln!(out, "{}", wrap(&entry, Some(WIDTH), "  - ", "    "));
    }
}

/// The contract has the values of latched transforms: whatever changes them is found without a requirement.
fn is_in_contract(trial: &Trial) -> bool {
    trial.fault.family == Family::Statement && trial.subject.contains("_static`: `")
}

/// The names of mistakes that were found, and nowhere missed.
fn shown(trials: &[&Trial]) -> BTreeSet<&'static str> {
    let names = |is_it: fn(TrialOutcome) -> bool| -> BTreeSet<&'static str> {
        let those = trials.iter().filter(|trial| is_it(trial.outcome));
        those.map(|trial| trial.fault.name).collect()
    };
    let found = names(|outcome| matches!(outcome, TrialOutcome::Named | TrialOutcome::Noticed));
    &found - &names(|outcome| outcome == TrialOutcome::Missed)
}

/// Mistakes by family, in the order of the catalogue: the family's word where all of it is there.
fn families(names: &BTreeSet<&str>) -> Vec<Vec<&'static str>> {
    let mut families: BTreeMap<Family, Vec<&'static str>> = BTreeMap::new();
    let mut partial: BTreeSet<Family> = BTreeSet::new();
    for fault in catalogue() {
        if names.contains(fault.name) {
            families.entry(fault.family).or_default().push(fault.name);
        } else {
            partial.insert(fault.family);
        }
    }
    let words = |(family, names): (Family, Vec<&'static str>)| {
        if partial.contains(&family) {
            names
        } else {
            vec![family.word()]
        }
    };
    families.into_iter().map(words).collect()
}

/// A glob for a subject, in recordings of any name.
fn glob(subject: &str, run: &Run) -> String {
    let glob = globset::escape(subject);
    run.sources.iter().fold(glob, |glob, source| {
        glob.replace(&format!("`{}`", globset::escape(&source.path)), "*")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_as_it_was() {
        for name in [
            "/imu/data",
            "imu_link",
            "no",
            "Null",
            "1",
            "a b",
            "it's",
            "",
            "{a}",
            "- a",
            "a: b",
            "#a",
            "a\tb",
            "a\nb",
            "\u{1b}[2J",
            "\u{202e}a",
            "\u{e9}",
        ] {
            let flow = format!("[{}, b]", scalar(name));
            assert_eq!(
                serde_yaml::from_str::<Vec<String>>(&flow).unwrap_or_default(),
                [name, "b"],
                "{flow}"
            );
        }
    }
}
