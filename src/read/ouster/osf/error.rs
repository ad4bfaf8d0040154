//! Why an OSF file, a chunk of it or a message is refused.

use std::{fmt, io};

use crate::read::ouster::OusterError;

/// Why an OSF file, a chunk or a message is not read; `Display` gives one plain sentence.
#[derive(Debug)]
#[non_exhaustive]
pub enum OsfError {
    /// The file cannot be read.
    Io(io::Error),
    /// The file is no OSF file.
    NotOsf,
    /// The version of the format is not known.
    Version {
        /// The major version: 2 is known.
        major: u64,
    },
    /// The file was not finished, so that its index is missing.
    Unfinished,
    /// A block says that it is longer than what is there, or longer than is accepted.
    Size {
        /// Where it is, bytes from the start of the file.
        offset: u64,
        /// The bytes that it states.
        stated: u64,
        /// The most that it can have.
        most: u64,
    },
    /// A block's content does not fit its CRC.
    Crc {
        /// Where it is, bytes from the start of the file.
        offset: u64,
        /// The CRC stored.
        stored: u32,
        /// The CRC of the content.
        computed: u32,
    },
    /// A flatbuffer is damaged, or lacks what it must have.
    Damaged {
        /// Which part of the file it is.
        part: &'static str,
    },
    /// A list has not one entry for each column.
    Columns {
        /// Which list it is.
        list: &'static str,
        /// Its entries.
        found: usize,
        /// The columns of the sensor.
        columns: usize,
    },
    /// An image cannot be decoded.
    Image {
        /// Which field it is.
        field: &'static str,
        /// Why not.
        reason: String,
    },
    /// An image has not the size of the sensor's scans.
    Pixels {
        /// Which field it is.
        field: &'static str,
        /// Its columns and rows.
        found: (u32, u32),
        /// The sensor's columns and rows.
        expected: (u32, u32),
    },
    /// The metadata of a sensor cannot be read.
    Metadata(OusterError),
}

impl fmt::Display for OsfError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "the file cannot be read: {error}"),
            Self::NotOsf => write!(f, "no OSF file: its first block is not a header"),
            Self::Version { major } => write!(f, "an OSF file of version {major}; 2 is known"),
            Self::Unfinished => write!(f, "an OSF file that was not finished; its index is missing"),
            Self::Size { offset, stated, most } => {
                write!(f, "a block of {stated} bytes at byte {offset}, where {most} can be")
            }
            Self::Crc {
                offset,
                stored,
                computed,
            } => {
                write!(
                    f,
                    "a damaged block at byte {offset}: its CRC is {stored:#010x}, that of its content {computed:#010x}"
                )
            }
            Self::Damaged { part } => write!(f, "a damaged {part}"),
            Self::Columns { list, found, columns } => {
                write!(
                    f,
                    "a scan with {found} entries of {list}; the sensor has {columns} columns"
                )
            }
            Self::Image { field, reason } => write!(f, "an image of {field} that cannot be decoded: {reason}"),
            Self::Pixels { field, found, expected } => write!(
                f,
                "an image of {field} with {} x {} pixels; the sensor has {} x {}",
                found.0, found.1, expected.0, expected.1
            ),
            Self::Metadata(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for OsfError {}

impl From<io::Error> for OsfError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}
