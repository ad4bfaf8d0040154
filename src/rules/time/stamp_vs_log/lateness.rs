//! What can be wrong between a stream's stamps and the log clock: a part of TIME02.

use crate::analysis::time::lateness::allowed_s;
use crate::rules::codes;
use crate::verdict::{Finding, Measured, Severity};

use crate::analysis::time::lateness::Limits;
use crate::analysis::time::naming::Naming;
use crate::analysis::time::streams::Stream;
use crate::analysis::time::trend::{Drift, change, drift};

/// The kinds of fault, in the order they are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// The stamps' seconds are no seconds.
    Rate,
    /// The offset grows.
    Drift,
    /// The offset steps.
    Step,
    /// The offset is large.
    Offset,
}

/// A fault of one stream.
pub(crate) struct Fault {
    pub(crate) kind: Kind,
    /// Its size, by which faults of one cause are recognised: seconds, or seconds a second.
    pub(crate) size: f64,
    pub(crate) finding: Finding,
}

/// All faults of a stream. One that runs at another rate has no offset to speak of.
pub(crate) fn faults(stream: &Stream<'_>, naming: &Naming<'_>, limits: &Limits) -> Vec<Fault> {
    let steady = drift(stream).filter(|drift| drift.gained_s().abs() > limits.margin * drift.residual_s);
    if let Some(found) = steady.and_then(|drift| rate(stream, drift, limits)) {
        return vec![found];
    }
    if !naming.is_comparable(stream) {
        return Vec::new();
    }
    let drifting = steady.and_then(|drift| drifting(stream, drift, limits));
    // The offset of a clock that drifts is whatever it has drifted to.
    let offset = offset(stream, naming, limits).filter(|_| drifting.is_none());
    [drifting, step(stream, limits), offset].into_iter().flatten().collect()
}

fn rate(stream: &Stream<'_>, drift: Drift, limits: &Limits) -> Option<Fault> {
    if drift.span_s < limits.rate_span_s || drift.rate.abs() <= limits.rate {
        return None;
    }
    let message = format!(
        "stamps on {} advance {:.3} s in each second of the log clock, over {:.0} s",
        stream.subject,
        1.0 + drift.rate,
        drift.span_s
    );
    let finding = Finding::error(stream.subject.clone(), message, stream.place())
        .help(
            "look at how the driver makes the stamp: digits of hours and minutes taken for seconds, a counter's unit, or a \
             recording played at another speed",
        )
        .measured(
            Measured::new("rate of the stamps, less 1", drift.rate, "1")
                .limit(limits.rate)
                .samples(stream.stamps.count),
        );
    Some(Fault {
        kind: Kind::Rate,
        size: drift.rate,
        finding,
    })
}

fn drifting(stream: &Stream<'_>, drift: Drift, limits: &Limits) -> Option<Fault> {
    let (ppm, gained_s) = (drift.rate * 1e6, drift.gained_s());
    if drift.span_s < limits.drift_span_s || ppm.abs() <= limits.drift_ppm || gained_s.abs() < limits.drift_gain_s {
        return None;
    }
    let (severity, limit) = if ppm.abs() > limits.drift_error_ppm {
        (Severity::Error, limits.drift_error_ppm)
    } else {
        (Severity::Warning, limits.drift_ppm)
    };
    let message = format!(
        "stamps on {} drift against the log clock by {ppm:+.0} ppm: {gained_s:+.3} s in {:.0} s",
        stream.subject, drift.span_s
    );
    let finding = Finding::new(severity, stream.subject.clone(), message, stream.place())
        .likely()
        .help(
            "synchronise the clock that stamps (PTP, PPS, NTP); stamps that only fall behind may also wait in a queue that \
             grows",
        )
        .measured(Measured::new("drift", ppm, "ppm").limit(limit).samples(stream.stamps.count))
        .measured(Measured::new("gained", gained_s, "s").spread(drift.residual_s));
    Some(Fault {
        kind: Kind::Drift,
        size: drift.rate,
        finding,
    })
}

fn step(stream: &Stream<'_>, limits: &Limits) -> Option<Fault> {
    let change = change(stream)?;
    if change.by.abs() <= limits.step_s || change.by.abs() <= limits.margin * change.spread {
        return None;
    }
    let message = format!(
        "stamps on {} step against the log clock by {:+.3} s, {:.1} s after the stream's first message, and stay there",
        stream.subject, change.by, change.after
    );
    let finding = Finding::warning(stream.subject.clone(), message, stream.place())
        .likely()
        .help("a clock was set while recording: let NTP or PTP settle before the drivers start, and slew from then on")
        .measured(
            Measured::new("step", change.by, "s")
                .limit(limits.step_s)
                .spread(change.spread)
                .samples(stream.stamps.count),
        );
    Some(Fault {
        kind: Kind::Step,
        size: change.by,
        finding,
    })
}

fn offset(stream: &Stream<'_>, naming: &Naming<'_>, limits: &Limits) -> Option<Fault> {
    let (offset, spread) = stream.offset_s()?;
    let (late_s, ahead_s) = allowed_s(stream, naming, limits);
    if (-late_s..=ahead_s).contains(&offset) {
        return None;
    }
    let far = offset.abs() > limits.far_s;
    let what = if offset > 0.0 {
        format!("{offset:.3} s ahead of the log clock: they lie in the future when they are recorded")
    } else if far {
        format!(
            "{:.1} s behind the log clock{}",
            -offset,
            if naming.has_word(stream) {
                ""
            } else {
                ", and no known epoch or leap second is that far off"
            }
        )
    } else {
        format!("{:.3} s behind the log clock", -offset)
    };
    let (severity, limit, help) = match (far, offset > 0.0) {
        (true, _) => (
            Severity::Error,
            limits.far_s,
            "find the clock that stamps, and synchronise it (PTP, GPS, NTP)",
        ),
        (false, true) => (
            Severity::Warning,
            ahead_s,
            "synchronise the clock that stamps with the recorder's (PTP, NTP); only a forecast may lie in the future",
        ),
        (false, false) => (
            Severity::Warning,
            late_s,
            "look for a driver that queues, a slow link, or a clock that is not synchronised; filters must wait that long",
        ),
    };
    let message = format!("stamps on {} run {what}", stream.subject);
    let finding = Finding::new(severity, stream.subject.clone(), message, stream.place())
        .likely()
        .help(help)
        .unless(codes::TIME01)
        .measured(
            Measured::new("stamp minus log time", offset, "s")
                .limit(limit)
                .spread(spread)
                .samples(stream.stamps.count),
        );
    Some(Fault {
        kind: Kind::Offset,
        size: offset,
        finding,
    })
}
