//! NAME09: frames named left and right are on these sides of the platform, and mirror images of each other where its other parts are.

use crate::analysis::name::sides::{Group, Pair, Placed, groups};
use crate::rules::prelude::*;

pub(crate) struct LeftRight;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_apart_m: f64,
    min_sideways: f64,
    mirrored_m: f64,
    min_mirrored: usize,
}

impl Rule for LeftRight {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for group in groups(world) {
            let mirrored = |pair: &&Pair| pair.asymmetry_m() <= limits.mirrored_m;
            let on = |is_left: bool| {
                let pairs = group.pairs.iter();
                pairs.filter(|pair| side(pair, limits) == Some(is_left)).count()
            };
            let known = Known {
                group: &group,
                mirrored: group.pairs.iter().filter(mirrored).count(),
                as_named: on(true),
                exchanged: on(false),
                limits,
            };
            for pair in &group.pairs {
                known.judge(pair, out);
            }
        }
    }
}

/// Whether the left one is on the left; `None` where the two are not side by side.
fn side(pair: &Pair, limits: &Limits) -> Option<bool> {
    let leftward = pair.leftward();
    let is_beside = pair.stays() && leftward.y.abs() >= limits.min_apart_m.max(limits.min_sideways * leftward.norm());
    is_beside.then_some(leftward.y > 0.0)
}

/// What is known of all pairs of a platform.
struct Known<'g> {
    group: &'g Group,
    /// Pairs that are mirror images.
    mirrored: usize,
    /// Pairs that are on the sides that their names say.
    as_named: usize,
    /// Those that are on the other sides.
    exchanged: usize,
    limits: &'g Limits,
}

impl Known<'_> {
    fn judge(&self, pair: &Pair, out: &mut Judge) {
        let limits = self.limits;
        let (left, right) = (&pair.left.frame, &pair.right.frame);
        let subject = format!("sides of `{left}` and `{right}`");
        let leftward = pair.leftward();
        let apart = Measured::new("distance of the left one to the left", leftward.y, "m").at_least(limits.min_apart_m);
        if let Some(finding) = self.negated(pair).or_else(|| self.turns_otherwise(pair)) {
            return out.fail(finding.measured(apart));
        }
        match side(pair, limits) {
            None if !pair.stays() => {
                out.not_applicable(subject, "moving joints above them: where they are depends on these")
            }
            None => {
                let (apart_m, sideways_m) = (leftward.norm(), leftward.y.abs());
                let why = format!("{apart_m:.2} m apart, {sideways_m:.2} m of it sideways: not side by side");
                out.not_applicable(subject, why);
            }
            Some(false) if pair.looks_backward() => {
                out.not_applicable(
                    subject,
                    "they look backward, and are on these sides as seen in that direction",
                );
            }
            Some(false) if self.exchanged >= self.as_named.max(2) => {
                let why = format!(
                    "{} pairs are on the other sides, and {} as named: the names are meant as seen from the front, or `{}` has other axes",
                    self.exchanged, self.as_named, self.group.base
                );
                out.missing(subject, why);
            }
            Some(false) if self.as_named == 0 && !self.group.is_of_whole_platform() => {
                out.missing(subject, "no other pair shows where left is");
            }
            Some(false) => out.fail(self.on_other_sides(pair, subject).measured(apart)),
            Some(true) => out.pass(subject, [apart]),
        }
    }

    fn on_other_sides(&self, pair: &Pair, subject: String) -> Finding {
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
    fn turns_otherwise(&self, pair: &Pair) -> Option<Finding> {
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
    fn negated(&self, pair: &Pair) -> Option<Finding> {
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
