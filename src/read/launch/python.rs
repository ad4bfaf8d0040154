//! Launch files in Python: `Node(package='tf2_ros', executable='static_transform_publisher', arguments=[...])`.
//!
//! Nothing is run: simple values are followed through names that are bound once, arguments of functions and defaults of
//! launch arguments. Anything else is unknown.

mod values;

use std::cell::Cell;
use std::collections::BTreeMap;

use tree_sitter::Node;

use crate::read::syntax::{children, nodes, parse, span, text};
use crate::source::{Place, SourceValue};

use super::{Call, CallCondition, LaunchFacts, PROGRAM, settings};
use values::{Bindings, Value, words};

/// Calls of one function that makes nodes.
const MAX_SITES: usize = 256;

/// Expressions that are followed in one file.
const MAX_VALUES: usize = 50_000;

struct Script<'t> {
    source: &'t str,
    /// The values assigned to names, anywhere; `None` for several values.
    assigned: BTreeMap<&'t str, Option<Node<'t>>>,
    /// Defaults of launch arguments.
    declared: BTreeMap<String, Node<'t>>,
    /// Expressions that may still be followed: lists of lists grow with every level.
    left: Cell<usize>,
}

pub(super) fn read(source: &str, found: &mut LaunchFacts) {
    let tree = match parse(source, &tree_sitter_python::LANGUAGE.into()) {
        Ok(tree) => tree,
        Err(fault) => return found.faults.push(fault),
    };
    let all = nodes(tree.root_node());
    let calls: Vec<Node<'_>> = all.iter().copied().filter(|node| node.kind() == "call").collect();
    let mut script = Script {
        source,
        assigned: BTreeMap::new(),
        declared: BTreeMap::new(),
        left: Cell::new(MAX_VALUES),
    };
    for node in &all {
        if node.kind() == "assignment"
            && let Some(name) = node.child_by_field_name("left")
            && name.kind() == "identifier"
        {
            let right = node.child_by_field_name("right");
            let known = script.assigned.entry(text(name, source));
            known.and_modify(|value| *value = None).or_insert(right);
        }
    }
    for call in &calls {
        if script.called(*call) == "DeclareLaunchArgument"
            && let (Some(name), Some(default)) = (
                script.argument(*call, 0, "name"),
                script.argument(*call, 1, "default_value"),
            )
            && let Value::Text(name) = script.value(name, &Bindings::new(), 0)
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

    fn node(&self, call: Node<'t>, calls: &[Node<'t>], found: &mut LaunchFacts) {
        let plain = |name: &str| match self.value(self.keyword(call, name)?, &Bindings::new(), 0) {
            Value::Text(word) if !word.is_open => Some(word.text),
            _ => None,
        };
        let program = plain("executable").or_else(|| plain("node_executable"));
        let package = plain("package");
        if program.as_deref() == Some(PROGRAM) {
            let arguments = self.keyword(call, "arguments");
            let name = plain("name").or_else(|| plain("node_name"));
            self.each_site(call, calls, |bound, when| {
                let words = arguments
                    .map(|node| words(self.value(node, bound, 0)))
                    .unwrap_or_default();
                found.call(&Call {
                    name: name.clone().filter(|_| bound.is_empty()),
                    package: package.clone(),
                    is_ros2: Some(true),
                    when,
                    words,
                    span: span(call),
                });
            });
        } else if package.as_deref() == Some("robot_localization") {
            self.settings(call, plain("name").or(program).unwrap_or_default(), found);
        }
    }

    /// `ExecuteProcess(cmd=['ros2', 'run', 'tf2_ros', 'static_transform_publisher', ...])`.
    fn process(&self, call: Node<'t>, calls: &[Node<'t>], found: &mut LaunchFacts) {
        let Some(command) = self.keyword(call, "cmd") else {
            return;
        };
        self.each_site(call, calls, |bound, when| {
            let words = words(self.value(command, bound, 0));
            let Some(at) = words.iter().position(|word| word.text == PROGRAM) else {
                return;
            };
            found.call(&Call {
                name: None,
                package: words.get(at.wrapping_sub(1)).map(|word| word.text.clone()),
                is_ros2: Some(true),
                when,
                words: words.get(at + 1..).unwrap_or_default().to_vec(),
                span: span(call),
            });
        });
    }

    /// Runs `made` once, or once for each call of the function around, with its parameters bound, and for each item of the loops around; and
    /// says when that call of a publisher runs.
    fn each_site(&self, call: Node<'t>, calls: &[Node<'t>], mut made: impl FnMut(&Bindings, CallCondition)) {
        let function = around(call, &["function_definition"]);
        let parameters = function.and_then(|function| function.child_by_field_name("parameters"));
        let parameters = parameters.map(children).unwrap_or_default();
        let name = function.and_then(|function| function.child_by_field_name("name"));
        let name = name.map_or("", |name| text(name, self.source));
        let sites = calls
            .iter()
            .copied()
            .filter(|site| !parameters.is_empty() && self.called(*site) == name);
        let mut bindings: Vec<(Bindings, bool)> = Vec::new();
        for site in sites.take(MAX_SITES) {
            for (outer, is_known) in self.looped(site, Bindings::new()) {
                let bound = parameters.iter().enumerate().filter_map(|(index, parameter)| {
                    let name = parameter.child_by_field_name("name").unwrap_or(*parameter);
                    let name = text(name, self.source);
                    let given = self
                        .argument(site, index, name)
                        .map(|given| self.value(given, &outer, 0));
                    let default = || Some(self.value(parameter.child_by_field_name("value")?, &Bindings::new(), 0));
                    Some((name.to_owned(), given.or_else(default)?))
                });
                bindings.push((bound.collect(), is_known));
            }
        }
        if bindings.is_empty() {
            bindings.push((Bindings::new(), true));
        }
        let is_branch = around(call, &["if_statement", "conditional_expression"]).is_some();
        let is_branch = is_branch || self.keyword(call, "condition").is_some();
        let each = bindings.into_iter().flat_map(|(bound, is_known)| {
            let inner = self.looped(call, bound).into_iter();
            inner.map(move |(bound, is_item)| (bound, is_known && is_item))
        });
        for (bound, is_known) in each.take(MAX_SITES) {
            let when = if is_branch || !is_known {
                CallCondition::Perhaps
            } else {
                CallCondition::Always
            };
            made(&bound, when);
        }
    }

    /// The names bound by the loops around a node within its function, for each item, outer loops first; and whether all items are known.
    fn looped(&self, node: Node<'t>, bound: Bindings) -> Vec<(Bindings, bool)> {
        let mut loops = Vec::new();
        let mut at = node.parent();
        while let Some(parent) = at.filter(|parent| parent.kind() != "function_definition") {
            loops.push(parent);
            at = parent.parent();
        }
        let mut all = vec![(bound, true)];
        for around in loops.into_iter().rev() {
            for (names, items) in clauses(around) {
                let each = all
                    .into_iter()
                    .flat_map(|(bound, is_known)| match self.value(items, &bound, 0) {
                        Value::List(items) => {
                            let with = |item| (self.with(&bound, names, item), is_known);
                            items.into_iter().map(with).collect()
                        }
                        _ => vec![(bound, false)],
                    });
                all = each.take(MAX_SITES).collect();
            }
            // Which items a condition leaves out is not known.
            if has_condition(around) {
                for (_, is_known) in &mut all {
                    *is_known = false;
                }
            }
        }
        all
    }

    /// Names bound to an item: one, or several to its parts.
    fn with(&self, bound: &Bindings, names: Node<'t>, item: Value) -> Bindings {
        let mut bound = bound.clone();
        match (names.kind(), item) {
            ("identifier", item) => {
                bound.insert(text(names, self.source).to_owned(), item);
            }
            (_, Value::List(parts)) => {
                for (name, part) in children(names).into_iter().zip(parts) {
                    bound = self.with(&bound, name, part);
                }
            }
            _ => {}
        }
        bound
    }

    fn settings(&self, call: Node<'t>, name: String, found: &mut LaunchFacts) {
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
                let key = self.value(key, &Bindings::new(), 0);
                let words = words(self.value(value, &Bindings::new(), 0));
                let known = words.iter().all(|word| !word.is_open);
                if let (Value::Text(key), true) = (key, known) {
                    let list: Vec<String> = words.into_iter().map(|word| word.text).collect();
                    let place = Place::text(found.source, span(value));
                    values.push((key.text, SourceValue::new(list.join(" "), place)));
                }
            }
        }
        found.facts.localizations.extend(settings::of(name, values));
    }
}

/// What a loop, or a comprehension, binds: names, and the items.
fn clauses(node: Node<'_>) -> Vec<(Node<'_>, Node<'_>)> {
    let parts = match node.kind() {
        "for_statement" => vec![node],
        "list_comprehension" | "generator_expression" | "set_comprehension" => children(node),
        _ => return Vec::new(),
    };
    let of = |part: Node<'_>| matches!(part.kind(), "for_statement" | "for_in_clause");
    let parts = parts.into_iter().filter(|part| of(*part));
    parts
        .filter_map(|part| Some((part.child_by_field_name("left")?, part.child_by_field_name("right")?)))
        .collect()
}

/// Whether a comprehension leaves out items by a condition.
fn has_condition(node: Node<'_>) -> bool {
    children(node).iter().any(|part| part.kind() == "if_clause")
}

/// The nearest enclosing node of one of these kinds.
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
