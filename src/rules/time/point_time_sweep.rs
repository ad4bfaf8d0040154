//! TIME07: which way a lidar sweeps, by the times of its points.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use serde::Deserialize;

use crate::math::circular::circular_mean;
use crate::rules::lidar::Clouds;
use crate::rules::motion::mount;
use crate::rules::{Judge, Need, Rule, limits_of};
use crate::tables::Sweep;
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;
use crate::world::cloud::CloudSample;

use super::laser;

/// TIME07.
pub struct PointTimeSweep;

/// Limits of TIME07.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    min_clouds: usize,
    min_points: usize,
    min_resultant: f64,
    min_ratio: f64,
    upright: f64,
    max_angle_steps: f64,
}

impl Rule for PointTimeSweep {
    const PAGE: &'static str = include_str!("../../../rules/time/point-time-sweep.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "order of the times of the points", out);
        for clouds in Clouds::all(world).filter(|clouds| clouds.timed().next().is_some()) {
            judge_clouds(world, &clouds, limits, out);
        }
        for scans in Clouds::lasers(world) {
            laser::judge_angles(&scans, limits.max_angle_steps, out);
        }
    }
}

/// Whether clouds sweep to the other side than their lidar turns, as far as their times tell it.
pub(crate) fn sweeps_the_other_way(clouds: &Clouds) -> bool {
    let Some((limits, expected)) = limits_of::<PointTimeSweep>().zip(clouds.driver.and_then(|driver| driver.sweep))
    else {
        return false;
    };
    let samples = clouds.evidence.samples.iter();
    let told: Vec<Sweep> = samples
        .filter_map(|sample| Some(sweep(clouds, sample, &limits)?.0))
        .collect();
    told.len() >= limits.min_clouds && told.iter().all(|seen| *seen != expected)
}

fn judge_clouds(world: &World, clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("sweep");
    let told: Vec<(Sweep, f64, f64)> = clouds
        .evidence
        .samples
        .iter()
        .filter_map(|sample| sweep(clouds, sample, limits))
        .collect();
    if told.len() < limits.min_clouds {
        let why = format!(
            "in {} of {} sampled clouds the azimuth follows the times of the points; {} are needed",
            told.len(),
            clouds.evidence.samples.len(),
            limits.min_clouds
        );
        return out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
    }
    let clockwise = told.iter().filter(|told| told.0 == Sweep::Clockwise).count();
    let seen = match clockwise {
        0 => Sweep::CounterClockwise,
        all if all == told.len() => Sweep::Clockwise,
        _ => {
            let why = format!(
                "{clockwise} of {} clouds sweep clockwise, the others not: their times are in no order",
                told.len()
            );
            return out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
        }
    };
    let measured = [
        Measured::new("resultant", told.iter().map(|told| told.1).fold(1.0, f64::min), "1")
            .limit(limits.min_resultant)
            .samples(told.len() as u64),
        Measured::new(
            "resultant of the other way",
            told.iter().map(|told| told.2).fold(0.0, f64::max),
            "1",
        ),
    ];
    let Some((driver, expected)) = clouds.driver.and_then(|driver| Some((driver, driver.sweep?))) else {
        let why = format!("it sweeps {}, and nothing says which way this lidar turns", words(seen));
        return out.not_evaluated(subject, NotEvaluated::MissingInput, why);
    };
    if seen == expected {
        return out.pass(subject, measured);
    }
    let mount = clouds.frame().and_then(|frame| mount(world, &frame));
    let up = mount.map(|mount| (mount.base_from_sensor.rotation * Vector3::z()).z);
    if up.is_some_and(|up| up <= -limits.upright) {
        let why = "it sweeps the other way round, in a frame that is mounted with z down: seen from above that is right only where the cloud \
                   is told in axes that are turned besides (AXES10)";
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let message = format!(
        "the points on `{}` sweep {} about z as time goes on, where a {} sweeps {}: the cloud is mirrored, or its z points down, or the times of \
         the points run backwards",
        clouds.topic.topic,
        words(seen),
        driver.name,
        words(expected)
    );
    let finding = Finding::warning(subject, message, clouds.place())
        .likely()
        .relation("mirrored")
        .help("look for y (or x) with the wrong sign where the points are made, an angle that is counted the other way, or times that count from the \
             end of the scan");
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}

fn words(sweep: Sweep) -> &'static str {
    match sweep {
        Sweep::Clockwise => "clockwise",
        Sweep::CounterClockwise => "counter-clockwise",
    }
}

/// Which way a cloud sweeps, with the resultant of that way and of the other; `None` where it does not show.
fn sweep(clouds: &Clouds, sample: &CloudSample, limits: &Limits) -> Option<(Sweep, f64, f64)> {
    let times = sample.times.as_ref()?;
    let (unit_s, _) = clouds.unit(times)?;
    let period_s = clouds.period_s()?;
    let with = |sign: f64| {
        let angles = sample.points.iter().map(|point| {
            let [x, y, _] = point.xyz;
            let share = (point.time - times.range[0]) * unit_s / period_s;
            (y.atan2(x) - sign * TAU * share, 1.0)
        });
        circular_mean(angles).map(|mean| mean.resultant)
    };
    let (left, right) = (with(1.0)?, with(-1.0)?);
    let (best, other) = (left.max(right), left.min(right));
    let is_told =
        sample.points.len() >= limits.min_points && best >= limits.min_resultant && best >= limits.min_ratio * other;
    let seen = if right > left {
        Sweep::Clockwise
    } else {
        Sweep::CounterClockwise
    };
    is_told.then_some((seen, best, other))
}
