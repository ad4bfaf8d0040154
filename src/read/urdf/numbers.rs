//! Numbers of attributes, read as urdfdom reads them, with a plain message where it cannot.
//!
//! The reference: urdfdom splits a vector at spaces (U+0020) and reads each piece with the C++ stream of the classic
//! locale; the piece must end with the number. NaN and infinities are kept as values: rules decide whether they are
//! right. Must not know elements.

use crate::source::{SourceValue, Span};
use crate::world::claim::Literal;
use crate::world::robot::NumberList;

use super::xml::Attribute;

/// Whether a text holds an expression that only xacro (or roslaunch) expands.
pub(super) fn is_unexpanded(text: &str) -> bool {
    memchr::memchr_iter(b'$', text.as_bytes()).any(|at| matches!(text.as_bytes().get(at + 1), Some(b'{' | b'(')))
}

/// Reads an attribute of `expected` numbers.
pub(super) fn number_list(attribute: &Attribute<'_>, expected: usize) -> NumberList {
    let text = attribute.value.as_ref();
    let literals = pieces(attribute);
    NumberList {
        attribute: attribute.name.into(),
        text: SourceValue::new(text.into(), attribute.place()),
        malformed: malformed(text, &literals, expected),
        literals,
        expected,
    }
}

/// Most pieces that are read; no attribute has more than six numbers.
const MOST: usize = 64;

/// The pieces between spaces, tabs and line ends.
fn pieces(attribute: &Attribute<'_>) -> Vec<Literal> {
    let text = attribute.value.as_ref();
    let mut literals = Vec::with_capacity(3);
    let mut start = None;
    for (at, c) in text.char_indices().chain([(text.len(), ' ')]) {
        if literals.len() >= MOST {
            break;
        }
        let is_blank = matches!(c, ' ' | '\t' | '\n' | '\r');
        match (start, is_blank) {
            (None, false) => start = Some(at),
            (Some(from), true) => {
                let piece = text.get(from..at).unwrap_or_default();
                literals.push(Literal {
                    text: piece.into(),
                    value: number(piece).unwrap_or(f64::NAN),
                    // With references inside, pieces have no span of their own.
                    span: if attribute.verbatim {
                        Span::new(attribute.span.start + from, attribute.span.start + at)
                    } else {
                        attribute.span
                    },
                });
                start = None;
            }
            _ => {}
        }
    }
    literals
}

/// A number as C++ streams and Rust both spell it; beyond the range it is infinite.
fn number(piece: &str) -> Option<f64> {
    piece.parse().ok()
}

fn malformed(text: &str, literals: &[Literal], expected: usize) -> Option<String> {
    if is_unexpanded(text) {
        return Some("there is an unexpanded expression (xacro or launch) instead of numbers".to_owned());
    }
    if literals.is_empty() {
        return Some(format!("the attribute is empty; {} needed", count(expected)));
    }
    let is_bad = |literal: &&Literal| literal.value.is_nan() && number(&literal.text).is_none();
    if let Some(bad) = literals.iter().find(is_bad) {
        return Some(not_a_number(&bad.text, literals, expected));
    }
    if literals.len() >= MOST {
        return Some(format!("{MOST} or more numbers are given, {expected} needed"));
    }
    if literals.len() != expected {
        return Some(format!("{} given, {expected} needed", count(literals.len())));
    }
    unreadable_blank(text, expected).map(|blank| {
        format!("{blank} next to a number: urdfdom splits numbers at spaces only and refuses the attribute")
    })
}

fn count(numbers: usize) -> String {
    match numbers {
        1 => "1 number is".to_owned(),
        n => format!("{n} numbers are"),
    }
}

fn not_a_number(bad: &str, literals: &[Literal], expected: usize) -> String {
    let is_number = |piece: &str| number(piece).is_some();
    let decimal_commas = |piece: &str| piece.matches(',').count() == 1 && is_number(&piece.replace(',', "."));
    if literals.len() == expected
        && literals
            .iter()
            .all(|literal| is_number(&literal.text) || decimal_commas(&literal.text))
        && !bad.ends_with(',')
        && !bad.starts_with(',')
    {
        return format!("`{bad}` has a decimal comma; write a decimal point");
    }
    if bad.contains([',', ';']) && bad.split([',', ';']).all(|piece| piece.is_empty() || is_number(piece)) {
        let mark = if bad.contains(',') { "comma" } else { "semicolon" };
        return format!("`{bad}`: a {mark} between numbers; separate them by spaces");
    }
    if let Some(odd) = bad.chars().find(|c| !c.is_ascii()) {
        let code = u32::from(odd);
        return match odd {
            '\u{2212}' | '\u{2010}'..='\u{2015}' => {
                format!("`{bad}` is not a number: U+{code:04X} instead of a minus sign")
            }
            _ => format!("`{}` is not a number: it contains U+{code:04X}", bad.escape_default()),
        };
    }
    format!("`{bad}` is not a number")
}

/// Whitespace that urdfdom's splitting does not handle.
fn unreadable_blank(text: &str, expected: usize) -> Option<&'static str> {
    let is_plain = |byte: u8| expected > 1 && !matches!(byte, b'\t' | b'\n' | b'\r');
    if text.bytes().all(is_plain) {
        return None;
    }
    let blank = |c: char| match c {
        '\t' => Some("a tab"),
        '\n' | '\r' => Some("a line end"),
        ' ' => Some("a trailing space"),
        _ => None,
    };
    let trailing = |piece: &str| {
        piece
            .trim_start_matches(['\t', '\n', '\r', ' '])
            .chars()
            .find_map(blank)
    };
    if expected == 1 {
        return trailing(text);
    }
    text.split(' ').filter(|piece| !piece.is_empty()).find_map(|piece| {
        let rest = piece.trim_start_matches(['\t', '\n', '\r']);
        if rest.is_empty() {
            piece.chars().find_map(blank)
        } else {
            trailing(piece)
        }
    })
}
