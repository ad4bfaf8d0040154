//! Robot descriptions published in a recording.

use crate::source::MessageRef;

use super::point::Point;

/// Bound on different descriptions.
pub(super) const MAX_DESCRIPTIONS: usize = 16;
/// Bound on their bytes together; a large robot's URDF has some megabytes.
const MAX_BYTES: usize = 64 << 20;

/// Each different text once, with the first message that carries it.
#[derive(Default)]
pub(super) struct Descriptions {
    pub(super) kept: Vec<(MessageRef, String)>,
    bytes: usize,
    /// Texts beyond the bound.
    pub(super) refused: u64,
}

impl Descriptions {
    pub(super) fn push(&mut self, point: Point, topic: &str, text: &str) {
        if self.kept.iter().any(|(_, known)| known == text) {
            return;
        }
        if self.kept.len() >= MAX_DESCRIPTIONS || self.bytes + text.len() > MAX_BYTES {
            self.refused += 1;
            return;
        }
        self.bytes += text.len();
        self.kept.push((point.on(topic), text.to_owned()));
    }
}
