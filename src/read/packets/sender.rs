//! Whose packet a datagram is that comes with nothing but its bytes.

use super::Maker;
use super::boundary::boundary;
use super::bytes::u16_at;

/// Whose packet this is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sender {
    /// Of a maker whose packets are decoded, and of a model that is known.
    Decoded(Maker),
    /// Ouster: the packets hold no angles, which are in the metadata of the sensor.
    Ouster,
}

impl Sender {
    /// By all that a packet shows.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        if let Some(maker) = Maker::of(bytes) {
            let is_known = boundary(maker).begins(bytes).is_some();
            return is_known.then_some(Self::Decoded(maker));
        }
        is_ouster(bytes).then_some(Self::Ouster)
    }
}

/// Whether these are columns of Ouster: 16 of the same length, whose numbers follow each other. Since firmware 2.0 a header of 32 bytes comes
/// before them, with the type of packet 1, and a footer of 32 bytes after them. Source: Ouster, Firmware User Manual, sensor data.
fn is_ouster(bytes: &[u8]) -> bool {
    let has_header = u16_at(bytes, 0) == Some(1);
    let forms = [(0, true), (32, has_header)];
    forms.into_iter().filter(|(_, may_be)| *may_be).any(|(header, _)| {
        let columns = bytes.len().saturating_sub(2 * header);
        let column = columns / 16;
        // A column has a time of eight bytes, its number, and at least sixteen pixels.
        let number = |index: usize| u16_at(bytes, header + column * index + 8);
        let follows = |index: usize| {
            let (this, next) = (number(index), number(index + 1));
            this.zip(next)
                .is_some_and(|(this, next)| next == this.wrapping_add(1) && next < 4096)
        };
        columns % 16 == 0 && column >= 64 && (0..15).all(follows)
    })
}
