//! The index of a file: sensors, streams and chunks; and how it is made anew of the chunks where it is missing.
//!
//! Source: ouster-sdk, `ouster_osf/fb/metadata.fbs`, `chunk.fbs`, `os_sensor/*.fbs`, `streaming/streaming_info.fbs`, and
//! `ouster_osf/src/reader_base.cpp`, `sensor_info_stream.cpp`.

use std::collections::HashMap;

use super::OsfError;
use super::file::Chunk;
use super::flat::Table;

/// The most bytes of metadata that are unpacked, and the most sensors, where the index is made anew.
const MOST_JSON: usize = 1 << 22;
const MOST_SENSORS: usize = 64;
/// The stream that a scan belongs to, in an index that is made anew.
const SCANS: &str = "ouster/v1/os_sensor/LidarScanStream";

/// What is in a file, and where.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Index {
    /// The first time of a message, nanoseconds by the host's clock.
    pub start_ns: u64,
    /// The last time of a message, nanoseconds by the host's clock.
    pub end_ns: u64,
    /// The sensors.
    pub sensors: Vec<Sensor>,
    /// The streams of messages.
    pub streams: Vec<Stream>,
    /// The chunks in the order of the file.
    pub chunks: Vec<Indexed>,
}

/// A sensor of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Its id within the file.
    pub id: u32,
    /// Its metadata, for [`crate::read::ouster::Metadata::parse`].
    pub json: String,
}

/// A stream of messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    /// Its id within the file.
    pub id: u32,
    /// What its messages are: "ouster/v1/os_sensor/LidarScanStream".
    pub kind: String,
    /// The sensor of a stream of lidar scans.
    pub sensor: Option<u32>,
}

/// A chunk as the index has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Indexed {
    /// Where it is, bytes from the start of the file.
    pub offset: u64,
    /// Where the next chunk or the index is, bytes from the start of the file.
    pub end: u64,
    /// The first time of its messages, nanoseconds.
    pub start_ns: u64,
    /// The last time of its messages, nanoseconds.
    pub end_ns: u64,
    /// Its stream and its number of messages, where the file says so.
    pub messages: Option<(u32, u32)>,
}

impl Index {
    /// Reads the block of an index; chunks are between `base` and `end`.
    pub(super) fn read(block: &[u8], base: u64, end: u64) -> Result<Self, OsfError> {
        let damaged = || OsfError::Damaged { part: "index" };
        let table = Table::root(block, Some(b"OSF#")).ok_or_else(damaged)?;
        let mut index = Self {
            start_ns: table.u64(1),
            end_ns: table.u64(2),
            ..Self::default()
        };
        let mut counts = HashMap::new();
        for entry in table.tables(4) {
            let (entry, kind) = entry
                .and_then(|entry| Some((entry, entry.text(1)?)))
                .ok_or_else(damaged)?;
            let id = entry.u32(0);
            let content = entry.vector(2, 1).and_then(|bytes| Table::root(bytes, None));
            match (kind.rsplit('/').next().unwrap_or_default(), content) {
                ("LidarSensor", content) => {
                    let json = content.and_then(|c| c.text(0)).ok_or_else(damaged)?.to_owned();
                    index.sensors.push(Sensor { id, json });
                }
                ("StreamingInfo", Some(content)) => {
                    counts.extend(
                        content
                            .tables(0)
                            .flatten()
                            .map(|info| (info.u64(0), (info.u32(1), info.u32(2)))),
                    );
                }
                ("LidarScanStream", Some(content)) => index.stream(id, kind, Some(content.u32(0))),
                (name, _) if name.contains("Stream") => index.stream(id, kind, None),
                _ => {}
            }
        }
        for chunk in table.vector(3, 24).unwrap_or_default().as_chunks::<24>().0 {
            let Some(numbers) = chunk.as_chunks().0.first_chunk() else {
                continue;
            };
            let [start_ns, end_ns, offset] = numbers.map(u64::from_le_bytes);
            let messages = counts.get(&offset).copied();
            index.chunks.push(Indexed {
                offset: base.saturating_add(offset),
                end,
                start_ns,
                end_ns,
                messages,
            });
        }
        index.chunks.sort_by_key(|chunk| chunk.offset);
        index.chunks.dedup_by_key(|chunk| chunk.offset);
        let ends: Vec<_> = index.chunks.iter().skip(1).map(|chunk| chunk.offset).collect();
        index
            .chunks
            .iter_mut()
            .zip(ends)
            .for_each(|(chunk, end)| chunk.end = end);
        Ok(index)
    }

    /// Adds a chunk to an index that is made anew; None where it does not say what it has, as those of version 2.0.
    pub(super) fn add(&mut self, offset: u64, chunk: &Chunk) -> Option<()> {
        let kind = chunk.kind()?;
        let mut indexed = Indexed {
            offset,
            end: offset + chunk.length(),
            start_ns: u64::MAX,
            end_ns: 0,
            messages: None,
        };
        for message in chunk.messages().flatten() {
            indexed.start_ns = indexed.start_ns.min(message.time_ns);
            indexed.end_ns = indexed.end_ns.max(message.time_ns);
            indexed.messages = Some((message.stream, indexed.messages.map_or(1, |(_, count)| count + 1)));
            if kind.ends_with("/SensorInfoStreamMeta") {
                self.sensor(message.bytes);
            }
            self.stream(message.stream, kind, None);
        }
        indexed.messages?;
        self.start_ns = if self.chunks.is_empty() {
            indexed.start_ns
        } else {
            self.start_ns.min(indexed.start_ns)
        };
        self.end_ns = self.end_ns.max(indexed.end_ns);
        self.chunks.push(indexed);
        Some(())
    }

    /// Adds the sensor of a message that is there for this purpose, and its stream of lidar scans.
    fn sensor(&mut self, message: &[u8]) -> Option<()> {
        let table = Table::root(message, None)?;
        let id = table.u32(0);
        if self.sensors.len() < MOST_SENSORS && self.sensors.iter().all(|sensor| sensor.id != id) {
            let json = zstd::bulk::decompress(table.vector(2, 1)?, MOST_JSON).ok()?;
            self.sensors.push(Sensor {
                id,
                json: String::from_utf8(json).ok()?,
            });
            self.stream(table.u32(1), SCANS, Some(id));
        }
        Some(())
    }

    fn stream(&mut self, id: u32, kind: &str, sensor: Option<u32>) {
        if self.streams.iter().all(|stream| stream.id != id) {
            self.streams.push(Stream {
                id,
                kind: kind.to_owned(),
                sensor,
            });
        }
    }
}
