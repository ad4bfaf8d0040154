//! Names of waivers and baselines in messages.

use crate::verdict::waiver::Waiver;

/// The name of an acceptance: its kind, what it is for, and where it is written.
pub(crate) fn subject(waiver: &Waiver) -> String {
    format!(
        "{} {}{} ({})",
        waiver.kind.word(),
        waiver.rule,
        about(waiver),
        waiver.origin
    )
}

/// How messages about an acceptance begin.
pub(crate) fn opening(waiver: &Waiver) -> String {
    format!("this {} for {}{}", waiver.kind.word(), waiver.rule, about(waiver))
}

/// What it is for besides the rule, behind a space, or nothing.
fn about(waiver: &Waiver) -> String {
    if waiver.about.is_empty() {
        String::new()
    } else {
        format!(" {}", waiver.about)
    }
}
