//! CAMERA03: distortion coefficients that do not match their model, or that fold within the image.

mod models;

use crate::analysis::camera::published::Intrinsics;
use crate::math::distortion::{RadialModel, Reach};
use crate::rules::prelude::*;

pub(crate) struct CameraInfoDistortion;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    tangential: f64,
    least_reach: f64,
    wide_deg: f64,
}

impl Rule for CameraInfoDistortion {
    const NEEDS: &'static [Need] = &[Need::CameraInfo];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for published in Intrinsics::all(world) {
            let subject = format!("distortion of {}", published.subject);
            if published.is_usable(&subject, out) {
                judge_model(&published, subject, limits, out);
            }
        }
        models::judge(world, out);
    }
}

/// The models of ROS, with the numbers of coefficients that OpenCV takes for each.
fn counts(model: &str) -> Option<&'static [usize]> {
    Some(match model {
        // OpenCV takes four as five without k3.
        "plumb_bob" => &[4, 5],
        // With thin prisms and a tilted sensor OpenCV has 12 and 14.
        "rational_polynomial" => &[8, 12, 14],
        "equidistant" | "fisheye" => &[4],
        _ => return None,
    })
}

/// The radial part of a model.
fn radial(model: &str, d: &[f64]) -> Option<RadialModel> {
    Some(match (model, d) {
        ("plumb_bob", [k1, k2, _, _]) => RadialModel::PlumbBob([*k1, *k2, 0.0]),
        ("plumb_bob", [k1, k2, _, _, k3]) => RadialModel::PlumbBob([*k1, *k2, *k3]),
        ("rational_polynomial", [k1, k2, _, _, k3, k4, k5, k6, ..]) => {
            RadialModel::Rational([*k1, *k2, *k3, *k4, *k5, *k6])
        }
        ("equidistant" | "fisheye", [k1, k2, k3, k4]) => RadialModel::Fisheye([*k1, *k2, *k3, *k4]),
        _ => return None,
    })
}

fn judge_model(published: &Intrinsics, subject: String, limits: &Limits, out: &mut Judge) {
    let (model, d) = (published.calibration.model.as_str(), published.calibration.d.as_slice());
    let whose = &published.whose;
    if d.iter().any(|value| !value.is_finite()) {
        let message = format!("a coefficient of the distortion {whose} is not finite");
        let finding = Finding::error(subject, message, published.place.clone());
        return out.fail(finding.help("calibrate the camera again"));
    }
    if d.is_empty() && matches!(model, "" | "plumb_bob") {
        let why = "it has no model and no coefficients: an image without distortion, or a camera without calibration";
        return out.missing(subject, why);
    }
    let Some(counts) = counts(model) else {
        let why = format!("the model `{model}` is not a ROS model (plumb_bob, rational_polynomial, equidistant)");
        return out.not_applicable(subject, why);
    };
    if !counts.contains(&d.len()) {
        return out.fail(miscounted(published, subject, counts));
    }
    let Some(radial) = radial(model, d) else {
        return;
    };
    let (Some((border, what)), true) = (
        border(published),
        published.calibration.size.iter().all(|pixels| *pixels > 0),
    ) else {
        return out.missing(
            subject,
            "width and height are zero, so the corners are not known: fill them in",
        );
    };
    let Some(reach) = radial.reach(border) else {
        return out.too_little(subject, "the distortion has no finite value within the image");
    };
    let tangential = match d {
        [_, _, p1, p2, ..] if !is_fisheye(model) => p1.abs().max(p2.abs()),
        _ => 0.0,
    };
    let measured = |reach: Reach| match reach {
        Reach::Whole { angle_rad } => Measured::new(format!("view angle at the {what}"), angle_rad.to_degrees(), "deg"),
        Reach::Folds { radius, .. } => Measured::new(
            format!("radius of the fold / radius of the {what}"),
            radius / border,
            "1",
        )
        .at_least(limits.least_reach),
    };
    if let Reach::Folds { radius, angle_rad } = reach
        && radius < limits.least_reach * border
    {
        let message = format!(
            "distortion {whose} folds back {:.1} deg from the axis, {:.0} % of the way to the {what}",
            angle_rad.to_degrees(),
            100.0 * radius / border
        );
        let help = format!(
            "calibrate again with the board in the corners of the image too, or with a model for wider angles; until then drop points beyond \
             {:.1} deg",
            angle_rad.to_degrees()
        );
        let finding = Finding::warning(subject, message, published.place.clone())
            .likely()
            .detail("Points farther from the axis are projected back into the image.")
            .relation("folds");
        return out.fail(finding.measured(measured(reach)).help(help));
    }
    if tangential > limits.tangential {
        let message =
            format!("a tangential coefficient {whose} is {tangential:.3}: k3 is probably written before p1 and p2");
        let finding = Finding::warning(subject, message, published.place.clone())
            .hint()
            .detail("Tangential coefficients of lenses are a few thousandths.")
            .relation("order");
        let measured = Measured::new("largest tangential coefficient", tangential, "1").limit(limits.tangential);
        return out.fail(
            finding
                .measured(measured)
                .help("write the coefficients in the order k1, k2, p1, p2, k3"),
        );
    }
    let [fx, _, cx, _] = published.pinhole();
    let across = [cx, f64::from(published.calibration.size[0]) - cx].map(|side| radial.reach(side / fx));
    let view_deg: f64 = across
        .iter()
        .map(|side| match side {
            Some(Reach::Whole { angle_rad }) => angle_rad.to_degrees(),
            _ => 0.0,
        })
        .sum();
    if model == "plumb_bob" && view_deg > limits.wide_deg {
        return out.fail(too_wide(published, subject, view_deg, limits));
    }
    out.pass(
        subject,
        [
            measured(reach),
            Measured::new("horizontal field of view", view_deg, "deg"),
        ],
    );
}

fn too_wide(published: &Intrinsics, subject: String, view_deg: f64, limits: &Limits) -> Finding {
    let message = format!(
        "the model {} is plumb_bob, but a view of {view_deg:.0} deg is too wide for plumb_bob",
        published.whose
    );
    Finding::warning(subject, message, published.place.clone())
        .likely()
        .detail("The polynomial of plumb_bob is in the tangent of the angle, and is not constrained at such angles.")
        .relation("wide")
        .measured(Measured::new("horizontal field of view", view_deg, "deg").limit(limits.wide_deg))
        .help("calibrate with the model rational_polynomial or equidistant")
}

/// The radius up to which a model must be valid, normalised, and its name: the corner farthest from the principal point. The image
/// of a fisheye is round, and its corners are often dark: there it is the nearest edge.
fn border(published: &Intrinsics) -> Option<(f64, &'static str)> {
    let [fx, fy, cx, cy] = published.pinhole();
    let [width, height] = published.calibration.size.map(f64::from);
    let border = if is_fisheye(&published.calibration.model) {
        let nearest = [cx / fx, (width - cx) / fx, cy / fy, (height - cy) / fy];
        (nearest.into_iter().fold(f64::INFINITY, f64::min), "nearest edge")
    } else {
        let (x, y) = (cx.max(width - cx) / fx, cy.max(height - cy) / fy);
        (x.hypot(y), "corner")
    };
    Some(border).filter(|(radius, _)| radius.is_finite())
}

fn is_fisheye(model: &str) -> bool {
    matches!(model, "equidistant" | "fisheye")
}

fn miscounted(published: &Intrinsics, subject: String, counts: &[usize]) -> Finding {
    let (model, d) = (&published.calibration.model, &published.calibration.d);
    let several: Vec<String> = counts.iter().map(usize::to_string).collect();
    let other = ["plumb_bob", "rational_polynomial"]
        .into_iter()
        .find(|other| other != model && self::counts(other).is_some_and(|counts| counts.contains(&d.len())));
    let message = format!(
        "the model {} is {model} ({} coefficients), but there are {}",
        published.whose,
        several.join(" or "),
        d.len()
    );
    let detail = other.map_or(String::new(), |other| {
        format!("The model {other} has that many coefficients.")
    });
    Finding::error(subject, message, published.place.clone())
        .detail(detail)
        .relation("count")
        .measured(Measured::count("coefficients", d.len()))
        .help("write the model that was calibrated, with all coefficients of that model")
}
