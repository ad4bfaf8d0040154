//! What expressions of Python are, as far as they are plain: texts, numbers and lists, followed through names.

use std::collections::BTreeMap;

use tree_sitter::Node;

use crate::read::syntax::{children, span, text};
use crate::source::Span;

use super::super::Word;
use super::Script;

/// How far values are followed.
const MAX_DEPTH: usize = 16;
/// What an expression is, as far as it is known.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(Word),
    List(Vec<Value>),
    /// Pairs of keys and values.
    Table(Vec<(Value, Value)>),
}

/// Names that are bound at the place of an expression.
pub(super) type Bindings = BTreeMap<String, Value>;

impl<'t> Script<'t> {
    pub(super) fn value(&self, node: Node<'t>, bound: &Bindings, depth: usize) -> Value {
        self.known(node, bound, depth).unwrap_or_else(|| {
            Value::Text(Word {
                text: text(node, self.source).to_owned(),
                span: span(node),
                is_open: true,
                is_default: false,
            })
        })
    }

    /// What an expression is; `None` where it is not known.
    fn known(&self, node: Node<'t>, bound: &Bindings, depth: usize) -> Option<Value> {
        if depth > MAX_DEPTH {
            return None;
        }
        self.left.set(self.left.get().checked_sub(1)?);
        let of = |node| self.value(node, bound, depth + 1);
        let plain = |text: String| {
            Some(Value::Text(Word {
                text,
                span: span(node),
                is_open: false,
                is_default: false,
            }))
        };
        let raw = text(node, self.source);
        match node.kind() {
            "integer" | "float" => plain(raw.replace('_', "")),
            "true" | "false" => plain(raw.to_lowercase()),
            "string" | "concatenated_string" => self.string(node, bound, depth),
            "list" | "tuple" => {
                let items = children(node).into_iter().filter(|item| item.kind() != "comment");
                let each = items.flat_map(|item| match item.kind() {
                    "list_splat" => match children(item).first().map(|inner| of(*inner)) {
                        Some(Value::List(items)) => items,
                        other => other.into_iter().collect(),
                    },
                    _ => vec![of(item)],
                });
                Some(Value::List(each.collect()))
            }
            "dictionary" => {
                let pairs = children(node).into_iter().filter(|pair| pair.kind() == "pair");
                let pair = |pair: Node<'t>| {
                    Some((
                        of(pair.child_by_field_name("key")?),
                        of(pair.child_by_field_name("value")?),
                    ))
                };
                Some(Value::Table(pairs.filter_map(pair).collect()))
            }
            "list_comprehension" | "generator_expression" => {
                let body = node.child_by_field_name("body")?;
                let [(names, items)] = *super::clauses(node) else {
                    return None;
                };
                if super::has_condition(node) {
                    return None;
                }
                let Value::List(items) = of(items) else { return None };
                let of_item = |item| self.value(body, &self.with(bound, names, item), depth + 1);
                Some(Value::List(items.into_iter().map(of_item).collect()))
            }
            "subscript" => {
                let Value::Text(at) = of(node.child_by_field_name("subscript")?) else {
                    return None;
                };
                match of(node.child_by_field_name("value")?) {
                    Value::List(items) => {
                        let at: isize = at.text.parse().ok()?;
                        let at = if at < 0 {
                            items.len().checked_add_signed(at)?
                        } else {
                            at.unsigned_abs()
                        };
                        items.into_iter().nth(at)
                    }
                    Value::Table(pairs) => {
                        let is_it = |(key, _): &(Value, Value)| matches!(key, Value::Text(key) if key.text == at.text);
                        Some(pairs.into_iter().find(is_it)?.1)
                    }
                    Value::Text(_) => None,
                }
            }
            "parenthesized_expression" => Some(of(*children(node).first()?)),
            "identifier" => {
                if let Some(value) = bound.get(raw) {
                    return Some(value.clone());
                }
                if raw == "pi" {
                    return plain(std::f64::consts::PI.to_string());
                }
                Some(of((*self.assigned.get(raw)?)?))
            }
            "attribute" if raw.rsplit('.').next() == Some("pi") => plain(std::f64::consts::PI.to_string()),
            "unary_operator" => {
                let Value::Text(word) = of(node.child_by_field_name("argument")?) else {
                    return None;
                };
                let is_known = !word.is_open && word.text.parse::<f64>().is_ok();
                match (is_known, raw.starts_with('-')) {
                    (true, true) => plain(format!("-{}", word.text)),
                    (true, false) => plain(word.text),
                    _ => None,
                }
            }
            "binary_operator" => self.product(node, bound, depth),
            "call" => self.call(node, bound, depth),
            _ => None,
        }
    }

    /// Sums of lists and texts, and arithmetic of numbers.
    fn product(&self, node: Node<'t>, bound: &Bindings, depth: usize) -> Option<Value> {
        let side = |name| Some(self.value(node.child_by_field_name(name)?, bound, depth + 1));
        let operator = text(node.child_by_field_name("operator")?, self.source);
        match (side("left")?, side("right")?) {
            (Value::List(mut left), Value::List(right)) if operator == "+" => {
                left.extend(right);
                Some(Value::List(left))
            }
            (Value::Text(left), Value::Text(right)) if !left.is_open && !right.is_open => {
                let numbers = left.text.parse::<f64>().ok().zip(right.text.parse::<f64>().ok());
                let text = match (numbers, operator) {
                    (Some((a, b)), "+") => (a + b).to_string(),
                    (Some((a, b)), "-") => (a - b).to_string(),
                    (Some((a, b)), "*") => (a * b).to_string(),
                    (Some((a, b)), "/") => (a / b).to_string(),
                    (None, "+") => left.text + &right.text,
                    _ => return None,
                };
                Some(Value::Text(Word {
                    text,
                    span: span(node),
                    is_open: false,
                    is_default: left.is_default || right.is_default,
                }))
            }
            _ => None,
        }
    }

    fn call(&self, node: Node<'t>, bound: &Bindings, depth: usize) -> Option<Value> {
        let first = || Some(self.value(self.argument(node, 0, "value")?, bound, depth + 1));
        let degrees = || match first()? {
            Value::Text(word) if !word.is_open => Some(Value::Text(Word {
                text: word.text.parse::<f64>().ok()?.to_radians().to_string(),
                span: span(node),
                ..word
            })),
            _ => None,
        };
        match self.called(node) {
            "str" | "float" | "int" | "repr" => first(),
            "radians" | "deg2rad" => degrees(),
            "map" => Some(self.value(self.argument(node, 1, "")?, bound, depth + 1)),
            "items" | "values" | "keys" => {
                let object = node.child_by_field_name("function")?.child_by_field_name("object")?;
                let Value::Table(pairs) = self.value(object, bound, depth + 1) else {
                    return None;
                };
                let part = |(key, value)| match self.called(node) {
                    "items" => Value::List(vec![key, value]),
                    "keys" => key,
                    _ => value,
                };
                Some(Value::List(pairs.into_iter().map(part).collect()))
            }
            "TextSubstitution" => Some(self.value(self.argument(node, 0, "text")?, bound, depth + 1)),
            "LaunchConfiguration" => {
                let Value::Text(name) =
                    first().or_else(|| Some(self.value(self.keyword(node, "variable_name")?, bound, depth + 1)))?
                else {
                    return None;
                };
                let default = self.value(*self.declared.get(&name.text)?, bound, depth + 1);
                Some(match default {
                    Value::Text(word) => Value::Text(Word {
                        is_default: true,
                        ..word
                    }),
                    other => other,
                })
            }
            // `'0 0 0 0 0 0 map odom'.split()`
            "split" => {
                let object = node.child_by_field_name("function")?.child_by_field_name("object")?;
                let Value::Text(word) = self.value(object, bound, depth + 1) else {
                    return None;
                };
                let pieces = word.text.split_whitespace().map(|piece| {
                    let at = word.text.find(piece).unwrap_or_default();
                    let start = word.span.start + at;
                    // Where the text is written unchanged.
                    let stands = self.source.get(start..start + piece.len()) == Some(piece);
                    Value::Text(Word {
                        text: piece.to_owned(),
                        span: if stands {
                            Span::new(start, start + piece.len())
                        } else {
                            word.span
                        },
                        ..word.clone()
                    })
                });
                (!word.is_open).then(|| Value::List(pieces.collect()))
            }
            _ => None,
        }
    }

    /// A text, also of several pieces or with values put in.
    fn string(&self, node: Node<'t>, bound: &Bindings, depth: usize) -> Option<Value> {
        let mut whole = Word {
            text: String::new(),
            span: span(node),
            is_open: false,
            is_default: false,
        };
        let mut places: Vec<Span> = Vec::new();
        for part in children(node) {
            let piece = match part.kind() {
                "string_content" => {
                    places.push(span(part));
                    text(part, self.source).to_owned()
                }
                "string" => match self.value(part, bound, depth + 1) {
                    Value::Text(word) if !word.is_open => {
                        places.push(word.span);
                        word.text
                    }
                    _ => return None,
                },
                "interpolation" => {
                    let inner = part.child_by_field_name("expression").or_else(|| part.named_child(0))?;
                    match self.value(inner, bound, depth + 1) {
                        Value::Text(word) if !word.is_open => word.text,
                        _ => return None,
                    }
                }
                "escape_sequence" => return None,
                _ => continue,
            };
            whole.text.push_str(&piece);
        }
        if let ([only], 1) = (
            places.as_slice(),
            children(node)
                .iter()
                .filter(|part| part.kind() == "string_content")
                .count(),
        ) {
            whole.span = *only;
        }
        Some(Value::Text(whole))
    }
}

/// The words of a list; a list in it is one word of several pieces, as substitutions of launch files are.
pub(super) fn words(value: Value) -> Vec<Word> {
    match value {
        Value::Text(word) => vec![word],
        Value::List(items) => items.into_iter().filter_map(word).collect(),
        Value::Table(_) => Vec::new(),
    }
}

fn word(item: Value) -> Option<Word> {
    match item {
        Value::Text(word) => Some(word),
        Value::List(items) => items.into_iter().filter_map(word).reduce(|one, other| Word {
            text: one.text + &other.text,
            span: one.span,
            is_open: one.is_open || other.is_open,
            is_default: one.is_default || other.is_default,
        }),
        Value::Table(_) => None,
    }
}
