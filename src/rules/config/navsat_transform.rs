//! CONFIG02: settings of `navsat_transform_node` in degrees, or with the wrong sign of the declination.

use crate::math::magnetism::declination_deg;
use crate::rules::prelude::*;
use crate::world::{World, launch::LocalizationSettings};

pub(crate) struct NavsatTransform;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_declination_rad: f64,
    least_deg: f64,
    agree_deg: f64,
    year: i32,
    quarter_deg: f64,
}

const DECLINATION: &str = "magnetic_declination_radians";
const OFFSET: &str = "yaw_offset";

impl Rule for NavsatTransform {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for settings in &world.localizations {
            let first = [DECLINATION, OFFSET, "datum"]
                .iter()
                .find_map(|key| settings.values.get(*key));
            let Some(first) = first else { continue };
            let of = format!("`{}` of {}", settings.node, world.path(first.place.source));
            judge_datum(settings, &of, out);
            judge_offset(settings, &of, limits, out);
            judge_declination(world, settings, &of, limits, out);
        }
    }
}

/// A latitude and longitude, and a heading in radians.
fn judge_datum(settings: &LocalizationSettings, of: &str, out: &mut Judge) {
    let Some(written) = settings.values.get("datum") else {
        return;
    };
    let subject = format!("datum of {of}");
    let numbers: Option<Vec<f64>> = written.value.split_whitespace().map(|word| word.parse().ok()).collect();
    let Some([latitude, longitude, rest @ ..]) = numbers.as_deref() else {
        return out.missing(subject, "the datum is not a list of numbers");
    };
    let heading = rest.first().copied().unwrap_or(0.0);
    let measured = Measured::new("heading of the datum", heading, "rad").limit(std::f64::consts::TAU);
    if latitude.abs() > 90.0 {
        let message = format!("the latitude of the datum is {latitude} deg, but must be within 90 deg");
        let latitude = Measured::new("latitude", *latitude, "deg").limit(90.0);
        let finding = Finding::error(subject, message, written.place.clone());
        out.fail(
            finding
                .detail("The order of the datum is latitude, longitude, heading.")
                .help(format!(
                    "if latitude and longitude are swapped, write {longitude}, {}",
                    latitude.value
                ))
                .measured(latitude),
        );
    } else if heading.abs() > std::f64::consts::TAU {
        let message = format!("the heading of the datum is {heading} rad, more than a full rotation");
        let finding = Finding::error(subject, message, written.place.clone())
            .likely()
            .relation("degrees");
        out.fail(
            finding
                .detail("The node reads radians. The value is probably in degrees.")
                .help(format!("write {:.7}", heading.to_radians()))
                .measured(measured),
        );
    } else {
        out.pass(subject, [measured]);
    }
}

fn judge_offset(settings: &LocalizationSettings, of: &str, limits: &Limits, out: &mut Judge) {
    let Some((offset, place)) = settings.number(OFFSET) else {
        return;
    };
    let subject = format!("yaw offset of {of}");
    let value = Measured::new("yaw_offset", offset, "rad");
    let measured = value.clone().limit(std::f64::consts::TAU);
    if offset.abs() > std::f64::consts::TAU {
        let message = format!("`yaw_offset` is {offset} rad, more than a full rotation");
        let finding = Finding::error(subject, message, place.clone())
            .likely()
            .relation("degrees");
        out.fail(
            finding
                .detail("The node reads radians. The value is probably in degrees.")
                .help(format!("write {:.7}", offset.to_radians()))
                .measured(measured),
        );
    } else if (offset.to_degrees() + 90.0).abs() <= limits.quarter_deg {
        let message = "`yaw_offset` is -90 deg; an IMU that reads 0 facing north needs +90 deg";
        let finding = Finding::warning(subject, message, place.clone()).hint();
        out.fail(
            finding
                .detail(
                    "The yaw of the IMU plus `yaw_offset` must be 0 facing east, and must increase counter-clockwise. No offset corrects a yaw \
                     that increases clockwise.",
                )
                .help(
                    "turn the robot left, then face it east, and read the yaw of the IMU:\n(1) if the yaw decreases in the left turn, make the \
                     driver publish a yaw that increases counter-clockwise, and read again\n(2) if the yaw is about 0 facing east (REP-103), \
                     write 0.0\n(3) if the yaw is about -90 deg facing east (0 facing north), write 1.5707963\n(4) if the yaw is about +90 deg \
                     facing east, keep -90 deg",
                )
                .measured(value.expected(std::f64::consts::FRAC_PI_2)),
        );
    } else {
        out.pass(subject, [measured]);
    }
}

fn judge_declination(world: &World, settings: &LocalizationSettings, of: &str, limits: &Limits, out: &mut Judge) {
    let Some((written, place)) = settings.number(DECLINATION) else {
        return;
    };
    let subject = format!("declination of {of}");
    let written_deg = written.to_degrees();
    let size = Measured::new(DECLINATION, written, "rad").limit(limits.max_declination_rad);
    if written.abs() > limits.max_declination_rad {
        let message = format!("`{DECLINATION}` is {written} rad ({written_deg:.0} deg): degrees were probably meant");
        let finding = Finding::error(subject, message, place.clone())
            .likely()
            .relation("degrees");
        let help = format!(
            "write {:.7}, and check the sign: west is positive (the node adds the value to a counter-clockwise yaw)",
            written.to_radians()
        );
        return out.fail(finding.help(help).measured(size));
    }
    if written_deg.abs() < limits.least_deg {
        return out.pass(subject, [size]);
    }
    let Some((position, source)) = position(world, settings) else {
        let why = "the location is unknown: set a datum, or add a recording with GNSS fixes";
        return out.missing(subject, why);
    };
    let Some(declination) = declination_deg(position.0, position.1, limits.year) else {
        return out.not_applicable(subject, "the magnetic model has no declination at this location");
    };
    let east_or_west = if declination > 0.0 { "east" } else { "west" };
    // The node adds the value to a yaw that increases counter-clockwise; magnetic north in the east makes that yaw too large.
    let needed = -declination;
    let measured = Measured::new("value in the file", written_deg, "deg").expected(needed);
    let near = |value: f64| (written_deg - value).abs() <= limits.agree_deg;
    if !near(needed) && near(-needed) && declination.abs() >= limits.least_deg {
        let message = format!("`{DECLINATION}` has the wrong sign: {written_deg:+.2} deg, expected {needed:+.2} deg");
        let detail = format!(
            "At {:.3}, {:.3} the declination is {:.2} deg {east_or_west} (World Magnetic Model). The node adds the value to a counter-clockwise yaw, \
             so west is positive.",
            position.0,
            position.1,
            declination.abs(),
        );
        let finding = Finding::warning(subject, message, place.clone())
            .likely()
            .detail(detail)
            .relation("sign")
            .help(format!(
                "write {:.5}, which is {needed:+.2} deg: {:.2} deg {east_or_west}",
                needed.to_radians(),
                declination.abs()
            ));
        let finding = finding.measured(measured);
        out.fail(match source {
            Some(source) => finding.related(source, "the position that was used"),
            None => finding,
        });
    } else {
        out.pass(subject, [measured]);
    }
}

/// Where the robot is: the datum of these settings, another file's origin, or a GNSS fix.
fn position(world: &World, settings: &LocalizationSettings) -> Option<((f64, f64), Option<Place>)> {
    let datum = settings.values.get("datum").and_then(|datum| {
        let mut numbers = datum.value.split_whitespace().map(|word| word.parse::<f64>().ok());
        Some(((numbers.next()??, numbers.next()??), Some(datum.place.clone())))
    });
    let origin = || {
        let mut origins = world.origins.iter();
        origins.find_map(|origin| {
            let [latitude, longitude] = origin.latitude_longitude_deg?;
            Some(((latitude, longitude), Some(origin.place.clone())))
        })
    };
    datum
        .or_else(origin)
        .or_else(|| crate::analysis::geo::fixes::some_position(world).map(|position| (position, None)))
}
