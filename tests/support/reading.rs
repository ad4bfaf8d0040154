//! Recordings read as the engine reads them, and as a visitor hears them.

use std::collections::BTreeSet;
use std::path::Path;

use frames_lint::collect::{CollectOptions, Collection, collect};
use frames_lint::read::bag::{self, Channel, Extent, Recording, Sampling, Selection, Visit};
use frames_lint::read::discover::discover;
use frames_lint::read::input::Input;
use frames_lint::source::{Source, SourceId, SourceKind};

/// An empty folder.
pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Collects an input as the engine does.
pub fn collect_input(input: &Input) -> (Source, Collection) {
    let mut source = Source::new(SourceId(0), input.display.clone(), input.kind);
    let parts = if input.kind == SourceKind::Rosbag2 {
        Vec::new()
    } else {
        input.parts.clone()
    };
    let how = CollectOptions {
        parts,
        ..CollectOptions::default()
    };
    let collected = collect(&input.path, &how, &mut source, &|_, _| {});
    (source, collected)
}

/// The one input that is found at a path, collected.
pub fn found(path: &Path) -> (Source, Collection) {
    let inputs = discover(&[path.to_path_buf()]).files;
    assert_eq!(inputs.len(), 1, "{inputs:#?}");
    collect_input(&inputs[0])
}

/// What the problems of a source say.
pub fn messages(source: &Source) -> Vec<&str> {
    source.problems.iter().map(|problem| problem.message.as_str()).collect()
}

/// What a reader told, in order.
#[derive(Default)]
pub struct ReadLog {
    pub channels: Vec<Channel>,
    /// Topic, time, first bytes.
    pub messages: Vec<(String, i64, Vec<u8>)>,
    /// Numbers of the messages in front of which something was left out.
    pub seams: Vec<usize>,
}

impl Visit for ReadLog {
    fn channel(&mut self, channel: &Channel) {
        assert_eq!(channel.number, self.channels.len());
        self.channels.push(channel.clone());
    }

    fn message(&mut self, channel: &Channel, message: &bag::Message<'_>) {
        assert_eq!(channel.topic, self.channels[channel.number].topic);
        let start = message.data.iter().take(16).copied().collect();
        self.messages.push((channel.topic.clone(), message.log_ns, start));
    }

    fn seam(&mut self) {
        self.seams.push(self.messages.len());
    }
}

impl ReadLog {
    /// Messages of a topic.
    pub fn count(&self, topic: &str) -> usize {
        self.messages.iter().filter(|(name, ..)| name == topic).count()
    }

    /// No message twice, all in order of time.
    pub fn check(&self) {
        assert!(self.messages.is_sorted_by_key(|(_, at, _)| *at));
        let different: BTreeSet<_> = self.messages.iter().collect();
        assert_eq!(different.len(), self.messages.len(), "a message was delivered twice");
    }
}

/// Reads a file or folder; topics called `tf_static` are wanted throughout, `/points` in a row.
pub fn read(path: &Path, sampling: Option<Sampling>) -> (Source, Extent, ReadLog) {
    let mut source = Source::new(SourceId(0), path.display().to_string(), SourceKind::Sqlite);
    let mut heard = ReadLog::default();
    let wanted = Selection {
        sampling,
        throughout: &|channel| channel.topic.ends_with("tf_static"),
        in_a_row: &|channel| channel.topic == "/points",
    };
    let recording = Recording { path, parts: &[] };
    let extent = bag::read(&recording, &wanted, &mut source, &|_, _| {}, &mut heard);
    (source, extent, heard)
}

/// A small part of a drive of some hundred kilobytes.
pub fn sparse() -> Sampling {
    Sampling {
        windows: 3,
        seconds: 0.5,
        bytes: 40_000,
        carried: None,
    }
}
