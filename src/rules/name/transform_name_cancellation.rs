//! NAME08: declared products of transforms whose inner frames do not cancel.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::name::alike::is_same;
use crate::rules::prelude::*;
use crate::source::{Confidence, SourceId, SourceKind, Span};
use crate::world::transform_name::{NameStyle, TransformName};
use crate::world::{Claim, DeclaredChain, Doubt, FrameId, World, transform_name};

pub(crate) struct TransformNameCancellation;

impl Rule for TransformNameCancellation {
    const NEEDS: &'static [Need] = &[];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let backwards = read_from_the_right(world);
        for chain in &world.chains {
            let is_backwards = backwards.contains(&chain.place.source);
            judge_chain(&with_aliases(world, chain), is_backwards, out);
        }
        judge_keys(world, out);
        judge_doubts(world, out);
    }
}

/// Files of source code that use `T_a_b` for the transform that takes points from `a` to `b`: several of their products cancel only from right to
/// left, and none only from left to right. With a mark between the frames (`a_T_b`) or with `from` this is not in use.
fn read_from_the_right(world: &World) -> BTreeSet<SourceId> {
    let mut votes: BTreeMap<SourceId, (usize, usize)> = BTreeMap::new();
    for chain in &world.chains {
        let is_code = world
            .source(chain.place.source)
            .is_some_and(|source| source.kind == SourceKind::Code);
        let mut styles = chain.factors.iter().map(|(name, _)| name.style);
        let is_open = styles.all(|style| matches!(style, NameStyle::Prefix | NameStyle::Letters));
        if !is_code || !is_open || chain.factors.len() < 2 {
            continue;
        }
        let fits = gaps(chain.factors.iter()).is_empty();
        let fits_turned = gaps(chain.factors.iter().rev()).is_empty();
        let (usual, turned) = votes.entry(chain.place.source).or_default();
        *usual += usize::from(fits && !fits_turned);
        *turned += usize::from(fits_turned && !fits);
    }
    let of_one_mind = votes
        .into_iter()
        .filter(|(_, (usual, turned))| *usual == 0 && *turned >= 2);
    of_one_mind.map(|(source, _)| source).collect()
}

/// Two neighbours that do not cancel: the source of the left one, the target of the right one, and where.
struct Gap {
    left: String,
    right: String,
    at: (Span, Span),
}

fn gaps<'a>(factors: impl Iterator<Item = &'a (TransformName, Span)> + Clone) -> Vec<Gap> {
    factors
        .clone()
        .zip(factors.skip(1))
        .filter(|((left, _), (right, _))| !is_same(&left.source, &right.target))
        .map(|((left, left_at), (right, right_at))| Gap {
            left: left.source.clone(),
            right: right.target.clone(),
            at: (*left_at, *right_at),
        })
        .collect()
}

/// The chain with the platform's names instead of aliases that the user declares.
fn with_aliases(world: &World, chain: &DeclaredChain) -> DeclaredChain {
    let mut chain = chain.clone();
    for (name, _) in chain.factors.iter_mut().chain(&mut chain.result) {
        for frame in [&mut name.target, &mut name.source] {
            if let Some(known) = world
                .conventions
                .frame_of(world.path(chain.place.source), &FrameId::new(frame.as_str()))
            {
                known.as_str().clone_into(frame);
            }
        }
    }
    chain
}

/// Whether the result is one of the factors: `T_a_b = T_x * T_a_b`, `T_a_b = T_a_b.inverse()`.
fn is_updated(chain: &DeclaredChain) -> bool {
    chain.result.as_ref().is_some_and(|(result, _)| {
        chain.factors.iter().any(|(factor, _)| {
            let is_it = |one: &TransformName| one.target == result.target && one.source == result.source;
            is_it(factor) || is_it(&factor.clone().inverse())
        })
    })
}

/// Whether a product is `A X A^-1`.
fn is_conjugation(chain: &DeclaredChain) -> bool {
    let [(first, _), between @ .., (last, _)] = chain.factors.as_slice() else {
        return false;
    };
    let are_inverses = first.target == last.source && first.source == last.target;
    are_inverses && !between.is_empty()
}

fn judge_chain(chain: &DeclaredChain, is_backwards: bool, out: &mut Judge) {
    let subject = format!("`{}`", chain.text.trim());
    if is_backwards && chain.factors.len() > 1 {
        let why = "all products of this file cancel from right to left: its `T_a_b` takes points from `a` to `b`";
        return out.not_applicable(subject, why);
    }
    if let Some(unknown) = &chain.not_understood {
        return out.too_little(
            subject,
            format!("`{unknown}` does not name a transform between two frames, as `a_T_b` does"),
        );
    }
    let (Some((first, _)), Some((last, _))) = (chain.factors.first(), chain.factors.last()) else {
        return;
    };
    let all = || chain.factors.iter().chain(&chain.result);
    let is_ambiguous = all().any(|(name, _)| name.ambiguous);
    let is_updated = is_updated(chain);
    let ceiling = if is_ambiguous && (chain.is_loose || is_updated) {
        Confidence::Hint
    } else if is_ambiguous {
        Confidence::Likely
    } else {
        Confidence::Certain
    };
    let inner = gaps(chain.factors.iter());
    // With an X that does not cancel between them.
    if is_conjugation(chain) && !inner.is_empty() {
        let why = "a change of basis: the first and the last factor are inverses, and the one between them is a motion";
        return out.not_applicable(subject, why);
    }
    let places = |span: Span| Place::text(chain.place.source, span);
    let joints = Measured::count("neighbours that do not cancel", inner.len()).limit(0.0);
    let joints = joints.samples(chain.factors.len().saturating_sub(1) as u64);
    let turned = !inner.is_empty() && gaps(chain.factors.iter().rev()).is_empty();
    for gap in &inner {
        let message = format!(
            "`{}` is followed by `{}`: neighbours in a product must share a frame",
            gap.left, gap.right
        );
        let help = if turned {
            "reverse the factors: these cancel from right to left, but `a_T_b * b_T_c` is `a_T_c`, with the source frame on the right"
                .to_owned()
        } else {
            format!(
                "insert the transform `{}` from `{}` between the two factors, or correct the wrong name",
                gap.left, gap.right
            )
        };
        let finding = Finding::error(subject.as_str(), message, places(gap.at.1))
            .confidence(ceiling)
            .label(format!("starts with `{}`", gap.right))
            .related(places(gap.at.0), format!("ends with `{}`", gap.left));
        out.fail(finding.help(help).measured(joints.clone()));
    }
    let outer = Measured::count("outer frames that differ", 0).limit(0.0);
    match &chain.result {
        // `a.T_world_sensor().inverse() * b.T_world_sensor()`: from one sensor to another, without their names.
        Some(_) if inner.is_empty() && chain.factors.len() > 1 && is_same(&first.target, &last.source) => {
            out.pass(subject, [joints]);
        }
        Some((result, at)) if inner.is_empty() => {
            let same = is_same(&result.target, &first.target) && is_same(&result.source, &last.source);
            if same {
                return out.pass(subject, [joints, outer]);
            }
            let message = format!(
                "the product takes `{}` to `{}`, but is declared to take `{}` to `{}`",
                last.source, first.target, result.source, result.target
            );
            let inverse = is_same(&result.source, &first.target) && is_same(&result.target, &last.source);
            // An update gives the name another meaning, which its author knows.
            let ceiling = if is_updated { Confidence::Hint } else { ceiling };
            let finding = Finding::error(subject, message, places(*at))
                .confidence(ceiling)
                .help(if inverse {
                    "swap the frames in the name of the result, or invert the product".to_owned()
                } else {
                    format!(
                        "append or remove the factor that is missing or too much, or name the result `{}` from `{}`",
                        first.target, last.source
                    )
                });
            let finding = finding.measured(Measured::count("outer frames that differ", 1).limit(0.0));
            out.fail(if inverse { finding.relation("inverse") } else { finding });
        }
        _ if inner.is_empty() => out.pass(subject, [joints]),
        _ => {}
    }
}

/// How far a transform and its inverse are apart, for the end of a headline.
fn apart(claim: &Claim) -> String {
    let Some(pose) = claim.pose.map(|pose| pose.isometry()) else {
        return String::new();
    };
    let inverse = pose.inverse();
    let angle_deg = pose.rotation.angle_to(&inverse.rotation).to_degrees();
    let distance_m = (pose.translation.vector - inverse.translation.vector).norm();
    format!(", and the two readings differ by {angle_deg:.1} deg and {distance_m:.3} m")
}

/// Statements of known dialects whose direction is ambiguous: one hint a file. Algebras are QUAT05's.
fn judge_doubts(world: &World, out: &mut Judge) {
    let mut seen = BTreeSet::new();
    for claim in &world.claims {
        let (Some(Doubt::Direction(doubt)), Some((target, source))) = (&claim.doubt, &claim.frames) else {
            continue;
        };
        if !seen.insert(claim.place.source) {
            continue;
        }
        let path = world.path(claim.place.source);
        let message = format!("`{}`: direction is ambiguous{}", claim.label, apart(claim));
        let finding = Finding::note(
            format!("direction of `{}` of {path}", claim.label),
            message,
            claim.place.clone(),
        )
        .hint()
        .detail(format!(
            "The transform is read as taking points of `{source}` to `{target}`. Why that is in doubt: {doubt}."
        ))
        .help(format!(
            "look up how the program that reads this file applies the transform, and declare the direction in frames-lint.yaml:\n\
             (1) as read: `transforms: [{{file: {path}, key: '{}', is: {target} from {source}}}]`\n\
             (2) inverse: the same with `is: {source} from {target}`",
            claim.label
        ));
        out.fail(finding.measured(Measured::count("readings", 2).limit(1.0)));
    }
}

/// Keys whose direction is ambiguous, in files of no known dialect: one hint a file.
fn judge_keys(world: &World, out: &mut Judge) {
    let mut seen = BTreeSet::new();
    for claim in &world.claims {
        let name = transform_name::parse(&claim.label).filter(|name| name.style == NameStyle::To);
        let (Some(name), true) = (name, claim.is_of_a_key()) else {
            continue;
        };
        if !seen.insert(claim.place.source) {
            continue;
        }
        let message = format!("`{}`: direction is ambiguous{}", claim.label, apart(claim));
        let finding = Finding::note(
            format!("names in {}", world.path(claim.place.source)),
            message,
            claim.place.clone(),
        )
        .hint()
        .detail(format!(
            "The transform can take points of `{}` to `{}`, or be the pose of `{1}` in `{0}`, which is the inverse.",
            name.source, name.target
        ))
        .help(format!(
            "look up how the program that reads this file applies the transform, and declare the direction in frames-lint.yaml:\n\
             (1) points of `{2}` to `{1}`: `transforms: [{{key: '{0}', is: {1} from {2}}}]`, or a clear key such as `{1}_from_{2}`\n\
             (2) pose of `{1}` in `{2}`: the same with `is: {2} from {1}`",
            claim.label, name.target, name.source
        ));
        out.fail(finding.measured(Measured::count("readings", 2).limit(1.0)));
    }
}
