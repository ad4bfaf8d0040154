//! What a rule is: its page, its needs, its limits and a judgement; and how the registry lists it.

use std::any::Any;
use std::collections::BTreeMap;

use crate::analysis::{Estimates, Settings};
use crate::page::{Number, Page};
use crate::verdict::waiver::{CommentFault, WaiverEffect};
use crate::verdict::{Finding, Judge, Row, RuleCode};
use serde::de::DeserializeOwned;

use super::need::Need;

/// A rule that judges worlds.
pub(crate) trait Rule {
    /// What must be available before the rule judges; the engine answers `not-evaluated` where it is not.
    const NEEDS: &'static [Need];
    /// How much of a recording the rule needs at first.
    const SAMPLE: SampleSize = SampleSize::USUAL;
    /// The limits of the page, typed.
    type Limits: Limits;

    /// Judges every subject of a world: one `pass`, `fail` or `not_evaluated` for each. No judgement at all means that the world
    /// has no subject.
    fn judge(world: &Estimates, limits: &Self::Limits, out: &mut Judge);
}

/// A rule on what the other rules found.
pub(crate) trait Review {
    /// The limits of the page, typed.
    type Limits: Limits;

    /// Called last. Findings and outcomes in, judgements out; it may add to what the findings measured.
    fn review(found: &mut [Finding], rows: &[Row], limits: &Self::Limits, out: &mut Judge);
}

/// A rule on what the user accepts.
pub(crate) trait PolicyRule {
    /// Called once for a run.
    fn judge(applied: &[WaiverEffect], misspelt: &[CommentFault], out: &mut Judge);
}

/// Typed limits.
pub(crate) trait Limits: DeserializeOwned + Any + Send + Sync {}

impl<L: DeserializeOwned + Any + Send + Sync> Limits for L {}

/// For rules without limits.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct NoLimits {}

/// How a recording is sampled for a rule, before anything is known about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleSize {
    /// Windows spread over the recording.
    pub windows: u32,
    /// Length of a window, seconds of log time.
    pub seconds: f64,
}

impl SampleSize {
    /// The least.
    pub const LEAST: Self = Self {
        windows: 2,
        seconds: 0.5,
    };
    /// What rules on names, trees and stamps need.
    pub const USUAL: Self = Self {
        windows: 10,
        seconds: 2.0,
    };

    /// What suffices for both.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self {
            windows: self.windows.max(other.windows),
            seconds: self.seconds.max(other.seconds),
        }
    }
}

/// How a rule is called.
#[derive(Clone, Copy)]
pub enum Kind {
    /// It judges each world.
    World(fn(&Estimates, &mut Judge)),
    /// It compares the recordings of one platform: it judges the world of each, and once more that of all together.
    Across(fn(&Estimates, &mut Judge)),
    /// It judges what the others found.
    Review(fn(&Settings, &mut [Finding], &[Row], &mut Judge)),
    /// It judges what the user accepts.
    Policy(fn(&[WaiverEffect], &[CommentFault], &mut Judge)),
}

/// A registered rule.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Its code.
    pub code: RuleCode,
    /// Its page.
    pub page: &'static Page,
    /// Its needs.
    pub needs: &'static [Need],
    /// How much of a recording it needs at first.
    pub sample: SampleSize,
    /// How it is called.
    pub kind: Kind,
    /// Adds its limits to the settings of a run: those of the page, overridden by these.
    pub add_limits: fn(&mut Settings, &'static Page, BTreeMap<String, Number>),
    /// Whether its limits load with these in place of the page's.
    pub check_limits: fn(&Page, &BTreeMap<String, Number>) -> Result<(), String>,
}

impl Entry {
    /// A rule that judges each world.
    pub(super) const fn world<R: Rule>(code: RuleCode, page: &'static Page) -> Self {
        Self {
            needs: R::NEEDS,
            sample: R::SAMPLE,
            kind: Kind::World(judge::<R>),
            ..Self::with::<R::Limits>(code, page)
        }
    }

    /// A rule that judges each recording, and all of a platform together.
    pub(super) const fn across<R: Rule>(code: RuleCode, page: &'static Page) -> Self {
        Self {
            kind: Kind::Across(judge::<R>),
            ..Self::world::<R>(code, page)
        }
    }

    /// A rule on what the others found.
    pub(super) const fn review<R: Review>(code: RuleCode, page: &'static Page) -> Self {
        Self {
            kind: Kind::Review(|settings, found, rows, out| {
                R::review(found, rows, &settings.limits::<R::Limits>(), out);
            }),
            ..Self::with::<R::Limits>(code, page)
        }
    }

    /// A rule on what the user accepts.
    pub(super) const fn policy<R: PolicyRule>(code: RuleCode, page: &'static Page) -> Self {
        Self {
            kind: Kind::Policy(R::judge),
            ..Self::with::<NoLimits>(code, page)
        }
    }

    const fn with<L: Limits>(code: RuleCode, page: &'static Page) -> Self {
        Self {
            code,
            page,
            needs: &[],
            sample: SampleSize::USUAL,
            kind: Kind::Policy(|_, _, _| {}),
            add_limits: |settings, page, overrides| {
                settings.add::<L>(move || page.limits(&overrides).ok());
            },
            check_limits: |page, own| page.limits::<L>(own).map(|_| ()),
        }
    }
}

fn judge<R: Rule>(world: &Estimates, out: &mut Judge) {
    R::judge(world, &world.limits::<R::Limits>(), out);
}

#[cfg(test)]
impl Entry {
    /// A rule for a test.
    pub(crate) fn of_test(
        page: &'static Page,
        needs: &'static [Need],
        sample: SampleSize,
        asked: fn(&Estimates, &mut Judge),
    ) -> &'static Self {
        Box::leak(Box::new(Self {
            needs,
            sample,
            kind: Kind::World(asked),
            ..Self::with::<NoLimits>(RuleCode::new("TEST01"), page)
        }))
    }
}
