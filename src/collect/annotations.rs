//! What a recording holds besides messages, bounded.

use std::collections::BTreeMap;

/// Bound on all of it together, bytes.
pub(super) const MAX_BYTES: usize = 1 << 20;

/// Fields by the name of their record.
#[derive(Default)]
pub(super) struct Annotations {
    pub(super) kept: BTreeMap<String, BTreeMap<String, String>>,
    bytes: usize,
    /// Fields beyond the bound.
    pub(super) refused: u64,
}

impl Annotations {
    /// Takes in the fields of a record. Records of one name are merged; of two equal keys the later counts.
    pub(super) fn push(&mut self, name: &str, fields: &BTreeMap<String, String>) {
        if !self.make_room(name.len()) {
            return;
        }
        self.kept.entry(name.to_owned()).or_default();
        for (key, value) in fields {
            if !self.make_room(key.len() + value.len()) {
                return;
            }
            let fields = self.kept.entry(name.to_owned()).or_default();
            fields.insert(key.clone(), value.clone());
        }
    }

    fn make_room(&mut self, bytes: usize) -> bool {
        // Maps and strings have an overhead of their own.
        let bytes = bytes.saturating_add(64);
        let fits = self.bytes.saturating_add(bytes) <= MAX_BYTES;
        if fits {
            self.bytes += bytes;
        } else {
            self.refused += 1;
        }
        fits
    }
}
