//! Whether a type is laid out as published, so that it can be read without looking at its definition again.

use std::collections::BTreeSet;

use super::{Kind, Schema};
use crate::read::messages::Wire;

/// How a type compares with the published one of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Every published field is there, in its place; more may follow.
    Published,
    /// Something is different.
    Different,
}

impl Schema {
    /// Compares a type with the published one, field by field: names (ROS 2 has made `D`, `K`, `R`, `P` of a camera lower case), forms and how often. At the end of the message
    /// itself there may be more fields; inside of it, a type has exactly the published ones.
    pub fn layout(&self, published: &Self, wire: Wire) -> Layout {
        self.layout_of(0, published, wire)
    }

    /// Whether the type at a place inside the message is exactly the published one of its name.
    pub fn is_published(&self, place: usize, wire: Wire) -> bool {
        let named = self.types.get(place).filter(|_| place > 0);
        let published = named.and_then(|one| Self::published(&one.name));
        published.is_some_and(|published| self.layout_of(place, &published, wire) == Layout::Published)
    }

    fn layout_of(&self, place: usize, published: &Self, wire: Wire) -> Layout {
        let mut to_compare = vec![(place, 0)];
        let mut seen = BTreeSet::from([(place, 0)]);
        while let Some(pair) = to_compare.pop() {
            let (Some(ours), Some(theirs)) = (self.types.get(pair.0), published.types.get(pair.1)) else {
                return Layout::Different;
            };
            let is_message = pair == (0, 0);
            let as_long = ours.fields.len() == theirs.fields.len() && ours.fault.is_none();
            if ours.fields.len() < theirs.fields.len() || !(is_message || as_long) {
                return Layout::Different;
            }
            for (field, other) in ours.fields.iter().zip(&theirs.fields) {
                let same_kind = match (&field.kind, &other.kind) {
                    (Kind::Nested(ours), Kind::Nested(theirs)) => {
                        if seen.insert((*ours, *theirs)) {
                            to_compare.push((*ours, *theirs));
                        }
                        true
                    }
                    (Kind::Header { has_seq }, Kind::Header { .. }) => *has_seq == (wire == Wire::Ros1),
                    (Kind::Unsupported(_), _) => false,
                    (ours, theirs) => ours == theirs,
                };
                if !same_kind || field.count != other.count || !field.name.eq_ignore_ascii_case(&other.name) {
                    return Layout::Different;
                }
            }
        }
        Layout::Published
    }
}
