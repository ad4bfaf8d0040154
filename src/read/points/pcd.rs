//! PCD, the format of the Point Cloud Library, of the versions 0.5 to 0.7: a header of lines, then points as text, as bytes, or compressed by
//! LZF field by field. Source: pointclouds.org, "The PCD (Point Cloud Data) file format"; `pcl/io/src/pcd_io.cpp` for what may be missing.

use std::collections::BTreeMap;
use std::io::{Read, Seek};

use crate::read::messages::cloud::{Column, Datatype};
use crate::source::{Place, Source, SourceId, SourceValue, Span};
use crate::world::PointFile;
use crate::world::cloud::PointField;
use crate::world::point_file::{PointFormat, Viewpoint};

use super::sample::{MAX_POINTS, Tape, spread, xyz, xyz_of_line};
use super::{Cloud, Fault, MAX_STRIDE, header_text, lines, lzf};

/// Bytes that a compressed cloud may unpack to.
const MAX_UNPACKED: u64 = 256 << 20;

/// A line of the header, in words behind its key.
type Entry<'t> = (Vec<&'t str>, Span);

/// The columns of a point.
struct Fields {
    named: Vec<PointField>,
    /// By field: its first byte, the bytes of one number, and the type if it is known.
    places: Vec<(u64, u64, Option<Datatype>)>,
    stride: u64,
    /// Numbers x, y and z in `named`.
    xyz: [usize; 3],
}

pub(super) fn read(tape: &mut Tape<impl Read + Seek>, head: &[u8], source: &mut Source) -> Result<Cloud, Fault> {
    let (text, start) = header_text(head, |line| line.starts_with("DATA"))?;
    source.text.clone_from(&text);
    let entries: BTreeMap<&str, Entry<'_>> = lines(&text)
        .filter_map(|(line, span)| {
            let mut words = line.split_ascii_whitespace();
            let key = words.next().filter(|key| !key.starts_with('#'))?;
            Some((key, (words.collect(), span)))
        })
        .collect();
    let fields = Fields::of(&entries)?;
    let mut faults = Vec::new();
    let stated = count(&entries, &mut faults)?;
    let names = entries.get("FIELDS").or(entries.get("COLUMNS"));
    let mut file = PointFile {
        place: Place::whole(source.id),
        format: PointFormat::Pcd,
        stated,
        read: 0,
        coordinates_at: names.map(|(_, span)| Place::text(source.id, *span)),
        seen: None,
        viewpoint: entries
            .get("VIEWPOINT")
            .map(|entry| viewpoint(entry, source.id))
            .transpose()?,
        las: None,
        crs: None,
        fields: Vec::new(),
    };
    let (data, span) = entries
        .get("DATA")
        .map_or((None, Span::default()), |(words, span)| (words.first().copied(), *span));
    let mut points = Vec::new();
    match data {
        Some("ascii") => {
            let numbers: Vec<usize> = fields
                .xyz
                .iter()
                .map(|field| fields.named.iter().take(*field).map(|one| one.count as usize).sum())
                .collect();
            let [x, y, z] = *numbers else {
                return Err(Fault::new("x, y and z are missing"));
            };
            let is_all = tape.lines(start, |line| {
                let line = line.trim();
                if !line.is_empty() && points.len() as u64 <= stated {
                    points.push(xyz_of_line([x, y, z], line));
                }
            })?;
            if is_all && points.len() as u64 != stated {
                faults.push(cut(stated, points.len() as u64));
            }
        }
        Some("binary") => {
            let held = tape.size.saturating_sub(start) / fields.stride.max(1);
            if held < stated {
                faults.push(cut(stated, held));
            }
            let columns = fields.columns(|(at, ..)| at)?;
            tape.records(start, (fields.stride, stated.min(held)), |point| {
                points.push(xyz(columns, point));
            })?;
        }
        Some("binary_compressed") => points = compressed(tape, start, &fields, stated)?,
        _ => {
            let message = "`DATA` must be ascii, binary or binary_compressed";
            return Err(Fault::at(span, message));
        }
    }
    file.fields = fields.named;
    Ok(Cloud { file, points, faults })
}

fn cut(stated: u64, held: u64) -> Fault {
    Fault::new(format!("the header states {stated} points, but the file has {held}"))
}

impl Fields {
    fn of(entries: &BTreeMap<&str, Entry<'_>>) -> Result<Self, Fault> {
        let Some((names, span)) = entries.get("FIELDS").or(entries.get("COLUMNS")) else {
            return Err(Fault::new("the header has no line `FIELDS`"));
        };
        // What a line states for a field; PCL takes the default where the line is missing.
        let word = |key: &str, index: usize, usual: &'static str| match entries.get(key) {
            None => Ok(usual),
            Some((words, span)) => words.get(index).copied().ok_or_else(|| {
                let message = format!("`{key}` has {} entries for {} fields", words.len(), names.len());
                Fault::at(*span, message)
            }),
        };
        let number = |key: &str, index: usize, usual: &'static str| {
            let text = word(key, index, usual)?;
            let at = entries.get(key).map_or(*span, |(_, span)| *span);
            text.parse::<u32>()
                .map_err(|_| Fault::at(at, format!("`{text}` in `{key}` is not a whole number")))
        };
        let (mut fields, mut places, mut stride) = (Vec::new(), Vec::new(), 0);
        for (index, name) in names.iter().enumerate() {
            let (size, count) = (number("SIZE", index, "4")?, number("COUNT", index, "1")?);
            let kind = word("TYPE", index, "F")?;
            let datatype = datatype(kind, size);
            places.push((stride, u64::from(size), datatype));
            stride += u64::from(size) * u64::from(count);
            fields.push(PointField {
                name: (*name).to_owned(),
                datatype: datatype.map_or_else(|| format!("{kind}{size}"), |one| one.word().to_owned()),
                count,
            });
        }
        if stride > MAX_STRIDE {
            return Err(Fault::at(
                *span,
                format!("a point has {stride} bytes, more than {MAX_STRIDE}"),
            ));
        }
        let place = |name: &str| {
            let found = names.iter().position(|one| *one == name);
            found.ok_or_else(|| Fault::at(*span, format!("`FIELDS` has no `{name}`")))
        };
        Ok(Self {
            xyz: [place("x")?, place("y")?, place("z")?],
            named: fields,
            places,
            stride,
        })
    }

    /// The columns of x, y and z, from this byte on.
    fn columns(&self, at: impl Fn((u64, u64, Option<Datatype>)) -> u64) -> Result<[Column; 3], Fault> {
        let column = |field: usize| {
            let place = *self.places.get(field)?;
            Some(Column::new(usize::try_from(at(place)).ok()?, place.2?, false))
        };
        let [x, y, z] = self.xyz.map(column);
        let (Some(x), Some(y), Some(z)) = (x, y, z) else {
            return Err(Fault::new("x, y and z have a type that PCD does not have"));
        };
        Ok([x, y, z])
    }
}

fn datatype(kind: &str, size: u32) -> Option<Datatype> {
    Some(match (kind, size) {
        ("F", 4) => Datatype::F32,
        ("F", 8) => Datatype::F64,
        ("I", 1) => Datatype::I8,
        ("I", 2) => Datatype::I16,
        ("I", 4) => Datatype::I32,
        ("U", 1) => Datatype::U8,
        ("U", 2) => Datatype::U16,
        ("U", 4) => Datatype::U32,
        _ => return None,
    })
}

/// The number of points: `POINTS`, or the width times the height. PCL refuses files in which these differ.
fn count(entries: &BTreeMap<&str, Entry<'_>>, faults: &mut Vec<Fault>) -> Result<u64, Fault> {
    let number = |key: &str| -> Result<Option<(u64, Span)>, Fault> {
        let Some((words, span)) = entries.get(key) else {
            return Ok(None);
        };
        let text = words.first().copied().unwrap_or_default();
        let whole = text.parse::<u64>().ok().filter(|whole| *whole < 1 << 48);
        let whole = whole.ok_or_else(|| Fault::at(*span, format!("`{key} {text}` is not a number of points")))?;
        Ok(Some((whole, *span)))
    };
    let (points, width, height) = (number("POINTS")?, number("WIDTH")?, number("HEIGHT")?);
    let area = width.map(|(width, _)| width.saturating_mul(height.map_or(1, |(height, _)| height)));
    match (points, area) {
        (Some((points, span)), Some(area)) if points != area => {
            let message = format!("`POINTS` is {points}, but width times height is {area}: PCL refuses the file");
            faults.push(Fault::at(span, message));
            Ok(points.min(area))
        }
        (Some((points, _)), _) => Ok(points),
        (None, Some(area)) => Ok(area),
        (None, None) => Err(Fault::new("the header has neither `POINTS` nor `WIDTH`")),
    }
}

fn viewpoint((words, span): &Entry<'_>, id: SourceId) -> Result<SourceValue<Viewpoint>, Fault> {
    let numbers: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let [x, y, z, qw, qx, qy, qz] = *numbers else {
        let message = "`VIEWPOINT` must have seven numbers: tx ty tz qw qx qy qz";
        return Err(Fault::at(*span, message));
    };
    let value = Viewpoint {
        translation: [x, y, z],
        wxyz: [qw, qx, qy, qz],
    };
    Ok(SourceValue::new(value, Place::text(id, *span)))
}

/// Points of a compressed file: all values of the first field, then all of the second.
fn compressed(
    tape: &mut Tape<impl Read + Seek>,
    start: u64,
    fields: &Fields,
    count: u64,
) -> Result<Vec<[f64; 3]>, Fault> {
    let sizes = tape.at(start, 8)?;
    let size = |at: usize| {
        let bytes = sizes.get(at..).and_then(|bytes| bytes.first_chunk());
        bytes.map(|bytes| u64::from(u32::from_le_bytes(*bytes)))
    };
    let (Some(packed), Some(unpacked)) = (size(0), size(4)) else {
        return Err(Fault::new("the file ends before its points"));
    };
    // The block of a field begins where the blocks of those before it end.
    let block = |(at, ..): (u64, u64, Option<Datatype>)| at.saturating_mul(count);
    let end = |field: &usize| {
        let place = fields.places.get(*field)?;
        Some(block(*place).saturating_add(place.1.saturating_mul(count)))
    };
    let needed = fields.xyz.iter().filter_map(end).max().unwrap_or_default();
    if needed > unpacked {
        let message = format!("the header states {count} points, but the compressed data have {unpacked} bytes");
        return Err(Fault::new(message));
    }
    if needed > MAX_UNPACKED {
        let limit = MAX_UNPACKED >> 20;
        let message = format!(
            "the coordinates unpack to {} MB; up to {limit} MB are read",
            needed >> 20
        );
        return Err(Fault::new(message));
    }
    let size = usize::try_from(packed).unwrap_or(usize::MAX);
    let packed = tape.at(start + 8, size)?;
    let data = lzf::unpack(&packed, usize::try_from(needed).unwrap_or_default());
    let data = data.filter(|_| packed.len() == size);
    let data = data.ok_or_else(|| Fault::new("the compressed points are damaged or cut off"))?;
    let columns = fields.columns(block)?;
    let size = |index: usize| {
        fields
            .xyz
            .get(index)
            .and_then(|field| fields.places.get(*field))
            .map_or(0, |one| one.1)
    };
    let sizes = [size(0), size(1), size(2)];
    let taken = count.min(MAX_POINTS);
    let point = |index: u64| {
        let at = spread(index, taken, count.saturating_sub(1));
        let mut axes = columns.into_iter().zip(sizes).map(|(column, size)| {
            let from = usize::try_from(at * size).unwrap_or(usize::MAX);
            data.get(from..).and_then(|data| column.of(data)).unwrap_or(f64::NAN)
        });
        [(); 3].map(|()| axes.next().unwrap_or(f64::NAN))
    };
    Ok((0..taken).map(point).collect())
}
