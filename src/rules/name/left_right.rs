//! NAME09: frames named left and right are on these sides of the platform, and mirror images of each other where its other parts are.

mod findings;

use std::collections::BTreeMap;

use crate::analysis::name::sides::{Group, Pair, groups};
use crate::rules::prelude::*;
use findings::Turning;

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
                turning: Turning::by_kind(&group.pairs),
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

fn subject(pair: &Pair) -> String {
    format!("sides of `{}` and `{}`", pair.left.frame, pair.right.frame)
}

/// What is known of all pairs of a platform.
struct Known<'g> {
    group: &'g Group,
    /// The joints, by the words that pairs of one kind share.
    turning: BTreeMap<Vec<String>, Turning>,
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
        let subject = subject(pair);
        let leftward = pair.leftward();
        let apart = Measured::new("distance of the left one to the left", leftward.y, "m").at_least(limits.min_apart_m);
        if let Some(finding) = self.negated(pair).or_else(|| self.turns_otherwise(pair)) {
            return out.fail(finding.measured(apart));
        }
        match side(pair, limits) {
            None if !pair.stays() => {
                out.not_applicable(subject, "moving joints above them: where they are depends on these");
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
            Some(false) => out.fail(self.on_other_sides(pair).measured(apart)),
            Some(true) => out.pass(subject, [apart]),
        }
    }
}
