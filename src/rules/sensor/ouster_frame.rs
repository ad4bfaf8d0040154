//! SENSOR01: an Ouster cloud that is expressed in the other one of its two frames.

use crate::analysis::sensor::ouster_look::{Limits, Seen, first, is_organised, look, share};
use crate::analysis::{lidar::Clouds, ouster, ouster::Axes};
use crate::rules::prelude::*;
use crate::verdict::plot::{Axis, Plot, Series};
use crate::world::World;

pub(crate) struct OusterFrame;

impl Rule for OusterFrame {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets_of(world, "frame of the cloud", |lidar| lidar.name == "Ouster", out);
        for clouds in Clouds::all(world).filter(|clouds| ouster::is_of_an_ouster(world, clouds)) {
            judge_clouds(world, &clouds, limits, out);
        }
    }
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
    let little = |why: String, out: &mut Judge| out.too_little(&subject, why);
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
            "the cloud is expressed in the {} frame, and the name of its frame does not say which of the two it is",
            seen.word()
        );
        return out.missing(subject, why);
    };
    if said == seen {
        return out.pass(subject, measured);
    }
    let message = format!(
        "the cloud on `{}` says `{frame}`, and is expressed in the {} frame: its first column lies at {:.0} deg, where the {} frame has {:.0}",
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
    out.fail(finding.measured(measured));
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
