//! TIME01: stamps run off the log clock by an offset that has a name.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::rules::{Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated, Severity};
use crate::world::{BagEvidence, World};

use super::known_offsets::{Explanation, Named, Specific};
use super::naming::Naming;
use super::streams::{Stream, declared_streams};
use super::together::tell_once;
use super::units::unit_error;

/// TIME01.
pub struct EpochOffset;

/// Limits of TIME01.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    pub(super) quiet_s: f64,
    pub(super) min_messages: u64,
    pub(super) base_tolerance_s: f64,
    pub(super) max_tolerance_s: f64,
    pub(super) fine_tolerance_s: f64,
    pub(super) spread_factor: f64,
    pub(super) slow_s: f64,
}

impl Rule for EpochOffset {
    const PAGE: &'static str = include_str!("../../../rules/time/epoch-offset.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            judge_bag(world, bag, limits, out);
        }
    }
}

fn judge_bag(world: &World, bag: &BagEvidence, limits: &Limits, out: &mut Judge) {
    let streams = declared_streams(world, bag);
    let naming = Naming::new(bag, &streams, limits);
    // One wrong clock stamps many streams: by the name of its offset.
    let mut by_name: BTreeMap<String, Vec<Finding>> = BTreeMap::new();
    for stream in &streams {
        if let Some((name, finding)) = judge_stream(stream, &naming, limits, out) {
            by_name.entry(name).or_default().push(finding);
        }
    }
    for findings in by_name.into_values() {
        tell_once(findings, "run by the same offset", out);
    }
}

fn judge_stream(
    stream: &Stream<'_>,
    naming: &Naming<'_>,
    limits: &Limits,
    out: &mut Judge,
) -> Option<(String, Finding)> {
    let subject = stream.subject.clone();
    let n = stream.stamps.count;
    if n < limits.min_messages {
        let why = format!("{n} stamped messages, {} are needed", limits.min_messages);
        out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
        return None;
    }
    let not_applicable = |out: &mut Judge, why: &str| {
        out.not_evaluated(subject.clone(), NotEvaluated::NotApplicable, why);
        None
    };
    let Some((offset, spread)) = stream.offset_s() else {
        return not_applicable(out, "every stamp is zero; see TIME04");
    };
    let measured = Measured::new("stamp minus log time", offset, "s")
        .limit(limits.quiet_s)
        .spread(spread)
        .samples(n);
    // Of what is no fault here TIME02 shows the same.
    let plot = || stream.plot(&[("quiet up to here", limits.quiet_s.copysign(offset))]);
    if let Some((factor, words)) = unit_error(stream, naming.log_s) {
        out.plot(&subject, plot);
        return Some((
            words.to_owned(),
            wrong_unit(stream, factor, words, naming.log_s, measured),
        ));
    }
    if !naming.is_calendar(stream) {
        return not_applicable(out, "stamps or log time are no calendar time; see TIME04");
    }
    if offset.abs() <= limits.quiet_s {
        out.pass(subject, [measured]);
        return None;
    }
    match naming.explain(stream) {
        (Explanation::One(named), reference) => {
            let name = format!("{} {reference}", named.what);
            out.plot(&subject, plot);
            Some((name, stream.tell(finding(stream, &named, reference, measured))))
        }
        (Explanation::Several(names), reference) => {
            let names: Vec<&str> = names.iter().map(|named| named.what.as_str()).collect();
            let names = names.join("; ");
            let why =
                format!("stamps run {offset:.3} s off {reference}, which fits several names: {names}; see TIME02");
            not_applicable(out, &why)
        }
        (Explanation::Unknown, _) => {
            let why = format!(
                "stamps run {offset:.3} s off the log clock, and no known epoch or leap second is that far off; see \
                 TIME02"
            );
            not_applicable(out, &why)
        }
    }
}

fn wrong_unit(stream: &Stream<'_>, factor: f64, words: &str, log_s: f64, measured: Measured) -> Finding {
    let message = format!(
        "stamps on {} are {factor:e} times the log time: {words}",
        stream.subject
    );
    let ratio = stream.median_stamp_s().unwrap_or(0.0) / log_s;
    Finding::error(stream.subject.clone(), message, stream.place())
        .likely()
        .help("divide once, where the sensor's number is turned into the stamp")
        .measured(measured)
        .measured(Measured::new("stamp / log time", ratio, "1"))
}

fn finding(stream: &Stream<'_>, named: &Named, reference: &str, measured: Measured) -> Finding {
    let severity = match named.specific {
        Specific::Single => Severity::Error,
        Specific::Family => Severity::Warning,
    };
    let message = format!(
        "stamps on {} run {:+.2} s against {reference}: {}",
        stream.subject, measured.value, named.what,
    );
    Finding::new(severity, stream.subject.clone(), message, stream.place())
        .likely()
        .help(format!(
            "set the driver's time base to UTC; to repair the recording, add {:+.3} s to these stamps",
            -named.offset_s
        ))
        .measured(measured)
        .measured(Measured::new("offset of that name", named.offset_s, "s"))
}
