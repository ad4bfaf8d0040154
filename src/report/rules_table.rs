//! The list of rules: for a terminal, as JSON, and as a Markdown table.

use std::fmt::Write;

use serde::Serialize;

use crate::page::{Page, Status, url};
use crate::visible::pretty_json;

use super::Style;
use super::style::Ink;
use super::text::wrap;

#[derive(Serialize)]
struct Row<'a> {
    code: &'a str,
    name: &'a str,
    family: &'a str,
    severity: &'static str,
    confidence: &'static str,
    status: &'static str,
    since: &'a str,
    subject: &'a str,
    summary: &'a str,
}

fn status(rule: &Page) -> &'static str {
    match rule.status {
        Status::Trial => "trial",
        Status::Stable => "stable",
    }
}

/// Columns for a terminal; the summary is wrapped in its column.
pub fn text(rules: &[&Page], style: Style) -> String {
    let codes = rules.iter().map(|rule| rule.code.len()).max().unwrap_or(0).max(4);
    let names = rules.iter().map(|rule| rule.name.len()).max().unwrap_or(0).max(4);
    let columns = |code: &str, name: &str, severity: &str, confidence: &str, status: &str| {
        format!("{code:<codes$}  {name:<names$}  {severity:<8}  {confidence:<10}  {status:<6}  ")
    };
    let heading = columns("code", "name", "severity", "confidence", "status") + "a finding says";
    let mut out = format!("{}\n", style.paint(Ink::Faint, &heading));
    for rule in rules {
        let row = columns(
            rule.code,
            rule.name,
            rule.severity.word(),
            rule.confidence.word(),
            status(rule),
        );
        // In a narrow terminal the summary goes on separate lines.
        let beside = style.width.is_none_or(|width| width >= row.len() + 30);
        if beside {
            let indent = " ".repeat(row.len());
            let _ = writeln!(out, "{}", wrap(rule.summary, style.width, &row, &indent));
        } else {
            let _ = writeln!(
                out,
                "{}\n{}",
                row.trim_end(),
                wrap(rule.summary, style.width, "    ", "    ")
            );
        }
    }
    out
}

/// An array of objects.
pub fn json(rules: &[&Page]) -> Result<String, serde_json::Error> {
    let rows: Vec<Row> = rules
        .iter()
        .map(|rule| Row {
            code: rule.code,
            name: rule.name,
            family: rule.family(),
            severity: rule.severity.word(),
            confidence: rule.confidence.word(),
            status: status(rule),
            since: rule.since,
            subject: rule.subject,
            summary: rule.summary,
        })
        .collect();
    pretty_json(&rows)
}

/// A Markdown table with links to the pages.
pub fn markdown(rules: &[&Page]) -> String {
    let mut out = String::from("| code | name | severity | confidence | a finding says |\n|---|---|---|---|---|\n");
    for rule in rules {
        let trial = if rule.status == Status::Trial { " (trial)" } else { "" };
        let _ = writeln!(
            out,
            "| {} | [{}]({}){trial} | {} | {} | {} |",
            rule.code,
            rule.name,
            url(rule.code),
            rule.severity.word(),
            rule.confidence.word(),
            rule.summary.replace('|', "\\|"),
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Confidence;
    use crate::verdict::Severity;

    fn rule() -> Page {
        Page {
            code: "TREE01",
            name: "orphan-subtree",
            summary: "frames that no chain of transforms connects to the rest of the tree",
            severity: Severity::Error,
            confidence: Confidence::Certain,
            status: Status::Stable,
            subject: "a tree",
            view: "frames",
            since: "0.1.0",
            evidence: &[],
            limits: &[],
            references: &[],
            body: "",
        }
    }

    #[test]
    fn a_rule_stands_on_a_line_or_wraps() {
        let line = "TREE01  orphan-subtree  error     certain     stable  frames that no chain of transforms connects to \
                    the rest of the tree\n";
        assert_eq!(text(&[&rule()], Style::PLAIN).lines().nth(1), Some(line.trim_end()));
        let narrow = Style {
            width: Some(60),
            ..Style::PLAIN
        };
        let narrow = text(&[&rule()], narrow);
        assert!(
            narrow.contains("stable\n    frames that no chain of transforms connects to the rest\n    of the tree\n"),
            "{narrow}"
        );
    }

    #[test]
    fn the_markdown_table_links_to_pages() {
        let mut trial = rule();
        trial.status = Status::Trial;
        trial.summary = "a | b";
        let link = format!(
            "| TREE01 | [orphan-subtree]({}) (trial) | error | certain | a \\| b |",
            url("TREE01")
        );
        assert_eq!(markdown(&[&trial]).lines().nth(2), Some(link.as_str()));
    }

    #[test]
    fn json_names_every_column() {
        let value: serde_json::Value = serde_json::from_str(&json(&[&rule()]).unwrap()).unwrap();
        assert_eq!(value[0]["code"], "TREE01");
        assert_eq!(value[0]["status"], "stable");
        assert_eq!(value[0].as_object().unwrap().len(), 9);
    }
}
