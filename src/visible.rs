//! Text from files and recordings where people see it: characters that steer, reorder or hide are spelled out.

use std::borrow::Cow;
use std::fmt::Write;

use serde::Serialize;

/// Characters that would steer a terminal, end a line, reorder what stands on it or cannot be seen, in text that comes from a file or a bag.
fn steers(c: char) -> bool {
    (c.is_control() && c != '\n' && c != '\t')
        || matches!(c, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
}

/// Whether a text may have any: nearly all have printable ASCII alone, and that is quickly seen.
fn may_steer(text: &str) -> bool {
    let is_plain = |byte: &u8| matches!(byte, b' '..=b'~' | b'\n' | b'\t');
    !text.as_bytes().iter().all(is_plain)
}

/// The text with control characters spelled out (`\u{1b}`). Newlines and tabs stay.
pub(crate) fn clean(text: &str) -> Cow<'_, str> {
    if !may_steer(text) || !text.chars().any(steers) {
        return Cow::Borrowed(text);
    }
    let mut cleaned = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if steers(c) {
            cleaned.extend(c.escape_unicode());
        } else {
            cleaned.push(c);
        }
    }
    Cow::Owned(cleaned)
}

/// The text with every control character replaced by as many `?` as it has bytes, so that offsets stay; `None` where
/// there is nothing to replace. A carriage return before a newline stays.
pub(crate) fn clean_in_place(text: &str) -> Option<String> {
    let lone_return = |offset: usize| text.as_bytes().get(offset + 1) != Some(&b'\n');
    let bad = |(offset, c): (usize, char)| if c == '\r' { lone_return(offset) } else { steers(c) };
    if !may_steer(text) || !text.char_indices().any(bad) {
        return None;
    }
    let mut cleaned = String::with_capacity(text.len());
    for (offset, c) in text.char_indices() {
        if bad((offset, c)) {
            cleaned.extend(std::iter::repeat_n('?', c.len_utf8()));
        } else {
            cleaned.push(c);
        }
    }
    Some(cleaned)
}

/// A value as indented JSON that ends with a newline. Characters that steer or hide are written as `\uXXXX`: a reader of the value gets them as
/// they are, who looks at the file sees them.
pub(crate) fn pretty_json(value: &impl Serialize) -> Result<String, serde_json::Error> {
    Ok(spelled_out(serde_json::to_string_pretty(value)?))
}

/// As [`pretty_json`], on one line.
pub(crate) fn json_line(value: &impl Serialize) -> Result<String, serde_json::Error> {
    Ok(spelled_out(serde_json::to_string(value)?))
}

/// Outside of strings JSON has none of these characters, and all of them lie in the first plane.
fn spelled_out(mut json: String) -> String {
    if may_steer(&json) && json.chars().any(steers) {
        let mut spelled = String::with_capacity(json.len() + 64);
        for c in json.chars() {
            if steers(c) {
                let _ = write!(spelled, "\\u{:04x}", u32::from(c));
            } else {
                spelled.push(c);
            }
        }
        json = spelled;
    }
    json.push('\n');
    json
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        assert_eq!(clean("a\u{1b}[31m\tb"), "a\\u{1b}[31m\tb");
        assert_eq!(clean("li\u{200b}dar\u{2028}"), "li\\u{200b}dar\\u{2028}");
        assert_eq!(clean_in_place("a\r\nb").as_deref(), None);
        assert_eq!(clean_in_place("é\u{1b}\rx\u{202e}").as_deref(), Some("é??x???"));
    }

    #[test]
    fn a_reader_of_json_gets_what_a_person_sees_spelled_out() {
        let names = [
            "a\u{202e}b",
            "zero\u{200b}width",
            "c1\u{9b}",
            "del\u{7f}",
            "line\u{2028}end",
            "plain é",
        ];
        for written in [pretty_json(&names).unwrap(), json_line(&names).unwrap()] {
            assert!(!written.chars().any(steers), "{written}");
            assert!(
                written.contains("a\\u202eb") && written.contains("plain é"),
                "{written}"
            );
            assert_eq!(serde_json::from_str::<Vec<String>>(&written).unwrap(), names);
        }
    }
}
