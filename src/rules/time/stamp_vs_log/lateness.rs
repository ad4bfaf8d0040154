//! What can be wrong between a stream's stamps and the recorder's clock: a part of TIME02.

use crate::analysis::time::lateness::allowed_s;
use crate::rules::codes;
use crate::verdict::{Finding, Measured, Severity};

use crate::analysis::time::lateness::Limits;
use crate::analysis::time::naming::Naming;
use crate::analysis::time::streams::Stream;
use crate::analysis::time::trend::{Drift, change, drift};

/// The kinds of fault, in the order of the findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// The stamps advance at another rate than seconds.
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

/// All faults of a stream. One that runs at another rate has no constant offset.
pub(crate) fn faults(stream: &Stream<'_>, naming: &Naming<'_>, limits: &Limits) -> Vec<Fault> {
    let steady = drift(stream).filter(|drift| drift.gained_s().abs() > limits.margin * drift.residual_s);
    if let Some(found) = steady.and_then(|drift| rate(stream, drift, limits)) {
        return vec![found];
    }
    if !naming.is_comparable(stream) {
        return Vec::new();
    }
    let drifting = steady.and_then(|drift| drifting(stream, drift, limits));
    // The offset of a drifting clock only shows how far it has drifted.
    let offset = offset(stream, naming, limits).filter(|_| drifting.is_none());
    [drifting, step(stream, limits), offset].into_iter().flatten().collect()
}

fn rate(stream: &Stream<'_>, drift: Drift, limits: &Limits) -> Option<Fault> {
    if drift.span_s < limits.rate_span_s || drift.rate.abs() <= limits.rate {
        return None;
    }
    let message = format!(
        "{}: stamps advance {:.3} s per second of the recorder's clock, over {:.0} s",
        stream.subject,
        1.0 + drift.rate,
        drift.span_s
    );
    let finding = Finding::error(stream.subject.clone(), message, stream.place())
        .help(
            "correct how the driver computes the stamp; usual causes:\n(1) digits of hours and minutes are read as seconds\n(2) a counter \
             is read in the wrong unit\n(3) a recording was played back at another speed while recording",
        )
        .measured(
            Measured::new("rate of the stamps minus 1", drift.rate, "1")
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
        "{}: stamps drift by {ppm:+.0} ppm from the recorder's clock ({gained_s:+.3} s in {:.0} s)",
        stream.subject, drift.span_s
    );
    let help = if ppm < 0.0 {
        "synchronise the clock that stamps (PTP, PPS, NTP); if that clock is synchronised, look for a queue that grows"
    } else {
        "synchronise the clock that stamps (PTP, PPS, NTP)"
    };
    let finding = Finding::new(severity, stream.subject.clone(), message, stream.place())
        .likely()
        .help(help)
        .measured(
            Measured::new("drift of the stamps from the recorder's clock", ppm, "ppm")
                .limit(limit)
                .samples(stream.stamps.count),
        )
        .measured(Measured::new("this drift, summed over the recording", gained_s, "s").spread(drift.residual_s));
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
        "{}: stamps jump by {:+.3} s against the recorder's clock, {:.1} s after the first message",
        stream.subject, change.by, change.after
    );
    let finding = Finding::warning(stream.subject.clone(), message, stream.place())
        .likely()
        .detail("The offset keeps its new value: probably a clock was set while recording.")
        .help("let NTP or PTP settle before the drivers start, and only slew the clock afterwards")
        .measured(
            Measured::new("step of the stamps against the recorder's clock", change.by, "s")
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
    let is_steady = spread < 0.1 * offset.abs();
    let (what, detail) = if offset > 0.0 {
        let what = format!("{offset:.3} s ahead of the recorder's clock");
        (
            what,
            "The stamps are in the future when the messages are recorded: only predictions may have such stamps.",
        )
    } else if far {
        let detail = if naming.has_word(stream) {
            ""
        } else {
            "No known epoch or leap second has that offset."
        };
        (format!("{:.1} s behind the recorder's clock", -offset), detail)
    } else {
        let detail = if is_steady {
            "The delay is nearly constant: a clock that is not synchronised, or buffering in the driver, is likelier than a queue."
        } else {
            "The delay varies: a queue or a slow link is likelier than a clock that is not synchronised."
        };
        (format!("{:.3} s behind the recorder's clock", -offset), detail)
    };
    let (severity, limit, help) = match (far, offset > 0.0) {
        (true, _) => (
            Severity::Error,
            limits.far_s,
            "synchronise the clock that stamps (PTP, GPS, NTP)",
        ),
        (false, true) => (
            Severity::Warning,
            ahead_s,
            "synchronise the clock that stamps with the recorder's clock (PTP, NTP)",
        ),
        (false, false) => (
            Severity::Warning,
            late_s,
            if is_steady {
                "synchronise the clock that stamps (PTP, NTP); if that clock is synchronised, shorten the buffering in the driver"
            } else {
                "shorten the queue in the driver, or the load on the link"
            },
        ),
    };
    let measured = Measured::new("stamp minus log time", offset, "s");
    let measured = if offset > 0.0 {
        measured.limit(limit)
    } else {
        measured.at_least(-limit)
    };
    let message = format!("{}: stamps are {what}", stream.subject);
    let finding = Finding::new(severity, stream.subject.clone(), message, stream.place())
        .likely()
        .detail(detail)
        .help(help)
        .unless(codes::TIME01)
        .measured(measured.spread(spread).samples(stream.stamps.count));
    Some(Fault {
        kind: Kind::Offset,
        size: offset,
        finding,
    })
}
