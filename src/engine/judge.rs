//! Runs the rules over a world. Adds `not-evaluated` rows that a rule's author could forget, and catches crashes.

use std::borrow::Cow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::analysis::{Estimates, KeptResults, Settings};
use crate::page::Status;
use crate::rules::Kind;
use crate::source::{Confidence, Place, ReadStatus, Span};
use crate::verdict::waiver::{CommentFault, WaiverEffect};
use crate::verdict::{Finding, Fix, Judge, Measured, NotEvaluated, Outcome, Row, Verdict, deference};
use crate::world::{BagEvidence, World};

use super::enabled::EnabledRule;
use super::timings::{Phase, Timings};

/// Judges one world with every enabled rule. `label` is put before each subject when the run has several platforms.
pub(super) fn judge<'r>(
    world: &World,
    rules: impl IntoIterator<Item = &'r EnabledRule> + Clone,
    settings: &Settings,
    label: Option<&str>,
    timings: &Timings,
) -> Verdict {
    judge_sharing(world, rules, settings, None, label, timings)
}

/// The same, with results that are shared with other worlds.
pub(super) fn judge_sharing<'r>(
    world: &World,
    rules: impl IntoIterator<Item = &'r EnabledRule> + Clone,
    settings: &Settings,
    kept: Option<&KeptResults>,
    label: Option<&str>,
    timings: &Timings,
) -> Verdict {
    let mut verdict = Verdict::default();
    let estimates = Estimates::new(world, settings).sharing(kept);
    for rule in rules.clone() {
        let (Kind::World(asked) | Kind::Across(asked)) = rule.entry.kind else {
            continue;
        };
        let mut out = Judge::default();
        out.without_plots = !rule.plots;
        let missing: Vec<&str> = rule
            .entry
            .needs
            .iter()
            .filter(|need| !need.is_met(world))
            .map(|need| need.missing())
            .collect();
        let mut crash = None;
        if missing.is_empty() {
            crash = timings.of(Phase::Judge, rule.entry.page.code, || {
                crash_of(|| asked(&estimates, &mut out))
            });
        } else {
            not_asked(world, &missing, &mut out);
        }
        if crash.is_none() {
            not_silent(rule, &mut out);
            crash = unmeasured(&out);
        }
        if rule.entry.needs.iter().any(|need| need.is_of_bags()) {
            add_share(world, &mut out);
        }
        doubt_guesses(world, &mut out);
        take(out, rule, label, crash, &mut verdict);
    }
    deference::match_up(&mut verdict.findings);
    deference::settle(&mut verdict);
    // A place in an expansion is shown, and fixed, where it is written.
    for finding in verdict.findings.iter_mut().chain(&mut verdict.explained) {
        finding.fix = finding.fix.take().and_then(|fix| written_fix(world, fix));
    }
    let findings = verdict.findings.iter_mut().chain(&mut verdict.explained);
    for label in findings.flat_map(|finding| &mut finding.places) {
        let source = world.source(label.place.source);
        if let Some(place) = source.and_then(|source| source.written(&label.place)) {
            label.place = place;
        }
    }
    // Rules about the findings run after all others.
    for rule in rules {
        if let Kind::Review(asked) = rule.entry.kind {
            let mut out = Judge::default();
            let crash = crash_of(|| asked(settings, &mut verdict.findings, &verdict.rows, &mut out));
            let crash = crash.or_else(|| unmeasured(&out));
            take(out, rule, label, crash, &mut verdict);
        }
    }
    verdict
}

/// A fix with its edits where the text is written; none if the text is computed, or written more than once.
fn written_fix(world: &World, mut fix: Fix) -> Option<Fix> {
    for edit in &mut fix.edits {
        let source = world.source(edit.place.source);
        let Some((source, place)) = source.and_then(|source| Some((source, source.written(&edit.place)?))) else {
            continue;
        };
        let text = |place: &Place| {
            let (source, span) = (world.source(place.source)?, place.span()?);
            source.text.get(span.start..span.end)
        };
        let old = source.text.get(edit.place.span()?.start..edit.place.span()?.end)?;
        let (from, mut found) = (place.span()?.start, text(&place)?.match_indices(old));
        let (at, _) = found.next().filter(|_| !old.is_empty() && found.next().is_none())?;
        let span = Span::new(from + at, from + at + old.len());
        edit.place = Place::text(place.source, span);
    }
    Some(fix)
}

/// Runs the rules about what the user accepts.
pub(super) fn judge_policy(
    applied: &[WaiverEffect],
    misspelt: &[CommentFault],
    rules: &[&EnabledRule],
    verdict: &mut Verdict,
) {
    for rule in rules {
        let Kind::Policy(asked) = rule.entry.kind else { continue };
        let mut out = Judge::default();
        let crash = crash_of(|| asked(applied, misspelt, &mut out)).or_else(|| {
            not_silent(rule, &mut out);
            unmeasured(&out)
        });
        take(out, rule, None, crash, verdict);
    }
}

/// Runs a rule. Returns the panic message if it crashed.
fn crash_of(asked: impl FnOnce()) -> Option<String> {
    let panic = catch_unwind(AssertUnwindSafe(asked)).err()?;
    Some(panic_words(panic.as_ref()))
}

/// A rule without any outcome had nothing to judge.
fn not_silent(rule: &EnabledRule, out: &mut Judge) {
    if out.judged.is_empty() {
        out.not_evaluated(
            "platform",
            NotEvaluated::NotApplicable,
            format!("nothing to check here ({})", rule.entry.page.subject),
        );
    }
}

/// A finding that depends on fields recognised only by their names is a hint, for every rule.
fn doubt_guesses(world: &World, out: &mut Judge) {
    for finding in &mut out.findings {
        let guessed = finding
            .places
            .iter()
            .filter_map(|label| world.guessed_fields(&label.place));
        let Some((topic, fields)) = guessed.last() else {
            continue;
        };
        let doubt = format!(
            "the meaning of the fields `{fields}` of `{topic}` is guessed from their names; confirm it with `fields: confirmed` in \
             frames-lint.yaml"
        );
        finding.help = if finding.help.is_empty() {
            doubt
        } else {
            format!("{}; {doubt}", finding.help)
        };
        finding.confidence = Confidence::Hint;
    }
}

fn not_asked(world: &World, missing: &[&str], out: &mut Judge) {
    let broken: Vec<&str> = world
        .members
        .iter()
        .filter_map(|id| world.source(*id))
        .filter(|source| source.required && source.status != ReadStatus::Read)
        .map(|source| source.path.as_str())
        .collect();
    if broken.is_empty() {
        out.not_evaluated("platform", NotEvaluated::MissingInput, missing.join(", "));
    } else {
        let (first, more) = (broken.first().copied().unwrap_or_default(), broken.len() - 1);
        let others = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        let missing = missing.join(", ");
        let reason = format!("{missing}; these inputs could not be read: {first}{others}");
        out.not_evaluated("platform", NotEvaluated::InputBroken, reason);
    }
}

/// Adds the share that was read to measurements on a part of a recording.
fn add_share(world: &World, out: &mut Judge) {
    let share_of = |source| {
        let bag = world.bags.iter().find(|bag| bag.source == source)?;
        bag.share_of_messages()
    };
    for finding in &mut out.findings {
        let shares = finding.places.iter().filter_map(|label| share_of(label.place.source));
        if let Some(share) = shares.reduce(f64::min) {
            finding.measured.push(Measured::new(SHARE, share, "1"));
        }
    }
    let shares = world.bags.iter().filter_map(BagEvidence::share_of_messages);
    let Some(least) = shares.reduce(f64::min) else { return };
    for judged in &mut out.judged {
        if matches!(judged.outcome, Outcome::Pass | Outcome::Fail) {
            judged.measured.push(Measured::new(SHARE, least, "1"));
        }
    }
}

/// The name of the share in reports.
const SHARE: &str = "share of messages read";

/// A pass without a measurement is a bug of the rule. A finding may have none.
fn unmeasured(out: &Judge) -> Option<String> {
    let silent = out
        .judged
        .iter()
        .find(|judged| judged.outcome == Outcome::Pass && judged.measured.is_empty())?;
    Some(format!("pass of `{}` without a measurement", silent.subject))
}

fn take(mut out: Judge, rule: &EnabledRule, label: Option<&str>, crash: Option<String>, verdict: &mut Verdict) {
    let prefixed = |subject: String| match label {
        Some(label) => format!("{label}: {subject}"),
        None => subject,
    };
    let row = |subject: String, outcome, reason, measured| Row {
        rule: Cow::Borrowed(rule.entry.page.code),
        name: Cow::Borrowed(rule.entry.page.name),
        subject,
        outcome,
        reason,
        measured,
        plots: Vec::new(),
        planes: Vec::new(),
    };
    if let Some(reason) = crash {
        verdict.rows.push(row(
            prefixed("platform".to_owned()),
            Outcome::Crashed,
            Some(reason),
            Vec::new(),
        ));
    }
    for judged in out.judged {
        let plots = out.plots.remove(&judged.subject).unwrap_or_default();
        let planes = out.planes.remove(&judged.subject).unwrap_or_default();
        verdict.rows.push(Row {
            plots,
            planes,
            ..row(prefixed(judged.subject), judged.outcome, judged.reason, judged.measured)
        });
    }
    let ceiling = match rule.entry.page.status {
        Status::Trial => Confidence::Hint,
        Status::Stable => rule.entry.page.confidence,
    };
    for finding in out.findings {
        let subject = prefixed(finding.subject.clone());
        verdict.findings.push(Finding {
            rule: rule.entry.page.code.to_owned(),
            name: rule.entry.page.name.to_owned(),
            subject,
            ..finding.confidence(ceiling)
        });
    }
}

/// The message of a panic, for the report.
pub(super) fn panic_words(panic: &(dyn std::any::Any + Send)) -> String {
    let said = panic
        .downcast_ref::<&str>()
        .map(|words| (*words).to_owned())
        .or_else(|| panic.downcast_ref::<String>().cloned());
    said.map_or_else(
        || "the rule panicked".to_owned(),
        |words| format!("the rule panicked: {words}"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::{Page, Status};
    use crate::rules::{Entry, Need, SampleSize};
    use crate::source::{Place, SourceId};
    use crate::verdict::Severity;

    static PAGE: Page = Page {
        code: "TEST01",
        name: "test",
        summary: "s",
        since: "0.1.0",
        status: Status::Stable,
        severity: Severity::Error,
        confidence: Confidence::Likely,
        subject: "one for each test",
        view: "frames",
        evidence: &[],
        limits: &[],
        references: &[],
        body: "",
    };

    fn run_with(entry: &'static Entry) -> Verdict {
        let rule = EnabledRule::new(entry);
        judge(
            &World::default(),
            [&rule],
            &Settings::default(),
            None,
            &Timings::default(),
        )
    }

    #[test]
    fn an_unmet_need_becomes_a_row_with_its_reason() {
        let entry = Entry::of_test(&PAGE, &[Need::Robot], SampleSize::LEAST, |_, _| panic!("must not run"));
        let verdict = run_with(entry);
        assert_eq!(verdict.rows.len(), 1);
        assert_eq!(verdict.rows[0].outcome, Outcome::NotEvaluated);
        assert_eq!(
            verdict.rows[0].reason.as_deref(),
            Some("missing input: no URDF: needs a file or /robot_description")
        );
    }

    #[test]
    fn silence_becomes_not_evaluated() {
        let entry = Entry::of_test(&PAGE, &[], SampleSize::LEAST, |_, _| {});
        let verdict = run_with(entry);
        assert_eq!(
            verdict.rows[0].reason.as_deref(),
            Some("not applicable: nothing to check here (one for each test)")
        );
    }

    #[test]
    fn a_crash_is_caught_and_named_and_what_was_judged_before_stays() {
        let entry = Entry::of_test(&PAGE, &[], SampleSize::LEAST, |_, out| {
            out.pass("first", [Measured::count("things", 1)]);
            panic!("boom")
        });
        let verdict = run_with(entry);
        assert_eq!(verdict.count(Outcome::Crashed), 1);
        assert_eq!(verdict.count(Outcome::Pass), 1);
        let crashed = verdict.rows.iter().find(|row| row.outcome == Outcome::Crashed).unwrap();
        assert_eq!(crashed.reason.as_deref(), Some("the rule panicked: boom"));
    }

    #[test]
    fn a_pass_without_a_number_is_a_fault_of_the_rule() {
        let entry = Entry::of_test(&PAGE, &[], SampleSize::LEAST, |_, out| {
            out.pass("thing", []);
        });
        assert_eq!(run_with(entry).count(Outcome::Crashed), 1);
    }

    #[test]
    fn the_page_caps_the_confidence() {
        let entry = Entry::of_test(&PAGE, &[], SampleSize::LEAST, |_, out| {
            out.fail(Finding::error("thing", "wrong", Place::whole(SourceId(0))).measured(Measured::count("n", 1)));
        });
        let verdict = run_with(entry);
        assert_eq!(verdict.findings[0].confidence, Confidence::Likely);
        assert_eq!(verdict.findings[0].severity, Severity::Error);
        assert_eq!(verdict.findings[0].rule, "TEST01");
    }
}
