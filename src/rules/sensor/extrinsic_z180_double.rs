//! SENSOR03: the half turn between an Ouster's two frames is missing or applied twice; or TF repeats a transform that a driver applies.

mod twice_applied;

use std::f64::consts::PI;

use nalgebra::Isometry3;

use crate::analysis::landmarks::{Grid, Maps, maps};
use crate::analysis::sensor::lidar_turn::{Edge, Origin};
use crate::analysis::{hand_eye::half_turn, lidar::Clouds, ouster, ouster::Axes, sensor::lidar_turn};
use crate::math::rotation::xyzw_in_words;
use crate::rules::{prelude::*, sensor::extrinsic_z180_double::twice_applied::Limits};
use crate::world::FrameId;

pub(crate) struct ExtrinsicZ180Double;

/// Whether the mounting of an Ouster lacks half a turn, and the evidence.
struct HalfTurnTest {
    is_turned: bool,
    body: FrameId,
    lidar: FrameId,
    poses: (String, Place),
    measured: Vec<Measured>,
}

impl Rule for ExtrinsicZ180Double {
    const NEEDS: &'static [Need] = &[Need::TransformsOrBag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets_of(world, "half turns of the mounting", |lidar| lidar.name == "Ouster", out);
        for clouds in Clouds::all(world).filter(|clouds| ouster::is_of_an_ouster(world, clouds)) {
            let subject = clouds.subject("half turns of the mounting");
            match look(world, &clouds, limits) {
                Ok(test) if test.is_turned => report(world, &clouds, subject, test, limits, out),
                Ok(test) => out.pass(subject, test.measured),
                Err((why, reason)) => out.not_evaluated(subject, why, reason),
            }
        }
        twice_applied::judge(world, limits, out);
    }
}

/// By the motion of the scans, and by landmarks; where both decide, they must agree.
fn look(world: &Estimates, clouds: &Clouds, limits: &Limits) -> Result<HalfTurnTest, (NotEvaluated, String)> {
    let of_yaw = world.limits::<crate::analysis::axes::forward::Limits>();
    let by_way = crate::analysis::axes::forward::look(world, clouds, &of_yaw);
    let by_landmarks = by_landmarks(world, clouds, limits);
    let landmarks = by_landmarks
        .as_ref()
        .ok()
        .and_then(|(maps, ratio)| decided(*ratio, limits).map(|is| (is, maps, *ratio)));
    match by_way {
        Ok((yaw, known)) => {
            let is_turned = match yaw.quarters(&of_yaw) {
                Some(0) => false,
                Some(2 | -2) => true,
                _ => {
                    let why = format!(
                        "the mounting is off by a yaw of {:.0} deg, which is not half a turn",
                        yaw.off_deg
                    );
                    return Err((NotEvaluated::NotApplicable, why));
                }
            };
            if landmarks.is_some_and(|(other, ..)| other != is_turned) {
                let why = format!(
                    "by the motion of the scans the mounting is off by a yaw of {:.0} deg, but landmarks contradict that",
                    yaw.off_deg
                );
                return Err((NotEvaluated::TooLittleEvidence, why));
            }
            let mut measured: Vec<Measured> = yaw.measured(&of_yaw).into();
            measured.extend(landmarks.map(|(_, maps, ratio)| crispness(maps, ratio, limits)));
            Ok(HalfTurnTest {
                is_turned,
                body: known.body,
                lidar: known.lidar,
                poses: known.poses,
                measured,
            })
        }
        // A mirror image, or a lidar that is upside down: landmarks cannot decide that either.
        Err((NotEvaluated::NotApplicable, reason)) => Err((NotEvaluated::NotApplicable, reason)),
        Err((why, reason)) => {
            let Some((is_turned, maps, ratio)) = landmarks else {
                let more = match by_landmarks {
                    Err((_, other)) if other != reason => format!("; {other}"),
                    Ok((_, ratio)) => format!(
                        "; by landmarks, the map with the lidar turned by 180 deg has {ratio:.2} times the size ({} or its inverse is needed)",
                        limits.min_ratio
                    ),
                    Err(_) => String::new(),
                };
                return Err((why, reason + &more));
            };
            let lidar = clouds.frame().ok_or_else(|| (why, reason.clone()))?;
            Ok(HalfTurnTest {
                is_turned,
                body: maps.body.clone(),
                lidar,
                poses: maps.poses.clone(),
                measured: vec![crispness(maps, ratio, limits)],
            })
        }
    }
}

/// The number of cells of the map with another half turn, relative to as published.
fn by_landmarks(world: &Estimates, clouds: &Clouds, limits: &Limits) -> Result<(Maps, f64), (NotEvaluated, String)> {
    let grid = Grid {
        cell_m: limits.cell_m,
        level_m: limits.level_m,
        way_m: limits.min_way_m,
    };
    let maps = maps(world, clouds, &[Isometry3::identity(), half_turn()], &grid)?;
    let [stated, turned] = maps.cells[..] else {
        return Err((NotEvaluated::TooLittleEvidence, "no landmarks".to_owned()));
    };
    if stated == 0 || turned == 0 {
        return Err((
            NotEvaluated::TooLittleEvidence,
            "no points are level with the sensor".to_owned(),
        ));
    }
    let ratio = turned as f64 / stated as f64;
    Ok((maps, ratio))
}

/// Whether the half turn is missing, where the ratio of the maps decides that.
fn decided(ratio: f64, limits: &Limits) -> Option<bool> {
    if ratio >= limits.min_ratio {
        Some(false)
    } else {
        (ratio <= 1.0 / limits.min_ratio).then_some(true)
    }
}

fn crispness(maps: &Maps, ratio: f64, limits: &Limits) -> Measured {
    Measured::new(
        format!(
            "cells of the map (fewer: sharper) with the lidar rotated by 180 deg / as mounted, {:.0} m driven",
            maps.way_m
        ),
        ratio,
        "1",
    )
    .at_least(limits.min_ratio)
}

fn report(world: &Estimates, clouds: &Clouds, subject: String, test: HalfTurnTest, limits: &Limits, out: &mut Judge) {
    let edges = lidar_turn::edges(world, &test.body, &test.lidar);
    let is_half =
        |edge: &&Edge| edge.pose.rotation.angle_to(&half_turn().rotation).to_degrees() <= limits.max_half_off_deg;
    let is_own = |edge: &&Edge| {
        let axes = [&edge.parent, &edge.child].map(Axes::of);
        axes.iter().all(Option::is_some) && axes[0] != axes[1]
    };
    let own = edges.iter().filter(is_own).find(|edge| is_half(edge));
    let mounting = edges.iter().find(|edge| !is_own(edge));
    let (relation, what, other) = match (own, lidar_turn::axes(world, clouds)) {
        (Some(own), _) => (
            "z180-twice",
            format!(
                "The half turn of an Ouster is applied twice: the mounting contains the half turn (made with clouds in the Lidar \
                 frame), and `{}` -> `{}` applies the half turn again",
                own.parent, own.child
            ),
            "",
        ),
        (None, Some(Axes::Lidar)) => (
            "z180-missing",
            "The clouds are expressed in the Lidar frame (x towards the connector), but the mounting was made for the Sensor frame".to_owned(),
            "Sensor",
        ),
        (None, Some(Axes::Sensor)) => (
            "z180-extra",
            "The clouds are expressed in the Sensor frame (x away from the connector), but the mounting was made for the Lidar frame".to_owned(),
            "Lidar",
        ),
        (None, None) => (
            "z180",
            "Of the Lidar and the Sensor frame, the clouds are expressed in one, and the mounting was made for the other".to_owned(),
            "other",
        ),
    };
    let direction = crate::analysis::cross::direction::direction_fit(world, clouds);
    let mounted = world.graph().chain(&test.body, &test.lidar, |edge| edge.is_rigid);
    let or = mounted.map_or("", |(pose, _)| {
        crate::analysis::cross::direction::doubt(direction.as_ref(), &pose, PI, limits.max_half_off_deg.to_radians())
    });
    let message = format!(
        "`{}` -> `{}` is rotated by 180 deg about z, compared with {}",
        test.body, test.lidar, test.poses.0
    );
    let mut finding = Finding::error(subject, message, clouds.place())
        .likely()
        .relation(relation)
        .unless(codes::CROSS04)
        .related(test.poses.1.clone(), "motion that the clouds are compared with")
        .detail(format!("{what}{or}."));
    if let Some(edge) = mounting.or(edges.first()) {
        let right = edge.pose * half_turn();
        let or = if other.is_empty() {
            String::new()
        } else {
            format!(
                "; or publish the clouds in the {other} frame (ouster-ros: `point_cloud_frame`), but do not do both"
            )
        };
        finding = finding.help(format!(
            "rotate `{}` -> `{}` by 180 deg about z of `{}`: the new rotation is x y z w = {}; keep the translation{or}",
            edge.parent,
            edge.child,
            edge.child,
            xyzw_in_words(&right.rotation, 6)
        ));
        let mut known = world.graph().edges_to(&edge.child);
        let stated = known.find(|known| known.parent == edge.parent);
        if let Some(place) = stated.and_then(|stated| crate::analysis::places::of_edge(world, stated)) {
            finding = finding.related(place, format!("`{}` -> `{}`", edge.parent, edge.child));
        }
    }
    let finding = match lidar_turn::half_turn(world, clouds, &test.body, &test.lidar) {
        Some(Origin::OusterFrame) => finding.unless(codes::SENSOR01),
        Some(Origin::OusterTf) => finding.unless_about(codes::SENSOR02, format!("`{}`", test.lidar)),
        _ => finding,
    };
    out.fail(finding.measured(test.measured));
}
