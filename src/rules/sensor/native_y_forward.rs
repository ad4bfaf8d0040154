//! SENSOR04: lidars whose own axes have y forward, beside drivers that turn them.

use crate::analysis::lidar::Clouds;
use crate::analysis::sensor::lidar_turn::{has_two_ways, lidar};
use crate::rules::prelude::*;
use crate::tables::{Forward, Lidar};

pub(crate) struct NativeYForward;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_off_deg: f64,
}

impl Rule for NativeYForward {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets_of(world, "axes", has_two_ways, out);
        for clouds in Clouds::all(world) {
            judge_clouds(world, &clouds, limits, out);
        }
    }
}

fn judge_clouds(world: &Estimates, clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("axes");
    let no = |why: NotEvaluated, reason: String, out: &mut Judge| out.not_evaluated(&subject, why, reason);
    if !clouds.is_of_a_lidar() {
        let why = "nothing says that these are the points of a lidar as it measured them".to_owned();
        return no(NotEvaluated::NotApplicable, why, out);
    }
    let Some(lidar) = lidar(world, clouds) else {
        let why = "neither topic, frame nor layout of the points tell a lidar that the tables know".to_owned();
        return no(NotEvaluated::MissingInput, why, out);
    };
    if !has_two_ways(&lidar) {
        let why = format!(
            "{} has no y forward, neither in the sensor nor in its driver",
            lidar.name
        );
        return no(NotEvaluated::NotApplicable, why, out);
    }
    let of_yaw = world.limits::<crate::analysis::axes::forward::Limits>();
    let (yaw, known) = match crate::analysis::axes::forward::look(world, clouds, &of_yaw) {
        Ok(seen) => seen,
        Err((why, reason)) => return no(why, reason, out),
    };
    let measured = yaw.measured(&of_yaw);
    let quarters = match yaw.quarters(&of_yaw) {
        Some(0) => return out.pass(subject, measured),
        Some(quarters @ (1 | -1)) if (yaw.off_deg - 90.0 * f64::from(quarters)).abs() <= limits.max_off_deg => quarters,
        _ => {
            let why = format!(
                "the mounting lacks a yaw of {:.0} deg, which is no quarter turn",
                yaw.off_deg
            );
            return no(NotEvaluated::NotApplicable, why, out);
        }
    };
    let (what, help) = told(&lidar, quarters, &format!("{}_from_{}", known.body, known.lidar));
    let message = format!(
        "the clouds on `{}` are {what}: `{}_from_{}` lacks a yaw of {:+.1} deg beside {}",
        clouds.topic.topic, known.body, known.lidar, yaw.off_deg, known.poses.0
    );
    let finding = Finding::error(subject, message, clouds.place())
        .likely()
        .unless(codes::CROSS04)
        .relation(if quarters > 0 { "z90" } else { "z-90" })
        .related(known.poses.1.clone(), "where it went")
        .help(help);
    out.fail(finding.measured(measured));
}

/// What a quarter turn means for this lidar, and what to do. A mounting that lacks -90 deg has y of the cloud forward.
fn told(lidar: &Lidar, quarters: i8, mounting: &str) -> (String, String) {
    let name = &lidar.name;
    let turn = format!("turn `{mounting}` by {} deg about z", 90 * i16::from(quarters));
    match (lidar.driver, quarters < 0) {
        (Forward::X | Forward::XOrBack, true) => (
            format!(
                "expressed in the axes of the sensor itself, y forward, as packets and the vendor's tools have them; the ROS driver of {name} has x forward, and the mounting is made for that"
            ),
            format!("publish the clouds with the ROS driver (x = y, y = -x of the sensor's axes), or {turn}"),
        ),
        (Forward::X | Forward::XOrBack, false) => (
            format!(
                "told with x forward, as the ROS driver of {name} has them, and the mounting is made for the axes of the sensor itself, y forward"
            ),
            format!("{turn}: what the manual shows as y is x of these clouds"),
        ),
        (Forward::Y, true) => (
            format!("told with y forward, as the driver of {name} leaves them, and the mounting is made for x forward"),
            turn,
        ),
        (Forward::Y, false) => (
            format!(
                "told with x forward, where the driver of {name} leaves y forward, and the mounting is made for that: something turns them twice"
            ),
            format!("take the clouds as the driver publishes them, or {turn}"),
        ),
    }
}
