//! Parsers and completions of the values of arguments.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, Command, CommandFactory, ValueEnum};
use clap_complete::CompletionCandidate;
use clap_complete::engine::{PathCompleter, ValueCompleter, complete_possible_values};

use crate::faults::{SIZES, Selection, catalogue};
use crate::fitness::Calibration;
use crate::report::Format;
use crate::rules::RULES;
use crate::run::FailOn;

use super::{Cli, Output};

/// The kinds of calibration.
pub(super) fn calibrations() -> impl TypedValueParser<Value = Calibration> {
    let known = |word: String| {
        Calibration::ALL
            .into_iter()
            .find(|kind| kind.word() == word)
            .ok_or("unknown")
    };
    PossibleValuesParser::new(Calibration::ALL.map(Calibration::word)).try_map(known)
}

/// The codes of rules, for completion; their names where no code matches.
pub(super) fn rules() -> Vec<CompletionCandidate> {
    let pages = RULES.iter().map(|entry| entry.page);
    pages
        .flat_map(|page| {
            let summary = Some(page.summary.into());
            [(page.code, false), (page.name, true)]
                .map(|(word, hide)| CompletionCandidate::new(word).help(summary.clone()).hide(hide))
        })
        .collect()
}

/// The codes and names of rules, and the families.
pub(super) fn selectors() -> Vec<CompletionCandidate> {
    let families: BTreeSet<&str> = RULES.iter().map(|entry| entry.page.family()).collect();
    families
        .into_iter()
        .map(CompletionCandidate::new)
        .chain(rules())
        .collect()
}

/// The known mistakes and their families, for completion.
pub(super) fn mistakes() -> Vec<CompletionCandidate> {
    let families: BTreeSet<&str> = catalogue().map(|fault| fault.family.word()).chain([SIZES]).collect();
    let Selection { faults, sizes, .. } = Selection::all();
    let faults = faults.iter().map(|fault| (fault.name, fault.sentence));
    let described = faults.chain(sizes.iter().map(|fault| (fault.name, fault.sentence)));
    let names = described.map(|(name, sentence)| CompletionCandidate::new(name).help(Some(sentence.into())));
    families
        .into_iter()
        .map(CompletionCandidate::new)
        .chain(names)
        .collect()
}

/// The commands, for completion.
pub(super) fn verbs() -> Vec<CompletionCandidate> {
    let command = Cli::command();
    command
        .get_subcommands()
        .map(|verb| CompletionCandidate::new(verb.get_name()).help(verb.get_about().cloned()))
        .collect()
}

/// Files, and formats before a `=` and a file, for completion.
pub(super) fn outputs(current: &OsStr) -> Vec<CompletionCandidate> {
    let files = |begun: &OsStr| PathCompleter::file().complete(begun);
    let formed = current.to_str().and_then(|text| text.split_once('='));
    if let Some((word, file)) = formed.filter(|(word, _)| Format::from_str(word, false).is_ok()) {
        let files = files(OsStr::new(file)).into_iter();
        return files.map(|file| file.add_prefix(format!("{word}="))).collect();
    }
    let forms = Format::value_variants().iter().filter_map(ValueEnum::to_possible_value);
    let mut known: Vec<CompletionCandidate> = complete_possible_values(current, forms)
        .into_iter()
        .map(|form| CompletionCandidate::new(format!("{}=", form.get_value().display())).help(form.get_help().cloned()))
        .collect();
    known.extend(files(current));
    known
}

/// `FILE` or `FORMAT=FILE`. A file whose name has a `=` behind another word is a file; a format alone is no file.
pub(super) fn output<F: ValueEnum>(text: &str) -> Result<Output<F>, String> {
    let format = |word: &str| F::from_str(word, false).ok();
    if format(text).is_some() {
        return Err(format!(
            "this is a format: use --format {text}, {text}=FILE, or ./{text} for a file of this name"
        ));
    }
    let known = text
        .split_once('=')
        .and_then(|(word, file)| Some((format(word)?, file)));
    let (format, file) = known.map_or((None, text), |(format, file)| (Some(format), file));
    Ok(Output {
        format,
        file: PathBuf::from(file),
    })
}

/// The format of a report by the extension of its file; `human` for any other extension.
pub(super) fn by_ending(file: &Path) -> Format {
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("sarif") => Format::Sarif,
        Some("html" | "htm") => Format::Html,
        Some("json") => Format::Json,
        Some("jsonl" | "ndjson") => Format::JsonLines,
        Some("xml") => Format::Junit,
        Some("md") => Format::Markdown,
        _ => Format::Human,
    }
}

/// The notations and dialects that `convert` writes. They come from a table, which is read only when needed.
#[derive(Clone)]
pub(super) struct Targets;

impl TypedValueParser for Targets {
    type Value = String;

    fn parse_ref(&self, cmd: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<String, clap::Error> {
        PossibleValuesParser::new(crate::convert::targets()).parse_ref(cmd, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(crate::convert::targets().into_iter().map(PossibleValue::new)))
    }
}

/// `TARGET from SOURCE`.
pub(super) fn is(text: &str) -> Result<(String, String), String> {
    let (target, source) = text.split_once(" from ").ok_or("expected `TARGET from SOURCE`")?;
    Ok((target.trim().to_owned(), source.trim().to_owned()))
}

/// Bytes: `800kB`, `100MB`, `2GB`; a number without a unit is in megabytes.
pub(super) fn size(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let factor = match unit.trim().to_lowercase().as_str() {
        "kb" => 1_000,
        "" | "mb" => 1_000_000,
        "gb" => 1_000_000_000,
        _ => return Err("unknown unit: use kB, MB or GB, as in 100MB".to_owned()),
    };
    let number: u64 = number
        .parse()
        .map_err(|_| "expected a whole number and a unit, as in 100MB".to_owned())?;
    let bytes = number.checked_mul(factor).filter(|bytes| *bytes > 0);
    bytes.ok_or_else(|| "the size must be above 0 and below 16 EiB".to_owned())
}

pub(super) fn xacro_arg(text: &str) -> Result<String, String> {
    match text.split_once(":=") {
        Some((name, _)) if !name.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("expected name:=value".to_owned()),
    }
}

impl ValueEnum for Format {
    fn value_variants<'a>() -> &'a [Self] {
        &[
            Self::Human,
            Self::Concise,
            Self::Json,
            Self::JsonLines,
            Self::Sarif,
            Self::Github,
            Self::Gitlab,
            Self::Junit,
            Self::Markdown,
            Self::Html,
        ]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (word, help) = match self {
            Self::Human => ("human", "For people, with the lines of the inputs"),
            Self::Concise => ("concise", "One line per finding, for editors"),
            Self::Json => ("json", "One JSON document (schema/frames-lint-1.json)"),
            Self::JsonLines => (
                "json-lines",
                "One line per input, outcome and finding, written during the run",
            ),
            Self::Sarif => ("sarif", "SARIF 2.1.0"),
            Self::Github => ("github", "Workflow commands of GitHub Actions"),
            Self::Gitlab => ("gitlab", "Code Quality report of GitLab"),
            Self::Junit => ("junit", "JUnit XML, one test case per check"),
            Self::Markdown => ("markdown", "For comments on pull requests and job summaries"),
            Self::Html => ("html", "Acceptance report: one page with all results, to be signed"),
        };
        Some(PossibleValue::new(word).help(help))
    }
}

impl ValueEnum for FailOn {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Error, Self::Warning, Self::Note, Self::Never]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.word()))
    }
}
