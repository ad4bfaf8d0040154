//! What is said of a left and a right part.

use std::collections::BTreeMap;

use super::{Known, subject};
use crate::analysis::name::sides::{Pair, Placed};
use crate::rules::prelude::*;

/// How many pairs of one kind of joint turn as mirror images, and how many do not.
#[derive(Default)]
pub(super) struct Turning {
    alike: usize,
    otherwise: usize,
}

impl Turning {
    /// By the words that pairs of one kind share.
    pub(super) fn by_kind(pairs: &[Pair]) -> BTreeMap<Vec<String>, Self> {
        let mut by_kind: BTreeMap<Vec<String>, Self> = BTreeMap::new();
        for pair in pairs {
            if let Some(is_alike) = pair.turns_alike() {
                let of_kind = by_kind.entry(pair.kind()).or_default();
                of_kind.alike += usize::from(is_alike);
                of_kind.otherwise += usize::from(!is_alike);
            }
        }
        by_kind
    }
}

impl Known<'_> {
    pub(super) fn on_other_sides(&self, pair: &Pair) -> Finding {
        let (left, right) = (&pair.left.frame, &pair.right.frame);
        let base = &self.group.base;
        let message = format!("`{left}` is on the right of `{right}` in `{base}`");
        let finding = finding(pair, message, "sides-exchanged").help(format!(
            "exchange the two names, or the two transforms, or negate y of both; if y of `{base}` points to the right, correct that frame (REP-103: y left)"
        ));
        if self.as_named > 0 {
            let others = format!(
                "{} other pairs of `{base}` are on the sides that their names say.",
                self.as_named
            );
            return finding.detail(others);
        }
        finding
            .hint()
            .detail("No other pair of frames shows where left is: the names may be meant as seen from the front.")
    }

    /// A finding where the axis of one joint is opposite, as the pairs of the same parts at the other end show.
    pub(super) fn turns_otherwise(&self, pair: &Pair) -> Option<Finding> {
        if pair.turns_alike() != Some(false) {
            return None;
        }
        let is_only_one = |of_kind: &&Turning| of_kind.otherwise == 1 && of_kind.alike > 0;
        self.turning.get(&pair.kind()).filter(is_only_one)?;
        let (left, right) = (&pair.left.frame, &pair.right.frame);
        let message =
            format!("the joints of `{left}` and `{right}` turn in opposite directions within the same limits");
        Some(
            finding(pair, message, "axis")
                .detail("The other pairs of this part turn as mirror images.")
                .help("negate the axis of the wrong one of the two joints, or negate and exchange its limits"),
        )
    }

    /// A finding where one sign keeps the two from being mirror images, as others are.
    pub(super) fn negated(&self, pair: &Pair) -> Option<Finding> {
        let limits = self.limits;
        let asymmetry_m = pair.asymmetry_m();
        let (word, rest_m) = pair.negated()?;
        let is_one = asymmetry_m > limits.min_apart_m && rest_m <= limits.mirrored_m && are_limbs(pair);
        if !is_one || self.mirrored < limits.min_mirrored {
            return None;
        }
        let (left, right) = (&pair.left.frame, &pair.right.frame);
        let message =
            format!("`{left}` and `{right}` are no mirror images: the sign of {word} is wrong in one of the two");
        let finding = finding(pair, message, "sign")
            .detail(format!(
                "{} other pairs of `{}` are mirror images.",
                self.mirrored, self.group.base
            ))
            .help(format!(
                "negate {word} of the transform from the parent in the wrong one of the two"
            ))
            .measured([
                Measured::new("distance from the mirror image", asymmetry_m, "m").limit(limits.min_apart_m),
                Measured::new("the same with that sign changed", rest_m, "m").limit(limits.mirrored_m),
            ]);
        Some(finding)
    }
}

fn finding(pair: &Pair, message: String, relation: &str) -> Finding {
    Finding::warning(subject(pair), message, pair.left.place.clone())
        .likely()
        .label("the left one")
        .relation(relation)
        .related(pair.right.place.clone(), "the right one")
}

/// Whether both are parts of moving joints on one frame: parts of a limb may be built alike on both sides, and sensors where there is room.
fn are_limbs(pair: &Pair) -> bool {
    let parent = |placed: &'_ Placed| {
        let own = placed.own.as_ref().filter(|own| !own.is_rigid);
        own.map(|own| own.parent.clone())
    };
    parent(&pair.left).is_some_and(|left| parent(&pair.right) == Some(left))
}
