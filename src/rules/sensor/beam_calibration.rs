//! SENSOR11: calibrations of the beams of a lidar compared with the published angles of its model.

mod angles;
mod counts;
mod packets;

use crate::analysis::beams::{BeamFit, Numbering, fit, numbering};
use crate::rules::prelude::*;
use crate::world::BeamCalibration;

pub(crate) struct BeamAngles;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(clippy::struct_field_names, reason = "all of them are maxima")]
pub(crate) struct Limits {
    max_elevation_deg: f64,
    max_azimuth_deg: f64,
    max_resolution_percent: f64,
}

impl Rule for BeamAngles {
    const NEEDS: &'static [Need] = &[Need::Beams];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut models = Vec::new();
        for file in &world.beams {
            let path = world.path(file.place.source);
            counts::judge(file, path, out);
            let is_whole = file.broken.is_none() && matches!(numbering(file), Numbering::Whole);
            let fit = fit(file).filter(|_| is_whole);
            if is_whole {
                angles::judge(file, path, fit.as_ref(), limits, out);
            } else {
                let why = "the beams are not numbered one after another, or lack numbers";
                out.missing(format!("elevations in {path}"), why);
            }
            resolution(file, path, fit.as_ref(), limits, out);
            models.push((file, fit.filter(|fit| fit.off_deg[0] <= limits.max_elevation_deg)));
        }
        packets::judge(world, &models, out);
    }
}

/// The unit of distances compared with that of the packets of the model, or of all models with as many beams.
fn resolution(file: &BeamCalibration, path: &str, fit: Option<&BeamFit>, limits: &Limits, out: &mut Judge) {
    let Some(stated) = &file.resolution_m else { return };
    let subject = format!("`distance_resolution` in {path}");
    let of_model = fit
        .filter(|fit| fit.off_deg[0] <= limits.max_elevation_deg)
        .map(|fit| fit.model);
    let mut sized = crate::analysis::beams::sized(file);
    let model = of_model.or_else(|| sized.next().filter(|_| sized.next().is_none()));
    let Some(model) = model else {
        return out.missing(subject, "the model is unknown, for no known one has these elevations");
    };
    let Some(known) = model.resolution_m else {
        let why = format!(
            "the driver does not take the distances of a {} from its calibration",
            model.name
        );
        return out.not_applicable(subject, why);
    };
    let percent = (stated.value / known - 1.0).abs() * 100.0;
    let measured = [
        Measured::new("distance resolution", stated.value, "m").expected(known),
        Measured::new("difference from that of the model", percent, "%").limit(limits.max_resolution_percent),
    ];
    if percent <= limits.max_resolution_percent {
        return out.pass(subject, measured);
    }
    let message = format!(
        "`{path}`: `distance_resolution` is {} m, but packets of a {} have {known} m",
        stated.value, model.name
    );
    let detail = format!(
        "All distances are {:.2} times as long as they are.",
        stated.value / known
    );
    let finding = Finding::error(subject, message, stated.place.clone())
        .likely()
        .relation("resolution");
    let help = format!("set `distance_resolution: {known}`, or use the calibration of this sensor");
    out.fail(finding.detail(detail).help(help).measured(measured));
}
