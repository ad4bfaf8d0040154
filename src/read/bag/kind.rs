//! What a file is, by its first bytes.
//!
//! Owns the magic bytes of recordings and of files mistaken for one, and the messages that refuse them.

use crate::source::SourceKind;

use super::{capture, osf};

/// How many bytes decide.
pub(super) const SNIFFED: u64 = 64;

/// What a file is by its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Container {
    /// An MCAP recording.
    Mcap,
    /// A ROS 1 bag, any version.
    Rosbag1,
    /// An SQLite database, as rosbag2 writes (`.db3`).
    Sqlite,
    /// A capture of a network, pcap or pcapng.
    Capture,
    /// An OSF file of Ouster.
    Osf,
    /// A file compressed with gzip.
    Gzip,
    /// A file compressed with zstd, as rosbag2 does in file mode (`.mcap.zstd`).
    Zstd,
    /// A file compressed with lz4.
    Lz4,
    /// A file compressed with bzip2.
    Bzip2,
    /// A ZIP archive.
    Zip,
    /// A pointer left by Git LFS where the file was never downloaded.
    GitLfsPointer,
    /// No bytes at all.
    Empty,
    /// None of these.
    Unknown,
}

impl Container {
    /// Judges the first bytes; 64 are enough.
    pub fn of(first: &[u8]) -> Self {
        let captures = capture::PCAP.iter().chain([&capture::PCAPNG]);
        let captures = captures.map(|magic| (magic.as_slice(), Self::Capture));
        let magics: [(&[u8], Self); 10] = [
            (::mcap::MAGIC, Self::Mcap),
            (b"#ROSBAG V", Self::Rosbag1),
            // The name of the formats before 2.0 (up to version 1.2).
            (b"#ROSRECORD V", Self::Rosbag1),
            (b"SQLite format 3\0", Self::Sqlite),
            (&[0x1f, 0x8b], Self::Gzip),
            (&[0x28, 0xb5, 0x2f, 0xfd], Self::Zstd),
            (&[0x04, 0x22, 0x4d, 0x18], Self::Lz4),
            (b"BZh", Self::Bzip2),
            (b"PK\x03\x04", Self::Zip),
            (b"version https://git-lfs.github.com/spec/", Self::GitLfsPointer),
        ];
        if first.is_empty() {
            return Self::Empty;
        }
        if first.get(8..).is_some_and(|rest| rest.starts_with(osf::MAGIC)) {
            return Self::Osf;
        }
        magics
            .into_iter()
            .chain(captures)
            .find(|(magic, _)| first.starts_with(magic))
            .map_or(Self::Unknown, |(_, container)| container)
    }

    /// Whether there is a reader for it.
    pub(super) fn is_read(self) -> bool {
        matches!(
            self,
            Self::Mcap | Self::Rosbag1 | Self::Sqlite | Self::Capture | Self::Osf
        )
    }

    /// Why such a file cannot be read as the expected recording, and what to do. Files with a reader are
    /// never refused.
    pub(super) fn refusal(self, taken_for: SourceKind) -> (String, Option<&'static str>) {
        let not = match taken_for {
            SourceKind::Rosbag1 => "not a ROS 1 bag",
            SourceKind::Sqlite => "not a rosbag2 database",
            SourceKind::Rosbag2 => "not a recording",
            SourceKind::Pcap => "not a capture",
            SourceKind::Osf => "not an OSF file",
            _ => "not an MCAP",
        };
        let is = |what: &str| format!("{not}: this is {what}");
        match self {
            Self::Mcap | Self::Rosbag1 | Self::Sqlite | Self::Capture | Self::Osf | Self::Zstd | Self::Unknown => (
                format!("{not}: the magic bytes at byte 0 are missing"),
                Some("pass a recording; if this file should be one, its first bytes are damaged"),
            ),
            Self::Empty => ("the file is empty".to_owned(), None),
            Self::Gzip => (is("a file compressed with gzip"), Some("decompress it first: `gunzip`")),
            Self::Lz4 => (is("a file compressed with lz4"), Some("decompress it first: `unlz4`")),
            Self::Bzip2 => (
                is("a file compressed with bzip2"),
                Some("decompress it first: `bunzip2`"),
            ),
            Self::Zip => (is("a ZIP archive"), Some("unpack it first")),
            Self::GitLfsPointer => (
                is("a Git LFS pointer; the recording itself was not downloaded"),
                Some("fetch it: `git lfs pull`"),
            ),
        }
    }
}
