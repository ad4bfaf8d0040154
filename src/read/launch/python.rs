//! Launch files in Python: `Node(package='tf2_ros', executable='static_transform_publisher', arguments=[...])`.
//!
//! Nothing is run: simple values are followed through names that are bound once, arguments of functions and defaults of
//! launch arguments. Anything else is unknown.

mod values;

use std::collections::BTreeMap;

use tree_sitter::Node;

use crate::read::syntax::{children, nodes, parse, span, text};
use crate::source::{Place, SourceValue};

use super::{Call, CallCondition, LaunchFacts, PROGRAM, settings};
use values::{Bindings, Value, words};

/// Calls of one function that makes nodes.
const MAX_SITES: usize = 256;

struct Script<'t> {
    source: &'t str,
    /// The values assigned to names, anywhere; `None` for several values.
    assigned: BTreeMap<&'t str, Option<Node<'t>>>,
    /// Defaults of launch arguments.
    declared: BTreeMap<String, Node<'t>>,
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
    fn process(&self, call: Node<'t>, calls: &[Node<'t>], found: &mut LaunchFacts) {
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

    /// Runs `made` once, or once for each call of the function around, with its parameters bound.
    fn each_site(&self, call: Node<'t>, calls: &[Node<'t>], mut made: impl FnMut(&Bindings)) {
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
                Some((name.to_owned(), self.value(value, &Bindings::new(), 0)))
            });
            made(&bound.collect());
        }
        if sites.is_empty() {
            made(&Bindings::new());
        }
    }

    /// With an `if` around it, or `condition=` in it, it is not known whether it runs.
    fn when(&self, call: Node<'t>) -> CallCondition {
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
            CallCondition::Perhaps
        } else {
            CallCondition::Always
        }
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
