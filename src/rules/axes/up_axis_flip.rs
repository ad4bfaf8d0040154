//! AXES10: a cloud whose ground is not opposite to up.

use std::rc::Rc;

use nalgebra::Vector3;

use crate::analysis::ground::{Ground, Limits, Planes, SIDES};
use crate::analysis::motion::{Imu, Motion, Stream};
use crate::analysis::{ground, lidar::Clouds, motion::mount::mount};
use crate::math::{stats::median, support_plane::open_above};
use crate::rules::prelude::*;
use crate::verdict::SeenPlane;
use crate::world::{FrameId, World, cloud::CloudSample};

pub(crate) struct UpAxisFlip;

impl Rule for UpAxisFlip {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "up", out);
        let (motion, planes) = (Motion::of(world), Planes::of(world));
        for clouds in Clouds::all(world) {
            let subject = clouds.subject("up");
            if !clouds.is_of_a_lidar() {
                out.not_applicable(
                    subject,
                    "not recognised as raw points of a lidar by its fields, topic or frame",
                );
                continue;
            }
            let by_cloud = planes.grounds_by_cloud(&clouds, &limits.is_ground());
            let grounds: Vec<Ground> = by_cloud.iter().map(|(_, ground)| *ground).collect();
            match limits.agreed(&clouds, &grounds) {
                Ok(side) => {
                    out.planes(&subject, || ground_planes(world, &clouds, &by_cloud, side));
                    judge_side(world, &motion, &clouds, (side, &grounds), limits, out);
                }
                Err(why) => out.too_little(subject, why),
            }
        }
    }
}

/// The ground planes on one side, each in its cloud.
fn ground_planes(world: &World, clouds: &Clouds, grounds: &[(usize, Ground)], side: usize) -> Vec<SeenPlane> {
    let sensor = ground::sensor_in_cloud(world, clouds).unwrap_or_else(Vector3::zeros);
    let of_side = grounds.iter().filter(|(_, ground)| ground.side == side);
    let plane = |(index, ground): &(usize, Ground)| {
        let normal = ground.plane.normal;
        Some(SeenPlane {
            topic: clouds.topic.topic.clone(),
            log_ns: clouds.evidence.samples.get(*index)?.at.log_ns,
            normal,
            offset_m: normal.dot(&sensor) - ground.plane.height_m,
        })
    };
    of_side.filter_map(plane).collect()
}

fn judge_side(
    world: &World,
    motion: &Rc<Motion>,
    clouds: &Clouds,
    (side, grounds): (usize, &[Ground]),
    limits: &Limits,
    out: &mut Judge,
) {
    let Some((axis, word)) = SIDES.get(side) else { return };
    let axis = Vector3::from(*axis);
    let subject = clouds.subject("up");
    let frame = clouds.frame();
    let mount = frame.as_ref().and_then(|frame| mount(world, frame));
    let in_base = mount
        .as_ref()
        .map_or(axis, |mount| mount.base_from_sensor.rotation * axis);
    let off_deg = in_base.angle(&Vector3::z()).to_degrees();
    let of_side = || grounds.iter().filter(|ground| ground.side == side);
    let Some(least) = of_side().min_by(|a, b| a.score.total_cmp(&b.score)) else {
        return;
    };
    let (_, min_score) = limits.is_ground().least(&least.plane);
    let next = of_side().map(|ground| ground.next).fold(0.0, f64::max);
    let angle = format!("angle between {word} and up, by the transforms");
    let measured = [
        Measured::new(angle, off_deg, "deg").limit(limits.max_off_deg),
        Measured::new(
            "evidence for this ground (grid cells on the plane, fewer if points are below the plane)",
            least.score,
            "1",
        )
        .at_least(min_score)
        .samples(of_side().count() as u64),
        Measured::new("the same evidence for the next best direction", next, "1"),
    ];
    if off_deg <= limits.max_off_deg {
        return out.pass(subject, measured);
    }
    let has_ceiling = of_side().any(|ground| ground.ceiling_cells >= limits.ceiling_cells);
    let is_closed = has_ceiling || open_share(clouds, &axis, limits).is_none_or(|share| share < limits.min_open);
    let is_indoors = is_closed && !is_under_open_sky(motion, clouds, limits);
    let gravity = frame
        .as_ref()
        .and_then(|frame| gravity(world, motion, clouds.index, frame));
    let gravity = gravity.map(|(up, who)| (up.dot(&axis), who));
    let has_gravity = gravity.as_ref().is_some_and(|(along, _)| *along >= limits.min_gravity);
    let against = gravity
        .filter(|(along, _)| *along <= -limits.min_gravity)
        .map(|(_, who)| who);
    let is_opposite = off_deg > 180.0 - limits.max_off_deg;
    let (relation, what, help) = named(word, is_opposite);
    // The axis that is up, or down: without a sign.
    let (axis_word, way, opposite) = match word.strip_prefix('-') {
        Some(axis) => (axis, "down", "up"),
        None => (*word, "up", "down"),
    };
    let but = match (&mount, &frame) {
        (Some(mount), _) if mount.is_base => format!("but `{}` is a base with z up", mount.base),
        (Some(mount), Some(frame)) if is_opposite => {
            format!("but `{}` -> `{frame}` has {axis_word} {opposite}", mount.base)
        }
        (Some(mount), Some(frame)) => {
            format!(
                "but `{}` -> `{frame}` has {axis_word} {off_deg:.0} deg from {way}",
                mount.base
            )
        }
        _ => match &against {
            Some(who) => format!("but the accelerometer of {who} shows {axis_word} {opposite}"),
            None => "but z must point up (REP-103)".to_owned(),
        },
    };
    let message = format!(
        "`{}`: ground in the cloud shows {axis_word} {way}, {but}",
        clouds.topic.topic
    );
    let is_known = mount.is_some() || against.is_some();
    let untied = if is_known {
        ""
    } else {
        " No transform connects the frame of the cloud with a base."
    };
    let ground = word.strip_prefix('-').map_or_else(|| format!("-{word}"), str::to_owned);
    let detail = format!("The points show the ground in the direction of {ground}: {what}.{untied}");
    let finding = if is_known {
        Finding::error(subject, message, clouds.place())
    } else {
        Finding::warning(subject, message, clouds.place())
    };
    // A ceiling looks like a ground from below: under open sky there is none, and gravity distinguishes the two.
    let finding = if !is_known || is_indoors && !has_gravity {
        finding.hint()
    } else {
        finding.likely()
    };
    let finding = finding.relation(relation).detail(detail).help(help);
    out.fail(clouds.once_per_lidar(world, finding.measured(measured)));
}

/// Share of the directions in which the highest beams hit nothing while others do; median over the clouds. `None` if no beam points
/// up.
fn open_share(clouds: &Clouds, up: &Vector3<f64>, limits: &Limits) -> Option<f64> {
    let of_cloud = |sample: &CloudSample| {
        let points: Vec<Vector3<f64>> = sample.points.iter().map(|point| point.xyz.into()).collect();
        open_above(
            &points,
            up,
            limits.top_deg.to_radians(),
            limits.min_top_deg.to_radians(),
        )
    };
    median(&clouds.evidence.samples.iter().filter_map(of_cloud).collect::<Vec<_>>())
}

/// Whether most clouds were measured while a GNSS receiver had a fix.
fn is_under_open_sky(motion: &Motion, clouds: &Clouds, limits: &Limits) -> bool {
    let (Some(bag), Some(start_ns)) = (motion.bags.get(clouds.index), clouds.bag.start_ns) else {
        return false;
    };
    let has_fix = |sample: &&CloudSample| {
        let t_s = sample.at.log_ns.saturating_sub(start_ns) as f64 * 1e-9;
        let mut rows = bag.fixes.iter().flat_map(Stream::rows);
        rows.any(|fix| (fix.t_s - t_s).abs() <= limits.fix_s)
    };
    let samples = &clouds.evidence.samples;
    2 * samples.iter().filter(has_fix).count() > samples.len()
}

/// Up in the axes of the cloud, by the inertial sensor that the fewest rigid transforms tie to its frame.
fn gravity(world: &World, motion: &Motion, bag: usize, frame: &FrameId) -> Option<(Vector3<f64>, String)> {
    let imus = &motion.bags.get(bag)?.imus;
    let of = |imu: &Imu| {
        let own = imu.stream.frame.as_ref()?;
        let (cloud_from_imu, steps) = world.graph().chain(frame, own, |edge| edge.is_rigid)?;
        let forces = imu
            .stream
            .rows()
            .map(|timed| Vector3::from(timed.row.linear_acceleration));
        let force: Vector3<f64> = forces.filter(|force| force.iter().all(|value| value.is_finite())).sum();
        let up = cloud_from_imu.rotation * force.try_normalize(1e-9)?;
        Some((steps.len(), up, imu.stream.subject.clone()))
    };
    let nearest = imus.iter().filter_map(of).min_by_key(|(steps, ..)| *steps);
    nearest.map(|(_, up, who)| (up, who))
}

/// Relation, description and help for a cloud with this side up, which may be down by the transforms.
fn named(side: &str, is_opposite: bool) -> (&'static str, &'static str, &'static str) {
    match side {
        "z" => (
            "mount",
            "the cloud itself has z up",
            if is_opposite {
                "correct the rotation of the mounting transform so that z points up: if the driver already turns the points of an upside-down sensor, the transform must not turn them again"
            } else {
                "correct roll or pitch of the mounting transform so that z points up: look for a rotation to optical axes, or a sideways mounting, that the points do not have"
            },
        ),
        "-z" => (
            "x180",
            "z points down",
            "look at the sensor:\n(1) if the sensor hangs upside down, add a roll of 180 deg to its mounting transform (or a pitch of 180 deg: the ground does not show which)\n(2) if the sensor stands upright, switch off the option of the driver that turns the points upside down",
        ),
        "-y" => (
            "optical",
            "y points down, as in an optical frame",
            "convert the cloud to x forward, y left, z up, or rotate its frame by RPY(-90, 0, -90) deg, as an optical frame",
        ),
        "y" => (
            "y-up",
            "y points up, as in graphics",
            "rotate the cloud by 90 deg about x: z points up (REP-103)",
        ),
        _ => (
            "on-its-side",
            "x points up or down",
            "compare the mounting with its transform: the sensor is on its side",
        ),
    }
}
