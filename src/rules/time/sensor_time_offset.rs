//! TIME09: the offset between the stamps of two sensors, by the motion that both measured.

use crate::advice::together::report_once;
use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::geo::antenna::Antennas;
use crate::analysis::lidar::Clouds;
use crate::analysis::motion::mount::{are_apart, carrier};
use crate::analysis::motion::{BagMotion, Motion};
use crate::analysis::scan_motion::ScanMotion;
use crate::analysis::time::offsets::{Limits, NoOffset, Offset};
use crate::analysis::time::reference::{reference, words};
use crate::analysis::time::turning::{Kind, Signal, scanned, signals};
use crate::rules::prelude::*;
use crate::verdict::Plot;
use crate::verdict::plot::{Axis, Series};

pub(crate) struct SensorTimeOffset;

/// Largest standard error of a delay that replaces the one by the course, seconds.
const MAX_DELAY_ERROR_S: f64 = 0.03;

impl Rule for SensorTimeOffset {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let sensors = Sensors::of(world);
        let scans = ScanMotion::of(world);
        for (index, motion) in Motion::of(world).bags.iter().enumerate() {
            let mut signals = signals(motion);
            let scanners = Clouds::scanners(world).filter(|clouds| clouds.index == index);
            for clouds in scanners {
                match scans.steps(&clouds) {
                    Some(steps) if steps.is_up.is_some() => signals.push(scanned(world, &clouds, steps)),
                    Some(steps) => out.too_little(format!("topic `{}`", clouds.topic.topic), steps.why),
                    None => {}
                }
            }
            signals.retain(|signal| {
                let on = signal.moving.as_ref().and_then(|frame| carrier(world, frame));
                if let Some(on) = &on {
                    let why = format!("it moves relative to `{on}` by TF, and turns otherwise");
                    out.not_applicable(&signal.subject, why);
                }
                on.is_none()
            });
            judge_bag(world, (index, motion), &signals, sensors.of_bag(index), limits, out);
        }
    }
}

/// Whether a signal is an orientation that is known to be wrong: its lag means nothing.
fn is_wrong(signal: &Signal, motion: &BagMotion, sensors: &[Sensor]) -> bool {
    let mut known = motion.imus.iter().zip(sensors);
    let own = known.find(|(imu, _)| signal.kind == Kind::Orientation && imu.stream.subject == signal.stream);
    own.is_some_and(|(_, sensor)| sensor.diagnosis.shown_by.is_some())
}

fn judge_bag(
    world: &Estimates,
    (index, motion): (usize, &BagMotion),
    signals: &[Signal],
    sensors: &[Sensor],
    limits: &Limits,
    out: &mut Judge,
) {
    let (first, others) = match reference(world, signals, limits) {
        Ok(found) => found,
        Err(whys) => {
            for (signal, why) in signals.iter().zip(whys) {
                out.too_little(&signal.subject, why);
            }
            return;
        }
    };
    let (mut later, mut sooner): (Vec<Finding>, Vec<Finding>) = (Vec::new(), Vec::new());
    for (second, found) in others {
        let subject = second.subject.clone();
        if is_wrong(second, motion, sensors) {
            out.not_applicable(
                subject,
                "the orientation itself is wrong, so its lag means nothing: fix that fault first",
            );
            continue;
        }
        let frames = first.moving.as_ref().zip(second.moving.as_ref());
        if frames.is_some_and(|(one, other)| are_apart(world, one, other)) {
            out.not_applicable(subject, format!("it moves by itself, and not with {}", words(first)));
            continue;
        }
        match found {
            Err(NoOffset::Undetermined(_, why)) => {
                out.too_little(subject, format!("compared with {}: {why}", words(first)));
            }
            Err(NoOffset::Varies(why)) => out.too_little(subject, why),
            Ok(offset) => {
                out.plot(&subject, || Some(plot(first, second, &offset)));
                let offset = without_arm(world, (index, motion), [first, second], offset);
                let limit_s = limit_s(first, second, limits);
                let measured = measured(first, &offset, limit_s);
                let (size_s, give_s) = (offset.in_stamps_s.abs(), limits.sigmas * offset.sigma_s);
                let beyond_s = size_s - give_s - limit_s;
                if beyond_s <= 0.0 && size_s + give_s > limit_s {
                    let why = format!(
                        "the offset is {:+.3} s +-{give_s:.3} s from {}: too uncertain to compare with the limit of {limit_s:.3} s",
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
                    let same = if offset.in_stamps_s > 0.0 {
                        &mut later
                    } else {
                        &mut sooner
                    };
                    same.push(if offset.in_log_s.abs() <= limit_s {
                        finding.unless(codes::TIME01).unless(codes::TIME02)
                    } else {
                        finding
                    });
                }
            }
        }
    }
    for together in [later, sooner] {
        report_once(together, "are off by the same amount", out);
    }
}

/// The offset without what the distance of an antenna from the body adds: ahead of it, its course turns earlier.
fn without_arm(world: &Estimates, motion: (usize, &BagMotion), pair: [&Signal; 2], offset: Offset) -> Offset {
    let receivers = pair.map(|signal| {
        let mut all = motion.1.fixes.iter();
        all.position(|fixes| signal.kind == Kind::Fix && fixes.subject == signal.stream)
    });
    let (receiver, sign) = match receivers {
        [None, Some(receiver)] => (receiver, 1.0),
        [Some(receiver), None] => (receiver, -1.0),
        _ => return offset,
    };
    let antennas = Antennas::of(world);
    let best = antennas.best(motion, receiver, |_| true);
    let Some((late_s, error_s)) = best
        .map(|(_, found)| found.late_s)
        .filter(|(_, error_s)| *error_s <= MAX_DELAY_ERROR_S)
    else {
        return offset;
    };
    let by_arm_s = offset.in_log_s - sign * late_s;
    Offset {
        in_log_s: offset.in_log_s - by_arm_s,
        in_stamps_s: offset.in_stamps_s - by_arm_s,
        sigma_s: offset.sigma_s.max(error_s),
        ..offset
    }
}

/// The largest offset of two signals without a fault, seconds.
fn limit_s(first: &Signal, second: &Signal, limits: &Limits) -> f64 {
    let of = |signal: &Signal| {
        let of_kind_s = match signal.kind {
            Kind::Fix => limits.fix_s,
            Kind::Scan => limits.scan_s,
            Kind::Orientation => limits.filter_s,
            Kind::Gyro | Kind::Pose | Kind::Twist => limits.limit_s,
        };
        of_kind_s + signal.within_s
    };
    of(first).max(of(second))
}

/// The delay of velocities that are computed from the difference to the previous message, seconds: half a period of the slower signal that
/// may be computed so.
fn slack_s(first: &Signal, second: &Signal) -> f64 {
    [first, second]
        .map(|signal| {
            if matches!(signal.kind, Kind::Gyro | Kind::Fix | Kind::Scan) {
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
            format!("size of the offset from {}, by {}", words(first), offset.by.words()),
            offset.in_stamps_s.abs(),
            "s",
        )
        .limit(limit_s)
        .spread(offset.sigma_s),
        Measured::new(
            format!("correlation of the {}s", offset.by.words()),
            offset.correlation,
            "1",
        )
        .samples(count(offset.n_eff)),
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

/// What to do to stamps that are to change by this, in words.
fn correction(by_s: f64) -> String {
    let size_s = by_s.abs();
    if by_s > 0.0 {
        format!("add {size_s:.3} s to")
    } else {
        format!("subtract {size_s:.3} s from")
    }
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
    let message = format!("{} is stamped {size_s:.3} s {way} {}", second.subject, words(first));
    let detail = format!(
        "Compared by the {} that both show. The offset is the same in all parts of the recording, to +-{:.3} s ({} times the spread). The \
         data do not show which of the two is wrong.",
        offset.by.words(),
        limits.sigmas * offset.sigma_s,
        limits.sigmas
    );
    let help = format!(
        "correct the stamps that are not the time of measurement:\n(1) {} the stamps of {}\n(2) or {} the stamps of {}",
        correction(-offset.in_stamps_s),
        second.subject,
        correction(offset.in_stamps_s),
        words(first)
    );
    let severity = if is_large { Severity::Warning } else { Severity::Note };
    let finding = Finding::new(severity, &second.subject, message, second.place.clone())
        .likely()
        .detail(detail)
        .help(help)
        .related(first.place.clone(), "compared with this motion");
    finding.measured(measured)
}
