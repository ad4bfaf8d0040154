//! Bytes to text: one decoder for every text source, so that byte spans mean the same to every reader.
//!
//! Owns encodings. Must not know formats.

/// How many NUL characters a text may contain before it counts as binary: a few real files have remains of a buffer
/// after their end.
const NULS_IN_TEXT: usize = 8;

/// Decodes the bytes of a text file, with a note if the encoding is unusual.
///
/// UTF-8 with or without a byte order mark and UTF-16 with one (or opening with `<` or two ASCII characters) are taken; bytes that are not
/// UTF-8 but look like text are read as Latin-1. The byte order mark is not part of the text: spans count in the
/// returned string.
///
/// # Errors
///
/// A line that states what the bytes look like and at which byte, if they are not a text.
pub fn decode(bytes: Vec<u8>) -> Result<(String, Option<String>), String> {
    match bytes.as_slice() {
        [0xEF, 0xBB, 0xBF, rest @ ..] => return decode_bytes(rest.to_vec(), 3),
        [0xFF, 0xFE, 0, 0, ..] | [0, 0, 0xFE, 0xFF, ..] => {
            return Err("the file is UTF-32 (byte 0), which is not supported: save it as UTF-8".to_owned());
        }
        [0xFF, 0xFE, rest @ ..] => return utf16(rest, u16::from_le_bytes),
        [0xFE, 0xFF, rest @ ..] => return utf16(rest, u16::from_be_bytes),
        [b'<', 0, ..] | [1..=0x7F, 0, 1..=0x7F, 0, ..] => return utf16(&bytes, u16::from_le_bytes),
        [0, b'<', ..] | [0, 1..=0x7F, 0, 1..=0x7F, ..] => return utf16(&bytes, u16::from_be_bytes),
        _ => {}
    }
    decode_bytes(bytes, 0)
}

fn decode_bytes(bytes: Vec<u8>, skipped: usize) -> Result<(String, Option<String>), String> {
    if let Some(offset) = binary_at(&bytes) {
        let offset = offset + skipped;
        return Err(format!(
            "not a text file: it contains control characters, the first at byte {offset}"
        ));
    }
    let nul = memchr::memchr(0, &bytes);
    let nul_note = nul.map(|offset| format!("a NUL character at byte {}", offset + skipped));
    match String::from_utf8(bytes) {
        Ok(text) => Ok((text, nul_note)),
        Err(error) => {
            let offset = error.utf8_error().valid_up_to() + skipped;
            let text = error.as_bytes().iter().map(|byte| char::from(*byte)).collect();
            Ok((text, Some(format!("not UTF-8 (byte {offset}); read as Latin-1"))))
        }
    }
}

/// The first control character of bytes that are not a text. Tabs, line ends, form feeds, escapes and up to
/// [`NULS_IN_TEXT`] NULs are text.
fn binary_at(bytes: &[u8]) -> Option<usize> {
    // Whole blocks at once: nearly every text has no odd byte at all.
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "without a jump the compiler takes many bytes at once"
    )]
    let is_common = |byte: &u8| (*byte >= 0x20) | (*byte == b'\t') | (*byte == b'\n') | (*byte == b'\r');
    if bytes
        .chunks(64)
        .all(|block| block.iter().fold(true, |all, byte| all & is_common(byte)))
    {
        return None;
    }
    let is_odd = |byte: u8| byte < 0x20 && !matches!(byte, 0 | b'\t' | b'\n' | b'\r' | 0x0B | 0x0C | 0x1B);
    let (nuls, odd) = bytes.iter().fold((0, 0), |(nuls, odd), byte| {
        (nuls + usize::from(*byte == 0), odd + usize::from(is_odd(*byte)))
    });
    // One stray control character in a long text is an editor's mistake; many, or any together with NULs, are a binary file.
    let is_binary = nuls > NULS_IN_TEXT || (nuls > 0 && odd > 0) || odd > 4 + bytes.len() / 1000;
    if !is_binary {
        return None;
    }
    bytes.iter().position(|byte| *byte == 0 || is_odd(*byte))
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<(String, Option<String>), String> {
    let units = bytes.chunks_exact(2).filter_map(|pair| match pair {
        [first, second] => Some(unit([*first, *second])),
        _ => None,
    });
    let mut text = String::with_capacity(bytes.len() / 2);
    for (index, decoded) in char::decode_utf16(units).enumerate() {
        match decoded {
            Ok(c) => text.push(c),
            Err(_) => return Err(format!("invalid UTF-16 at character {}", index + 1)),
        }
    }
    if bytes.len() % 2 == 1 {
        return Err(format!(
            "invalid UTF-16: the last of {} bytes is half a character",
            bytes.len()
        ));
    }
    Ok((text, Some("read as UTF-16".to_owned())))
}

#[cfg(test)]
mod tests {
    fn decode(bytes: &[u8]) -> Result<(String, Option<String>), String> {
        super::decode(bytes.to_vec())
    }

    #[test]
    fn utf8_is_taken_as_it_stands_and_a_byte_order_mark_is_dropped() {
        assert_eq!(decode("é\n".as_bytes()), Ok(("é\n".to_owned(), None)));
        assert_eq!(decode(b"\xEF\xBB\xBF<a/>"), Ok(("<a/>".to_owned(), None)));
        assert_eq!(decode(b""), Ok((String::new(), None)));
    }

    #[test]
    fn utf16_is_known_by_its_mark_or_its_first_character() {
        let utf16: Vec<u8> = "<é/>".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let marked: Vec<u8> = [0xFF, 0xFE].into_iter().chain(utf16.clone()).collect();
        assert_eq!(decode(&marked).unwrap().0, "<é/>");
        assert_eq!(decode(&utf16).unwrap().0, "<é/>");
        let big: Vec<u8> = "\u{FEFF}<é/>".encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!(decode(&big).unwrap().0, "<é/>");
        assert_eq!(decode(b"a\0:\0 \0\xE9\0").unwrap().0, "a: é");
        assert!(decode(b"\xFF\xFE\0\0a\0\0\0").unwrap_err().contains("UTF-32"));
        assert!(decode(b"\xFF\xFE<\0a").unwrap_err().contains("half a character"));
        assert!(decode(b"\xFF\xFE\x00\xD8a\0").unwrap_err().contains("character 1"));
    }

    #[test]
    fn latin1_is_read_with_a_note() {
        let (text, note) = decode(b"caf\xE9").unwrap();
        assert_eq!(text, "café");
        assert!(note.unwrap().contains("byte 3"), "the note names the byte");
    }

    #[test]
    fn binary_is_refused_with_its_first_byte() {
        let mut bytes = b"MCAP".to_vec();
        bytes.extend([0, 1, 2, 3].repeat(10));
        assert!(decode(&bytes).unwrap_err().contains("byte 4"));
        assert!(decode(&[0; 64]).is_err(), "zeros alone are no text");
    }

    #[test]
    fn a_stray_nul_does_not_make_a_text_binary() {
        let (text, note) = decode(b"<robot/>\n\0 rest").unwrap();
        assert!(text.starts_with("<robot/>"));
        assert!(note.unwrap().contains("byte 9"));
    }
}
