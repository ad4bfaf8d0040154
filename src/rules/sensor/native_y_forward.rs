//! SENSOR04: lidars whose own axes have y forward, where drivers may rotate them.

use crate::advice::places::with_mounting;
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
        let why = "fields, topic and frame do not identify these as raw points of a lidar".to_owned();
        return no(NotEvaluated::NotApplicable, why, out);
    }
    let Some(lidar) = lidar(world, clouds) else {
        let why = "the model is unknown: topic, frame and fields of the points match no lidar in the tables".to_owned();
        return no(NotEvaluated::MissingInput, why, out);
    };
    if !has_two_ways(&lidar) {
        let why = format!("{} has y forward neither in the sensor nor in its driver", lidar.name);
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
                "the mounting is off by a yaw of {:.0} deg, which is not a quarter turn",
                yaw.off_deg
            );
            return no(NotEvaluated::NotApplicable, why, out);
        }
    };
    let mounting = format!("{}_from_{}", known.body, known.lidar);
    let (detail, help) = detail_and_help(&lidar, quarters, &mounting);
    let [seen, meant] = if quarters < 0 { ["y", "x"] } else { ["x", "y"] };
    let message = format!(
        "`{}`: clouds have {seen} forward, `{mounting}` expects {meant} forward ({:+.1} deg of yaw)",
        clouds.topic.topic, yaw.off_deg
    );
    let finding = Finding::error(subject, message, clouds.place())
        .likely()
        .unless(codes::CROSS04)
        .relation(if quarters > 0 { "z90" } else { "z-90" })
        .related(known.poses.1.clone(), "compared with this motion")
        .detail(format!("{detail} Compared with {}.", known.poses.0))
        .help(help);
    let mounting = [&known.body, &known.lidar];
    let finding = clouds.once_per_lidar(world, finding.measured(measured));
    out.fail(with_mounting(world, mounting, finding));
}

/// What a quarter turn means for this lidar, and what to do. Where a mounting lacks -90 deg, y of the cloud is forward.
fn detail_and_help(lidar: &Lidar, quarters: i8, mounting: &str) -> (String, String) {
    let name = &lidar.name;
    let turn = format!("add {:+} deg to the yaw of `{mounting}`", 90 * i16::from(quarters));
    match (lidar.driver, quarters < 0) {
        (Forward::X | Forward::XOrBack, true) => (
            format!(
                "Packets and the vendor's tools use the sensor's own axes, y forward; the ROS driver of {name} publishes x forward, and the mounting is made for that."
            ),
            format!("publish the clouds with the ROS driver (x = y, y = -x of the sensor's axes), or {turn}"),
        ),
        (Forward::X | Forward::XOrBack, false) => (
            format!(
                "The ROS driver of {name} publishes x forward; the mounting is made for the sensor's own axes, y forward."
            ),
            turn,
        ),
        (Forward::Y, true) => (
            format!("The driver of {name} publishes y forward; the mounting is made for x forward."),
            turn,
        ),
        (Forward::Y, false) => (
            format!(
                "The driver of {name} publishes y forward, and the mounting is made for that: something rotates the clouds a second time."
            ),
            format!("use the clouds as the driver publishes them, or {turn}"),
        ),
    }
}
