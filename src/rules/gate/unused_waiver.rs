//! GATE01: an acceptance that is for nothing.

use crate::rules::OfGate;
use crate::verdict::waiver::{Applied, Misspelt};
use crate::verdict::{Finding, Judge, Measured, NotEvaluated};

/// The rule.
pub(crate) struct UnusedWaiver;

impl OfGate for UnusedWaiver {
    const PAGE: &'static str = include_str!("../../../rules/gate/unused-waiver.md");

    fn judge(applied: &[Applied], _: &[Misspelt], out: &mut Judge) {
        for one in applied {
            let waiver = &one.waiver;
            let subject = crate::advice::waiver::subject(waiver);
            let matched = Measured::count("findings that it is for", one.matched).limit(1.0);
            if one.matched > 0 {
                out.pass(subject, [matched]);
            } else if let Some(why) = &one.unjudged {
                out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
            } else {
                let message = format!(
                    "{} accepts nothing that was found",
                    crate::advice::waiver::opening(waiver)
                );
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
