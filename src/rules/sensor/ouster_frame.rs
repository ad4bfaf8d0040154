//! SENSOR01: an Ouster cloud that is told in the other one of its two frames.

use std::f64::consts::TAU;

use serde::Deserialize;

use crate::math::circular::{circular_mean, difference};
use crate::rules::lidar::Clouds;
use crate::rules::ouster::{self, Axes};
use crate::rules::{Judge, Need, Rule};
use crate::verdict::plot::{Axis, Plot, Series};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;
use crate::world::cloud::CloudSample;

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
        Clouds::say_packets_of(world, "frame of the cloud", |lidar| lidar.name == "Ouster", out);
        for clouds in Clouds::all(world).filter(|clouds| ouster::is_of_an_ouster(world, clouds)) {
            judge_clouds(world, &clouds, limits, out);
        }
    }
}

/// Where the first column of a topic's clouds lies.
pub(crate) struct Seen {
    /// The frame in whose axes the clouds are told; `None` where the first column is at neither's.
    pub(crate) axes: Option<Axes>,
    azimuth_rad: f64,
    measured: [Measured; 3],
}

/// Which axes the clouds are told in; the error says why that does not show.
pub(crate) fn look(clouds: &Clouds, limits: &Limits) -> Result<Seen, String> {
    let firsts: Vec<First> = clouds
        .evidence
        .samples
        .iter()
        .filter_map(|sample| first(clouds, sample, limits))
        .collect();
    if firsts.len() < limits.min_clouds {
        return Err(format!(
            "in {} of {} sampled clouds the azimuth follows the columns, or the times of a whole turn; {} are needed",
            firsts.len(),
            clouds.evidence.samples.len(),
            limits.min_clouds
        ));
    }
    let mean = circular_mean(firsts.iter().map(|first| (first.azimuth_rad, 1.0)));
    let mean = mean.ok_or("the first columns of the clouds lie in all directions")?;
    let least = firsts.iter().map(|first| first.resultant).fold(1.0, f64::min);
    let other = firsts.iter().map(|first| first.other).fold(0.0, f64::max);
    let near = |axes: &Axes| difference(mean.mean_rad, axes.azimuth_rad()).abs().to_degrees() <= limits.max_off_deg;
    Ok(Seen {
        axes: Axes::BOTH.into_iter().find(near),
        azimuth_rad: mean.mean_rad,
        measured: [
            Measured::new("azimuth of the first column", mean.mean_rad.to_degrees(), "deg")
                .samples(firsts.len() as u64),
            Measured::new("resultant, clockwise", least, "1").limit(limits.min_resultant),
            Measured::new("resultant, counter-clockwise", other, "1"),
        ],
    })
}

/// What the metadata say of the zero of the encoder, for the end of a reason.
fn set_to(world: &World, clouds: &Clouds) -> String {
    let offset = ouster::metadata_of(world, clouds).and_then(|metadata| metadata.azimuth_offset_mdeg.as_ref());
    match offset {
        Some(offset) if offset.value != 0.0 => format!(
            "its metadata set `lidar_frame_azimuth_offset` to {:.3} deg, and what that does to the columns is not verified",
            offset.value * 1e-3
        ),
        Some(_) => "the cloud was turned, for by its metadata the sensor's zero is not set to another angle".to_owned(),
        None => "the cloud was turned, or the sensor is set to another zero (`lidar_frame_azimuth_offset`)".to_owned(),
    }
}

fn judge_clouds(world: &World, clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("frame of the cloud");
    let little = |why: String, out: &mut Judge| out.not_evaluated(&subject, NotEvaluated::TooLittleEvidence, why);
    let Seen {
        axes,
        azimuth_rad,
        measured,
    } = match look(clouds, limits) {
        Ok(seen) => seen,
        Err(why) => return little(why, out),
    };
    out.plot(&subject, || plot(clouds, limits));
    let azimuth_deg = azimuth_rad.to_degrees();
    let seen = axes;
    let frame = clouds.frame();
    let Some(seen) = seen else {
        let why = format!(
            "the first column lies at {azimuth_deg:.0} deg, where the Lidar frame has 0 and the Sensor frame 180: {}",
            set_to(world, clouds)
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
        azimuth_deg,
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

fn is_organised(sample: &CloudSample) -> bool {
    let [height, width] = sample.size;
    height > 1 && width > 1
}

/// How far along the turn a point was measured: by its column, or by its time.
fn share(clouds: &Clouds, sample: &CloudSample, index: usize) -> Option<f64> {
    let point = sample.points.get(index)?;
    if is_organised(sample) {
        return Some(f64::from(point.cell[1]) / f64::from(sample.size[1]));
    }
    let (unit_s, _) = clouds.unit(sample.times.as_ref()?)?;
    Some(point.time * unit_s / clouds.period_s()?)
}

/// The azimuth of the points of the first cloud that tells, along the turn, with how each of the two frames would have it.
fn plot(clouds: &Clouds, limits: &Limits) -> Option<Plot> {
    let mut samples = clouds.evidence.samples.iter();
    let sample = samples.find(|sample| first(clouds, sample, limits).is_some())?;
    let points = sample.points.iter().enumerate().filter_map(|(index, point)| {
        let [x, y, _] = point.xyz;
        Some([share(clouds, sample, index)?, y.atan2(x).to_degrees()])
    });
    let mut series = vec![Series::points("points of a cloud", points)];
    for axes in Axes::BOTH {
        // Clockwise, seen from above: from the azimuth of the first column down.
        let lines = match axes {
            Axes::Lidar => vec![vec![[0.0, 0.0], [0.5, -180.0]], vec![[0.5, 180.0], [1.0, 0.0]]],
            Axes::Sensor => vec![vec![[0.0, 180.0], [1.0, -180.0]]],
        };
        series.extend(Series::lines(&format!("as the {} frame has it", axes.word()), lines));
    }
    Some(Plot {
        title: format!("Azimuth along the turn on `{}`", clouds.topic.topic),
        x: Axis::new(
            if is_organised(sample) {
                "column, share of the turn"
            } else {
                "time, share of the turn"
            },
            "1",
        ),
        y: Axis::new("azimuth of the point", "deg"),
        equal: false,
        series,
        limits: Vec::new(),
    })
}

/// The azimuth of the first column of a cloud; `None` where it does not show.
fn first(clouds: &Clouds, sample: &CloudSample, limits: &Limits) -> Option<First> {
    let is_organised = is_organised(sample);
    let share = |index: usize| share(clouds, sample, index);
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
