//! A rule's page: its front matter with typed limits, its sections and its executable examples.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::source::Confidence;
use crate::verdict::Severity;

/// How settled a rule is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// On trial: its findings are shown as hints.
    Trial,
    /// Quiet on the whole real corpus.
    Stable,
}

/// One limit: a number with its unit and the reason for it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// The number.
    pub value: serde_yaml::Value,
    /// Its unit.
    pub unit: String,
    /// Why this number.
    pub reason: String,
}

impl Limit {
    /// The number that a text opens with, alone.
    fn bare(text: &str) -> Result<Self, PageError> {
        let word = text.split([',', '}']).next().unwrap_or_default().trim();
        let whole = word.parse::<i64>().map(serde_yaml::Value::from);
        let value = whole.or_else(|_| word.parse::<f64>().map(serde_yaml::Value::from));
        Ok(Self {
            value: value.map_err(|_| PageError(format!("limits: `{word}` is no number")))?,
            unit: String::new(),
            reason: String::new(),
        })
    }
}

/// The front matter of a page.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Front {
    /// `TREE01`.
    pub code: String,
    /// `orphan-subtree`.
    pub name: String,
    /// One line: what a finding says.
    pub summary: String,
    /// Version the rule came with.
    pub since: String,
    /// Trial or stable.
    pub status: Status,
    /// The worst severity the rule gives.
    pub severity: Severity,
    /// The ceiling of its confidence.
    pub confidence: Confidence,
    /// What is judged: one outcome row for each.
    pub subject: String,
    /// What there is to be seen of it: a row of `rules/tables/views.yaml`.
    pub view: String,
    /// What must be at hand, in kinds of `rules/tables/recordings.yaml`.
    #[serde(default)]
    pub evidence: Vec<String>,
    /// Limits by name; the rule's Rust has a typed struct of the same names.
    #[serde(default)]
    pub limits: BTreeMap<String, Limit>,
    /// Standards, papers and code the rule rests on.
    #[serde(default)]
    pub references: Vec<String>,
}

/// A page that cannot be used: a fault of ours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageError(pub String);

impl std::fmt::Display for PageError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for PageError {}

/// A value that is one word of a closed list.
fn word<T: DeserializeOwned>(value: &str) -> Result<T, PageError> {
    let word = serde::de::value::StrDeserializer::<serde::de::value::Error>::new(value.trim());
    T::deserialize(word).map_err(|error| PageError(format!("front matter: {error}")))
}

/// Splits a page into its front matter text and its body.
pub fn split(page: &str) -> Result<(&str, &str), PageError> {
    page.strip_prefix("---\n")
        .and_then(|rest| rest.split_once("\n---\n"))
        .ok_or_else(|| PageError("a page opens with front matter between two lines of ---".to_owned()))
}

impl Front {
    /// Reads the front matter of a page.
    pub fn parse(page: &str) -> Result<Self, PageError> {
        let (front, _) = split(page)?;
        serde_yaml::from_str(front).map_err(|error| PageError(format!("front matter: {error}")))
    }

    /// Reads the front matter without limits and references, which stand last: a run needs those of few rules.
    ///
    /// These lines are plain `key: value` pairs in this order and are taken as they stand, because fifty YAML documents cost as
    /// much as reading a robot; a test holds the answer to that of [`Front::parse`].
    pub fn parse_head(page: &str) -> Result<Self, PageError> {
        let (front, _) = split(page)?;
        let mut lines = front.lines().take_while(|line| !line.starts_with("limits:"));
        let mut line = |key: &str| {
            let value = lines.find_map(|line| line.strip_prefix(key)?.strip_prefix(": "));
            let value = value.map(|value| value.trim().trim_matches('"'));
            value.ok_or_else(|| PageError(format!("front matter: no line `{key}` in its place")))
        };
        Ok(Self {
            code: line("code")?.to_owned(),
            name: line("name")?.to_owned(),
            summary: line("summary")?.to_owned(),
            since: line("since")?.to_owned(),
            status: word(line("status")?)?,
            severity: word(line("severity")?)?,
            confidence: word(line("confidence")?)?,
            subject: line("subject")?.to_owned(),
            view: line("view")?.to_owned(),
            evidence: Vec::new(),
            limits: BTreeMap::new(),
            references: Vec::new(),
        })
    }

    /// Reads the front matter with the values of its limits, without their units, reasons and the references.
    ///
    /// Values are single numbers and taken as they stand, for the reason of [`Front::parse_head`]; the same test holds
    /// them.
    pub fn parse_limits(page: &str) -> Result<Self, PageError> {
        let mut whole = Self::parse_head(page)?;
        let (front, _) = split(page)?;
        let mut name = None;
        let lines = front.lines().skip_while(|line| !line.starts_with("limits:")).skip(1);
        for line in lines.take_while(|line| line.starts_with("  ")) {
            let (key, rest) = line.trim().split_once(':').unwrap_or((line, ""));
            if !line.starts_with("   ") {
                name = Some(key);
            }
            let value = if key == "value" {
                Some(rest)
            } else {
                rest.trim_start().strip_prefix("{value:")
            };
            if let (Some(name), Some(value)) = (name, value) {
                whole.limits.insert(name.to_owned(), Limit::bare(value)?);
            }
        }
        Ok(whole)
    }

    /// The family: the letters of the code.
    pub fn family(&self) -> &str {
        self.code.trim_end_matches(|c: char| c.is_ascii_digit())
    }

    /// The limits as the rule's own struct; names that do not match are an error.
    pub fn limits<L: DeserializeOwned>(&self) -> Result<L, PageError> {
        let mapping: serde_yaml::Mapping = self
            .limits
            .iter()
            .map(|(name, limit)| (serde_yaml::Value::from(name.as_str()), limit.value.clone()))
            .collect();
        serde_yaml::from_value(serde_yaml::Value::Mapping(mapping))
            .map_err(|error| PageError(format!("limits of {}: {error}", self.code)))
    }
}

/// Whether a word names a rule: its code, its name or its family, in any case.
pub fn names_rule(word: &str, code: &str, name: &str) -> bool {
    let family = code.trim_end_matches(|c: char| c.is_ascii_digit());
    [code, name, family]
        .iter()
        .any(|known| known.eq_ignore_ascii_case(word))
}

/// A fenced block of a page: ```` ```xml robot.urdf ````.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block<'a> {
    /// The first word after the fence (`xml`, `yaml`, `recipe`, `expect`).
    pub language: &'a str,
    /// The rest of the line: a file name, or empty.
    pub argument: &'a str,
    /// The lines between the fences.
    pub text: &'a str,
}

/// A `## Section` of a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section<'a> {
    /// The heading.
    pub title: &'a str,
    /// Everything up to the next `## ` heading.
    pub text: &'a str,
}

/// The sections of a page's body, in order. Headings inside fenced blocks do not count.
pub fn sections(body: &str) -> Vec<Section<'_>> {
    let mut starts: Vec<(usize, usize, &str)> = Vec::new();
    let mut offset = 0;
    let mut fenced = false;
    for line in body.split_inclusive('\n') {
        if line.starts_with("```") {
            fenced = !fenced;
        } else if let (false, Some(title)) = (fenced, line.strip_prefix("## ")) {
            starts.push((offset, offset + line.len(), title.trim()));
        }
        offset += line.len();
    }
    starts
        .iter()
        .enumerate()
        .map(|(index, (_, from, title))| {
            let to = starts.get(index + 1).map_or(body.len(), |next| next.0);
            Section {
                title,
                text: body.get(*from..to).unwrap_or_default(),
            }
        })
        .collect()
}

/// The fenced blocks of a text, in order.
pub fn blocks(text: &str) -> Vec<Block<'_>> {
    let mut found = Vec::new();
    let mut open: Option<(&str, usize)> = None;
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        if let Some(info) = line.strip_prefix("```") {
            match open.take() {
                None => open = Some((info.trim(), offset + line.len())),
                Some((info, from)) => {
                    let (language, argument) = info.split_once(' ').unwrap_or((info, ""));
                    found.push(Block {
                        language,
                        argument: argument.trim(),
                        text: text.get(from..offset).unwrap_or_default(),
                    });
                }
            }
        }
        offset += line.len();
    }
    found
}
