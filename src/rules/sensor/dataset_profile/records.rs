//! Records of a dataset that name no frames: their quaternions compared with the sensors of the dataset. Part of SENSOR10.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::tables::{Dataset, QuaternionWord};
use crate::verdict::Judge;
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::{Claim, FrameId, NamedDataset, Spelling, World};

use crate::analysis::sensor::dataset::{Limits, rotation};

/// Judges the records of tables such as `calibrated_sensor.json`, and returns their number.
pub(crate) fn judge(world: &World, dataset: &NamedDataset, limits: &Limits, out: &mut Judge) -> usize {
    // Such tables are read as w, x, y, z.
    if dataset.row.quaternion != Some(QuaternionWord::Wxyz) {
        return 0;
    }
    let mut count = 0;
    let is_named = |claim: &Claim| {
        let frames = claim.frames.as_ref();
        let is_known = |frame: &FrameId| dataset.row.frame(frame.as_str()).is_some();
        frames.is_some_and(|(target, source)| is_known(target) && is_known(source))
    };
    for claim in world.claims.iter().filter(|claim| claim.is_row() && !is_named(claim)) {
        let Spelling::Quaternion { xyzw, .. } = &claim.spelling else {
            continue;
        };
        count += 1;
        judge_record(world, dataset, (claim, *xyzw), limits, out);
    }
    count
}

fn judge_record(
    world: &World,
    dataset: &NamedDataset,
    (claim, xyzw): (&Claim, [f64; 4]),
    limits: &Limits,
    out: &mut Judge,
) {
    let row = &*dataset.row;
    let subject = format!("`{}` in {}", claim.label, world.path(claim.place.source));
    let [x, y, z, w] = xyzw;
    let unit = |w: f64, x: f64, y: f64, z: f64| UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9);
    // As read; and with the four slots of the file taken in the other order.
    let (Some(read), Some(other)) = (unit(w, x, y, z), unit(z, w, x, y)) else {
        return out.not_evaluated(subject, NotEvaluated::InputBroken, "its quaternion has zero norm");
    };
    let [off, other_off] = [read, other].map(|turn| tilt_deg(&turn, row));
    let word = "w, x, y, z";
    let measured = [
        Measured::new(
            format!("tilt against the nearest sensor of {}, read as {word}", row.name),
            off,
            "deg",
        )
        .limit(limits.max_off_deg),
        Measured::new(
            format!("tilt against the nearest sensor of {}, read as x, y, z, w", row.name),
            other_off,
            "deg",
        ),
    ];
    if off <= limits.max_off_deg && other_off <= limits.max_off_deg {
        let why = format!(
            "its tilt matches a sensor of {} in both orders of its quaternion",
            row.name
        );
        return out.too_little(subject, why);
    }
    if off <= limits.max_off_deg {
        return out.pass(subject, measured);
    }
    if other_off > limits.max_off_deg {
        let why = format!(
            "its tilt matches no sensor of {} in either order of its quaternion",
            row.name
        );
        return out.too_little(subject, why);
    }
    let message = format!(
        "entry `{}`: quaternion is not in the order {word} of {} (tilt {off:.0} deg off)",
        claim.label, row.name
    );
    let finding = Finding::error(subject, message, claim.place.clone())
        .likely()
        .relation("quaternion-order")
        .detail("Read as x, y, z, w, the tilt matches a sensor of the dataset.")
        .help(format!("write the quaternion as {word}"));
    out.fail(finding.measured(measured));
}

/// The angle between up of the vehicle and up of the sensor of the dataset with the most similar tilt.
fn tilt_deg(vehicle_from_sensor: &UnitQuaternion<f64>, row: &Dataset) -> f64 {
    let up = vehicle_from_sensor.inverse() * Vector3::z();
    let tilts = row.frames.iter().map(|frame| {
        let of_frame = rotation(&frame.axes).inverse() * Vector3::z();
        up.angle(&of_frame).to_degrees()
    });
    tilts.fold(180.0, f64::min)
}
