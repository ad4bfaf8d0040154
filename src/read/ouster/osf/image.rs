//! Images of a scan's fields: PNG, and ZPNG, which is filtered pixels under zstd.
//!
//! Source: ouster-sdk, `ouster_osf/src/png_tools.cpp`, `png_lidarframe_encoder.cpp`, `zpng_lidarframe_encoder.cpp`, and
//! `thirdparty/zpng/zpng.cpp`; the PNG specification.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

use super::OsfError;

/// The first bytes of ZPNG.
const ZPNG_MAGIC: [u8; 2] = [0xF8, 0xFB];
/// Magic, columns, rows, channels of a pixel, bytes of a channel.
const ZPNG_HEAD: usize = 8;
/// Bytes that decoding a PNG may take besides the image.
const PNG_ROOM: usize = 1 << 20;

/// An image to decode: the name of its field, and the size (columns, rows) that bounds what is allocated.
#[derive(Clone, Copy)]
pub(super) struct Image {
    pub(super) field: &'static str,
    pub(super) size: (u16, u16),
}

impl Image {
    /// The values row by row, and whether each row has been moved by the sensor's pixel shift (which PNG has, ZPNG not).
    pub(super) fn decode(self, bytes: &[u8]) -> Result<(Vec<u32>, bool), OsfError> {
        match bytes.split_first_chunk::<ZPNG_HEAD>() {
            Some(([a, b, w0, w1, h0, h1, channels, depth], packed)) if [*a, *b] == ZPNG_MAGIC => {
                self.check(
                    u16::from_le_bytes([*w0, *w1]).into(),
                    u16::from_le_bytes([*h0, *h1]).into(),
                )?;
                Ok((self.zpng(usize::from(*channels) * usize::from(*depth), packed)?, false))
            }
            _ => Ok((self.png(bytes)?, true)),
        }
    }

    fn refuse(self, reason: &dyn ToString) -> OsfError {
        OsfError::Image {
            field: self.field,
            reason: reason.to_string(),
        }
    }

    fn check(self, columns: u32, rows: u32) -> Result<(), OsfError> {
        let expected = (self.size.0.into(), self.size.1.into());
        if (columns, rows) == expected {
            return Ok(());
        }
        Err(OsfError::Pixels {
            field: self.field,
            found: (columns, rows),
            expected,
        })
    }

    fn pixels(self) -> usize {
        usize::from(self.size.0) * usize::from(self.size.1)
    }

    fn png(self, bytes: &[u8]) -> Result<Vec<u32>, OsfError> {
        let limits = Limits {
            bytes: 8 * self.pixels() + PNG_ROOM,
        };
        let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
        decoder.set_transformations(Transformations::IDENTITY);
        let mut reader = decoder.read_info().map_err(|e| self.refuse(&e))?;
        let info = reader.info();
        self.check(info.width, info.height)?;
        let depth = info.bit_depth;
        let width = match (info.color_type, depth) {
            (ColorType::Grayscale, BitDepth::Eight) => 1,
            (ColorType::Grayscale, BitDepth::Sixteen) => 2,
            (ColorType::Rgb, BitDepth::Eight) => 3,
            (ColorType::Rgba, BitDepth::Eight) => 4,
            (ColorType::Rgba, BitDepth::Sixteen) => 8,
            (color, depth) => return Err(self.refuse(&format_args!("{color:?} with {depth:?} bits a sample"))),
        };
        let mut buffer = vec![0; self.pixels() * width];
        reader.next_frame(&mut buffer).map_err(|e| self.refuse(&e))?;
        if depth == BitDepth::Sixteen {
            buffer
                .as_chunks_mut::<2>()
                .0
                .iter_mut()
                .for_each(|sample| sample.reverse());
        }
        let little_endian = |pixel: &[u8]| pixel.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte));
        buffer
            .chunks_exact(width)
            .map(|pixel| self.value(little_endian(pixel)))
            .collect()
    }

    /// A value; no field that is read here has more than 32 bits.
    fn value(self, value: u64) -> Result<u32, OsfError> {
        u32::try_from(value).map_err(|_| self.refuse(&format_args!("a value of {value}")))
    }

    /// Pixels of `width` bytes. Each byte was sent less that of the pixel to its left; of pixels with three or four bytes,
    /// the first three are mixed and each byte has a plane of its own.
    fn zpng(self, width: usize, packed: &[u8]) -> Result<Vec<u32>, OsfError> {
        let count = self.pixels();
        if !(1..=8).contains(&width) {
            return Err(self.refuse(&format_args!("pixels of {width} bytes")));
        }
        let bytes = zstd::bulk::decompress(packed, count * width).map_err(|e| self.refuse(&e))?;
        if bytes.len() != count * width {
            return Err(self.refuse(&format_args!("{} bytes for {count} pixels of {width}", bytes.len())));
        }
        let byte = |at: usize| bytes.get(at).copied().unwrap_or_default();
        let mut pixel = [0_u8; 8];
        let values = (0..count).map(|i| {
            if i % usize::from(self.size.0) == 0 {
                pixel = [0; 8];
            }
            let mut step = [0; 8];
            if width == 3 || width == 4 {
                let [blue, green, red, alpha] = [0, 1, 2, 3].map(|plane| byte(plane * count + i));
                let green = green.wrapping_add(blue);
                step = [green.wrapping_sub(red), green, blue, alpha, 0, 0, 0, 0];
            } else {
                step.iter_mut()
                    .zip(i * width..(i + 1) * width)
                    .for_each(|(step, at)| *step = byte(at));
            }
            pixel
                .iter_mut()
                .zip(step)
                .for_each(|(byte, step)| *byte = byte.wrapping_add(step));
            self.value(u64::from_le_bytes(pixel))
        });
        values.collect()
    }
}
