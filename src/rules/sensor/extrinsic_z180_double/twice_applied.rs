//! Transforms that a lidar's driver applies to every point, and that TF applies again. Part of SENSOR03.

use crate::analysis::cross::pair::Statement;
use crate::analysis::cross::statements::statements;
use crate::tables::Lidar;
use crate::verdict::Judge;
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::{Claim, ClaimKind, World};
use serde::Deserialize;

/// Judges every configuration of a driver that holds such a transform.
pub(crate) fn judge(world: &World, limits: &Limits, out: &mut Judge) {
    let mut mountings: Option<Vec<Statement>> = None;
    for claim in &world.claims {
        let lidars = drivers(world, claim);
        if !lidars.is_empty() {
            let mountings = mountings.get_or_insert_with(|| statements(world));
            judge_claim(world, claim, &lidars, mountings, limits, out);
        }
    }
}

/// The lidars whose drivers read such a claim; none where it is not of a driver.
fn drivers<'w>(world: &'w World, claim: &Claim) -> Vec<&'w Lidar> {
    let names_none = match claim.kind {
        ClaimKind::File { roles, .. } => roles || claim.frames.is_none(),
        ClaimKind::Joint { .. } => false,
    };
    if !names_none {
        return Vec::new();
    }
    let is_number = |part: &&str| part.chars().all(|letter| letter.is_ascii_digit());
    let label: Vec<&str> = claim.label.split('/').filter(|part| !is_number(part)).collect();
    let label = label.join("/");
    let ends = |key: &String| label == *key || label.strip_suffix(key.as_str()).is_some_and(|rest| rest.ends_with('/'));
    world
        .tables
        .lidars()
        .filter(|lidar| lidar.transform_keys.iter().any(ends))
        .collect()
}

fn judge_claim(
    world: &World,
    claim: &Claim,
    lidars: &[&Lidar],
    mountings: &[Statement],
    limits: &Limits,
    out: &mut Judge,
) {
    let subject = format!("`{}` in {}", claim.label, world.path(claim.place.source));
    let Some(pose) = claim.pose.as_ref().map(crate::world::Pose::isometry) else {
        return out.not_evaluated(subject, NotEvaluated::InputBroken, "its numbers are no valid transform");
    };
    let size = [
        Measured::new(
            "translation that the driver applies",
            pose.translation.vector.norm(),
            "m",
        )
        .limit(limits.same_m),
        Measured::new(
            "rotation that the driver applies",
            pose.rotation.angle().to_degrees(),
            "deg",
        )
        .limit(limits.same_deg),
    ];
    let is_same = |of: &nalgebra::Isometry3<f64>| {
        let left = pose.inv_mul(of);
        left.translation.vector.norm() <= limits.same_m && left.rotation.angle().to_degrees() <= limits.same_deg
    };
    if is_same(&nalgebra::Isometry3::identity()) {
        // Nothing is applied, so nothing can be applied twice.
        return out.pass(subject, size);
    }
    let named = |statement: &Statement| {
        let words = statement.source_frame.tokens();
        lidars
            .iter()
            .find(|lidar| !statement.is_of_a_file() && lidar.is_named_by(&words))
            .copied()
    };
    let of_it: Vec<(&Statement, &Lidar)> = mountings
        .iter()
        .filter_map(|statement| Some((statement, named(statement)?)))
        .collect();
    if of_it.is_empty() {
        let names: Vec<&str> = lidars.iter().map(|lidar| lidar.name.as_str()).collect();
        let why = format!(
            "the driver ({}) applies it to every point, but TF and URDF have no mounting of such a frame to compare with",
            names.join(" or ")
        );
        return out.missing(subject, why);
    }
    let Some((twice, lidar)) = of_it.into_iter().find(|(statement, _)| is_same(&statement.pose)) else {
        return out.pass(subject, size);
    };
    let message = format!(
        "`{}` is applied twice: by the {} driver and by `{}` -> `{}`",
        claim.label, lidar.name, twice.target, twice.source_frame
    );
    let detail = format!(
        "The driver applies this transform to every point{}, and {} states the same transform.",
        if lidar.transform_by_setting {
            " if the setting for that is on"
        } else {
            ""
        },
        twice.who
    );
    let finding = Finding::error(subject, message, claim.place.clone());
    let finding = if lidar.transform_by_setting {
        finding.hint()
    } else {
        finding.likely()
    };
    let finding = finding
        .relation("applied-twice")
        .related(twice.place.clone(), "applied again here")
        .detail(detail)
        .help(format!(
            "set `{}` to zero, and keep the mounting in TF: the driver does not transform the IMU of the device",
            claim.label
        ));
    out.fail(finding.measured(size));
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) cell_m: f64,
    pub(crate) level_m: f64,
    pub(crate) min_way_m: f64,
    pub(crate) min_ratio: f64,
    pub(crate) max_half_off_deg: f64,
    pub(crate) same_m: f64,
    pub(crate) same_deg: f64,
}
