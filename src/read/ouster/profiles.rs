//! The layouts of a pixel in lidar packets, and of the packets' headers: where each value's bits are.
//!
//! Source: ouster-sdk, `ouster_core/src/parsing.cpp`; Ouster's firmware user manual, chapter on lidar data packets.

/// A number of up to 64 bits, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bits {
    /// Its lowest bit, counted from the start of the pixel, the column or the packet.
    pub first: u16,
    /// How many bits it has; 0 where the layout lacks it.
    pub count: u16,
    /// How many lower bits of the value are not sent.
    pub dropped: u16,
}

impl Bits {
    /// The value; 0 where the layout lacks it, None past the end of the bytes.
    pub fn of(self, bytes: &[u8]) -> Option<u64> {
        let rest = bytes.get(usize::from(self.first / 8)..)?;
        let shift = self.first % 8;
        let word = if let Some(eight) = rest.first_chunk() {
            u64::from_le_bytes(*eight)
        } else if usize::from(shift + self.count) > 8 * rest.len() {
            return None;
        } else {
            rest.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte))
        };
        let mask = u64::MAX.checked_shr(64 - u32::from(self.count)).unwrap_or_default();
        Some((word >> shift & mask) << self.dropped)
    }
}

const fn at(first: u16, count: u16) -> Bits {
    Bits {
        first,
        count,
        dropped: 0,
    }
}

const NONE: Bits = at(0, 0);

/// One return of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Echo {
    /// Millimetres from the beam's origin; 0 where nothing came back.
    pub range: Bits,
    /// Photons of the signal; of layouts without it, the reflectivity.
    pub intensity: Bits,
}

/// The layout of a lidar packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Profile {
    /// Its name in the metadata.
    pub name: &'static str,
    /// Bytes of a pixel.
    pub pixel_bytes: usize,
    /// The strongest return, or the one that comes first by the sensor's setting.
    pub first: Echo,
    /// The other return of layouts that have two.
    pub second: Option<Echo>,
}

/// Range at full resolution, and a signal.
const fn fine(range: u16, signal: u16) -> Echo {
    Echo {
        range: at(range, 19),
        intensity: at(signal, 16),
    }
}

/// Range in steps of 8 mm, and a reflectivity right after it.
const fn coarse(range: u16) -> Echo {
    Echo {
        range: Bits {
            first: range,
            count: 15,
            dropped: 3,
        },
        intensity: at(range + 16, 8),
    }
}

const fn profile(name: &'static str, pixel_bytes: usize, first: Echo, second: Option<Echo>) -> Profile {
    Profile {
        name,
        pixel_bytes,
        first,
        second,
    }
}

/// The layout before packets had headers.
pub(super) const LEGACY: &str = "LEGACY";

/// All layouts of lidar packets.
pub(super) const PROFILES: [Profile; 13] = [
    profile(
        LEGACY,
        12,
        Echo {
            range: at(0, 20),
            intensity: at(48, 16),
        },
        None,
    ),
    profile("RNG19_RFL8_SIG16_NIR16", 12, fine(0, 48), None),
    profile("RNG19_RFL8_SIG16_NIR16_DUAL", 16, fine(0, 64), Some(fine(32, 80))),
    profile("RNG19_RFL8_SIG16_NIR16_ZONE16", 12, fine(0, 48), None),
    profile("RNG19_RFL8_SIG16_ZONE16_DUAL", 16, fine(0, 64), Some(fine(32, 80))),
    profile("RNG19_RFL8_SIG16_NIR16_RGB16", 16, fine(0, 32), None),
    profile("RNG19_RFL8_SIG16_NIR16_RGB16_DUAL", 20, fine(0, 64), Some(fine(32, 80))),
    profile("FIVE_WORD_PIXEL", 20, fine(0, 64), Some(fine(32, 80))),
    profile("RNG15_RFL8_NIR8", 4, coarse(0), None),
    profile("RNG15_RFL8_WIN8", 4, coarse(0), None),
    profile("RNG15_RFL8_NIR8_ZONE16", 8, coarse(0), None),
    profile("RNG15_RFL8_NIR8_DUAL", 8, coarse(0), Some(coarse(32))),
    profile("FUSA_RNG15_RFL8_NIR8_DUAL", 8, coarse(0), Some(coarse(32))),
];

/// Where a packet's header has its values, and a column its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Heads {
    pub(super) packet_type: Bits,
    pub(super) frame_id: Bits,
    pub(super) serial: Bits,
    /// Bytes of the packet's header; its footer has as many.
    pub(super) packet_bytes: usize,
    pub(super) column_bytes: usize,
    pub(super) footer_bytes: usize,
}

/// The header that all profiles but the oldest have.
pub(super) const STANDARD: Heads = Heads {
    packet_type: at(0, 16),
    frame_id: at(16, 16),
    serial: at(56, 40),
    packet_bytes: 32,
    column_bytes: 12,
    footer_bytes: 0,
};

/// The header of functional safety.
pub(super) const SAFETY: Heads = Heads {
    packet_type: at(0, 8),
    frame_id: at(32, 32),
    serial: at(88, 40),
    ..STANDARD
};

/// No header; the frame id is that of the first column.
pub(super) const HEADLESS: Heads = Heads {
    packet_type: NONE,
    frame_id: at(80, 16),
    serial: NONE,
    packet_bytes: 0,
    column_bytes: 16,
    footer_bytes: 4,
};

/// Of a column and of a measurement of the IMU: nanoseconds by the sensor's clock.
pub(super) const TIMESTAMP: Bits = at(0, 64);
/// Of a column and of a measurement of the IMU: its number within the turn.
pub(super) const MEASUREMENT_ID: Bits = at(64, 16);
/// Of a column and of a measurement of the IMU: its lowest bit is set where it is valid.
pub(super) const STATUS: Bits = at(80, 16);
/// Of the footer of a column of the oldest layout: all bits are set where it is valid.
pub(super) const FOOTER: Bits = at(0, 32);
