//! The number of beams, and their numbers. Part of SENSOR11.

use crate::analysis::beams::{Numbering, numbering};
use crate::verdict::{Finding, Judge, Measured};
use crate::world::BeamCalibration;

/// Every beam has its number once, and there are as many as the file says.
pub(super) fn judge(file: &BeamCalibration, path: &str, out: &mut Judge) {
    let subject = format!("beams in {path}");
    let count = file.beams.len();
    let mut measured = Measured::count("beams", count);
    if let Some(stated) = &file.stated {
        measured = measured.expected(stated.value);
    }
    let (relation, message, place, detail) = if let Some(place) = &file.broken {
        let message = format!("`{path}`: a beam lacks its number or an angle");
        ("not-a-number", message, place, "The driver does not read the file.")
    } else if let Numbering::Twice(beam) = numbering(file) {
        let message = format!("`{path}`: beam {} is there twice", beam.id);
        let detail = "The driver takes the last one, and another beam has no angles: it looks straight ahead.";
        ("duplicate-id", message, &beam.place, detail)
    } else if let Numbering::Missing(id) = numbering(file) {
        let message = format!("`{path}`: beam {id} is missing");
        (
            "missing-id",
            message,
            &file.place,
            "A beam without angles looks straight ahead.",
        )
    } else {
        let other = file
            .stated
            .as_ref()
            .filter(|stated| (stated.value - count as f64).abs() > 0.5);
        let Some(stated) = other else {
            return out.pass(subject, [measured]);
        };
        let message = format!(
            "`{path}`: `num_lasers` is {}, but {count} lasers are listed",
            stated.value
        );
        let detail = "The driver reads as many as `num_lasers` says: fewer are ignored, more are a fault.";
        ("count", message, &stated.place, detail)
    };
    let finding = Finding::error(subject, message, place.clone())
        .likely()
        .relation(relation);
    let help = "take the calibration from the sensor or its vendor again";
    out.fail(finding.detail(detail).help(help).measured([measured]));
}
