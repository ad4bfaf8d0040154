//! Calibration files in plain text, which are neither YAML nor JSON: converted to the same documents, so that one reader handles all.
//!
//! Owns which form a text has. The table of dialects states what its keys mean.

mod blocks;
mod lines;
mod records;

use super::document::{Documents, Kind, Node};
use crate::source::Span;

/// The form of a plain text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// `key: numbers`, line by line (KITTI).
    Keyed,
    /// Rows of numbers that are one matrix (numpy's `savetxt`).
    Matrix,
    /// `[section]` and `key = value` (MRPT).
    Ini,
    /// `key value` in blocks of braces (ROVIO's Boost property trees).
    Info,
    /// Tables of Lua (Cartographer).
    Lua,
    /// Poses over time, one a line.
    Trajectory,
    /// A line of names and a transform in each row (CSV; what a feather table becomes).
    Table,
    /// The same with the angles of a beam in each row (Hesai).
    Beams,
    /// The same with a time in each row: poses over time.
    Moments,
    /// States of OpenVINS over time.
    States,
    /// Images of COLMAP.
    Colmap,
    /// Blocks of numbers under titles (M2DGR).
    Titled,
}

impl Form {
    /// Whether it holds poses over time, and no transform of the platform.
    pub(super) fn is_over_time(self) -> bool {
        matches!(self, Self::Trajectory | Self::Moments | Self::States)
    }
}

/// Bytes of a file that determine its form; the rest must have the same form.
const HEAD: usize = 8192;

/// Words that a file with these endings must contain.
const MARKS: [(&str, Form, &[&str]); 3] = [
    ("ini", Form::Ini, &["pose_x", "sensorLabel"]),
    ("info", Form::Info, &["qCM_", "MrMC_"]),
    ("lua", Form::Lua, &["tracking_frame", "published_frame"]),
];

/// The form of a file by the ending of its name, in lower case, and the beginning of its text; `None` if it is not a calibration.
pub(crate) fn form(ending: &str, text: &str) -> Option<Form> {
    let mut cuts = (0..=HEAD.min(text.len())).rev();
    let head = cuts.find_map(|end| text.get(..end)).unwrap_or_default();
    if let Some((_, form, words)) = MARKS.iter().find(|(known, ..)| *known == ending) {
        return words.iter().any(|word| head.contains(word)).then_some(*form);
    }
    match ending {
        "txt" => records::titled_form(head).or_else(|| lines::form(head)),
        "csv" | "feather" => records::table_form(head),
        "tum" => Some(Form::Trajectory),
        _ => None,
    }
}

/// Whether a text is YAML though its name does not say so (M2DGR-plus).
pub(crate) fn is_yaml(ending: &str, head: &str) -> bool {
    let has = |start: &str| head.lines().any(|line| line.trim_start().starts_with(start));
    ending == "txt" && has("rows:") && has("data:") && !head.contains("%%")
}

/// The document of a text. `stem` is the name of the file without its ending: in some formats, only the name states what a file contains.
pub(super) fn build(form: Form, text: &str, stem: &str) -> Documents {
    let (root, fault) = match form {
        Form::Keyed => lines::keyed(text),
        Form::Matrix => lines::matrix(text),
        Form::Trajectory => lines::trajectory(text),
        Form::Table | Form::Beams => records::table(text),
        Form::Moments | Form::States => (lines::mapping(text, Vec::new()), None),
        Form::Colmap => records::colmap(text),
        Form::Titled => records::titled(text),
        Form::Ini => blocks::ini(text),
        Form::Info => blocks::info(text),
        Form::Lua => blocks::lua(text),
    };
    let root = if matches!(form, Form::Keyed | Form::Matrix | Form::Table | Form::Beams) {
        let first = root.pairs().first().map_or(root.span.start, |(key, _)| key.span.start);
        let name = scalar(stem, Span::new(first, first));
        Node::new(root.span, Kind::Mapping(vec![(name, root)]))
    } else {
        root
    };
    Documents {
        roots: vec![root],
        fault,
        ..Documents::default()
    }
}

fn scalar(text: &str, span: Span) -> Node {
    let kind = Kind::Scalar {
        text: text.into(),
        quoted: false,
    };
    Node::new(span, kind)
}

/// The words of a line with their places; `start` is where the line begins.
fn words(line: &str, start: usize) -> impl Iterator<Item = (&str, Span)> {
    // MRPT writes lists in brackets.
    let is_gap = |letter: char| letter.is_whitespace() || matches!(letter, ',' | '[' | ']');
    line.split(is_gap).filter(|word| !word.is_empty()).map(move |word| {
        let at = start + (word.as_ptr() as usize - line.as_ptr() as usize);
        (word, Span::new(at, at + word.len()))
    })
}

/// The lines of a text with where they begin, without their ends.
fn text_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut start = 0;
    text.split_inclusive('\n').map(move |line| {
        let at = start;
        start += line.len();
        (at, line.trim_end_matches(['\n', '\r']))
    })
}

/// One word, or a list of them.
fn value(words: Vec<(&str, Span)>, empty_at: usize) -> Node {
    match words.as_slice() {
        [] => scalar("", Span::new(empty_at, empty_at)),
        [(word, span)] => scalar(word, *span),
        [(_, first), .., (_, last)] => {
            let span = first.cover(*last);
            let items = words.into_iter().map(|(word, span)| scalar(word, span)).collect();
            Node::new(span, Kind::Sequence(items))
        }
    }
}
