//! GATE01: an acceptance that is for nothing.

use crate::rules::{Judge, Need, NoLimits, Rule};
use crate::verdict::waiver::{Applied, Misspelt};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;

/// The rule.
pub struct UnusedWaiver;

impl Rule for UnusedWaiver {
    const PAGE: &'static str = include_str!("../../../rules/gate/unused-waiver.md");
    const NEEDS: &'static [Need] = &[];
    const OF_GATE: bool = true;
    type Limits = NoLimits;

    fn judge(_: &World, _: &NoLimits, _: &mut Judge) {}

    fn judge_gate(applied: &[Applied], _: &[Misspelt], _: &NoLimits, out: &mut Judge) {
        for one in applied {
            let waiver = &one.waiver;
            let subject = super::subject(waiver);
            let matched = Measured::count("findings that it is for", one.matched).limit(1.0);
            if one.matched > 0 {
                out.pass(subject, [matched]);
            } else if let Some(why) = &one.unjudged {
                out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
            } else {
                let message = format!("{} accepts nothing that was found", super::opening(waiver));
                out.fail(
                    Finding::warning(subject, message, waiver.place.clone())
                        .label(format!("reason: {}", waiver.reason))
                        .help(
                            "What it accepted is mended, or is called otherwise now: take it out, or it will hide the next fault of this \
                             kind.",
                        )
                        .measured(matched),
                );
            }
        }
    }
}
