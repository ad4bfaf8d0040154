//! ROS 1 bags from connections and messages given as bytes, closed or not, honest or not.
//!
//! Layout as in <http://wiki.ros.org/Bags/Format/2.0>, written by the text of that page and not by the reader.

use std::collections::BTreeMap;
use std::io::{Read, Write};

/// Compression of the chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compression {
    /// `none`
    None,
    /// `bz2`
    Bz2,
    /// `lz4`: a frame of LZ4 with independent blocks and a checksum of the content, as roslz4 writes.
    Lz4,
}

impl Compression {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::None, Self::Bz2, Self::Lz4];

    fn word(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Bz2 => "bz2",
            Self::Lz4 => "lz4",
        }
    }

    fn pack(self, bytes: &[u8]) -> Vec<u8> {
        match self {
            Self::None => bytes.to_vec(),
            Self::Bz2 => {
                let mut packed = Vec::new();
                let mut packer = bzip2::read::BzEncoder::new(bytes, bzip2::Compression::best());
                packer.read_to_end(&mut packed).unwrap();
                packed
            }
            Self::Lz4 => {
                let mut packer = lz4::EncoderBuilder::new()
                    .block_mode(lz4::BlockMode::Independent)
                    .checksum(lz4::ContentChecksum::ChecksumEnabled)
                    .build(Vec::new())
                    .unwrap();
                packer.write_all(bytes).unwrap();
                let (packed, result) = packer.finish();
                result.unwrap();
                packed
            }
        }
    }
}

/// How a recording ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// With an index.
    Closed,
    /// With its last chunk complete, and no index: the bag header says byte 0.
    Unindexed,
    /// In the middle of its last chunk, whose sizes are still 0: what a killed recorder leaves in `.bag.active`.
    Active,
}

/// How the file is laid out.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Compression of the chunks.
    pub compression: Compression,
    /// Uncompressed size at which a chunk is closed.
    pub chunk_bytes: usize,
    /// How it ends.
    pub ending: Ending,
    /// Bytes that index data claim for each message; 12 is true, 20 was written in 2010.
    pub index_claim: u32,
    /// Zeros between the last chunk and the index.
    pub zeros: usize,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            compression: Compression::None,
            chunk_bytes: 4000,
            ending: Ending::Closed,
            index_claim: 12,
            zeros: 0,
        }
    }
}

/// What a connection is defined by.
#[derive(Clone, Copy, Debug)]
pub struct Connection<'a> {
    /// Topic.
    pub topic: &'a str,
    /// Type of the messages, as ROS 1 spells it.
    pub message_type: &'a str,
    /// The definition.
    pub definition: &'a str,
    /// The node that publishes.
    pub callerid: Option<&'a str>,
    /// Whether it latches.
    pub latching: bool,
}

impl Default for Connection<'_> {
    fn default() -> Self {
        Self {
            topic: "/topic",
            message_type: "acme_msgs/Thing",
            definition: "Header header\n",
            callerid: None,
            latching: false,
        }
    }
}

/// A bag that was written, and where its parts stand.
#[derive(Clone, Debug)]
pub struct BagFile {
    /// The file.
    pub bytes: Vec<u8>,
    /// Byte of the record of every chunk.
    pub chunks: Vec<usize>,
    /// Byte of the index; the length where there is none.
    pub index: usize,
}

#[derive(Default)]
struct Chunk {
    bytes: Vec<u8>,
    /// Log time and offset in the chunk of every message, by connection.
    messages: BTreeMap<u32, Vec<(i64, u32)>>,
}

/// A recording in the making.
pub struct Rosbag1 {
    layout: Layout,
    written: BagFile,
    connections: Vec<Vec<u8>>,
    /// Connections that stand in a chunk already.
    introduced: usize,
    infos: Vec<Vec<u8>>,
    chunk: Chunk,
}

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
const TOP: usize = 4104;

/// A record of a header and data.
pub fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    claiming(fields, data.len() as u32, data)
}

/// A record that claims a length of its data.
pub fn claiming(fields: &[(&str, &[u8])], claim: u32, data: &[u8]) -> Vec<u8> {
    let header = header(fields);
    [
        &(header.len() as u32).to_le_bytes(),
        header.as_slice(),
        &claim.to_le_bytes(),
        data,
    ]
    .concat()
}

fn header(fields: &[(&str, &[u8])]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (name, value) in fields {
        let len = (name.len() + 1 + value.len()) as u32;
        bytes.extend(len.to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.push(b'=');
        bytes.extend(*value);
    }
    bytes
}

fn time(ns: i64) -> [u8; 8] {
    let seconds = u32::try_from(ns / 1_000_000_000).unwrap();
    let nanoseconds = u32::try_from(ns % 1_000_000_000).unwrap();
    let mut bytes = [0; 8];
    bytes[..4].copy_from_slice(&seconds.to_le_bytes());
    bytes[4..].copy_from_slice(&nanoseconds.to_le_bytes());
    bytes
}

impl Rosbag1 {
    /// Starts a recording.
    pub fn new(layout: Layout) -> Self {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(top(0, 0, 0));
        let index = bytes.len();
        Self {
            layout,
            written: BagFile {
                bytes,
                chunks: Vec::new(),
                index,
            },
            connections: Vec::new(),
            introduced: 0,
            infos: Vec::new(),
            chunk: Chunk::default(),
        }
    }

    /// Adds a connection and gives its number.
    pub fn connection(&mut self, connection: &Connection<'_>) -> u32 {
        let number = self.connections.len() as u32;
        let mut fields: Vec<(&str, &[u8])> = vec![
            ("topic", connection.topic.as_bytes()),
            ("type", connection.message_type.as_bytes()),
            ("md5sum", b"0123456789abcdef0123456789abcdef"),
            ("message_definition", connection.definition.as_bytes()),
        ];
        if let Some(node) = connection.callerid {
            fields.push(("callerid", node.as_bytes()));
        }
        if connection.latching {
            fields.push(("latching", b"1"));
        }
        let named: [(&str, &[u8]); 3] = [
            ("op", &[7]),
            ("conn", &number.to_le_bytes()),
            ("topic", connection.topic.as_bytes()),
        ];
        self.connections.push(record(&named, &header(&fields)));
        number
    }

    /// Adds a message.
    pub fn message(&mut self, connection: u32, log_ns: i64, data: &[u8]) {
        while self.introduced < self.connections.len() {
            self.chunk.bytes.extend(&self.connections[self.introduced]);
            self.introduced += 1;
        }
        let offset = self.chunk.bytes.len() as u32;
        let fields: [(&str, &[u8]); 3] = [
            ("op", &[2]),
            ("conn", &connection.to_le_bytes()),
            ("time", &time(log_ns)),
        ];
        self.chunk.bytes.extend(record(&fields, data));
        self.chunk
            .messages
            .entry(connection)
            .or_default()
            .push((log_ns, offset));
        if self.chunk.bytes.len() >= self.layout.chunk_bytes {
            self.close_chunk();
        }
    }

    /// Adds bytes to the open chunk as they are.
    pub fn raw(&mut self, bytes: &[u8]) {
        self.chunk.bytes.extend(bytes);
    }

    /// Closes the chunk.
    pub fn close_chunk(&mut self) {
        let Chunk { bytes, messages } = std::mem::take(&mut self.chunk);
        if bytes.is_empty() {
            return;
        }
        let at = self.written.bytes.len();
        self.written.chunks.push(at);
        let packed = self.layout.compression.pack(&bytes);
        let head = self.chunk_head(bytes.len() as u32);
        self.written.bytes.extend(record(&borrowed(&head), &packed));
        for (connection, entries) in &messages {
            let count = entries.len() as u32;
            let fields: [(&str, &[u8]); 4] = [
                ("op", &[4]),
                ("ver", &1_u32.to_le_bytes()),
                ("conn", &connection.to_le_bytes()),
                ("count", &count.to_le_bytes()),
            ];
            let data: Vec<u8> = entries
                .iter()
                .flat_map(|(log_ns, offset)| [&time(*log_ns)[..], &offset.to_le_bytes()].concat())
                .collect();
            let claim = self.layout.index_claim * count;
            self.written.bytes.extend(claiming(&fields, claim, &data));
        }
        let times = || messages.values().flatten().map(|(log_ns, _)| *log_ns);
        let counts: Vec<u8> = messages
            .iter()
            .flat_map(|(connection, entries)| [connection.to_le_bytes(), (entries.len() as u32).to_le_bytes()].concat())
            .collect();
        let fields: [(&str, &[u8]); 6] = [
            ("op", &[6]),
            ("ver", &1_u32.to_le_bytes()),
            ("chunk_pos", &(at as u64).to_le_bytes()),
            ("start_time", &time(times().min().unwrap_or(0))),
            ("end_time", &time(times().max().unwrap_or(0))),
            ("count", &(messages.len() as u32).to_le_bytes()),
        ];
        self.infos.push(record(&fields, &counts));
    }

    fn chunk_head(&self, size: u32) -> Vec<(&'static str, Vec<u8>)> {
        vec![
            ("op", vec![5]),
            ("compression", self.layout.compression.word().as_bytes().to_vec()),
            ("size", size.to_le_bytes().to_vec()),
        ]
    }

    /// Ends the recording.
    pub fn finish(mut self) -> BagFile {
        if self.layout.ending == Ending::Active {
            let bytes = std::mem::take(&mut self.chunk.bytes);
            let packed = self.layout.compression.pack(&bytes);
            self.written.chunks.push(self.written.bytes.len());
            let head = self.chunk_head(0);
            self.written.bytes.extend(record(&borrowed(&head), &[]));
            // A compressor holds back what does not fill a block; here the end of the stream is missing.
            let end = match self.layout.compression {
                Compression::None => packed.len(),
                _ => packed.len() - 5,
            };
            self.written.bytes.extend(&packed[..end]);
        } else {
            self.close_chunk();
        }
        self.written.index = self.written.bytes.len();
        if self.layout.ending == Ending::Closed {
            self.written.bytes.extend(vec![0; self.layout.zeros]);
            self.written.index = self.written.bytes.len();
            self.written.bytes.extend(self.connections.concat());
            self.written.bytes.extend(self.infos.concat());
            let top = top(self.written.index, self.connections.len(), self.infos.len());
            self.written.bytes[MAGIC.len()..MAGIC.len() + TOP].copy_from_slice(&top);
        }
        self.written
    }
}

/// The record at the top, which has the same length whatever it says.
pub fn top(index: usize, connections: usize, chunks: usize) -> Vec<u8> {
    let fields: [(&str, &[u8]); 4] = [
        ("op", &[3]),
        ("index_pos", &(index as u64).to_le_bytes()),
        ("conn_count", &(connections as u32).to_le_bytes()),
        ("chunk_count", &(chunks as u32).to_le_bytes()),
    ];
    let padding = TOP - 8 - header(&fields).len();
    record(&fields, &vec![b' '; padding])
}

fn borrowed<'a>(fields: &'a [(&'static str, Vec<u8>)]) -> Vec<(&'static str, &'a [u8])> {
    fields.iter().map(|(name, value)| (*name, value.as_slice())).collect()
}
