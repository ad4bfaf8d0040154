//! TREE13: `base_footprint` that is not the level shadow of `base_link` on the ground.

use crate::analysis::tree::footprint::{LevelPath, Limits, Mount, level_paths, mounts};
use crate::math::stats::quantile;
use crate::rules::prelude::*;
use crate::world::FrameId;

pub(crate) struct BaseFootprint;

impl Rule for BaseFootprint {
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for footprint in &world.graph().frames {
            let name = footprint.as_str();
            let (namespace, last) = name.rsplit_once('/').map_or(("", name), |(space, last)| (space, last));
            if last != "base_footprint" {
                continue;
            }
            let base = FrameId::new(name.replace("base_footprint", "base_link"));
            let mut measured = Vec::new();
            let mut findings = Vec::new();
            let by_rank = |a: &Mount, b: &Mount| a.rank(limits).total_cmp(&b.rank(limits));
            if let Some(worst) = mounts(world, footprint, &base).into_iter().max_by(by_rank) {
                judge_mount(footprint, &base, &worst, limits, &mut measured, &mut findings);
            }
            for path in level_paths(world, footprint, namespace) {
                judge_tilt(footprint, &path, limits, &mut measured, &mut findings);
            }
            let subject = subject(footprint);
            if measured.is_empty() {
                out.too_little(subject, format!("no transform to `{base}`, and none that moves it in `odom` or `map`"));
            } else if findings.is_empty() {
                out.pass(subject, measured);
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
    let yaw = Measured::new("yaw off", mount.yaw_deg, "deg")
        .turn()
        .limit(limits.max_yaw_deg);
    let below = Measured::new("below", mount.below_m, "m").limit(limits.max_below_m);
    let finding = |message| Finding::warning(subject(footprint), message, mount.place.clone()).likely();
    if mount.yaw_deg > limits.max_yaw_deg {
        let turned = format!("`{base}` is turned by {:.1} deg about", mount.yaw_deg);
        let help = "both look the same way: the footprint is the base without roll, pitch and height (REP-120)";
        let finding = finding(format!("{turned} the vertical of `{footprint}`"));
        findings.push(finding.help(help).measured(yaw.clone()));
    }
    if mount.below_m > limits.max_below_m {
        let help = "the footprint lies on the ground: check the sign of z, and which of the two is the parent";
        let finding = finding(format!("`{base}` lies {:.3} m below `{footprint}`", mount.below_m));
        findings.push(finding.help(help).measured(below.clone()));
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
    let tilt = Measured::new("tilt, 95 of 100 samples below", deg, "deg")
        .limit(limits.max_tilt_deg)
        .samples(degrees.len() as u64);
    if deg > limits.max_tilt_deg {
        let (parent, child) = (&path.edge.parent, &path.edge.child);
        let is_on_its_head = quantile(&degrees, 0.05).is_some_and(|least| least > limits.upside_down_deg);
        let finding = if is_on_its_head {
            let message = format!(
                "`{child}` stands on its head in `{parent}` ({deg:.1} deg in 95 of 100 samples): z of one of them points down, as of a \
                 body of forward, right, down, or of a world of north, east, down. These data cannot tell which"
            );
            Finding::warning(subject(footprint), message, place.clone()).help(format!(
                "tell `{parent}` -> `{child}` of a body forward, left, up in a world whose z is up (REP-103): `R_flu = R_frd * F`, or \
                 `R_enu = P * R_ned` and (y, x, -z) of the position"
            ))
        } else if child == footprint {
            let message = format!(
                "`{footprint}` is tilted against `{parent}`: {deg:.1} deg in 95 of 100 samples, {most:.1} deg at most"
            );
            Finding::warning(subject(footprint), message, place.clone())
                .help(format!("publish `{parent}` -> `{footprint}` with yaw only, and roll and pitch in the transform to `base_link` (REP-120)"))
        } else {
            let message = format!(
                "`{footprint}` is fixed to `{child}` and tilts with it against `{parent}`: {deg:.1} deg in 95 of 100 samples"
            );
            Finding::note(subject(footprint), message, place.clone())
                .help("do not take it for the ground while the vehicle rolls, pitches or climbs")
        };
        findings.push(finding.likely().measured(tilt.clone()));
    }
    measured.push(tilt);
}
