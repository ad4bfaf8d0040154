//! ROT06: a translation in millimetres or centimetres where metres are read.

use nalgebra::Vector3;

use crate::advice::literal::{rewrite_values, with_fix};
use crate::advice::tally::Tally;
use crate::analysis::pairs::{Pairs, Statement};
use crate::analysis::rot::translations::{StatedTranslation, by_source};
use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::verdict::Safety;
use crate::world::World;

pub(crate) struct TranslationUnits;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Length from which a mounting is judged, metres.
    pub far_m: f64,
    /// Length from which a joint among many much shorter ones is judged, metres.
    pub far_among_many_m: f64,
    /// How many other translations are many.
    pub many: usize,
    /// Length that no mounting has, metres.
    pub impossible_m: f64,
    /// How many times longer than everything else in the source.
    pub outlier: f64,
    /// Longest mounting that the number may mean in millimetres, metres.
    pub plausible_m: f64,
    /// Tolerance of a ratio of 1000 or 100 against another source.
    pub ratio_tolerance: f64,
}

/// Lengths in millimetres that Ouster prints in its metadata (36.18: sensor to lidar; 6.253 -11.775 7.645: IMU; ...).
const OUSTER_MM: [f64; 10] = [36.18, 38.195, 74.296, 78.296, 6.253, 11.775, 7.645, 2.441, 9.725, 7.533];

impl Rule for TranslationUnits {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let pairs = Pairs::new(world);
        let mut right = Tally::new("translations");
        for (source, group) in by_source(world) {
            // The longest plausible translation: the reference for the others of the source.
            let usual = group
                .iter()
                .map(StatedTranslation::norm)
                .filter(|norm| *norm < limits.far_m)
                .fold(0.0, f64::max);
            // Where many are between the usual ones and the longest, none is an outlier: positions on a path, a map of landmarks.
            let between = |other: &&StatedTranslation| (limits.far_m..limits.outlier * usual).contains(&other.norm());
            let is_spread = group.iter().filter(between).count() > limits.many;
            let (longest, second) = two_longest(&group);
            let is_many = group.len() > limits.many;
            for stated in &group {
                let is_near = stated.norm() < limits.far_m;
                // A short one is compared with the longest of the others.
                let usual = match (is_near, longest > stated.norm()) {
                    (false, _) => usual,
                    (true, true) => longest,
                    (true, false) => second,
                };
                let far = match (is_near, is_many && stated.is_joint && usual > 0.0) {
                    (true, true) => limits.far_among_many_m,
                    _ => limits.far_m,
                };
                let found = against_others(world, source, stated, &pairs, limits)
                    .or_else(|| by_size(world, source, stated, (usual, far), limits).filter(|_| is_near || !is_spread));
                match found {
                    Some(finding) => out.fail(finding),
                    None => right.pass(source, Measured::new("length", stated.norm(), "m").limit(limits.far_m)),
                }
            }
        }
        right.report(world, out);
    }
}

/// The two longest translations, the longest first; 0 where there is none.
fn two_longest(group: &[StatedTranslation]) -> (f64, f64) {
    group
        .iter()
        .map(StatedTranslation::norm)
        .fold((0.0, 0.0), |(first, second), norm| {
            if norm > first {
                (norm, first)
            } else {
                (first, norm.max(second))
            }
        })
}

/// Certain: another source states the same mounting a thousand or a hundred times shorter.
fn against_others(
    world: &World,
    source: SourceId,
    stated: &StatedTranslation,
    pairs: &Pairs,
    limits: &Limits,
) -> Option<Finding> {
    let (target, from) = stated.frames.as_ref()?;
    let here = Vector3::from(stated.xyz);
    let others = pairs.others(target, from, source);
    others
        .into_iter()
        .filter(|other| other.has_translation)
        .find_map(|other: Statement| {
            let there = other.pose.translation.vector;
            let ratio = here.norm() / there.norm();
            let unit = [(1000.0, "millimetres"), (100.0, "centimetres")]
                .into_iter()
                .find(|(factor, _)| (ratio / factor - 1.0).abs() <= limits.ratio_tolerance);
            let (factor, unit) = unit.filter(|_| there.norm() >= 1e-3)?;
            let parallel = here.dot(&there) >= 0.999 * here.norm() * there.norm();
            let message = format!(
                "the translation of {} is in {unit}: {factor} times that of the other source",
                stated.name
            );
            let finding = Finding::error(subject(world, source, stated), message, stated.place.clone());
            parallel.then(|| {
                finish(world, finding, source, stated, factor)
                    .relation(unit)
                    .detail(format!("The same transform is in {}.", world.path(other.source)))
                    .related(other.place, "the same mounting in metres")
                    .measured(Measured::new("ratio of the lengths", ratio, "1").expected(factor))
            })
        })
}

/// Likely: longer than any mounting, and right when read in millimetres.
fn by_size(
    world: &World,
    source: SourceId,
    stated: &StatedTranslation,
    (usual, far): (f64, f64),
    limits: &Limits,
) -> Option<Finding> {
    let norm = stated.norm();
    let suspicious = norm >= far && norm >= limits.outlier * usual && !stated.is_from_a_world();
    if !suspicious || norm / 1000.0 > limits.plausible_m {
        return None;
    }
    let ouster = stated
        .xyz
        .iter()
        .filter(|value| OUSTER_MM.iter().any(|mm| (value.abs() - mm).abs() < 1e-6))
        .count();
    let is_ouster = ouster > 0 && stated.xyz.iter().filter(|value| **value != 0.0).count() == ouster;
    let severity = if is_ouster || (norm >= limits.impossible_m && usual > 0.0) {
        Severity::Error
    } else {
        Severity::Warning
    };
    let why = match (is_ouster, usual > 0.0) {
        (true, _) => "These are numbers of Ouster's metadata, which are in millimetres.".to_owned(),
        (false, true) => format!("All other translations of this file are within {usual:.3} m."),
        (false, false) => "That is far for a mounting on one robot.".to_owned(),
    };
    // A length that a big machine may have, with nothing to compare it with, is only worth a look.
    let lone = usual == 0.0 && norm < limits.impossible_m && !is_ouster;
    let doubt = if lone { "perhaps" } else { "probably" };
    let message = format!(
        "the translation of {} is {norm:.3} m long: {doubt} in millimetres",
        stated.name
    );
    let finding = Finding::new(severity, subject(world, source, stated), message, stated.place.clone())
        .likely()
        .detail(why);
    let finding = finish(world, finding.relation("millimetres"), source, stated, 1000.0);
    Some(if lone {
        finding.hint().help("check the unit: divide the three numbers by 1000 if they are millimetres; nothing is wrong if they are metres")
    } else {
        finding
    })
}

fn subject(world: &World, source: SourceId, stated: &StatedTranslation) -> String {
    format!("{} of {}", stated.name, world.path(source))
}

fn finish(world: &World, finding: Finding, source: SourceId, stated: &StatedTranslation, factor: f64) -> Finding {
    let finding = finding
        .label("read as metres")
        .unless_relation(codes::CROSS02)
        .help(format!(
            "divide the three numbers by {factor}, or convert where the file is written"
        ))
        .measured(Measured::new("length", stated.norm(), "m").limit(10.0));
    let metres = stated.literals.iter().map(|literal| (literal, literal.value / factor));
    let edits = rewrite_values(world, source, metres);
    with_fix(finding, &format!("divide by {factor}"), Safety::ChangesBehaviour, edits)
}
