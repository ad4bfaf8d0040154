//! TIME07: in which direction a lidar sweeps, by the times of its points.

mod cause;
mod laser;

use nalgebra::Vector3;

use crate::analysis::time::sweep::{Limits, sweep};
use crate::analysis::{lidar::Clouds, motion::mount::mount};
use crate::rules::prelude::*;
use crate::source::Confidence;
use crate::tables::Sweep;

pub(crate) struct PointTimeSweep;

impl Rule for PointTimeSweep {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "order of the times of the points", out);
        for clouds in Clouds::all(world).filter(|clouds| clouds.timed().next().is_some()) {
            judge_clouds(world, &clouds, limits, out);
        }
        for scans in Clouds::lasers(world) {
            laser::judge_angles(&scans, limits.max_angle_steps, out);
        }
    }
}

fn judge_clouds(world: &Estimates, clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("sweep");
    let sweeps: Vec<(Sweep, f64, f64)> = clouds
        .evidence
        .samples
        .iter()
        .filter_map(|sample| sweep(clouds, sample, limits))
        .collect();
    if sweeps.len() < limits.min_clouds {
        let why = format!(
            "in {} of {} sampled clouds the azimuth follows the times of the points; {} are needed",
            sweeps.len(),
            clouds.evidence.samples.len(),
            limits.min_clouds
        );
        return out.too_little(subject, why);
    }
    let clockwise = sweeps.iter().filter(|one| one.0 == Sweep::Clockwise).count();
    let seen = match clockwise {
        0 => Sweep::CounterClockwise,
        all if all == sweeps.len() => Sweep::Clockwise,
        _ => {
            let why = format!(
                "{clockwise} of {} clouds sweep clockwise, the others counter-clockwise: the direction is not determined",
                sweeps.len()
            );
            return out.too_little(subject, why);
        }
    };
    let opposite = match seen {
        Sweep::Clockwise => Sweep::CounterClockwise,
        Sweep::CounterClockwise => Sweep::Clockwise,
    };
    let measured = [
        Measured::new(
            format!("fit of a {} sweep (1: perfect)", seen.words()),
            sweeps.iter().map(|one| one.1).fold(1.0, f64::min),
            "1",
        )
        .at_least(limits.min_resultant)
        .samples(sweeps.len() as u64),
        Measured::new(
            format!("fit of a {} sweep (1: perfect)", opposite.words()),
            sweeps.iter().map(|one| one.2).fold(0.0, f64::max),
            "1",
        ),
    ];
    let Some((driver, expected)) = clouds.driver.and_then(|driver| Some((driver, driver.sweep?))) else {
        return out.missing(
            subject,
            format!(
                "the points sweep {}, but the direction of this lidar is not in the tables",
                seen.words()
            ),
        );
    };
    if seen == expected {
        return out.pass(subject, measured);
    }
    let mount = clouds.frame().and_then(|frame| mount(world, &frame));
    let up = mount.map(|mount| (mount.base_from_sensor.rotation * Vector3::z()).z);
    if up.is_some_and(|up| up <= -limits.upright) {
        let why = "the sweep is reversed, but the frame is mounted with z down: that is right only where the axes of the cloud are rotated too \
                   (AXES10)";
        return out.not_applicable(subject, why);
    }
    let sensor = clouds.evidence.packets.as_ref();
    let message = format!(
        "`{}`: the points sweep {} about z; a {} sweeps {}",
        clouds.topic.topic,
        seen.words(),
        sensor.map_or(&driver.name, |sensor| &sensor.maker),
        expected.words()
    );
    let (confidence, doubt) = if sensor.is_some() || driver.is_among(&clouds.topic.words()) {
        (Confidence::Likely, "")
    } else {
        (
            Confidence::Hint,
            "Only the fields of the points show the maker of the lidar, and points of other makers may have the same fields.",
        )
    };
    let finding = Finding::warning(subject, message, clouds.place())
        .confidence(confidence)
        .detail(doubt)
        .unless_relation(codes::AXES11)
        .unless_relation(codes::AXES10);
    let finding = cause::explained(world, clouds, finding).measured(measured);
    out.fail(clouds.once_per_lidar(world, finding));
}
