//! Rules on what the user accepts: waivers, comments and baselines that do nothing, have run out, or are not understood.

pub mod comment_not_understood;
pub mod expired_waiver;
pub mod unused_waiver;

use crate::verdict::waiver::Waiver;

/// What an acceptance is called: what it is, for what, and where it stands.
fn subject(waiver: &Waiver) -> String {
    let about = if waiver.about.is_empty() {
        String::new()
    } else {
        format!(" {}", waiver.about)
    };
    format!("{} {}{about} ({})", waiver.kind.word(), waiver.rule, waiver.origin)
}

/// What it is for besides the rule, with a blank behind it, or nothing.
fn about(waiver: &Waiver) -> String {
    if waiver.about.is_empty() {
        String::new()
    } else {
        format!("{} ", waiver.about)
    }
}
