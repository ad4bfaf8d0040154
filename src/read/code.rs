//! Source code: the products of transforms in it, in C++, Python and Rust.
//!
//! Owns what is a product, an inverse and a name of a transform in code. Nothing is run and no type is known: only names count, and anything
//! else than the name of a transform ends a product. A rule decides whether frames cancel.

mod names;
#[cfg(test)]
mod tests;

use tree_sitter::{Language, Node};

use std::collections::HashMap;

use crate::source::{Place, ReadStatus, Source, Span};
use crate::world::transform_name::{NamePart, TransformName};
use crate::world::{DeclaredChain, Facts};

use super::syntax::{children, nodes, parse, span, text};
use names::{WRAPS, named};

/// Deeper expressions are not followed.
const MAX_DEPTH: usize = 128;
/// Longer texts of a chain are cut.
const MAX_TEXT: usize = 120;

/// Endings of the files that are read.
const CPP: [&str; 14] = [
    "c", "cc", "cpp", "cxx", "c++", "h", "hh", "hpp", "hxx", "ipp", "tpp", "inl", "cu", "cuh",
];

/// Calls that invert what they are called on, or their argument.
const INVERSES: [&str; 7] = ["inverse", "inv", "Inverse", "Inv", "inverted", "try_inverse", "invert"];
/// Calls and members that give the same transform, or its rotation, in another form.
const SAME: [&str; 30] = [
    "rotation",
    "rotationMatrix",
    "linear",
    "so3",
    "rot",
    "matrix",
    "matrix3x4",
    "eval",
    "normalized",
    "cast",
    "to_homogeneous",
    "to_matrix",
    "clone",
    "unwrap",
    "expect",
    "toRotationMatrix",
    "to_rotation_matrix",
    "rotation_matrix",
    "as_matrix",
    "copy",
    "value",
    "get",
    "R",
    "asMatrix",
    "toMatrix",
    "quaternion",
    "unit_quaternion",
    "isometry",
    "affine",
    "getRotationMatrix",
];
/// Calls that multiply.
const PRODUCTS: [&str; 6] = ["compose", "dot", "matmul", "multiply", "mul", "Compose"];

/// The grammar of a file by the ending of its name, in lower case.
fn language(ending: &str) -> Option<Language> {
    match ending {
        "py" | "launch.py" | "pyi" => Some(tree_sitter_python::LANGUAGE.into()),
        "rs" => Some(tree_sitter_rust::LANGUAGE.into()),
        _ if CPP.contains(&ending) => Some(tree_sitter_cpp::LANGUAGE.into()),
        _ => None,
    }
}

/// Whether a file of this ending is read.
pub(crate) fn is_code(ending: &str) -> bool {
    language(ending).is_some()
}

/// Reads a file of source code (`source.text`). Sets status and detail.
pub fn read(source: &mut Source) -> Facts {
    let ending = super::input::ending(std::path::Path::new(&source.path));
    let Some(language) = language(&ending) else {
        let place = Place::whole(source.id);
        source.problem(ReadStatus::Unreadable, place, "not C++, Python or Rust");
        return Facts::default();
    };
    let tree = match parse(&source.text, &language) {
        Ok(tree) => tree,
        Err((span, message)) => {
            source.problem(ReadStatus::Unreadable, Place::text(source.id, span), message);
            return Facts::default();
        }
    };
    let nodes = nodes(tree.root_node());
    let reader = Reader {
        text: &source.text,
        parents: nodes
            .iter()
            .flat_map(|node| children(*node).into_iter().map(|child| (child.id(), *node)))
            .collect(),
    };
    let mut facts = Facts::default();
    for node in nodes {
        let chain = bound(node).map_or_else(|| reader.product(node), |(name, value)| reader.binding(name, value));
        for mut chain in chain {
            chain.place.source = source.id;
            facts.chains.push(chain);
        }
    }
    if facts.chains.is_empty() && source.detail.is_none() {
        source.detail = Some("no products of transforms whose names state their frames".to_owned());
    }
    facts
}

/// A name and the value that is given to it.
fn bound(node: Node<'_>) -> Option<(Node<'_>, Node<'_>)> {
    let pair = |name, value| Some((node.child_by_field_name(name)?, node.child_by_field_name(value)?));
    match node.kind() {
        "init_declarator" => pair("declarator", "value"),
        "assignment" | "assignment_expression" => {
            let operator = node.child_by_field_name("operator");
            pair("left", "right").filter(|_| operator.is_none_or(|operator| operator.kind() == "="))
        }
        "let_declaration" => pair("pattern", "value"),
        "keyword_argument" | "named_expression" => pair("name", "value"),
        // C++ has no fields here: a name and its arguments.
        "field_initializer" => pair("field", "value").or_else(|| {
            let parts = children(node);
            Some((*parts.first()?, *parts.get(1)?))
        }),
        _ => None,
    }
}

/// A name of a transform in a product.
#[derive(Clone)]
struct Factor {
    name: TransformName,
    at: Span,
    /// The object that it is a member of; empty for names of their own and members of this object.
    owner: String,
}

struct Reader<'t> {
    text: &'t str,
    /// By the ids of nodes. The library looks for a parent from the root on, each time.
    parents: HashMap<usize, Node<'t>>,
}

impl<'t> Reader<'t> {
    fn parent(&self, node: Node<'t>) -> Option<Node<'t>> {
        self.parents.get(&node.id()).copied()
    }

    /// The chains of a product that is not part of a larger one and not bound to a name.
    fn product(&self, node: Node<'t>) -> Vec<DeclaredChain> {
        if !self.is_product(node) || self.parent(node).is_some_and(|parent| self.continues(parent)) {
            return Vec::new();
        }
        let mut around = self.parent(node);
        while let Some(parent) =
            around.filter(|parent| matches!(parent.kind(), "parenthesized_expression" | "argument_list"))
        {
            around = self.parent(parent);
        }
        let is_bound = around
            .and_then(bound)
            .is_some_and(|(_, value)| value.start_byte() <= node.start_byte() && node.end_byte() <= value.end_byte());
        if is_bound {
            return Vec::new();
        }
        self.runs(node, None)
    }

    /// The chains of a value that is given to a name.
    fn binding(&self, name: Node<'t>, value: Node<'t>) -> Vec<DeclaredChain> {
        let value = match value.kind() {
            // `T_a_c(T_a_b * T_b_c)`, `T_a_c{...}`
            "argument_list" | "initializer_list" => match children(value).as_slice() {
                [only] => *only,
                _ => return Vec::new(),
            },
            _ => value,
        };
        let result = self.bound_name(name);
        self.runs(value, result.as_ref())
    }

    /// The name on the left, without the marks of a reference or a pointer.
    fn bound_name(&self, node: Node<'t>) -> Option<Factor> {
        let mut at = node;
        for _ in 0..4 {
            match at.kind() {
                "reference_declarator" | "pointer_declarator" | "mut_pattern" | "ref_pattern" => {
                    at = *children(at).last()?;
                }
                "pointer_expression" => at = at.child_by_field_name("argument")?,
                "field_expression" => at = at.child_by_field_name("field")?,
                "attribute" => at = at.child_by_field_name("attribute")?,
                "qualified_identifier" => at = at.child_by_field_name("name")?,
                _ => break,
            }
        }
        let is_name = matches!(at.kind(), "identifier" | "field_identifier");
        is_name.then(|| self.named(at, at))?
    }

    /// Runs of names of transforms in a product. A result belongs to them if the value is nothing else.
    fn runs(&self, value: Node<'t>, result: Option<&Factor>) -> Vec<DeclaredChain> {
        let factors = self.factors(value, 0);
        if let ([Some(only)], Some(result)) = (factors.as_slice(), result) {
            // A copy under another name shows nothing; an inverse, or a copy under the inverse's name, does.
            let is_swapped = only.name.target == result.name.source && only.name.source == result.name.target;
            if !is_swapped && !self.inverts(value) {
                return Vec::new();
            }
        }
        let is_whole = factors.iter().all(Option::is_some);
        let least = if is_whole && result.is_some() { 1 } else { 2 };
        let mut chains = Vec::new();
        for run in factors.split(Option::is_none) {
            let run: Vec<Factor> = run.iter().flatten().cloned().collect();
            let (Some(first), Some(last)) = (run.first(), run.last()) else {
                continue;
            };
            if run.len() < least {
                continue;
            }
            let result = result.filter(|_| is_whole).cloned();
            let mut whole = first.at.cover(last.at);
            if let Some(result) = &result {
                whole = whole.cover(result.at).cover(span(value));
            }
            chains.push(DeclaredChain {
                text: self.shown(whole),
                place: Place::text(crate::source::SourceId(0), whole),
                is_loose: run.iter().chain(&result).any(|factor| factor.owner != first.owner),
                factors: run.into_iter().map(|factor| (factor.name, factor.at)).collect(),
                result: result.map(|factor| (factor.name, factor.at)),
                not_understood: None,
            });
        }
        chains
    }

    /// Whether an inverse is taken somewhere in a value.
    fn inverts(&self, value: Node<'t>) -> bool {
        nodes(value).into_iter().any(|node| {
            let is_call = matches!(node.kind(), "call" | "call_expression");
            let name = Self::called(node)
                .filter(|_| is_call)
                .map_or("", |(_, name)| text(name, self.text));
            let is_transposed = node.kind() == "attribute" && text(node, self.text).rsplit('.').next() == Some("T");
            INVERSES.contains(&name) || matches!(name, "transpose" | "transposed") || is_transposed
        })
    }

    /// The text of a chain in one line.
    fn shown(&self, span: Span) -> String {
        let raw = self.text.get(span.start..span.end).unwrap_or_default();
        let line = raw.split_whitespace().collect::<Vec<_>>().join(" ");
        match line.char_indices().nth(MAX_TEXT) {
            Some((cut, _)) => format!("{}...", line.get(..cut).unwrap_or_default()),
            None => line,
        }
    }

    fn is_product(&self, node: Node<'t>) -> bool {
        let operator = || {
            node.child_by_field_name("operator")
                .map_or("", |operator| operator.kind())
        };
        match node.kind() {
            "binary_expression" => operator() == "*",
            "binary_operator" => matches!(operator(), "*" | "@"),
            "call_expression" | "call" => {
                let name = Self::called(node).map_or("", |(_, name)| text(name, self.text));
                PRODUCTS.contains(&name) || name == "between"
            }
            _ => false,
        }
    }

    /// Whether a node passes a product inside of it on to a larger one.
    fn continues(&self, node: Node<'t>) -> bool {
        match node.kind() {
            "parenthesized_expression"
            | "reference_expression"
            | "pointer_expression"
            | "argument_list"
            | "arguments" => self.parent(node).is_some_and(|parent| self.continues(parent)),
            "field_expression" | "attribute" => self.parent(node).is_some_and(|parent| self.continues(parent)),
            "call_expression" | "call" => {
                let name = Self::called(node).map_or("", |(_, name)| text(name, self.text));
                let passes = INVERSES.contains(&name) || SAME.contains(&name) || WRAPS.contains(&name);
                self.is_product(node)
                    || passes
                        && self
                            .parent(node)
                            .is_some_and(|parent| self.continues(parent) || bound(parent).is_some())
            }
            _ => self.is_product(node),
        }
    }

    /// What a call is made on, where it is a method, and the name of what is called.
    fn called(call: Node<'t>) -> Option<(Option<Node<'t>>, Node<'t>)> {
        let function = call.child_by_field_name("function")?;
        let plain = |name: Node<'t>| match name.kind() {
            "template_method" | "template_function" => name.child_by_field_name("name").unwrap_or(name),
            _ => name,
        };
        Some(match function.kind() {
            "generic_function" => {
                let inner = function.child_by_field_name("function")?;
                match inner.kind() {
                    "field_expression" => (inner.child_by_field_name("value"), inner.child_by_field_name("field")?),
                    _ => (None, inner.child_by_field_name("name").unwrap_or(inner)),
                }
            }
            "field_expression" => {
                let object = function
                    .child_by_field_name("argument")
                    .or_else(|| function.child_by_field_name("value"));
                (object, plain(function.child_by_field_name("field")?))
            }
            "attribute" => (
                function.child_by_field_name("object"),
                function.child_by_field_name("attribute")?,
            ),
            "qualified_identifier" | "scoped_identifier" => {
                let mut name = function;
                while let Some(inner) = name.child_by_field_name("name") {
                    name = inner;
                }
                (None, name)
            }
            _ => (None, plain(function)),
        })
    }

    /// The factors of an expression from left to right; `None` for anything but the name of a transform.
    fn factors(&self, node: Node<'t>, depth: usize) -> Vec<Option<Factor>> {
        let unknown = || vec![None];
        if depth > MAX_DEPTH {
            return unknown();
        }
        let of = |node: Option<Node<'t>>| node.map_or_else(unknown, |node| self.factors(node, depth + 1));
        let field = |name: &str| node.child_by_field_name(name);
        match node.kind() {
            "parenthesized_expression" => of(children(node).first().copied()),
            "reference_expression" | "try_expression" => of(field("value").or_else(|| children(node).first().copied())),
            "pointer_expression" => of(field("argument")),
            "unary_expression" if text(node, self.text).starts_with('*') => of(children(node).first().copied()),
            "binary_expression" | "binary_operator" if self.is_product(node) => {
                let mut all = of(field("left"));
                all.extend(of(field("right")));
                all
            }
            "call_expression" | "call" => self.call(node, depth),
            "field_expression" | "attribute" => {
                let object = field("argument").or_else(|| field("value")).or_else(|| field("object"));
                let Some(name) = field("field").or_else(|| field("attribute")) else {
                    return unknown();
                };
                match text(name, self.text) {
                    "T" => transposed(of(object), span(node)),
                    member if SAME.contains(&member) => of(object),
                    _ => vec![self.named(name, node)],
                }
            }
            "subscript_expression" | "subscript" | "index_expression" => {
                let inner = field("argument")
                    .or_else(|| field("value"))
                    .or_else(|| children(node).first().copied());
                let indices = text(node, self.text).rsplit('[').next().unwrap_or_default();
                // One element of a list, or the rotation out of a matrix; not a number out of it.
                if indices.contains(',') && !indices.contains(':') {
                    unknown()
                } else {
                    of(inner)
                }
            }
            "identifier" => vec![self.named(node, node)],
            _ => unknown(),
        }
    }

    fn call(&self, node: Node<'t>, depth: usize) -> Vec<Option<Factor>> {
        let Some((object, called)) = Self::called(node) else {
            return vec![None];
        };
        let arguments = node.child_by_field_name("arguments").map(children).unwrap_or_default();
        let name = text(called, self.text);
        let of = |node: Node<'t>| self.factors(node, depth + 1);
        match (object, arguments.as_slice()) {
            (Some(object), []) if INVERSES.contains(&name) => inverse(of(object), span(node)),
            (Some(object), []) if matches!(name, "transpose" | "transposed") => transposed(of(object), span(node)),
            (Some(object), _) if SAME.contains(&name) => of(object),
            (_, [only]) if INVERSES.contains(&name) => inverse(of(*only), span(node)),
            (_, [only]) if WRAPS.contains(&name) => of(*only),
            // `numpy.dot(a, b)` is a method by its grammar alone.
            (_, [left, right]) if PRODUCTS.contains(&name) => [of(*left), of(*right)].concat(),
            (Some(object), [only]) if PRODUCTS.contains(&name) => [of(object), of(*only)].concat(),
            (Some(object), [only]) if name == "between" => [inverse(of(object), span(object)), of(*only)].concat(),
            // A function of time, or a getter.
            (_, [] | [_]) => vec![self.named(called, node)],
            _ => vec![None],
        }
    }

    /// The transform that a name describes; `whole` counts as its place.
    fn named(&self, name: Node<'t>, whole: Node<'t>) -> Option<Factor> {
        Some(Factor {
            name: named(text(name, self.text))?,
            at: span(whole),
            owner: self.owner(name),
        })
    }

    /// What a member is a member of; nothing for names of their own and of this object.
    fn owner(&self, name: Node<'t>) -> String {
        let object = self.parent(name).and_then(|member| {
            let object = ["argument", "value", "object"]
                .iter()
                .find_map(|field| member.child_by_field_name(field));
            object.filter(|_| matches!(member.kind(), "field_expression" | "attribute"))
        });
        let text = object
            .filter(|object| *object != name)
            .map_or("", |object| text(object, self.text));
        if matches!(text, "this" | "self" | "(*this)") {
            String::new()
        } else {
            text.split_whitespace().collect()
        }
    }
}

/// Inverts factors; the place of each becomes that of the call where there is one of them.
fn inverse(factors: Vec<Option<Factor>>, call: Span) -> Vec<Option<Factor>> {
    let is_one = factors.len() == 1;
    let turned = factors.into_iter().rev().map(|factor| {
        let Factor { name, at, owner } = factor?;
        Some(Factor {
            name: name.inverse(),
            at: if is_one { call } else { at },
            owner,
        })
    });
    turned.collect()
}

/// A rotation's transpose is its inverse; that of a 4x4 has no meaning.
fn transposed(factors: Vec<Option<Factor>>, call: Span) -> Vec<Option<Factor>> {
    let are_rotations = factors
        .iter()
        .flatten()
        .all(|factor| factor.name.part == NamePart::Rotation);
    if are_rotations {
        inverse(factors, call)
    } else {
        vec![None]
    }
}
