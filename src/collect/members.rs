//! Members inside the messages of a topic with the content of a standard type.
//!
//! Owns how many such members are kept. Must not know how they were found.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::read::messages::content::{Body, Member};
use crate::world::bag::MemberEvidence;

use super::CloudOptions;
use super::content::Contents;
use super::names::Names;
use super::point::{Point, PointOwner};
use super::series::RowBudget;
use super::thin::SampleBudget;

/// Bound on the members of all topics together; a driver has some five.
pub(super) const MAX_MEMBERS: usize = 256;
/// A topic's first member has the room of the topic, which usually has no other content; each further one that of a topic
/// so much later.
const LATER: usize = 16;

/// The members of one topic.
pub(super) struct Members {
    rank: usize,
    of_clouds: CloudOptions,
    of_type: usize,
    known: BTreeMap<Arc<str>, Box<MemberState>>,
    /// Those beyond the bound.
    pub(super) refused: u64,
}

struct MemberState {
    guessed: bool,
    first: Point,
    frames: Names,
    children: Names,
    contents: Contents,
}

impl Members {
    /// Those of the topic that came `rank`-th, from 0, and `of_type`-th among those of its type.
    pub(super) fn new(rank: usize, of_type: usize, of_clouds: CloudOptions) -> Self {
        Self {
            rank,
            of_clouds,
            of_type,
            known: BTreeMap::new(),
            refused: 0,
        }
    }

    /// Messages were left out here.
    pub(super) fn seam(&mut self) {
        for one in self.known.values_mut() {
            one.contents.seam();
        }
    }

    /// Takes in a member of the message at `point`; for a new one `room` is how many more are allowed.
    pub(super) fn push(&mut self, point: Point, member: &Member<'_>, room: &mut usize) {
        let point = Point {
            stamp_ns: member.header.as_ref().map(|header| header.stamp_ns),
            ..point
        };
        if !self.known.contains_key(&member.field) {
            let Some(left) = room.checked_sub(1) else {
                self.refused += 1;
                return;
            };
            *room = left;
            let rank = self.rank + LATER * self.known.len();
            let share = SampleBudget::of(rank).with_clouds(self.of_type + self.known.len());
            let one = MemberState {
                guessed: member.guessed,
                first: point,
                frames: Names::new(share),
                children: Names::new(share),
                contents: Contents::new(share, RowBudget::of(rank), self.of_clouds.clone()),
            };
            self.known.insert(Arc::clone(&member.field), Box::new(one));
        }
        let Some(one) = self.known.get_mut(&member.field) else {
            return;
        };
        if let Some(header) = &member.header {
            one.frames.add(&header.frame_id, point);
        }
        if let Body::Odometry(odometry) = &member.body {
            one.children.add(&odometry.child, point);
        }
        one.contents.body(point, &member.body);
    }

    pub(super) fn finish(self, topic: &str) -> BTreeMap<String, MemberEvidence> {
        let finish = |(field, one): (Arc<str>, Box<MemberState>)| {
            let on = PointOwner {
                topic,
                field: Some(&field),
            };
            let evidence = MemberEvidence {
                guessed: one.guessed,
                header_frames: one.frames.finish(on),
                child_frames: one.children.finish(on),
                first: Some(one.first.on(on)),
                content: one.contents.finish(on).into(),
            };
            (field.to_string(), evidence)
        };
        self.known.into_iter().map(finish).collect()
    }

    /// Names of frames, of headers and of children, with their count and first message.
    pub(super) fn names(&self) -> impl Iterator<Item = (&str, [&Names; 2])> {
        self.known
            .iter()
            .map(|(field, one)| (&**field, [&one.frames, &one.children]))
    }
}
