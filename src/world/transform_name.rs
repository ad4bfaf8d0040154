//! The grammar of transform names: which two frames a name such as `map_T_lidar` names, and in which direction.
//!
//! Pure text: no files, no numbers. A name shows what its author meant, not what the numbers are: the caller decides
//! how far to trust it (see [`TransformName::ambiguous`]).

use serde::{Deserialize, Serialize};

/// How a name is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NameStyle {
    /// `A_T_B`, `A_R_B`, `A_SE3_B`: `p_A = A_T_B p_B`.
    Infix,
    /// `T_A_B`, `R_A_B`: `p_A = T_A_B p_B`.
    Prefix,
    /// `A_from_B`: `p_A = A_from_B p_B`.
    From,
    /// `A_to_B`, `A2B`, `IMUtoACC`. Read as `p_B = T p_A`; the direction of "to" is not agreed between projects.
    To,
    /// `T_BS`, `Tbc`, `wTc`: one letter a frame.
    Letters,
}

/// The part of a rigid transform that a name means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NamePart {
    /// The whole transform.
    Whole,
    /// Only its rotation (`R_A_B`).
    Rotation,
    /// Only its translation (`A_t_B`): the origin of B in A.
    Translation,
}

/// A parsed name of a transform `target_from_source`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct TransformName {
    /// The frame to which points are taken, as spelled.
    pub target: String,
    /// The frame from which points are taken, as spelled.
    pub source: String,
    /// How the name is built.
    pub style: NameStyle,
    /// The part of the transform that it means.
    pub part: NamePart,
    /// Whether the frames or the direction are ambiguous: always for "to", for names of letters without a
    /// separator, and where a frame of several words had to be guessed (`T_base_link_lidar`).
    pub ambiguous: bool,
}

impl TransformName {
    /// The name of the inverse transform.
    #[must_use]
    pub fn inverse(self) -> Self {
        Self {
            target: self.source,
            source: self.target,
            ..self
        }
    }

    /// Whether both frames are single letters, perhaps numbered (`B`, `c1`): symbols of a formula, not names.
    pub fn is_letters(&self) -> bool {
        is_letter(&self.target) && is_letter(&self.source)
    }
}

/// Words at the end of a name that name no frames: what is stored, and how.
#[rustfmt::skip]
const TRAILING: &[&str] = &[
    "transform", "tf", "matrix", "mat", "extrinsic", "extrinsics", "calib", "calibration", "param", "params",
    "xyzw", "wxyz", "deg", "degrees", "rad", "mm", "m", "data",
];
/// Words at the end that name a part of the transform.
const TRAILING_ROTATION: &[&str] = &["rot", "rotation", "quat", "quaternion", "rpy", "euler", "q"];
const TRAILING_TRANSLATION: &[&str] = &["trans", "translation", "xyz", "position", "offset"];
/// Words at the start of a name that name no frames.
const LEADING: &[&str] = &[
    "extrinsic",
    "extrinsics",
    "extr",
    "ext",
    "calib",
    "calibration",
    "tf",
    "static",
];
/// Words that are not a frame by themselves and belong to the word before them.
const GLUED: &[&str] = &["link", "frame", "optical", "footprint"];
/// Words of a side, which belong to the word before them (`camera_left`), or after that of a platform to the word behind them.
const SIDES: &[&str] = &["left", "right", "front", "rear", "center", "top"];
/// Words of the platform itself, which has no left and no right one: `T_base_rear_lidar` is of the rear lidar.
const PLATFORMS: &[&str] = &["base", "body", "vehicle", "ego", "robot", "car"];

/// Whether a word is not a frame by itself and belongs to the word before it (`base_link`, `camera_left`).
pub(crate) fn is_glued(word: &str) -> bool {
    GLUED.contains(&word) || SIDES.contains(&word)
}

/// Three-letter words that only look like `Tbc` or `TAB`.
#[rustfmt::skip]
const WORDS: &[&str] = &[
    "tof", "tag", "tau", "tcp", "top", "tip", "ton", "two", "the", "try", "ten", "tls", "ttl", "ttc", "tdc",
    "tts", "run", "raw", "rot", "row", "rad", "rgb", "rpy", "res", "rel", "ros", "red", "ref", "rms", "rgt",
    "rev", "rmt", "rng", "pos", "per", "pad", "pre", "pid", "pix", "pan", "par", "pin", "pwm", "png", "pcd",
    "pub", "pts", "ply", "put", "psi",
];

/// Parses a name. Of a path (`IMU.T_b_c1`, `a/T_a_b`) only the last part is read. `None` if the name does not
/// name two frames, or if it is not clear where one frame ends and the other begins.
///
/// ```
/// use frames_lint::world::transform_name::parse;
/// let name = parse("map_T_lidar").unwrap();
/// assert_eq!((name.target.as_str(), name.source.as_str()), ("map", "lidar"));
/// ```
pub fn parse(key: &str) -> Option<TransformName> {
    let key = key.trim().rsplit(['/', '.']).next()?;
    if key.len() > 200 || !key.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-') {
        return None;
    }
    let mut words = split(key);
    let mut part = NamePart::Whole;
    while words.len() > 2 {
        let last = words.last()?.text.to_lowercase();
        if TRAILING_ROTATION.contains(&last.as_str()) {
            part = if part == NamePart::Translation {
                NamePart::Whole
            } else {
                NamePart::Rotation
            };
        } else if TRAILING_TRANSLATION.contains(&last.as_str()) || (last == "t" && part != NamePart::Whole) {
            part = if part == NamePart::Rotation {
                NamePart::Whole
            } else {
                NamePart::Translation
            };
        } else if !TRAILING.contains(&last.as_str()) {
            break;
        }
        words.pop();
    }
    while words.len() > 2 && LEADING.contains(&words.first()?.text.to_lowercase().as_str()) {
        words.remove(0);
    }
    // `T_..._t_xyz_q_xyzw` ends in a translation mark that the loop above leaves when a rotation followed it.
    if words.len() > 3 && words.last()?.text == "t" {
        words.pop();
    }
    let name = from(key, &words)
        .or_else(|| to(key, &words))
        .or_else(|| infix(key, &words))
        .or_else(|| prefix(key, &words))
        .or_else(|| compact(&words))?;
    let part = if name.part == NamePart::Whole { part } else { name.part };
    (name.target != name.source).then_some(TransformName { part, ..name })
}

/// A word of a name and its position in it.
#[derive(Clone, Copy)]
struct Word<'a> {
    text: &'a str,
    start: usize,
    end: usize,
}

fn split(key: &str) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    let mut start = 0;
    for piece in key.split(['_', '-']) {
        let end = start + piece.len();
        if !piece.is_empty() {
            words.push(Word {
                text: piece,
                start,
                end,
            });
        }
        start = end + 1;
    }
    words
}

/// The text from the first to the last word, as spelled.
fn spelled<'a>(key: &'a str, words: &[Word<'_>]) -> Option<&'a str> {
    let text = key.get(words.first()?.start..words.last()?.end)?;
    text.starts_with(char::is_alphabetic).then_some(text)
}

fn name(target: &str, source: &str, style: NameStyle, part: NamePart, ambiguous: bool) -> TransformName {
    TransformName {
        target: target.to_owned(),
        source: source.to_owned(),
        style,
        part,
        ambiguous,
    }
}

/// The part that a mark of a transform means (`T`, `R`, `t`).
fn mark(word: &str) -> Option<NamePart> {
    match word {
        "T" | "Tr" | "TF" | "Tf" | "SE3" | "H" => Some(NamePart::Whole),
        "R" | "Rot" | "rot" | "SO3" => Some(NamePart::Rotation),
        "t" | "p" | "trans" => Some(NamePart::Translation),
        _ => None,
    }
}

/// Removes a mark in front of frames (`T_imu_from_lidar`), if words remain.
fn unmarked<'w, 'k>(words: &'w [Word<'k>]) -> (&'w [Word<'k>], NamePart) {
    match words {
        [first, rest @ ..] if !rest.is_empty() => match mark(first.text) {
            Some(part) => (rest, part),
            None => (words, NamePart::Whole),
        },
        _ => (words, NamePart::Whole),
    }
}

/// Splits the words at the only one of them that is `at`.
fn around<'w, 'k>(words: &'w [Word<'k>], at: impl Fn(&str) -> bool) -> Option<(&'w [Word<'k>], &'w [Word<'k>])> {
    let mut places = words.iter().enumerate().filter(|(_, word)| at(word.text));
    let (index, _) = places.next()?;
    if places.next().is_some() {
        return None;
    }
    let (before, rest) = words.split_at_checked(index)?;
    let after = rest.get(1..)?;
    (!before.is_empty() && !after.is_empty()).then_some((before, after))
}

fn from(key: &str, words: &[Word<'_>]) -> Option<TransformName> {
    let (before, after) = around(words, |word| word.eq_ignore_ascii_case("from"))?;
    let (before, part) = unmarked(before);
    Some(name(
        spelled(key, before)?,
        spelled(key, after)?,
        NameStyle::From,
        part,
        false,
    ))
}

fn to(key: &str, words: &[Word<'_>]) -> Option<TransformName> {
    if let Some((before, after)) = around(words, |word| word.eq_ignore_ascii_case("to") || word == "2") {
        let (before, part) = unmarked(before);
        return Some(name(
            spelled(key, after)?,
            spelled(key, before)?,
            NameStyle::To,
            part,
            true,
        ));
    }
    let (rest, part) = unmarked(words);
    let text = spelled(key, rest)?;
    let (source, target) = joined_to(text)?;
    Some(name(target, source, NameStyle::To, part, true))
}

/// `lidar2cam`, `lidarToCam`, `IMUtoACC` as (before, after).
fn joined_to(text: &str) -> Option<(&str, &str)> {
    let ascii = text.is_ascii();
    let mut found = None;
    for (index, _) in text.char_indices().skip(1) {
        let (before, rest) = text.split_at_checked(index)?;
        let last = before.chars().next_back()?;
        let after = if let Some(after) = rest.strip_prefix('2') {
            let next = after.chars().next();
            let word = last.is_alphabetic() && next.is_some_and(char::is_alphabetic);
            // `2d` and `3d` are dimensions.
            let dimension = after.len() == 1 || after.get(..2).is_some_and(|s| s.eq_ignore_ascii_case("d_"));
            (word && !dimension).then_some(after)
        } else if let Some(after) = rest.strip_prefix("To") {
            (last.is_lowercase() && after.starts_with(char::is_uppercase)).then_some(after)
        } else if let Some(after) = rest.strip_prefix("to") {
            (last.is_uppercase() && after.starts_with(char::is_uppercase)).then_some(after)
        } else {
            None
        };
        if let Some(after) = after {
            if found.is_some() {
                return None;
            }
            found = Some((before, after));
        }
    }
    found.filter(|_| ascii)
}

fn infix(key: &str, words: &[Word<'_>]) -> Option<TransformName> {
    let whole = |word: &str| matches!(word, "T" | "SE3");
    let (before, after, part) = if let Some((before, after)) = around(words, whole) {
        (before, after, NamePart::Whole)
    } else if let Some((before, after)) = around(words, |word| word == "R") {
        (before, after, NamePart::Rotation)
    } else {
        let (before, after) = around(words, |word| word == "t").filter(|_| words.len() == 3)?;
        (before, after, NamePart::Translation)
    };
    Some(name(
        spelled(key, before)?,
        spelled(key, after)?,
        NameStyle::Infix,
        part,
        false,
    ))
}

fn prefix(key: &str, words: &[Word<'_>]) -> Option<TransformName> {
    let (first, rest) = words.split_first()?;
    let part = mark(first.text)?;
    if let [letters] = rest {
        let (target, source) = two_letters(letters.text)?;
        return Some(name(target, source, NameStyle::Letters, part, false));
    }
    if let [target, source] = rest {
        let (target, source) = (spelled(key, &[*target])?, spelled(key, &[*source])?);
        return Some(name(target, source, NameStyle::Prefix, part, false));
    }
    // A frame may have several words: `T_base_link_camera_left`.
    let is_one_of = |word: &Word<'_>, list: &[&str]| list.contains(&word.text.to_lowercase().as_str());
    let is_side = |word: &Word<'_>| is_one_of(word, SIDES);
    let is_of_a_platform = |frame: &[Word<'_>]| frame.first().is_some_and(|word| is_one_of(word, PLATFORMS));
    let mut frames: Vec<Vec<Word<'_>>> = Vec::new();
    for word in rest {
        let is_number = word.text.chars().all(|c| c.is_ascii_digit());
        match frames.last_mut() {
            Some(frame) if frame.iter().all(is_side) => frame.push(*word),
            Some(frame) if is_side(word) && !is_of_a_platform(frame) => frame.push(*word),
            Some(frame) if is_one_of(word, GLUED) || is_number => frame.push(*word),
            _ => frames.push(vec![*word]),
        }
    }
    let [target, source] = frames.as_slice() else {
        return None;
    };
    Some(name(
        spelled(key, target)?,
        spelled(key, source)?,
        NameStyle::Prefix,
        part,
        true,
    ))
}

/// `BS`, `BC0`, `ic`: two letters of one case, the second perhaps numbered.
fn two_letters(text: &str) -> Option<(&str, &str)> {
    let (target, source) = text.split_at_checked(1)?;
    let case = |c: char| c.is_ascii_uppercase();
    let (a, b) = (target.chars().next()?, source.chars().next()?);
    let letters = a.is_ascii_alphabetic() && is_letter(source) && case(a) == case(b);
    letters.then_some((target, source))
}

/// One letter, perhaps followed by a number.
fn is_letter(frame: &str) -> bool {
    let mut chars = frame.chars();
    chars.next().is_some_and(|c| c.is_ascii_alphabetic()) && chars.all(|c| c.is_ascii_digit())
}

/// `Tbc`, `TAB`, `Rcl`, `Pcl`, `wTc`: a name of one word.
fn compact(words: &[Word<'_>]) -> Option<TransformName> {
    let [word] = words else { return None };
    let text = word.text;
    if !text.is_ascii() || WORDS.contains(&text.to_lowercase().as_str()) {
        return None;
    }
    let letters = |c: char| match c {
        'T' => Some(NamePart::Whole),
        'R' => Some(NamePart::Rotation),
        'P' | 'p' | 't' => Some(NamePart::Translation),
        _ => None,
    };
    let (first, rest) = (text.chars().next()?, text.get(1..)?);
    let second = rest.chars().next()?;
    // `wTc`, `bTc1`: a lower-case frame, the mark, a lower-case frame.
    if let (true, Some(part @ (NamePart::Whole | NamePart::Rotation))) = (first.is_ascii_lowercase(), letters(second)) {
        let source = rest.get(1..)?;
        if second.is_ascii_uppercase() && is_letter(source) && source.starts_with(|c: char| c.is_ascii_lowercase()) {
            return Some(name(text.get(..1)?, source, NameStyle::Letters, part, true));
        }
    }
    let part = letters(first)?;
    let (target, source) = two_letters(rest)?;
    // Capitals after anything but a T are acronyms.
    let plausible = second.is_ascii_lowercase() || part == NamePart::Whole;
    plausible.then(|| name(target, source, NameStyle::Letters, part, true))
}

#[cfg(test)]
mod tests;
