//! CROSS05: a mounting transform compared with the one that the motions of lidar and body determine.

use crate::analysis::cross::hand_eye::{Limits, at_place, solved};
use crate::analysis::hand_eye::{HandEye, in_plane};
use crate::analysis::lidar::Clouds;
use crate::math::planar_hand_eye::PlanarMount;
use crate::rules::prelude::*;

pub(crate) struct HandEyeCalibration;

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
                Ok((mounted, known)) => judge_mounted(&clouds, &known, &mounted, limits, out),
                Err((reason, why)) => out.not_evaluated(clouds.subject("place of the mounting"), reason, why),
            }
        }
    }
}

fn judge_mounted(clouds: &Clouds, known: &HandEye, found: &PlanarMount, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("place of the mounting");
    let published = known.stated.translation.vector.xy();
    let off = found.place - published;
    let [sigma_yaw, sigma_x, sigma_y] = found.sigma;
    let (yaw_deg, sigma_deg, sigma_m) = (
        found.yaw_rad.to_degrees(),
        sigma_yaw.to_degrees(),
        sigma_x.hypot(sigma_y),
    );
    let measured = [
        Measured::new("yaw that the mounting lacks", yaw_deg, "deg")
            .turn()
            .limit(limits.max_yaw_deg)
            .spread(sigma_deg)
            .samples(found.pairs as u64),
        Measured::new("position error of the mounting", off.norm(), "m")
            .limit(limits.max_place_m)
            .spread(sigma_m),
    ];
    let turned = yaw_deg.abs() > limits.max_yaw_deg.max(limits.sigmas * sigma_deg);
    let moved = off.norm() > limits.max_place_m.max(limits.sigmas * sigma_m);
    if !turned && !moved {
        let is_sure = |sigmas: f64| sigmas * sigma_deg <= limits.max_yaw_deg && sigmas * sigma_m <= limits.max_place_m;
        let is_within = yaw_deg.abs() <= limits.max_yaw_deg && off.norm() <= limits.max_place_m;
        if is_within && is_sure(1.0) || is_sure(limits.sigmas) {
            return out.pass(subject, measured);
        }
        let why = format!(
            "the mounting is off by {:.1} deg and {:.2} m with standard errors of {sigma_deg:.1} deg and {sigma_m:.2} m: not accurate \
             enough to decide; record a drive with more turns",
            yaw_deg.abs(),
            off.norm()
        );
        return out.too_little(subject, why);
    }
    let what = match (turned, moved) {
        (true, true) => format!("lacks a yaw of {yaw_deg:+.1} deg, and is {:.2} m off", off.norm()),
        (true, false) => format!("lacks a yaw of {yaw_deg:+.1} deg"),
        _ => format!("is {:.2} m off", off.norm()),
    };
    let message = format!("`{}_from_{}` {what}", known.body, known.lidar);
    let detail = format!(
        "The motions of the scans on `{}` and of {} put the lidar at x = {:.2} m, y = {:.2} m; the transform states {:.2} m, {:.2} m.",
        clouds.topic.topic, known.poses.0, found.place.x, found.place.y, published.x, published.y
    );
    let inverse = known.stated.inverse();
    let is_inverse = in_plane(&(inverse * inverse)).rotation.angle().to_degrees().abs() <= limits.forward_deg
        && (found.place - inverse.translation.vector.xy()).norm() <= limits.sure_place_m.max(limits.sigmas * sigma_m);
    let (relation, detail) = if turned && !moved {
        let quarters = [("z90", 90.0), ("z-90", -90.0), ("z180", 180.0), ("z180", -180.0)];
        let is_near = |deg: f64| (yaw_deg - deg).abs() <= limits.forward_deg.max(limits.sigmas * sigma_deg);
        let quarter = quarters.into_iter().find(|(_, deg)| is_near(*deg));
        (quarter.map_or("yaw", |(word, _)| word), detail)
    } else if is_inverse {
        (
            "inverse",
            format!("{detail} The inverse of the transform has it there: it is probably inverted."),
        )
    } else {
        ("moved", detail)
    };
    let finding = Finding::warning(subject, message, clouds.place())
        .likely()
        .relation(relation)
        .detail(detail)
        .related(known.poses.1.clone(), "motion of the body")
        .help("calibrate the mounting again; motion in a plane does not determine roll, pitch and height")
        .prefers(known.body.to_string(), known.lidar.to_string(), at_place(known, found))
        .unless(codes::TIME07);
    // AXES12 reports a large rotation better: by the direction of the x axis.
    let finding = if yaw_deg.abs() > limits.forward_deg {
        finding.unless(codes::AXES12).unless(codes::CROSS04)
    } else {
        finding
    };
    out.fail(finding.measured(measured));
}
