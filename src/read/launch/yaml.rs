//! Launch files in YAML (ROS 2), and settings of `robot_localization` in files of parameters.

use crate::read::calibration::document::Node;
use crate::read::calibration::events;
use crate::read::calibration::repair::OffsetMap;
use crate::source::{Place, SourceId, SourceValue, Span};
use crate::world::Facts;

use super::traced::TracedText;
use super::{Call, CallCondition, LaunchFacts, PROGRAM, settings};

/// Deeper values are not read.
pub(super) const MAX_DEPTH: usize = 32;

/// What a document states about launched publishers and settings. Spans count in `text`.
pub(crate) fn collect(root: &Node, text: &str, source: SourceId) -> Facts {
    let mut found = LaunchFacts::new(source);
    if let Some(items) = root.get("launch").and_then(Node::items) {
        for item in items {
            launched(item, text, &mut found);
        }
    }
    filters(root, "", &mut found, 0);
    found.facts
}

/// `- node: {pkg: tf2_ros, exec: static_transform_publisher, args: "..."}`, perhaps in a group.
fn launched(item: &Node, text: &str, found: &mut LaunchFacts) {
    if let Some(items) = item.get("group").and_then(Node::items) {
        for item in items.iter().filter(|item| item.get("node").is_some()) {
            launched(item, text, found);
        }
    }
    let Some(node) = item
        .get("node")
        .filter(|node| node.get("exec").and_then(Node::text) == Some(PROGRAM))
    else {
        return;
    };
    let of = |key: &str| Some(node.get(key)?.text()?.to_owned());
    let words = node.get("args").map_or_else(Vec::new, |args| {
        let written = args.text().unwrap_or_default();
        let start = args.text_start(text).unwrap_or(args.span.start);
        let traced = TracedText::new(written, Span::new(start, args.span.end.max(start)));
        let mut words = traced.words();
        for word in &mut words {
            word.is_open = word.text.contains("$(");
        }
        words
    });
    let has_condition = node.get("if").is_some() || node.get("unless").is_some();
    found.call(&Call {
        name: of("name"),
        package: of("pkg"),
        is_ros2: Some(true),
        when: if has_condition {
            CallCondition::Perhaps
        } else {
            CallCondition::Always
        },
        words,
        span: node.span,
    });
}

/// Keys that only filters of `robot_localization` have.
fn is_of_a_filter(key: &str) -> bool {
    let numbered = |stem: &str, end: &str| {
        let digits = key.strip_prefix(stem).and_then(|rest| rest.strip_suffix(end));
        digits.is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit()))
    };
    key == "two_d_mode"
        || ["odom", "imu", "pose", "twist"]
            .iter()
            .any(|stem| numbered(stem, "_config"))
}

/// Settings of filters and of `navsat_transform_node`, anywhere in the document. `name` is the key above.
fn filters(node: &Node, name: &str, found: &mut LaunchFacts, depth: usize) {
    let keys = || node.pairs().iter().filter_map(|(key, _)| key.text());
    let is_navsat = keys().any(|key| key == "magnetic_declination_radians")
        || keys().any(|key| key == "yaw_offset")
            && keys().any(|key| matches!(key, "zero_altitude" | "use_odometry_yaw"));
    if is_navsat || keys().any(is_of_a_filter) {
        let values = values_of(node, found.source);
        let node = if name.is_empty() { "robot_localization" } else { name };
        found.facts.localizations.extend(settings::of(node.to_owned(), values));
    }
    if depth < MAX_DEPTH {
        for (key, value) in node.pairs() {
            let name = match key.text() {
                Some("ros__parameters" | "/**") | None => name,
                Some(key) => key,
            };
            filters(value, name, found, depth + 1);
        }
    }
}

pub(super) fn values_of(node: &Node, source: SourceId) -> Vec<(String, SourceValue<String>)> {
    let of = |(key, value): &(Node, Node)| {
        let text = match value.items() {
            Some(items) => items.iter().filter_map(Node::text).collect::<Vec<_>>().join(" "),
            None => value.text()?.to_owned(),
        };
        Some((
            key.text()?.to_owned(),
            SourceValue::new(text, Place::text(source, value.span)),
        ))
    };
    node.pairs().iter().filter_map(of).collect()
}

/// The settings in a text that begins at `base` in its source.
pub(super) fn values(raw: &str, base: usize, source: SourceId) -> Vec<(String, SourceValue<String>)> {
    let documents = events::build(raw, &OffsetMap::starting_at(base));
    documents
        .roots
        .first()
        .map(|root| values_of(root, source))
        .unwrap_or_default()
}
