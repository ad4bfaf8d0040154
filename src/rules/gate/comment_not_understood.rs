//! GATE03: a comment to frames-lint that says nothing which it understands.

use crate::rules::{Judge, Need, NoLimits, Rule};
use crate::verdict::waiver::{Applied, Misspelt, WaiverKind};
use crate::verdict::{Finding, Measured};
use crate::world::World;

/// The rule.
pub struct CommentNotUnderstood;

impl Rule for CommentNotUnderstood {
    const PAGE: &'static str = include_str!("../../../rules/gate/comment-not-understood.md");
    const NEEDS: &'static [Need] = &[];
    const OF_GATE: bool = true;
    type Limits = NoLimits;

    fn judge(_: &World, _: &NoLimits, _: &mut Judge) {}

    fn judge_gate(applied: &[Applied], misspelt: &[Misspelt], _: &NoLimits, out: &mut Judge) {
        for one in applied.iter().filter(|one| one.waiver.kind == WaiverKind::Comment) {
            out.pass(
                super::subject(&one.waiver),
                [Measured::count("faults of the comment", 0).limit(0.0)],
            );
        }
        for comment in misspelt {
            let subject = format!("comment `frames-lint: {}`", comment.text);
            let message = format!("a comment to frames-lint has no effect: {}", comment.fault);
            out.fail(
                Finding::warning(subject, message, comment.place.clone())
                    .help(
                        "Write `frames-lint: allow RULE reason`, or `frames-lint: allow RULE until 2027-01-31 reason`.",
                    )
                    .measured(Measured::count("faults of the comment", 1).limit(0.0)),
            );
        }
    }
}
