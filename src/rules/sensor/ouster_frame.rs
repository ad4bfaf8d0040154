//! SENSOR01: an Ouster cloud that is told in the other one of its two frames.

use std::f64::consts::{PI, TAU};

use serde::Deserialize;

use crate::math::circular::{circular_mean, difference};
use crate::rules::lidar::Clouds;
use crate::rules::{Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::cloud::CloudSample;
use crate::world::{FrameId, World};

/// SENSOR01.
pub struct OusterFrame;

/// Limits of SENSOR01.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    min_clouds: usize,
    min_points: usize,
    min_resultant: f64,
    min_ratio: f64,
    max_off_deg: f64,
    min_turn: f64,
}

/// The two frames of the sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axes {
    /// x towards the connector, as the encoder counts.
    Lidar,
    /// x away from the connector.
    Sensor,
}

impl Axes {
    fn word(self) -> &'static str {
        match self {
            Self::Lidar => "Lidar",
            Self::Sensor => "Sensor",
        }
    }

    fn azimuth_rad(self) -> f64 {
        match self {
            Self::Lidar => 0.0,
            Self::Sensor => PI,
        }
    }

    /// That which a frame's name says: `os_lidar`, `os1_sensor`, `ouster/os_lidar`. A plain `lidar` may be either.
    fn of(frame: &FrameId) -> Option<Self> {
        let tokens = frame.tokens();
        let is_ouster = |token: &String| {
            let rest = token.strip_prefix("os");
            token == "ouster" || rest.is_some_and(|rest| rest.chars().all(|letter| letter.is_ascii_digit()))
        };
        match tokens.last().map(String::as_str)? {
            "lidar" if tokens.iter().any(is_ouster) => Some(Self::Lidar),
            "sensor" if tokens.iter().any(is_ouster) => Some(Self::Sensor),
            _ => None,
        }
    }
}

/// Azimuth of the first column, in one cloud.
struct First {
    azimuth_rad: f64,
    resultant: f64,
    other: f64,
}

impl Rule for OusterFrame {
    const PAGE: &'static str = include_str!("../../../rules/sensor/ouster-frame.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let is_ouster = |clouds: &Clouds| clouds.driver.is_some_and(|driver| driver.name == "Ouster");
        for clouds in Clouds::all(world).filter(is_ouster) {
            judge_clouds(&clouds, limits, out);
        }
    }
}

fn judge_clouds(clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("frame of the cloud");
    let firsts: Vec<First> = clouds
        .evidence
        .samples
        .iter()
        .filter_map(|sample| first(clouds, sample, limits))
        .collect();
    let little = |why: String, out: &mut Judge| out.not_evaluated(&subject, NotEvaluated::TooLittleEvidence, why);
    if firsts.len() < limits.min_clouds {
        let why = format!(
            "in {} of {} sampled clouds the azimuth follows the columns, or the times of a whole turn; {} are needed",
            firsts.len(),
            clouds.evidence.samples.len(),
            limits.min_clouds
        );
        return little(why, out);
    }
    let Some(mean) = circular_mean(firsts.iter().map(|first| (first.azimuth_rad, 1.0))) else {
        return;
    };
    let least = firsts.iter().map(|first| first.resultant).fold(1.0, f64::min);
    let other = firsts.iter().map(|first| first.other).fold(0.0, f64::max);
    let measured = [
        Measured::new("azimuth of the first column", mean.mean_rad.to_degrees(), "deg").samples(firsts.len() as u64),
        Measured::new("resultant, clockwise", least, "1").limit(limits.min_resultant),
        Measured::new("resultant, counter-clockwise", other, "1"),
    ];
    let near = |axes: &Axes| difference(mean.mean_rad, axes.azimuth_rad()).abs().to_degrees() <= limits.max_off_deg;
    let seen = [Axes::Lidar, Axes::Sensor].into_iter().find(near);
    let frame = clouds.frame();
    let Some(seen) = seen else {
        let why = format!(
            "the first column lies at {:.0} deg, where the Lidar frame has 0 and the Sensor frame 180: the cloud was turned, or the sensor \
             is set to another zero (`lidar_frame_azimuth_offset`)",
            mean.mean_rad.to_degrees()
        );
        return little(why, out);
    };
    let Some((frame, said)) = frame.and_then(|frame| Some((frame.clone(), Axes::of(&frame)?))) else {
        let why = format!(
            "the cloud is told in the {} frame, and the name of its frame does not say which of the two it is",
            seen.word()
        );
        return out.not_evaluated(subject, NotEvaluated::MissingInput, why);
    };
    if said == seen {
        return out.pass(subject, measured);
    }
    let message = format!(
        "the cloud on `{}` says `{frame}`, and is told in the {} frame: its first column lies at {:.0} deg, where the {} frame has {:.0}",
        clouds.topic.topic,
        seen.word(),
        mean.mean_rad.to_degrees(),
        said.word(),
        said.azimuth_rad().to_degrees()
    );
    let finding = Finding::error(subject, message, clouds.place())
        .likely()
        .relation("z180")
        .help(
            "set `point_cloud_frame` of ouster-ros to the frame that the calibration was made in (ROS 1 publishes the Sensor frame, ROS 2 the Lidar \
             frame), and let the name say it: the two differ by 180 deg about z and by the height of the beams",
        );
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}

/// The azimuth of the first column of a cloud; `None` where it does not show.
fn first(clouds: &Clouds, sample: &CloudSample, limits: &Limits) -> Option<First> {
    let [height, width] = sample.size;
    let is_organised = height > 1 && width > 1;
    let share = |index: usize| -> Option<f64> {
        let point = sample.points.get(index)?;
        if is_organised {
            return Some(f64::from(point.cell[1]) / f64::from(width));
        }
        let (unit_s, _) = clouds.unit(sample.times.as_ref()?)?;
        Some(point.time * unit_s / clouds.period_s()?)
    };
    if !is_organised {
        // A part of a turn, or one whose first time is not that of its first column, would be turned.
        let times = sample.times.as_ref()?;
        let (unit_s, _) = clouds.unit(times)?;
        let span = (times.range[1] - times.range[0]) * unit_s / clouds.period_s()?;
        if span < limits.min_turn {
            return None;
        }
    }
    let with = |sign: f64| {
        let angles = sample.points.iter().enumerate().filter_map(|(index, point)| {
            let [x, y, _] = point.xyz;
            Some((y.atan2(x) + sign * TAU * share(index)?, 1.0))
        });
        circular_mean(angles)
    };
    let (clockwise, other) = (with(1.0)?, with(-1.0)?);
    let is_told = sample.points.len() >= limits.min_points
        && clockwise.resultant >= limits.min_resultant
        && clockwise.resultant >= limits.min_ratio * other.resultant;
    is_told.then_some(First {
        azimuth_rad: clockwise.mean_rad,
        resultant: clockwise.resultant,
        other: other.resultant,
    })
}
