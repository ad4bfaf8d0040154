//! Text from files and recordings in output: characters that control, reorder or hide text are escaped.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{BufWriter, Write};

use serde::Serialize;

/// Characters that would control a terminal, end a line, reorder its text or are invisible, in text from a file or a bag.
fn steers(c: char) -> bool {
    (c.is_control() && c != '\n' && c != '\t') || is_unseen(c)
}

/// Characters that are not controls and have no width or shape of their own: Unicode's `Default_Ignorable_Code_Point`, its marks of direction,
/// of annotations and of lines among them.
pub(crate) fn is_unseen(c: char) -> bool {
    matches!(c,
        '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}'..='\u{1160}' | '\u{17b4}'..='\u{17b5}' | '\u{180b}'..='\u{180f}'
        | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{3164}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}'
        | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}' | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e0fff}')
}

/// Whether a text may have any: nearly all are printable ASCII, which is quickly checked.
fn may_steer(text: &str) -> bool {
    let is_plain = |byte: &u8| matches!(byte, b' '..=b'~' | b'\n' | b'\t');
    !text.as_bytes().iter().all(is_plain)
}

/// The text with control characters escaped (`\u{1b}`). Newlines and tabs stay.
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

/// Writes a value as indented JSON that ends with a newline. Characters that control or hide text are written as `\uXXXX`: a parser gets
/// the original characters, and they are visible in the file.
pub(crate) fn write_json(value: &impl Serialize, to: &mut dyn Write) -> serde_json::Result<()> {
    let mut to = EscapeWriter(BufWriter::with_capacity(1 << 16, to));
    serde_json::to_writer_pretty(&mut to, value)?;
    to.write_all(b"\n")
        .and_then(|()| to.flush())
        .map_err(serde_json::Error::io)
}

/// The same as a text.
pub(crate) fn pretty_json(value: &impl Serialize) -> serde_json::Result<String> {
    text(|to| write_json(value, to))
}

/// As [`pretty_json`], on one line.
pub(crate) fn json_line(value: &impl Serialize) -> serde_json::Result<String> {
    text(|to| {
        serde_json::to_writer(EscapeWriter(&mut *to), value)?;
        to.push(b'\n');
        Ok(())
    })
}

/// The written bytes, as a text.
pub(crate) fn text(write: impl FnOnce(&mut Vec<u8>) -> serde_json::Result<()>) -> serde_json::Result<String> {
    let mut bytes = Vec::new();
    write(&mut bytes)?;
    String::from_utf8(bytes).map_err(|error| serde_json::Error::io(std::io::Error::other(error)))
}

/// Escapes characters of JSON on its way to a writer, piece by piece. A piece of JSON is whole characters; outside of strings it has none
/// that are escaped.
struct EscapeWriter<W>(W);

impl<W: Write> Write for EscapeWriter<W> {
    fn write(&mut self, piece: &[u8]) -> std::io::Result<usize> {
        match std::str::from_utf8(piece) {
            Ok(text) if may_steer(text) && text.chars().any(steers) => {
                let mut spelled = String::with_capacity(text.len() + 8);
                for c in text.chars() {
                    if steers(c) {
                        for unit in c.encode_utf16(&mut [0; 2]) {
                            let _ = write!(spelled, "\\u{unit:04x}");
                        }
                    } else {
                        spelled.push(c);
                    }
                }
                self.0.write_all(spelled.as_bytes())?;
            }
            _ => self.0.write_all(piece)?,
        }
        Ok(piece.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
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
            "tag\u{e0041}",
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
