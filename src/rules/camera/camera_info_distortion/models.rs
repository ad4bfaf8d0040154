//! Equal coefficients under two models.

use crate::analysis::camera::published::Intrinsics;
use crate::rules::prelude::*;
use crate::world::World;

use super::is_fisheye;

/// Compares the models of calibrations with equal coefficients: those of a fisheye mean angles, the others tangents.
pub(super) fn judge(world: &World, out: &mut Judge) {
    let usable = |camera: &Intrinsics| camera.calibration.d.iter().take(4).any(|value| *value != 0.0);
    let mut cameras: Vec<Intrinsics> = Intrinsics::all(world).filter(usable).collect();
    let key = |camera: &Intrinsics| -> Vec<f64> {
        let mut key = camera.calibration.d.clone();
        while key.last() == Some(&0.0) {
            key.pop();
        }
        key
    };
    let order = |a: &[f64], b: &[f64]| {
        a.iter()
            .map(|value| value.to_bits())
            .cmp(b.iter().map(|value| value.to_bits()))
    };
    cameras.sort_by(|a, b| order(&key(a), &key(b)));
    for (a, b) in cameras
        .iter()
        .zip(cameras.iter().skip(1))
        .filter(|(a, b)| key(a) == key(b))
    {
        judge_pair(a, b, out);
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
