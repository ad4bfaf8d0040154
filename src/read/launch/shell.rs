//! Shell scripts that run `static_transform_publisher`.

use std::collections::BTreeMap;

use tree_sitter::Node;

use crate::read::syntax::{children, nodes, parse, span, text};

use super::{Call, CallCondition, LaunchFacts, PROGRAM, Word};

pub(super) fn read(source: &str, found: &mut LaunchFacts) {
    let tree = match parse(source, &tree_sitter_bash::LANGUAGE.into()) {
        Ok(tree) => tree,
        Err(fault) => return found.faults.push(fault),
    };
    let all = nodes(tree.root_node());
    let mut variables: BTreeMap<&str, Option<Word>> = BTreeMap::new();
    for node in all.iter().filter(|node| node.kind() == "variable_assignment") {
        let (Some(name), Some(value)) = (node.child_by_field_name("name"), node.child_by_field_name("value")) else {
            continue;
        };
        // What is set twice is not known.
        let name = text(name, source);
        let value = (!variables.contains_key(name)).then(|| word(value, source, &variables));
        variables.insert(name, value);
    }
    for node in all.iter().filter(|node| node.kind() == "command") {
        let words: Vec<Word> = children(*node)
            .into_iter()
            .filter(|child| !matches!(child.kind(), "variable_assignment" | "file_redirect"))
            .flat_map(|child| {
                if child.kind() == "command_name" {
                    children(child)
                } else {
                    vec![child]
                }
            })
            .map(|child| word(child, source, &variables))
            .collect();
        let Some(at) = words
            .iter()
            .position(|word| word.text.rsplit('/').next() == Some(PROGRAM))
        else {
            continue;
        };
        let before = words.get(..at).unwrap_or_default();
        let runs = |program: &str| before.iter().any(|word| word.text == program);
        found.call(&Call {
            name: None,
            package: before.last().map(|word| word.text.clone()),
            is_ros2: if runs("ros2") {
                Some(true)
            } else {
                runs("rosrun").then_some(false)
            },
            when: if is_conditional(*node) {
                CallCondition::Perhaps
            } else {
                CallCondition::Always
            },
            words: words.get(at + 1..).unwrap_or_default().to_vec(),
            span: span(*node),
        });
    }
}

/// Whether the command is in a branch, a loop or a function.
fn is_conditional(node: Node<'_>) -> bool {
    let mut around = node.parent();
    while let Some(parent) = around {
        if matches!(
            parent.kind(),
            "if_statement" | "case_statement" | "while_statement" | "for_statement" | "function_definition"
        ) {
            return true;
        }
        around = parent.parent();
    }
    false
}

/// A word of a command, quotes taken off and variables put in where they are known.
fn word(node: Node<'_>, source: &str, variables: &BTreeMap<&str, Option<Word>>) -> Word {
    let raw = text(node, source);
    let plain = |text: &str, is_open: bool| Word {
        text: text.to_owned(),
        span: span(node),
        is_open,
        is_default: false,
    };
    match node.kind() {
        "raw_string" => plain(raw.trim_matches('\''), false),
        "simple_expansion" | "expansion" => {
            let name = raw
                .trim_start_matches("${")
                .trim_start_matches('$')
                .trim_end_matches('}');
            match variables.get(name) {
                Some(Some(known)) => Word {
                    span: span(node),
                    ..known.clone()
                },
                _ => plain(raw, true),
            }
        }
        "string" | "concatenation" => {
            let parts = children(node);
            let holds_more = parts
                .iter()
                .any(|part| !matches!(part.kind(), "string_content" | "word" | "number"));
            match parts.as_slice() {
                [only] if only.kind().ends_with("expansion") => word(*only, source, variables),
                _ if node.kind() == "string" => plain(raw.trim_matches('"'), holds_more),
                _ => plain(raw, holds_more),
            }
        }
        "command_substitution" | "arithmetic_expansion" => plain(raw, true),
        _ => plain(raw, false),
    }
}
