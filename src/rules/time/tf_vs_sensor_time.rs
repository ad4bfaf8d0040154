//! TIME10: transforms are stamped in the future or far behind the sensors, or many messages share one stamp.

use crate::advice::together::report_once;
use crate::analysis::time::naming::Naming;
use crate::analysis::time::streams::{Limits, Stream, StreamSource, streams};
use crate::math::stats::median;
use crate::rules::prelude::*;

pub(crate) struct TfVsSensorTime;

impl Rule for TfVsSensorTime {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let names = world.limits::<crate::analysis::time::naming::Limits>();
        for bag in &world.bags {
            let streams = streams(bag);
            let naming = Naming::new(bag, &streams, &names);
            judge_bag(&streams, &naming, limits, out);
        }
    }
}

fn judge_bag(streams: &[Stream<'_>], naming: &Naming<'_>, limits: &Limits, out: &mut Judge) {
    let sensors: Vec<&Stream<'_>> = streams
        .iter()
        .filter(|stream| matches!(stream.of, StreamSource::Topic(_)) && stream.is_live() && !stream.is_gnss())
        .collect();
    let (mut ahead, mut behind, mut reused) = (Vec::new(), Vec::new(), Vec::new());
    for stream in streams {
        let is_edge = matches!(stream.of, StreamSource::Edge(_));
        if !(is_edge || stream.is_live()) || !has_enough(stream, limits, out) {
            continue;
        }
        // TIME01 reports an offset with a known cause better.
        let mut add_finding = |finding: Finding, found: &mut Vec<Finding>| {
            if naming.has_word(stream) {
                out.fail(finding.unless(codes::TIME01));
            } else {
                found.push(finding);
            }
        };
        if stream.is_reused(limits) {
            reused.push(one_stamp(stream, limits));
        } else if !is_edge {
            out.pass(stream.subject.clone(), [unique(stream, limits)]);
        } else if let Some((lead_s, of)) = lead(stream, &sensors, naming, limits) {
            let measured = Measured::new(format!("stamp minus {of}"), lead_s, "s").samples(stream.stamps.count);
            if lead_s > limits.lead_s {
                add_finding(off(stream, of, measured.limit(limits.lead_s)), &mut ahead);
            } else if lead_s < -limits.lag_s {
                add_finding(off(stream, of, measured.limit(-limits.lag_s)), &mut behind);
            } else {
                out.pass(
                    stream.subject.clone(),
                    [measured.limit(limits.lead_s), unique(stream, limits)],
                );
            }
        } else {
            out.missing(
                stream.subject.clone(),
                "neither the recorder's clock nor a sensor's stamps are of the same kind and rate to compare with",
            );
        }
    }
    report_once(ahead, "are ahead too", out);
    report_once(behind, "are behind too", out);
    report_once(reused, "repeat stamps too", out);
}

/// Constant transforms are valid at any time, and few messages prove nothing.
fn has_enough(stream: &Stream<'_>, limits: &Limits, out: &mut Judge) -> bool {
    let n = stream.stamps.count.saturating_sub(stream.stamps.zero);
    let (why, reason) = if n < limits.min_messages {
        let why = format!("{n} non-zero stamps, {} are needed", limits.min_messages);
        (NotEvaluated::TooLittleEvidence, why)
    } else if matches!(stream.of, StreamSource::Edge(_)) && !stream.moves(limits) {
        let why = "the transform never changes: its stamp does not matter";
        (NotEvaluated::NotApplicable, why.to_owned())
    } else {
        return true;
    };
    out.not_evaluated(stream.subject.clone(), why, reason);
    false
}

/// How far an edge's stamps are ahead of the recorder's clock or of the sensors, whichever is nearer: seconds, and of which.
///
/// Only constant offsets are compared: where a clock runs at another rate, medians of streams that were recorded at
/// different times differ for that reason alone.
fn lead(
    stream: &Stream<'_>,
    sensors: &[&Stream<'_>],
    naming: &Naming<'_>,
    limits: &Limits,
) -> Option<(f64, &'static str)> {
    let steady = |stream: &Stream<'_>| {
        let (offset, spread) = stream.offset_s()?;
        (spread < 0.5 * limits.lead_s).then_some(offset)
    };
    let offset = steady(stream)?;
    let same_clock = sensors.iter().filter(|sensor| sensor.clock() == stream.clock());
    let theirs: Vec<f64> = same_clock.filter_map(|sensor| steady(sensor)).collect();
    let from_sensors = median(&theirs).map(|theirs| (offset - theirs, "the sensors' stamps"));
    let from_log = naming.is_comparable(stream).then_some((offset, "the recorder's clock"));
    let both = from_log.into_iter().chain(from_sensors);
    both.min_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()))
}

/// A stream in a headline.
fn named(stream: &Stream<'_>) -> String {
    match stream.of {
        StreamSource::Edge(edge) => format!("`{}` -> `{}` on `{}`", edge.parent, edge.child, edge.topic),
        StreamSource::Topic(_) => stream.subject.clone(),
    }
}

fn off(stream: &Stream<'_>, of: &str, measured: Measured) -> Finding {
    let lead_s = measured.value;
    let (way, detail, help) = if lead_s > 0.0 {
        (
            "ahead of",
            "tf2 answers a look-up for the present with an estimate that is as old as that.",
            "correct the cause that applies:\n(1) the clock of the computer that publishes the transform is ahead: synchronise the clocks (chrony, PTP)\n\
             (2) the node adds time to the stamp (`transform_tolerance` of AMCL, `transform_time_offset` of robot_localization): set the option to 1 s or \
             less\n(3) otherwise stamp the transform with the time of the estimate",
        )
    } else {
        (
            "behind",
            "tf2 look-ups at the stamps of the sensors wait that long, or fail.",
            "correct the cause that applies:\n(1) the clock of the computer that publishes the transform is behind: synchronise the clocks (chrony, PTP)\n\
             (2) otherwise stamp the transform with the time of the estimate, and publish the transform without delay",
        )
    };
    let message = format!("{}: stamps are {:.2} s {way} {of}", named(stream), lead_s.abs());
    Finding::warning(stream.subject.clone(), message, stream.place())
        .likely()
        .detail(detail)
        .help(help)
        .measured(measured)
}

fn unique(stream: &Stream<'_>, limits: &Limits) -> Measured {
    Measured::new("share of new stamps", 1.0 - stream.repeated_share(), "1")
        .at_least(limits.unique_share)
        .samples(stream.stamps.count)
}

fn one_stamp(stream: &Stream<'_>, limits: &Limits) -> Finding {
    let message = format!(
        "{}: {} of {} messages repeat the previous stamp",
        named(stream),
        stream.stamps.repeated,
        stream.stamps.count
    );
    Finding::warning(stream.subject.clone(), message, stream.place())
        .likely()
        .detail("The content of the messages is from different times.")
        .help("stamp each message with the time of its own content, not with the time of the first message or of the start")
        .measured(unique(stream, limits))
}
