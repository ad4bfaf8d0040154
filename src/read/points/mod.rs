//! Files of point clouds: PCD, PLY, LAS and LAZ.
//!
//! Owns their headers, and which points are read: at most `sample::MAX_POINTS`, spread over the file, so that the time does not depend on its
//! size. Must not judge.

mod crs;
mod las;
mod laz;
mod lzf;
mod pcd;
mod ply;
mod sample;

use std::io::{Read, Seek};

use crate::math::relief;
use crate::source::{Coverage, Place, ReadStatus, Source, Span};
use crate::world::point_file::{PointsSeen, Relief};
use crate::world::{Facts, PointFile};

use sample::Tape;

pub(crate) use ply::is_cloud as is_ply_cloud;

/// The first bytes of LAS and LAZ.
pub(crate) const LAS_MAGIC: &[u8] = b"LASF";
/// The first bytes of PLY.
pub(crate) const PLY_MAGIC: &[u8] = b"ply";
/// Longest header that is a text, bytes.
const MAX_HEADER: usize = 64 << 10;
/// Largest point, bytes.
const MAX_STRIDE: u64 = 64 << 10;

/// Why a file cannot be read: a sentence, and the place in the header if there is one.
#[derive(Debug)]
struct Fault {
    message: String,
    span: Option<Span>,
}

impl Fault {
    fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            span: None,
        }
    }

    fn at(span: Span, message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            span: Some(span),
        }
    }
}

impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Self {
        Self::new(format!("cannot be read: {error}"))
    }
}

/// A file's header and the points that were read of it.
struct Cloud {
    file: PointFile,
    points: Vec<[f64; 3]>,
    /// What is missing or contradictory.
    faults: Vec<Fault>,
}

/// A record of a LAS file, with its user and its number.
struct Record {
    user: String,
    id: u16,
    data: Vec<u8>,
}

/// What a file of points contains. Its header becomes the text of the source, if it is one.
pub fn read(file: impl Read + Seek, source: &mut Source) -> Facts {
    let cloud = Tape::new(file).map_err(Fault::from).and_then(|mut tape| {
        let cloud = read_cloud(&mut tape, source);
        source.examined = Coverage {
            bytes: tape.taken.min(tape.size),
            bytes_total: tape.size,
            ..Coverage::default()
        };
        cloud
    });
    let place = |span: Option<Span>| span.map_or(Place::whole(source.id), |span| Place::text(source.id, span));
    match cloud {
        Ok(Cloud {
            mut file,
            points,
            faults,
        }) => {
            let faults: Vec<_> = faults.into_iter().map(|one| (place(one.span), one.message)).collect();
            for (place, message) in faults {
                source.problem(ReadStatus::Partial, place, message);
            }
            file.read = points.len() as u64;
            file.seen = seen(&points);
            Facts {
                point_files: vec![file],
                ..Facts::default()
            }
        }
        Err(Fault { message, span }) => {
            let place = place(span);
            source.problem(ReadStatus::Unreadable, place, message);
            Facts::default()
        }
    }
}

fn read_cloud(tape: &mut Tape<impl Read + Seek>, source: &mut Source) -> Result<Cloud, Fault> {
    let head = tape.at(0, MAX_HEADER)?;
    if head.is_empty() {
        return Err(Fault::new("the file is empty"));
    }
    if head.starts_with(LAS_MAGIC) {
        las::read(tape, &head, source.id)
    } else if head.starts_with(PLY_MAGIC) {
        ply::read(tape, &head, source)
    } else {
        pcd::read(tape, &head, source)
    }
}

/// The text of a header that ends with the line that `is_last`, and the offset behind it.
fn header_text(head: &[u8], is_last: impl Fn(&str) -> bool) -> Result<(String, u64), Fault> {
    let mut end = 0;
    for line in head.split_inclusive(|byte| *byte == b'\n') {
        end += line.len();
        if is_last(String::from_utf8_lossy(line).trim()) {
            let text = head.get(..end).map(String::from_utf8_lossy).unwrap_or_default();
            return Ok((text.into_owned(), end as u64));
        }
    }
    Err(Fault::new(
        "the header has no end: the file is cut off, or is of another format",
    ))
}

/// Lines of a header with their spans.
fn lines(text: &str) -> impl Iterator<Item = (&str, Span)> {
    text.split_inclusive('\n').scan(0, |start, line| {
        let at = *start;
        *start += line.len();
        let line = line.trim_end();
        Some((line, Span::new(at, at + line.len())))
    })
}

/// Measurements of points. In organised clouds, points without a return are NaN or the origin.
fn seen(points: &[[f64; 3]]) -> Option<PointsSeen> {
    let is_point = |point: &&[f64; 3]| point.iter().all(|v| v.is_finite()) && point.iter().any(|v| *v != 0.0);
    let points: Vec<[f64; 3]> = points.iter().filter(is_point).copied().collect();
    let first = *points.first()?;
    let bound = |pick: fn(f64, f64) -> f64| {
        points
            .iter()
            .fold(first, |[a, b, c], [x, y, z]| [pick(a, *x), pick(b, *y), pick(c, *z)])
    };
    let least = bound(f64::min);
    let [a, b, c] = least;
    let near: Vec<[f64; 3]> = points.iter().map(|[x, y, z]| [x - a, y - b, z - c]).collect();
    let values = || points.iter().flatten();
    #[allow(clippy::cast_possible_truncation)] // the loss is what is measured
    let is_single = |value: &f64| f64::from(*value as f32).to_bits() == value.to_bits();
    Some(PointsSeen {
        least,
        most: bound(f64::max),
        is_single: values().all(is_single),
        relief: relief::relief(&near).map(|(extent, [low, high], cells)| Relief {
            extent,
            low,
            high,
            cells: u32::try_from(cells).unwrap_or(u32::MAX),
        }),
    })
}
