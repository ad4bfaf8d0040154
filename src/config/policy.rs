//! The keys `fail-on`, `rules`, `limits`, `paths` and `waivers` of the configuration: what the user accepts. [`required`](super::required) reads
//! what is required.
//!
//! Which rules exist is not known here: words that name rules are kept with their places, and the engine looks them up.

use globset::GlobMatcher;

use crate::policy::{Exception, Level, RequiredShare, Requirement, Scope, Weight};
use crate::read::calibration::document::Node;
use crate::run::FailOn;
use crate::source::{Place, SourceId, Span};
use crate::verdict::Severity;
use crate::verdict::waiver::{Day, Waiver, WaiverKind};

use super::ConfigError;
use super::reader::Reader;

/// The policy of one layer.
#[derive(Clone, Debug, Default)]
pub(super) struct PolicyLayer {
    pub(super) fail_on: Option<FailOn>,
    /// Words for rules (codes, names, families), with their places in words.
    pub(super) select: Option<Vec<(String, String)>>,
    pub(super) ignore: Vec<(String, String)>,
    pub(super) named: Vec<(String, String)>,
    pub(super) weights: Vec<Weight>,
    pub(super) limits: Vec<LimitOverride>,
    waivers: Vec<WaiverDraft>,
    pub(super) required: Vec<Requirement>,
    pub(super) share: Option<RequiredShare>,
    /// Known mistakes that must be found.
    pub(super) detections: Vec<Requirement>,
}

/// A limit that differs from that of the rule's page.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitOverride {
    /// Code or name of the rule.
    pub rule: String,
    /// Name of the limit.
    pub name: String,
    /// The number, in `unit`.
    pub value: f64,
    /// The unit as written; empty if there is none.
    pub unit: String,
    /// Its place, in words.
    pub origin: String,
}

/// A waiver without the identity of its source.
#[derive(Clone, Debug)]
struct WaiverDraft {
    rule: String,
    subject: Option<GlobMatcher>,
    file: Option<GlobMatcher>,
    reason: String,
    by: Option<String>,
    until: Option<Day>,
    origin: String,
    span: Span,
}

impl PolicyLayer {
    /// Levels of findings by their files. An ignored rule is off in these files.
    pub(super) fn of_files(&self) -> Self {
        let off = self.ignore.iter().map(|(rule, origin)| Weight {
            rule: rule.clone(),
            file: None,
            level: Level::Off,
            origin: origin.clone(),
        });
        Self {
            weights: self.weights.iter().cloned().chain(off).collect(),
            waivers: self.waivers.clone(),
            ..Self::default()
        }
    }

    /// The globs of files that its parts concern.
    pub(super) fn files(&mut self) -> impl Iterator<Item = &mut Option<GlobMatcher>> {
        let weights = self.weights.iter_mut().map(|weight| &mut weight.file);
        weights.chain(self.waivers.iter_mut().map(|waived| &mut waived.file))
    }

    /// The waivers; the layer has this id as a source.
    pub(super) fn exceptions(&self, id: SourceId) -> impl Iterator<Item = Exception> {
        self.waivers.iter().map(move |waived| {
            let words = |glob: &Option<GlobMatcher>, before: &str| {
                glob.as_ref()
                    .map_or_else(String::new, |glob| format!("{before}`{}`", glob.glob().glob()))
            };
            let about = format!("{}{}", words(&waived.subject, ""), words(&waived.file, " in "));
            Exception {
                waiver: Waiver {
                    kind: WaiverKind::Configuration,
                    rule: waived.rule.clone(),
                    about: about.trim().to_owned(),
                    reason: waived.reason.clone(),
                    by: waived.by.clone(),
                    until: waived.until.clone(),
                    origin: waived.origin.clone(),
                    place: Place::text(id, waived.span),
                },
                scope: Scope::Globs {
                    subject: waived.subject.clone(),
                    file: waived.file.clone(),
                },
            }
        })
    }
}

const SEVERITIES: &[(&str, Level)] = &[
    ("off", Level::Off),
    ("note", Level::Severity(Severity::Note)),
    ("warning", Level::Severity(Severity::Warning)),
    ("error", Level::Severity(Severity::Error)),
];

const FAIL_ON: &[(&str, FailOn)] = &[
    ("error", FailOn::Error),
    ("warning", FailOn::Warning),
    ("note", FailOn::Note),
    ("never", FailOn::Never),
];

impl Reader<'_> {
    /// The keys of the policy.
    pub(super) fn asked(&self, root: &Node) -> Result<PolicyLayer, ConfigError> {
        let mut asked = PolicyLayer {
            fail_on: self.word(root, "fail-on", FAIL_ON)?,
            ..PolicyLayer::default()
        };
        if let Some(rules) = root.get("rules") {
            self.keys(rules, &["select", "ignore", "severity"])?;
            if let Some(node) = rules.get("select") {
                asked.select = Some(self.rule_words(node, &mut asked.named)?);
            }
            if let Some(node) = rules.get("ignore") {
                asked.ignore = self.rule_words(node, &mut asked.named)?;
            }
            self.severities(rules, None, &mut asked)?;
        }
        self.limits(root, &mut asked)?;
        for item in self.list_of(root, "paths", "`- {file: simulation/**, ignore: [urdf]}`")? {
            self.path_section(item, &mut asked)?;
        }
        for item in self.list_of(root, "waivers", "`- {rule: CROSS02, subject: '*lidar*', reason: ...}`")? {
            let waived = self.waiver(item, &mut asked.named)?;
            asked.waivers.push(waived);
        }
        self.requirements(root, &mut asked)?;
        Ok(asked)
    }

    /// The items of a list; none if the key is absent.
    pub(super) fn list_of<'n>(&self, root: &'n Node, key: &str, example: &str) -> Result<&'n [Node], ConfigError> {
        let Some(node) = root.get(key) else { return Ok(&[]) };
        let fault = || self.error(node.span.start, &format!("`{key}` must be a list: {example}"));
        node.items().ok_or_else(fault)
    }

    /// The text of a required key.
    pub(super) fn required_text(&self, item: &Node, key: &str, what: &str) -> Result<String, ConfigError> {
        let Some(node) = item.get(key) else {
            return Err(self.error(item.span.start, &format!("`{key}` is missing: {what}")));
        };
        let text = node.text().map(str::trim).filter(|text| !text.is_empty());
        let text = text.ok_or_else(|| self.error(node.span.start, &format!("`{key}` must be {what}")))?;
        Ok(text.to_owned())
    }

    /// A word for rules, kept with its place.
    pub(super) fn rule_word(
        &self,
        node: &Node,
        named: &mut Vec<(String, String)>,
    ) -> Result<(String, String), ConfigError> {
        let text = node.text().map(str::trim).filter(|text| !text.is_empty());
        let text = text.ok_or_else(|| self.error(node.span.start, "expected a rule: a code, a name or a family"))?;
        let word = (text.to_owned(), self.origin(node, true));
        named.push(word.clone());
        Ok(word)
    }

    /// The word of the required key `rule`.
    pub(super) fn rule_of(&self, item: &Node, named: &mut Vec<(String, String)>) -> Result<String, ConfigError> {
        match item.get("rule") {
            Some(node) => Ok(self.rule_word(node, named)?.0),
            None => Err(self.error(item.span.start, "`rule` is missing: a code, a name or a family")),
        }
    }

    /// One word for rules, or a list of them.
    fn rule_words(&self, node: &Node, named: &mut Vec<(String, String)>) -> Result<Vec<(String, String)>, ConfigError> {
        let items = node.items().map_or_else(|| vec![node], |items| items.iter().collect());
        items.into_iter().map(|item| self.rule_word(item, named)).collect()
    }

    /// `severity: {NAME02: error}`.
    fn severities(&self, node: &Node, file: Option<&GlobMatcher>, asked: &mut PolicyLayer) -> Result<(), ConfigError> {
        let Some(map) = node.get("severity") else { return Ok(()) };
        if !map.is_mapping() {
            let what = "`severity` must map rules to severities: `severity: {NAME02: error}`";
            return Err(self.error(map.span.start, what));
        }
        for (key, _) in map.pairs() {
            let (rule, _) = self.rule_word(key, &mut asked.named)?;
            let level = self.word(map, &rule, SEVERITIES)?;
            // Off everywhere: the rule does not run.
            if level == Some(Level::Off) && file.is_none() {
                asked.ignore.push((rule, self.origin(key, true)));
                continue;
            }
            asked.weights.extend(level.map(|level| Weight {
                rule,
                file: file.cloned(),
                level,
                origin: self.origin(key, false),
            }));
        }
        Ok(())
    }

    fn path_section(&self, item: &Node, asked: &mut PolicyLayer) -> Result<(), ConfigError> {
        self.keys(item, &["file", "ignore", "severity"])?;
        self.required_text(item, "file", "a path, or a glob with `*`")?;
        let file = self.glob(item, "file")?;
        if item.get("ignore").is_none() && item.get("severity").is_none() {
            let what = "this changes nothing: `ignore` or `severity` is missing";
            return Err(self.error(item.span.start, what));
        }
        self.severities(item, file.as_ref(), asked)?;
        if let Some(node) = item.get("ignore") {
            for (rule, _) in self.rule_words(node, &mut asked.named)? {
                asked.weights.push(Weight {
                    rule,
                    file: file.clone(),
                    level: Level::Off,
                    origin: self.origin(item, false),
                });
            }
        }
        Ok(())
    }

    /// `limits: {CROSS02: {rotation_deg: 3 deg}}`.
    fn limits(&self, root: &Node, asked: &mut PolicyLayer) -> Result<(), ConfigError> {
        let Some(map) = root.get("limits") else { return Ok(()) };
        let example = "`limits` must map each rule to its limits: `CROSS02: {rotation_deg: 3 deg}`";
        if !map.is_mapping() {
            return Err(self.error(map.span.start, example));
        }
        for (key, limits) in map.pairs() {
            let (rule, _) = self.rule_word(key, &mut asked.named)?;
            if !limits.is_mapping() {
                return Err(self.error(limits.span.start, example));
            }
            for (name, value) in limits.pairs() {
                let (number, unit) = self.quantity(value)?;
                asked.limits.push(LimitOverride {
                    rule: rule.clone(),
                    name: name.text().unwrap_or_default().to_owned(),
                    value: number,
                    unit,
                    origin: self.origin(value, true),
                });
            }
        }
        Ok(())
    }

    /// A number and its unit: `3 deg`.
    pub(super) fn quantity(&self, node: &Node) -> Result<(f64, String), ConfigError> {
        let text = node.text().unwrap_or_default().trim();
        let end = text
            .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e' | 'E')))
            .unwrap_or(text.len());
        let (number, unit) = text.split_at(end);
        let number = number.parse::<f64>().ok().filter(|number| number.is_finite());
        let what = "expected a number with its unit: `3 deg`, `8 cm`";
        let number = number.ok_or_else(|| self.error(node.span.start, what))?;
        Ok((number, unit.trim().to_owned()))
    }

    fn waiver(&self, item: &Node, named: &mut Vec<(String, String)>) -> Result<WaiverDraft, ConfigError> {
        self.keys(item, &["rule", "subject", "file", "reason", "until", "by"])?;
        let rule = self.rule_of(item, named)?;
        let reason = self.required_text(
            item,
            "reason",
            "the reason why this is accepted, for readers of the report",
        )?;
        let until = match item.get("until") {
            None => None,
            Some(node) => {
                let day = node.text().and_then(Day::parse);
                Some(
                    day.ok_or_else(|| self.error(node.span.start, "`until` must be the last day, as in `2027-01-31`"))?,
                )
            }
        };
        let by = item
            .get("by")
            .map(|_| self.required_text(item, "by", "the name of the person who accepts this"));
        Ok(WaiverDraft {
            rule,
            subject: self.glob(item, "subject")?,
            file: self.glob(item, "file")?,
            reason,
            by: by.transpose()?,
            until,
            origin: self.origin(item, false),
            span: item.span,
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::indexing_slicing)]
    use std::path::Path;

    use super::super::{Config, parse, tests::fault};
    use super::*;

    fn config(text: &str) -> Config {
        parse("c.yaml", text.to_owned(), Path::new("")).unwrap()
    }

    #[test]
    fn every_key_is_read_with_its_place() {
        let config = config(
            "fail-on: warning\nrules:\n  select: [tree, CROSS02]\n  ignore: NAME01\n  severity: {NAME02: error}\n\
             limits:\n  CROSS02: {rotation_deg: 3.5 deg, translation_m: 8 cm}\n\
             paths:\n  - {file: 'sim/**', ignore: [urdf], severity: {TREE01: note}}\n\
             waivers:\n  - rule: CROSS02\n    subject: '*lidar*'\n    file: a.yaml\n    reason: remounted\n    until: 2027-01-31\n    by: J. Doe\n\
             require:\n  - TREE01\n  - {rule: AXES03, subject: '*imu*'}\n",
        );
        assert_eq!(config.fail_on(), Some(FailOn::Warning));
        let (select, ignore) = config.rules();
        assert_eq!(
            select,
            [
                ("tree".to_owned(), "c.yaml:3:12".to_owned()),
                ("CROSS02".to_owned(), "c.yaml:3:18".to_owned())
            ]
        );
        assert_eq!(ignore.count(), 1);
        let limits: Vec<_> = config.limits().collect();
        assert_eq!((limits[0].value, limits[0].unit.as_str()), (3.5, "deg"));
        assert_eq!(
            (limits[1].name.as_str(), limits[1].value, limits[1].unit.as_str()),
            ("translation_m", 8.0, "cm")
        );
        let policy = config.policy(5);
        let levels: Vec<_> = policy
            .weights
            .iter()
            .map(|w| (w.rule.as_str(), w.level, w.file.is_some()))
            .collect();
        assert_eq!(
            levels,
            [
                ("NAME02", Level::Severity(Severity::Error), false),
                ("TREE01", Level::Severity(Severity::Note), true),
                ("urdf", Level::Off, true)
            ]
        );
        let waiver = &policy.exceptions[0].waiver;
        assert_eq!(
            waiver.waived().words(),
            "remounted, by J. Doe, until 2027-01-31 (c.yaml:11)"
        );
        assert_eq!(
            (waiver.about.as_str(), waiver.place.source),
            ("`*lidar*` in `a.yaml`", SourceId(5))
        );
        assert_eq!(policy.required.len(), 2);
        assert_eq!(config.named_rules().count(), 10);
    }

    #[test]
    fn faults_have_a_place() {
        assert_eq!(
            fault("waivers:\n  - {rule: CROSS02}\n"),
            "c.yaml:2:5: `reason` is missing: the reason why this is accepted, for readers of the report"
        );
        assert!(
            fault("waivers:\n  - {rule: X, reason: y, until: 2027-02-30}\n")
                .contains("c.yaml:2:33: `until` must be the last day")
        );
        assert!(fault("waivers: {}\n").contains("must be a list"));
        assert!(fault("fail-on: errors\n").contains("`fail-on` must be one of error, warning, note, never"));
        assert!(fault("rules: {severity: {X: fatal}}\n").contains("must be one of off, note, warning, error"));
        assert!(fault("limits: {X: {a: three}}\n").contains("expected a number with its unit"));
        assert!(fault("limits: {X: 3}\n").contains("`limits` must map each rule"));
        assert!(fault("paths: [{file: a}]\n").contains("this changes nothing"));
        assert!(fault("rules: {selct: [a]}\n").contains("did you mean `select`?"));
    }
}
