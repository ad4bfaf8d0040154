//! COV04: covariances that are expressed in other axes than the message says.

mod pairs;

mod limits;

use crate::analysis::cov::declared::{Axes, Declared, each};
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

/// Where the axes of a stream's covariances turn, or why that cannot be said.
fn axes(declared: &Declared<'_>, limits: &Limits) -> Result<Axes, String> {
    if declared.samples.is_empty() {
        return Err("every covariance is all zeros, or not finite".to_owned());
    }
    let Some(axes) = declared.axes() else {
        return Err("no covariance of x and y is an ellipse".to_owned());
    };
    if axes.stretch < limits.min_stretch {
        return Err(format!(
            "x and y are alike (the ellipse is stretched {:.2} times, {} are needed): it has no direction",
            axes.stretch, limits.min_stretch
        ));
    }
    if axes.spread < limits.min_spread {
        return Err(format!(
            "the yaw hardly changes (spread {:.2}, {} is needed): axes of the world and of the body are the same",
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
        Measured::new("constancy of the longer axis as published", axes.constant, "1").samples(n),
        Measured::new("constancy of the longer axis less the yaw", axes.less_yaw, "1").samples(n),
        Measured::new("longer over shorter axis", axes.stretch, "1").limit(limits.min_stretch),
    ]
}

fn judge_twist(stream: &Stream<PoseRow>, declared: &Declared<'_>, limits: &Limits, out: &mut Judge) {
    let subject = format!("axes of `twist.covariance` on {}", stream.subject);
    let little = NotEvaluated::TooLittleEvidence;
    if declared.is_constant() {
        return out.not_applicable(subject, "one constant matrix: numbers that were typed in, which do not turn anyhow");
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
            "its longer axis keeps to neither body nor world (constancy {:.2} and {:.2}, {} is needed)",
            axes.constant, axes.less_yaw, limits.along
        );
        return out.not_evaluated(subject, little, why);
    }
    let message = format!(
        "`twist.covariance` on `{}` turns with the yaw (constancy of its longer axis {:.2} less the yaw, {:.2} as published): it is in the \
         axes of the world, and the velocity is in those of the child frame",
        stream.topic, axes.less_yaw, axes.constant
    );
    let finding = Finding::warning(subject, message, stream.place()).likely().relation("in-world").unless(codes::AXES08).help(
        "publish it in the child frame: `C_body = R^T C_world R`, with `R` the orientation of the pose, for both blocks of three",
    );
    out.fail(finding.measured(measured));
}

fn judge_pose(stream: &Stream<PoseRow>, declared: &Declared<'_>, limits: &Limits, out: &mut Judge) {
    let subject = format!("axes of `pose.covariance` on {}", stream.subject);
    let little = |why: String, out: &mut Judge| out.too_little(&subject, why);
    let axes = match axes(declared, limits) {
        Ok(axes) => axes,
        Err(why) => return little(why, out),
    };
    let noise = Noise::of(stream, declared.topic);
    let Some((fixed, body)) = noise.ellipses().filter(|_| noise.count() as f64 >= limits.min_poses) else {
        let why = format!(
            "{} poses at even steps show the noise that it speaks of, {} are needed",
            noise.count(),
            limits.min_poses
        );
        return little(why, out);
    };
    let scale = axes.trace / fixed.trace;
    if !(1.0 / limits.scale..=limits.scale).contains(&scale) {
        let why = format!(
            "it states {scale:.2e} times the variance that the poses show from one to the next, up to {} are needed: a filtered \
             estimate hides where its error points",
            limits.scale
        );
        return little(why, out);
    }
    let (with_body, with_world) = (
        body.stretch >= limits.min_stretch && fixed.stretch <= limits.round,
        fixed.stretch >= limits.min_stretch && body.stretch <= limits.round,
    );
    let (told_body, told_world) = (
        axes.less_yaw > limits.along && axes.constant < limits.across,
        axes.constant > limits.along && axes.less_yaw < limits.across,
    );
    let all = measured(&axes, limits).into_iter().chain([
        Measured::new("noise, longer over shorter axis in the frame", fixed.stretch, "1").samples(noise.count() as u64),
        Measured::new("noise, longer over shorter axis in the body", body.stretch, "1").samples(noise.count() as u64),
    ]);
    let wrong = match (with_body, with_world, told_body, told_world) {
        (true, _, true, _) | (_, true, _, true) => return out.pass(&subject, all),
        (true, _, _, true) => {
            "keeps its axes while the platform turns, and the noise of the poses turns with the body: it is in the body's axes"
        }
        (_, true, true, _) => {
            "turns with the body, and the noise of the poses keeps its axes: it was turned, and must not be"
        }
        _ => {
            let why = format!(
                "neither covariance nor noise keep clearly to body or world (covariance: constancy {:.2} and {:.2}; noise: stretched {:.2} \
                 and {:.2} times)",
                axes.less_yaw, axes.constant, body.stretch, fixed.stretch
            );
            return little(why, out);
        }
    };
    let message = format!(
        "`pose.covariance` on `{}` {wrong} (noise stretched {:.1} times in the body's axes, {:.1} times in those of the frame)",
        stream.topic, body.stretch, fixed.stretch
    );
    let finding = Finding::warning(&subject, message, stream.place())
        .relation(if told_world { "not-rotated" } else { "rotated-twice" })
        .help(if told_world {
            "the covariance of a pose is in the axes of its header's frame: `C_world = R C_body R^T`, with `R` the orientation of the pose"
        } else {
            "publish the covariance of the position in the header's frame as it is; it must not be turned by the orientation"
        });
    // One matrix for all messages was typed in: nobody meant the axes.
    let finding = if declared.is_constant() {
        finding.hint()
    } else {
        finding.likely()
    };
    out.fail(finding.measured(all));
}
