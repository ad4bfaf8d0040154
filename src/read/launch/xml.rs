//! Launch files in XML, of ROS 1 (`type`, `$(arg x)`) and of ROS 2 (`exec`, `$(var x)`).

use std::collections::BTreeMap;

use roxmltree::{Attribute, Document, Node, ParsingOptions};

use crate::source::{Place, SourceValue, Span};

use super::traced::TracedText;
use super::{Call, CallCondition, LaunchFacts, PROGRAM, settings, yaml};

/// Deepest nesting of elements that is read.
const MAX_DEPTH: usize = 1000;
/// Deepest nesting of substitutions.
const MAX_NESTING: usize = 8;

pub(super) fn read(text: &str, found: &mut LaunchFacts) {
    let bom = text.len() - text.trim_start_matches('\u{feff}').len();
    let options = ParsingOptions {
        allow_dtd: true,
        nodes_limit: 1_000_000,
        ..ParsingOptions::default()
    };
    // An XML declaration must come first.
    let body = text.get(bom..).unwrap_or_default();
    match Document::parse_with_options(body, options) {
        Ok(document) => {
            let mut walk = Walk {
                body,
                base: bom,
                args: BTreeMap::new(),
                found,
            };
            walk.element(document.root_element(), CallCondition::Always, 0);
        }
        Err(error) => {
            let at = error.pos();
            let lines = body.split_inclusive('\n').take(at.row.saturating_sub(1) as usize);
            let start: usize = lines.map(str::len).sum();
            let line = body.get(start..).unwrap_or_default();
            let column = line.char_indices().nth(at.col.saturating_sub(1) as usize);
            let at = bom + (start + column.map_or(0, |(index, _)| index)).min(body.len());
            let end = text.get(at..).and_then(|rest| rest.chars().next());
            let span = Span::new(at, at + end.map_or(0, char::len_utf8));
            found.faults.push((span, format!("not XML: {error}")));
        }
    }
}

struct Walk<'a> {
    body: &'a str,
    /// Where the body begins in the source's text.
    base: usize,
    args: BTreeMap<String, TracedText>,
    found: &'a mut LaunchFacts,
}

impl Walk<'_> {
    fn element(&mut self, node: Node<'_, '_>, around: CallCondition, depth: usize) {
        let when = around.max(self.condition(node));
        match node.tag_name().name() {
            "arg" => self.arg(node, "value", true),
            "let" if when != CallCondition::Off => self.arg(node, "value", when < CallCondition::Perhaps),
            "node" => self.node(node, when),
            "executable" => self.executable(node, when),
            // Its arguments belong to another file.
            "include" => {}
            _ if depth < MAX_DEPTH => {
                for child in node.children().filter(Node::is_element) {
                    self.element(child, when, depth + 1);
                }
            }
            _ if node.has_children() => {
                let start = self.base + node.range().start;
                let fault = format!("elements are nested more than {MAX_DEPTH} deep: the inner ones are not read");
                self.found.faults.push((Span::new(start, start + 1), fault));
            }
            _ => {}
        }
    }

    /// An attribute with the place of its letters, substitutions resolved.
    fn value(&self, node: Node<'_, '_>, name: &str) -> Option<TracedText> {
        let attribute = node.attribute_node(name)?;
        Some(self.resolved(&self.traced(&attribute), 0))
    }

    fn traced(&self, attribute: &Attribute<'_, '_>) -> TracedText {
        let range = attribute.range_value();
        TracedText::new(
            attribute.value(),
            Span::new(self.base + range.start, self.base + range.end),
        )
    }

    fn arg(&mut self, node: Node<'_, '_>, key: &str, is_sure: bool) {
        let Some(name) = node.attribute("name") else { return };
        let value = match self.value(node, key) {
            Some(value) => Some(value),
            None => self.value(node, "default").map(TracedText::defaulted),
        };
        let Some(value) = value else { return };
        let value = if is_sure { value } else { value.opened() };
        self.args.insert(name.to_owned(), value);
    }

    /// `$(arg x)` and similar substitutions replaced by their values, where these are known.
    fn resolved(&self, raw: &TracedText, nesting: usize) -> TracedText {
        let mut done = TracedText::default();
        let text = raw.text();
        let mut from = 0;
        while let Some(start) = text.get(from..).and_then(|rest| rest.find("$(")).map(|at| from + at) {
            let Some(end) = closing(text, start + 1) else { break };
            done.push(&raw.part(from..start));
            let inner = raw.part(start + 2..end);
            let value = if nesting < MAX_NESTING {
                self.substitution(&self.resolved(&inner, nesting + 1))
            } else {
                None
            };
            match value {
                Some(value) => done.push(&value),
                None => done.push(&raw.part(start..end + 1).opened()),
            }
            from = end + 1;
        }
        done.push(&raw.part(from..text.len()));
        done
    }

    /// The value of the text between `$(` and `)`.
    fn substitution(&self, inner: &TracedText) -> Option<TracedText> {
        let text = inner.text();
        let (command, rest) = text.trim().split_once(char::is_whitespace)?;
        match command {
            "arg" | "var" => self.args.get(rest.trim()).cloned(),
            "optenv" | "env" => {
                let (_, default) = rest.trim().split_once(char::is_whitespace)?;
                let at = text.rfind(default)?;
                Some(inner.part(at..at + default.len()).defaulted())
            }
            _ => None,
        }
    }

    /// The condition by `if` and `unless`.
    fn condition(&self, node: Node<'_, '_>) -> CallCondition {
        let mut when = CallCondition::Always;
        for (key, wanted) in [("if", true), ("unless", false)] {
            let Some(value) = self.value(node, key) else { continue };
            let is_true = match value.text().trim().to_lowercase().as_str() {
                _ if value.is_open() => None,
                "true" | "1" => Some(true),
                "false" | "0" => Some(false),
                _ => None,
            };
            when = when.max(match is_true {
                None => CallCondition::Perhaps,
                Some(is_true) if is_true != wanted => CallCondition::Off,
                Some(_) if value.is_default() => CallCondition::ByDefault,
                Some(_) => CallCondition::Always,
            });
        }
        when
    }

    fn node(&mut self, node: Node<'_, '_>, when: CallCondition) {
        let program = node
            .attribute("type")
            .or_else(|| node.attribute("exec"))
            .unwrap_or_default();
        let package = node.attribute("pkg").map(str::to_owned);
        let is_ros2 = Some(node.has_attribute("exec"));
        let name = self.value(node, "name").filter(|name| !name.is_open());
        let name = name.map(|name| name.text().to_owned());
        if program == PROGRAM {
            self.found.call(&Call {
                name,
                package,
                is_ros2,
                when,
                words: self.value(node, "args").map(|args| args.words()).unwrap_or_default(),
                span: self.span(node),
            });
        } else if package.as_deref() == Some("robot_localization") && when != CallCondition::Off {
            self.settings(node, name.unwrap_or_else(|| program.to_owned()));
        }
    }

    fn settings(&mut self, node: Node<'_, '_>, name: String) {
        let mut values = Vec::new();
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "param" => {
                    let word = self.value(child, "value").and_then(|value| value.whole());
                    if let (Some(key), Some(word)) = (child.attribute("name"), word)
                        && !word.is_open
                    {
                        let place = Place::text(self.found.source, word.span);
                        values.push((key.to_owned(), SourceValue::new(word.text, place)));
                    }
                }
                "rosparam" => {
                    let Some(text) = child.children().find(Node::is_text) else {
                        continue;
                    };
                    let range = text.range();
                    if let Some(raw) = self.body.get(range.clone()) {
                        values.extend(yaml::values(raw, self.base + range.start, self.found.source));
                    }
                }
                _ => {}
            }
        }
        self.found.facts.localizations.extend(settings::of(name, values));
    }

    /// `<executable cmd="ros2 run tf2_ros static_transform_publisher ..."/>`.
    fn executable(&mut self, node: Node<'_, '_>, when: CallCondition) {
        let Some(command) = self.value(node, "cmd") else { return };
        let mut words = command.words();
        let Some(at) = words.iter().position(|word| word.text.ends_with(PROGRAM)) else {
            return;
        };
        let arguments = words.split_off(at + 1);
        let package = words.get(at.wrapping_sub(1)).map(|word| word.text.clone());
        self.found.call(&Call {
            name: None,
            package,
            is_ros2: Some(true),
            when,
            words: arguments,
            span: self.span(node),
        });
    }

    fn span(&self, node: Node<'_, '_>) -> Span {
        let range = node.range();
        Span::new(self.base + range.start, self.base + range.end)
    }
}

/// The parenthesis that closes the one at `open`.
fn closing(text: &str, open: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for (index, byte) in text.bytes().enumerate().skip(open) {
        match byte {
            b'(' => depth += 1,
            b')' => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return Some(index);
                }
            }
            _ => {}
        }
    }
    None
}
