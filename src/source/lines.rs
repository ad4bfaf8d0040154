//! Lines and columns of byte offsets, found without walking through the text.
//!
//! Must not know sources or places.

/// One-based line and column of a byte offset. Columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineColumn {
    /// One-based line.
    pub line: usize,
    /// One-based column, in characters.
    pub column: usize,
}

/// Byte offsets of line starts, for turning spans into lines.
#[derive(Clone, Debug)]
pub struct LineIndex {
    starts: Vec<usize>,
    /// Characters that begin before each [`BLOCK`] bytes: a file may be one line of many megabytes.
    characters: Vec<usize>,
}

/// Bytes between two counts of characters.
const BLOCK: usize = 4096;

fn characters(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| (**byte & 0xC0) != 0x80).count()
}

impl LineIndex {
    /// Indexes `text`.
    pub fn new(text: &str) -> Self {
        let mut starts = vec![0];
        starts.extend(memchr::memchr_iter(b'\n', text.as_bytes()).map(|at| at + 1));
        let mut counted = 0;
        let characters = text
            .as_bytes()
            .chunks(BLOCK)
            .map(|block| {
                let before = counted;
                counted += characters(block);
                before
            })
            .collect();
        Self { starts, characters }
    }

    /// Characters that begin before an offset.
    fn before(&self, text: &str, offset: usize) -> usize {
        // An offset at the end of a full last block has no block of its own.
        let block = (offset / BLOCK).min(self.characters.len().saturating_sub(1));
        let counted = self.characters.get(block).copied().unwrap_or(0);
        counted + text.as_bytes().get(block * BLOCK..offset).map_or(0, characters)
    }

    /// Line and column of a byte offset into the same text; offsets past the end give the last position.
    pub fn locate(&self, text: &str, offset: usize) -> LineColumn {
        let offset = offset.min(text.len());
        let line = self.starts.partition_point(|start| *start <= offset).max(1);
        let start = self.starts.get(line - 1).copied().unwrap_or(0);
        let column = self.before(text, offset) - self.before(text, start) + 1;
        LineColumn { line, column }
    }

    /// Byte offset at which a zero-based line starts, if the text has that line.
    pub fn line_start(&self, line: usize) -> Option<usize> {
        self.starts.get(line).copied()
    }

    /// Number of lines.
    pub fn len(&self) -> usize {
        self.starts.len()
    }

    /// Whether the text was empty.
    pub fn is_empty(&self) -> bool {
        self.starts.len() <= 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_are_one_based_and_count_characters() {
        let text = "a\nbé c\n";
        let index = LineIndex::new(text);
        assert_eq!(index.locate(text, 0), LineColumn { line: 1, column: 1 });
        assert_eq!(index.locate(text, 2), LineColumn { line: 2, column: 1 });
        // "é" takes two bytes: the "c" is at byte 6, column 4.
        assert_eq!(index.locate(text, 6), LineColumn { line: 2, column: 4 });
        assert_eq!(index.locate(text, 999), LineColumn { line: 3, column: 1 });
    }

    #[test]
    fn columns_of_a_long_line_are_counted_from_its_start() {
        for length in [BLOCK - 2, BLOCK, 3 * BLOCK, 3 * BLOCK + 5] {
            let text = format!("x\n{}", "é".repeat(length / 2));
            let index = LineIndex::new(&text);
            for offset in (2..=text.len()).filter(|offset| text.is_char_boundary(*offset)) {
                let column = text[2..offset].chars().count() + 1;
                assert_eq!(index.locate(&text, offset), LineColumn { line: 2, column });
            }
        }
    }
}
