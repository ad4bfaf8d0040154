//! GATE01: an acceptance that matches no finding.

use crate::rules::{PolicyRule, prelude::*};
use crate::verdict::waiver::{CommentFault, WaiverEffect};

/// The rule.
pub(crate) struct UnusedWaiver;

impl PolicyRule for UnusedWaiver {
    fn judge(applied: &[WaiverEffect], _: &[CommentFault], out: &mut Judge) {
        for one in applied {
            let waiver = &one.waiver;
            let subject = crate::advice::waiver::subject(waiver);
            let matched = Measured::count("matching findings", one.matched).at_least(1.0);
            if one.matched > 0 {
                out.pass(subject, [matched]);
            } else if let Some(why) = &one.unjudged {
                out.too_little(subject, why);
            } else {
                let message = format!("{} matches no finding", crate::advice::waiver::opening(waiver));
                out.fail(
                    Finding::warning(subject, message, waiver.place.clone())
                        .label("matches nothing")
                        .detail("The fault that was accepted is fixed, or its subject has another name now.")
                        .help(format!(
                            "delete the {}: it would hide the next fault of this kind",
                            waiver.kind.word()
                        ))
                        .measured(matched),
                );
            }
        }
    }
}
