//! TIME04: stamps that are zero, or from another clock than the rest of the recording.

use crate::rules::prelude::*;
use crate::world::BagEvidence;

mod simulated;

use crate::advice::together::report_once;
use crate::analysis::time::simulated::Time;
use crate::analysis::time::streams::{Stream, UPTIME_BELOW_S, log_start_s, streams};
use crate::analysis::time::units::unit_error;
use simulated::{explain_simulation, judge_simulated};

pub(crate) struct ClockDomain;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_messages: u64,
    zero_share: f64,
    same_clock_s: f64,
    same_start_s: f64,
    min_simulated: usize,
}

impl Rule for ClockDomain {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            judge_bag(bag, limits, out);
        }
    }
}

fn judge_bag(bag: &BagEvidence, limits: &Limits, out: &mut Judge) {
    let streams = streams(bag);
    let time = Time::of(bag, &streams);
    let mut since_start: Vec<(f64, Finding)> = streams
        .iter()
        .filter_map(|stream| judge_stream(bag, stream, (time, &streams), limits, out))
        .collect();
    since_start.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    while let Some((earliest, _)) = since_start.first() {
        // A simulation may run at any rate, so its medians differ.
        let beside_wall = time == Time::SimulatedBesideWall;
        let same = if beside_wall {
            f64::INFINITY
        } else {
            earliest + limits.same_start_s
        };
        // At least the earliest one, whatever the limit: without it this would not end.
        let together = since_start.partition_point(|(offset, _)| *offset <= same).max(1);
        let rest = since_start.split_off(together);
        let group = std::mem::replace(&mut since_start, rest);
        let mut findings: Vec<Finding> = group.into_iter().map(|(_, finding)| finding).collect();
        findings.sort_by(|a, b| a.subject.cmp(&b.subject));
        let mut more = "count from the same start";
        let (n, enough) = (findings.len(), findings.len() >= limits.min_simulated);
        if let Some(first) = findings
            .first_mut()
            .filter(|_| beside_wall || (n == streams.len() && enough))
        {
            explain_simulation(first, n);
            more = "";
        }
        report_once(findings, more, out);
    }
}

/// Judges one stream. A finding of a clock that counts from some start is returned with its offset: other streams may share that clock.
fn judge_stream(
    bag: &BagEvidence,
    stream: &Stream<'_>,
    (time, all): (Time, &[Stream<'_>]),
    limits: &Limits,
    out: &mut Judge,
) -> Option<(f64, Finding)> {
    let subject = stream.subject.clone();
    let n = stream.stamps.count;
    if n < limits.min_messages {
        out.too_little(
            subject,
            format!("{n} stamped messages, {} are needed", limits.min_messages),
        );
        return None;
    }
    let share = stream.zero_share();
    if share > limits.zero_share {
        out.fail(zero(stream, share, limits));
        return None;
    }
    let (Some((offset, spread)), Some(stamp_s)) = (stream.offset_s(), stream.median_stamp_s()) else {
        out.too_little(subject, "no stamps were sampled");
        return None;
    };
    let measured = Measured::new("stamp minus log time", offset, "s")
        .limit(limits.same_clock_s)
        .spread(spread)
        .samples(n);
    let counts = stamp_s < UPTIME_BELOW_S;
    if time == Time::Simulated || (time == Time::SimulatedBesideWall && !counts) {
        judge_simulated(stream, all, measured, out);
    } else if counts && unit_error(stream, log_start_s(bag)).is_none() {
        return Some((offset, uptime(stream, stamp_s, measured)));
    } else if offset.abs() > limits.same_clock_s {
        // A calendar clock with an offset is judged by TIME01 and TIME02.
        out.not_applicable(
            subject,
            format!("stamps are {offset:.1} s from the recorder's clock, but in calendar time"),
        );
    } else {
        out.pass(subject, [measured]);
    }
    None
}

fn zero(stream: &Stream<'_>, share: f64, limits: &Limits) -> Finding {
    let place = stream.stamps.first_zero.clone();
    let message = format!(
        "{}: {:.0} % of the header stamps are zero",
        stream.subject,
        share * 100.0
    );
    let place = place.map_or_else(|| stream.place(), |first| Place::message(stream.source, first));
    Finding::error(stream.subject.clone(), message, place)
        .label("first zero stamp")
        .detail("A tf2 look-up with a zero stamp returns the latest transform, not the one at the time of measurement.")
        .help("set `header.stamp` to the time of measurement in the driver")
        .measured(
            Measured::new("share of zero stamps", share, "1")
                .limit(limits.zero_share)
                .samples(stream.stamps.count),
        )
}

fn uptime(stream: &Stream<'_>, stamp_s: f64, measured: Measured) -> Finding {
    let message = format!(
        "{}: stamps are near {stamp_s:.1} s, the recorder's clock is calendar time",
        stream.subject
    );
    Finding::error(stream.subject.clone(), message, stream.place())
        .label("first stamp")
        .detail("The clock that stamps counts from power-up or from midnight.")
        .help("synchronise the sensor's clock (PTP, GPS, NTP), or stamp with the host clock in the driver")
        .measured(Measured::new("median stamp after 1970", stamp_s, "s").at_least(UPTIME_BELOW_S))
        .measured(measured)
}
