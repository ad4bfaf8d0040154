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
                "{} expired after {}: its findings count again",
                crate::advice::waiver::opening(waiver),
                until.as_str()
            );
            out.fail(
                Finding::warning(subject, message, waiver.place.clone())
                    .label(format!("reason: {}", waiver.reason))
                    .help("fix what it accepted, or write a later day and a reason that is still valid")
                    .measured(past),
            );
        }
    }
}
