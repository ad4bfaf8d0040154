//! The elevations and azimuths of the beams. Part of SENSOR11.

use super::Limits;
use crate::analysis::beams::{BeamFit, Written, sized, steepest};
use crate::verdict::{Finding, Judge, Measured};
use crate::world::BeamCalibration;

/// No beam points farther up or down, degrees.
const STEEPEST_DEG: f64 = 90.0;

pub(super) fn judge(file: &BeamCalibration, path: &str, fit: Option<&BeamFit>, limits: &Limits, out: &mut Judge) {
    let subject = format!("elevations in {path}");
    let [meant, other] = if file.is_radians {
        ["radians", "degrees"]
    } else {
        ["degrees", "radians"]
    };
    let error = |relation, message, help: &str| {
        let finding = Finding::error(format!("elevations in {path}"), message, file.place.clone());
        finding
            .likely()
            .relation(relation)
            .help(help)
            .detail("All points are computed with these angles.")
    };
    let unit = || {
        let message = format!("`{path}`: the angles are in {other}, but the driver takes them as {meant}");
        error("unit", message, &format!("convert the angles to {meant}"))
    };
    let Some(fit) = fit else {
        let steepest = steepest(file).map_or(0.0, |steepest| steepest.0);
        let measured = [Measured::new("steepest beam", steepest, "deg").limit(STEEPEST_DEG)];
        if steepest.abs() > STEEPEST_DEG {
            return out.fail(unit().measured(measured));
        }
        if let Some(model) = sized(file).next() {
            let why = format!("the angles of a {} differ from sensor to sensor", model.name);
            return out.not_applicable(subject, why);
        }
        let why = format!("{} has no known model with {} beams", file.maker, file.beams.len());
        return out.missing(subject, why);
    };
    let name = fit.model.name;
    let [off, read_off] = fit.off_deg;
    let is_known = off <= limits.max_elevation_deg;
    let what = format!("largest difference from the elevations of a {name}");
    let measured = [Measured::new(what, read_off, "deg").limit(limits.max_elevation_deg)];
    if read_off <= limits.max_elevation_deg {
        out.pass(subject, measured);
        return azimuths(file, path, fit, limits, out);
    }
    let finding = match fit.written {
        Written::OtherUnit if is_known => unit(),
        Written::UpsideDown if is_known => {
            let message = format!("`{path}`: the elevations are those of a {name} with the other sign: upside down");
            error(
                "upside-down",
                message,
                "change the sign of all elevations, not the order",
            )
        }
        Written::Backwards if is_known => {
            let message = format!("`{path}`: the elevations are those of a {name} from the last beam to the first");
            error("backwards", message, "reverse the order of the beams")
        }
        _ => {
            let message = format!("`{path}`: elevations of no known {}, by {off:.1} deg", file.maker);
            let finding = Finding::warning(subject, message, file.place.clone())
                .hint()
                .relation("unexplained");
            let detail = "Compared with all models with as many beams: as written, with the other sign, in reverse and in other units.";
            finding
                .detail(detail)
                .help("compare the elevations with the manual of the sensor")
        }
    };
    out.fail(finding.measured(measured));
}

/// Azimuths count clockwise in the calibrations of both makers.
fn azimuths(file: &BeamCalibration, path: &str, fit: &BeamFit, limits: &Limits, out: &mut Judge) {
    let subject = format!("azimuths in {path}");
    let name = fit.model.name;
    let Some([off, mirrored]) = fit.azimuth_off_deg else {
        return out.missing(subject, format!("the azimuths of a {name} are not known"));
    };
    let what = format!("largest difference from the azimuths of a {name}");
    let measured = [
        Measured::new(what, off, "deg").limit(limits.max_azimuth_deg),
        Measured::new("the same with the other sign", mirrored, "deg"),
    ];
    if off <= limits.max_azimuth_deg {
        return out.pass(subject, measured);
    }
    let is_mirrored = mirrored <= limits.max_azimuth_deg;
    let finding = if is_mirrored {
        let message = format!("`{path}`: the azimuths are those of a {name} with the other sign");
        let finding = Finding::error(subject, message, file.place.clone())
            .likely()
            .relation("mirrored");
        finding
            .detail("Azimuths of beams count clockwise as seen from above.")
            .help("change the sign of all azimuths")
    } else {
        let message = format!("`{path}`: the azimuths differ from those of a {name} by up to {off:.1} deg");
        let finding = Finding::warning(subject, message, file.place.clone())
            .hint()
            .relation("unexplained");
        finding
            .detail("They are not mirrored either.")
            .help("compare the azimuths with the manual of the sensor")
    };
    out.fail(finding.measured(measured));
}
