//! TIME02: stamps run late, ahead, or at another rate than the recorder's clock.

mod lateness;

use crate::advice::together::report_once;
use crate::analysis::time::lateness::{Limits, allowed_s};
use crate::analysis::time::streams::{Clock, Stream, StreamSource, declared_streams, log_clock};
use crate::analysis::time::{naming, naming::Naming, simulated::Time, streams};
use crate::rules::prelude::*;
use crate::source::Confidence;
use crate::world::BagEvidence;
use lateness::{Fault, faults};

pub(crate) struct StampVsLog;

impl Rule for StampVsLog {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let (names, reused) = (world.limits::<naming::Limits>(), world.limits::<streams::Limits>());
        for bag in &world.bags {
            let streams = declared_streams(world, bag);
            let naming = Naming::new(bag, &streams, &names);
            let topics = streams.iter().filter(|one| matches!(one.of, StreamSource::Topic(_)));
            let judged: Vec<&Stream<'_>> = topics
                .filter(|stream| is_judged(bag, stream, &streams, (limits, &reused), out))
                .collect();
            let found = judged.iter().flat_map(|one| judge_stream(one, &naming, limits, out));
            report(found.collect(), judged.len(), limits, out);
        }
    }
}

/// Whether the stream's stamps are the time of measurement and can be compared with the recorder's clock.
fn is_judged(
    bag: &BagEvidence,
    stream: &Stream<'_>,
    all: &[Stream<'_>],
    (limits, reused): (&Limits, &streams::Limits),
    out: &mut Judge,
) -> bool {
    let n = stream.stamps.count.saturating_sub(stream.stamps.zero);
    let (why, reason) = if n < limits.min_messages {
        let why = format!("{n} non-zero stamps, {} are needed", limits.min_messages);
        (NotEvaluated::TooLittleEvidence, why)
    } else if !stream.is_live() {
        let why = "messages of this type may carry the stamp of the data that they were computed from";
        (NotEvaluated::NotApplicable, why.to_owned())
    } else if stream.is_reused(reused) {
        let why = "nearly all messages repeat a stamp";
        (NotEvaluated::NotApplicable, why.to_owned())
    } else if stream.clock() == Some(log_clock(bag)) || runs_apart(bag, stream, all) {
        return true;
    } else {
        let why =
            "the stamps and the log time are from different kinds of clock (calendar time, or time since a start)";
        (NotEvaluated::NotApplicable, why.to_owned())
    };
    out.not_evaluated(stream.subject.clone(), why, reason);
    false
}

/// Whether an uptime clock must still advance like a log in calendar time: it is a GNSS receiver's, or other
/// streams show calendar time. The clock of a simulation may run at any rate.
fn runs_apart(bag: &BagEvidence, stream: &Stream<'_>, all: &[Stream<'_>]) -> bool {
    let calendar = all.iter().any(|other| other.clock() == Some(Clock::Calendar));
    Time::of(bag, all) == Time::Wall && (calendar || stream.is_gnss())
}

fn judge_stream(stream: &Stream<'_>, naming: &Naming<'_>, limits: &Limits, out: &mut Judge) -> Vec<Fault> {
    let Some((offset, spread)) = stream.offset_s() else {
        return Vec::new();
    };
    let found = faults(stream, naming, limits);
    let (late_s, ahead_s) = allowed_s(stream, naming, limits);
    if !naming.has_word(stream) {
        let limits_s = [("late from here on", -late_s), ("ahead from here on", ahead_s)];
        out.plot(&stream.subject, || stream.plot(&limits_s));
    }
    if found.is_empty() {
        let named = naming.has_word(stream);
        let measured = Measured::new("stamp minus log time", offset, "s")
            .spread(spread)
            .at_least(-late_s);
        if named || !naming.is_comparable(stream) {
            let why = format!("stamps are {offset:.3} s from the recorder's clock, on another clock or time scale");
            out.not_applicable(stream.subject.clone(), why);
        } else {
            out.pass(stream.subject.clone(), [measured.samples(stream.stamps.count)]);
        }
    }
    found
}

/// Reports faults of one kind and size as one finding, since they have one cause. Where all of several streams have it, the recorder's clock
/// itself is probably wrong.
fn report(mut found: Vec<Fault>, judged: usize, limits: &Limits, out: &mut Judge) {
    found.sort_by(|a, b| a.kind.cmp(&b.kind).then(a.size.total_cmp(&b.size)));
    let mut left = found.into_iter().peekable();
    while let Some(first) = left.next() {
        let (kind, mut size) = (first.kind, first.size);
        let mut findings: Vec<Finding> = vec![first.finding];
        let near = limits.together_s + limits.together_share * size.abs();
        while let Some(next) = left.next_if(|next| next.kind == kind && next.size - size <= near) {
            size = next.size;
            findings.push(next.finding);
        }
        let all = findings.len() == judged && findings.len() >= limits.all_streams;
        if let (true, Some(first)) = (all, findings.first_mut()) {
            "set the clock of the recording computer before recording, and play back no other recording meanwhile: all streams \
             agree with each other, but not with this clock"
                .clone_into(&mut first.help);
            first.severity = first.severity.min(Severity::Warning);
            first.confidence = first.confidence.min(Confidence::Likely);
        }
        report_once(findings, "are off by the same amount", out);
    }
}
