//! TIME01: stamps run off the log clock by an offset that has a name.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::math::stats::median;
use crate::rules::{Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated, Severity};
use crate::world::{BagEvidence, World};

use super::known_offsets::{Named, Specific, explain, unit_error};
use super::streams::{Stream, UPTIME_BELOW_S, streams};
use super::together::tell_once;

/// TIME01.
pub struct EpochOffset;

/// Limits of TIME01.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    quiet_s: f64,
    min_messages: u64,
    base_tolerance_s: f64,
    max_tolerance_s: f64,
    spread_factor: f64,
}

impl Rule for EpochOffset {
    const PAGE: &'static str = include_str!("../../../rules/time/epoch-offset.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            judge_bag(bag, limits, out);
        }
    }
}

fn judge_bag(bag: &BagEvidence, limits: &Limits, out: &mut Judge) {
    let streams = streams(bag);
    let offsets: Vec<f64> = streams
        .iter()
        .filter(|stream| stream.stamps.count >= limits.min_messages)
        .filter_map(|stream| stream.offset_s().map(|(offset, _)| offset))
        .collect();
    let log_s = bag.start_ns.unwrap_or(0) as f64 / 1e9;
    // Some stream that agrees with the log clock shows that the log clock is the sensors' own.
    let trusted = offsets.iter().any(|offset| offset.abs() <= limits.quiet_s);
    let common = if trusted { 0.0 } else { median(&offsets).unwrap_or(0.0) };
    // One wrong clock stamps many streams: by the name of its offset.
    let mut by_name: BTreeMap<String, Vec<Finding>> = BTreeMap::new();
    for stream in &streams {
        if let Some((name, finding)) = judge_stream(stream, (log_s, common, offsets.len()), limits, out) {
            by_name.entry(name).or_default().push(finding);
        }
    }
    for findings in by_name.into_values() {
        tell_once(findings, "run by the same offset", out);
    }
}

fn judge_stream(
    stream: &Stream<'_>,
    (log_s, common, streams): (f64, f64, usize),
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
    let Some((offset, spread)) = stream.offset_s() else {
        out.not_evaluated(subject, NotEvaluated::NotApplicable, "every stamp is zero; see TIME04");
        return None;
    };
    let stamp_s = stream.median_stamp_s().unwrap_or(0.0);
    let measured = Measured::new("stamp minus log time", offset, "s")
        .limit(limits.quiet_s)
        .spread(spread)
        .samples(n);
    if let Some((factor, words)) = unit_error(stamp_s, log_s) {
        let message = format!("stamps on {subject} are {factor:e} times the log time: {words}");
        let finding = Finding::error(subject, message, stream.place())
            .likely()
            .help("divide once, where the sensor's number is turned into the stamp")
            .measured(measured)
            .measured(Measured::new("stamp / log time", stamp_s / log_s, "1"));
        return Some((words.to_owned(), finding));
    }
    if stamp_s < UPTIME_BELOW_S || log_s < UPTIME_BELOW_S {
        out.not_evaluated(
            subject,
            NotEvaluated::NotApplicable,
            "stamps or log time are no calendar time; see TIME04",
        );
        return None;
    }
    let tolerance = (limits.base_tolerance_s + limits.spread_factor * spread).min(limits.max_tolerance_s);
    let relative = offset - common;
    let against_log = explain(offset, tolerance, log_s);
    let against_others = explain(relative, tolerance, log_s);
    let (hits, reference) = if !against_log.is_empty() {
        (against_log, "the log clock")
    } else if streams >= 2 {
        (against_others, "the other topics")
    } else {
        (Vec::new(), "")
    };
    match hits.first() {
        _ if offset.abs() <= limits.quiet_s => out.pass(subject, [measured]),
        Some(named) => {
            let name = format!("{} {reference}", named.what);
            return Some((name, finding(stream, named, &hits, reference, measured)));
        }
        None => {
            let why = format!(
                "stamps run {offset:.3} s off the log clock, and no known epoch or leap second is that far off"
            );
            out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
        }
    }
    None
}

fn finding(stream: &Stream<'_>, named: &Named, hits: &[Named], reference: &str, measured: Measured) -> Finding {
    let severity = match named.specific {
        Specific::Single => Severity::Error,
        Specific::Family => Severity::Warning,
    };
    let offset = measured.value;
    let also: Vec<&str> = hits.iter().skip(1).map(|other| other.what.as_str()).collect();
    let message = format!(
        "stamps on {} run {offset:+.2} s against {reference}: {}{}",
        stream.subject,
        named.what,
        if also.is_empty() {
            String::new()
        } else {
            format!(" (or: {})", also.join("; "))
        },
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
