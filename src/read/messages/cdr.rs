//! A cursor over a CDR message, little or big endian.
//!
//! Owns alignment and bounds. Written here, not taken from a crate, because its errors name the byte and its byte order
//! is decided at run time by the message. Source: OMG DDS-XTypes 1.3, 7.4.3 (XCDR version 1) and 7.6.3.1.2
//! (encapsulation).

use super::{DecodeError, MAX_NAME};

/// Reads primitives one after the other; each is aligned to its own size, counted from the end of the encapsulation.
#[derive(Clone, Debug)]
pub struct Cdr<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
}

/// Bytes of the encapsulation header in front of every message.
const ENCAPSULATION: usize = 4;

impl<'a> Cdr<'a> {
    /// Opens a message by its encapsulation header. Plain CDR of version 1 is read, which is what ROS 2 writes.
    pub fn new(message: &'a [u8]) -> Result<Self, DecodeError> {
        let Some(([k0, k1, _, _], body)) = message.split_first_chunk::<ENCAPSULATION>() else {
            return Err(DecodeError(format!(
                "{} bytes are too few for a CDR message",
                message.len()
            )));
        };
        match u16::from_be_bytes([*k0, *k1]) {
            kind @ (0 | 1) => Ok(Self {
                body,
                at: 0,
                little: kind == 1,
            }),
            kind => Err(DecodeError(format!(
                "encapsulation {kind:#06x} is not plain CDR (0x0000 or 0x0001)"
            ))),
        }
    }

    /// Position in the message, encapsulation included.
    pub fn position(&self) -> usize {
        ENCAPSULATION + self.at
    }

    /// `i32`.
    pub fn i32(&mut self) -> Result<i32, DecodeError> {
        let bytes = self.aligned::<4>()?;
        Ok(if self.little {
            i32::from_le_bytes(bytes)
        } else {
            i32::from_be_bytes(bytes)
        })
    }

    /// `u32`; also the length of a sequence.
    pub fn u32(&mut self) -> Result<u32, DecodeError> {
        let bytes = self.aligned::<4>()?;
        Ok(if self.little {
            u32::from_le_bytes(bytes)
        } else {
            u32::from_be_bytes(bytes)
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

    /// `N` numbers in a row.
    pub fn f64s<const N: usize>(&mut self) -> Result<[f64; N], DecodeError> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.f64()?;
        }
        Ok(values)
    }

    /// A string: its length with the closing NUL, then its bytes. Writers that leave out the NUL, or give an empty
    /// string the length 0, are understood too.
    pub fn str(&mut self) -> Result<&'a str, DecodeError> {
        let start = self.position();
        let len = self.u32()?;
        let bytes = self.take(usize::try_from(len).unwrap_or(usize::MAX))?;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        std::str::from_utf8(text).map_err(|_| DecodeError(format!("the string at byte {start} is not UTF-8")))
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

    fn aligned<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let start = self.at.next_multiple_of(N);
        match self.body.get(start..).and_then(|rest| rest.first_chunk::<N>()) {
            Some(bytes) => {
                self.at = start + N;
                Ok(*bytes)
            }
            None => Err(self.too_short(start - self.at + N)),
        }
    }

    fn take(&mut self, len: usize) -> Result<&'a [u8], DecodeError> {
        match self.body.get(self.at..).and_then(|rest| rest.get(..len)) {
            Some(bytes) => {
                self.at += len;
                Ok(bytes)
            }
            None => Err(self.too_short(len)),
        }
    }

    fn too_short(&self, wanted: usize) -> DecodeError {
        DecodeError(format!(
            "{wanted} bytes at byte {} run past the end of the message of {}",
            self.position(),
            ENCAPSULATION + self.body.len()
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
        let mut cdr = Cdr::new(little).unwrap();
        assert_eq!(cdr.i32(), Ok(7));
        assert_eq!(cdr.f64(), Ok(1.0));
        assert_eq!(cdr.u32(), Ok(9));
        assert_eq!(cdr.position(), little.len());
        assert!(cdr.u32().unwrap_err().0.contains("run past the end"));
    }

    #[test]
    fn both_byte_orders_are_read() {
        let big: &[u8] = &[0, 0, 0, 0, 0, 0, 0, 3, b'm', b'a', 0, 0xff, 0xff, 0xff, 0xff, 0xfe];
        let mut cdr = Cdr::new(big).unwrap();
        assert_eq!(cdr.str(), Ok("ma"));
        assert_eq!(cdr.i32(), Ok(-2));
    }

    #[test]
    fn strings_with_no_nul_and_empty_strings_are_understood() {
        let bytes: &[u8] = &[
            0, 1, 0, 0, 2, 0, 0, 0, b'm', b'a', 0xff, 0xff, 0, 0, 0, 0, 1, 0, 0, 0, 0,
        ];
        let mut cdr = Cdr::new(bytes).unwrap();
        assert_eq!(cdr.str(), Ok("ma"));
        assert_eq!(cdr.str(), Ok(""));
        assert_eq!(cdr.str(), Ok(""));
    }

    #[test]
    fn wrong_bytes_are_refused_with_their_place() {
        let of = |bytes: &[u8]| Cdr::new(bytes).and_then(|mut cdr| cdr.name().map(str::to_owned));
        assert!(of(&[0, 1]).unwrap_err().0.contains("2 bytes are too few"));
        assert!(of(&[0, 7, 0, 0]).unwrap_err().0.contains("0x0007"));
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
