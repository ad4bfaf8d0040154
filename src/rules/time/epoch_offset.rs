//! TIME01: stamps differ from the recorder's clock by an offset with a known cause.

use std::collections::BTreeMap;

use crate::advice::together::report_once;
use crate::analysis::time::known_offsets::{Explanation, KnownOffset, Specificity};
use crate::analysis::time::naming::{Limits, Naming};
use crate::analysis::time::streams::{Stream, declared_streams};
use crate::analysis::{time::lateness, time::units::unit_error};
use crate::rules::prelude::*;
use crate::world::BagEvidence;

pub(crate) struct EpochOffset;

impl Rule for EpochOffset {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            judge_bag(world, bag, limits, out);
        }
    }
}

fn judge_bag(world: &Estimates, bag: &BagEvidence, limits: &Limits, out: &mut Judge) {
    let streams = declared_streams(world, bag);
    let naming = Naming::new(bag, &streams, limits);
    let far_s = world.limits::<lateness::Limits>().far_s;
    // One wrong clock stamps many streams: grouped by the cause of the offset.
    let mut by_name: BTreeMap<String, Vec<Finding>> = BTreeMap::new();
    for stream in &streams {
        if let Some((name, finding)) = judge_stream(stream, &naming, (limits, far_s), out) {
            by_name.entry(name).or_default().push(finding);
        }
    }
    for findings in by_name.into_values() {
        report_once(findings, "have the same offset", out);
    }
}

fn judge_stream(
    stream: &Stream<'_>,
    naming: &Naming<'_>,
    (limits, far_s): (&Limits, f64),
    out: &mut Judge,
) -> Option<(String, Finding)> {
    let subject = stream.subject.clone();
    let n = stream.stamps.count;
    if n < limits.min_messages {
        out.too_little(
            subject,
            format!("{n} stamped messages, {} are needed", limits.min_messages),
        );
        return None;
    }
    let not_applicable = |out: &mut Judge, why: &str| {
        out.not_applicable(subject.clone(), why);
        None
    };
    let Some((offset, spread)) = stream.offset_s() else {
        return not_applicable(out, "every stamp is zero");
    };
    let measured = Measured::new("stamp minus log time", offset, "s")
        .limit(limits.quiet_s)
        .spread(spread)
        .samples(n);
    let plot = || stream.plot(&[("accepted up to here", limits.quiet_s.copysign(offset))]);
    if let Some((factor, words)) = unit_error(stream, naming.log_s) {
        out.plot(&subject, plot);
        return Some((
            words.to_owned(),
            wrong_unit(stream, factor, words, naming.log_s, measured),
        ));
    }
    if !naming.is_calendar(stream) {
        return not_applicable(out, "the stamps or the log time are not calendar time");
    }
    if offset.abs() <= limits.quiet_s {
        out.pass(subject, [measured]);
        return None;
    }
    match naming.explain(stream) {
        (Explanation::One(named), reference) => {
            let name = format!("{} {reference}", named.what);
            out.plot(&subject, plot);
            Some((
                name,
                stream.annotate(finding(stream, &named, (reference, far_s), measured)),
            ))
        }
        (Explanation::Several(names), reference) => {
            let names: Vec<&str> = names.iter().map(|named| named.what.as_str()).collect();
            let names = names.join("; ");
            let why = format!("stamps are {offset:.3} s from {reference}, which matches several known causes: {names}");
            not_applicable(out, &why)
        }
        (Explanation::Unknown, _) => {
            let why = format!(
                "stamps are {offset:.3} s from the recorder's clock, and no known epoch or leap second has that offset"
            );
            not_applicable(out, &why)
        }
    }
}

fn wrong_unit(stream: &Stream<'_>, factor: f64, words: &str, log_s: f64, measured: Measured) -> Finding {
    let message = format!(
        "{}: stamps are {factor:e} times the log time: wrong unit",
        stream.subject
    );
    let ratio = stream.median_stamp_s().unwrap_or(0.0) / log_s;
    Finding::error(stream.subject.clone(), message, stream.place())
        .likely()
        .detail(format!("Probably {words}."))
        .help("fix the conversion of the sensor's time to `header.stamp` in the driver: convert the unit exactly once")
        .measured(measured)
        .measured(Measured::new("stamp / log time", ratio, "1"))
}

/// A cause without its alternative and without its number, which stand in the detail.
fn brief(cause: &str) -> &str {
    let first = cause.split(", or ").next().unwrap_or(cause);
    match first.rsplit_once(" (") {
        Some((words, number)) if number.ends_with(')') => words,
        _ => first,
    }
}

fn finding(stream: &Stream<'_>, named: &KnownOffset, (reference, far_s): (&str, f64), measured: Measured) -> Finding {
    let severity = match named.specific {
        Specificity::Single => Severity::Error,
        // Beyond this limit it is an error with or without a known cause.
        Specificity::Family if measured.value.abs() > far_s => Severity::Error,
        Specificity::Family => Severity::Warning,
    };
    let way = if measured.value > 0.0 { "ahead of" } else { "behind" };
    let cause = brief(&named.what);
    let message = format!(
        "{}: stamps {:.2} s {way} {reference}: {cause}",
        stream.subject,
        measured.value.abs()
    );
    let in_full = if cause == named.what {
        String::new()
    } else {
        format!("Cause: {}.", named.what)
    };
    Finding::new(severity, stream.subject.clone(), message, stream.place())
        .likely()
        .detail(in_full)
        .help(format!(
            "set the driver's time base to UTC; to repair the recording, {} {:.3} s {} these stamps",
            if named.offset_s > 0.0 { "subtract" } else { "add" },
            named.offset_s.abs(),
            if named.offset_s > 0.0 { "from" } else { "to" },
        ))
        .measured(measured)
        .measured(Measured::new("offset that this cause makes", named.offset_s, "s"))
}
