//! What is said of a left and a right part.

use super::Known;
use crate::analysis::name::sides::{Pair, Placed};
use crate::rules::prelude::*;

impl Known<'_> {
    pub(super) fn on_other_sides(&self, pair: &Pair, subject: String) -> Finding {
        let (left, right) = (&pair.left.frame, &pair.right.frame);
        let base = &self.group.base;
        let message = format!("`{left}` is on the right of `{right}` in `{base}`");
        let finding = Finding::warning(subject, message, pair.left.place.clone())
            .label("the left one")
            .relation("sides-exchanged")
            .related(pair.right.place.clone(), "the right one")
            .help(format!(
                "exchange the two names, or the two transforms, or negate y of both; if y of `{base}` points to the right, correct that frame (REP-103: y left)"
            ));
        if self.as_named > 0 {
            let others = format!(
                "{} other pairs of `{base}` are on the sides that their names say.",
                self.as_named
            );
            return finding.likely().detail(others);
        }
        finding
            .hint()
            .detail("No other pair of frames shows where left is: the names may be meant as seen from the front.")
    }

    /// A finding where the axis of one joint is opposite, as the pairs of the same parts at the other end show.
    pub(super) fn turns_otherwise(&self, pair: &Pair) -> Option<Finding> {
        let kind = pair.kind();
        let alike: Vec<bool> = self
            .group
            .pairs
            .iter()
            .filter(|other| other.kind() == kind)
            .filter_map(Pair::turns_alike)
            .collect();
        let is_only_one = alike.iter().filter(|is_alike| !**is_alike).count() == 1 && alike.len() > 1;
        if !is_only_one || pair.turns_alike() != Some(false) {
            return None;
        }
        let (left, right) = (&pair.left.frame, &pair.right.frame);
        let message =
            format!("the joints of `{left}` and `{right}` turn in opposite directions within the same limits");
        let finding = Finding::warning(
            format!("sides of `{left}` and `{right}`"),
            message,
            pair.left.place.clone(),
        )
        .likely()
        .label("the left one")
        .relation("axis")
        .related(pair.right.place.clone(), "the right one")
        .detail("The other pairs of this part turn as mirror images.")
        .help("negate the axis of the wrong one of the two joints, or negate and exchange its limits");
        Some(finding)
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
        let subject = format!("sides of `{left}` and `{right}`");
        let message =
            format!("`{left}` and `{right}` are no mirror images: the sign of {word} is wrong in one of the two");
        let finding = Finding::warning(subject, message, pair.left.place.clone())
            .label("the left one")
            .relation("sign")
            .related(pair.right.place.clone(), "the right one")
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
        Some(finding.likely())
    }
}

/// Whether both are parts of moving joints on one frame: parts of a limb may be built alike on both sides, and sensors where there is room.
fn are_limbs(pair: &Pair) -> bool {
    let own = |placed: &'_ Placed| placed.own.clone().filter(|own| !own.is_rigid).map(|own| own.parent);
    own(&pair.left).is_some() && own(&pair.left) == own(&pair.right)
}
