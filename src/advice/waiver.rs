//! Words for what a user accepts.

use crate::verdict::waiver::Waiver;

/// What an acceptance is called: what it is, for what, and where it stands.
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

/// What it is for besides the rule, behind a blank, or nothing.
fn about(waiver: &Waiver) -> String {
    if waiver.about.is_empty() {
        String::new()
    } else {
        format!(" {}", waiver.about)
    }
}
