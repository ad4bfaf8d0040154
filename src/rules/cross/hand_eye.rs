//! CROSS05: a mounting transform compared with the one that the motions of lidar and body determine.

use crate::advice::{places::with_mounting, scale::wrong_scale};
use crate::analysis::cross::hand_eye::{Limits, corrected, other_scale, solved};
use crate::analysis::hand_eye::{HandEye, in_plane};
use crate::analysis::lidar::Clouds;
use crate::math::planar_hand_eye::PlanarMount;
use crate::rules::prelude::*;
use crate::world::{FrameId, World};

pub(crate) struct HandEyeCalibration;

/// What is judged of each lidar.
const SCALE: &str = "scale of the platform's poses by the scans";
const YAW: &str = "yaw of the mounting";
const PLACE: &str = "place of the mounting";

impl Rule for HandEyeCalibration {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "mounting", out);
        for clouds in Clouds::scanners(world) {
            let known = HandEye::of(world, &clouds, |steps| {
                steps.chained_to_the_end(|moved| {
                    moved.turned_rad().abs().to_degrees() >= limits.long_deg || moved.lasted_s() >= limits.long_s
                })
            });
            match known.and_then(|known| Ok((solved(&known, limits)?, known))) {
                Ok((mounted, known)) => {
                    judge_scale(&clouds, &known, &mounted, limits, out);
                    match other_scale(&known, &mounted, limits) {
                        None => judge_mounted(world, (&clouds, &known), &mounted, limits, out),
                        Some(why) => {
                            for part in [YAW, PLACE] {
                                out.too_little(clouds.subject(part), why.clone());
                            }
                        }
                    }
                }
                Err((reason, why)) => {
                    for part in [SCALE, YAW, PLACE] {
                        out.not_evaluated(clouds.subject(part), reason, why.clone());
                    }
                }
            }
        }
    }
}

/// Judges whether poses and scans move equally far.
fn judge_scale(clouds: &Clouds, known: &HandEye, found: &PlanarMount, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject(SCALE);
    let (off, error) = ((found.scale - 1.0).abs(), found.scale_sigma);
    let measured = Measured::new(
        "metres of the poses for a metre of the scans, minus 1",
        found.scale - 1.0,
        "1",
    )
    .limit(limits.max_scale)
    .spread(error)
    .samples(found.pairs as u64);
    // A fit whose residuals are as large as the motion shows no scale: noise makes it too small, and tilting is no motion in a plane.
    if found.residual_m > limits.max_residual * found.way_m {
        let why = format!(
            "with any scale the motions of a pair, of {:.2} m, differ by {:.2} m: they are not accurate enough, or not in one plane",
            found.way_m, found.residual_m
        );
        return out.too_little(subject, why);
    }
    if off <= limits.max_scale && error <= limits.max_scale {
        return out.pass(subject, [measured]);
    }
    if off <= limits.max_scale.max(limits.sigmas * error) {
        let why = format!("{:.2} +- {error:.2}: not accurate enough to decide", found.scale);
        return out.too_little(subject, why);
    }
    let scans = format!("the scans on `{}`", clouds.topic.topic);
    let finding = wrong_scale(
        (subject, known.poses.1.clone()),
        (&known.poses.0, &scans),
        1.0 / found.scale,
        limits.max_scale,
    );
    let finding = finding.related(clouds.place(), "scans");
    out.fail(
        finding
            .measured(measured)
            .unless_relation(codes::AXES07)
            .unless(codes::TIME07),
    );
}

/// An error of a mounting with its standard error; its limit, and the standard error up to which it is judged.
struct MountingError {
    subject: String,
    measured: Measured,
    size: f64,
    sigma: f64,
    limit: f64,
    sure: f64,
}

impl MountingError {
    fn is_beyond(&self, limits: &Limits) -> bool {
        self.sigma <= self.sure && self.size > self.limit.max(limits.sigmas * self.sigma)
    }

    /// Passes one that is not beyond its limit, if that is certain.
    fn judge(self, limits: &Limits, out: &mut Judge) {
        let is_sure = |sigmas: f64| sigmas * self.sigma <= self.limit;
        if self.size <= self.limit && is_sure(1.0) || is_sure(limits.sigmas) {
            return out.pass(self.subject, [self.measured]);
        }
        let why = format!(
            "{} {:.2} +- {:.2} {unit}, {} {unit} are allowed: not accurate enough to decide; record more turns",
            self.measured.what,
            self.size,
            self.sigma,
            self.limit,
            unit = self.measured.unit
        );
        out.too_little(self.subject, why);
    }
}

fn judge_mounted(
    world: &World,
    (clouds, known): (&Clouds, &HandEye),
    found: &PlanarMount,
    limits: &Limits,
    out: &mut Judge,
) {
    let published = known.stated.translation.vector.xy();
    let off = found.place - published;
    let [sigma_yaw, sigma_x, sigma_y] = found.sigma;
    let (yaw_deg, sigma_deg, sigma_m) = (
        found.yaw_rad.to_degrees(),
        sigma_yaw.to_degrees(),
        sigma_x.hypot(sigma_y),
    );
    let error = |part, measured: Measured, [sigma, limit, sure]: [f64; 3]| MountingError {
        subject: clouds.subject(part),
        size: measured.value.abs(),
        measured: measured.limit(limit).spread(sigma).samples(found.pairs as u64),
        sigma,
        limit,
        sure,
    };
    let of_yaw = Measured::new("yaw missing in the mounting", yaw_deg, "deg").turn();
    let yaw = error(YAW, of_yaw, [sigma_deg, limits.max_yaw_deg, limits.sure_yaw_deg]);
    let of_place = Measured::new("position error of the mounting", off.norm(), "m");
    let place = error(PLACE, of_place, [sigma_m, limits.max_place_m, limits.sure_place_m]);
    let (turned, moved) = (yaw.is_beyond(limits), place.is_beyond(limits));
    let (subject, measured, what) = match (turned, moved) {
        (false, false) => {
            yaw.judge(limits, out);
            return place.judge(limits, out);
        }
        (true, false) => {
            place.judge(limits, out);
            let what = format!("is missing a yaw of {yaw_deg:+.1} deg");
            (yaw.subject, vec![yaw.measured], what)
        }
        (false, true) => {
            yaw.judge(limits, out);
            let what = format!("is off by {:.2} m", off.norm());
            (place.subject, vec![place.measured], what)
        }
        (true, true) => {
            out.not_applicable(yaw.subject, "reported with the position of the mounting");
            let what = format!(
                "is missing a yaw of {yaw_deg:+.1} deg, and is off by {:.2} m",
                off.norm()
            );
            (place.subject, vec![yaw.measured, place.measured], what)
        }
    };
    let by = format!(
        "the motions of the scans on `{}` and of {}",
        clouds.topic.topic, known.poses.0
    );
    let detail = if moved {
        format!(
            "By {by} the lidar is at x = {:.2} m, y = {:.2} m; the transform states x = {:.2} m, y = {:.2} m.",
            found.place.x, found.place.y, published.x, published.y
        )
    } else {
        format!("Measured by {by}.")
    };
    let inverse = known.stated.inverse();
    let is_inverse = in_plane(&(inverse * inverse)).rotation.angle().to_degrees().abs() <= limits.forward_deg
        && (found.place - inverse.translation.vector.xy()).norm() <= limits.sure_place_m.max(limits.sigmas * sigma_m);
    let (relation, detail) = if turned && !moved {
        let quarters = [("z90", 90.0), ("z-90", -90.0), ("z180", 180.0), ("z180", -180.0)];
        let is_near = |deg: f64| (yaw_deg - deg).abs() <= limits.forward_deg.max(limits.sigmas * sigma_deg);
        let quarter = quarters.into_iter().find(|(_, deg)| is_near(*deg));
        (quarter.map_or("yaw", |(word, _)| word), detail)
    } else if is_inverse {
        ("inverse", format!("{detail} Its inverse states that place."))
    } else {
        ("moved", detail)
    };
    let inverted = if relation == "inverse" {
        "is probably inverted: it "
    } else {
        ""
    };
    let message = format!("`{}_from_{}` {inverted}{what}", known.body, known.lidar);
    let finding = Finding::warning(subject, message, clouds.place())
        .likely()
        .relation(relation)
        .detail(detail)
        .related(known.poses.1.clone(), "motion of the body")
        .help(help(&known.body, relation, (turned && !moved).then_some(yaw_deg)))
        .prefers(
            known.body.to_string(),
            known.lidar.to_string(),
            corrected(known, found, moved),
        )
        .unless(codes::TIME07);
    // AXES12 reports a large rotation better: by the direction of the x axis.
    let finding = if yaw_deg.abs() > limits.forward_deg {
        finding.unless(codes::AXES12).unless(codes::CROSS04)
    } else {
        finding
    };
    out.fail(with_mounting(
        world,
        [&known.body, &known.lidar],
        clouds.once_per_lidar(world, finding.measured(measured)),
    ));
}

/// What to do about a mounting that misses a yaw alone, or about another one.
fn help(body: &FrameId, relation: &str, yaw_deg: Option<f64>) -> String {
    let first = match yaw_deg {
        Some(deg) => format!("add {deg:+.1} deg of yaw (about z of `{body}`) to the transform, or "),
        None if relation == "inverse" => "invert the transform, or ".to_owned(),
        None => String::new(),
    };
    format!("{first}calibrate the mounting again; motion in a plane does not determine roll, pitch and height")
}
