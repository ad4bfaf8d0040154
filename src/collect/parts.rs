//! The files of a split recording: what each of them holds.

use crate::read::bag::Channel;
use crate::world::bag::Part;

use super::topic::last_segment;

/// Bound on the files that are kept apart.
const MAX_PARTS: usize = 10_000;

/// The files met so far; none where the recording is one file.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) kept: Vec<Part>,
    /// Files beyond the bound.
    pub(super) refused: u64,
}

impl Parts {
    /// What follows is in this file.
    pub(super) fn start(&mut self, name: &str) {
        if self.kept.len() >= MAX_PARTS {
            self.refused += 1;
            return;
        }
        self.kept.push(Part {
            path: name.to_owned(),
            start_ns: None,
            end_ns: None,
            messages: 0,
            static_transforms: false,
        });
    }

    fn current(&mut self) -> Option<&mut Part> {
        self.kept.last_mut().filter(|_| self.refused == 0)
    }

    /// Takes in a message of the current file.
    pub(super) fn message(&mut self, channel: &Channel, log_ns: i64) {
        if let Some(part) = self.current() {
            part.messages += 1;
            part.start_ns = Some(part.start_ns.map_or(log_ns, |start| start.min(log_ns)));
            part.end_ns = Some(part.end_ns.map_or(log_ns, |end| end.max(log_ns)));
            part.static_transforms |= is_static(channel);
        }
    }
}

fn is_static(channel: &Channel) -> bool {
    last_segment(&channel.topic) == "tf_static"
}
