//! PLY clouds: a header of lines, then the vertices as text or bytes. Source: Turk, "The PLY Polygon File Format", 1994. Meshes and Gaussian
//! splats have the same format and are no clouds.

use std::io::{Read, Seek};

use crate::read::messages::cloud::{Column, Datatype};
use crate::source::{Place, Source, Span};
use crate::world::PointFile;
use crate::world::cloud::PointField;
use crate::world::point_file::PointFormat;

use super::sample::{Tape, xyz, xyz_of_line};
use super::{Cloud, Fault, MAX_STRIDE, PLY_MAGIC, header_text, lines};

const END: &str = "end_header";

/// Whether a file with these first bytes is a cloud.
pub(crate) fn is_cloud(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    let text = text.split(END).next().unwrap_or_default();
    let has_faces = |line: &str| {
        let count = ["element face ", "element tristrips ", "element edge "];
        let count = count.iter().find_map(|start| line.strip_prefix(start));
        count.is_some_and(|count| count.trim() != "0")
    };
    // The colours of a splat.
    let is_splat = |line: &str| line.ends_with(" f_dc_0");
    head.starts_with(PLY_MAGIC)
        && text.contains("element vertex")
        && !text.lines().any(|line| has_faces(line) || is_splat(line))
}

/// One kind of things of the file.
struct Element<'t> {
    name: &'t str,
    count: u64,
    fields: Vec<(PointField, Option<Datatype>)>,
    has_list: bool,
    /// The line of its first coordinate.
    at: Span,
}

impl Element<'_> {
    fn stride(&self) -> Option<u64> {
        let sizes = self.fields.iter().map(|(_, kind)| Some(u64::from((*kind)?.bytes())));
        sizes.sum::<Option<u64>>().filter(|_| !self.has_list)
    }
}

pub(super) fn read(tape: &mut Tape<impl Read + Seek>, head: &[u8], source: &mut Source) -> Result<Cloud, Fault> {
    let (text, mut start) = header_text(head, |line| line == END)?;
    source.text.clone_from(&text);
    let (format, elements) = elements(&text)?;
    let mut before = elements.iter().take_while(|element| element.name != "vertex");
    let vertices = elements.iter().find(|element| element.name == "vertex");
    let vertices = vertices.ok_or_else(|| Fault::new("the header has no `element vertex`"))?;
    let place = |name: &str| {
        let at = vertices.fields.iter().position(|(field, _)| field.name == name);
        at.ok_or_else(|| Fault::at(vertices.at, format!("the vertices have no property `{name}`")))
    };
    let places = [place("x")?, place("y")?, place("z")?];
    let (mut points, mut faults) = (Vec::new(), Vec::new());
    let cut = |held: u64| {
        Fault::new(format!(
            "the header states {} points, but the file has {held}",
            vertices.count
        ))
    };
    if format == "ascii" {
        let skipped: u64 = before.map(|element| element.count).sum();
        let mut line_number = 0;
        let is_all = tape.lines(start, |line| {
            line_number += 1;
            if line_number > skipped && points.len() as u64 <= vertices.count {
                points.push(xyz_of_line(places, line));
            }
        })?;
        if is_all && (points.len() as u64) < vertices.count {
            faults.push(cut(points.len() as u64));
        }
        points.truncate(usize::try_from(vertices.count).unwrap_or(usize::MAX));
    } else {
        let skipped: Option<u64> = before.try_fold(0_u64, |sum, element| {
            sum.checked_add(element.stride()?.checked_mul(element.count)?)
        });
        let stride = vertices.stride().filter(|stride| (1..=MAX_STRIDE).contains(stride));
        let (Some(skipped), Some(stride)) = (skipped, stride) else {
            let message = "a list, or a type that PLY does not have, stands before or in the vertices";
            return Err(Fault::at(vertices.at, message));
        };
        start = start.saturating_add(skipped);
        let offset = |field: usize| {
            let before = vertices.fields.iter().take(field);
            before.map(|(_, kind)| kind.map_or(0, Datatype::bytes) as usize).sum()
        };
        let is_bigendian = format == "binary_big_endian";
        let columns = places.map(|field| {
            let kind = vertices.fields.get(field).and_then(|(_, kind)| *kind);
            Column::new(offset(field), kind.unwrap_or(Datatype::F32), is_bigendian)
        });
        let held = tape.size.saturating_sub(start) / stride;
        if held < vertices.count {
            faults.push(cut(held));
        }
        tape.records(start, (stride, vertices.count.min(held)), |point| {
            points.push(xyz(columns, point));
        })?;
    }
    let file = PointFile {
        place: Place::whole(source.id),
        format: PointFormat::Ply,
        stated: vertices.count,
        read: 0,
        fields: vertices.fields.iter().map(|(field, _)| field.clone()).collect(),
        coordinates_at: Some(Place::text(source.id, vertices.at)),
        seen: None,
        viewpoint: None,
        las: None,
        crs: None,
    };
    Ok(Cloud { file, points, faults })
}

/// The format of the data, and the elements in their order.
fn elements(text: &str) -> Result<(&str, Vec<Element<'_>>), Fault> {
    let (mut format, mut elements) = (None, Vec::<Element>::new());
    for (line, span) in lines(text) {
        let mut words = line.split_ascii_whitespace();
        match (words.next(), words.next(), words.next(), elements.last_mut()) {
            (Some("format"), Some(word @ ("ascii" | "binary_little_endian" | "binary_big_endian")), ..) => {
                format = Some(word);
            }
            (Some("format"), ..) => {
                let message = "the format must be ascii, binary_little_endian or binary_big_endian";
                return Err(Fault::at(span, message));
            }
            (Some("element"), Some(name), Some(count), _) => {
                let count = count.parse().ok().filter(|count: &u64| *count < 1 << 48);
                elements.push(Element {
                    name,
                    count: count.ok_or_else(|| Fault::at(span, "the number of elements is not a whole number"))?,
                    fields: Vec::new(),
                    has_list: false,
                    at: span,
                });
            }
            (Some("property"), Some("list"), _, Some(element)) => element.has_list = true,
            (Some("property"), Some(kind), Some(name), Some(element)) => {
                if name == "x" {
                    element.at = span;
                }
                let datatype = datatype(kind);
                let field = PointField {
                    name: name.to_owned(),
                    datatype: datatype.map_or_else(|| kind.to_owned(), |one| one.word().to_owned()),
                    count: 1,
                };
                element.fields.push((field, datatype));
            }
            _ => {}
        }
    }
    let format = format.ok_or_else(|| Fault::new("the header has no line `format`"))?;
    Ok((format, elements))
}

fn datatype(kind: &str) -> Option<Datatype> {
    Some(match kind {
        "char" | "int8" => Datatype::I8,
        "uchar" | "uint8" => Datatype::U8,
        "short" | "int16" => Datatype::I16,
        "ushort" | "uint16" => Datatype::U16,
        "int" | "int32" => Datatype::I32,
        "uint" | "uint32" => Datatype::U32,
        "float" | "float32" => Datatype::F32,
        "double" | "float64" => Datatype::F64,
        _ => return None,
    })
}
