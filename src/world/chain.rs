//! Declared chains of transforms: `world_T_odom = world_T_map * map_T_odom` in a file.
//!
//! Owns the chain and the parsing of its text. A rule decides whether its frames cancel.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::source::{Place, Span};

use super::transform_name::{self, TransformName};

/// A product of transforms that a file declares.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeclaredChain {
    /// The text as written.
    pub text: String,
    /// The whole text.
    pub place: Place,
    /// The factors from left to right, with inverses already applied, each with the span of its text.
    /// Empty if a factor was not understood: see `not_understood`.
    pub factors: Vec<(TransformName, Span)>,
    /// The declared result of the product, if the text states it.
    pub result: Option<(TransformName, Span)>,
    /// The first factor (or result) that is not the name of a transform.
    pub not_understood: Option<String>,
    /// Whether the names are members of several objects: `imu` of one may be another frame than `imu` of another.
    #[serde(default)]
    pub is_loose: bool,
}

/// A parsed chain; ranges count bytes of its text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Factors {
    /// The factors from left to right.
    pub factors: Vec<(TransformName, Range<usize>)>,
    /// The declared result.
    pub result: Option<(TransformName, Range<usize>)>,
    /// The first part that is not the name of a transform.
    pub not_understood: Option<String>,
}

/// Parses a chain: factors joined by `*`, `@` or `·`, perhaps after `result =`. A factor may carry a time
/// (`map_T_odom(t)`) and may be inverted (`inv(a_T_b)`, `a_T_b.inverse()`, `a_T_b^-1`). `None` if the text is neither a
/// product nor an equation.
pub fn parse(text: &str) -> Option<Factors> {
    if text.len() > 4096 || !text.contains(['*', '@', '·', '=']) {
        return None;
    }
    let mut chain = Factors::default();
    let product_start = match text.find('=') {
        Some(at) => {
            let range = trimmed(text, 0..at);
            match text.get(range.clone()).and_then(factor) {
                Some(name) => chain.result = Some((name, range)),
                None => chain.not_understood = text.get(range).map(str::to_owned),
            }
            at + 1
        }
        None => 0,
    };
    let mut start = product_start;
    let separators = text
        .char_indices()
        .filter(|(at, c)| *at >= product_start && matches!(c, '*' | '@' | '·'));
    let ends = separators
        .map(|(at, c)| (at, c.len_utf8()))
        .chain(std::iter::once((text.len(), 0)));
    for (end, width) in ends {
        let range = trimmed(text, start..end);
        start = end + width;
        let piece = text.get(range.clone())?;
        match factor(piece) {
            Some(name) => chain.factors.push((name, range)),
            None if chain.not_understood.is_none() => chain.not_understood = Some(piece.to_owned()),
            None => {}
        }
    }
    if chain.not_understood.is_some() {
        chain.factors.clear();
    }
    Some(chain)
}

/// The range without whitespace at its ends.
fn trimmed(text: &str, range: Range<usize>) -> Range<usize> {
    let Some(piece) = text.get(range.clone()) else {
        return range;
    };
    let start = range.start + (piece.len() - piece.trim_start().len());
    start..(start + piece.trim().len())
}

fn factor(piece: &str) -> Option<TransformName> {
    let piece = piece.trim();
    for call in ["inv(", "inverse("] {
        if let Some(inner) = piece.strip_prefix(call).and_then(|rest| rest.strip_suffix(')')) {
            return factor(inner).map(TransformName::inverse);
        }
    }
    for suffix in [".inverse()", ".inv()", "^-1", "^{-1}", "**-1", "⁻¹"] {
        if let Some(inner) = piece.strip_suffix(suffix) {
            return factor(inner).map(TransformName::inverse);
        }
    }
    // A time: `map_T_odom(t_i)`.
    let bare = match piece.split_once('(') {
        Some((before, rest)) if rest.ends_with(')') => before,
        _ => piece,
    };
    transform_name::parse(bare)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> String {
        let Some(chain) = parse(text) else {
            return "-".to_owned();
        };
        let part = |(name, range): &(TransformName, Range<usize>)| {
            format!("{}<-{}[{}]", name.target, name.source, &text[range.clone()])
        };
        let factors: Vec<String> = chain.factors.iter().map(part).collect();
        let result = chain.result.as_ref().map(part).unwrap_or_default();
        format!(
            "{result} = {} ! {}",
            factors.join(" * "),
            chain.not_understood.unwrap_or_default()
        )
    }

    #[test]
    fn products_and_equations_are_taken_apart_with_their_places() {
        assert_eq!(
            read("world_T_map * map_T_odom"),
            " = world<-map[world_T_map] * map<-odom[map_T_odom] ! "
        );
        assert_eq!(
            read("world_T_odom = world_T_map*map_T_odom(t)"),
            "world<-odom[world_T_odom] = world<-map[world_T_map] * map<-odom[map_T_odom(t)] ! "
        );
        assert_eq!(read("T_a_b @ inv(T_c_b)"), " = a<-b[T_a_b] * b<-c[inv(T_c_b)] ! ");
        assert_eq!(
            read("a_T_b · c_T_b.inverse()"),
            " = a<-b[a_T_b] * b<-c[c_T_b.inverse()] ! "
        );
    }

    #[test]
    fn what_is_no_chain_is_said() {
        assert_eq!(read("hello"), "-");
        assert_eq!(read("a_T_b * p_b * x"), " =  ! p_b");
        assert_eq!(read("a_T_b *"), " =  ! ");
        assert!(parse("a_T_b *").unwrap().not_understood.is_some());
    }
}
