//! Names of transforms as written in code: with marks of members, words for which value it is, and verbs of getters.

use crate::world::transform_name::{self, NamePart, NameStyle, TransformName};

/// Calls that put transforms into another type.
pub(super) const WRAPS: [&str; 22] = [
    "SE3",
    "SE3d",
    "SE3f",
    "SO3",
    "SO3d",
    "SO3f",
    "Isometry3d",
    "Isometry3f",
    "Isometry3",
    "Affine3d",
    "Matrix4d",
    "Matrix4f",
    "Matrix3d",
    "Pose3",
    "Rot3",
    "Rigid3d",
    "array",
    "asarray",
    "matrix",
    "Transform",
    "Transformation",
    "Some",
];
/// Words after a name that state which value of it this is.
const VALUES: [&str; 20] = [
    "est",
    "estimated",
    "gt",
    "guess",
    "prior",
    "init",
    "initial",
    "meas",
    "measured",
    "opt",
    "optimized",
    "tmp",
    "temp",
    "raw",
    "old",
    "new",
    "corrected",
    "eigen",
    "mat",
    "ptr",
];

/// Verbs before the name of what a function returns.
const GETTERS: [&str; 6] = ["get", "compute", "calc", "lookup", "make", "estimate"];
/// Marks between or before two frames.
const MARKS: [&str; 4] = ["T", "R", "SE3", "H"];

/// The transform that a name in code describes. Names with `to` are skipped: projects disagree on their direction.
pub(super) fn named(spelled: &str) -> Option<TransformName> {
    let trimmed = spelled.strip_prefix("m_").unwrap_or(spelled).trim_matches('_');
    let mut words: Vec<&str> = trimmed.split('_').filter(|word| !word.is_empty()).collect();
    let has = |wanted: &str| words.iter().any(|word| word.eq_ignore_ascii_case(wanted));
    if WRAPS.contains(&spelled) || has("from") && has("to") {
        return None;
    }
    // `get_T_M_I`, `getVertex_T_G_I`
    let is_getter = |word: &str| GETTERS.iter().any(|getter| word.to_lowercase().starts_with(getter));
    let mark = words.iter().position(|word| MARKS.contains(word));
    match mark {
        Some(at) if at > 0 && words.len() > at + 2 => {
            if words.first().is_some_and(|word| is_getter(word)) {
                words.drain(..at);
            } else if !words.get(at + 2..).unwrap_or_default().iter().all(|word| belongs(word)) {
                // `old_T_world_imu`: a frame of two words, or a word before `T_world_imu`?
                return None;
            }
        }
        _ => {}
    }
    let mut is_inverse = false;
    while words.len() > 2 {
        let last = words.last()?.to_lowercase();
        let is_turn = matches!(last.as_str(), "inv" | "inverse");
        if !is_turn && !VALUES.contains(&last.as_str()) && !is_index(&words) {
            break;
        }
        is_inverse ^= is_turn;
        words.pop();
    }
    let name = transform_name::parse(&words.join("_"))?;
    // Vectors are in one frame; `p_in_cam` does not name two.
    if name.style == NameStyle::To || name.part == NamePart::Translation {
        return None;
    }
    // With one letter for a frame, or no mark between the two, names are ambiguous.
    let is_plain = matches!(name.style, NameStyle::Infix | NameStyle::From) && !name.is_letters();
    let name = TransformName {
        ambiguous: name.ambiguous || !is_plain,
        ..name
    };
    Some(if is_inverse { name.inverse() } else { name })
}

/// Whether a word after a frame's first word belongs to it: `base_link`, `camera_left`, `body_k`.
fn belongs(word: &str) -> bool {
    is_counter(word)
        || transform_name::is_glued(word)
        || matches!(word, "prev" | "curr")
        || VALUES.contains(&word)
        || matches!(word, "inv" | "inverse")
}

/// Whether the last word counts which one this is: `T_WS_k`, `T_w_c_i`, `map_T_odom_1`.
fn is_index(words: &[&str]) -> bool {
    let [first, rest @ .., last] = words else { return false };
    let is_mark = matches!(*first, "T" | "R" | "H");
    match rest {
        // Two letters name two frames, and what follows distinguishes values: `T_WS_init`.
        [pair] => {
            let is_pair = pair.len() == 2 && pair.bytes().all(|byte| byte.is_ascii_uppercase());
            is_mark && is_pair && last.starts_with(|letter: char| !letter.is_ascii_uppercase())
        }
        _ => is_counter(last) && rest.len() >= 2,
    }
}

/// Whether a word counts: digits, or a letter that indices have.
fn is_counter(word: &str) -> bool {
    word.bytes().all(|byte| byte.is_ascii_digit()) || matches!(word, "i" | "j" | "k" | "n" | "t")
}
