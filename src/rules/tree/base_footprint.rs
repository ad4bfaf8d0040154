//! TREE13: `base_footprint` that is not the level projection of `base_link` onto the ground.

mod wheels;

use crate::analysis::tree::footprint::{LevelPath, Limits, Mount, level_paths, mounts};
use crate::math::stats::quantile;
use crate::rules::prelude::*;
use crate::world::FrameId;

pub(crate) struct BaseFootprint;

impl Rule for BaseFootprint {
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let is_footprint = |frame: &&FrameId| frame.as_str().rsplit('/').next() == Some("base_footprint");
        for footprint in world.graph().frames.iter().filter(is_footprint) {
            let name = footprint.as_str();
            let namespace = name.rsplit_once('/').map_or("", |(namespace, _)| namespace);
            let base = FrameId::new(name.replace("base_footprint", "base_link"));
            let (mut measured, mut findings) = (Vec::new(), Vec::new());
            let by_rank = |a: &Mount, b: &Mount| a.rank(limits).total_cmp(&b.rank(limits));
            if let Some(worst) = mounts(world, footprint, &base).into_iter().max_by(by_rank) {
                judge_mount(footprint, &base, &worst, limits, &mut measured, &mut findings);
            }
            wheels::judge(world, footprint, &base, limits, &mut measured, &mut findings);
            for path in level_paths(world, footprint, namespace) {
                judge_tilt(footprint, &path, limits, &mut measured, &mut findings);
            }
            if measured.is_empty() {
                let why = format!("no transform to `{base}`, and no moving transform from `odom` or `map`");
                out.too_little(subject(footprint), why);
            } else if findings.is_empty() {
                out.pass(subject(footprint), measured);
            }
            for finding in findings {
                out.fail(finding);
            }
        }
    }
}

fn subject(footprint: &FrameId) -> String {
    format!("frame `{footprint}`")
}

fn judge_mount(
    footprint: &FrameId,
    base: &FrameId,
    mount: &Mount,
    limits: &Limits,
    measured: &mut Vec<Measured>,
    findings: &mut Vec<Finding>,
) {
    let (yaw_deg, below_m) = (mount.yaw_deg, mount.below_m);
    let yaw = Measured::new("yaw between base and footprint", yaw_deg, "deg")
        .turn()
        .limit(limits.max_yaw_deg);
    let below = Measured::new("height of the footprint above the base", below_m, "m").limit(limits.max_below_m);
    let finding = |message| Finding::warning(subject(footprint), message, mount.place.clone()).likely();
    if yaw_deg > limits.max_yaw_deg {
        let help = format!(
            "set the yaw between the two to 0: `{footprint}` is `{base}` without roll, pitch and height (REP-120)"
        );
        let message = format!("`{base}` is rotated by {yaw_deg:.1} deg about z of `{footprint}`");
        findings.push(finding(message).help(help).measured(yaw.clone()));
    }
    if below_m > limits.max_below_m {
        let help = format!("negate z of this transform: `{footprint}` is on the ground, `{base}` is above");
        let message = format!("`{base}` is {below_m:.3} m below `{footprint}`");
        findings.push(finding(message).help(help).measured(below.clone()));
    }
    measured.extend([yaw, below]);
}

fn judge_tilt(
    footprint: &FrameId,
    path: &LevelPath,
    limits: &Limits,
    measured: &mut Vec<Measured>,
    findings: &mut Vec<Finding>,
) {
    let degrees: Vec<f64> = path.tilts.iter().map(|(deg, _)| *deg).collect();
    let worst = path.tilts.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((deg, (most, place))) = quantile(&degrees, 0.95).zip(worst) else {
        return;
    };
    let tilt = Measured::new("tilt, 95th percentile", deg, "deg")
        .limit(limits.max_tilt_deg)
        .samples(degrees.len() as u64);
    if deg > limits.max_tilt_deg {
        let (parent, child) = (&path.edge.parent, &path.edge.child);
        let is_upside_down = quantile(&degrees, 0.05).is_some_and(|least| least > limits.upside_down_deg);
        let finding = if is_upside_down {
            let message = format!("`{child}` is upside down in `{parent}`: tilted by {deg:.1} deg");
            Finding::warning(subject(footprint), message, place.clone())
                .detail("One of the two has z down: an FRD body or an NED world; these data cannot distinguish them.")
                .help(format!(
                    "publish `{parent}` -> `{child}` with a forward-left-up body in a z-up world (REP-103):\n\
                     (1) if the body is FRD: `R_flu = R_frd * diag(1, -1, -1)`\n\
                     (2) if the world is NED: position (y, x, -z) and `R_enu = P * R_ned`, where P exchanges x and y and negates z"
                ))
        } else if child == footprint {
            let message = format!("`{footprint}` is tilted by {deg:.1} deg in `{parent}` (95th percentile)");
            Finding::warning(subject(footprint), message, place.clone())
                .detail(format!("The largest tilt is {most:.1} deg."))
                .help(format!("publish `{parent}` -> `{footprint}` with yaw only, and roll and pitch in the transform to `base_link` (REP-120)"))
        } else {
            let message =
                format!("`{footprint}` is fixed to `{child}` and tilts with it in `{parent}`, by {deg:.1} deg");
            let help = format!("do not use `{footprint}` as the ground while the vehicle rolls, pitches or climbs");
            Finding::note(subject(footprint), message, place.clone())
                .detail("The tilt is the 95th percentile.")
                .help(help)
        };
        findings.push(finding.likely().measured(tilt.clone()));
    }
    measured.push(tilt);
}
