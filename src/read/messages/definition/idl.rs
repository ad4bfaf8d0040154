//! The text of IDL files, and such texts put together in one as rosbag2 stores them (`ros2idl`).
//!
//! Reads what message types are made of: modules, structs, names for types, arrays, sequences, enumerations. Unions and
//! other forms are reported by name if a type needs them. Sources: OMG IDL 4.2, 7.4; rosidl's mapping
//! (`design.ros2.org/articles/idl_interface_definition.html`); sections of `=` and `IDL: package/msg/Type`:
//! rosbag2_cpp `local_message_definition_source.cpp`.

use super::tokens::{Token, Tokens};
use super::{Alias, Bundle, Count, FieldSpelling, Number, StructSpelling, TypeSpelling, plain_name};

/// Bound on nested modules: every name is looked up in all of them. Message types are in two.
const MAX_SCOPE: usize = 8;

/// Reads every type of a text. An error ends its section, and is returned with its line, next to the types.
pub(super) fn bundle(text: &str) -> (Bundle, Option<String>) {
    let mut reader = Reader::default();
    let mut start = (0, 1);
    let mut at = 0;
    for (number, line) in (1..).zip(text.split_inclusive('\n')) {
        let is_rule = line.starts_with("===");
        if is_rule || line.starts_with("IDL:") {
            reader.section(text.get(start.0..at).unwrap_or_default(), start.1);
            start = (at + line.len(), number + 1);
        }
        at += line.len();
    }
    reader.section(text.get(start.0..).unwrap_or_default(), start.1);
    (reader.bundle, reader.fault)
}

#[derive(Default)]
struct Reader {
    bundle: Bundle,
    /// The first thing that was not understood outside of a type.
    fault: Option<String>,
}

/// What ended a declaration.
type EndReason = String;

impl Reader {
    fn section(&mut self, text: &str, first_line: usize) {
        let mut tokens = Tokens::new(text, first_line);
        let mut scope: Vec<&str> = Vec::new();
        while let Some(token) = tokens.next() {
            let read = match token {
                Token::Word("module") => match (tokens.next(), tokens.takes('{')) {
                    (Some(Token::Word(name)), true) if scope.len() < MAX_SCOPE => {
                        scope.push(name);
                        Ok(())
                    }
                    (Some(_), true) => Err(format!("modules are nested more than {MAX_SCOPE} deep")),
                    _ => Err("a module has no name".to_owned()),
                },
                Token::Sign('}') if scope.pop().is_some() => Ok(()),
                Token::Sign(';' | '@') => Ok(()),
                Token::Word("struct") => self.structure(&mut tokens, &scope),
                Token::Word("typedef") => self.alias(&mut tokens, &scope),
                Token::Word("const") => {
                    tokens.skip_declaration();
                    Ok(())
                }
                Token::Word(kind @ ("enum" | "union" | "bitmask" | "bitset")) => self.other(kind, &mut tokens, &scope),
                token => Err(format!("{} is not a supported declaration", words(Some(token)))),
            };
            if let Err(what) = read {
                let line = tokens.line();
                self.fault.get_or_insert_with(|| format!("line {line}: {what}"));
                return;
            }
        }
    }

    fn structure(&mut self, tokens: &mut Tokens<'_>, scope: &[&str]) -> Result<(), EndReason> {
        let Some(Token::Word(name)) = tokens.next() else {
            return Err("a struct has no name".to_owned());
        };
        if tokens.peek() == Some(Token::Sign(';')) {
            return Ok(());
        }
        let mut read = StructSpelling::default();
        if tokens.takes(':') {
            read.fault = Some(format!("line {}: structs with a base are not supported", tokens.line()));
            tokens.skip_declaration();
        } else if !tokens.takes('{') {
            return Err(format!("{} after `struct {name}`", words(tokens.peek())));
        } else {
            while read.fault.is_none() && !tokens.takes('}') {
                if let Err(what) = member(tokens, scope, &mut read.fields) {
                    read.fault = Some(format!("line {}: {what}", tokens.line()));
                }
            }
        }
        let broken = read.fault.clone();
        self.bundle.types.entry(full_name(scope, name)).or_insert(read);
        broken.map_or(Ok(()), Err)
    }

    fn alias(&mut self, tokens: &mut Tokens<'_>, scope: &[&str]) -> Result<(), EndReason> {
        let mut fields = Vec::new();
        member(tokens, scope, &mut fields)?;
        for FieldSpelling { name, spelled, count } in fields {
            let alias = Alias { spelled, count };
            self.bundle.aliases.entry(full_name(scope, &name)).or_insert(alias);
        }
        Ok(())
    }

    /// Enumerations are numbers of four bytes; the other kinds are skipped and remembered by name.
    fn other(&mut self, kind: &str, tokens: &mut Tokens<'_>, scope: &[&str]) -> Result<(), EndReason> {
        let Some(Token::Word(name)) = tokens.next() else {
            return Err(format!("`{kind}` has no name"));
        };
        tokens.skip_declaration();
        let spelled = match kind {
            "enum" => TypeSpelling::Number(Number::Unsigned(4)),
            _ => TypeSpelling::Unsupported(format!("`{name}` is a {kind}, which is not supported")),
        };
        let count = Count::One;
        let alias = Alias { spelled, count };
        self.bundle.aliases.entry(full_name(scope, name)).or_insert(alias);
        Ok(())
    }
}

fn full_name(scope: &[&str], name: &str) -> String {
    let mut full = scope.join("/");
    full.push('/');
    full.push_str(name);
    plain_name(&full)
}

/// Reads `type name, name[3];`.
fn member(tokens: &mut Tokens<'_>, scope: &[&str], fields: &mut Vec<FieldSpelling>) -> Result<(), EndReason> {
    let is_optional = tokens.takes('@');
    let (spelled, count) = type_of(tokens, scope)?;
    let spelled = if is_optional {
        TypeSpelling::Unsupported("optional fields are not supported".to_owned())
    } else {
        spelled
    };
    loop {
        let Some(Token::Word(name)) = tokens.next() else {
            return Err("a field has no name".to_owned());
        };
        let mut length: Option<u32> = None;
        while tokens.takes('[') {
            let (Some(Token::Number(size)), true) = (tokens.next(), tokens.takes(']')) else {
                return Err(format!("the length of `{name}` is not a number"));
            };
            let product = length.unwrap_or(1).checked_mul(size);
            length = Some(product.ok_or_else(|| format!("`{name}` is longer than any message"))?);
        }
        let (spelled, count) = match (count, length) {
            (count, None) => (spelled.clone(), count),
            (Count::One, Some(length)) => (spelled.clone(), Count::Fixed(length)),
            _ => (arrays_of_arrays(), Count::One),
        };
        let name = name.to_owned();
        fields.push(FieldSpelling { name, spelled, count });
        if tokens.takes(';') {
            return Ok(());
        }
        if !tokens.takes(',') {
            return Err(format!("{} where `;` was expected", words(tokens.peek())));
        }
    }
}

pub(super) fn arrays_of_arrays() -> TypeSpelling {
    TypeSpelling::Unsupported("arrays of sequences and sequences of arrays are not supported".to_owned())
}

fn type_of(tokens: &mut Tokens<'_>, scope: &[&str]) -> Result<(TypeSpelling, Count), EndReason> {
    if tokens.peek() != Some(Token::Word("sequence")) {
        return Ok((single(tokens, scope)?, Count::One));
    }
    tokens.next();
    if !tokens.takes('<') {
        return Err("`sequence` has no type".to_owned());
    }
    let spelled = if tokens.peek() == Some(Token::Word("sequence")) {
        arrays_of_arrays()
    } else {
        single(tokens, scope)?
    };
    // The bound, and anything else there, changes nothing in a message.
    close(tokens)?;
    Ok((spelled, Count::Sequence))
}

/// Skips the rest of `<...>`, after its opening sign.
fn close(tokens: &mut Tokens<'_>) -> Result<(), EndReason> {
    let mut depth = 1_usize;
    while depth > 0 {
        match tokens.next() {
            Some(Token::Sign('<')) => depth += 1,
            Some(Token::Sign('>')) => depth -= 1,
            Some(Token::Sign(';' | '{' | '}')) | None => return Err("`<` without `>`".to_owned()),
            Some(_) => {}
        }
    }
    Ok(())
}

fn single(tokens: &mut Tokens<'_>, scope: &[&str]) -> Result<TypeSpelling, EndReason> {
    let unsupported = |what: &str| TypeSpelling::Unsupported(format!("`{what}` is not supported"));
    let word = match tokens.next() {
        Some(Token::Word(word)) => word,
        Some(Token::Scope) => return scoped(tokens, None, &[]),
        other => return Err(format!("{} where a type was expected", words(other))),
    };
    let is_next = |tokens: &mut Tokens<'_>, word: &str| {
        let is_it = tokens.peek() == Some(Token::Word(word));
        if is_it {
            tokens.next();
        }
        is_it
    };
    let number = match word {
        "boolean" | "octet" | "char" | "uint8" => Number::Unsigned(1),
        "int8" => Number::Signed(1),
        "int16" | "short" => Number::Signed(2),
        "uint16" => Number::Unsigned(2),
        "int64" => Number::Signed(8),
        "uint64" => Number::Unsigned(8),
        "float" => Number::Float(4),
        "double" => Number::Float(8),
        "long" if is_next(tokens, "double") => return Ok(unsupported("long double")),
        "long" if is_next(tokens, "long") => Number::Signed(8),
        "int32" | "long" => Number::Signed(4),
        "unsigned" if is_next(tokens, "short") => Number::Unsigned(2),
        "unsigned" if is_next(tokens, "long") && is_next(tokens, "long") => Number::Unsigned(8),
        "uint32" | "unsigned" => Number::Unsigned(4),
        "string" | "wstring" | "map" => {
            if tokens.takes('<') {
                close(tokens)?;
            }
            return Ok(match word {
                "string" => TypeSpelling::Text,
                _ => unsupported(word),
            });
        }
        "wchar" | "any" | "fixed" => return Ok(unsupported(word)),
        name => return scoped(tokens, Some(name), scope),
    };
    Ok(TypeSpelling::Number(number))
}

/// A name with its scope: what it means is looked up from the innermost module outwards.
fn scoped(tokens: &mut Tokens<'_>, first: Option<&str>, scope: &[&str]) -> Result<TypeSpelling, EndReason> {
    let mut parts: Vec<&str> = first.into_iter().collect();
    while parts.is_empty() || tokens.peek() == Some(Token::Scope) {
        if !parts.is_empty() {
            tokens.next();
        }
        match tokens.next() {
            Some(Token::Word(part)) => parts.push(part),
            other => return Err(format!("{} after `::`", words(other))),
        }
    }
    let name = parts.join("/");
    let outwards = (0..=scope.len()).rev().filter_map(|depth| scope.get(..depth));
    Ok(TypeSpelling::Named(
        outwards.map(|modules| full_name(modules, &name)).collect(),
    ))
}

fn words(token: Option<Token<'_>>) -> String {
    match token {
        None => "the end".to_owned(),
        Some(Token::Word(word)) => format!("`{}`", super::msg::shortened(word)),
        Some(Token::Number(number)) => format!("`{number}`"),
        Some(Token::Literal) => "a literal".to_owned(),
        Some(Token::Scope) => "`::`".to_owned(),
        Some(Token::Sign(sign)) => format!("`{sign}`"),
    }
}
