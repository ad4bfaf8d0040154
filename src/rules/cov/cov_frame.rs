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
            "constancy of the direction of the long axis as published (1: constant)",
            axes.constant,
            "1",
        )
        .samples(n),
        Measured::new(
            "constancy of the direction of the long axis minus the yaw (1: constant)",
            axes.less_yaw,
            "1",
        )
        .samples(n),
        Measured::new("long axis / short axis of the covariance", axes.stretch, "1").at_least(limits.min_stretch),
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
        "`{}`: `twist.covariance` is expressed in world axes, not in {} (axis ratio {:.1})",
        stream.topic,
        stream.child_name(),
        axes.stretch
    );
    let finding = Finding::warning(subject, message, stream.place())
        .likely()
        .relation("in-world")
        .unless(codes::AXES08)
        .detail(
            "The long axis of the published ellipse turns with the yaw of the platform. Expressed in the child frame, the \
             direction would be constant.",
        )
        .help(
            "rotate both 3x3 blocks into the child frame before publishing: `C_body = R^T C_world R`, with `R` the orientation of the pose",
        );
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
        Measured::new(
            "long axis / short axis of the noise, in the axes of the header's frame",
            fixed.stretch,
            "1",
        )
        .samples(noise.count() as u64),
        Measured::new(
            "long axis / short axis of the noise, in the axes of the body",
            body.stretch,
            "1",
        )
        .samples(noise.count() as u64),
    ]);
    let frame = stream.frame_name();
    let (wrong, detail) = match (with_body, with_world, body_differs, world_differs) {
        (true, _, true, _) | (_, true, _, true) => return out.pass(&subject, all),
        (true, _, _, true) => (
            format!("expressed in body axes, not in {frame}"),
            "The published ellipse keeps its direction while the platform turns, but the noise of the poses turns with the platform.",
        ),
        (_, true, true, _) => (
            format!("rotated with the body, but the noise in {frame} is not"),
            "The published ellipse turns with the platform, but the noise of the poses keeps its direction.",
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
    let message = format!(
        "`{}`: `pose.covariance` is {wrong} (axis ratio {:.1})",
        stream.topic, axes.stretch
    );
    let finding = Finding::warning(&subject, message, stream.place())
        .relation(if world_differs { "not-rotated" } else { "rotated-twice" })
        .help(if world_differs {
            "rotate the covariance into the header's frame before publishing: `C_world = R C_body R^T`, with `R` the orientation of the pose"
        } else {
            "remove the rotation of the covariance by the orientation: the covariance of the position is right in the header's frame"
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
