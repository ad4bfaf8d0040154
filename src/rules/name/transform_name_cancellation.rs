//! NAME08: declared products of transforms whose inner frames do not cancel.

use std::collections::BTreeSet;

use crate::rules::{Judge, Need, NoLimits, Rule, names};
use crate::source::{Confidence, Place, Span};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::transform_name::{self, NameStyle, TransformName};
use crate::world::{ClaimKind, DeclaredChain, FrameId, World};

/// NAME08.
pub struct TransformNameCancellation;

impl Rule for TransformNameCancellation {
    const PAGE: &'static str = include_str!("../../../rules/name/transform-name-cancellation.md");
    const NEEDS: &'static [Need] = &[];
    type Limits = NoLimits;

    fn judge(world: &World, _limits: &NoLimits, out: &mut Judge) {
        for chain in &world.chains {
            judge_chain(chain, out);
        }
        judge_keys(world, out);
    }
}

/// A frame's name as it stands in a formula: `base` and `base_link` are one there.
fn label(name: &str) -> String {
    names::without_ending(FrameId::new(name).tokens()).concat()
}

/// Two neighbours that do not fit: what the left one ends in, what the right one begins with, and where.
struct Gap {
    left: String,
    right: String,
    at: (Span, Span),
}

fn gaps<'a>(factors: impl Iterator<Item = &'a (TransformName, Span)> + Clone) -> Vec<Gap> {
    factors
        .clone()
        .zip(factors.skip(1))
        .filter(|((left, _), (right, _))| label(&left.source) != label(&right.target))
        .map(|((left, left_at), (right, right_at))| Gap {
            left: left.source.clone(),
            right: right.target.clone(),
            at: (*left_at, *right_at),
        })
        .collect()
}

fn judge_chain(chain: &DeclaredChain, out: &mut Judge) {
    let subject = format!("`{}`", chain.text.trim());
    if let Some(unknown) = &chain.not_understood {
        let reason = format!("`{unknown}` is no name of a transform between two frames");
        out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, reason);
        return;
    }
    let (Some((first, _)), Some((last, _))) = (chain.factors.first(), chain.factors.last()) else {
        return;
    };
    let all = || chain.factors.iter().chain(&chain.result);
    let ceiling = if all().any(|(name, _)| name.ambiguous) {
        Confidence::Likely
    } else {
        Confidence::Certain
    };
    let places = |span: Span| Place::text(chain.place.source, span);
    let inner = gaps(chain.factors.iter());
    let joints = Measured::count("neighbours that do not cancel", inner.len()).limit(0.0);
    let joints = joints.samples(chain.factors.len().saturating_sub(1) as u64);
    let turned = !inner.is_empty() && gaps(chain.factors.iter().rev()).is_empty();
    for gap in &inner {
        let message = format!(
            "`{}` meets `{}`: neighbours in a product must share a frame",
            gap.left, gap.right
        );
        let help = if turned {
            "the frames cancel from right to left: `a_T_b * b_T_c` is `a_T_c`, the frame that points come from is on the right"
        } else {
            "insert the missing transform, or take the inverse of one of the two"
        };
        let finding = Finding::error(subject.as_str(), message, places(gap.at.1))
            .confidence(ceiling)
            .label(format!("begins with `{}`", gap.right))
            .related(places(gap.at.0), format!("ends in `{}`", gap.left));
        out.fail(finding.help(help).measured(joints.clone()));
    }
    let outer = Measured::count("outer frames that differ", 0).limit(0.0);
    match &chain.result {
        Some((result, at)) if inner.is_empty() => {
            let same = label(&result.target) == label(&first.target) && label(&result.source) == label(&last.source);
            if same {
                out.pass(subject, [joints, outer]);
                return;
            }
            let message = format!(
                "the product takes `{}` to `{}`, and is declared to take `{}` to `{}`",
                last.source, first.target, result.source, result.target
            );
            let inverse = label(&result.source) == label(&first.target) && label(&result.target) == label(&last.source);
            let finding = Finding::error(subject, message, places(*at))
                .confidence(ceiling)
                .help(if inverse {
                    "the result is the inverse: exchange its frames, or invert the product"
                } else {
                    "name the result after its outer frames"
                });
            let finding = finding.measured(Measured::count("outer frames that differ", 1).limit(0.0));
            out.fail(if inverse { finding.relation("inverse") } else { finding });
        }
        _ if inner.is_empty() => out.pass(subject, [joints]),
        _ => {}
    }
}

/// Keys whose direction is not agreed, in files of no known dialect: one hint a file.
fn judge_keys(world: &World, out: &mut Judge) {
    let mut seen = BTreeSet::new();
    for claim in &world.claims {
        let is_generic = matches!(&claim.kind, ClaimKind::File { dialect, .. } if dialect == "generic");
        let name = transform_name::parse(&claim.label).filter(|name| name.style == NameStyle::To);
        let (Some(name), true) = (name, is_generic && claim.reading < Confidence::Certain) else {
            continue;
        };
        if !seen.insert(claim.place.source) {
            continue;
        }
        let message = format!(
            "`{}` does not say its direction: projects disagree whether it takes points from `{}` to `{}` or is the pose of one in the other",
            claim.label, name.source, name.target
        );
        let finding = Finding::note(
            format!("names in {}", world.path(claim.place.source)),
            message,
            claim.place.clone(),
        )
        .hint()
        .help(format!(
            "a name such as `{}_from_{}` can be read in one way only",
            name.target, name.source
        ));
        out.fail(finding.measured(Measured::count("readings", 2).limit(1.0)));
    }
}
