//! Which way is up by the data, compared with the dataset: accelerometers, and the ground under lidars. Part of SENSOR10.

use crate::analysis::Estimates;
use nalgebra::Vector3;

use crate::analysis::ground::{Planes, SIDES};
use crate::analysis::lidar::Clouds;
use crate::analysis::motion::{Imu, Motion};
use crate::analysis::suffix::axes_in_words;
use crate::rules::codes;
use crate::tables::DatasetFrame;
use crate::verdict::{Finding, Judge, Measured};
use crate::world::NamedDataset;

use crate::analysis::sensor::dataset::{Limits, rotation};

/// Judges the streams of frames that the dataset has, and returns their number.
pub(crate) fn judge(world: &Estimates, dataset: &NamedDataset, limits: &Limits, out: &mut Judge) -> usize {
    let mut count = 0;
    for bag in &Motion::of(world).bags {
        for imu in &bag.imus {
            let frame = imu.stream.frame.as_ref();
            if let Some(frame) = frame.and_then(|frame| dataset.row.frame(frame.as_str())) {
                count += 1;
                judge_imu(dataset, imu, frame, limits, out);
            }
        }
    }
    let planes = Planes::of(world);
    for clouds in Clouds::all(world).filter(Clouds::is_of_a_lidar) {
        let frame = clouds.frame();
        if let Some(frame) = frame.as_ref().and_then(|frame| dataset.row.frame(frame.as_str())) {
            count += 1;
            judge_cloud(world, dataset, &clouds, (frame, &planes), out);
        }
    }
    count
}

/// The axes of a frame in the dataset, as a sentence.
fn has_axes(dataset: &NamedDataset, frame: &DatasetFrame) -> String {
    format!(
        "In {} this sensor has {}.",
        dataset.row.name,
        axes_in_words(&frame.axes.word)
    )
}

/// Up in the axes of a frame.
fn up(frame: &DatasetFrame) -> Vector3<f64> {
    rotation(&frame.axes).inverse() * Vector3::z()
}

fn judge_imu(dataset: &NamedDataset, imu: &Imu, frame: &DatasetFrame, limits: &Limits, out: &mut Judge) {
    let subject = format!("up of {}", imu.stream.subject);
    let forces: Vec<Vector3<f64>> = imu
        .stream
        .rows()
        .map(|timed| Vector3::from(timed.row.linear_acceleration))
        .filter(|force| force.iter().all(|value| value.is_finite()))
        .collect();
    let mean = forces.iter().sum::<Vector3<f64>>() / forces.len().max(1) as f64;
    if !(limits.min_force_m_s2..=limits.max_force_m_s2).contains(&mean.norm()) {
        let why = format!(
            "the mean acceleration is {:.1} m/s², which is not gravity alone",
            mean.norm()
        );
        return out.too_little(subject, why);
    }
    let off = mean.angle(&up(frame)).to_degrees();
    let measured = Measured::new(
        format!("angle of the acceleration from up of {}", dataset.row.name),
        off,
        "deg",
    )
    .limit(limits.max_up_deg)
    .samples(forces.len() as u64);
    if off <= limits.max_up_deg {
        return out.pass(subject, [measured]);
    }
    let message = format!(
        "`{}`: mean acceleration is {off:.0} deg from up in the axes of {}",
        imu.stream.topic, dataset.row.name
    );
    let finding = Finding::error(subject, message, imu.stream.place())
        .likely()
        .relation("axes")
        .detail(has_axes(dataset, frame))
        .help(
            "correct the cause that applies:\n(1) the axes of the data were converted: use the data as the dataset has them, or give the frame \
             another name\n(2) the data are of another dataset: correct or remove `dataset` in the configuration",
        )
        .measured(measured);
    out.fail(match &dataset.place {
        Some(place) => finding.related(place.clone(), "named here"),
        None => finding,
    });
}

fn judge_cloud(
    world: &Estimates,
    dataset: &NamedDataset,
    clouds: &Clouds,
    (frame, planes): (&DatasetFrame, &Planes),
    out: &mut Judge,
) {
    let subject = clouds.subject("up");
    let of_up = world.limits::<crate::analysis::ground::Limits>();
    let side = match of_up.agreed(clouds, &planes.grounds(clouds, &of_up.is_ground())) {
        Ok(side) => side,
        Err(why) => return out.too_little(subject, why),
    };
    let Some((axis, word)) = SIDES.get(side) else { return };
    let off = Vector3::from(*axis).angle(&up(frame)).to_degrees();
    if off < 1.0 {
        let what = format!("angle of {word} (up by the ground) from up of {}", dataset.row.name);
        return out.pass(subject, [Measured::new(what, off, "deg").limit(45.0)]);
    }
    let message = format!(
        "`{}`: the ground shows that {word} points up, {off:.0} deg from up in the axes of {}",
        clouds.topic.topic, dataset.row.name
    );
    let finding = Finding::warning(subject, message, clouds.place())
        .likely()
        .unless(codes::AXES10)
        .detail(has_axes(dataset, frame))
        .help("convert the clouds to these axes, or rename their frame")
        .measured(Measured::new("angle from up of the dataset", off, "deg").limit(45.0));
    out.fail(finding);
}
