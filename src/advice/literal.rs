//! Literals in fixes: how a number is written, and what its text shows.

use nalgebra::Matrix3;

use crate::analysis::rot::parts::Parts;
use crate::source::{Place, SourceId};
use crate::verdict::{Edit, Finding, Safety};
use crate::world::{Literal, World};

/// A number with at most twelve decimals and no trailing zeros: enough for a picometre and for 1e-12 rad.
pub(crate) fn spell(value: f64) -> String {
    let text = format!("{value:.12}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "-0" | "" => "0".to_owned(),
        text => text.to_owned(),
    }
}

/// Replaces a literal by another text. `None` where the source's text does not hold the literal at its place: numbers
/// spelled with character references, or a world without texts.
pub(crate) fn rewrite(world: &World, source: SourceId, literal: &Literal, text: impl Into<String>) -> Option<Edit> {
    replace(world, Place::text(source, literal.span), &literal.text, text)
}

/// Edits that give literals these values; a literal that has its value already is left as it is. `None` where one of the others is not
/// found at its place, as in [`rewrite`].
pub(crate) fn rewrite_values<'l>(
    world: &World,
    source: SourceId,
    values: impl IntoIterator<Item = (&'l Literal, f64)>,
) -> Option<Vec<Edit>> {
    values
        .into_iter()
        .filter(|(literal, value)| (literal.value - value).abs() > 1e-12 * (1.0 + value.abs()))
        .map(|(literal, value)| rewrite(world, source, literal, spell(value)))
        .collect()
}

/// Replaces the text `written` at `place`. `None` where the text there is different.
pub(crate) fn replace(world: &World, place: Place, written: &str, text: impl Into<String>) -> Option<Edit> {
    let span = place.span()?;
    let there = world.source(place.source)?.text.get(span.start..span.end)?;
    (there == written).then(|| Edit {
        place,
        replacement: text.into(),
    })
}

/// The finding with a fix, where all of its edits can be made.
pub(crate) fn with_fix(finding: Finding, title: &str, safety: Safety, edits: Option<Vec<Edit>>) -> Finding {
    match edits {
        Some(edits) if !edits.is_empty() => finding.fix(title, safety, edits),
        _ => finding,
    }
}

/// Whether the text is a spelling of NaN or infinity (`nan`, `.inf`, `1e999`), not text without a number.
pub(crate) fn is_spelled_non_finite(literal: &Literal) -> bool {
    if literal.value.is_finite() {
        return false;
    }
    let text = literal.text.trim();
    let (sign, digits) = text
        .split_at_checked(1)
        .map_or(("", text), |(first, rest)| match first {
            "+" | "-" => (first, rest),
            _ => ("", text),
        });
    let plain = format!("{sign}{}", digits.strip_prefix('.').unwrap_or(digits));
    [text, plain.as_str()]
        .iter()
        .any(|text| text.parse::<f64>().is_ok_and(|value| !value.is_finite()))
}

/// Whether the text is a macro (`${width/2}`, `$(optenv ...)`) that xacro or roslaunch expands.
pub(crate) fn is_macro(text: &str) -> bool {
    text.contains("${") || text.contains("$(")
}

impl Parts<'_> {
    /// Edits that write another rotation into the block, where entries differ. `None` where the text of an entry is not known.
    pub(crate) fn replace_rotation(&self, world: &World, rotation: &Matrix3<f64>) -> Option<Vec<Edit>> {
        let mut values = Vec::new();
        for row in 0..3 {
            for col in 0..3 {
                let (r, c) = if self.transposed {
                    (col, row)
                } else if self.by_columns {
                    let at = col * 3 + row;
                    (at / 4, at % 4)
                } else {
                    (row, col)
                };
                values.push((self.literal(r, c)?, *rotation.get((row, col))?));
            }
        }
        rewrite_values(world, self.source(), values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Span;

    fn literal(text: &str) -> Literal {
        Literal {
            text: text.into(),
            value: text.parse().unwrap_or(f64::NAN),
            span: Span::new(0, text.len()),
        }
    }

    #[test]
    fn numbers_are_spelled_short_and_without_negative_zero() {
        assert_eq!(spell(1.0), "1");
        assert_eq!(spell(-0.0), "0");
        assert_eq!(spell(-1e-14), "0");
        assert_eq!(spell(0.25), "0.25");
        assert_eq!(spell(1000.0), "1000");
        assert_eq!(spell(std::f64::consts::FRAC_PI_2), "1.570796326795");
    }

    #[test]
    fn non_finite_spellings_of_xml_and_yaml_are_known_and_words_are_not() {
        for text in ["nan", "NaN", "-inf", ".nan", "-.inf", ".Inf", "1e999", "+infinity"] {
            assert!(is_spelled_non_finite(&literal(text)), "{text}");
        }
        for text in ["", "-", "1,5", "abc", "1.5", "${x}", ".", "é"] {
            assert!(!is_spelled_non_finite(&literal(text)), "{text}");
        }
    }
}
