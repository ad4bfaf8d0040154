//! Why metadata or a packet of an Ouster sensor is refused.

use std::fmt;

/// Why metadata or a packet is not decoded; `Display` gives one plain sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OusterError {
    /// No packets were given.
    Empty,
    /// The metadata is no JSON object.
    Json {
        /// The line at which it ceases to be one, from 1.
        line: usize,
        /// The column of that line.
        column: usize,
    },
    /// The metadata lacks something that has no default.
    Missing {
        /// Its key.
        key: &'static str,
    },
    /// A number of the metadata is outside of what a sensor can have.
    Range {
        /// Its key.
        key: &'static str,
        /// The number found, or how many of them.
        found: u64,
        /// The least that can be.
        least: u64,
        /// The most that can be.
        most: u64,
    },
    /// The packet layout is none of those known here.
    Profile {
        /// Its name in the metadata.
        name: String,
    },
    /// The packet has not the size that the metadata states.
    Length {
        /// The bytes of the packet.
        bytes: usize,
        /// The name of the layout.
        profile: &'static str,
        /// Columns of a packet, or measurements of the IMU.
        columns: usize,
        /// The bytes of a packet of this layout.
        expected: usize,
    },
    /// The packet says that it is of another kind.
    Type {
        /// The packet's type.
        found: u16,
        /// The type expected: 1 lidar, 2 IMU.
        expected: u16,
    },
    /// The packet is of another sensor than the metadata.
    Serial {
        /// The serial number in the packet.
        packet: u64,
        /// The serial number in the metadata.
        metadata: u64,
    },
    /// A valid column is outside of the turn.
    Column {
        /// Its measurement id.
        id: u16,
        /// The columns of a turn.
        columns: u16,
    },
}

impl fmt::Display for OusterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "no packets"),
            Self::Json { line, column } => {
                write!(
                    f,
                    "metadata that is no JSON object, seen at line {line}, column {column}"
                )
            }
            Self::Missing { key } => write!(f, "metadata without \"{key}\""),
            Self::Range {
                key,
                found,
                least,
                most,
            } => {
                write!(f, "metadata with {found} for \"{key}\", which can be {least} to {most}")
            }
            Self::Profile { name } => write!(f, "the unknown packet profile {name}"),
            Self::Length {
                bytes,
                profile,
                columns,
                expected,
            } => write!(
                f,
                "a packet of {bytes} bytes; the profile {profile} with {columns} columns has {expected}"
            ),
            Self::Type { found, expected } => write!(f, "a packet of type {found}, not {expected}"),
            Self::Serial { packet, metadata } => {
                write!(
                    f,
                    "a packet of the sensor {packet}; the metadata is of the sensor {metadata}"
                )
            }
            Self::Column { id, columns } => write!(f, "a packet with column {id} of a turn of {columns} columns"),
        }
    }
}

impl std::error::Error for OusterError {}
