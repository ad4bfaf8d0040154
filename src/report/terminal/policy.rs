//! Accepted findings, and requirements that are not met.

use std::fmt::Write;

use crate::run::{RequirementKind, Run, UnmetRequirement};
use crate::verdict::Acceptance;

use super::super::Style;
use super::super::place::Locator;
use super::super::style::Ink;
use super::super::text::{one_line, plural, wrap};
use super::{Options, finding, heading};

/// Maximum number of waived findings shown, without --all.
const SHOWN: usize = 50;

/// Accepted findings: a line each, with the reason.
pub(super) fn waived(run: &Run, options: &Options, locator: &Locator, out: &mut String) {
    let waived = || {
        run.verdict
            .findings
            .iter()
            .filter_map(|one| Some((one, one.waived.as_ref()?)))
    };
    let count = waived().count();
    if count == 0 {
        return;
    }
    heading(options.style, "Waived", count, "finding", out);
    let shown = if options.all { count } else { SHOWN };
    for (one, waived) in waived().take(shown) {
        out.push_str("  ");
        finding::line(one, locator, options.style, out);
        let words = wrap(
            &one_line(&waived.words()),
            options.style.width,
            "    waived: ",
            "            ",
        );
        let _ = writeln!(out, "{words}");
    }
    if count > shown {
        let _ = writeln!(out, "  ... and {} more (show with --all)", count - shown);
    }
    out.push('\n');
}

/// Requirements that are not met: why, and what is needed.
pub(super) fn unmet(run: &Run, style: Style, out: &mut String) {
    // What is not fit has a section of its own.
    let lacking = run.lacking().filter(|unmet| unmet.kind != RequirementKind::Fitness);
    let lacking: Vec<&UnmetRequirement> = lacking.collect();
    if !lacking.is_empty() {
        heading(style, "Requirements not met", lacking.len(), "requirement", out);
        for unmet in lacking {
            requirement(unmet, style, out);
            if let Some(record) = &unmet.record {
                let _ = writeln!(
                    out,
                    "{}",
                    wrap(&one_line(record), style.width, "    needed: ", "            ")
                );
            }
        }
        let key = |unmet: &UnmetRequirement| match unmet.kind {
            RequirementKind::Rule => Some("rule"),
            RequirementKind::Detection => Some("detects"),
            RequirementKind::Share | RequirementKind::Fitness => None,
        };
        if let Some((key, unmet)) = run.lacking().find_map(|unmet| Some((key(unmet)?, unmet))) {
            let words = format!(
                "To lift a requirement, add to frames-lint.yaml: `require: [{{{key}: {}, lifted: REASON}}]`",
                unmet.rule
            );
            let _ = writeln!(out, "{}", wrap(&words, style.width, "  ", "  "));
        }
        out.push('\n');
    }
    let accepted = || {
        run.unmet
            .iter()
            .filter_map(|unmet| Some((unmet, unmet.waived.as_ref()?)))
    };
    if accepted().next().is_some() {
        heading(
            style,
            "Requirements not met, waived",
            accepted().count(),
            "requirement",
            out,
        );
        for (unmet, waived) in accepted() {
            requirement(unmet, style, out);
            let words = wrap(&one_line(&waived.words()), style.width, "    waived: ", "            ");
            let _ = writeln!(out, "{words}");
        }
        out.push('\n');
    }
}

fn requirement(unmet: &UnmetRequirement, style: Style, out: &mut String) {
    let subject = unmet
        .subject
        .as_ref()
        .map_or_else(String::new, |subject| format!(" of `{subject}`"));
    let head = style.paint(Ink::Strong, &format!("{} {}", unmet.rule, unmet.name));
    let _ = writeln!(out, "  {head}{} ({})", one_line(&subject), one_line(&unmet.origin));
    for why in unmet.reasons() {
        let _ = writeln!(out, "{}", wrap(&one_line(&why), style.width, "    ", "      "));
    }
}

/// `2 requirements are not met`.
pub(super) fn unmet_words(run: &Run) -> Option<String> {
    let count = run.lacking().count();
    let verb = if count == 1 { "is" } else { "are" };
    (count > 0).then(|| format!("{} {verb} not met.", plural(count, "requirement")))
}

/// Waived findings and requirements that are not met, a line each.
pub(super) fn concise(run: &Run, locator: &Locator, style: Style, out: &mut String) {
    for one in run.verdict.waived() {
        let words = one.waived.as_ref().map(Acceptance::words).unwrap_or_default();
        out.push_str("waived: ");
        finding::line(one, locator, style, out);
        out.truncate(out.trim_end().len());
        let _ = writeln!(out, " [{}]", one_line(&words));
    }
    for unmet in run.lacking() {
        let _ = writeln!(out, "{}: {}", one_line(&unmet.origin), one_line(&unmet.words()));
    }
}
