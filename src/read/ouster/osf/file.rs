//! The file: its header, and its chunks, which are read one at a time.
//!
//! Source: ouster-sdk, `ouster_osf/fb/header.fbs`, `chunk.fbs`, and `ouster_osf/src/file.cpp`, `chunk.cpp`.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::flat::{SIZE_BYTES, Table};
use super::{Index, Indexed, OsfError, Sensor};

/// The most bytes of a block that are accepted; ouster-sdk begins a new chunk after 2 MiB.
const MOST_BLOCK: u64 = 1 << 28;
/// The bytes of a block besides its flatbuffer: the size before it, the CRC behind it.
const FRAME_BYTES: u64 = 8;
const CRC_BYTES: usize = 4;
/// The header's status of a finished file.
const VALID: u8 = 2;
/// The major version that is known.
const MAJOR: u64 = 2;
/// The number of version 2.1: up to here versions were counted, since then each part has 16 bits.
const VERSION_2_1: u64 = 21;

/// An OSF file that is open.
#[derive(Debug)]
pub struct Osf<R> {
    file: R,
    /// Version of the format: major, minor.
    pub version: (u64, u64),
    /// What is in the file.
    pub index: Index,
    /// Why the index was made anew of the chunks, up to the first one that is damaged; None where the file has one.
    pub rebuilt: Option<OsfError>,
}

/// A chunk that was read.
#[derive(Clone, Debug)]
pub struct Chunk(Vec<u8>);

/// A message of a chunk.
#[derive(Clone, Copy, Debug)]
pub struct Message<'c> {
    /// When the host received it, nanoseconds.
    pub time_ns: u64,
    /// When the sensor measured it, nanoseconds; 0 where the file lacks it.
    pub sensor_ns: u64,
    /// Its stream.
    pub stream: u32,
    /// Its flatbuffer, with the size before it.
    pub bytes: &'c [u8],
}

impl Chunk {
    fn table(&self) -> Option<Table<'_>> {
        Table::root(&self.0, Some(b"OSF!"))
    }

    pub(super) fn kind(&self) -> Option<&str> {
        self.table()?.text(1)
    }

    pub(super) fn length(&self) -> u64 {
        self.0.len() as u64
    }

    /// The messages; a damaged one is an error in its place, and so is one that others' bytes leave no room for.
    pub fn messages(&self) -> impl Iterator<Item = Result<Message<'_>, OsfError>> {
        let mut room = self.0.len();
        self.table()
            .into_iter()
            .flat_map(|chunk| chunk.tables(0))
            .map(move |message| {
                let content = message.and_then(|message| {
                    let bytes = message.vector(2, 1)?;
                    room = room.checked_sub(bytes.len())?;
                    Some((message, bytes))
                });
                let (message, bytes) = content.ok_or(OsfError::Damaged { part: "message" })?;
                Ok(Message {
                    time_ns: message.u64(0),
                    sensor_ns: message.u64(3),
                    stream: message.u32(1),
                    bytes,
                })
            })
    }
}

impl Osf<BufReader<File>> {
    /// Opens a file; see [`Osf::new`].
    pub fn open(path: &Path) -> Result<Self, OsfError> {
        Self::new(BufReader::new(File::open(path)?))
    }
}

impl<R: Read + Seek> Osf<R> {
    /// Reads the header and the index. Where the index is missing or damaged, as in a file that was not finished, all
    /// chunks are read to make it anew, if they say what they have (version 2.2).
    ///
    /// # Errors
    /// Where it is no OSF file of version 2, its header is damaged, or it has no index and that cannot be made anew.
    pub fn new(mut file: R) -> Result<Self, OsfError> {
        let length = file.seek(SeekFrom::End(0))?;
        let header_block = block(&mut file, 0, length)?;
        let header = Table::root(&header_block, Some(b"OSF$")).ok_or(OsfError::NotOsf)?;
        let version = match header.u64(0) {
            old @ ..=VERSION_2_1 => (old / 10, old % 10),
            new => (new >> 48, new >> 32 & 0xFFFF),
        };
        if version.0 != MAJOR {
            return Err(OsfError::Version { major: version.0 });
        }
        let (base, end) = (header_block.len() as u64, header.u64(2));
        let index = if header.u8(1) == VALID {
            block(&mut file, end, length).and_then(|bytes| Index::read(&bytes, base, end))
        } else {
            Err(OsfError::Unfinished)
        };
        let (index, rebuilt) = match index {
            Ok(index) => (index, None),
            Err(error) => (rebuild(&mut file, base, length), Some(error)),
        };
        match rebuilt {
            Some(error) if index.sensors.is_empty() => Err(error),
            rebuilt => Ok(Self {
                file,
                version,
                index,
                rebuilt,
            }),
        }
    }

    /// The sensor of a stream of lidar scans.
    pub fn sensor(&self, stream: u32) -> Option<&Sensor> {
        let stream = self.index.streams.iter().find(|s| s.id == stream)?;
        self.index
            .sensors
            .iter()
            .find(|sensor| Some(sensor.id) == stream.sensor)
    }

    /// Reads one chunk.
    ///
    /// # Errors
    /// Where the file cannot be read there or the chunk is damaged; others may still be readable.
    pub fn read(&mut self, chunk: &Indexed) -> Result<Chunk, OsfError> {
        let chunk = Chunk(block(&mut self.file, chunk.offset, chunk.end)?);
        if chunk.table().is_none() {
            return Err(OsfError::Damaged { part: "chunk" });
        }
        Ok(chunk)
    }
}

/// The index that follows from the chunks up to the first one that is damaged.
fn rebuild<R: Read + Seek>(file: &mut R, base: u64, length: u64) -> Index {
    let (mut index, mut offset) = (Index::default(), base);
    while let Ok(bytes) = block(file, offset, length) {
        let chunk = Chunk(bytes);
        if index.add(offset, &chunk).is_none() {
            break;
        }
        offset += chunk.length();
    }
    index
}

/// The block at an offset, with its size and its CRC, which fits.
fn block<R: Read + Seek>(file: &mut R, offset: u64, end: u64) -> Result<Vec<u8>, OsfError> {
    let most = end.saturating_sub(offset).min(MOST_BLOCK);
    let too_long = |stated| OsfError::Size { offset, stated, most };
    if most < FRAME_BYTES {
        return Err(too_long(FRAME_BYTES));
    }
    file.seek(SeekFrom::Start(offset))?;
    let mut size = [0; SIZE_BYTES];
    file.read_exact(&mut size)?;
    let stated = u64::from(u32::from_le_bytes(size)) + FRAME_BYTES;
    if stated > most {
        return Err(if offset == 0 {
            OsfError::NotOsf
        } else {
            too_long(stated)
        });
    }
    let mut block = size.to_vec();
    file.take(stated - SIZE_BYTES as u64).read_to_end(&mut block)?;
    let Some((content, crc)) = block.split_last_chunk::<CRC_BYTES>() else {
        return Err(too_long(stated));
    };
    let (stored, computed) = (u32::from_le_bytes(*crc), crc32fast::hash(content));
    if block.len() as u64 != stated || stored != computed {
        return Err(OsfError::Crc {
            offset,
            stored,
            computed,
        });
    }
    Ok(block)
}
