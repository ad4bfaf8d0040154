//! LAS of the versions 1.0 to 1.4, and the header of LAZ, which is the same. Source: ASPRS, LAS Specification 1.4 R15.

use std::io::{Read, Seek};

use crate::read::messages::cloud::{Column, Datatype};
use crate::source::{Place, SourceId};
use crate::world::PointFile;
use crate::world::cloud::PointField;
use crate::world::point_file::{LasHeader, PointFormat};

use super::sample::{Tape, xyz};
use super::{Cloud, Fault, Record, crs, laz};

/// Records behind the header that are looked at.
const MAX_RECORDS: u64 = 1000;
/// Longest of them that is read, bytes: a text of a reference system has some thousands.
const MAX_RECORD: u64 = 1 << 20;
/// Smallest header, of version 1.0.
const HEADER: usize = 227;
/// The bytes of a point in each format.
const POINT_BYTES: [u16; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];

/// Little-endian numbers of the header.
struct Numbers<'h>(&'h [u8]);

impl Numbers<'_> {
    fn bytes<const N: usize>(&self, at: usize) -> Result<[u8; N], Fault> {
        let bytes = self.0.get(at..).and_then(|bytes| bytes.first_chunk());
        bytes.copied().ok_or_else(|| Fault::new("the file ends in its header"))
    }

    fn u16(&self, at: usize) -> Result<u16, Fault> {
        self.bytes(at).map(u16::from_le_bytes)
    }

    fn u32(&self, at: usize) -> Result<u32, Fault> {
        self.bytes(at).map(u32::from_le_bytes)
    }

    fn u64(&self, at: usize) -> Result<u64, Fault> {
        self.bytes(at).map(u64::from_le_bytes)
    }

    /// Three numbers, each this many bytes after the last.
    fn three(&self, at: usize, step: usize) -> Result<[f64; 3], Fault> {
        let number = |index: usize| self.bytes(at + index * step).map(f64::from_le_bytes);
        Ok([number(0)?, number(1)?, number(2)?])
    }
}

pub(super) fn read(tape: &mut Tape<impl Read + Seek>, head: &[u8], id: SourceId) -> Result<Cloud, Fault> {
    let numbers = Numbers(head);
    let [major, minor] = numbers.bytes(24)?;
    if major != 1 || minor > 4 {
        return Err(Fault::new(format!(
            "LAS {major}.{minor} is not known: 1.0 to 1.4 are read"
        )));
    }
    let is_1_4 = minor == 4;
    let header = LasHeader {
        version: [major, minor],
        scale: numbers.three(131, 8)?,
        offset: numbers.three(155, 8)?,
        most: numbers.three(179, 16)?,
        least: numbers.three(187, 16)?,
        has_adjusted_time: numbers.u16(6)? & 1 == 1,
        created: [numbers.u16(92)?, numbers.u16(90)?],
    };
    let (header_size, start) = (u64::from(numbers.u16(94)?), u64::from(numbers.u32(96)?));
    let [format] = numbers.bytes(104)?;
    let (point_bytes, is_packed) = (numbers.u16(105)?, format & 0xC0 != 0);
    let format = format & 0x3F;
    let least = POINT_BYTES.get(usize::from(format)).copied();
    let least = least.ok_or_else(|| Fault::new(format!("the point format {format} is not known: 0 to 10 are read")))?;
    if point_bytes < least || header_size < HEADER as u64 || start < header_size {
        let message = format!(
            "the header contradicts itself: {header_size} bytes, points of format {format} with {point_bytes} bytes from byte {start} on"
        );
        return Err(Fault::new(message));
    }
    let mut stated = u64::from(numbers.u32(107)?);
    let mut records = records(tape, header_size, u64::from(numbers.u32(100)?), 54)?;
    if is_1_4 {
        stated = stated.max(numbers.u64(247)?);
        records.extend(self::records(
            tape,
            numbers.u64(235)?,
            u64::from(numbers.u32(243)?),
            60,
        )?);
    }
    let (mut points, mut faults) = (Vec::new(), Vec::new());
    let columns = [0, 4, 8].map(|at| Column::new(at, Datatype::I32, false));
    let [scale, offset] = [header.scale, header.offset];
    let mut take = |point: &[u8]| {
        let mut axes = xyz(columns, point).into_iter().zip(scale.into_iter().zip(offset));
        points.push([(); 3].map(|()| {
            let (whole, (scale, offset)) = axes.next().unwrap_or_default();
            whole * scale + offset
        }));
    };
    if is_packed {
        let parameters = records
            .iter()
            .find(|one| one.user == "laszip encoded" && one.id == 22204);
        let parameters =
            parameters.ok_or_else(|| Fault::new("the record that describes the compression is missing"))?;
        if let Err(fault) = laz::read(tape, start, (stated, point_bytes), &parameters.data, &mut take) {
            faults.push(fault);
        }
    } else {
        let held = tape.size.saturating_sub(start) / u64::from(point_bytes);
        if held < stated {
            let message = format!("the header states {stated} points, but the file has {held}");
            faults.push(Fault::new(message));
        }
        tape.records(start, (u64::from(point_bytes), stated.min(held)), take)?;
    }
    let field = |name: &str| PointField {
        name: name.to_owned(),
        datatype: "int32".to_owned(),
        count: 1,
    };
    let file = PointFile {
        place: Place::whole(id),
        format: PointFormat::Las,
        stated,
        read: 0,
        fields: ["x", "y", "z"].map(field).to_vec(),
        coordinates_at: None,
        seen: None,
        viewpoint: None,
        crs: crs::stated(&records),
        las: Some(header),
    };
    Ok(Cloud { file, points, faults })
}

/// The records from this byte on, whose heads have this size: 54, or 60 for those behind the points.
fn records(tape: &mut Tape<impl Read + Seek>, mut at: u64, count: u64, head_bytes: u16) -> Result<Vec<Record>, Fault> {
    let mut records = Vec::new();
    for _ in 0..count.min(MAX_RECORDS) {
        let head = tape.at(at, usize::from(head_bytes))?;
        if head.len() < usize::from(head_bytes) {
            break;
        }
        let numbers = Numbers(&head);
        let length = if head_bytes == 54 {
            u64::from(numbers.u16(20)?)
        } else {
            numbers.u64(20)?
        };
        let user = numbers.bytes::<16>(2)?;
        let user = String::from_utf8_lossy(&user).trim_end_matches('\0').to_owned();
        let is_wanted = length <= MAX_RECORD && ["LASF_Projection", "laszip encoded"].contains(&user.as_str());
        at = at.saturating_add(u64::from(head_bytes));
        if is_wanted {
            records.push(Record {
                id: numbers.u16(18)?,
                data: tape.at(at, usize::try_from(length).unwrap_or_default())?,
                user,
            });
        }
        at = at.saturating_add(length);
    }
    Ok(records)
}
