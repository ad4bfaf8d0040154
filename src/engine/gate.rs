//! Brings a run to the gate: the policy of the configuration, a baseline, today, and the rules that speak of waivers.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::SystemTime;

use crate::config::Config;
use crate::gate::baseline::{self, Document};
use crate::gate::{self, Context, Policy};
use crate::page::Front;
use crate::read::calibration::document::Node;
use crate::read::calibration::events;
use crate::read::calibration::repair::OffsetMap;
use crate::run::{RuleInfo, Run};
use crate::source::{LineIndex, Place, Source, SourceId, SourceKind};
use crate::verdict::waiver::Day;

use super::plan::{self, Enabled};
use super::{Options, UsageError, judge};

/// Lays over a run's verdict what the user asks of the gate.
pub(super) fn pass(
    run: &mut Run,
    options: &Options,
    config: Option<&Config>,
    enabled: &[Enabled],
    platforms: &[String],
) -> Result<(), UsageError> {
    let first = run
        .sources
        .iter()
        .position(|source| source.kind == SourceKind::Configuration);
    let mut policy = match (config, first.and_then(|at| u32::try_from(at).ok())) {
        (Some(config), Some(first)) => config.policy(first),
        _ => Policy::default(),
    };
    let folder = options.baseline.as_deref().and_then(Path::parent);
    if let Some(path) = &options.baseline {
        let (document, mut source, spans) = read_baseline(path)?;
        let id = SourceId(u32::try_from(run.sources.len()).unwrap_or(u32::MAX));
        source.id = id;
        let lines = LineIndex::new(&source.text);
        let place = |index: usize| {
            let span = spans.get(index).copied().unwrap_or_default();
            let line = lines.locate(&source.text, span.start).line;
            (Place::text(id, span), format!("{}:{line}", source.path))
        };
        policy.exceptions.extend(baseline::exceptions(&document, place));
        run.sources.push(source);
    }
    let rules = super::rules()?;
    let asked: BTreeSet<String> = enabled.iter().map(|rule| rule.front.code.clone()).collect();
    let paths = paths(&run.sources, folder);
    let today = options.today.clone().unwrap_or_else(|| Day::of(SystemTime::now()));
    let context = Context {
        sources: &run.sources,
        platforms,
        rules: &rules,
        asked: &asked,
        paths: &paths,
        today: &today,
    };
    let passed = gate::pass(&mut run.verdict, &policy, &context);
    judge::judge_gate(&passed.applied, &passed.misspelt, enabled, &mut run.verdict);
    run.unmet = passed.unmet;
    for unmet in &mut run.unmet {
        unmet.record = plan::all()?
            .iter()
            .find(|rule| rule.front.code == unmet.rule)
            .and_then(|rule| Front::parse(rule.entry.page).ok())
            .and_then(|front| crate::tables::recordings::advice(&front.evidence));
    }
    run.platforms = platforms.to_vec();
    Ok(())
}

/// Writes the findings of a run to a baseline, and accepts them in the run. Says how many they are.
pub fn write_baseline(run: &mut Run, path: &Path) -> Result<usize, UsageError> {
    let rules: Vec<RuleInfo> = Vec::new();
    let paths = paths(&run.sources, path.parent());
    let context = Context {
        sources: &run.sources,
        platforms: &run.platforms,
        rules: &rules,
        asked: &BTreeSet::new(),
        paths: &paths,
        today: &Day::of(SystemTime::UNIX_EPOCH),
    };
    let document = baseline::of(&run.verdict, &context);
    let failed = |what: String| UsageError(format!("cannot write `{}`: {what}", path.display()));
    let text = serde_json::to_string_pretty(&document).map_err(|error| failed(error.to_string()))?;
    std::fs::write(path, text + "\n").map_err(|error| failed(error.to_string()))?;
    baseline::accept_all(&mut run.verdict, &path.display().to_string());
    Ok(document.findings.iter().map(|entry| entry.count).sum())
}

/// The paths of sources from a folder, where they lie below it; else as they are.
fn paths(sources: &[Source], folder: Option<&Path>) -> Vec<String> {
    let folder = folder.map(|folder| {
        if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        }
    });
    let folder = folder.and_then(|folder| std::fs::canonicalize(folder).ok());
    let path = |source: &Source| {
        let below = folder.as_ref().and_then(|folder| {
            let whole = std::fs::canonicalize(&source.path).ok()?;
            let parts: Vec<String> = whole
                .strip_prefix(folder)
                .ok()?
                .components()
                .map(|part| part.as_os_str().to_string_lossy().into_owned())
                .collect();
            Some(parts.join("/"))
        });
        below.unwrap_or_else(|| source.path.clone())
    };
    sources.iter().map(path).collect()
}

/// A baseline, as a source of the run, and where its entries stand.
fn read_baseline(path: &Path) -> Result<(Document, Source, Vec<crate::source::Span>), UsageError> {
    let shown = path.display().to_string();
    let failed = |what: String| UsageError(format!("baseline `{shown}`: {what}"));
    let text = std::fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
    let document: Document = serde_json::from_str(&text).map_err(|error| failed(error.to_string()))?;
    if document.schema != baseline::SCHEMA {
        let what = format!("it is `{}`, not `{}`", document.schema, baseline::SCHEMA);
        return Err(failed(what));
    }
    let parsed = events::build(&text, &OffsetMap::default());
    let spans = parsed
        .roots
        .first()
        .and_then(|root| root.get("findings"))
        .and_then(Node::items)
        .map(|items| items.iter().map(|item| item.span).collect())
        .unwrap_or_default();
    let mut source = Source::new(SourceId(0), shown, SourceKind::Configuration);
    source.examined.bytes = text.len() as u64;
    source.examined.bytes_total = text.len() as u64;
    source.text = text;
    Ok((document, source, spans))
}
