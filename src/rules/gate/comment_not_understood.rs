//! GATE03: a comment to frames-lint that has no effect.

use crate::rules::{PolicyRule, prelude::*};
use crate::verdict::waiver::{CommentFault, WaiverEffect, WaiverKind};

/// The rule.
pub(crate) struct CommentNotUnderstood;

impl PolicyRule for CommentNotUnderstood {
    fn judge(applied: &[WaiverEffect], misspelt: &[CommentFault], out: &mut Judge) {
        for one in applied.iter().filter(|one| one.waiver.kind == WaiverKind::Comment) {
            out.pass(
                crate::advice::waiver::subject(&one.waiver),
                [Measured::count("faults of the comment", 0).limit(0.0)],
            );
        }
        for comment in misspelt {
            let subject = format!("comment `frames-lint: {}`", comment.text);
            let message = format!("`frames-lint:` comment has no effect: {}", comment.fault);
            out.fail(
                Finding::warning(subject, message, comment.place.clone())
                    .help(comment.help)
                    .measured(Measured::count("faults of the comment", 1).limit(0.0)),
            );
        }
    }
}
