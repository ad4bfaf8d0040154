//! Why a packet is refused.

use std::fmt;

/// Why a packet is not decoded; `Display` gives one plain sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PacketError {
    /// The message has no packets.
    Empty,
    /// The number of bytes fits no data packet, or not the model that the packet names.
    Length {
        /// The bytes of the packet.
        bytes: usize,
        /// What the packet ought to be.
        of: &'static str,
    },
    /// The packet does not start as the maker's data packets do.
    NotData {
        /// The bytes of the packet.
        bytes: usize,
    },
    /// The model is none of those known here.
    Model {
        /// The bytes of the packet.
        bytes: usize,
        /// The model byte (Velodyne), or the two version bytes (Hesai).
        id: u16,
    },
    /// The return mode is none of those known here.
    Mode {
        /// The model of the packet.
        model: &'static str,
        /// The return mode byte.
        id: u8,
    },
    /// The channels follow a configuration of this one sensor, which the packet does not hold.
    Configured {
        /// The model of the packet.
        model: &'static str,
    },
    /// The angles of the beams are this one sensor's, and what tells them is missing.
    Untold {
        /// The model of the packet.
        model: &'static str,
        /// What tells them.
        place: &'static str,
    },
    /// A block does not begin with its mark.
    Mark {
        /// The model of the packet.
        model: &'static str,
        /// The number of the block, from 1.
        block: usize,
    },
    /// The azimuth of a block is 360° or more.
    Azimuth {
        /// The model of the packet.
        model: &'static str,
        /// The number of the block, from 1.
        block: usize,
        /// The azimuth as sent, hundredths of a degree.
        sent: u16,
    },
    /// The packet's time is no time.
    Time {
        /// The model of the packet.
        model: &'static str,
    },
    /// The packet is of another model than those before it in the message.
    Mixed {
        /// The model of the packet.
        model: &'static str,
        /// The model of those before.
        before: &'static str,
    },
    /// No metadata of the sensor (Ouster) is known.
    NoMetadata,
    /// The metadata, or a packet by it, is refused: why.
    Other(String),
}

impl fmt::Display for PacketError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Empty => write!(f, "a message without packets"),
            Self::Length { bytes, of } => write!(f, "a packet of {bytes} bytes, which is not the length of {of}"),
            Self::NotData { bytes } => write!(f, "a packet of {bytes} bytes that does not start as a data packet does"),
            Self::Model { bytes, id } => write!(f, "a packet of {bytes} bytes with the unknown model {id:#04x}"),
            Self::Mode { model, id } => write!(f, "a packet of a {model} with the unknown return mode {id:#04x}"),
            Self::Configured { model } => write!(
                f,
                "a packet of a {model} whose channels follow a configuration of its own"
            ),
            Self::Untold { model, place } => write!(f, "a packet of a {model} whose angles are in {place}"),
            Self::Mark { model, block } => write!(f, "a packet of a {model} whose block {block} lacks its mark"),
            Self::Azimuth { model, block, sent } => write!(
                f,
                "a packet of a {model} whose block {block} has an azimuth of {}.{:02} degrees",
                sent / 100,
                sent % 100
            ),
            Self::Time { model } => write!(f, "a packet of a {model} whose time is no time"),
            Self::Mixed { model, before } => write!(f, "a packet of a {model} among those of a {before}"),
            Self::NoMetadata => write!(
                f,
                "packets of an Ouster without its metadata: record its topic, or put its JSON file beside the recording"
            ),
            Self::Other(ref reason) => f.write_str(reason),
        }
    }
}

impl std::error::Error for PacketError {}
