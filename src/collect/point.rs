//! One message while it is being collected: a place without its topic's name.

use crate::source::MessageRef;

/// Index, stamp and log time of a message, and the index of a transform in it, if any. Small and `Copy`, so that every
/// message can have one; it becomes a [`MessageRef`] only where it is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Point {
    /// Zero-based index on the topic.
    pub(super) index: u64,
    /// Header stamp, nanoseconds.
    pub(super) stamp_ns: Option<i64>,
    /// Log time, nanoseconds.
    pub(super) log_ns: i64,
    /// Index into `transforms`.
    pub(super) transform: Option<u32>,
}

/// What a point is of: a topic, or a member of its messages.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointOwner<'a> {
    pub(super) topic: &'a str,
    pub(super) field: Option<&'a str>,
}

impl<'a> From<&'a str> for PointOwner<'a> {
    fn from(topic: &'a str) -> Self {
        Self { topic, field: None }
    }
}

impl<'a> From<&'a String> for PointOwner<'a> {
    fn from(topic: &'a String) -> Self {
        Self::from(topic.as_str())
    }
}

impl Point {
    pub(super) fn on<'a>(self, on: impl Into<PointOwner<'a>>) -> MessageRef {
        let PointOwner { topic, field } = on.into();
        let field = field.map(str::to_owned);
        MessageRef {
            topic: topic.to_owned(),
            index: self.index,
            stamp_ns: self.stamp_ns,
            log_ns: self.log_ns,
            field: self
                .transform
                .map_or(field, |index| Some(format!("transforms[{index}]"))),
        }
    }
}
