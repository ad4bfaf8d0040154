//! Every rule's page is a test: its Bad, Good and Not evaluated blocks are run, and must give what the page says. Each is laid out and judged
//! once: what is saved of it is judged the same, what is wrong can be seen, and fixes leave nothing.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::string_slice)]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::support::point_files::PointsRecipe;
use crate::support::{self, deference};
use crate::{evidence, fixes, views};
use frames_lint::engine::{self, Options, Retention, VerdictScope};
use frames_lint::page::{self, Block, Page};
use frames_lint::rules::RULES;
use frames_lint::run::Run;
use frames_lint::source::{LineIndex, SourcePart};
use frames_lint::verdict::{Finding, Outcome, PlaceRole, Severity};
use frames_lint::world::World;
use rayon::prelude::*;

/// One case of a page: the blocks under a section, or under one of its `### ` headings.
pub(crate) struct Case<'a> {
    pub(crate) title: String,
    blocks: Vec<Block<'a>>,
}

pub(crate) fn cases<'a>(section: &page::Section<'a>) -> Vec<Case<'a>> {
    let mut parts: Vec<(String, &str)> = Vec::new();
    let mut rest = section.text;
    let mut title = section.title.to_owned();
    while let Some(at) = find_heading(rest) {
        parts.push((title, &rest[..at]));
        let line_end = rest[at..].find('\n').map_or(rest.len(), |n| at + n + 1);
        title = format!("{}, {}", section.title, rest[at + 4..line_end].trim());
        rest = &rest[line_end..];
    }
    parts.push((title, rest));
    parts
        .into_iter()
        .map(|(title, text)| Case {
            title,
            blocks: page::blocks(text),
        })
        .filter(|case| case.blocks.iter().any(is_input))
        .collect()
}

/// Offset of the next `### ` line outside fences.
fn find_heading(text: &str) -> Option<usize> {
    let mut offset = 0;
    let mut fenced = false;
    for line in text.split_inclusive('\n') {
        if line.starts_with("```") {
            fenced = !fenced;
        } else if !fenced && line.starts_with("### ") {
            return Some(offset);
        }
        offset += line.len();
    }
    None
}

fn is_input(block: &Block<'_>) -> bool {
    !block.argument.is_empty()
}

/// A folder with the files of a case; recipes become recordings.
pub(crate) fn laid_out(case: &Case<'_>) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for block in case.blocks.iter().filter(|block| is_input(block)) {
        let path = folder.path().join(block.argument);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        if block.language == "recipe" {
            support::write(block.text, &path);
        } else if block.language == "cloud" {
            PointsRecipe::parse(block.text).write(&path);
        } else {
            fs::write(&path, block.text).unwrap();
        }
    }
    folder
}

/// The platforms of a case.
pub(crate) fn worlds(case: &Case<'_>) -> Vec<World> {
    let folder = laid_out(case);
    let options = Options {
        paths: vec![folder.path().to_path_buf()],
        verdicts: VerdictScope::One,
        sights: Retention::Everything,
        ..Options::default()
    };
    engine::check(&options).unwrap().seen
}

fn run_case(case: &Case<'_>) -> (tempfile::TempDir, Run) {
    let folder = laid_out(case);
    let run = support::checked(folder.path());
    let crashed = run.verdict.rows.iter().find(|row| row.outcome == Outcome::Crashed);
    assert!(crashed.is_none(), "{}: {crashed:?}", case.title);
    (folder, run)
}

fn expectations(case: &Case<'_>) -> Vec<String> {
    case.blocks
        .iter()
        .filter(|block| block.language == "expect")
        .flat_map(|block| block.text.lines())
        .map(|line| line.trim().to_owned())
        .filter(|line| !line.is_empty())
        .collect()
}

/// A finding in the words of an `expect` line, with only the parts that the line asks for.
fn describe(run: &Run, folder: &Path, finding: &Finding, line: &str) -> String {
    let primary = finding
        .places
        .iter()
        .find(|label| label.role == PlaceRole::Primary)
        .unwrap();
    let source = &run.sources[primary.place.source.0 as usize];
    let path = Path::new(&source.path);
    let file = path.strip_prefix(folder).unwrap_or(path).display();
    let mut text = format!("{} {} {file}", finding.severity.word(), finding.confidence.word());
    if line.split_whitespace().nth(2).is_some_and(|place| place.contains(':')) {
        match &primary.place.at {
            SourcePart::Text(span) => {
                let at = LineIndex::new(&source.text).locate(&source.text, span.start);
                write!(text, ":{}", at.line).unwrap();
            }
            other => write!(text, ":{other:?}").unwrap(),
        }
    }
    for word in line.split_whitespace().skip(3) {
        if word.starts_with("topic=") {
            let topic = match &primary.place.at {
                SourcePart::Message(message) => message.topic.as_str(),
                _ => "-",
            };
            write!(text, " topic={topic}").unwrap();
        } else if word.starts_with("relation=") {
            write!(text, " relation={}", finding.relation.as_deref().unwrap_or("-")).unwrap();
        }
    }
    text
}

/// Pairs every expected line with one finding; what is left over on either side is reported.
fn compare(run: &Run, folder: &Path, code: &str, expected: &[String], faults: &mut Vec<String>, title: &str) {
    let mut left: Vec<&Finding> = run
        .verdict
        .findings
        .iter()
        .filter(|finding| finding.rule == code)
        .collect();
    for line in expected {
        let wanted: String = line.split_whitespace().collect::<Vec<_>>().join(" ");
        match left
            .iter()
            .position(|finding| describe(run, folder, finding, line) == wanted)
        {
            Some(at) => {
                left.remove(at);
            }
            None => faults.push(format!(
                "{code} {title}: expected `{wanted}`, and no finding is that: {}",
                reasons(run, code)
            )),
        }
    }
    for finding in left {
        let full = describe(run, folder, finding, "x x x:1 topic= relation=");
        faults.push(format!("{code} {title}: not expected: `{full}`: {}", finding.message));
    }
}

fn input_problems(run: &Run, code: &str, title: &str) -> Vec<String> {
    run.sources
        .iter()
        .flat_map(|source| &source.problems)
        .map(|problem| format!("{code} {title}: input problem: {}", problem.message))
        .collect()
}

fn rows(run: &Run, code: &str, outcome: Outcome) -> usize {
    run.verdict
        .rows
        .iter()
        .filter(|row| row.rule == code && row.outcome == outcome)
        .count()
}

/// What the rule said where it judged nothing.
fn reasons(run: &Run, code: &str) -> String {
    let rows = run.verdict.rows.iter().filter(|row| row.rule == code);
    let said: Vec<&str> = rows.filter_map(|row| row.reason.as_deref()).collect();
    said.join("; ")
}

fn check_bad(page: &Page, case: &Case<'_>, (folder, run): (&Path, &Run), faults: &mut Vec<String>) {
    let expected = expectations(case);
    if expected.is_empty() {
        faults.push(format!(
            "{} {}: a bad case needs an expect block",
            page.code, case.title
        ));
    }
    compare(run, folder, page.code, &expected, faults, &case.title);
}

fn check_good(page: &Page, case: &Case<'_>, run: &Run, faults: &mut Vec<String>) {
    let code = page.code;
    faults.extend(input_problems(run, code, &case.title));
    if rows(run, code, Outcome::Pass) == 0 {
        faults.push(format!(
            "{code} {}: a good case must pass, and nothing passed: {}",
            case.title,
            reasons(run, code)
        ));
    }
    for finding in &run.verdict.findings {
        if finding.rule == *code || finding.severity > Severity::Note {
            faults.push(format!(
                "{code} {}: a good case gave {} {}: {}",
                case.title, finding.rule, finding.name, finding.message
            ));
        }
    }
}

fn check_not_evaluated(page: &Page, case: &Case<'_>, run: &Run, faults: &mut Vec<String>) {
    let code = page.code;
    if rows(run, code, Outcome::Pass) + rows(run, code, Outcome::Fail) > 0 {
        faults.push(format!("{code} {}: was evaluated", case.title));
    }
    for line in expectations(case) {
        let (outcome, reason) = match (line.strip_prefix("not-evaluated "), line.as_str()) {
            (Some(reason), _) => (Outcome::NotEvaluated, reason),
            (None, reason) if reason.starts_with("explained by ") => (Outcome::Explained, reason),
            _ => {
                let what = "an expect line here opens with `not-evaluated` or `explained by`";
                faults.push(format!("{code} {}: {what}", case.title));
                continue;
            }
        };
        let said = run
            .verdict
            .rows
            .iter()
            .filter(|row| row.rule == *code && row.outcome == outcome)
            .any(|row| row.reason.as_deref().is_some_and(|said| said.contains(reason)));
        if !said {
            let all: Vec<_> = run.verdict.rows.iter().filter(|row| row.rule == *code).collect();
            faults.push(format!("{code} {}: no reason holds `{reason}`: {all:?}", case.title));
        }
    }
}

/// A case, with the page and the section that it is of.
struct PageCase {
    page: &'static Page,
    section: &'static str,
    case: Case<'static>,
}

impl PageCase {
    fn faults(&self) -> Vec<String> {
        let (page, case) = (self.page, &self.case);
        let mut faults = Vec::new();
        let (folder, run) = run_case(case);
        let folder = folder.path();
        match self.section {
            "Bad" => check_bad(page, case, (folder, &run), &mut faults),
            "Good" => check_good(page, case, &run, &mut faults),
            _ => check_not_evaluated(page, case, &run, &mut faults),
        }
        evidence::is_the_same(&[folder], &format!("{} {}", page.code, case.title), Some(&run));
        if self.section == "Bad" {
            let looked_at = views::looked_at(folder, VerdictScope::One);
            faults.extend(views::unseen(page, &case.title, &looked_at));
            // No reason points at a rule that is silent.
            let dangling = looked_at.seen.iter().flat_map(deference::faults);
            faults.extend(dangling.map(|fault| format!("{} {}: {fault}", page.code, case.title)));
            // Last: files are changed.
            faults.extend(fixes::uncorrected(page, &case.title, folder, &run));
        }
        faults
    }
}

fn asked(page: &'static Page, faults: &mut Vec<String>) -> Vec<PageCase> {
    let mut all = Vec::new();
    for section in page::sections(page.body) {
        if !["Bad", "Good", "Not evaluated"].contains(&section.title) {
            continue;
        }
        let known = all.len();
        let of = |case| PageCase {
            page,
            section: section.title,
            case,
        };
        all.extend(cases(&section).into_iter().map(of));
        if all.len() == known {
            faults.push(format!("{}: section {} has no case", page.code, section.title));
        }
    }
    all
}

#[test]
fn every_page_gives_what_it_says() {
    let only = std::env::var("ONLY").unwrap_or_default();
    let pages = RULES.iter().map(|entry| entry.page);
    let pages = pages.filter(|page| only.is_empty() || only.split(',').any(|code| page.code.starts_with(code)));
    let mut faults = Vec::new();
    let mut all = Vec::new();
    for page in pages {
        all.extend(asked(page, &mut faults));
    }
    assert!(all.len() > 500 || !only.is_empty(), "{}", all.len());
    faults.extend(all.par_iter().flat_map_iter(PageCase::faults).collect::<Vec<_>>());
    faults.sort();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}
