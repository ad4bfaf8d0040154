//! MCAP files from channels and messages given as bytes: what recipes are written with, and what tests of damage and of
//! strange encodings use directly.

use std::collections::BTreeMap;
use std::io::{Cursor, Seek, Write};

use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};

/// How the file is laid out.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Compression of chunks.
    pub compression: Option<mcap::Compression>,
    /// Uncompressed size at which a chunk is closed.
    pub chunk_bytes: u64,
    /// Whether there are chunks at all.
    pub chunks: bool,
    /// Whether chunks carry a checksum.
    pub checksums: bool,
}

impl Default for Layout {
    /// As rosbag2 with zstd, in chunks of 64 KiB.
    fn default() -> Self {
        Self {
            compression: Some(mcap::Compression::Zstd),
            chunk_bytes: 64 << 10,
            chunks: true,
            checksums: true,
        }
    }
}

/// A recording in the making.
pub struct RawBag<W: Write + Seek> {
    writer: Writer<W>,
}

/// What a channel is defined by.
#[derive(Clone, Debug)]
pub struct RawChannel<'a> {
    /// Topic.
    pub topic: &'a str,
    /// Type of the messages; empty for a channel without a schema.
    pub message_type: &'a str,
    /// Encoding of the definition.
    pub schema_encoding: &'a str,
    /// The definition.
    pub schema: &'a str,
    /// The definition where it is no text; stands instead of `schema` unless empty.
    pub descriptor: &'a [u8],
    /// Encoding of the messages.
    pub message_encoding: &'a str,
    /// `offered_qos_profiles`, where given.
    pub qos: Option<&'a str>,
    /// The node that writes, where given: `callerid`, as the converters of ROS 1 bags note it.
    pub writer: Option<&'a str>,
}

impl Default for RawChannel<'_> {
    fn default() -> Self {
        Self {
            topic: "/topic",
            message_type: "",
            schema_encoding: "ros2msg",
            schema: "",
            descriptor: &[],
            message_encoding: "cdr",
            qos: None,
            writer: None,
        }
    }
}

impl<W: Write + Seek> RawBag<W> {
    /// Starts a recording with profile `ros2`.
    pub fn new(out: W, layout: Layout) -> Self {
        let writer = WriteOptions::new()
            .profile("ros2")
            .library("frames-lint tests")
            .compression(layout.compression)
            .compression_threads(0)
            .chunk_size(Some(layout.chunk_bytes))
            .use_chunks(layout.chunks)
            .calculate_chunk_crcs(layout.checksums)
            .create(out)
            .unwrap();
        Self { writer }
    }

    /// Adds a channel and gives its number.
    pub fn channel(&mut self, channel: &RawChannel<'_>) -> u16 {
        let schema = if channel.message_type.is_empty() {
            0
        } else {
            let schema = match channel.descriptor {
                [] => channel.schema.as_bytes(),
                descriptor => descriptor,
            };
            self.writer
                .add_schema(channel.message_type, channel.schema_encoding, schema)
                .unwrap()
        };
        let noted = [("offered_qos_profiles", channel.qos), ("callerid", channel.writer)];
        let metadata: BTreeMap<String, String> = noted
            .into_iter()
            .filter_map(|(key, value)| Some((key.to_owned(), value?.to_owned())))
            .collect();
        self.writer
            .add_channel(schema, channel.topic, channel.message_encoding, &metadata)
            .unwrap()
    }

    /// Adds a message; `log_ns` is also its publish time.
    pub fn message(&mut self, channel: u16, log_ns: i64, data: &[u8]) {
        let time = u64::try_from(log_ns).unwrap();
        let header = MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: time,
            publish_time: time,
        };
        self.writer.write_to_known_channel(&header, data).unwrap();
    }

    /// Ends the chunk: the next message opens another.
    pub fn end_chunk(&mut self) {
        self.writer.flush().unwrap();
    }

    /// Adds a metadata record.
    pub fn metadata(&mut self, name: &str, fields: &BTreeMap<String, String>) {
        let record = mcap::records::Metadata {
            name: name.to_owned(),
            metadata: fields.clone(),
        };
        self.writer.write_metadata(&record).unwrap();
    }

    /// Adds an attachment.
    pub fn attachment(&mut self, name: &str, media_type: &str, data: &[u8]) {
        self.writer
            .attach(&mcap::Attachment {
                log_time: 0,
                create_time: 0,
                name: name.to_owned(),
                media_type: media_type.to_owned(),
                data: data.into(),
            })
            .unwrap();
    }

    /// Closes the recording.
    pub fn finish(mut self) -> W {
        self.writer.finish().unwrap();
        self.writer.into_inner()
    }
}

/// A recording in memory.
pub fn in_memory(layout: Layout, fill: impl FnOnce(&mut RawBag<Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut bag = RawBag::new(Cursor::new(Vec::new()), layout);
    fill(&mut bag);
    bag.finish().into_inner()
}
