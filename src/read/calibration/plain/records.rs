//! Texts of records: tables with a line of names (CSV), images of COLMAP, and blocks under titles (M2DGR).

use super::super::beams::are_columns;
use super::super::document::{Fault, Kind, Node};
use super::super::numbers::number;
use super::lines::{fault, mapping};
use super::{Form, scalar, text_lines, value, words};
use crate::source::Span;

/// Sets of column names: a table has transforms if it has a position and a rotation, each by one set.
const PLACES: [[&str; 3]; 7] = [
    ["x", "y", "z"],
    ["tx", "ty", "tz"],
    ["px", "py", "pz"],
    ["x_m", "y_m", "z_m"],
    ["tx_m", "ty_m", "tz_m"],
    ["x_mm", "y_mm", "z_mm"],
    ["tx_mm", "ty_mm", "tz_mm"],
];
const ROTATIONS: [&[&str]; 4] = [
    &["qx", "qy", "qz", "qw"],
    &["roll", "pitch", "yaw"],
    &["roll_deg", "pitch_deg", "yaw_deg"],
    &["roll_rad", "pitch_rad", "yaw_rad"],
];
/// Columns that name the two frames of a transform: with these, a position alone is one.
const FRAMES: [[&str; 2]; 3] = [
    ["parent", "child"],
    ["parent_frame", "child_frame"],
    ["target_frame", "source_frame"],
];
/// With one of these columns, the rows are poses at different times of a drive.
const TIMES: [&str; 6] = ["time", "timestamp", "timestamp_ns", "stamp", "sec", "t"];
/// How COLMAP states the meaning of its lines.
const COLMAP: &str = "IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME";
/// How OpenVINS states the columns of its states.
const OPENVINS: &str = "# timestamp(s) q p v bg ba";
/// Rows that are read.
const MAX_ROWS: usize = 20_000;

/// The form of a table by its line of names, which comments may precede.
pub(super) fn table_form(head: &str) -> Option<Form> {
    let mut begin = head.lines().filter(|line| !line.trim().is_empty());
    begin.find_map(|line| {
        Some(form_of_names(line)).filter(|form| form.is_some() || !(is_comment(line) || is_mark(line)))
    })?
}

/// Whether a line is a comment, unless it has the names of the columns.
fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with('#')
}

/// Whether a line is the mark that precedes a table of Hesai.
fn is_mark(line: &str) -> bool {
    line.trim_start().starts_with("EEFF")
}

fn form_of_names(line: &str) -> Option<Form> {
    let names: Vec<String> = fields(line, 0).into_iter().map(|(name, _)| column(name)).collect();
    let has = |set: &[&str]| set.iter().all(|name| names.iter().any(|known| known == name));
    let has_more = ROTATIONS.iter().any(|set| has(set)) || FRAMES.iter().any(|set| has(set));
    let is_of_transforms = PLACES.iter().any(|set| has(set)) && has_more;
    let is_of_time = names.iter().any(|name| TIMES.contains(&name.as_str()));
    match (is_of_transforms, is_of_time) {
        _ if are_columns(&names) => Some(Form::Beams),
        (true, false) => Some(Form::Table),
        (true, true) => Some(Form::Moments),
        _ => None,
    }
}

/// The form of a text with words of COLMAP or of M2DGR in its first lines.
pub(super) fn titled_form(head: &str) -> Option<Form> {
    if head.contains(COLMAP) {
        return Some(Form::Colmap);
    }
    if head.starts_with(OPENVINS) {
        return Some(Form::States);
    }
    let titles = head.lines().filter(|line| line.starts_with("%%")).count();
    (titles > 0 && head.contains("data: [")).then_some(Form::Titled)
}

/// A name of a column without its unit and comment mark.
fn column(name: &str) -> String {
    let name = name.trim_start_matches('#').split('[').next().unwrap_or_default();
    name.trim().to_lowercase()
}

/// The fields of a line between commas or semicolons, quotes taken off, with their places.
fn fields(line: &str, start: usize) -> Vec<(&str, Span)> {
    let separator = if line.contains(';') { ';' } else { ',' };
    line.split(separator)
        .map(|field| {
            let text = field.trim().trim_matches('"');
            let at = start + (text.as_ptr() as usize - line.as_ptr() as usize);
            (text, Span::new(at, at + text.len()))
        })
        .collect()
}

/// A list of mappings, one a row.
pub(super) fn table(text: &str) -> (Node, Option<Fault>) {
    let mut lines = text_lines(text).filter(|(_, line)| !line.trim().is_empty());
    let Some((start, first)) = lines.find(|(_, line)| form_of_names(line).is_some()) else {
        return (mapping(text, Vec::new()), None);
    };
    let names: Vec<(String, Span)> = fields(first, start)
        .into_iter()
        .map(|(name, span)| (column(name), span))
        .collect();
    let is_of_beams = form_of_names(first) == Some(Form::Beams);
    let mut rows = Vec::new();
    let mut wrong = None;
    for (start, line) in lines.filter(|(_, line)| !is_comment(line)) {
        let found = fields(line, start);
        // Behind its rows, a table of Hesai may have a line with their checksum.
        if found.len() == 1 && is_of_beams {
            continue;
        }
        if found.len() != names.len() {
            let message = format!("{} fields, but the line of names has {}", found.len(), names.len());
            wrong = Some(fault(start, &message));
            break;
        }
        if rows.len() >= MAX_ROWS {
            wrong = Some(fault(start, &format!("more than {MAX_ROWS} rows")));
            break;
        }
        let pairs: Vec<(Node, Node)> = names
            .iter()
            .zip(found)
            .map(|((name, _), (field, span))| (scalar(name, span), scalar(field, span)))
            .collect();
        rows.push(Node::new(Span::new(start, start + line.len()), Kind::Mapping(pairs)));
    }
    (Node::new(Span::new(0, text.len()), Kind::Sequence(rows)), wrong)
}

/// `{images: [{name, camera_id, qw, ..., tz}]}`; the lines of points in between are skipped.
pub(super) fn colmap(text: &str) -> (Node, Option<Fault>) {
    const NAMES: [&str; 9] = ["image_id", "qw", "qx", "qy", "qz", "tx", "ty", "tz", "camera_id"];
    let said = text_lines(text).filter(|(_, line)| !line.trim_start().starts_with('#'));
    let mut images = Vec::new();
    let mut wrong = None;
    let mut is_points = false;
    for (start, line) in said {
        if std::mem::take(&mut is_points) {
            continue;
        }
        if line.trim().is_empty() {
            continue;
        }
        is_points = true;
        let all: Vec<(&str, Span)> = words(line, start).collect();
        let (Some(numbers), Some((name, place))) = (all.get(..9), all.get(9)) else {
            wrong = Some(fault(
                start,
                "the line of an image must have an id, a rotation, a translation, a camera and a name",
            ));
            break;
        };
        if let Some((word, span)) = numbers.iter().find(|(word, _)| number(word).is_none()) {
            wrong = Some(fault(span.start, &format!("`{word}` is not a number")));
            break;
        }
        if images.len() >= MAX_ROWS {
            wrong = Some(fault(start, &format!("more than {MAX_ROWS} images")));
            break;
        }
        let numbers = NAMES.iter().zip(numbers);
        let mut pairs: Vec<(Node, Node)> = numbers
            .map(|(key, (word, span))| (scalar(key, *span), scalar(word, *span)))
            .collect();
        pairs.push((scalar("name", *place), scalar(name, *place)));
        images.push(Node::new(Span::new(start, start + line.len()), Kind::Mapping(pairs)));
    }
    let whole = Span::new(0, text.len());
    let key = scalar("images", Span::new(0, 0));
    let images = Node::new(whole, Kind::Sequence(images));
    (Node::new(whole, Kind::Mapping(vec![(key, images)])), wrong)
}

/// `{Cam-left: {"Extrinsic [to LIDAR]": [...]}}` of `%% Cam-left 8823`, `% Extrinsic [to LIDAR], [opencv-matrix]`, `data: [...]`.
pub(super) fn titled(text: &str) -> (Node, Option<Fault>) {
    let mut sensors: Vec<(Node, Vec<(Node, Node)>)> = Vec::new();
    let mut label: Option<Node> = None;
    let mut open: Option<(usize, Vec<(&str, Span)>)> = None;
    for (start, line) in text_lines(text) {
        let title = line.trim();
        if let Some((at, mut numbers)) = open.take() {
            numbers.extend(words(line, start));
            open = close(line, at, numbers, &mut label, &mut sensors);
        } else if let Some(name) = title.strip_prefix("%%") {
            let word = name.split_whitespace().next().unwrap_or_default();
            if !word.is_empty() {
                let at = start + (word.as_ptr() as usize - line.as_ptr() as usize);
                label = None;
                sensors.push((scalar(word, Span::new(at, at + word.len())), Vec::new()));
            }
        } else if let Some(words) = title.strip_prefix('%') {
            let name = words.split(',').next().unwrap_or_default().trim();
            let at = start + (name.as_ptr() as usize - line.as_ptr() as usize);
            let plain = name.split_whitespace().collect::<Vec<_>>().join(" ");
            // The text between a title and its numbers is a comment.
            label.get_or_insert(scalar(&plain, Span::new(at, at + name.len())));
        } else if let Some(at) = line.find("data:") {
            let behind = at + "data:".len();
            let rest = line.get(behind..).unwrap_or_default();
            let numbers: Vec<(&str, Span)> = words(rest, start + behind).collect();
            open = close(rest, start + behind, numbers, &mut label, &mut sensors);
        }
    }
    let unclosed = open.map(|(at, _)| fault(at, "this list is not closed"));
    let pairs = sensors.into_iter().map(|(name, pairs)| {
        let span = pairs.last().map_or(name.span, |(_, last)| name.span.cover(last.span));
        (name, Node::new(span, Kind::Mapping(pairs)))
    });
    (mapping(text, pairs.collect()), unclosed)
}

/// Stores a list under its label if the line closes it; otherwise it stays open.
fn close<'a>(
    line: &str,
    at: usize,
    numbers: Vec<(&'a str, Span)>,
    label: &mut Option<Node>,
    sensors: &mut [(Node, Vec<(Node, Node)>)],
) -> Option<(usize, Vec<(&'a str, Span)>)> {
    if !line.contains(']') {
        return Some((at, numbers));
    }
    if let (Some(label), Some((_, pairs))) = (label.take(), sensors.last_mut()) {
        pairs.push((label, value(numbers, at)));
    }
    None
}
