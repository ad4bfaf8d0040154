//! Messages of a recording that stay unread, reported once for each type.

use std::collections::BTreeMap;

use crate::source::{Place, ReadStatus, Source};

use super::MAX_PROBLEMS;
use super::topic::Topic;

/// What the user can provide to make the messages of a topic readable, if anything.
pub(super) fn help(topic: &Topic) -> Option<&'static str> {
    topic
        .lacks_definition
        .then_some("pass the folder of the package that defines it with --msg-path")
}

/// Reports the types that stay unread, with the count of their messages and the reason. A recording whose only type stays unread is
/// reported as a whole elsewhere.
pub(super) fn say(topics: &[Topic], source: &mut Source) {
    let mut types: BTreeMap<(&str, &str), (u64, ReadStatus, Option<&str>)> = BTreeMap::new();
    let spoken = || topics.iter().filter(|topic| topic.count > 0);
    for topic in spoken() {
        // An unknown type does not make the recording incomplete; a standard one that is not read, or not as published, does.
        let (why, status) = match (topic.unread(), &topic.note) {
            (Some(why), _) if topic.is_asked_for => (why, ReadStatus::Partial),
            (Some(why), _) => (why, ReadStatus::Read),
            (None, Some(note)) => (note.as_str(), ReadStatus::Partial),
            (None, None) => continue,
        };
        let entry = (0, status, help(topic));
        types.entry((topic.message_type.as_str(), why)).or_insert(entry).0 += topic.whole_count();
    }
    if types.len() == 1 && spoken().all(|topic| topic.unread().is_some()) {
        return;
    }
    let (id, left_out) = (source.id, types.len().saturating_sub(MAX_PROBLEMS));
    for ((message_type, why), (count, status, help)) in types.into_iter().take(MAX_PROBLEMS) {
        let of = if message_type.is_empty() {
            "an unnamed type".to_owned()
        } else {
            format!("`{message_type}`")
        };
        let message = format!("{count} messages of {of}: {why}");
        source.problem_with_help(status, Place::whole(id), message, help.map(str::to_owned));
    }
    if left_out > 0 {
        let message = format!("messages of {left_out} more types could not be decoded");
        source.problem(ReadStatus::Read, Place::whole(id), message);
    }
}
