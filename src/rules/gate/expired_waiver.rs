//! GATE02: an acceptance that has expired.

use crate::rules::{PolicyRule, prelude::*};
use crate::verdict::waiver::{CommentFault, WaiverEffect};

/// The rule.
pub(crate) struct ExpiredWaiver;

impl PolicyRule for ExpiredWaiver {
    fn judge(applied: &[WaiverEffect], _: &[CommentFault], out: &mut Judge) {
        for one in applied {
            let waiver = &one.waiver;
            let Some(until) = &waiver.until else { continue };
            let subject = crate::advice::waiver::subject(waiver);
            let days = one.expired_days.unwrap_or(0);
            let past = Measured::new("days since its last day", days as f64, "d").limit(0.0);
            if one.expired_days.is_none() {
                out.pass(subject, [past]);
                continue;
            }
            let message = format!(
                "{} has expired: its last day was {}, {days} d ago",
                crate::advice::waiver::opening(waiver),
                until.as_str()
            );
            let (kind, rule) = (waiver.kind.word(), &waiver.rule);
            out.fail(
                Finding::warning(subject, message, waiver.place.clone())
                    .label("expired")
                    .detail(format!(
                        "Findings that this {kind} accepted count again. The reason was \"{}\".",
                        waiver.reason
                    ))
                    .help(format!(
                        "fix the findings of {rule} that this {kind} accepted, or write a later last day and a reason that still holds"
                    ))
                    .measured(past),
            );
        }
    }
}
