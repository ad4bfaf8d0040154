//! TIME09: what one sensor's stamps say happened sooner or later than another's, by the motion that both saw.

use crate::advice::together::tell_once;
use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{BagMotion, Motion};
use crate::analysis::time::offsets::{Limits, Offset, Without};
use crate::analysis::time::reference::{reference, words};
use crate::analysis::time::turning::{Kind, Signal, signals};
use crate::rules::prelude::*;
use crate::verdict::Plot;
use crate::verdict::plot::{Axis, Series};
use crate::world::{BagEvidence, World};

pub(crate) struct SensorTimeOffset;

impl Rule for SensorTimeOffset {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let sensors = Sensors::of(world);
        for (index, (bag, motion)) in world.bags.iter().zip(&Motion::of(world).bags).enumerate() {
            judge_bag(world, bag, motion, sensors.of_bag(index), limits, out);
        }
    }
}

/// Whether a signal is an orientation that is known to be wrong: its lag is none.
fn is_wrong(signal: &Signal, motion: &BagMotion, sensors: &[Sensor]) -> bool {
    let mut known = motion.imus.iter().zip(sensors);
    let own = known.find(|(imu, _)| signal.kind == Kind::Orientation && imu.stream.subject == signal.stream);
    own.is_some_and(|(_, sensor)| sensor.diagnosis.shown_by.is_some())
}

fn judge_bag(
    world: &World,
    _bag: &BagEvidence,
    motion: &BagMotion,
    sensors: &[Sensor],
    limits: &Limits,
    out: &mut Judge,
) {
    let signals = signals(motion);
    let (first, others) = match reference(world, &signals, limits) {
        Ok(found) => found,
        Err(whys) => {
            for (signal, why) in signals.iter().zip(whys) {
                out.too_little(&signal.subject, why);
            }
            return;
        }
    };
    let mut off: Vec<Finding> = Vec::new();
    for (second, found) in others {
        let subject = second.subject.clone();
        if is_wrong(second, motion, sensors) {
            out.not_applicable(subject, "the orientation is wrong by itself: its lag says nothing");
            continue;
        }
        match found {
            Err(Without::Silent(_, why)) => {
                out.too_little(subject, format!("against {}, {why}", words(first)));
            }
            Err(Without::Varies(why)) => out.too_little(subject, why),
            Ok(offset) => {
                out.plot(&subject, || Some(plot(first, second, &offset)));
                let limit_s = limit_s(first, second, limits);
                let measured = measured(first, &offset, limit_s);
                let (size_s, give_s) = (offset.in_stamps_s.abs(), limits.sigmas * offset.sigma_s);
                let beyond_s = size_s - give_s - limit_s;
                if beyond_s <= 0.0 && size_s + give_s > limit_s {
                    let why = format!(
                        "an offset of {:+.3} s against {}, give or take {give_s:.3} s: whether it is within the {limit_s:.3} s that are \
                         sound cannot be told",
                        offset.in_stamps_s,
                        words(first)
                    );
                    out.too_little(subject, why);
                } else if beyond_s <= 0.0 {
                    out.pass(subject, measured);
                } else {
                    let is_large = beyond_s > slack_s(first, second);
                    let finding = late(first, second, &offset, measured, is_large, limits);
                    // In log time they agree: the stamps of one of them are off.
                    off.push(if offset.in_log_s.abs() <= limit_s {
                        finding.unless(codes::TIME01).unless(codes::TIME02)
                    } else {
                        finding
                    });
                }
            }
        }
    }
    let (later, sooner) = off
        .into_iter()
        .partition(|finding: &Finding| finding.measured.first().is_some_and(|measured| measured.value > 0.0));
    for together in [later, sooner] {
        tell_once(together, "run likewise", out);
    }
}

/// Up to which offset two signals are sound, seconds.
fn limit_s(first: &Signal, second: &Signal, limits: &Limits) -> f64 {
    let of = |signal: &Signal| match signal.kind {
        Kind::Fix => limits.fix_s + signal.period_s,
        Kind::Orientation => limits.filter_s,
        _ => limits.limit_s,
    };
    of(first).max(of(second))
}

/// What velocities made of the difference to the message before are late by, seconds: half a period of the slower signal.
fn slack_s(first: &Signal, second: &Signal) -> f64 {
    [first, second]
        .map(|signal| {
            if signal.kind == Kind::Fix {
                0.0
            } else {
                signal.period_s / 2.0
            }
        })
        .into_iter()
        .fold(0.0, f64::max)
}

fn measured(first: &Signal, offset: &Offset, limit_s: f64) -> [Measured; 2] {
    [
        Measured::new(
            format!("after {}, by {}", words(first), offset.by.words()),
            offset.in_stamps_s,
            "s",
        )
        .limit(limit_s.copysign(offset.in_stamps_s))
        .spread(offset.sigma_s),
        Measured::new("correlation", offset.correlation, "1").samples(count(offset.n_eff)),
    ]
}

/// The correlation over the lag, with the one that fits best.
fn plot(first: &Signal, second: &Signal, offset: &Offset) -> Plot {
    let mut series = Series::lines(&format!("correlation by {}", offset.by.words()), [offset.curve.clone()]);
    series.push(Series::points(
        "the best lag",
        [[offset.in_stamps_s, offset.correlation]],
    ));
    Plot {
        title: format!("{} after {}", second.subject, words(first)),
        x: Axis::new("lag of the stamps", "s"),
        y: Axis::new("correlation", "1"),
        equal: false,
        series,
        limits: Vec::new(),
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn count(n_eff: f64) -> u64 {
    n_eff.max(0.0) as u64
}

fn late(
    first: &Signal,
    second: &Signal,
    offset: &Offset,
    measured: [Measured; 2],
    is_large: bool,
    limits: &Limits,
) -> Finding {
    let way = if offset.in_stamps_s > 0.0 { "after" } else { "before" };
    let size_s = offset.in_stamps_s.abs();
    let message = format!(
        "by its stamps, {} shows the motion {size_s:.3} s {way} {} (+-{:.3} s; {}, correlation {:.2}, alike in all parts of the \
         recording)",
        second.subject,
        words(first),
        limits.sigmas * offset.sigma_s,
        offset.by.words(),
        offset.correlation
    );
    let help = format!(
        "stamp with the time of measuring, not of arrival; find which of the two is off, or tell the filter the delay: {} {size_s:.3} \
         s {} the stamps of {}",
        if offset.in_stamps_s > 0.0 { "take" } else { "add" },
        if offset.in_stamps_s > 0.0 { "from" } else { "to" },
        second.subject
    );
    let severity = if is_large { Severity::Warning } else { Severity::Note };
    let finding = Finding::new(severity, &second.subject, message, second.place.clone())
        .likely()
        .help(help)
        .related(first.place.clone(), words(first));
    finding.measured(measured)
}
