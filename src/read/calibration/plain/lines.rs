//! Texts whose lines are keys with numbers, rows of a matrix, or poses over time.

use super::super::document::{Fault, Kind, Node};
use super::super::numbers::number;
use super::{Form, scalar, text_lines, value, words};
use crate::source::Span;

/// Numbers of a line of poses: TUM's time, place and quaternion; KITTI's 3x4.
const POSE_COLUMNS: [usize; 2] = [8, 12];
/// Keys of KITTI: a file with them is a KITTI calibration, even if numbers are missing.
const KITTI: [&str; 8] = [
    "calib_time",
    "Tr_velo_to_cam",
    "Tr_velo_cam",
    "Tr_imu_to_velo",
    "Tr_imu_velo",
    "R0_rect",
    "R_rect",
    "P_rect_00",
];
/// Lines that must agree before a text is taken for poses over time.
const MIN_POSES: usize = 2;

fn is_said(line: &str) -> bool {
    let line = line.trim();
    !line.is_empty() && !line.starts_with(['#', '%'])
}

/// The form of a text by its first lines; the last of them may be cut.
pub(super) fn form(head: &str) -> Option<Form> {
    let all: Vec<&str> = head.lines().filter(|line| is_said(line)).collect();
    let whole = if head.len() >= 4096 && all.len() > 1 {
        all.split_last().map(|(_, rest)| rest)?
    } else {
        all.as_slice()
    };
    let counts: Option<Vec<usize>> = whole
        .iter()
        .map(|line| Some(count(line)).filter(|count| *count > 0))
        .collect();
    if let Some(counts) = counts {
        let first = *counts.first()?;
        let is_even = counts.iter().all(|count| *count == first);
        return match counts.len() {
            3 | 4 if is_even && first == 4 => Some(Form::Matrix),
            lines if is_even && lines >= MIN_POSES && POSE_COLUMNS.contains(&first) => Some(Form::Trajectory),
            _ => None,
        };
    }
    // Every line is a key with something after it, and some have the numbers of a rotation or more.
    let keyed: Option<Vec<usize>> = whole
        .iter()
        .map(|line| key_of(line).map(|(_, rest)| count(rest)))
        .collect();
    let keys = || whole.iter().filter_map(|line| key_of(line)).map(|(key, _)| key);
    let is_kittis = keys().any(|key| KITTI.contains(&key));
    let has_matrices = keyed?.into_iter().any(|count| matches!(count, 9 | 12 | 16));
    (has_matrices || is_kittis).then_some(Form::Keyed)
}

/// How many numbers a text has; zero if it contains anything else.
fn count(text: &str) -> usize {
    let all: Option<Vec<f64>> = words(text, 0).map(|(word, _)| number(word)).collect();
    all.map_or(0, |all| all.len())
}

/// The key of a line, and what follows it. KITTI's tracking files omit the colon.
fn key_of(line: &str) -> Option<(&str, &str)> {
    let line = line.trim_start();
    let end = line.find(|letter: char| letter == ':' || letter.is_whitespace())?;
    let (key, rest) = line.split_at(end);
    let is_key = key.starts_with(|letter: char| letter.is_ascii_alphabetic())
        && key
            .chars()
            .all(|letter| letter.is_ascii_alphanumeric() || "_-./".contains(letter));
    is_key.then(|| (key, rest.strip_prefix(':').unwrap_or(rest)))
}

/// `key: numbers`.
pub(super) fn keyed(text: &str) -> (Node, Option<Fault>) {
    let mut pairs = Vec::new();
    for (start, line) in text_lines(text).filter(|(_, line)| is_said(line)) {
        let Some((key, rest)) = key_of(line) else {
            return (
                mapping(text, pairs),
                Some(fault(start, "this line does not begin with a key")),
            );
        };
        let at = start + (key.as_ptr() as usize - line.as_ptr() as usize);
        let behind = start + (rest.as_ptr() as usize - line.as_ptr() as usize);
        let key = scalar(key, Span::new(at, at + key.len()));
        pairs.push((key, value(words(rest, behind).collect(), behind)));
    }
    (mapping(text, pairs), None)
}

/// Rows of numbers.
pub(super) fn matrix(text: &str) -> (Node, Option<Fault>) {
    let rows = text_lines(text).filter(|(_, line)| is_said(line));
    let rows: Vec<Node> = rows
        .map(|(start, line)| value(words(line, start).collect(), start))
        .collect();
    let span = match (rows.first(), rows.last()) {
        (Some(first), Some(last)) => first.span.cover(last.span),
        _ => Span::new(0, text.len()),
    };
    (Node::new(span, Kind::Sequence(rows)), None)
}

/// Poses over time: each line must have the form of the first. They contain no mounting transform.
pub(super) fn trajectory(text: &str) -> (Node, Option<Fault>) {
    let mut columns = None;
    for (start, line) in text_lines(text).filter(|(_, line)| is_said(line)) {
        let found = words(line, start).count();
        let expected = *columns.get_or_insert(found);
        let bad = words(line, start).find(|(word, _)| number(word).is_none());
        if let Some((word, span)) = bad {
            return (
                mapping(text, Vec::new()),
                Some(fault(span.start, &format!("`{word}` is not a number"))),
            );
        }
        if found != expected {
            let message = format!("{found} numbers, but the lines before have {expected}");
            return (mapping(text, Vec::new()), Some(fault(start, &message)));
        }
    }
    (mapping(text, Vec::new()), None)
}

pub(super) fn mapping(text: &str, pairs: Vec<(Node, Node)>) -> Node {
    Node::new(Span::new(0, text.len()), Kind::Mapping(pairs))
}

pub(super) fn fault(at: usize, message: &str) -> Fault {
    Fault {
        at,
        message: message.to_owned(),
    }
}
