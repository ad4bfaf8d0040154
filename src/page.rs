//! A rule's page: its front matter with typed limits, its sections and its executable examples.

use std::collections::BTreeMap;

use serde::de::value::{self, MapDeserializer};
use serde::de::{DeserializeOwned, IntoDeserializer, Visitor};
use serde::{Deserialize, Deserializer};

use crate::source::Confidence;
use crate::verdict::Severity;

/// Where the page of a rule is published.
pub fn url(code: &str) -> String {
    format!(
        "https://frames-lint.github.io/frames-lint/rules/{}.html",
        code.to_lowercase()
    )
}

/// How settled a rule is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// On trial: its findings are shown as hints.
    Trial,
    /// Quiet on the whole real corpus.
    Stable,
}

/// A number of a page: whole where it counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// A count.
    Whole(i64),
    /// A quantity.
    Real(f64),
}

impl Number {
    /// As a quantity.
    pub fn as_f64(self) -> f64 {
        match self {
            Self::Whole(whole) => whole as f64,
            Self::Real(real) => real,
        }
    }
}

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Whole(whole) => write!(f, "{whole}"),
            Self::Real(real) => write!(f, "{real:?}"),
        }
    }
}

impl<'de> Deserializer<'de> for Number {
    type Error = value::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        match self {
            Self::Whole(whole) => visitor.visit_i64(whole),
            Self::Real(real) => visitor.visit_f64(real),
        }
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct newtype_struct seq
        tuple tuple_struct map struct enum identifier ignored_any
    }
}

impl IntoDeserializer<'_> for Number {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// One limit: a number with its unit and the reason for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// What the rule's Rust calls it.
    pub name: &'static str,
    /// The number.
    pub value: Number,
    /// Its unit.
    pub unit: &'static str,
    /// Why this number.
    pub reason: &'static str,
}

/// A rule's page. Those of the catalogue are made by `build.rs` of the files in `rules/`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Page {
    /// `TREE01`.
    pub code: &'static str,
    /// `orphan-subtree`.
    pub name: &'static str,
    /// One line: what a finding says.
    pub summary: &'static str,
    /// Version the rule came with.
    pub since: &'static str,
    /// Trial or stable.
    pub status: Status,
    /// The worst severity the rule gives.
    pub severity: Severity,
    /// The ceiling of its confidence.
    pub confidence: Confidence,
    /// What is judged: one outcome row for each.
    pub subject: &'static str,
    /// What there is to be seen of it: a row of `rules/tables/views.yaml`.
    pub view: &'static str,
    /// What must be at hand, in kinds of `rules/tables/recordings.yaml`.
    pub evidence: &'static [&'static str],
    /// Limits by name; the rule's Rust has a typed struct of the same names.
    pub limits: &'static [Limit],
    /// Standards, papers and code the rule rests on.
    pub references: &'static [&'static str],
    /// What follows the front matter.
    pub body: &'static str,
}

impl Page {
    /// The family: the letters of the code.
    pub fn family(&self) -> &'static str {
        self.code.trim_end_matches(|c: char| c.is_ascii_digit())
    }

    /// The limit of this name.
    pub fn limit(&self, name: &str) -> Option<&'static Limit> {
        self.limits.iter().find(|limit| limit.name == name)
    }

    /// The limits as the rule's own struct, those of `own` in place of the page's; names that do not match are an error.
    pub fn limits<L: DeserializeOwned>(&self, own: &BTreeMap<String, Number>) -> Result<L, String> {
        let limits = self.limits.iter();
        let values = limits.map(|limit| (limit.name, own.get(limit.name).copied().unwrap_or(limit.value)));
        L::deserialize(MapDeserializer::new(values)).map_err(|error| format!("limits of {}: {error}", self.code))
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
