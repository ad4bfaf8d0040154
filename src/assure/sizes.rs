//! The smallest error that would have been found: by search on copies of the drive, and of the drive without each of its parts.

use std::cell::OnceCell;
use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::faults::motion::{Rotations, pace};
use crate::faults::{SizedFault, Subject};
use crate::verdict::{Bound, Measured, Row, Verdict};
use crate::world::World;

use super::base::Base;
use super::miss::Miss;
use super::parts::{deviation, without_parts};

/// Copies that one search judges, about.
pub(super) const COPIES: usize = 60;
/// A search begins with steps of this factor.
const STEP: f64 = 2.0;
/// A search ends where the smallest size that is found is known to within this factor.
const RESOLUTION: f64 = 1.02;
/// Without a part a size counts as the same within this factor.
const SAME: f64 = 1.03;
/// A size whose lower end is below this share of it, about zero, is none: it says nothing about another drive.
const UNSTEADY: f64 = 0.05;
/// The quantile of a normal distribution at the power of 80 %.
const Z_80: f64 = 0.8416;
/// The quantile at 95 %.
const Z_95: f64 = 1.6449;

/// The smallest error of one kind in one subject that would have been found.
#[derive(Clone, Debug)]
pub struct SmallestError {
    /// The mistake.
    pub fault: &'static SizedFault,
    /// The name of the platform.
    pub platform: String,
    /// The name of the subject.
    pub subject: String,
    /// Its size. `Err`: why no size would have been found.
    pub found: Result<FoundSize, Miss>,
    /// If no size would have been found because of the motion: the direction in which that hides it, a unit vector in the axes of the
    /// platform.
    pub hidden: Option<[f64; 3]>,
}

/// A size at which a mistake is found. Sizes are in the unit of the mistake.
#[derive(Clone, Debug)]
pub struct FoundSize {
    /// The rule with the finding.
    pub rule: String,
    /// Found with a probability of 80 %, whichever sign it has.
    pub size: f64,
    /// Found with a probability of 5 %, and of 95 %; `None` where the rule does not judge without some part of the drive.
    pub range: Option<[f64; 2]>,
    /// Found with a probability of 80 %, if it is positive and if it is negative.
    pub by_sign: [f64; 2],
    /// The rules that find it with these signs.
    pub rules_by_sign: [String; 2],
    /// By the limit of the rule and what it measured, where it compares a value of this unit: limit, value, and 0.84 of its spread.
    pub by_limit: Option<f64>,
    /// What it means for a point at 50 m, metres.
    pub at_50_m: Option<f64>,
}

/// Searches the smallest errors; `step` is called after each.
pub(super) fn smallest(
    base: &Base,
    searches: Vec<(&'static SizedFault, Subject)>,
    step: &(dyn Fn() + Sync),
) -> Vec<SmallestError> {
    if searches.is_empty() {
        return Vec::new();
    }
    let worlds = without_parts(base.world);
    let parts: Vec<Base> = worlds.iter().map(|world| Base::new(world, base.rules)).collect();
    let (pace, rotations) = (pace(base.world), Rotations::of(base.world));
    let errors = searches.into_par_iter().map(|(fault, subject)| {
        let of_sign = |sign: f64| {
            let search = Search {
                base,
                parts: &parts,
                fault,
                subject: &subject,
                sign,
                touched: OnceCell::new(),
            };
            search.run()
        };
        // One sign that is found at no size decides.
        let both = of_sign(1.0).and_then(|positive| Ok([positive, of_sign(-1.0)?]));
        let mut found = both.map(|both| {
            let by_sign = both.each_ref().map(|found| found.size);
            let rules_by_sign = both.each_ref().map(|found| found.rule.clone());
            let [positive, negative] = both;
            let larger = if positive.size >= negative.size {
                positive
            } else {
                negative
            };
            FoundSize {
                by_sign,
                rules_by_sign,
                at_50_m: fault.at_50_m(larger.size, pace),
                ..larger
            }
        });
        let hidden = rotations.as_ref().and_then(|rotations| fault.hidden_by(rotations));
        let hidden = found.as_mut().err().zip(hidden).map(|(miss, hidden)| {
            miss.reason = format!("{}; {}", hidden.why, miss.reason);
            hidden.axis
        });
        step();
        SmallestError {
            fault,
            platform: base.world.label.clone(),
            subject: subject.name,
            found,
            hidden,
        }
    });
    errors.collect()
}

/// The smallest size that is found, between one that is not and one that is.
fn narrowed([mut below, mut size]: [f64; 2], mut is_found: impl FnMut(f64) -> bool) -> f64 {
    while size > below * RESOLUTION {
        let middle = (size * below).sqrt();
        if is_found(middle) {
            size = middle;
        } else {
            below = middle;
        }
    }
    size
}

/// What a rule says of each of its subjects.
fn rows_of<'v>(verdict: &'v Verdict, code: &str) -> impl Iterator<Item = &'v Row> {
    verdict.rows.iter().filter(move |row| row.rule == code)
}

struct Search<'s> {
    base: &'s Base<'s>,
    parts: &'s [Base<'s>],
    fault: &'static SizedFault,
    subject: &'s Subject,
    /// The sign of the sizes.
    sign: f64,
    /// See [`Search::touched`].
    touched: OnceCell<BTreeSet<&'static str>>,
}

/// The rule and the subject of a finding.
type By = (String, String);

impl Search<'_> {
    fn run(&self) -> Result<FoundSize, Miss> {
        if self.touched().is_empty() {
            return Err(self.miss());
        }
        let Some((whole, by)) = self.smallest() else {
            return Err(self.miss());
        };
        let without: Vec<f64> = self
            .parts
            .iter()
            .filter_map(|base| self.near(base, whole, &by.0))
            .collect();
        let deviation = match self.parts.len() {
            // What no recording is behind does not vary.
            0 => Some(0.0),
            // With fewer, what is found depends on one part of the drive.
            all if without.len() + 1 >= all => Some(deviation(whole, &without)),
            _ => None,
        };
        let range = deviation.map(|deviation| [(whole - Z_95 * deviation).max(0.0), whole + Z_95 * deviation]);
        if let Some([low, high]) = range.filter(|[low, _]| *low < UNSTEADY * whole) {
            return Err(self.unsteady([whole, low, high], &by.0));
        }
        Ok(FoundSize {
            size: whole + Z_80 * deviation.unwrap_or_default(),
            range,
            by_limit: self.by_limit(&by),
            at_50_m: None,
            by_sign: [whole; 2],
            rules_by_sign: Default::default(),
            rule: by.0,
        })
    }

    /// Why a size is none: it depends on single parts of the drive.
    fn unsteady(&self, sizes: [f64; 3], rule: &str) -> Miss {
        let unit = self.fault.unit;
        let [whole, low, high] = sizes.map(|size| format!("{size:.2}"));
        Miss {
            reason: format!(
                "what {rule} finds varies too much from part to part of these data: from {whole} {unit} on in all of them together, and on another drive of the kind from {low} to {high} {unit} on"
            ),
            record: format!("more of what {rule} measures: {}", self.fault.record),
        }
    }

    /// The rules that should see it and whose rows depend on it, with those that fail without it: these may explain what others find.
    /// Only they are judged while its size is searched. None if no row depends on it.
    fn touched(&self) -> &BTreeSet<&'static str> {
        self.touched.get_or_init(|| {
            let healthy = self.base.healthy(self.fault.seen_by);
            let [_, largest] = self.fault.range;
            let altered = [self.middle(), largest].map(|size| self.judged_by_all(size));
            let is_touched = |code: &&str| {
                let mut altered = altered.iter().flatten();
                altered.any(|altered| !rows_of(altered, code).eq(rows_of(&healthy.verdict, code)))
            };
            let mut touched: BTreeSet<&str> = self.fault.seen_by.codes().filter(is_touched).collect();
            if !touched.is_empty() {
                let fails = |code: &&str| healthy.verdict.findings.iter().any(|finding| finding.rule == *code);
                touched.extend(self.fault.seen_by.codes().filter(fails));
            }
            touched
        })
    }

    /// The middle of the sizes, by their logarithms.
    fn middle(&self) -> f64 {
        let [smallest, largest] = self.fault.range;
        (smallest * largest).sqrt()
    }

    /// A copy with the mistake, judged by the rules that it touches; none if nothing changes.
    fn judged(&self, base: &Base, size: f64) -> Option<Verdict> {
        let world = self.altered(base, size)?;
        Some(base.rules.judge(&world, &|code| self.touched().contains(code)))
    }

    /// The whole drive with the mistake, judged by the rules that should see it; none if nothing changes.
    fn judged_by_all(&self, size: f64) -> Option<Verdict> {
        let world = self.altered(self.base, size)?;
        Some(self.base.judge(&world, self.fault.seen_by))
    }

    /// A copy with the mistake; none if nothing changes.
    fn altered(&self, base: &Base, size: f64) -> Option<World> {
        let mut world: World = base.world.clone();
        let has_changed = self.fault.apply(&mut world, self.subject, self.sign * size);
        world.forget();
        has_changed.then_some(world)
    }

    /// What finds the mistake with this size: any rule, or this one.
    fn found(&self, base: &Base, size: f64, rule: Option<&str>) -> Option<By> {
        let altered = self.judged(base, size)?;
        let healthy = base.healthy(self.fault.seen_by);
        let mut new = healthy.new_in(&altered).into_iter();
        let finding = new.find(|finding| rule.is_none_or(|rule| finding.rule == rule))?;
        Some((finding.rule.clone(), finding.subject.clone()))
    }

    /// The smallest size that is found in the whole drive, as is twice that size.
    fn smallest(&self) -> Option<(f64, By)> {
        let [mut size, largest] = self.fault.range;
        let mut below: Option<f64> = None;
        let found = |size: f64| self.found(self.base, size, None);
        let mut by = found(size);
        loop {
            let next = size * STEP;
            let of_next = if next <= largest { found(next) } else { by.clone() };
            if let (Some(by), Some(_)) = (by, &of_next) {
                let Some(below) = below else { return Some((size, by)) };
                let mut smallest = (size, by);
                narrowed([below, size], |size| {
                    found(size).map(|by| smallest = (size, by)).is_some()
                });
                return Some(smallest);
            }
            if next > largest {
                return None;
            }
            (below, size, by) = (Some(size), next, of_next);
        }
    }

    /// The smallest size that this rule finds without a part, near that of the whole drive; none if even twice that is not found.
    fn near(&self, without: &Base, whole: f64, rule: &str) -> Option<f64> {
        let is_found = |size: f64| self.found(without, size, Some(rule)).is_some();
        let is_same = is_found(whole * SAME);
        let mut last = whole * SAME;
        let steps = if is_same {
            [1.0 / SAME, 0.7, 0.4]
        } else {
            [1.4, 2.0, 2.0]
        };
        for size in steps.map(|times| times * whole) {
            if is_found(size) != is_same {
                let [below, above] = if is_same { [size, last] } else { [last, size] };
                return Some(if above <= below * SAME * SAME * 1.001 {
                    whole
                } else {
                    narrowed([below, above], is_found)
                });
            }
            last = size;
        }
        is_same.then_some(last)
    }

    /// Limit and value of the rule that finds it, where it compares a value of the same unit.
    fn by_limit(&self, (rule, subject): &By) -> Option<f64> {
        let healthy = self.base.healthy(self.fault.seen_by);
        let rows = healthy.verdict.rows.iter();
        let mut measured = rows
            .filter(|row| row.rule == *rule && row.subject == *subject)
            .flat_map(|row| &row.measured)
            .filter(|measured| measured.unit == self.fault.unit && measured.bound == Bound::Within);
        let limit = |measured: &Measured| {
            let spread = measured.spread.unwrap_or_default();
            Some(measured.limit? + measured.value.abs() + Z_80 * spread)
        };
        measured.find_map(limit)
    }

    /// Why no size is found: what the rules say of a mistake of a middle size.
    fn miss(&self) -> Miss {
        let Some(altered) = self.judged_by_all(self.middle()) else {
            return Miss {
                reason: "it changes nothing here".to_owned(),
                record: self.fault.record.to_owned(),
            };
        };
        let healthy = self.base.healthy(self.fault.seen_by);
        let verdicts = [&healthy.verdict, &altered];
        Miss::of(
            self.base.world,
            self.fault.seen_by,
            self.subject,
            verdicts,
            self.fault.record,
        )
    }
}
