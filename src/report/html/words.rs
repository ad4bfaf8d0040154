//! Texts of files in a page: cleaned, cut, and with text between backticks as code. Everything from inputs passes through here or
//! through `maud`, which escapes it.

use std::fmt::Write;

use maud::{Markup, html};

use crate::verdict::Outcome;

use super::super::text::clean;

/// Maximum number of characters of a text: a hostile file may have a name of a megabyte.
const LONGEST: usize = 1500;

/// A text for a page: control characters escaped, cut if it is too long.
pub(super) fn plain(text: &str) -> String {
    let mut shown: String = text.chars().take(LONGEST).collect();
    let count = text.chars().count();
    if count > LONGEST {
        let _ = write!(shown, "… ({count} characters)");
    }
    // Code points that are not characters in HTML.
    let is_none = |c: char| matches!(c, '\u{fdd0}'..='\u{fdef}') || u32::from(c) & 0xfffe == 0xfffe;
    clean(&shown).replace(is_none, "\u{fffd}")
}

/// Words with code between backticks.
pub(super) fn words(text: &str) -> Markup {
    let text = plain(text);
    let parts: Vec<&str> = text.split('`').collect();
    // An unpaired backtick opens nothing.
    let closed = if parts.len().is_multiple_of(2) {
        parts.len() - 1
    } else {
        parts.len()
    };
    html! {
        @for (index, part) in parts.iter().enumerate() {
            @if index >= closed { "`" (part) }
            @else if index % 2 == 1 { code { (part) } }
            @else { (part) }
        }
    }
}

/// The outcome of a check: class, sign and word. The sign never appears alone.
pub(super) fn outcome(outcome: Outcome) -> (&'static str, &'static str, &'static str) {
    match outcome {
        Outcome::Pass => ("pass", "✓", "passed"),
        Outcome::Fail => ("fail", "✗", "failed"),
        Outcome::NotEvaluated => ("open", "–", "not evaluated"),
        Outcome::Waived => ("waived", "⊘", "waived"),
        Outcome::Explained => ("waived", "→", "explained"),
        Outcome::Crashed => ("crashed", "!", "crashed"),
    }
}

/// Failures come first.
pub(super) fn rank(outcome: Outcome) -> usize {
    match outcome {
        Outcome::Crashed => 0,
        Outcome::Fail => 1,
        Outcome::Explained | Outcome::Waived => 2,
        Outcome::Pass => 3,
        Outcome::NotEvaluated => 4,
    }
}

/// A sign and a word in the colour of a class.
pub(super) fn badge(class: &str, sign: &str, word: &str) -> Markup {
    html! {
        span class={ "badge " (class) } { span class="sign" aria-hidden="true" { (sign) } " " (word) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_files_say_is_no_markup() {
        assert_eq!(
            words("`a<b>` & \"c\" 'd' `e").into_string(),
            "<code>a&lt;b&gt;</code> &amp; &quot;c&quot; 'd' `e"
        );
        assert_eq!(words("").into_string(), "");
        assert_eq!(
            plain("a\u{1b}[2J\u{0}\u{202e}\u{fffe}b"),
            "a\\u{1b}[2J\\u{0}\\u{202e}\u{fffd}b"
        );
    }

    #[test]
    fn long_texts_are_cut_and_say_so() {
        let shown = plain(&"é".repeat(2_000_000));
        assert!(shown.len() < 4000 && shown.ends_with("… (2000000 characters)"));
    }
}
