//! One message while it is being collected: a place without its topic's name.

use crate::source::MessageRef;

/// Index, stamp and log time of a message, and the transform in it where one is meant. Small and `Copy`, so that every
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

impl Point {
    pub(super) fn on(self, topic: &str) -> MessageRef {
        MessageRef {
            topic: topic.to_owned(),
            index: self.index,
            stamp_ns: self.stamp_ns,
            log_ns: self.log_ns,
            field: self.transform.map(|index| format!("transforms[{index}]")),
        }
    }
}
