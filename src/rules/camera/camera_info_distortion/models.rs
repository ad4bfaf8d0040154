//! Equal coefficients under two models.

use crate::analysis::camera::published::Intrinsics;
use crate::rules::prelude::*;
use crate::world::World;

use super::is_fisheye;

/// Compares the models of calibrations with equal coefficients: those of a fisheye mean angles, the others tangents.
pub(super) fn judge(world: &World, out: &mut Judge) {
    let usable = |camera: &Intrinsics| {
        let d = &camera.calibration.d;
        d.iter().take(4).any(|value| *value != 0.0) && d.iter().all(|value| !value.is_nan())
    };
    // By the bits of the coefficients, without zeros at the end.
    let key = |camera: &Intrinsics| -> Vec<u64> {
        let d = camera.calibration.d.as_slice();
        let end = d.iter().rposition(|value| *value != 0.0).map_or(0, |last| last + 1);
        d.iter().take(end).map(|value| (value + 0.0).to_bits()).collect()
    };
    let mut cameras: Vec<(Vec<u64>, Intrinsics)> = Intrinsics::all(world)
        .filter(usable)
        .map(|camera| (key(&camera), camera))
        .collect();
    cameras.sort_by(|(a, _), (b, _)| a.cmp(b));
    for ((a, one), (b, other)) in cameras.iter().zip(cameras.iter().skip(1)) {
        if a == b {
            judge_pair(one, other, out);
        }
    }
}

fn judge_pair(a: &Intrinsics, b: &Intrinsics, out: &mut Judge) {
    let model = |camera: &Intrinsics| camera.calibration.model.clone();
    let is_of_fisheye = |camera: &Intrinsics| is_fisheye(&camera.calibration.model);
    let (wrong, right) = if is_of_fisheye(a) { (b, a) } else { (a, b) };
    let subject = format!("model of {} against {}", wrong.subject, right.subject);
    let equal = Measured::count("equal coefficients", right.calibration.d.len());
    if is_of_fisheye(a) == is_of_fisheye(b) || model(wrong).is_empty() {
        return out.pass(subject, [equal]);
    }
    let message = format!(
        "the coefficients {} are of {}, not of {}, by another calibration",
        wrong.whose,
        model(right),
        model(wrong)
    );
    let finding = Finding::error(subject, message, wrong.place.clone())
        .likely()
        .relation("model")
        .detail(format!("The other one is the {}.", right.subject))
        .detail("Coefficients of an equidistant lens are factors of the angle, those of plumb_bob of its tangent: far from the axis they differ by many pixels.")
        .related(right.place.clone(), "the same coefficients, of another model")
        .help(format!(
            "write `{}` where the camera was calibrated so, and undistort with that model (OpenCV: cv::fisheye)",
            model(right)
        ))
        .measured(equal);
    out.fail(finding);
}
