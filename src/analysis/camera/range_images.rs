//! Faults of a declared range image: of its declaration alone, and compared with the clouds that it is made of. Must not judge.

use std::f64::consts::TAU;

use serde::Deserialize;

use crate::analysis::{camera::declared::is_about, lidar::Clouds, names};
use crate::math::stats::quantile;
use crate::verdict::Measured;
use crate::world::World;
use crate::world::projection::{Projection, RangeImage, Seam, Sense};

/// A fault, with its relation, help and measurement.
pub(crate) struct Fault {
    pub(crate) message: String,
    /// Evidence behind the message; may be empty.
    pub(crate) detail: String,
    pub(crate) relation: &'static str,
    pub(crate) help: &'static str,
    pub(crate) measured: Measured,
    pub(crate) is_certain: bool,
}

/// The faults that show without any data.
pub(crate) fn alone(image: &RangeImage) -> Vec<Fault> {
    let mut faults = Vec::new();
    if let (Some(up), Some(down)) = (image.fov_up_deg, image.fov_down_deg)
        && up <= down
    {
        faults.push(Fault {
            message: format!(
                "the upper edge of the range image, {up} deg, is declared below its lower edge, {down} deg"
            ),
            detail: String::new(),
            relation: "swapped",
            help: "exchange the two edges, or correct the sign of the lower edge",
            measured: Measured::new("upper edge minus lower edge", up - down, "deg").at_least(0.0),
            is_certain: true,
        });
    }
    if let (Some(Seam::None), Some(width)) = (image.seam, image.width) {
        faults.push(Fault {
            message: format!(
                "`seam: none`: a point straight behind gets column {width}, but the last column is {}",
                width.saturating_sub(1)
            ),
            detail: "The usual formula, column = floor((azimuth + pi) / (2 pi) * width), gives the width at azimuth pi."
                .to_owned(),
            relation: "seam",
            help: "in the code of the projection, take the column modulo the width, and declare `seam: wrap`; or limit the column to width - 1, and \
                   declare `seam: clamp`",
            measured: Measured::new("column of azimuth pi", f64::from(width), "count").limit(f64::from(width) - 1.0),
            is_certain: true,
        });
    }
    faults
}

/// The clouds that a declaration is about.
pub(crate) fn clouds<'w>(
    world: &'w World,
    projection: &Projection,
    declared: &[(&Projection, &RangeImage)],
) -> Result<Vec<Clouds<'w>>, String> {
    let about = |clouds: &Clouds| {
        let is_ouster = clouds.driver.is_some_and(|driver| driver.name == "Ouster");
        clouds.is_of_a_lidar() && is_about(projection, clouds.topic) && (projection.format != "ouster" || is_ouster)
    };
    let found: Vec<Clouds> = Clouds::all(world).filter(about).collect();
    let (first, others) = found
        .split_first()
        .ok_or("no recording has clouds of a lidar that it could be about: add one, or declare its `topic`")?;
    if projection.topic.is_none() {
        if others.iter().any(|clouds| clouds.topic.topic != first.topic.topic) {
            return Err("several lidars are recorded: declare which one it is about with `topic`".to_owned());
        }
        let alike = declared
            .iter()
            .filter(|(other, _)| other.topic.is_none() && other.format == projection.format);
        if alike.count() > 1 {
            return Err(
                "several files of this format are given: check the one of this lidar alone, or declare `topic`"
                    .to_owned(),
            );
        }
    }
    Ok(found)
}

/// The faults that the data of a topic show.
pub(crate) fn against(
    clouds: &Clouds,
    image: &RangeImage,
    limits: &Limits,
) -> Result<(Vec<Fault>, Vec<Measured>), String> {
    let topic = &clouds.topic.topic;
    if clouds
        .frame()
        .is_some_and(|frame| names::is_base(&frame) && !names::is_device(&frame))
    {
        return Err(format!(
            "the clouds on `{topic}` are expressed in the base, not in the sensor: record the clouds of the driver"
        ));
    }
    let elevations: Vec<f64> = clouds
        .evidence
        .samples
        .iter()
        .flat_map(|sample| &sample.points)
        .map(|point| point.xyz)
        .filter(|[x, y, z]| x.hypot(*y).hypot(*z) >= limits.near_m)
        .map(|[x, y, z]| z.atan2(x.hypot(y)).to_degrees())
        .collect();
    if elevations.len() < limits.min_points {
        return Err(format!(
            "{} points of `{topic}` are beyond {} m; {} are needed",
            elevations.len(),
            limits.near_m,
            limits.min_points
        ));
    }
    let at = |share| quantile(&elevations, share).unwrap_or(f64::NAN);
    let (low, high) = (at(limits.quantile), at(1.0 - limits.quantile));
    let mut measured = vec![
        Measured::new("lowest elevation of nearly all points", low, "deg").samples(elevations.len() as u64),
        Measured::new("highest elevation of nearly all points", high, "deg").samples(elevations.len() as u64),
    ];
    let mut faults = Vec::new();
    faults.extend(edges(topic, image, &elevations, [low, high], limits, &mut measured));
    faults.extend(size(clouds, image, &mut measured));
    faults.extend(sense(clouds, image, limits, &mut measured));
    Ok((faults, measured))
}

fn edges(
    topic: &str,
    image: &RangeImage,
    elevations: &[f64],
    [low, high]: [f64; 2],
    limits: &Limits,
    measured: &mut Vec<Measured>,
) -> Option<Fault> {
    let (up, down) = (image.fov_up_deg?, image.fov_down_deg?);
    if up <= down {
        return None;
    }
    let off = limits.max_off_deg;
    let outside = elevations
        .iter()
        .filter(|angle| **angle > up + off || **angle < down - off)
        .count();
    let outside = outside as f64 / elevations.len() as f64;
    let share = Measured::new("share of the points outside the declared edges", outside, "1").limit(limits.max_outside);
    measured.push(share.clone());
    if outside > limits.max_outside {
        let [up_deg, down_deg] = [up, down].map(f64::to_degrees);
        let is_radians = up_deg <= 91.0 && down_deg >= -91.0 && high <= up_deg + off && low >= down_deg - off;
        let is_reversed = high <= -down + off && low >= -up - off;
        let (relation, what, help) = if is_radians {
            (
                "radians",
                "The edges are probably in radians.",
                "multiply both edges by 180 / pi: degrees are required",
            )
        } else if is_reversed {
            (
                "swapped",
                "The two edges are exchanged, with their signs.",
                "exchange the edges: the upper edge is the elevation of the highest beam",
            )
        } else {
            (
                "field-of-view",
                "The edges are probably those of another sensor or revision.",
                "declare the elevations of the sensor's own metadata or data sheet",
            )
        };
        return Some(Fault {
            message: format!(
                "{:.1} % of the points on `{topic}` are outside the declared range image, {down} to {up} deg",
                100.0 * outside
            ),
            detail: format!("The points are from {low:.1} to {high:.1} deg. {what}"),
            relation,
            help,
            measured: share,
            is_certain: false,
        });
    }
    // Beams into the sky have no returns; the lowest ones hit the ground.
    let unused = low - down;
    (unused > 2.0 * off + 0.25 * (up - down)).then(|| Fault {
        message: format!(
            "the range image is declared down to {down} deg, but the points on `{topic}` end at {low:.1} deg"
        ),
        detail: "The lowest rows stay empty.".to_owned(),
        relation: "field-of-view",
        help: "declare the elevations of the sensor's own metadata or data sheet",
        measured: Measured::new("declared below the lowest points", unused, "deg").limit(off),
        is_certain: false,
    })
}

/// Rows and columns, where the cloud is organised.
fn size(clouds: &Clouds, image: &RangeImage, measured: &mut Vec<Measured>) -> Option<Fault> {
    let sample = clouds
        .evidence
        .samples
        .iter()
        .find(|sample| sample.size.iter().all(|count| *count > 1))?;
    let [rows, columns] = sample.size;
    measured.push(Measured::new("rows of the cloud", f64::from(rows), "count"));
    measured.push(Measured::new("columns of the cloud", f64::from(columns), "count"));
    let multiple = |a: u32, b: u32| a.max(b).is_multiple_of(a.min(b).max(1));
    let topic = &clouds.topic.topic;
    let both = [("rows", image.height, rows), ("columns", image.width, columns)];
    both.into_iter().find_map(|(what, declared, seen)| {
        let declared = declared?;
        (!multiple(declared, seen)).then(|| Fault {
            message: format!(
                "the range image is declared with {declared} {what}, but the clouds on `{topic}` have {seen}"
            ),
            detail: String::new(),
            relation: "size",
            help: "declare the rows and columns of the sensor, or an integer fraction of them",
            measured: Measured::new(format!("declared {what}"), f64::from(declared), "count").expected(f64::from(seen)),
            is_certain: true,
        })
    })
}

/// The direction in which the azimuth grows with the columns of an organised cloud.
fn sense(clouds: &Clouds, image: &RangeImage, limits: &Limits, measured: &mut Vec<Measured>) -> Option<Fault> {
    let declared = image.azimuth?;
    let resultant = |sign: f64| {
        let (mut x, mut y, mut count) = (0.0, 0.0, 0.0);
        for sample in clouds
            .evidence
            .samples
            .iter()
            .filter(|sample| sample.size.iter().all(|count| *count > 1))
        {
            for point in &sample.points {
                let [_, column] = point.cell;
                let azimuth = point.xyz[1].atan2(point.xyz[0]);
                let rest = azimuth - sign * TAU * f64::from(column) / f64::from(sample.size[1]);
                (x, y, count) = (x + rest.cos(), y + rest.sin(), count + 1.0);
            }
        }
        if count > 0.0 { f64::hypot(x, y) / count } else { 0.0 }
    };
    let (clockwise, counter) = (resultant(-1.0), resultant(1.0));
    let (seen, most) = if clockwise > counter {
        (Sense::Clockwise, clockwise)
    } else {
        (Sense::CounterClockwise, counter)
    };
    if most < limits.min_resultant {
        return None;
    }
    measured.push(
        Measured::new("agreement of azimuth and column, clockwise", clockwise, "1").at_least(limits.min_resultant),
    );
    measured.push(Measured::new(
        "agreement of azimuth and column, counter-clockwise",
        counter,
        "1",
    ));
    let word = |sense| {
        if sense == Sense::Clockwise {
            "clockwise"
        } else {
            "counter-clockwise"
        }
    };
    (seen != declared).then(|| Fault {
        message: format!(
            "the range image is mirrored: columns are declared {}, but {} on `{}`",
            word(declared),
            word(seen),
            clouds.topic.topic
        ),
        detail: String::new(),
        relation: "mirrored",
        help: match seen {
            Sense::Clockwise => {
                "in the code of the projection, use column = (1 - (azimuth + pi) / (2 pi)) * width; if the code does so already, declare `azimuth: clockwise`"
            }
            Sense::CounterClockwise => {
                "in the code of the projection, use column = (azimuth + pi) / (2 pi) * width; if the code does so already, declare `azimuth: counter_clockwise`"
            }
        },
        measured: Measured::new(
            format!("agreement of azimuth and column, {} (1: always the same)", word(seen)),
            most,
            "1",
        )
        .at_least(limits.min_resultant),
        is_certain: false,
    })
}

/// The origin of the beams: in the sensor's metadata and as declared.
pub(crate) fn beams(
    clouds: &Clouds,
    projection: &Projection,
    image: &RangeImage,
    declared: &[(&Projection, &RangeImage)],
    limits: &Limits,
) -> Option<Fault> {
    if projection.format == "ouster" || clouds.driver.is_none_or(|driver| driver.name != "Ouster") {
        return None;
    }
    let mut metadata = declared.iter().filter(|(other, _)| other.format == "ouster");
    let (Some((_, metadata)), None) = (metadata.next(), metadata.next()) else {
        return None;
    };
    let by_sensor = metadata.beam_offset_mm?;
    let by_file = image.beam_offset_mm.unwrap_or(0.0);
    let off = (by_sensor - by_file).abs();
    (off > limits.max_beam_mm).then(|| Fault {
        message: format!(
            "the beams of the range image start {by_file} mm from the axis, but {by_sensor} mm in the sensor's metadata"
        ),
        detail: format!("This moves points at 3 m by {:.2} deg.", (off * 1e-3 / 3.0).atan().to_degrees()),
        relation: "beam-offset",
        help: "use lidar_origin_to_beam_origin_mm of the sensor's metadata in the projection, as ouster-sdk's XYZLut does",
        measured: Measured::new("difference in the origin of the beams", off, "mm").limit(limits.max_beam_mm),
        is_certain: true,
    })
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) near_m: f64,
    pub(crate) min_points: usize,
    pub(crate) max_off_deg: f64,
    pub(crate) max_outside: f64,
    pub(crate) quantile: f64,
    pub(crate) min_resultant: f64,
    pub(crate) max_beam_mm: f64,
}
