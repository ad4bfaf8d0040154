//! A cursor over the bytes of a message: CDR as ROS 2 writes it, and the packed form of ROS 1.
//!
//! Owns alignment, byte order and bounds. Written here, not taken from a crate, because its errors name the byte, and
//! the byte order is decided at run time by the message. Sources: OMG DDS-XTypes 1.3, 7.4.3 (encoding versions 1 and 2)
//! and 7.6.3.1.2 (encapsulation); ROS 1: `wiki.ros.org/roscpp/Overview/MessagesSerializationAndAdaptingTypes`.

use super::{DecodeError, MAX_NAME};

/// How the messages of a channel are laid out as bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// CDR with its encapsulation in front: the message states byte order and version.
    Cdr,
    /// ROS 1: little endian, no padding, no encapsulation.
    Ros1,
}

impl Wire {
    /// The wire of a message encoding by its name in recordings.
    pub fn named(encoding: &str) -> Option<Self> {
        match encoding {
            "cdr" => Some(Self::Cdr),
            "ros1" => Some(Self::Ros1),
            _ => None,
        }
    }

    /// Opens a message.
    pub fn open(self, message: &[u8]) -> Result<Cursor<'_>, DecodeError> {
        match self {
            Self::Cdr => Cursor::cdr(message),
            Self::Ros1 => Ok(Cursor::ros1(message)),
        }
    }
}

/// Reads values one after the other; each is aligned to its own size, but never to more than the encoding aligns to.
#[derive(Clone, Debug)]
pub struct Cursor<'a> {
    message: &'a [u8],
    at: usize,
    /// Where alignment is counted from: after the encapsulation.
    origin: usize,
    /// What the encoding aligns to at most: 8 in CDR, 4 in CDR of version 2, 1 in ROS 1.
    largest: usize,
    little: bool,
    wire: Wire,
}

/// Bytes of the encapsulation header in front of every CDR message.
const ENCAPSULATION: usize = 4;

impl<'a> Cursor<'a> {
    /// Opens a CDR message by its encapsulation header: plain CDR of version 1, which is what ROS 2 writes, or of
    /// version 2. The forms for extensible types (delimited, parameter list) are refused by name.
    pub fn cdr(message: &'a [u8]) -> Result<Self, DecodeError> {
        let Some([k0, k1, _, _]) = message.first_chunk::<ENCAPSULATION>() else {
            return Err(DecodeError(format!(
                "{} bytes are too few for a CDR message",
                message.len()
            )));
        };
        let kind = u16::from_be_bytes([*k0, *k1]);
        let largest = match kind {
            0 | 1 => 8,
            6 | 7 => 4,
            _ => {
                let word = match kind {
                    2 | 3 | 0xa | 0xb => "a parameter list, which is not supported",
                    8 | 9 => "delimited CDR, which is not supported",
                    _ => "not plain CDR (0x0000, 0x0001, 0x0006 or 0x0007)",
                };
                return Err(DecodeError(format!("encapsulation {kind:#06x} is {word}")));
            }
        };
        Ok(Self {
            message,
            at: ENCAPSULATION,
            origin: ENCAPSULATION,
            largest,
            little: kind & 1 == 1,
            wire: Wire::Cdr,
        })
    }

    /// Opens a message of ROS 1.
    pub fn ros1(message: &'a [u8]) -> Self {
        Self {
            message,
            at: 0,
            origin: 0,
            largest: 1,
            little: true,
            wire: Wire::Ros1,
        }
    }

    /// Which wire this is.
    pub fn wire(&self) -> Wire {
        self.wire
    }

    /// Position in the message, encapsulation included.
    pub fn position(&self) -> usize {
        self.at
    }

    /// Length of the message, encapsulation included.
    pub fn message_len(&self) -> usize {
        self.message.len()
    }

    /// `i8`.
    pub fn i8(&mut self) -> Result<i8, DecodeError> {
        let [byte] = self.aligned::<1>()?;
        Ok(byte.cast_signed())
    }

    /// `u16`.
    pub fn u16(&mut self) -> Result<u16, DecodeError> {
        let bytes = self.aligned::<2>()?;
        Ok(if self.little {
            u16::from_le_bytes(bytes)
        } else {
            u16::from_be_bytes(bytes)
        })
    }

    /// `i32`.
    pub fn i32(&mut self) -> Result<i32, DecodeError> {
        Ok(self.u32()?.cast_signed())
    }

    /// `u32`; also the length of a sequence of numbers.
    pub fn u32(&mut self) -> Result<u32, DecodeError> {
        let bytes = self.aligned::<4>()?;
        Ok(if self.little {
            u32::from_le_bytes(bytes)
        } else {
            u32::from_be_bytes(bytes)
        })
    }

    /// `u64`.
    pub fn u64(&mut self) -> Result<u64, DecodeError> {
        let bytes = self.aligned::<8>()?;
        Ok(if self.little {
            u64::from_le_bytes(bytes)
        } else {
            u64::from_be_bytes(bytes)
        })
    }

    /// `f64`.
    pub fn f64(&mut self) -> Result<f64, DecodeError> {
        let bytes = self.aligned::<8>()?;
        Ok(if self.little {
            f64::from_le_bytes(bytes)
        } else {
            f64::from_be_bytes(bytes)
        })
    }

    /// `f32`.
    pub fn f32(&mut self) -> Result<f32, DecodeError> {
        Ok(f32::from_bits(self.u32()?))
    }

    /// `N` numbers in a row.
    pub fn f64s<const N: usize>(&mut self) -> Result<[f64; N], DecodeError> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.f64()?;
        }
        Ok(values)
    }

    /// A time or duration in nanoseconds: seconds signed in ROS 2 and unsigned in ROS 1, then nanoseconds unsigned.
    pub fn time(&mut self) -> Result<i64, DecodeError> {
        let seconds = match self.wire {
            Wire::Cdr => i64::from(self.i32()?),
            Wire::Ros1 => i64::from(self.u32()?),
        };
        Ok(seconds * 1_000_000_000 + i64::from(self.u32()?))
    }

    /// The length of a sequence of anything but numbers; CDR of version 2 puts the size in bytes before it.
    pub fn sequence(&mut self) -> Result<u32, DecodeError> {
        self.delimiter()?;
        self.u32()
    }

    /// The size in bytes that CDR of version 2 puts before a collection of anything but numbers (DDS-XTypes 7.4.3.5.3).
    pub fn delimiter(&mut self) -> Result<(), DecodeError> {
        if self.wire == Wire::Cdr && self.largest == 4 {
            self.u32()?;
        }
        Ok(())
    }

    /// A string: its length, then its bytes. In CDR the length counts a closing NUL; writers that omit it, or give
    /// an empty string the length 0, are supported too.
    pub fn str(&mut self) -> Result<&'a str, DecodeError> {
        self.str_at().map(|(_, text)| text)
    }

    /// A string with the position of its first byte.
    pub fn str_at(&mut self) -> Result<(usize, &'a str), DecodeError> {
        let start = self.position();
        let bytes = self.bytes()?;
        let first = self.position() - bytes.len();
        let text = match self.wire {
            Wire::Cdr => bytes.strip_suffix(&[0]).unwrap_or(bytes),
            Wire::Ros1 => bytes,
        };
        let text = std::str::from_utf8(text);
        let text = text.map_err(|_| DecodeError(format!("the string at byte {start} is not UTF-8")))?;
        Ok((first, text))
    }

    /// A frame name: a string of at most [`MAX_NAME`] bytes.
    pub fn name(&mut self) -> Result<&'a str, DecodeError> {
        let start = self.position();
        let name = self.str()?;
        if name.len() > MAX_NAME {
            return Err(DecodeError(format!(
                "the frame name at byte {start} has {} bytes",
                name.len()
            )));
        }
        Ok(name)
    }

    /// Skips a string with any bytes.
    pub fn skip_str(&mut self) -> Result<(), DecodeError> {
        self.bytes().map(drop)
    }

    /// Skips `count` numbers of `size` bytes at once; no numbers need no padding.
    pub fn skip_numbers(&mut self, size: usize, count: usize) -> Result<(), DecodeError> {
        if count == 0 {
            return Ok(());
        }
        let start = self.start_of(size);
        let wanted = size.saturating_mul(count);
        match start.checked_add(wanted).filter(|end| *end <= self.message.len()) {
            Some(end) => {
                self.at = end;
                Ok(())
            }
            None => Err(self.too_short((start - self.at).saturating_add(wanted))),
        }
    }

    /// All remaining bytes, from the next multiple of `alignment` on, as the encoding aligns.
    pub fn rest(&self, alignment: usize) -> &'a [u8] {
        self.message.get(self.start_of(alignment)..).unwrap_or_default()
    }

    /// Whether the least significant byte of a number comes first.
    pub fn is_little(&self) -> bool {
        self.little
    }

    /// A sequence of bytes: its length, then the bytes.
    pub fn bytes(&mut self) -> Result<&'a [u8], DecodeError> {
        let len = usize::try_from(self.u32()?).unwrap_or(usize::MAX);
        self.take(len)
    }

    /// So many bytes: an array of bytes has no length before it.
    pub fn take(&mut self, len: usize) -> Result<&'a [u8], DecodeError> {
        match self.message.get(self.at..).and_then(|rest| rest.get(..len)) {
            Some(bytes) => {
                self.at += len;
                Ok(bytes)
            }
            None => Err(self.too_short(len)),
        }
    }

    /// Where the next value of `size` bytes begins.
    fn start_of(&self, size: usize) -> usize {
        let alignment = size.min(self.largest).max(1);
        self.origin + (self.at - self.origin).next_multiple_of(alignment)
    }

    fn aligned<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let start = self.start_of(N);
        match self.message.get(start..).and_then(|rest| rest.first_chunk::<N>()) {
            Some(bytes) => {
                self.at = start + N;
                Ok(*bytes)
            }
            None => Err(self.too_short(start - self.at + N)),
        }
    }

    fn too_short(&self, wanted: usize) -> DecodeError {
        DecodeError(format!(
            "{wanted} bytes at byte {} run past the end of the message of {}",
            self.position(),
            self.message.len()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_to_their_size_behind_the_encapsulation() {
        // i32 7, padding, f64 1.0, then a u32 without padding.
        let little: &[u8] = &[
            0, 1, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 9, 0, 0, 0,
        ];
        let mut cdr = Cursor::cdr(little).unwrap();
        assert_eq!(cdr.i32(), Ok(7));
        assert_eq!(cdr.f64(), Ok(1.0));
        assert_eq!(cdr.u32(), Ok(9));
        assert_eq!(cdr.position(), little.len());
        assert!(cdr.u32().unwrap_err().0.contains("run past the end"));
    }

    #[test]
    fn version_2_aligns_to_four_bytes_and_puts_sizes_before_sequences() {
        // i32 7, f64 1.0 without padding, then a sequence of one string: its size, its length, "ma".
        let message: &[u8] = &[
            0, 7, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 11, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, b'm', b'a', 0,
        ];
        let mut cdr = Cursor::cdr(message).unwrap();
        assert_eq!(cdr.i32(), Ok(7));
        assert_eq!(cdr.f64(), Ok(1.0));
        assert_eq!(cdr.sequence(), Ok(1));
        assert_eq!(cdr.str(), Ok("ma"));
    }

    #[test]
    fn both_byte_orders_are_read() {
        let big: &[u8] = &[0, 0, 0, 0, 0, 0, 0, 3, b'm', b'a', 0, 0xff, 0xff, 0xff, 0xff, 0xfe];
        let mut cdr = Cursor::cdr(big).unwrap();
        assert_eq!(cdr.str(), Ok("ma"));
        assert_eq!(cdr.i32(), Ok(-2));
    }

    #[test]
    fn strings_with_no_nul_and_empty_strings_are_understood() {
        let bytes: &[u8] = &[
            0, 1, 0, 0, 2, 0, 0, 0, b'm', b'a', 0xff, 0xff, 0, 0, 0, 0, 1, 0, 0, 0, 0,
        ];
        let mut cdr = Cursor::cdr(bytes).unwrap();
        assert_eq!(cdr.str(), Ok("ma"));
        assert_eq!(cdr.str(), Ok(""));
        assert_eq!(cdr.str(), Ok(""));
    }

    #[test]
    fn ros_1_is_packed_and_its_seconds_are_unsigned() {
        // u8 1, f64 1.0, string "ma", time 4294967295.000000007.
        let message: &[u8] = &[
            1, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 2, 0, 0, 0, b'm', b'a', 0xff, 0xff, 0xff, 0xff, 7, 0, 0, 0,
        ];
        let mut ros1 = Cursor::ros1(message);
        assert_eq!(ros1.i8(), Ok(1));
        assert_eq!(ros1.f64(), Ok(1.0));
        assert_eq!(ros1.str(), Ok("ma"));
        assert_eq!(ros1.time(), Ok(4_294_967_295_000_000_007));
        assert_eq!(
            ros1.u16().unwrap_err().0,
            "2 bytes at byte 23 run past the end of the message of 23"
        );
    }

    #[test]
    fn numbers_are_passed_over_at_once_with_their_padding() {
        let mut message = vec![0, 1, 0, 0, 1];
        message.resize(4 + 8 + 16, 0);
        let mut cdr = Cursor::cdr(&message).unwrap();
        cdr.skip_numbers(1, 1).unwrap();
        cdr.skip_numbers(8, 0).unwrap();
        assert_eq!(cdr.position(), 5);
        cdr.skip_numbers(8, 2).unwrap();
        assert_eq!(cdr.position(), message.len());
        assert!(
            cdr.skip_numbers(8, usize::MAX)
                .unwrap_err()
                .0
                .contains("run past the end")
        );
    }

    #[test]
    fn wrong_bytes_are_refused_with_their_place() {
        let of = |bytes: &[u8]| Cursor::cdr(bytes).and_then(|mut cdr| cdr.name().map(str::to_owned));
        assert!(of(&[0, 1]).unwrap_err().0.contains("2 bytes are too few"));
        assert!(of(&[0, 12, 0, 0]).unwrap_err().0.contains("0x000c is not plain CDR"));
        assert!(of(&[0, 9, 0, 0]).unwrap_err().0.contains("0x0009 is delimited CDR"));
        assert!(of(&[0, 3, 0, 0]).unwrap_err().0.contains("0x0003 is a parameter list"));
        let lying = of(&[0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, b'x']).unwrap_err();
        assert_eq!(
            lying.0,
            "4294967295 bytes at byte 8 run past the end of the message of 9"
        );
        assert!(of(&[0, 1, 0, 0, 1, 0, 0, 0, 0xc3]).unwrap_err().0.contains("not UTF-8"));
        let mut long = vec![0, 1, 0, 0, 0xd0, 7, 0, 0];
        long.resize(8 + 2000, b'x');
        assert!(of(&long).unwrap_err().0.contains("has 2000 bytes"));
    }
}
