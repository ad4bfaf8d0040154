//! The keys `conventions` and `dataset` of the configuration: what topics, frames and files are expressed in.

use crate::read::calibration::document::Node;
use crate::source::Span;
use crate::tables::Tables;
use crate::world::NamedDataset;
use crate::world::conventions::{
    BodyAxes, Convention, Declaration, Fields, QuaternionAlgebra, QuaternionOrder, Scope, TimeScale, WorldAxes,
};

use super::ConfigError;
use super::reader::Reader;

/// The keys of one declaration.
const KEYS: &[&str] = &[
    "topic",
    "frame",
    "file",
    "world",
    "body",
    "quaternion",
    "time",
    "fields",
];

impl Reader<'_> {
    pub(super) fn dataset(&self, node: &Node, tables: &Tables) -> Result<(NamedDataset, Span), ConfigError> {
        let row = node.text().and_then(|text| tables.dataset(text));
        let row = row.ok_or_else(|| {
            let names = tables.dataset_names().join(", ");
            let what = format!(
                "`dataset` must be one of {names}, not `{}`",
                node.text().unwrap_or("a list or a mapping")
            );
            self.error(node.span.start, &what)
        })?;
        Ok((NamedDataset { row, place: None }, node.span))
    }

    pub(super) fn conventions(&self, root: &Node) -> Result<Vec<(Declaration, Span)>, ConfigError> {
        let Some(list) = root.get("conventions") else {
            return Ok(Vec::new());
        };
        let items = list.items().ok_or_else(|| {
            self.error(
                list.span.start,
                "`conventions` must be a list: `- topic: /imu` on one line, `world: NED` below it",
            )
        })?;
        items.iter().map(|item| self.declaration(item)).collect()
    }

    fn declaration(&self, item: &Node) -> Result<(Declaration, Span), ConfigError> {
        self.keys(item, KEYS)?;
        let scope = Scope {
            topic: self.glob(item, "topic")?,
            frame: self.glob(item, "frame")?,
            file: self.glob(item, "file")?,
        };
        if scope.topic.is_none() && scope.frame.is_none() && scope.file.is_none() {
            return Err(self.error(
                item.span.start,
                "this applies to nothing: `topic`, `frame` or `file` is missing",
            ));
        }
        let mut convention = Convention {
            world: self.word(item, "world", WorldAxes::WORDS)?,
            body: self.word(item, "body", BodyAxes::WORDS)?,
            time: self.word(item, "time", TimeScale::WORDS)?,
            fields: self.word(item, "fields", Fields::WORDS)?,
            ..Convention::default()
        };
        if let Some(quaternion) = item.get("quaternion") {
            self.keys(quaternion, &["order", "algebra"])?;
            convention.order = self.word(quaternion, "order", QuaternionOrder::WORDS)?;
            convention.algebra = self.word(quaternion, "algebra", QuaternionAlgebra::WORDS)?;
        }
        if convention.is_empty() {
            let what = "this declares nothing: `world`, `body`, `quaternion`, `time` or `fields` is missing";
            return Err(self.error(item.span.start, what));
        }
        let origin = self.origin(item, false);
        let declaration = Declaration {
            scope,
            convention,
            origin,
            place: None,
        };
        Ok((declaration, item.span))
    }
}
