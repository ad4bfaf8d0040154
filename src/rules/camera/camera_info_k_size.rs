//! CAMERA02: intrinsics that contradict the image.

mod sizes;

use std::collections::BTreeMap;

use crate::analysis::camera::published::{Intrinsics, RecordedCamera};
use crate::rules::prelude::*;
use crate::world::{BagEvidence, camera::ImageForm};

pub(crate) struct CameraInfoKSize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    exact: f64,
    aspect: f64,
    least_centre: f64,
    most_centre: f64,
    least_view_deg: f64,
    most_view_deg: f64,
    same_ratio: f64,
    same_k: f64,
}

/// What to do where K is for an image that is so many times as large as this one.
fn rescale(times: f64, [width, height]: [f64; 2]) -> String {
    let size = format!("K and in P, with width = {width} and height = {height}");
    if times < 1.0 {
        return format!("multiply fx, fy, cx and cy by about {:.2} in {size}", 1.0 / times);
    }
    format!(
        "divide fx, fy, cx and cy by the size of the calibrated image / that of this image (about {times:.2}) in {size}; or, if the camera bins \
         pixels, keep K and P, write the size of the whole image into width and height, and the whole number {times:.0} into binning_x and \
         binning_y"
    )
}

impl Rule for CameraInfoKSize {
    const NEEDS: &'static [Need] = &[Need::CameraInfo];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let compared = sizes::judge(world, limits, out);
        let spaces: Vec<BTreeMap<&str, Namespace>> = world.bags.iter().map(spaces).collect();
        for published in RecordedCamera::all(world) {
            judge_k(&published.intrinsics(), &compared, limits, out);
            let space = spaces.get(published.index).and_then(|of| of.get(published.namespace()));
            let Some(space) = space.filter(|space| !space.images.is_empty()) else {
                continue;
            };
            if space.calibrations > 1 {
                let subject = format!("size of the images beside {}", published.subject());
                let why = "several calibrations share the namespace of these images: publish each camera in its own namespace";
                out.missing(subject, why);
                continue;
            }
            for (topic, form) in &space.images {
                judge_size(&published, topic, form, limits, out);
            }
        }
        for camera in Intrinsics::of_files(world) {
            judge_k(&camera, &compared, limits, out);
        }
    }
}

/// What a namespace holds: its images share its calibration (image_transport).
#[derive(Default)]
struct Namespace<'w> {
    /// Topics of calibrations.
    calibrations: usize,
    /// Forms of images, each with its topic.
    images: Vec<(&'w str, &'w ImageForm)>,
}

/// The namespaces of a recording.
fn spaces(bag: &BagEvidence) -> BTreeMap<&str, Namespace<'_>> {
    let mut spaces: BTreeMap<&str, Namespace> = BTreeMap::new();
    for topic in bag.topics.values() {
        let forms = topic.content.images.iter().flat_map(|images| &images.forms);
        let namespace = crate::analysis::camera::published::namespace(&topic.topic);
        let space = spaces.entry(namespace).or_default();
        space.calibrations += usize::from(topic.content.calibrations.is_some());
        space.images.extend(forms.map(|form| (topic.topic.as_str(), form)));
    }
    spaces
}

/// `compared`: the subjects of calibrations whose K is known to be for another size, each with that of the finding.
fn judge_k(published: &Intrinsics, compared: &BTreeMap<String, String>, limits: &Limits, out: &mut Judge) {
    let subject = published.subject.clone();
    let calibration = published.calibration;
    let k = &calibration.k;
    if published.is_uncalibrated() {
        let message = format!("K {} is all zeros: the camera is not calibrated", published.whose);
        let finding = Finding::note(&subject, message, published.place.clone()).relation("uncalibrated");
        return out.fail(finding.help("calibrate the camera, or project nothing into its images"));
    }
    let [fx, fy, cx, cy] = published.pinhole();
    if k.iter().any(|value| !value.is_finite()) || fx <= 0.0 || fy <= 0.0 {
        let message = format!("K {} has invalid focal lengths: {fx} and {fy} pixels", published.whose);
        let finding = Finding::error(&subject, message, published.place.clone());
        return out
            .fail(finding.help("write the calibrated numbers into K, with fx and fy (first and fifth) in pixels"));
    }
    if let Some(finding) = layout(published, &subject, limits) {
        return out.fail(finding);
    }
    let [width, height] = calibration.size.map(f64::from);
    if width == 0.0 || height == 0.0 {
        return out.missing(
            subject,
            "width and height are zero, so K cannot be compared with them: fill them in",
        );
    }
    let view_deg = 2.0 * (width / (2.0 * fx)).atan().to_degrees();
    let measured = [
        Measured::new("fx / fy", fx / fy, "1").limit(1.0 + limits.aspect),
        Measured::new("cx / width", cx / width, "1").expected(0.5),
        Measured::new("cy / height", cy / height, "1").expected(0.5),
    ];
    let view = Measured::new("horizontal field of view", view_deg, "deg");
    let view = if view_deg < limits.least_view_deg {
        view.at_least(limits.least_view_deg)
    } else {
        view.limit(limits.most_view_deg)
    };
    let is_central = |share: f64| (limits.least_centre..=limits.most_centre).contains(&share);
    let what = if !is_central(cx / width) || !is_central(cy / height) {
        Some(off_centre([cx, cy], [width, height], limits))
    } else if (fx / fy - 1.0).abs() > limits.aspect {
        let words = format!(
            ": focal lengths {fx:.1} and {fy:.1} differ by {:.0} %",
            100.0 * (fx / fy - 1.0).abs()
        );
        Some((
            words,
            "aspect",
            "if the image was stretched, scale fx or fy by the same factor; if not, calibrate again (pixels of nearly all cameras are square)"
                .to_owned(),
            Severity::Warning,
        ))
    } else if !(limits.least_view_deg..=limits.most_view_deg).contains(&view_deg) {
        let words = format!(": horizontal field of view of {view_deg:.1} deg is implausible");
        Some((
            words,
            "view",
            format!("write fx and fy in pixels, not in millimetres, for an image of {width} x {height} pixels"),
            Severity::Warning,
        ))
    } else {
        None
    };
    match what {
        None => out.pass(subject, measured.into_iter().chain([view])),
        Some((words, relation, help, severity)) => {
            let message = format!("K {}{words}", published.whose);
            let mut finding = Finding::warning(subject, message, published.place.clone()).likely();
            finding.severity = severity;
            let same_cause = compared.get(&published.subject).into_iter();
            let finding = same_cause.fold(finding, Finding::same_cause_as);
            let finding = match relation {
                "not-rescaled" => finding.detail(format!(
                    "cx, cy = {cx:.1}, {cy:.1} are expected near the centre of the image, {:.0}, {:.0}. The size that K is for is estimated from them.",
                    width / 2.0,
                    height / 2.0
                )),
                "view" => finding.measured(view),
                _ => finding,
            };
            let finding = finding.relation(relation).help(help);
            out.fail(finding.measured(measured));
        }
    }
}

/// Words, relation, help and severity for a principal point that is far from the centre of its image.
fn off_centre(
    [cx, cy]: [f64; 2],
    [width, height]: [f64; 2],
    limits: &Limits,
) -> (String, &'static str, String, Severity) {
    let (x, y) = (2.0 * cx / width, 2.0 * cy / height);
    let of_another = (x / y - 1.0).abs() <= limits.same_ratio * 10.0;
    if !of_another {
        let help = "set `roi` for a cropped image, and keep K of the whole image (REP-104)".to_owned();
        let words =
            format!(": principal point ({cx:.1}, {cy:.1}) is far from the centre of a {width} x {height} image");
        return (words, "centre", help, Severity::Warning);
    }
    let words = format!(
        " is probably for about {:.0} x {:.0} pixels, not {width} x {height} ({x:.2} times)",
        width * x,
        height * y
    );
    // No lens looks past its image.
    let severity = if x.max(y) > 2.0 {
        Severity::Error
    } else {
        Severity::Warning
    };
    (words, "not-rescaled", rescale(x, [width, height]), severity)
}

/// A finding where the numbers that must be zero or one are not.
fn layout(published: &Intrinsics, subject: &str, limits: &Limits) -> Option<Finding> {
    let [_, _, cx, k10, _, cy, k20, k21, k22] = published.calibration.k;
    let is = |value: f64, wanted: f64| (value - wanted).abs() <= limits.exact;
    if is(k10, 0.0) && is(k20, 0.0) && is(k21, 0.0) && is(k22, 1.0) {
        return None;
    }
    let is_transposed = is(k22, 1.0) && is(cx, 0.0) && is(cy, 0.0) && k20 > 0.0 && k21 > 0.0;
    let (relation, help) = if is_transposed {
        ("transposed", "write K row by row: fx, 0, cx, 0, fy, cy, 0, 0, 1")
    } else {
        (
            "not-a-camera-matrix",
            "write K row by row: fx, s, cx, 0, fy, cy, 0, 0, 1",
        )
    };
    let message = format!(
        "K {} is {}: it ends in {k20}, {k21}, {k22}, not 0, 0, 1",
        published.whose,
        if is_transposed {
            "transposed"
        } else {
            "no camera matrix"
        }
    );
    let finding = Finding::error(subject, message, published.place.clone())
        .relation(relation)
        .detail(format!(
            "Row by row, the last three numbers of K must be 0, 0, 1, and the fourth, {k10}, must be 0."
        ));
    let off = [k10, k20, k21, k22 - 1.0].map(f64::abs).into_iter().fold(0.0, f64::max);
    let measured = Measured::new("largest error of these four numbers", off, "1").limit(limits.exact);
    Some(finding.measured(measured).help(help))
}

/// Compares an image's size with the one that is calibrated.
fn judge_size(published: &RecordedCamera, topic: &str, form: &ImageForm, limits: &Limits, out: &mut Judge) {
    let calibration = published.calibration;
    let subject = format!("size of `{topic}` against {}", published.subject());
    let [_, _, roi_width, roi_height] = calibration.roi;
    let whole = roi_width == 0 || roi_height == 0;
    let shown = if whole {
        calibration.size
    } else {
        [roi_width, roi_height]
    };
    let binned = |index: usize| {
        let pixels = calibration.binning.get(index).copied().unwrap_or(0).max(1);
        f64::from(shown.get(index).copied().unwrap_or(0)) / f64::from(pixels)
    };
    let ([width, height], [image_width, image_height]) = ([binned(0), binned(1)], form.size.map(f64::from));
    if width == 0.0 || height == 0.0 || published.is_uncalibrated() {
        return out.missing(subject, "the calibration has no size, or the camera is not calibrated");
    }
    let (x, y) = (image_width / width, image_height / height);
    let measured = [
        Measured::new("width of the images / calibrated width", x, "1").expected(1.0),
        Measured::new("height of the images / calibrated height", y, "1").expected(1.0),
    ];
    // Binning leaves a pixel over.
    if (image_width - width).abs() < 1.0 && (image_height - height).abs() < 1.0 {
        return out.pass(subject, measured);
    }
    let (words, relation, help) = if (x / y - 1.0).abs() <= limits.same_ratio {
        (
            format!("The images were scaled by {x:.3}, and the calibration was not."),
            "not-rescaled",
            rescale(1.0 / x, [image_width, image_height]),
        )
    } else if (image_width - height).abs() < 1.0 && (image_height - width).abs() < 1.0 {
        (
            "The images were rotated by 90 deg, and the calibration was not.".to_owned(),
            "turned",
            "rotate the calibration and the optical frame with the image".to_owned(),
        )
    } else {
        (
            "The images show another part, or are of another camera.".to_owned(),
            "other-size",
            "set `roi` if the images are cropped; otherwise publish the calibration of the camera that makes these images".to_owned(),
        )
    };
    let message = format!(
        "images on `{topic}` have {image_width} x {image_height} pixels, but {width} x {height} are calibrated"
    );
    let place = Place::message(published.bag.source, form.at.clone());
    let finding = Finding::error(subject, message, place)
        .likely()
        .detail(format!(
            "Compared with the calibration on `{}`. {words}",
            published.topic
        ))
        .relation(relation)
        .related(published.place(), "the calibration")
        .help(help);
    out.fail(finding.measured(measured));
}
