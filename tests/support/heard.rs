//! What a reader of recordings hands on, kept as it came.

use std::path::Path;

use frames_lint::read::bag::{self, Channel, Extent, Message, Recording, Selection, Visit};
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};

/// A message by its topic, log time and bytes.
pub type TopicMessage = (String, i64, Vec<u8>);

/// What a reader handed on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Delivery {
    /// Channels, in the order they were told.
    pub channels: Vec<Channel>,
    /// Messages, in the order of the file.
    pub messages: Vec<TopicMessage>,
    /// How often messages were left out.
    pub seams: usize,
}

impl Visit for Delivery {
    fn channel(&mut self, channel: &Channel) {
        assert_eq!(channel.number, self.channels.len());
        self.channels.push(channel.clone());
    }

    fn message(&mut self, channel: &Channel, message: &Message<'_>) {
        assert_eq!(*channel, self.channels[channel.number]);
        self.messages
            .push((channel.topic.clone(), message.log_ns, message.data.to_vec()));
    }

    fn seam(&mut self) {
        self.seams += 1;
    }
}

/// Reads the recording at a path, whose status and numbers must agree.
pub fn read_from(path: &Path) -> (Source, Extent, Delivery) {
    wanted_from(path, &Selection::ALL)
}

fn wanted_from(path: &Path, wanted: &Selection<'_>) -> (Source, Extent, Delivery) {
    let mut source = Source::new(SourceId(0), path.display().to_string(), SourceKind::Rosbag1);
    let mut heard = Delivery::default();
    let extent = bag::read(
        &Recording { path, parts: &[] },
        wanted,
        &mut source,
        &|_, _| {},
        &mut heard,
    );
    assert_eq!(
        source.examined.messages,
        Some(heard.messages.len() as u64),
        "{source:?}"
    );
    assert!(source.examined.bytes <= source.examined.bytes_total);
    assert!(source.status == ReadStatus::Read || !source.problems.is_empty());
    (source, extent, heard)
}

/// Reads a bag given as bytes.
pub fn read(bytes: &[u8]) -> (Source, Extent, Delivery) {
    wanted(bytes, &Selection::ALL)
}

/// Reads some of a bag given as bytes.
pub fn wanted(bytes: &[u8], wanted: &Selection<'_>) -> (Source, Extent, Delivery) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.bag");
    std::fs::write(&path, bytes).unwrap();
    wanted_from(&path, wanted)
}

/// Whether messages are some of others, in their order.
pub fn are_some_of(part: &[TopicMessage], whole: &[TopicMessage]) -> bool {
    let mut rest = whole.iter();
    part.iter().all(|message| rest.any(|other| other == message))
}
