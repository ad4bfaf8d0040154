//! Stray characters in names: the fault of a spelling, and the spelling without them.
//!
//! Must not know the world.

use unicode_normalization::{UnicodeNormalization, is_nfc};

use crate::visible::is_unseen;

/// Whether a character has no width or is a control character, so that two names can look the same and differ.
pub(crate) fn is_invisible(c: char) -> bool {
    (c.is_control() || is_unseen(c)) && !c.is_whitespace()
}

/// The name without what must not be in one: invisible characters, whitespace at its ends, slashes at its ends and doubled,
/// decomposed letters. Whitespace inside is kept.
pub(crate) fn clean(name: &str) -> String {
    if name
        .bytes()
        .all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.'))
    {
        return name.to_owned();
    }
    // ASCII is its own composition: nearly every name needs no tables.
    let visible: String = if name.is_ascii() {
        name.chars().filter(|c| !is_invisible(*c)).collect()
    } else {
        name.nfc().filter(|c| !is_invisible(*c)).collect()
    };
    visible
        .trim()
        .split('/')
        .map(str::trim)
        .filter(|segment| !segment.is_empty())
        .collect::<Vec<_>>()
        .join("/")
}

/// The name without case and stray characters, to find names that differ only by those.
pub(crate) fn loose(name: &str) -> String {
    clean(name).to_lowercase()
}

/// What is wrong with a name. The worst comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fault {
    /// A character without width, or a control character.
    Invisible,
    /// Whitespace at an end.
    BlankAtEnd,
    /// Whitespace inside.
    BlankInside,
    /// A slash at the end, or two in a row.
    Slashes,
    /// One slash at the start.
    LeadingSlash,
    /// Letters that NFC would compose.
    Decomposed,
}

impl Fault {
    /// The worst fault of a name.
    pub(crate) fn of(name: &str) -> Option<Self> {
        let body = name.strip_prefix('/').unwrap_or(name);
        if name.chars().any(is_invisible) {
            Some(Self::Invisible)
        } else if name.trim() != name {
            Some(Self::BlankAtEnd)
        } else if name.chars().any(char::is_whitespace) {
            Some(Self::BlankInside)
        } else if body.starts_with('/') || body.ends_with('/') || body.contains("//") || body.is_empty() {
            Some(Self::Slashes)
        } else if body.len() != name.len() {
            Some(Self::LeadingSlash)
        } else if !is_nfc(name) {
            Some(Self::Decomposed)
        } else {
            None
        }
    }

    /// The fault, as a predicate.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Invisible => "contains an invisible character",
            Self::BlankAtEnd => "starts or ends with whitespace",
            Self::BlankInside => "contains whitespace",
            Self::Slashes => "ends with a slash or contains a double slash",
            Self::LeadingSlash => "starts with a slash",
            Self::Decomposed => "contains letters that are not composed (Unicode NFC)",
        }
    }

    /// Its consequence, as a sentence.
    pub(crate) fn why(self) -> &'static str {
        match self {
            Self::LeadingSlash => {
                "tf2 removes the slash when storing a transform, but rejects a name with a slash in a look-up."
            }
            Self::Slashes => "tf2 removes one leading slash and compares the rest byte by byte.",
            _ => "tf2 compares names byte by byte: for tf2 this spelling and the clean one are two frames.",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cleaning_keeps_a_good_name() {
        assert_eq!(clean("robot1/base_link"), "robot1/base_link");
        assert_eq!(clean(" /lidar\u{200b}// "), "lidar");
        assert_eq!(clean("caf\u{65}\u{301}"), "caf\u{e9}");
        assert_eq!(clean("front lidar"), "front lidar");
    }
}
