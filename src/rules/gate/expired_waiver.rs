//! GATE02: an acceptance that has run out.

use crate::rules::{Judge, Need, NoLimits, Rule};
use crate::verdict::waiver::{Applied, Misspelt};
use crate::verdict::{Finding, Measured};
use crate::world::World;

/// The rule.
pub struct ExpiredWaiver;

impl Rule for ExpiredWaiver {
    const PAGE: &'static str = include_str!("../../../rules/gate/expired-waiver.md");
    const NEEDS: &'static [Need] = &[];
    const OF_GATE: bool = true;
    type Limits = NoLimits;

    fn judge(_: &World, _: &NoLimits, _: &mut Judge) {}

    fn judge_gate(applied: &[Applied], _: &[Misspelt], _: &NoLimits, out: &mut Judge) {
        for one in applied {
            let waiver = &one.waiver;
            let Some(until) = &waiver.until else { continue };
            let subject = super::subject(waiver);
            let days = one.expired_days.unwrap_or(0);
            let past = Measured::new("days since its last day", days as f64, "d").limit(0.0);
            if one.expired_days.is_none() {
                out.pass(subject, [past]);
                continue;
            }
            let message = format!(
                "{} held until {}: what it accepted counts again",
                super::opening(waiver),
                until.as_str()
            );
            out.fail(
                Finding::warning(subject, message, waiver.place.clone())
                    .label(format!("reason: {}", waiver.reason))
                    .help("Mend what it accepted, or accept it anew with a later day and a reason that still holds.")
                    .measured(past),
            );
        }
    }
}
