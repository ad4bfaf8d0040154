//! The tokens of IDL. Source: OMG IDL 4.2, 7.2.

/// A token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Token<'t> {
    /// A word, or a name.
    Word(&'t str),
    /// A whole number in decimal; other literals are [`Token::Literal`].
    Number(u32),
    /// A text or any other literal.
    Literal,
    /// `::`.
    Scope,
    /// Any other character.
    Sign(char),
}

/// The tokens of a text with their line numbers. Comments, lines of the preprocessor and annotations are skipped,
/// except `@optional`, which changes the bytes of a message: it is the sign `@`.
pub(super) struct Tokens<'t> {
    rest: &'t str,
    line: usize,
    peeked: Option<Token<'t>>,
}

impl<'t> Tokens<'t> {
    pub(super) fn new(text: &'t str, first_line: usize) -> Self {
        Self {
            rest: text,
            line: first_line,
            peeked: None,
        }
    }

    /// The line that has been read up to.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    pub(super) fn next(&mut self) -> Option<Token<'t>> {
        self.peeked.take().or_else(|| self.read())
    }

    pub(super) fn peek(&mut self) -> Option<Token<'t>> {
        if self.peeked.is_none() {
            self.peeked = self.read();
        }
        self.peeked
    }

    /// Takes the next token if it is this sign.
    pub(super) fn takes(&mut self, sign: char) -> bool {
        let is_it = self.peek() == Some(Token::Sign(sign));
        if is_it {
            self.peeked = None;
        }
        is_it
    }

    /// Skips everything up to the next `;` outside of braces, or up to the brace that closes the outer ones.
    pub(super) fn skip_declaration(&mut self) {
        let mut depth = 0_usize;
        while let Some(token) = self.peek() {
            match token {
                Token::Sign('{') => depth += 1,
                Token::Sign('}') if depth == 0 => return,
                Token::Sign('}') => depth -= 1,
                Token::Sign(';') if depth == 0 => {
                    self.peeked = None;
                    return;
                }
                _ => {}
            }
            self.peeked = None;
        }
    }

    fn read(&mut self) -> Option<Token<'t>> {
        loop {
            match self.raw()? {
                Token::Sign('@') => {
                    if self.annotation() == Some("optional") {
                        return Some(Token::Sign('@'));
                    }
                }
                token => return Some(token),
            }
        }
    }

    /// Skips an annotation after its `@`; returns its last name.
    fn annotation(&mut self) -> Option<&'t str> {
        let mut name = None;
        loop {
            let before = (self.rest, self.line);
            match self.raw() {
                Some(Token::Word(word)) if name.is_none() => name = Some(word),
                Some(Token::Scope) => name = None,
                Some(Token::Sign('(')) => break,
                _ => {
                    (self.rest, self.line) = before;
                    return name;
                }
            }
        }
        let mut depth = 1_usize;
        while depth > 0 {
            match self.raw() {
                None => return name,
                Some(Token::Sign('(')) => depth += 1,
                Some(Token::Sign(')')) => depth -= 1,
                Some(_) => {}
            }
        }
        name
    }

    /// The next token, annotations in parts.
    fn raw(&mut self) -> Option<Token<'t>> {
        self.skip_blank();
        let first = self.rest.chars().next()?;
        if first.is_ascii_alphabetic() || first == '_' {
            let word = self.take_while(|c| c.is_ascii_alphanumeric() || c == '_');
            return Some(Token::Word(word));
        }
        if first.is_ascii_digit() {
            let digits = self.take_while(|c| c.is_ascii_alphanumeric() || c == '.');
            return Some(digits.parse().map_or(Token::Literal, Token::Number));
        }
        if first == '"' || first == '\'' {
            self.skip_quoted(first);
            return Some(Token::Literal);
        }
        if let Some(rest) = self.rest.strip_prefix("::") {
            self.rest = rest;
            return Some(Token::Scope);
        }
        self.advance(first.len_utf8());
        Some(Token::Sign(first))
    }

    fn skip_blank(&mut self) {
        loop {
            self.take_while(char::is_whitespace);
            if self.rest.starts_with("//") || self.rest.starts_with('#') {
                self.take_while(|c| c != '\n');
            } else if self.rest.starts_with("/*") {
                let end = self.rest.find("*/").map_or(self.rest.len(), |end| end + 2);
                self.advance(end);
            } else {
                return;
            }
        }
    }

    fn skip_quoted(&mut self, quote: char) {
        let mut escaped = false;
        let inside = self.rest.char_indices().skip(1);
        let end = inside
            .filter(|(_, c)| {
                let closes = *c == quote && !escaped;
                escaped = *c == '\\' && !escaped;
                closes
            })
            .map(|(at, c)| at + c.len_utf8())
            .next();
        self.advance(end.unwrap_or(self.rest.len()));
    }

    fn take_while(&mut self, belongs: impl Fn(char) -> bool) -> &'t str {
        let end = self.rest.find(|c| !belongs(c)).unwrap_or(self.rest.len());
        self.advance(end)
    }

    fn advance(&mut self, len: usize) -> &'t str {
        let (taken, rest) = self.rest.split_at_checked(len).unwrap_or((self.rest, ""));
        self.line += taken.bytes().filter(|byte| *byte == b'\n').count();
        self.rest = rest;
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_annotations_and_texts_are_passed_over() {
        let text = "// one\n#include \"x.idl\"\n/* two\n lines */ module a {\n@verbatim (language=\"comment\", text=\n\
            \"( ) ; \\\" struct\" \"\\n\")\n@key long b::c[9]; @optional float d; };";
        let mut tokens = Tokens::new(text, 1);
        let mut all = Vec::new();
        while let Some(token) = tokens.next() {
            all.push((tokens.line(), token));
        }
        let expected = [
            (4, Token::Word("module")),
            (4, Token::Word("a")),
            (4, Token::Sign('{')),
            (7, Token::Word("long")),
            (7, Token::Word("b")),
            (7, Token::Scope),
            (7, Token::Word("c")),
            (7, Token::Sign('[')),
            (7, Token::Number(9)),
            (7, Token::Sign(']')),
            (7, Token::Sign(';')),
            (7, Token::Sign('@')),
            (7, Token::Word("float")),
            (7, Token::Word("d")),
            (7, Token::Sign(';')),
            (7, Token::Sign('}')),
            (7, Token::Sign(';')),
        ];
        assert_eq!(all, expected);
    }

    #[test]
    fn open_ends_end() {
        for text in ["\"abc", "/* abc", "@a(((", "@", "@a::", "'\\'", "::", "1x", "\u{e4}"] {
            let mut tokens = Tokens::new(text, 1);
            while tokens.next().is_some() {}
            assert_eq!(tokens.rest, "", "{text}");
        }
    }
}
