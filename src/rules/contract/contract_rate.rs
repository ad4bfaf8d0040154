//! CONTRACT02: topics with another rate than that of the contract.

use crate::advice::contract::{MEANT, Term, terms};
use crate::analysis::contract::Recorded;
use crate::rules::prelude::*;
use crate::world::BagEvidence;
use crate::world::bag::TopicEvidence;

pub(crate) struct ContractRate;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    tolerance_percent: f64,
}

impl Rule for ContractRate {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for term in terms(world, "rate of ", |terms| terms.rate_hz.is_some(), out) {
            let Some(wanted_hz) = term.terms.rate_hz.filter(|_| !term.is_absent(out)) else {
                continue;
            };
            let tolerance = term.terms.tolerance_percent.unwrap_or(limits.tolerance_percent);
            for found in &term.seen {
                judge_one(&term, found, (wanted_hz, tolerance), out);
            }
        }
    }
}

fn judge_one(term: &Term, (bag, topic): &Recorded, (wanted_hz, tolerance): (f64, f64), out: &mut Judge) {
    if bag.truncated {
        return out.too_little(
            term.subject.as_str(),
            "a part of the recording could not be read, so its messages cannot be counted",
        );
    }
    let Some([least, most]) = bag.rate_hz(topic) else {
        let count = topic.total.unwrap_or(topic.count);
        return out.too_little(
            term.subject.as_str(),
            format!(
                "it has {count} messages; 10 are needed, and 5 s from the first of them to the end of the recording"
            ),
        );
    };
    // Of the rates that it may have, the one nearest to the contract.
    let rate_hz = wanted_hz.max(least).min(most);
    let percent = (rate_hz / wanted_hz - 1.0) * 100.0;
    let measured = [
        Measured::new("rate", rate_hz, "Hz").samples(topic.total.unwrap_or(topic.count)),
        Measured::new("size of the difference from the contract", percent.abs(), "%").limit(tolerance),
    ];
    if percent.abs() <= tolerance {
        return out.pass(term.subject.as_str(), measured);
    }
    let name = term.name;
    let message =
        format!("`{name}` has {rate_hz:.2} Hz instead of {wanted_hz} Hz: {percent:+.0} %, tolerance {tolerance} %");
    let stopped = stopped(bag, topic).filter(|_| percent < 0.0);
    let message = stopped.as_ref().map_or(message, |stopped| {
        format!("`{name}` {stopped}; it should go on with {wanted_hz} Hz")
    });
    let gap_s = topic
        .stamps
        .largest_gap
        .as_ref()
        .map_or(0.0, |(gap_ns, _)| *gap_ns as f64 / 1e9);
    let message = if stopped.is_none() && percent < 0.0 && gap_s > PAUSED / rate_hz {
        format!("{message}, with a gap of {gap_s:.1} s")
    } else {
        message
    };
    let help = if stopped.is_some() {
        "find out what stopped the messages of the topic"
    } else if percent < 0.0 {
        "find out what slows down or drops the messages of the topic"
    } else {
        "find out whether the topic is published twice, or set up with another rate"
    };
    let finding = Finding::warning(&term.subject, message, term.terms.place.clone())
        .label("rate by the contract")
        .detail(
            "The rate is by log time, from the first message of the topic to the last, or to the end of the recording if the messages stop \
             earlier.",
        )
        .help(format!("{help}; {MEANT}"))
        .measured(measured)
        .related(Place::of(bag.source, topic.stamps.first.as_ref()), "first message");
    out.fail(finding);
}

/// A gap of so many steps is stated.
const PAUSED: f64 = 10.0;
/// Share of a recording at its end without a message from which on a topic stopped.
const STOPPED: f64 = 0.1;

/// That a topic stopped before the recording ends, in words.
fn stopped(bag: &BagEvidence, topic: &TopicEvidence) -> Option<String> {
    let (start, end) = bag.share.span_ns.or(bag.start_ns.zip(bag.end_ns))?;
    let seconds = |to: i64| to.saturating_sub(start) as f64 / 1e9;
    let (last_s, end_s) = (seconds(topic.last_log_ns?), seconds(end));
    (end_s - last_s > STOPPED * end_s).then(|| format!("stops after {last_s:.1} s of {end_s:.1} s of the recording"))
}
