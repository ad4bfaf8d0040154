//! SENSOR01: an Ouster cloud that is expressed in the other one of its two frames.

use crate::analysis::sensor::ouster_look::{Limits, first, is_organised, look, share};
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

/// What the metadata state about the zero of the encoder, for the end of a reason.
fn set_to(world: &World, clouds: &Clouds) -> String {
    let offset = ouster::metadata_of(world, clouds).and_then(|metadata| metadata.azimuth_offset_mdeg.as_ref());
    match offset {
        Some(offset) if offset.value != 0.0 => format!(
            "its metadata set `lidar_frame_azimuth_offset` to {:.3} deg, whose effect on the columns is not verified",
            offset.value * 1e-3
        ),
        Some(_) => "the cloud was rotated, since its metadata set no other zero of the sensor".to_owned(),
        None => "the cloud was rotated, or the sensor has another zero (`lidar_frame_azimuth_offset`)".to_owned(),
    }
}

fn judge_clouds(world: &World, clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("frame of the cloud");
    let little = |why: String, out: &mut Judge| out.too_little(&subject, why);
    let fit = match look(clouds, limits) {
        Ok(fit) => fit,
        Err(why) => return little(why, out),
    };
    out.plot(&subject, || plot(clouds, limits));
    let azimuth_deg = fit.azimuth_rad.to_degrees();
    let Some(seen) = fit.axes else {
        let why = format!(
            "the first column is at {azimuth_deg:.0} deg; the Lidar frame has it at 0, the Sensor frame at 180: {}",
            set_to(world, clouds)
        );
        return little(why, out);
    };
    let frame = clouds.frame();
    let Some((frame, said)) = frame.and_then(|frame| Some((frame.clone(), Axes::of(&frame)?))) else {
        let why = format!(
            "the cloud is expressed in the {} frame, but its frame name does not state which of the two it is (`os_lidar` or `os_sensor`)",
            seen.word()
        );
        return out.missing(subject, why);
    };
    if said == seen {
        return out.pass(subject, fit.measured);
    }
    let message = format!(
        "`{}`: frame_id is `{frame}`, but the points are in the {} frame (180 deg off)",
        clouds.topic.topic,
        seen.word()
    );
    let [right, wrong] = [seen, said].map(|axes| axes.word().to_lowercase());
    let named = frame.as_str().strip_suffix(wrong.as_str());
    let named = named.map_or_else(|| "the other frame".to_owned(), |stem| format!("`{stem}{right}`"));
    let finding = Finding::error(subject, message, clouds.place())
        .likely()
        .relation("z180")
        .detail(format!(
            "The azimuth of the first column is {azimuth_deg:.0} deg; in the {} frame it would be {:.0} deg. The two frames differ by 180 deg \
             about z and by the height of the beams.",
            said.word(),
            said.azimuth_rad().to_degrees()
        ))
        .help(format!(
            "set the frame_id of the cloud to {named} (with ouster-ros by `point_cloud_frame`)"
        ));
    out.fail(finding.measured(fit.measured));
}

/// The azimuth of the points along the turn, of the first cloud that determines it, with the lines of the two frames.
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
        series.extend(Series::lines(&format!("expected in the {} frame", axes.word()), lines));
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
