//! Dialects: what a known format means beyond its keys.
//!
//! Owns how a file is recognised by its keys, and which row of the table describes a value. The table (`rules/tables/
//! calibration-dialects.yaml`) knows the formats; a new one needs only a row there. Autoware's is recognised by its nesting, in `generic`.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Bound;
use std::sync::Arc;

use crate::source::Confidence;
use crate::tables::{Angle, Dialect, KeyedTransform, Length, QuaternionWord, Rows};

use super::document::{Kind, Node};

/// Values under one path that are kept for marks such as `T_type=0`.
const MAX_VALUES: usize = 4;
/// Longer texts are not such values.
const MAX_VALUE: usize = 32;
/// Different paths that are read; files of records repeat the same ones.
const MAX_PATHS: usize = 4096;

/// Units and order of the numbers under a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Terms {
    /// Metres of one unit of length.
    pub(super) metres: f64,
    /// Whether angles are degrees.
    pub(super) degrees: bool,
    /// Whether a bare list of four is x y z w, or w x y z.
    pub(super) xyzw: Option<bool>,
    /// The list holds one 4x4 for each sensor, and the bottom rows carry flags: only their upper 3x4 are transforms.
    pub(super) packed: bool,
    /// Where they come from.
    pub(super) by: TermsSource,
}

/// Why the units and order of a value are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TermsSource {
    /// They are not known; the usual ones are assumed.
    Nothing,
    /// A row of the table.
    Row,
    /// Autoware's nesting, whose xacro pastes the values into a joint's origin under these names.
    Nesting,
}

/// Unknown format: metres, radians.
pub(super) const GENERIC: Terms = Terms {
    metres: 1.0,
    degrees: false,
    xyzw: None,
    packed: false,
    by: TermsSource::Nothing,
};

/// Autoware's `parent: {child: {x, y, z, roll, pitch, yaw}}`.
pub(super) const AUTOWARE: Terms = Terms {
    by: TermsSource::Nesting,
    ..GENERIC
};

impl Terms {
    /// Whether the format is known.
    pub(super) fn are_known(&self) -> bool {
        self.by != TermsSource::Nothing
    }

    fn of(keyed: &KeyedTransform) -> Self {
        Self {
            metres: match keyed.length {
                Length::Metres => 1.0,
                Length::Millimetres => 1e-3,
            },
            degrees: keyed.angle == Angle::Degrees,
            xyzw: keyed.quaternion.map(|order| order == QuaternionWord::Xyzw),
            packed: keyed.packed,
            by: TermsSource::Row,
        }
    }
}

/// What the table says about one value.
#[derive(Clone, Debug)]
pub(super) struct TableEntry<'r> {
    pub(super) keyed: &'r KeyedTransform,
    /// The parts of its path that the key leaves open.
    found: KeyWildcards,
}

/// The values of `#` and `*` of a key.
#[derive(Clone, Debug, Default)]
struct KeyWildcards {
    numbers: Vec<u32>,
    words: Vec<String>,
}

impl TableEntry<'_> {
    pub(super) fn terms(&self) -> Terms {
        Terms::of(self.keyed)
    }

    /// The two frames, `(target, source)`, with `sibling` for the texts next to it.
    pub(super) fn frames(&self, sibling: impl Fn(&str) -> Option<String>) -> Option<(String, String)> {
        let (target, source) = self.keyed.is.as_ref()?.split_once(" from ")?;
        let frame = |word: &str| match word.strip_prefix('@') {
            Some(key) => sibling(key),
            None if word == "*" => self.found.words.first().cloned(),
            None => self.numbered(word),
        };
        let frames = (frame(target)?, frame(source)?);
        // KITTI also lists camera 0 relative to itself.
        (frames.0 != frames.1).then_some(frames)
    }

    /// Whether the row names exactly this key.
    pub(super) fn names(&self, key: &str) -> bool {
        let keys = self.keyed.keys.iter();
        keys.filter_map(|known| known.rsplit('/').next())
            .any(|known| matched(known, &[key]).is_some() && known != "*")
    }

    /// What the halves of one transform have in common, where the row names several keys for it.
    pub(super) fn stem(&self) -> Option<String> {
        let numbers: Vec<String> = self.found.numbers.iter().map(u32::to_string).collect();
        (self.keyed.keys.len() > 1).then(|| format!("{} {}", self.keyed.keys.join("+"), numbers.join(" ")))
    }

    /// A frame with its numbers: `#`, `#2`, `#-1`.
    fn numbered(&self, word: &str) -> Option<String> {
        let mut parts = word.split('#');
        let mut name = parts.next()?.to_owned();
        for part in parts {
            let (number, rest) = if let Some(rest) = part.strip_prefix("-1") {
                (self.found.numbers.first()?.checked_sub(1)?, rest)
            } else if let Some(rest) = part.strip_prefix('2') {
                (*self.found.numbers.get(1)?, rest)
            } else {
                (*self.found.numbers.first()?, part)
            };
            name.push_str(&number.to_string());
            name.push_str(rest);
        }
        Some(name)
    }
}

/// How sure a row's direction is.
pub(super) fn reading(dialect: &Dialect, keyed: &KeyedTransform) -> Confidence {
    if dialect.verified && keyed.doubt.is_none() {
        Confidence::Likely
    } else {
        Confidence::Hint
    }
}

/// What the row says about the value with this label.
pub(super) fn entry<'r>(dialect: &'r Dialect, label: &str) -> Option<TableEntry<'r>> {
    let by = |path: &[&str]| {
        dialect.transforms.iter().find_map(|keyed| {
            let found = keyed.keys.iter().find_map(|key| matched(key, path))?;
            Some(TableEntry { keyed, found })
        })
    };
    let slashes: Vec<&str> = label.split('/').collect();
    // Parameters of ROS 2 may be written with dots.
    by(&slashes).or_else(|| by(&label.split(['/', '.']).collect::<Vec<_>>()))
}

/// The values of `#` and `*` if a path ends in a key; `None` if it does not.
fn matched(key: &str, path: &[&str]) -> Option<KeyWildcards> {
    let pattern: Vec<&str> = key.split('/').collect();
    let tail = path.get(path.len().checked_sub(pattern.len())?..)?;
    let mut found = KeyWildcards::default();
    for (pattern, part) in pattern.into_iter().zip(tail) {
        match pattern.split_once('#') {
            _ if pattern == "*" => found.words.push((*part).to_owned()),
            None if pattern == *part => {}
            None => return None,
            Some((before, behind)) => {
                let digits = part.strip_prefix(before)?.strip_suffix(behind)?;
                found.numbers.push(
                    digits
                        .bytes()
                        .all(|byte| byte.is_ascii_digit())
                        .then(|| digits.parse().ok())??,
                );
            }
        }
    }
    Some(found)
}

/// The dialect of a file: the first row whose marks its keys have.
pub(super) fn recognise(roots: &[Node], dialects: &Rows<Dialect>) -> Option<Arc<Dialect>> {
    let mut paths = Paths::default();
    for root in roots {
        paths.take(root, &mut Vec::new());
    }
    dialects
        .iter()
        .find(|row| row.marks.iter().any(|mark| paths.have(mark)))
        .cloned()
}

/// The paths of keys of a file, without their numbers and from the end to the root, with some of the texts under them.
#[derive(Default)]
struct Paths(BTreeMap<Vec<String>, BTreeSet<String>>);

/// A key without its numbers.
fn unnumbered(key: &str) -> String {
    let mut plain = String::with_capacity(key.len());
    for letter in key.chars() {
        if !letter.is_ascii_digit() {
            plain.push(letter);
        } else if !plain.ends_with('#') {
            plain.push('#');
        }
    }
    plain
}

impl Paths {
    fn take(&mut self, node: &Node, path: &mut Vec<String>) {
        match &node.kind {
            Kind::Scalar { .. } => {}
            Kind::Sequence(items) => {
                path.push("#".to_owned());
                for item in items.iter().filter(|item| item.text().is_none()) {
                    self.take(item, path);
                }
                path.pop();
            }
            Kind::Mapping(pairs) => {
                for (key, value) in pairs {
                    let Some(text) = key.text() else { continue };
                    let before = path.len();
                    path.extend(text.split('/').filter(|part| !part.is_empty()).map(unnumbered));
                    self.add(path, value);
                    self.take(value, path);
                    path.truncate(before);
                }
            }
        }
    }

    fn add(&mut self, path: &[String], value: &Node) {
        self.insert(path.iter().rev().cloned().collect(), value);
        // `a.b.c`, as parameters of ROS 2 are written, is recognised by its parts as well.
        if path.iter().any(|part| part.contains('.')) {
            let parts = path.iter().rev().flat_map(|part| part.rsplit('.'));
            self.insert(parts.map(str::to_owned).collect(), value);
        }
    }

    fn insert(&mut self, path: Vec<String>, value: &Node) {
        if self.0.len() >= MAX_PATHS && !self.0.contains_key(&path) {
            return;
        }
        let values = self.0.entry(path).or_default();
        if let Some(text) = value.text().filter(|text| text.len() <= MAX_VALUE)
            && values.len() < MAX_VALUES
        {
            values.insert(text.to_owned());
        }
    }

    /// Whether a line of marks matches: all its keys exist, and none of those after a `!`.
    fn have(&self, mark: &str) -> bool {
        mark.split('&').map(str::trim).all(|part| match part.strip_prefix('!') {
            Some(absent) => !self.has(absent),
            None => self.has(part),
        })
    }

    fn has(&self, mark: &str) -> bool {
        let (key, value) = mark
            .split_once('=')
            .map_or((mark, None), |(key, value)| (key, Some(value)));
        let pattern: Vec<String> = key.rsplit('/').map(unnumbered).collect();
        let end = pattern.get(..1).unwrap_or_default();
        let from_end = (Bound::Included(end), Bound::Unbounded);
        let ends_alike = self
            .0
            .range::<[String], _>(from_end)
            .take_while(|(path, _)| path.starts_with(end));
        let mut fits = ends_alike.filter(|(path, _)| {
            path.len() >= pattern.len()
                && path
                    .iter()
                    .zip(&pattern)
                    .all(|(part, wanted)| wanted == "*" || part == wanted)
        });
        fits.any(|(_, values)| value.is_none_or(|value| values.contains(value)))
    }
}
