//! The text of a configuration: one document, known keys, words of closed lists, globs, and errors with a place.

use globset::{GlobBuilder, GlobMatcher};

use crate::read::calibration::document::Node;
use crate::read::calibration::events;
use crate::read::calibration::repair::OffsetMap;
use crate::source::LineIndex;

use super::ConfigError;

pub(super) struct Reader<'t> {
    pub(super) path: &'t str,
    pub(super) text: &'t str,
    pub(super) lines: LineIndex,
}

impl<'t> Reader<'t> {
    /// For a text; `path` is its name in messages.
    pub(super) fn new(path: &'t str, text: &'t str) -> Self {
        Self {
            path,
            lines: LineIndex::new(text),
            text,
        }
    }

    /// The document of the text; `None` if it is empty.
    pub(super) fn document(&self) -> Result<Option<Node>, ConfigError> {
        let documents = events::build(self.text, &OffsetMap::default());
        if let Some(fault) = &documents.fault {
            return Err(self.error(fault.at, &fault.message));
        }
        if let Some((key, span)) = documents.repeated.first() {
            return Err(self.error(span.start, &format!("the key `{key}` occurs twice")));
        }
        let mut roots = documents.roots.into_iter();
        let root = roots.next();
        if let Some(second) = roots.next() {
            return Err(self.error(second.span.start, "expected one YAML document, found several"));
        }
        let is_nothing = |text: &str| text.is_empty() || text == "~" || text == "null";
        Ok(root.filter(|root| !root.text().is_some_and(is_nothing)))
    }

    /// A mapping with known keys only.
    pub(super) fn keys(&self, node: &Node, known: &[&str]) -> Result<(), ConfigError> {
        let words = || format!("known keys: {}", known.join(", "));
        if !node.is_mapping() {
            return Err(self.error(node.span.start, &format!("expected keys with values; {}", words())));
        }
        for (key, _) in node.pairs() {
            let text = key.text().unwrap_or_default();
            if !known.contains(&text) {
                let near = known
                    .iter()
                    .map(|known| (strsim::damerau_levenshtein(known, text), known))
                    .filter(|(distance, _)| *distance <= 2)
                    .min();
                let meant = near.map_or_else(String::new, |(_, near)| format!("did you mean `{near}`? "));
                return Err(self.error(key.span.start, &format!("unknown key `{text}`; {meant}{}", words())));
            }
        }
        Ok(())
    }

    pub(super) fn glob(&self, item: &Node, key: &str) -> Result<Option<GlobMatcher>, ConfigError> {
        let Some(value) = item.get(key) else { return Ok(None) };
        let text = value.text().filter(|text| !text.is_empty());
        let text =
            text.ok_or_else(|| self.error(value.span.start, &format!("`{key}` must be a name, or a glob with `*`")))?;
        // Frames are compared without a leading slash, as in tf2.
        let text = if key == "frame" {
            text.strip_prefix('/').unwrap_or(text)
        } else {
            text
        };
        let glob = GlobBuilder::new(text)
            .literal_separator(false)
            .build()
            .map_err(|error| {
                self.error(
                    value.span.start,
                    &format!("`{key}` is not a valid glob: {}", error.kind()),
                )
            })?;
        Ok(Some(glob.compile_matcher()))
    }

    pub(super) fn word<T: Clone>(&self, item: &Node, key: &str, words: &[(&str, T)]) -> Result<Option<T>, ConfigError> {
        let Some(value) = item.get(key) else { return Ok(None) };
        let text = value.text().unwrap_or_default();
        let known = words.iter().find(|(word, _)| word.eq_ignore_ascii_case(text));
        known.map(|(_, value)| Some(value.clone())).ok_or_else(|| {
            let words: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            let what = format!("`{key}` must be one of {}, not `{text}`", words.join(", "));
            self.error(value.span.start, &what)
        })
    }

    pub(super) fn number(&self, item: &Node, key: &str) -> Result<Option<f64>, ConfigError> {
        let Some(value) = item.get(key) else { return Ok(None) };
        self.one(value, key).map(Some)
    }

    pub(super) fn one(&self, value: &Node, key: &str) -> Result<f64, ConfigError> {
        let number = value.text().and_then(|text| text.parse::<f64>().ok());
        let number = number.filter(|number| number.is_finite());
        number.ok_or_else(|| self.error(value.span.start, &format!("`{key}` must be a number")))
    }

    /// The place of a node in words: path, line, and column if wanted.
    pub(super) fn origin(&self, node: &Node, with_column: bool) -> String {
        let place = self.lines.locate(self.text, node.span.start);
        let column = if with_column {
            format!(":{}", place.column)
        } else {
            String::new()
        };
        format!("{}:{}{column}", self.path, place.line)
    }

    pub(super) fn error(&self, at: usize, what: &str) -> ConfigError {
        let place = self.lines.locate(self.text, at);
        ConfigError(format!("{}:{}:{}: {what}", self.path, place.line, place.column))
    }
}
