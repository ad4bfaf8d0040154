//! One camera matrix for images of two sizes.

use std::collections::BTreeMap;

use crate::analysis::camera::published::Intrinsics;
use crate::rules::prelude::*;
use crate::world::World;

use super::{Limits, rescale};

/// Compares the sizes of calibrations with equal camera matrices. The subjects of the wrong ones, each with that of its comparison.
pub(super) fn judge(world: &World, limits: &Limits, out: &mut Judge) -> BTreeMap<String, String> {
    let usable = |camera: &Intrinsics| {
        let sizes = camera.calibration.size.iter();
        camera.pinhole().iter().all(|value| *value > 0.0) && sizes.copied().all(|pixels| pixels > 0)
    };
    let mut cameras: Vec<Intrinsics> = Intrinsics::all(world).filter(usable).collect();
    cameras.sort_by(|a, b| a.pinhole()[0].total_cmp(&b.pinhole()[0]));
    let pairs = cameras.iter().zip(cameras.iter().skip(1));
    let have_one_k = |(a, b): &(&Intrinsics, &Intrinsics)| {
        let mut sides = a.pinhole().into_iter().zip(b.pinhole());
        sides.all(|(a, b)| (a / b - 1.0).abs() <= limits.same_k)
    };
    pairs
        .filter(have_one_k)
        .filter_map(|(a, b)| judge_pair(a, b, limits, out))
        .collect()
}

fn judge_pair(a: &Intrinsics, b: &Intrinsics, limits: &Limits, out: &mut Judge) -> Option<(String, String)> {
    let size = |camera: &Intrinsics| camera.calibration.size.map(f64::from);
    // How far the principal point is from the centre, as a share of the image.
    let off = |camera: &Intrinsics| {
        let ([_, _, cx, cy], [width, height]) = (camera.pinhole(), size(camera));
        (cx / width - 0.5).hypot(cy / height - 0.5)
    };
    let (wrong, right) = if off(a) > off(b) { (a, b) } else { (b, a) };
    let subject = format!("size of {} against {}", wrong.subject, right.subject);
    let ([width, height], [right_width, right_height]) = (size(wrong), size(right));
    let (x, y) = (right_width / width, right_height / height);
    let measured = [
        Measured::new("width with the same K / width", x, "1").expected(1.0),
        Measured::new("height with the same K / height", y, "1").expected(1.0),
    ];
    if (x - 1.0).abs() <= limits.same_ratio && (y - 1.0).abs() <= limits.same_ratio {
        out.pass(subject, measured);
        return None;
    }
    if (x / y - 1.0).abs() > limits.same_ratio {
        let why = "both have the same K, and sizes in another ratio: one may be a part of the other";
        out.not_applicable(subject, why);
        return None;
    }
    let message = format!(
        "K {} is for {right_width} x {right_height} pixels, not {width} x {height}: another calibration has the same K",
        wrong.whose
    );
    let finding = Finding::error(&subject, message, wrong.place.clone())
        .likely()
        .relation("not-rescaled")
        .detail(format!(
            "The other one is the {}. Of the two, this principal point is farther from the centre of its image.",
            right.subject
        ))
        .related(right.place.clone(), "the same K, for images of another size")
        .help(rescale(x, [width, height]))
        .measured(measured);
    out.fail(finding);
    Some((wrong.subject.clone(), subject))
}
