//! The offset of one signal against another, and whether it is one at all.
//!
//! Owns what makes a lag count. Must not judge whether it is too large.

use std::hash::Hasher;
use std::sync::Arc;

use serde::Deserialize;

use crate::analysis::estimates::{Estimates, InputHasher, hash_numbers};
use crate::analysis::time::turning::{Kind, Runs, Signal};
use crate::math::lag::{Lag, Options, Peak, lag};

/// Lags farther from the best one than this count as different, seconds.
const GUARD_S: f64 = 2.0;

/// By what two signals are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    YawRate,
    Speed,
}

impl Quantity {
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::YawRate => "yaw rate",
            Self::Speed => "speed",
        }
    }
}

/// A lag that counts: the second signal after the first.
#[derive(Clone, Debug)]
pub(crate) struct Offset {
    pub(crate) by: Quantity,
    /// By the times that messages arrive with, seconds.
    pub(crate) in_log_s: f64,
    /// By the stamps, seconds.
    pub(crate) in_stamps_s: f64,
    pub(crate) sigma_s: f64,
    pub(crate) correlation: f64,
    pub(crate) n_eff: f64,
    /// The correlation at each lag of the stamps, seconds.
    pub(crate) curve: Vec<[f64; 2]>,
}

/// Why there is no offset.
pub(crate) enum NoOffset {
    /// The signals do not determine one: their correlation, and why.
    Undetermined(f64, String),
    /// They determine one, but it changes.
    Varies(String),
}

/// The offset, unless the two may be of two bodies: one that follows the other shows its motion later without a fault.
pub(crate) fn held(world: &Estimates, first: &Signal, second: &Signal, limits: &Limits) -> Result<Offset, NoOffset> {
    if let (Some(one), Some(other)) = (&first.body, &second.body)
        && one != other
        && world.graph().chain(one, other, |edge| edge.is_rigid).is_none()
    {
        let why = format!("no rigid transform connects `{other}` and `{one}`: they may be two bodies");
        return Err(NoOffset::Undetermined(0.0, why));
    }
    offset(world, first, second, limits)
}

/// The offset of `second` against `first`, by the quantity that determines it best.
fn offset(world: &Estimates, first: &Signal, second: &Signal, limits: &Limits) -> Result<Offset, NoOffset> {
    let (Some(from_s), Some(to_s)) = (first.stamp_offset_s, second.stamp_offset_s) else {
        let why = "the stamps are zero, do not advance, or advance at another rate than the recorder's clock";
        return Err(NoOffset::Undetermined(0.0, why.to_owned()));
    };
    let is_fix = [first.kind, second.kind].contains(&Kind::Fix);
    let by = |by: Quantity, a: &Runs, b: &Runs| log_lag(world, [a, b], by, is_fix, limits);
    let turned = by(Quantity::YawRate, &first.yaw_rate, &second.yaw_rate);
    let ran = by(Quantity::Speed, &first.speed, &second.speed);
    let best = match (turned, ran) {
        (Err(varies @ NoOffset::Varies(_)), _) | (_, Err(varies @ NoOffset::Varies(_))) => Err(varies),
        (Ok(turned), Ok(ran)) => Ok(if ran.sigma_s < turned.sigma_s { ran } else { turned }),
        (Ok(one), Err(NoOffset::Undetermined(..))) | (Err(NoOffset::Undetermined(..)), Ok(one)) => Ok(one),
        (Err(NoOffset::Undetermined(a, why)), Err(NoOffset::Undetermined(b, other))) => Err(if b > a {
            NoOffset::Undetermined(b, other)
        } else {
            NoOffset::Undetermined(a, why)
        }),
    };
    let ahead_s = to_s - from_s;
    best.map(|lag| Offset {
        by: lag.by,
        in_log_s: lag.peak.lag_s,
        in_stamps_s: lag.peak.lag_s + ahead_s,
        sigma_s: lag.sigma_s,
        correlation: lag.peak.rho,
        n_eff: lag.peak.n_eff,
        curve: lag
            .curve
            .into_iter()
            .map(|[lag_s, rho]| [lag_s + ahead_s, rho])
            .collect(),
    })
}

/// A lag by the times that messages arrive with.
struct LogLag {
    by: Quantity,
    sigma_s: f64,
    peak: Peak,
    curve: Vec<[f64; 2]>,
}

fn log_lag(
    world: &Estimates,
    [first, second]: [&Runs; 2],
    by: Quantity,
    is_fix: bool,
    limits: &Limits,
) -> Result<LogLag, NoOffset> {
    let silent = |rho: f64, why: &str| Err(NoOffset::Undetermined(rho, format!("{}: {why}", by.words())));
    let mut options = Options {
        max_lag_s: limits.max_lag_s,
        guard_s: GUARD_S,
        ..Options::fine()
    };
    if is_fix || by == Quantity::Speed {
        (options.grid_s, options.smooth_s, options.hole_s) = (0.1, 0.5, 1.1);
    }
    let found = either_sign(world, [first, second], &options);
    let Some(found) = found.as_ref() else {
        return silent(0.0, "nothing changes while both are recorded");
    };
    let peak = found.whole;
    let recorded_s = peak.pairs as f64 * options.grid_s;
    if recorded_s < limits.min_s {
        let why = format!("both are recorded for {recorded_s:.1} s; {} s are needed", limits.min_s);
        return silent(peak.rho, &why);
    }
    if by == Quantity::YawRate {
        let turning_rad_s = deviation(first).min(deviation(second));
        if turning_rad_s < limits.min_turning_rad_s {
            let why = format!(
                "its standard deviation is {:.1} deg/s, as on a straight drive; record turns ({:.1} deg/s are needed)",
                turning_rad_s.to_degrees(),
                limits.min_turning_rad_s.to_degrees()
            );
            return silent(peak.rho, &why);
        }
    }
    let sigma_s = peak.sigma_s.unwrap_or(f64::INFINITY);
    let min_rho = if is_fix {
        limits.min_correlation_fix
    } else {
        limits.min_correlation
    };
    if peak.rho < min_rho || peak.z < limits.min_z || peak.n_eff < limits.min_n_eff || !peak.interior {
        let why = format!(
            "correlation {:.2} of {:.0} independent samples ({} sigma); {min_rho}, {} and {} sigma are needed",
            peak.rho,
            peak.n_eff,
            peak.z.round(),
            limits.min_n_eff,
            limits.min_z
        );
        return silent(peak.rho, &why);
    }
    // A nearly perfect correlation leads by the ratio of the unexplained parts.
    let leads = |other: f64| peak.rho - other >= limits.min_lead || 1.0 - other >= limits.min_ratio * (1.0 - peak.rho);
    if peak.runner_up.is_some_and(|other| !leads(other)) {
        return silent(peak.rho, "the motion is periodic, and another lag fits as well");
    }
    let telling = found.parts.iter().flatten().filter(|part| {
        part.interior && part.rho >= limits.min_correlation && part.z >= limits.min_part_z && part.sigma_s.is_some()
    });
    let telling: Vec<&Peak> = telling.collect();
    if telling.len() < 2 {
        return silent(
            peak.rho,
            "fewer than two of the three parts of the recording determine a lag",
        );
    }
    let strays = |part: &Peak| {
        let sigma_s = part.sigma_s.unwrap_or(0.0).hypot(sigma_s);
        (part.lag_s - peak.lag_s).abs() > limits.sigmas * sigma_s + limits.steady_s
    };
    if telling.iter().any(|part| strays(part)) {
        let lags: Vec<f64> = telling.iter().map(|part| part.lag_s).collect();
        let (low, high) = lags
            .iter()
            .fold((f64::MAX, f64::MIN), |(low, high), lag| (low.min(*lag), high.max(*lag)));
        return Err(NoOffset::Varies(format!(
            "by {} the lag is {low:+.3} s in one third of the recording and {high:+.3} s in another: a clock drifts, or stamps \
             jitter",
            by.words()
        )));
    }
    if peak.rho < limits.sure_correlation {
        let why = format!(
            "correlation {:.2}; {} is needed, because noise can shift the lag",
            peak.rho, limits.sure_correlation
        );
        return silent(peak.rho, &why);
    }
    // Speeds are taken over two seconds, so that errors of neighbouring speeds are correlated.
    let sigma_s = match by {
        Quantity::YawRate => sigma_s,
        Quantity::Speed => peak.cautious_sigma_s.unwrap_or(f64::INFINITY),
    };
    Ok(LogLag {
        by,
        sigma_s,
        peak,
        curve: found.curve.clone(),
    })
}

/// Standard deviation of the values of a signal.
fn deviation(runs: &Runs) -> f64 {
    let values = || {
        runs.iter()
            .flatten()
            .map(|(_, value)| *value)
            .filter(|value| value.is_finite())
    };
    let count = values().count().max(1) as f64;
    let mean = values().sum::<f64>() / count;
    (values().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// The lag, also of signals with opposite signs: which sign is right is not judged here.
fn either_sign(world: &Estimates, [first, second]: [&Runs; 2], options: &Options) -> Arc<Option<Lag>> {
    let numbers = |hasher: &mut InputHasher| {
        hash_numbers(hasher, [options.grid_s, options.max_lag_s]);
        for runs in [first, second] {
            hasher.write_usize(runs.len());
            for run in runs {
                hasher.write_usize(run.len());
                hash_numbers(hasher, run.iter().flat_map(|(t_s, value)| [*t_s, *value]));
            }
        }
    };
    world.shared(numbers, || {
        let found = lag(first, second, options)?;
        if found.whole.trough.0.abs() <= found.whole.rho {
            return Some(found);
        }
        let negated = |run: &Vec<(f64, f64)>| run.iter().map(|(t_s, value)| (*t_s, -value)).collect();
        let negated: Runs = first.iter().map(negated).collect();
        lag(&negated, second, options)
    })
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) limit_s: f64,
    pub(crate) max_pairs: usize,
    pub(crate) filter_s: f64,
    pub(crate) fix_s: f64,
    pub(crate) scan_s: f64,
    pub(crate) sigmas: f64,
    pub(crate) steady_s: f64,
    pub(crate) max_lag_s: f64,
    pub(crate) min_s: f64,
    pub(crate) min_turning_rad_s: f64,
    pub(crate) min_correlation: f64,
    pub(crate) min_correlation_fix: f64,
    pub(crate) sure_correlation: f64,
    pub(crate) min_z: f64,
    pub(crate) min_part_z: f64,
    pub(crate) min_n_eff: f64,
    pub(crate) min_lead: f64,
    pub(crate) min_ratio: f64,
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::unwrap_used,
        clippy::print_stdout,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss
    )]
    use super::*;
    use crate::analysis::Settings;
    use crate::math::tests_drive::Wander;
    use crate::math::tests_support::Rng;
    use crate::rules::pages;
    use crate::world::World;
    use std::collections::BTreeMap;

    const LATE_S: f64 = 0.1;

    /// Simulation S4 of `tests/rates/lines.rs`: a gyro at 50 Hz, and a yaw rate at 10 Hz with this noise, late by 0.1 s, or another one.
    fn drive(rng: &mut Rng, seconds: f64, noise: f64, related: bool) -> [Runs; 2] {
        let mut wander = || Wander::new(rng, 0.12, 4.0, 0.02);
        let (mut yaw_rate, mut other) = (wander(), wander());
        let (mut gyro, mut rate) = (Vec::new(), Vec::new());
        for i in 0..(seconds / 0.02) as usize {
            let (t_s, one, two) = (i as f64 * 0.02, yaw_rate.next(rng), other.next(rng));
            gyro.push((t_s, one + 0.003 * rng.normal()));
            if i % 5 == 0 {
                let value = if related { one } else { two };
                rate.push((t_s + LATE_S, value + noise * rng.normal()));
            }
        }
        [vec![gyro], vec![rate]]
    }

    fn share(seconds: f64, noise: f64, related: bool, trials: u32) -> (f64, f64) {
        let limits = pages::TIME09.limits::<Limits>(&BTreeMap::new()).unwrap();
        let (world, settings) = (World::default(), Settings::default());
        let estimates = Estimates::new(&world, &settings);
        let mut rng = Rng::new(909);
        let (mut found, mut worst) = (0, 0.0_f64);
        for _ in 0..trials {
            let [gyro, rate] = drive(&mut rng, seconds, noise, related);
            if let Ok(lag) = log_lag(&estimates, [&gyro, &rate], Quantity::YawRate, false, &limits) {
                found += 1;
                worst = worst.max((lag.peak.lag_s - LATE_S).abs());
            }
        }
        (f64::from(found) / f64::from(trials), worst)
    }

    #[test]
    fn an_offset_is_told_nearly_as_often_as_in_s4_and_none_is_invented() {
        for (noise, seconds, least, most_s) in [
            (0.01, 40.0, 0.6, 0.02),
            (0.01, 90.0, 0.9, 0.01),
            (0.05, 90.0, 0.9, 0.03),
        ] {
            let (share, worst_s) = share(seconds, noise, true, 20);
            println!("noise {noise}, {seconds} s: told {share:.2}, worst {worst_s:.3} s");
            assert!(
                share >= least && worst_s <= most_s,
                "{noise} {seconds}: {share} {worst_s}"
            );
        }
        for seconds in [20.0, 40.0, 90.0] {
            assert!(share(seconds, 0.01, false, 40).0 == 0.0, "{seconds}");
        }
    }
}
