//! Launch files in Python: `Node(package='tf2_ros', executable='static_transform_publisher', arguments=[...])`.
//!
//! Nothing is run: values are followed as far as they are plain, through names that are bound once, arguments of functions and defaults of
//! launch arguments. What goes beyond is not known.

use std::collections::BTreeMap;

use tree_sitter::Node;

use crate::read::syntax::{children, nodes, parse, span, text};
use crate::source::{Place, Placed, Span};

use super::{Call, Found, PROGRAM, When, Word, settings};

/// How far values are followed.
const MAX_DEPTH: usize = 16;
/// Calls of one function that makes nodes.
const MAX_SITES: usize = 256;

/// What an expression is, as far as it is known.
#[derive(Clone, Debug)]
enum Value {
    Text(Word),
    List(Vec<Value>),
}

/// Names that are bound where an expression stands.
type Bound = BTreeMap<String, Value>;

struct Script<'t> {
    source: &'t str,
    /// Functions by name; `None` where a name stands for several.
    functions: BTreeMap<&'t str, Option<Node<'t>>>,
    /// What is assigned to names, wherever it is; `None` where it is more than one thing.
    assigned: BTreeMap<&'t str, Option<Node<'t>>>,
    /// Defaults of launch arguments.
    declared: BTreeMap<String, Node<'t>>,
}

pub(super) fn read(source: &str, found: &mut Found) {
    let Some(tree) = parse(source, &tree_sitter_python::LANGUAGE.into()) else {
        return;
    };
    let all = nodes(tree.root_node());
    let calls: Vec<Node<'_>> = all.iter().copied().filter(|node| node.kind() == "call").collect();
    let mut script = Script {
        source,
        functions: BTreeMap::new(),
        assigned: BTreeMap::new(),
        declared: BTreeMap::new(),
    };
    for node in &all {
        match node.kind() {
            "function_definition" => {
                if let Some(name) = node.child_by_field_name("name") {
                    let known = script.functions.entry(text(name, source));
                    known.and_modify(|function| *function = None).or_insert(Some(*node));
                }
            }
            "assignment" => {
                if let Some(left) = node
                    .child_by_field_name("left")
                    .filter(|left| left.kind() == "identifier")
                {
                    let right = node.child_by_field_name("right");
                    let known = script.assigned.entry(text(left, source));
                    known.and_modify(|value| *value = None).or_insert(right);
                }
            }
            _ => {}
        }
    }
    for call in &calls {
        if script.called(*call) == "DeclareLaunchArgument"
            && let (Some(name), Some(default)) = (
                script.argument(*call, 0, "name"),
                script.argument(*call, 1, "default_value"),
            )
            && let Value::Text(name) = script.value(name, &Bound::new(), 0)
        {
            script.declared.insert(name.text, default);
        }
    }
    for call in &calls {
        match script.called(*call) {
            "Node" | "LifecycleNode" => script.node(*call, &calls, found),
            "ExecuteProcess" => script.process(*call, &calls, found),
            _ => {}
        }
    }
}

impl<'t> Script<'t> {
    /// The last part of the name of a called function.
    fn called(&self, call: Node<'t>) -> &'t str {
        let function = call.child_by_field_name("function");
        let name = function.map_or("", |function| text(function, self.source));
        name.rsplit('.').next().unwrap_or_default()
    }

    /// An argument of a call, by place or by name.
    fn argument(&self, call: Node<'t>, index: usize, name: &str) -> Option<Node<'t>> {
        self.keyword(call, name).or_else(|| {
            let arguments = children(call.child_by_field_name("arguments")?);
            let mut plain = arguments
                .into_iter()
                .filter(|node| !matches!(node.kind(), "keyword_argument" | "comment"));
            plain.nth(index)
        })
    }

    fn keyword(&self, call: Node<'t>, name: &str) -> Option<Node<'t>> {
        let arguments = children(call.child_by_field_name("arguments")?);
        arguments.into_iter().find_map(|argument| {
            let key = argument
                .child_by_field_name("name")
                .filter(|_| argument.kind() == "keyword_argument")?;
            (text(key, self.source) == name).then(|| argument.child_by_field_name("value"))?
        })
    }

    fn node(&self, call: Node<'t>, calls: &[Node<'t>], found: &mut Found) {
        let plain = |name: &str| match self.value(self.keyword(call, name)?, &Bound::new(), 0) {
            Value::Text(word) if !word.is_open => Some(word.text),
            _ => None,
        };
        let program = plain("executable").or_else(|| plain("node_executable"));
        let package = plain("package");
        if program.as_deref() == Some(PROGRAM) {
            let arguments = self.keyword(call, "arguments");
            let name = plain("name").or_else(|| plain("node_name"));
            self.each_site(call, calls, |bound| {
                let words = arguments
                    .map(|node| words(self.value(node, bound, 0)))
                    .unwrap_or_default();
                found.call(&Call {
                    name: name.clone().filter(|_| bound.is_empty()),
                    package: package.clone(),
                    is_ros2: Some(true),
                    when: self.when(call),
                    words,
                    span: span(call),
                });
            });
        } else if package.as_deref() == Some("robot_localization") {
            self.settings(call, plain("name").or(program).unwrap_or_default(), found);
        }
    }

    /// `ExecuteProcess(cmd=['ros2', 'run', 'tf2_ros', 'static_transform_publisher', ...])`.
    fn process(&self, call: Node<'t>, calls: &[Node<'t>], found: &mut Found) {
        let Some(command) = self.keyword(call, "cmd") else {
            return;
        };
        self.each_site(call, calls, |bound| {
            let words = words(self.value(command, bound, 0));
            let Some(at) = words.iter().position(|word| word.text == PROGRAM) else {
                return;
            };
            found.call(&Call {
                name: None,
                package: words.get(at.wrapping_sub(1)).map(|word| word.text.clone()),
                is_ros2: Some(true),
                when: self.when(call),
                words: words.get(at + 1..).unwrap_or_default().to_vec(),
                span: span(call),
            });
        });
    }

    /// Runs `made` once, or once for each call of the function around, its parameters bound.
    fn each_site(&self, call: Node<'t>, calls: &[Node<'t>], mut made: impl FnMut(&Bound)) {
        let function = around(call, &["function_definition"]);
        let parameters = function.and_then(|function| function.child_by_field_name("parameters"));
        let parameters = parameters.map(children).unwrap_or_default();
        let name = function.and_then(|function| function.child_by_field_name("name"));
        let name = name.map_or("", |name| text(name, self.source));
        let sites: Vec<Node<'t>> = calls
            .iter()
            .copied()
            .filter(|site| !parameters.is_empty() && self.called(*site) == name)
            .take(MAX_SITES)
            .collect();
        for site in &sites {
            let bound = parameters.iter().enumerate().filter_map(|(index, parameter)| {
                let name = parameter.child_by_field_name("name").unwrap_or(*parameter);
                let name = text(name, self.source);
                let given = self.argument(*site, index, name);
                let value = given.or_else(|| parameter.child_by_field_name("value"))?;
                Some((name.to_owned(), self.value(value, &Bound::new(), 0)))
            });
            made(&bound.collect());
        }
        if sites.is_empty() {
            made(&Bound::new());
        }
    }

    /// `if` around it, and `condition=` in it, decide what is not known here.
    fn when(&self, call: Node<'t>) -> When {
        let is_branch = around(
            call,
            &[
                "if_statement",
                "conditional_expression",
                "for_statement",
                "list_comprehension",
            ],
        );
        if is_branch.is_some() || self.keyword(call, "condition").is_some() {
            When::Perhaps
        } else {
            When::Always
        }
    }

    fn settings(&self, call: Node<'t>, name: String, found: &mut Found) {
        let Some(parameters) = self.keyword(call, "parameters") else {
            return;
        };
        let mut values = Vec::new();
        for map in children(parameters)
            .into_iter()
            .filter(|node| node.kind() == "dictionary")
        {
            for pair in children(map).into_iter().filter(|node| node.kind() == "pair") {
                let (Some(key), Some(value)) = (pair.child_by_field_name("key"), pair.child_by_field_name("value"))
                else {
                    continue;
                };
                let key = self.value(key, &Bound::new(), 0);
                let words = words(self.value(value, &Bound::new(), 0));
                let known = words.iter().all(|word| !word.is_open);
                if let (Value::Text(key), true) = (key, known) {
                    let list: Vec<String> = words.into_iter().map(|word| word.text).collect();
                    let place = Place::text(found.source, span(value));
                    values.push((key.text, Placed::new(list.join(" "), place)));
                }
            }
        }
        found.facts.localizations.extend(settings::of(name, values));
    }

    fn value(&self, node: Node<'t>, bound: &Bound, depth: usize) -> Value {
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
    fn known(&self, node: Node<'t>, bound: &Bound, depth: usize) -> Option<Value> {
        if depth > MAX_DEPTH {
            return None;
        }
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
                Some(Value::List(items.map(of).collect()))
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
    fn product(&self, node: Node<'t>, bound: &Bound, depth: usize) -> Option<Value> {
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

    fn call(&self, node: Node<'t>, bound: &Bound, depth: usize) -> Option<Value> {
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
                    list @ Value::List(_) => list,
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
                    // Where the text stands as it is.
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
    fn string(&self, node: Node<'t>, bound: &Bound, depth: usize) -> Option<Value> {
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

/// The nearest node around of one of these kinds.
fn around<'t>(node: Node<'t>, kinds: &[&str]) -> Option<Node<'t>> {
    let mut at = node.parent();
    while let Some(parent) = at {
        if kinds.contains(&parent.kind()) {
            return Some(parent);
        }
        at = parent.parent();
    }
    None
}

/// The words of a list; a list in it is one word of several pieces, as substitutions of launch files are.
fn words(value: Value) -> Vec<Word> {
    match value {
        Value::Text(word) => vec![word],
        Value::List(items) => items.into_iter().filter_map(word).collect(),
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
    }
}
