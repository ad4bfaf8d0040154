//! Tests of the calibration reader: forms of transforms, quirks of files, and real files where they are available.

mod corpus;
mod dialects;
mod forms;
mod frames;
mod leftovers;
mod ouster;
mod plain;
mod quirks;

use crate::source::{LineIndex, ReadStatus, Source, SourceId, SourceKind, Span};
use crate::tables::Tables;
use crate::world::{Claim, Facts, Spelling};

use super::{read_json, read_yaml};

/// Reads a text as YAML.
fn yaml(text: &str) -> (Source, Facts) {
    let mut source = Source::new(SourceId(0), "calib.yaml", SourceKind::Yaml);
    text.clone_into(&mut source.text);
    let facts = read_yaml(&mut source, Tables::default().dialects());
    assert_eq!(source.text, text, "the text stays");
    (source, facts)
}

/// Reads a text as JSON.
fn json(text: &str) -> (Source, Facts) {
    let mut source = Source::new(SourceId(0), "calib.json", SourceKind::Json);
    text.clone_into(&mut source.text);
    let facts = read_json(&mut source, Tables::default().dialects());
    (source, facts)
}

/// The only claim of a YAML text that is read without a problem.
fn one(text: &str) -> Claim {
    let (source, facts) = yaml(text);
    assert_eq!(source.status, ReadStatus::Read, "{:?}", source.problems);
    assert_eq!(facts.claims.len(), 1, "{:?}", facts.claims);
    facts.claims.into_iter().next().unwrap()
}

/// No claim, and no problem either.
fn none(text: &str) {
    let (source, facts) = yaml(text);
    assert!(facts.claims.is_empty(), "{text}\n{:?}", facts.claims);
    assert!(source.problems.is_empty(), "{:?}", source.problems);
    assert_eq!(source.detail.as_deref(), Some("no transforms found"));
}

/// `target<-source`, or `-`.
fn frames(claim: &Claim) -> String {
    claim
        .frames
        .as_ref()
        .map_or("-".to_owned(), |(target, source)| format!("{target}<-{source}"))
}

/// One-based line and column of the start of a span.
fn at(text: &str, span: Span) -> (usize, usize) {
    let place = LineIndex::new(text).locate(text, span.start);
    (place.line, place.column)
}

/// The matrix of a claim.
fn matrix(claim: &Claim) -> (usize, usize, Vec<f64>) {
    match &claim.spelling {
        Spelling::Matrix { rows, cols, values } => (*rows, *cols, values.clone()),
        other => panic!("no matrix: {other:?}"),
    }
}

/// Every literal of a claim is at its span.
fn literals_stand_where_they_say(text: &str, claim: &Claim) {
    let literals = claim.translation_literals.iter().chain(&claim.rotation_literals);
    for literal in literals {
        assert_eq!(
            text.get(literal.span.start..literal.span.end),
            Some(literal.text.as_str())
        );
        let same = literal
            .text
            .parse::<f64>()
            .is_ok_and(|v| v.to_bits() == literal.value.to_bits());
        assert!(same, "{literal:?}");
    }
    assert!(!claim.rotation_literals.is_empty() || !claim.has_rotation);
    assert!(!claim.translation_literals.is_empty() || !claim.has_translation);
}
