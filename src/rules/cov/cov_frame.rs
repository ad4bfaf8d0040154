//! COV04: covariances that are expressed in other axes than their message defines.

mod pairs;

mod limits;

use crate::analysis::cov::declared::{Axes, StreamCovariance, each};
use crate::analysis::{cov::noise::Noise, motion::Stream};
use crate::rules::{cov::cov_frame::limits::Limits, prelude::*};
use crate::world::motion::PoseRow;

pub(crate) struct CovFrame;

impl Rule for CovFrame {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        each(world, "pose.covariance", |_, stream, declared| {
            judge_pose(stream, declared, limits, out);
        });
        each(world, "twist.covariance", |_, stream, declared| {
            judge_twist(stream, declared, limits, out);
        });
        crate::rules::cov::cov_frame::pairs::judge(world, limits, out);
    }
}

/// How the axes of a stream's covariances rotate, or why that is unknown.
fn axes(declared: &StreamCovariance<'_>, limits: &Limits) -> Result<Axes, String> {
    if declared.samples.is_empty() {
        return Err("every covariance is all zeros, or not finite".to_owned());
    }
    let Some(axes) = declared.axes() else {
        return Err("no covariance of x and y is a valid ellipse, or the yaw is unknown".to_owned());
    };
    if axes.stretch < limits.min_stretch {
        return Err(format!(
            "the ellipse of x and y has no direction (axis ratio {:.2}, {} is needed)",
            axes.stretch, limits.min_stretch
        ));
    }
    if axes.spread < limits.min_spread {
        return Err(format!(
            "the yaw hardly changes (spread {:.2}, {} is needed): world and body axes cannot be distinguished",
            axes.spread, limits.min_spread
        ));
    }
    if !declared.is_constant() && (axes.count as f64) < limits.min_matrices {
        return Err(format!(
            "{} different matrices, {} are needed",
            axes.count, limits.min_matrices
        ));
    }
    Ok(axes)
}

fn measured(axes: &Axes, limits: &Limits) -> [Measured; 3] {
    let n = axes.count as u64;
    [
        Measured::new(
            "direction of the long axis as published, agreement of the directions",
            axes.constant,
            "1",
        )
        .samples(n),
        Measured::new(
            "direction of the long axis minus the yaw, agreement of the directions",
            axes.less_yaw,
            "1",
        )
        .samples(n),
        Measured::new("ratio of the axes", axes.stretch, "1").at_least(limits.min_stretch),
    ]
}

fn judge_twist(stream: &Stream<PoseRow>, declared: &StreamCovariance<'_>, limits: &Limits, out: &mut Judge) {
    let subject = format!("axes of `twist.covariance` on {}", stream.subject);
    let little = NotEvaluated::TooLittleEvidence;
    if declared.is_constant() {
        return out.not_applicable(
            subject,
            "one constant matrix in all messages: hard-coded numbers do not rotate",
        );
    }
    let axes = match axes(declared, limits) {
        Ok(axes) => axes,
        Err(why) => return out.not_evaluated(subject, little, why),
    };
    let measured = measured(&axes, limits);
    if axes.constant > limits.along {
        return out.pass(subject, measured);
    }
    if axes.less_yaw <= limits.along || axes.constant >= limits.across {
        let why = format!(
            "its longer axis is constant neither as published nor minus the yaw ({:.2} and {:.2}, {} is needed)",
            axes.constant, axes.less_yaw, limits.along
        );
        return out.not_evaluated(subject, little, why);
    }
    let message = format!(
        "`{}`: `twist.covariance` is expressed in world axes, not in the child frame",
        stream.topic
    );
    let finding = Finding::warning(subject, message, stream.place())
        .likely()
        .relation("in-world")
        .unless(codes::AXES08)
        .detail("The long axis of its ellipse keeps its direction in the world and rotates in the child frame, in which the velocity is expressed (an agreement of 1 is a constant direction).")
        .help("publish it in the child frame: `C_body = R^T C_world R` for both 3x3 blocks, with `R` the orientation of the pose");
    out.fail(finding.measured(measured));
}

fn judge_pose(stream: &Stream<PoseRow>, declared: &StreamCovariance<'_>, limits: &Limits, out: &mut Judge) {
    let subject = format!("axes of `pose.covariance` on {}", stream.subject);
    let little = |why: String, out: &mut Judge| out.too_little(&subject, why);
    let axes = match axes(declared, limits) {
        Ok(axes) => axes,
        Err(why) => return little(why, out),
    };
    let noise = Noise::of(stream, declared.topic);
    let Some((fixed, body)) = noise.ellipses().filter(|_| noise.count() as f64 >= limits.min_poses) else {
        let why = format!(
            "{} evenly spaced poses to measure the noise from, {} are needed",
            noise.count(),
            limits.min_poses
        );
        return little(why, out);
    };
    let scale = axes.trace / fixed.trace;
    if !(1.0 / limits.scale..=limits.scale).contains(&scale) {
        let why = format!(
            "it states {scale:.2e} times the variance of the noise from pose to pose (a factor of {} is allowed): a filtered estimate \
             hides the direction of its error",
            limits.scale
        );
        return little(why, out);
    }
    let (with_body, with_world) = (
        body.stretch >= limits.min_stretch && fixed.stretch <= limits.round,
        fixed.stretch >= limits.min_stretch && body.stretch <= limits.round,
    );
    let (body_differs, world_differs) = (
        axes.less_yaw > limits.along && axes.constant < limits.across,
        axes.constant > limits.along && axes.less_yaw < limits.across,
    );
    let all = measured(&axes, limits).into_iter().chain([
        Measured::new("noise, longer over shorter axis in the frame", fixed.stretch, "1").samples(noise.count() as u64),
        Measured::new("noise, longer over shorter axis in the body", body.stretch, "1").samples(noise.count() as u64),
    ]);
    let (wrong, detail) = match (with_body, with_world, body_differs, world_differs) {
        (true, _, true, _) | (_, true, _, true) => return out.pass(&subject, all),
        (true, _, _, true) => (
            "is expressed in body axes, not in its header's frame",
            "The covariance keeps its axes while the platform turns; the noise of the poses rotates with the body.",
        ),
        (_, true, true, _) => (
            "is rotated by the orientation and must not be",
            "The covariance rotates with the body; the noise of the poses keeps its axes.",
        ),
        _ => {
            let why = format!(
                "covariance and noise do not clearly follow body or world axes (covariance: constancy {:.2} minus the yaw, {:.2} as \
                 published; noise: axis ratio {:.2} in the body, {:.2} in the frame)",
                axes.less_yaw, axes.constant, body.stretch, fixed.stretch
            );
            return little(why, out);
        }
    };
    let message = format!("`{}`: `pose.covariance` {wrong}", stream.topic);
    let finding = Finding::warning(&subject, message, stream.place())
        .relation(if world_differs { "not-rotated" } else { "rotated-twice" })
        .help(if world_differs {
            "express it in the header's frame: `C_world = R C_body R^T`, with `R` the orientation of the pose"
        } else {
            "publish the covariance of the position in the header's frame, without rotating it by the orientation"
        })
        .detail(detail);
    // One matrix for all messages is hard-coded: its axes were probably not intended.
    let finding = if declared.is_constant() {
        finding.hint()
    } else {
        finding.likely()
    };
    out.fail(finding.measured(all));
}
