//! Whether recordings are fit for calibrations: each condition with what was measured.

use std::fmt::Write;

use crate::fitness::{ConditionState, FitnessWord};
use crate::run::Run;

use super::super::fitness::{state, title};
use super::super::style::{Ink, Style};
use super::super::text::{one_line, wrap};
use super::measured_words;

/// The conditions of every calibration that was asked for.
pub(super) fn section(run: &Run, style: Style, out: &mut String) {
    for one in &run.fitness {
        let ink = match one.verdict() {
            FitnessWord::Fit => Ink::Good,
            FitnessWord::NotFit => Ink::Error,
            FitnessWord::Unknown => Ink::Warning,
        };
        let _ = writeln!(
            out,
            "{}",
            style.paint(ink, &wrap(&one_line(&title(one)), style.width, "", "  "))
        );
        for condition in &one.conditions {
            let mut line = |text: &str, first: &str, rest: &str| {
                let _ = writeln!(out, "{}", wrap(&one_line(text), style.width, first, rest));
            };
            line(
                &format!("{}: {}: {}", state(condition), condition.name, condition.asks),
                "  ",
                "      ",
            );
            let measured: Vec<String> = condition.measured.iter().map(measured_words).collect();
            if !measured.is_empty() {
                line(&measured.join("; "), "      ", "        ");
            }
            if let Some(reason) = &condition.reason {
                line(&format!("why: {reason}"), "      ", "        ");
            }
            if let Some(record) = condition
                .record
                .as_ref()
                .filter(|_| condition.state != ConditionState::Met)
            {
                line(&format!("record or add: {record}"), "      ", "        ");
            }
        }
        out.push('\n');
    }
}
