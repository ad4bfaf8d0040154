//! Applies what the user accepts and requires: the policy of the configuration, a baseline, today's date, and the rules about waivers.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use crate::assure::Assurance;
use crate::config::Config;
use crate::files;
use crate::page::Page;
use crate::policy::baseline::{self, Document};
use crate::policy::{self, AppliedPolicy, Context, Exception, Policy};
use crate::read::calibration::document::Node;
use crate::read::calibration::events;
use crate::read::calibration::repair::OffsetMap;
use crate::rules::RULES;
use crate::run::Run;
use crate::source::{LineIndex, Place, Source, SourceId, SourceKind, Span};
use crate::verdict::waiver::Day;
use crate::verdict::{Row, Verdict};
use crate::visible::pretty_json;

use super::enabled::EnabledRule;
use super::governed::Configurations;
use super::{Options, UsageError, judge};

/// What the user accepts and requires, for every verdict of a run.
pub(super) struct RunPolicy<'a> {
    /// By the indices of the configurations.
    each: Vec<ConfigPolicy>,
    /// Every rule.
    rules: Vec<&'static Page>,
    /// The base folder of the baseline's paths, if there is a baseline.
    folder: Option<PathBuf>,
    today: Day,
    enabled: Vec<&'a EnabledRule>,
    /// Whether comments in the inputs accept findings.
    comments: bool,
}

/// The policy of one configuration.
struct ConfigPolicy {
    policy: Policy,
    /// Codes of the rules that run.
    asked: BTreeSet<String>,
}

/// What is changed and accepted in verdicts on copies of a world.
pub(super) struct PolicyOfCopies<'p> {
    run: &'p RunPolicy<'p>,
    governing: &'p ConfigPolicy,
    exceptions: Vec<Exception>,
}

impl PolicyOfCopies<'_> {
    /// Marks a verdict on a copy with these sources.
    pub(super) fn mark(&self, verdict: &mut Verdict, sources: &[Arc<Source>]) {
        let marks = (self.governing.policy.weights.as_slice(), self.exceptions.clone());
        self.run.with(sources, &[], &self.governing.asked, |context| {
            policy::mark(verdict, marks, context);
        });
    }
}

/// What requirements are checked against besides a verdict.
#[derive(Default)]
pub(super) struct RequirementContext<'a> {
    /// Outcomes of what was judged beside it.
    pub(super) beside: &'a [Row],
    /// Label of the recording, if each has its own verdict.
    pub(super) recording: Option<&'a str>,
    /// Trials of known mistakes, by the indices of the configurations.
    pub(super) assured: &'a [(usize, Assurance)],
}

impl<'a> RunPolicy<'a> {
    /// Reads the baseline, which becomes a source after the existing ones, which include the configurations.
    pub(super) fn new(
        options: &'a Options,
        governed: &'a Configurations,
        sources: &mut Vec<Arc<Source>>,
    ) -> Result<Self, UsageError> {
        let first = sources
            .iter()
            .position(|source| source.kind == SourceKind::Configuration);
        let first = first.and_then(|at| u32::try_from(at).ok());
        let of_config = |config: &Option<Config>| Some(config.as_ref()?.policy(first?));
        let each = governed.each().map(|one| ConfigPolicy {
            policy: of_config(&one.config).unwrap_or_default(),
            asked: one
                .choice
                .rules
                .iter()
                .map(|rule| rule.entry.page.code.to_owned())
                .collect(),
        });
        let mut each: Vec<ConfigPolicy> = each.collect();
        if let Some(path) = &options.baseline {
            let (document, mut source, spans) = read_baseline(path)?;
            let id = SourceId(u32::try_from(sources.len()).unwrap_or(u32::MAX));
            source.id = id;
            let lines = LineIndex::new(&source.text);
            let place = |index: usize| {
                let span = spans.get(index).copied().unwrap_or_default();
                let line = lines.locate(&source.text, span.start).line;
                (Place::text(id, span), format!("{}:{line}", source.path))
            };
            let exceptions = baseline::exceptions(&document, place);
            for one in &mut each {
                one.policy.exceptions.extend(exceptions.iter().cloned());
            }
            sources.push(Arc::new(source));
        }
        Ok(Self {
            each,
            rules: RULES.iter().map(|entry| entry.page).collect(),
            folder: options.baseline.as_deref().and_then(folder_of),
            today: options.today.clone().unwrap_or_else(|| Day::of(SystemTime::now())),
            enabled: governed.rules(),
            comments: governed.counts_comments(options),
        })
    }

    /// Applies to verdicts what the configurations with these indices accept and, if wanted, require. Returns one verdict of all.
    pub(super) fn apply(
        &self,
        verdicts: impl IntoIterator<Item = (usize, Verdict)>,
        (sources, platforms): (&[Arc<Source>], &[String]),
        demanded: Option<&RequirementContext>,
    ) -> (Verdict, AppliedPolicy) {
        let mut parts: BTreeMap<usize, Vec<Verdict>> = BTreeMap::new();
        for (governed, verdict) in verdicts {
            parts.entry(governed).or_default().push(verdict);
        }
        let (mut whole, mut all) = (Verdict::default(), AppliedPolicy::default());
        for (at, verdicts) in parts {
            let Some(governing) = self.each.get(at) else { continue };
            let mut verdict = Verdict::default();
            // With room for the rules on acceptances, which come last: to grow afterwards would copy all rows.
            let rows: usize = verdicts.iter().map(|one| one.rows.len()).sum();
            verdict.rows.reserve_exact(rows + self.enabled.len());
            for one in verdicts {
                verdict.extend(one);
            }
            let mut applied = self.with(sources, platforms, &governing.asked, |context| {
                policy::apply(&mut verdict, &governing.policy, context)
            });
            if let Some(demanded) = demanded {
                let rows = (verdict.rows.as_slice(), demanded.beside);
                let assured = demanded.assured.iter().filter(|(governed, _)| *governed == at);
                let assured: Vec<&Assurance> = assured.map(|(_, assurance)| assurance).collect();
                self.with(&[], platforms, &governing.asked, |context| {
                    let evidence = (rows, assured.as_slice());
                    applied.demand(evidence, &governing.policy, demanded.recording, context);
                });
            }
            all.join(applied);
            whole.extend(verdict);
        }
        (whole, all)
    }

    /// What the configuration with this index and the comments in these sources accept, for verdicts on copies of a world.
    pub(super) fn of_copies(&self, at: usize, sources: &[Arc<Source>]) -> Option<PolicyOfCopies<'_>> {
        let governing = self.each.get(at)?;
        let known = |context: &Context| policy::exceptions(&governing.policy, context).0;
        let exceptions = self.with(sources, &[], &governing.asked, known);
        let is_any = !exceptions.is_empty() || !governing.policy.weights.is_empty();
        is_any.then_some(PolicyOfCopies {
            run: self,
            governing,
            exceptions,
        })
    }

    /// Whether anything is required at all.
    pub(super) fn demands(&self) -> bool {
        self.each.iter().any(|one| !one.policy.required.is_empty())
    }

    /// Ends a run: requirements, the effect of every acceptance, and the rules about these.
    pub(super) fn close(&self, applied: AppliedPolicy, run: &mut Run) {
        let asked = self.each.iter().flat_map(|one| one.asked.iter().cloned()).collect();
        let passed = self.with(&run.sources, &run.platforms, &asked, |context| {
            applied.close(&run.verdict, context)
        });
        judge::judge_policy(&passed.applied, &passed.misspelt, &self.enabled, &mut run.verdict);
        run.unmet = passed.unmet;
        let has_recording = run.sources.iter().any(|source| source.kind.is_bag());
        for unmet in run.unmet.iter_mut().filter(|unmet| unmet.record.is_none()) {
            let rule = self.rules.iter().find(|rule| rule.code == unmet.rule);
            let kinds = rule.map_or(&[][..], |rule| rule.evidence).iter().copied();
            // A recording that is there is not asked for.
            let lacking: Vec<&str> = kinds.filter(|kind| *kind != "recording" || !has_recording).collect();
            unmet.record = crate::tables::recordings::advice(&lacking);
        }
    }

    fn with<T>(
        &self,
        sources: &[Arc<Source>],
        platforms: &[String],
        asked: &BTreeSet<String>,
        ask: impl FnOnce(&Context) -> T,
    ) -> T {
        let known_as = |source: &Source| path_from(self.folder.as_deref(), source);
        ask(&Context {
            sources,
            platforms,
            rules: &self.rules,
            asked,
            known_as: self.folder.is_some().then_some(&known_as),
            today: &self.today,
            comments: self.comments,
        })
    }
}

/// Writes the findings of a run to a baseline, and accepts them in the run. Returns their number.
pub fn write_baseline(run: &mut Run, path: &Path) -> Result<usize, UsageError> {
    let folder = folder_of(path);
    let document = baseline::of(
        &run.verdict,
        &Context {
            sources: &run.sources,
            platforms: &run.platforms,
            rules: &[],
            asked: &BTreeSet::new(),
            known_as: Some(&|source| path_from(folder.as_deref(), source)),
            today: &Day::of(SystemTime::UNIX_EPOCH),
            comments: true,
        },
    );
    let failed = |what: String| UsageError(format!("cannot write `{}`: {what}", path.display()));
    let text = pretty_json(&document).map_err(|error| failed(error.to_string()))?;
    files::write(path, text.as_bytes()).map_err(|error| failed(error.to_string()))?;
    baseline::accept_all(&mut run.verdict, &path.display().to_string());
    Ok(document.findings.iter().map(|entry| entry.count).sum())
}

/// The path of a source relative to the folder of a baseline if it is below it, else unchanged.
fn path_from(folder: Option<&Path>, source: &Source) -> String {
    let below = || {
        let whole = std::fs::canonicalize(&source.path).ok()?;
        let parts = whole.strip_prefix(folder?).ok()?.components();
        let parts: Vec<_> = parts.map(|part| part.as_os_str().to_string_lossy()).collect();
        Some(parts.join("/"))
    };
    below().unwrap_or_else(|| source.path.clone())
}

/// The folder of a baseline, without links.
fn folder_of(baseline: &Path) -> Option<PathBuf> {
    let folder = baseline.parent().filter(|folder| !folder.as_os_str().is_empty());
    std::fs::canonicalize(folder.unwrap_or(Path::new("."))).ok()
}

/// A baseline, as a source of the run, and the places of its entries.
fn read_baseline(path: &Path) -> Result<(Document, Source, Vec<Span>), UsageError> {
    let shown = path.display().to_string();
    let failed = |what: String| UsageError(format!("baseline `{shown}`: {what}"));
    let text = std::fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
    let document: Document = serde_json::from_str(&text).map_err(|error| failed(error.to_string()))?;
    if document.schema != baseline::SCHEMA {
        let what = format!("its schema is `{}`, not `{}`", document.schema, baseline::SCHEMA);
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
