//! Whether recordings are fit for calibrations: a table of conditions for each.

use maud::{Markup, html};

use crate::fitness::{Condition, ConditionState};
use crate::run::Run;

use super::super::fitness::{state, title};
use super::super::terminal::measured_words;
use super::words::{badge, plain, words};

pub(super) fn render(run: &Run) -> Option<Markup> {
    (!run.fitness.is_empty()).then(|| {
        html! {
            @for fitness in &run.fitness {
                h3 { (words(&title(fitness))) }
                table class="cards" {
                    thead { tr {
                        th scope="col" { "Condition" } th scope="col" { "State" } th scope="col" { "Measured, and why" }
                        th scope="col" { "What to record or add" }
                    } }
                    tbody { @for condition in &fitness.conditions { (row(condition)) } }
                }
            }
        }
    })
}

fn row(condition: &Condition) -> Markup {
    let (class, sign) = match condition.state {
        ConditionState::Met => ("pass", "✓"),
        ConditionState::NotMet if condition.is_needed => ("fail", "✗"),
        ConditionState::NotMet => ("waived", "~"),
        ConditionState::NotEvaluated => ("open", "!"),
    };
    html! {
        tr {
            th scope="row" { (condition.name) p class="small" { (words(&condition.asks)) } }
            td data-name="State" { (badge(class, sign, &state(condition))) }
            td data-name="Measured, and why" {
                ul class="bare" { @for measured in &condition.measured { li { (plain(&measured_words(measured))) } } }
                @if let Some(reason) = &condition.reason { p { (words(reason)) } }
            }
            td data-name="What to record or add" { @if let Some(record) = &condition.record { (words(record)) } }
        }
    }
}
