//! What a reader of recordings hands on, kept as it came.

use std::path::Path;

use frames_lint::read::bag::{self, Channel, Extent, Message, Recording, Visit, Wanted};
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};

/// A message by its topic, log time and bytes.
pub type Said = (String, i64, Vec<u8>);

/// What a reader handed on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Heard {
    /// Channels, in the order they were told.
    pub channels: Vec<Channel>,
    /// Messages, in the order of the file.
    pub messages: Vec<Said>,
    /// How often messages were left out.
    pub seams: usize,
}

impl Visit for Heard {
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
pub fn read_from(path: &Path) -> (Source, Extent, Heard) {
    wanted_from(path, &Wanted::ALL)
}

fn wanted_from(path: &Path, wanted: &Wanted<'_>) -> (Source, Extent, Heard) {
    let mut source = Source::new(SourceId(0), path.display().to_string(), SourceKind::Rosbag1);
    let mut heard = Heard::default();
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
pub fn read(bytes: &[u8]) -> (Source, Extent, Heard) {
    wanted(bytes, &Wanted::ALL)
}

/// Reads some of a bag given as bytes.
pub fn wanted(bytes: &[u8], wanted: &Wanted<'_>) -> (Source, Extent, Heard) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.bag");
    std::fs::write(&path, bytes).unwrap();
    wanted_from(&path, wanted)
}

/// Whether messages are some of others, in their order.
pub fn are_some_of(part: &[Said], whole: &[Said]) -> bool {
    let mut rest = whole.iter();
    part.iter().all(|message| rest.any(|other| other == message))
}
