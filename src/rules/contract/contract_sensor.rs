//! CONTRACT05: sensors that give something else than by the contract: another size of images, other rings, rays or fields.

use crate::advice::contract::{MEANT, Term, terms};
use crate::analysis::contract::Recorded;
use crate::analysis::contract::sensor::SensorSeen;
use crate::rules::prelude::*;
use crate::source::{MessageRef, SourceId};

pub(crate) struct ContractSensor;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_ratio: f64,
    min_share: f64,
}

impl Rule for ContractSensor {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for term in terms(world, "sensor of ", |terms| !terms.sensor.is_empty(), out) {
            if !term.is_absent(out) {
                for recorded in &term.seen {
                    judge_one(&term, recorded, limits, out);
                }
            }
        }
    }
}

/// What is compared of one sensor.
#[derive(Default)]
struct Compared<'w> {
    measured: Vec<Measured>,
    /// Differences in words, each with what to do, and a message that has it.
    other: Vec<(String, String, &'w MessageRef)>,
    /// Keys of the contract that are not decided, and why, as clauses.
    unknown: Vec<String>,
}

fn judge_one(term: &Term, (bag, topic): &Recorded, limits: &Limits, out: &mut Judge) {
    let (seen, wanted) = (SensorSeen::of(topic), &term.terms.sensor);
    let mut found = Compared::default();
    if let Some([width, height]) = wanted.image {
        let others = seen.images.iter().filter(|(size, _)| *size != [width, height]);
        for ([other_width, other_height], at) in others.clone().take(1) {
            let words = format!("images of {other_width} x {other_height} instead of {width} x {height}");
            found
                .other
                .push((words, format!("publish images of {width} x {height}"), at));
        }
        found.counted(
            "image",
            "sizes of images that are not in the contract",
            (&seen.images, others.count()),
        );
    }
    let counts = [("rings", wanted.rings, seen.rings), ("rays", wanted.rays, seen.rays)];
    for (key, wanted, seen) in counts {
        let Some(wanted) = wanted else { continue };
        let Some((count, at)) = seen else {
            found.unread(key);
            continue;
        };
        let share = f64::from(count) / f64::from(wanted.max(1));
        // Rings whose rays all miss leave nothing in a cloud; rays of a scan do not.
        let least = if key == "rings" {
            limits.min_share
        } else {
            1.0 / limits.max_ratio
        };
        if share > limits.max_ratio || share <= least {
            let words = format!("{count} {key} instead of {wanted}");
            found
                .other
                .push((words, format!("use the model or the mode with {wanted} {key}"), at));
        } else if key == "rings" && (share < 1.0 / limits.max_ratio || count > wanted) {
            let why = "a ring whose rays all miss has no points";
            found
                .unknown
                .push(format!("rings: {count} have points, {wanted} by the contract; {why}"));
        }
        found
            .measured
            .push(Measured::count(key, count as usize).expected(f64::from(wanted)));
    }
    if !wanted.fields.is_empty() {
        let lacks = |names: &[&str]| {
            let lacks = wanted.fields.iter().filter(|name| !names.contains(&name.as_str()));
            lacks.map(|name| format!("`{name}`")).collect::<Vec<_>>()
        };
        let mut lacking = seen.fields.iter().map(|(names, at)| (lacks(names), at));
        let (lacks, at) = lacking.find(|(lacks, _)| !lacks.is_empty()).unzip();
        let lacks = lacks.unwrap_or_default();
        if let Some(at) = at {
            let lacks = lacks.join(", ");
            let words = format!("no field {lacks} in its points");
            found
                .other
                .push((words, format!("set the driver to publish the field {lacks}"), at));
        }
        found.counted(
            "fields",
            "fields of the contract that the points lack",
            (&seen.fields, lacks.len()),
        );
    }
    report(term, (bag.source, topic.unread.as_deref()), found, out);
}

impl Compared<'_> {
    fn unread(&mut self, key: &str) {
        self.unknown.push(format!("{key}: no message has one"));
    }

    fn counted<T>(&mut self, key: &'static str, what: &str, (seen, count): (&[T], usize)) {
        if seen.is_empty() {
            self.unread(key);
        } else {
            self.measured.push(Measured::count(what, count).limit(0.0));
        }
    }
}

fn report(term: &Term, (source, unread): (SourceId, Option<&str>), found: Compared, out: &mut Judge) {
    let subject = term.subject.as_str();
    let Some((first, _, at)) = found.other.first() else {
        if found.unknown.is_empty() {
            return out.pass(subject, found.measured);
        }
        let why = unread.map_or_else(|| found.unknown.join("; "), str::to_owned);
        return out.too_little(subject, why);
    };
    let words: Vec<&str> = found.other.iter().map(|(words, ..)| words.as_str()).collect();
    let help: Vec<&str> = found.other.iter().map(|(_, help, _)| help.as_str()).collect();
    let message = format!("`{}` has {}", term.name, words.join(", "));
    let finding = Finding::error(subject, message, term.terms.place.clone())
        .label("sensor in the contract")
        .help(format!("{}; {MEANT}", help.join(", and ")))
        .related(Place::message(source, (*at).clone()), format!("message with {first}"))
        .measured(found.measured);
    out.fail(finding);
}
