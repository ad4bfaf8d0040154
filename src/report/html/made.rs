//! How the report was made, so that it can be reproduced: tool, command, settings, configuration.

use std::collections::BTreeMap;

use maud::{Markup, html};

use crate::page::Status;

use super::super::text::plural;
use super::words::plain;
use super::{Page, summary};

pub(super) fn render(page: &Page) -> Markup {
    let run = page.run;
    let mut since: BTreeMap<&str, usize> = BTreeMap::new();
    for rule in &run.rules {
        *since.entry(rule.since).or_default() += 1;
    }
    let trial = run.rules.iter().filter(|rule| rule.status == Status::Trial).count();
    html! {
        dl class="facts" {
            div { dt { "Tool" } dd { "frames-lint " (env!("CARGO_PKG_VERSION")) } }
            div {
                dt { "Rules" }
                dd {
                    (plural(run.rules.len(), "rule")) " ran, " (run.rules.len() - trial) " stable and " (trial) " on trial"
                    @for (index, (version, count)) in since.iter().enumerate() {
                        @if index == 0 { " (" } @else { ", " }
                        (count) " since " (version)
                        @if index + 1 == since.len() { ")" }
                    }
                    "; the checklist shows the status of each"
                }
            }
            @if !page.call.command.is_empty() {
                div { dt { "Command" } dd { pre tabindex="0" { code { (command(&page.call.command)) } } } }
            }
            @for (name, value) in &page.call.settings { div { dt { (name) } dd { (plain(value)) } } }
            div {
                dt { "Configuration" }
                dd { (summary::configuration(page)) }
            }
        }
    }
}

/// The command, quoted for a shell.
pub(super) fn command(arguments: &[String]) -> String {
    let quoted: Vec<String> = arguments.iter().map(|argument| quoted(&plain(argument))).collect();
    quoted.join(" ")
}

fn quoted(argument: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_@%+=:,./-".contains(c);
    if !argument.is_empty() && argument.chars().all(is_plain) {
        argument.to_owned()
    } else {
        format!("'{}'", argument.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_can_be_typed_again() {
        let words = [
            "frames-lint",
            "check",
            "a b",
            "it's",
            "",
            "--output",
            "html=r.html",
            "$(x)",
        ];
        assert_eq!(
            command(&words.map(str::to_owned)),
            r"frames-lint check 'a b' 'it'\''s' '' --output html=r.html '$(x)'"
        );
    }
}
