//! Packets of one turn decoded into returns.
//!
//! Source: ouster-sdk, `ouster_core/src/lidar_frame.cpp` (`FrameBatcher`) and `xyzlut.cpp`.

use super::{Axes, Beams, Column, Echo, Layout, Metadata, OusterError};

/// One return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// Metres, in the frame asked for.
    pub x: f32,
    /// Metres, in the frame asked for.
    pub y: f32,
    /// Metres, upwards.
    pub z: f32,
    /// Photons of the signal; of layouts without it, the reflectivity.
    pub intensity: f32,
    /// The row of the pixel, from the highest beam down.
    pub ring: u16,
    /// The column of the pixel, which is its measurement id.
    pub column: u16,
    /// After [`Scan::start_ns`], nanoseconds (may be negative).
    pub offset_ns: i64,
}

/// What the packets of one turn say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scan {
    /// The model: "OS-1-128".
    pub model: String,
    /// When the first valid column was measured, nanoseconds by the sensor's clock; None without a valid column.
    pub start_ns: Option<i64>,
    /// When the host received the first packet that was decoded, nanoseconds.
    pub received_ns: Option<i64>,
    /// The returns in the order of the columns as they came, from the highest beam down. A second return comes right
    /// behind the first one of its pixel.
    pub returns: Vec<Return>,
    /// Packets that could not be decoded.
    pub refused: usize,
    /// Why the first of them could not.
    pub reason: Option<OusterError>,
}

/// The number of the turn to which a lidar packet belongs; None where it is no lidar packet of this sensor.
pub fn frame_id(metadata: &Metadata, bytes: &[u8]) -> Option<u32> {
    let layout = Layout::of(metadata).ok()?;
    Some(layout.read(metadata, bytes).ok()?.0.frame_id)
}

/// Decodes the lidar packets of one turn, each with when the host received it. Left out are ranges of 0, which is no
/// return, and second returns that repeat the first. A turn's packets are those of one [`frame_id`].
///
/// # Errors
/// Where the profile is not known, or no packet could be decoded: why the first could not.
pub fn decode<'p>(
    metadata: &Metadata,
    packets: impl Iterator<Item = (i64, &'p [u8])>,
    axes: Axes,
) -> Result<Scan, OusterError> {
    let layout = Layout::of(metadata)?;
    let mut build = Builder::new(metadata, axes);
    for (received_ns, bytes) in packets {
        match columns(metadata, &layout, bytes) {
            Ok(columns) => {
                build.scan.received_ns.get_or_insert(received_ns);
                for column in &columns {
                    build.column(&layout, column);
                }
            }
            Err(error) => {
                build.scan.refused += 1;
                build.scan.reason.get_or_insert(error);
            }
        }
    }
    let scan = build.scan;
    if scan.received_ns.is_none() {
        Err(scan.reason.unwrap_or(OusterError::Empty))
    } else {
        Ok(scan)
    }
}

/// The valid columns of a packet, all of them within the turn.
fn columns<'p>(metadata: &Metadata, layout: &Layout, bytes: &'p [u8]) -> Result<Vec<Column<'p>>, OusterError> {
    let columns: Vec<_> = layout.read(metadata, bytes)?.1.filter(Column::valid).collect();
    match columns
        .iter()
        .find(|column| column.measurement_id >= metadata.columns_per_frame)
    {
        Some(column) => Err(OusterError::Column {
            id: column.measurement_id,
            columns: metadata.columns_per_frame,
        }),
        None => Ok(columns),
    }
}

/// A scan in the making.
pub(crate) struct Builder {
    pub(crate) scan: Scan,
    beams: Beams,
}

impl Builder {
    pub(crate) fn new(metadata: &Metadata, axes: Axes) -> Self {
        Self {
            scan: Scan {
                model: metadata.model(),
                ..Scan::default()
            },
            beams: Beams::new(metadata, axes),
        }
    }

    /// Nanoseconds of a column after the first one.
    pub(crate) fn offset(&mut self, timestamp_ns: u64) -> i64 {
        let time = i64::try_from(timestamp_ns).unwrap_or(i64::MAX);
        time - *self.scan.start_ns.get_or_insert(time)
    }

    /// Appends the returns of a pixel: range in millimetres and intensity of each.
    pub(crate) fn pixel(
        &mut self,
        row: u16,
        column: u16,
        offset_ns: i64,
        first: (u32, u32),
        second: Option<(u32, u32)>,
    ) {
        let second = second.filter(|second| second.0 != first.0);
        for (range, intensity) in [Some(first), second]
            .into_iter()
            .flatten()
            .filter(|(range, _)| *range > 0)
        {
            let Some([x, y, z]) = self.beams.point(usize::from(row), usize::from(column), range) else {
                continue;
            };
            self.scan.returns.push(Return {
                x,
                y,
                z,
                intensity: intensity as f32,
                ring: row,
                column,
                offset_ns,
            });
        }
    }

    fn column(&mut self, layout: &Layout, column: &Column<'_>) {
        let offset_ns = self.offset(column.timestamp_ns);
        let echo = |echo: Echo, pixel| {
            let value = |bits: super::Bits| u32::try_from(bits.of(pixel)?).ok();
            Some((value(echo.range)?, value(echo.intensity)?))
        };
        for (row, pixel) in (0..).zip(column.pixels.chunks_exact(layout.profile.pixel_bytes)) {
            let Some(first) = echo(layout.profile.first, pixel) else {
                continue;
            };
            let second = layout.profile.second.and_then(|second| echo(second, pixel));
            self.pixel(row, column.measurement_id, offset_ns, first, second);
        }
    }
}
