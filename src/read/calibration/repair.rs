//! Repairs of text that is nearly YAML or nearly JSON, so that it can be read as other readers do.
//!
//! OpenCV's reader accepts files that YAML forbids: `%YAML:1.0` without `---`, `key:[1, 2]` and `key:!!opencv-matrix`
//! without a space, words after a tag, tabs, ragged indentation. Owns the edits and the map back to the source's
//! offsets; never adds, removes or reorders values. Knows nothing of transforms.

/// Converts offsets of a repaired text to offsets of the source's text.
#[derive(Clone, Debug, Default)]
pub(crate) struct OffsetMap {
    /// `(offset in the repaired text, offset in the source)` from which on both run together, sorted.
    anchors: Vec<(usize, usize)>,
}

impl OffsetMap {
    /// A map for a text that is the source from this byte on.
    pub(crate) fn starting_at(offset: usize) -> Self {
        Self {
            anchors: vec![(0, offset)],
        }
    }

    /// The source's offset of an offset of the repaired text.
    pub(crate) fn back(&self, offset: usize) -> usize {
        let index = self.anchors.partition_point(|(repaired, _)| *repaired <= offset);
        let anchor = index.checked_sub(1).and_then(|index| self.anchors.get(index));
        let Some((repaired, source)) = anchor else {
            return offset;
        };
        let exact = source + (offset - repaired);
        // Inside inserted text the next anchor is the nearest place of the source.
        self.anchors.get(index).map_or(exact, |(_, next)| exact.min(*next))
    }
}

/// A repaired text under construction.
struct Output {
    text: String,
    map: OffsetMap,
}

impl Output {
    /// Copies a piece of the source that starts at `source`.
    fn copy(&mut self, piece: &str, source: usize) {
        self.map.anchors.push((self.text.len(), source));
        self.text.push_str(piece);
    }

    fn insert(&mut self, piece: &str) {
        self.text.push_str(piece);
    }
}

/// Converts `%YAML:1.0` lines to comments of the same length: every parser refuses the directive without `---`.
pub(super) fn without_directives(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        match line.strip_prefix('%') {
            Some(rest) if rest.trim_start().starts_with("YAML") => {
                bytes.push('#');
                bytes.extend(rest.chars());
            }
            _ => bytes.extend(line.chars()),
        }
    }
    bytes.into_iter().collect()
}

/// Replaces `//` and `/* */` comments outside strings by spaces; offsets stay.
pub(super) fn without_json_comments(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut chars = text.chars().peekable();
    let mut in_string = false;
    while let Some(c) = chars.next() {
        match (c, chars.peek().copied()) {
            ('\\', Some(_)) if in_string => {
                out.push(c);
                out.extend(chars.next());
            }
            ('"', _) => {
                in_string = !in_string;
                out.push(c);
            }
            ('/', Some('/')) if !in_string => {
                blank(c, &mut out);
                while let Some(c) = chars.next_if(|c| *c != '\n') {
                    blank(c, &mut out);
                }
            }
            ('/', Some('*')) if !in_string => {
                blank(c, &mut out);
                let mut previous = ' ';
                for (index, c) in chars.by_ref().enumerate() {
                    blank(c, &mut out);
                    // The star of `/*` itself does not close it.
                    if previous == '*' && c == '/' && index > 1 {
                        break;
                    }
                    previous = c;
                }
            }
            _ => out.push(c),
        }
    }
    out
}

/// As many spaces as the character has bytes; line ends stay.
fn blank(c: char, out: &mut String) {
    if c == '\n' || c == '\r' {
        out.push(c);
    } else {
        out.extend(std::iter::repeat_n(' ', c.len_utf8()));
    }
}

/// Replaces the full-width commas of Chinese keyboards by commas, each with spaces that keep the offsets; returns the lines.
pub(super) fn without_wide_commas(text: &str) -> (String, Vec<(usize, &'static str)>) {
    const WIDE: char = '\u{ff0c}';
    let lines = text.lines().enumerate().filter(|(_, line)| {
        let code = line.split('#').next().unwrap_or_default();
        code.contains(WIDE)
    });
    let notes = lines
        .map(|(index, _)| (index + 1, "its commas are full-width"))
        .collect();
    (text.replace(WIDE, ",  "), notes)
}

/// Whether a text has tabs in its indentation.
pub(super) fn has_leading_tabs(text: &str) -> bool {
    text.lines().any(|line| line.trim_start_matches(' ').starts_with('\t'))
}

/// Rewrites line by line what OpenCV's reader would accept, a tab counting as `tab` spaces. Returns the text, the map
/// back (on top of `base`, the source offset of the text's first byte) and what was fixed, by line.
pub(super) fn lenient(text: &str, base: usize, tab: usize) -> (String, OffsetMap, Vec<(usize, &'static str)>) {
    let mut out = Output {
        text: String::with_capacity(text.len() + 64),
        map: OffsetMap::default(),
    };
    let mut notes = Vec::new();
    let mut levels = Levels::default();
    let mut brackets = 0_i32;
    let mut start = base;
    for (index, line) in text.split_inclusive('\n').enumerate() {
        let body = line.trim_start_matches([' ', '\t']);
        let lead = line.len() - body.len();
        let blanks = line.get(..lead).unwrap_or_default();
        let written: usize = blanks.chars().map(|c| if c == '\t' { tab } else { 1 }).sum();
        let content = body.trim_end();
        if brackets > 0 || content.is_empty() || content.starts_with('#') || content.starts_with("---") {
            out.insert(&" ".repeat(written));
            out.copy(body, start + lead);
        } else {
            let indent = levels.place(written, content);
            if indent != written {
                notes.push((index + 1, "its indentation matches no line above"));
            } else if blanks.contains('\t') {
                notes.push((index + 1, "it is indented with tabs"));
            }
            out.insert(&" ".repeat(indent));
            if let Some(note) = correct(body, start + lead, &mut out) {
                notes.push((index + 1, note));
            }
        }
        brackets = (brackets + bracket_balance(body)).max(0);
        start += line.len();
    }
    (out.text, out.map, notes)
}

const MATRIX: &str = "!!opencv-matrix";

/// Copies a line's content, with a space after its first colon if there is none, and without words after a tag.
fn correct(body: &str, source: usize, out: &mut Output) -> Option<&'static str> {
    let mut note = None;
    let is_key = |key: &str| !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || "_.-/ ".contains(c));
    let mut rest_start = 0;
    if let Some(colon) = body.find(':') {
        let (key, after) = (
            body.get(..colon).unwrap_or_default(),
            body.get(colon + 1..).unwrap_or_default(),
        );
        let joined = after.starts_with(|c: char| !c.is_whitespace() && c != ':' && c != '/');
        if is_key(key) && joined {
            out.copy(body.get(..=colon).unwrap_or_default(), source);
            out.insert(" ");
            rest_start = colon + 1;
            note = Some("a space is missing after its colon");
        }
    }
    let rest = body.get(rest_start..).unwrap_or_default();
    match rest.find(MATRIX) {
        Some(at) => {
            let end = at + MATRIX.len();
            let (kept, junk) = (rest.get(..end).unwrap_or_default(), rest.get(end..).unwrap_or_default());
            out.copy(kept, source + rest_start);
            let junk_text = junk.trim();
            if junk_text.is_empty() || junk_text.starts_with('#') || junk_text.starts_with('{') {
                out.copy(junk, source + rest_start + end);
            } else {
                note = note.or(Some("there are words after its tag"));
                out.insert("\n");
            }
        }
        None => out.copy(rest, source + rest_start),
    }
    note
}

/// Opening minus closing brackets outside quotes and comments.
fn bracket_balance(body: &str) -> i32 {
    let mut balance = 0;
    let mut quote = None;
    for c in body.chars() {
        match (quote, c) {
            (Some(q), c) => quote = (q != c).then_some(q),
            (None, '"' | '\'') => quote = Some(c),
            (None, '#') => break,
            (None, '[' | '{') => balance += 1,
            (None, ']' | '}') => balance -= 1,
            _ => {}
        }
    }
    balance
}

/// The indentation levels that are open, and whether the last line may open another.
#[derive(Default)]
struct Levels {
    open: Vec<usize>,
    opens: bool,
    /// Set while reading the keys of an `!!opencv-matrix`: the level its keys are put on.
    matrix: Option<usize>,
}

impl Levels {
    /// The indentation a line should have: its own if it matches a level, else that of the nearest level outside it.
    fn place(&mut self, written: usize, content: &str) -> usize {
        let key = content.split(':').next().unwrap_or_default().trim();
        let is_pair = content.contains(':');
        let opens_matrix = content.contains("!!opencv-matrix");
        if let Some(level) = self.matrix {
            if matches!(key, "rows" | "cols" | "dt" | "data") {
                self.opens = false;
                return level;
            }
            self.matrix = None;
            self.open.retain(|open| *open < level);
        }
        let top = self.open.last().copied();
        let level = match top {
            None => written,
            Some(top) if written > top && (self.opens || !is_pair) => written,
            Some(top) if written > top => top,
            Some(_) => {
                let below = self.open.iter().rev().find(|open| **open <= written);
                below.or(self.open.first()).copied().unwrap_or(written)
            }
        };
        if is_pair || content.starts_with('-') {
            self.open.retain(|open| *open < level);
            self.open.push(level);
        }
        let bare = content.split(" #").next().unwrap_or_default().trim_end();
        self.opens = bare.ends_with(':') || bare.ends_with('|') || bare.ends_with('>') || content.starts_with('-');
        if opens_matrix {
            self.matrix = Some(level + 3);
            self.opens = true;
        }
        level
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_of_json_are_blanked_and_offsets_stay() {
        let text = "{ // é\n \"a//b\": /* x */ 1, \"q\\\"//\": 2 /*/ y */ }";
        let blanked = without_json_comments(text);
        assert_eq!(blanked.len(), text.len());
        assert_eq!(blanked.find("1,"), text.find("1,"));
        assert!(blanked.contains("\"a//b\"") && blanked.contains("\"q\\\"//\": 2") && !blanked.contains('y'));
    }

    #[test]
    fn inserted_text_maps_to_its_neighbour() {
        let (text, map, notes) = lenient("ab:[1]\n", 3, 1);
        assert_eq!(text, "ab: [1]\n");
        assert_eq!(map.back(0), 3);
        assert_eq!(map.back(text.find('[').unwrap()), 6);
        assert_eq!(notes.len(), 1);
    }

    #[test]
    fn directives_become_comments() {
        assert_eq!(without_directives("%YAML:1.0\na: %b\n"), "#YAML:1.0\na: %b\n");
    }
}
