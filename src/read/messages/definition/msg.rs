//! The text of `.msg` files, and such texts put together in one as recordings carry them (`ros2msg`, `ros1msg`).
//!
//! Sources: `docs.ros.org/en/rolling/Concepts/Basic/About-Interfaces.html`, `wiki.ros.org/msg`; the form of several texts
//! in one: `mcap.dev/spec/registry` (ros1msg, ros2msg).

use super::{Bundle, Count, FieldSpelling, Number, StructSpelling, TypeSpelling, plain_name};

/// Reads a text that begins with the fields of `root`, followed by the types it uses, each after a line of `=` and
/// `MSG: package/Type`. Of two texts for one type the first one is used.
pub(super) fn bundle(root: &str, text: &str) -> Bundle {
    let mut bundle = Bundle::default();
    let root = plain_name(root);
    let mut name = Some(root.clone());
    let mut section: Vec<(usize, &str)> = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        if line.starts_with("===") {
            keep(&mut bundle, name.take(), &mut section);
        } else if let Some(named) = line.trim().strip_prefix("MSG:").filter(|_| name.is_none()) {
            name = Some(plain_name(named));
        } else {
            section.push((number, line));
        }
    }
    keep(&mut bundle, name, &mut section);
    bundle.types.entry(root).or_default();
    bundle
}

/// Keeps a section. One without a name or content is ignored.
fn keep(bundle: &mut Bundle, name: Option<String>, section: &mut Vec<(usize, &str)>) {
    let lines = std::mem::take(section);
    let (Some(name), true) = (name, lines.iter().any(|(_, line)| !line.trim().is_empty())) else {
        return;
    };
    let package = name.rsplit_once('/').map_or("", |(package, _)| package);
    let read = one(package, lines.into_iter());
    bundle.types.entry(name).or_insert(read);
}

/// Reads the fields of one type in `package` from numbered lines.
pub(super) fn one<'t>(package: &str, lines: impl Iterator<Item = (usize, &'t str)>) -> StructSpelling {
    let mut read = StructSpelling::default();
    for (number, line) in lines {
        match field(package, line) {
            Ok(None) => {}
            Ok(Some(field)) => read.fields.push(field),
            Err(what) => {
                read.fault = Some(format!("line {number}: {what}"));
                break;
            }
        }
    }
    read
}

/// The field a line declares; `None` for empty lines, comments and constants (`type NAME = value`).
fn field(package: &str, line: &str) -> Result<Option<FieldSpelling>, String> {
    // Texts in constants and defaults may hold a `#`: the part cut off then is not part of the field either.
    let line = line.split('#').next().unwrap_or_default().trim();
    if line.is_empty() {
        return Ok(None);
    }
    let not_a_field = || format!("`{}` is not a field", shortened(line));
    let (type_text, rest) = line.split_once(char::is_whitespace).ok_or_else(not_a_field)?;
    let rest = rest.trim_start();
    let end = rest
        .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
        .unwrap_or(rest.len());
    let (name, after) = rest.split_at_checked(end).ok_or_else(not_a_field)?;
    if name.is_empty() || name.starts_with(|c: char| c.is_ascii_digit()) {
        return Err(not_a_field());
    }
    if after.trim_start().starts_with('=') {
        return Ok(None);
    }
    if !after.is_empty() && !after.starts_with(char::is_whitespace) {
        return Err(not_a_field());
    }
    let (spelled, count) = type_of(package, type_text).ok_or_else(not_a_field)?;
    Ok(Some(FieldSpelling {
        name: name.to_owned(),
        spelled,
        count,
    }))
}

fn type_of(package: &str, text: &str) -> Option<(TypeSpelling, Count)> {
    let (base, count) = match text.strip_suffix(']') {
        None => (text, Count::One),
        Some(inner) => {
            let (base, bound) = inner.rsplit_once('[')?;
            let count = match bound {
                "" => Count::Sequence,
                bound if bound.starts_with("<=") => {
                    bound.strip_prefix("<=")?.parse::<u32>().ok()?;
                    Count::Sequence
                }
                fixed => Count::Fixed(fixed.parse().ok()?),
            };
            (base, count)
        }
    };
    let (base, bound) = match base.split_once("<=") {
        Some((base, bound)) => (base, Some(bound.parse::<u32>().ok()?)),
        None => (base, None),
    };
    let spelled = match base {
        "string" => TypeSpelling::Text,
        "wstring" => TypeSpelling::Unsupported("the size of a `wstring` differs between writers".to_owned()),
        _ if bound.is_some() => return None,
        "bool" | "byte" | "char" | "uint8" => TypeSpelling::Number(Number::Unsigned(1)),
        "int8" => TypeSpelling::Number(Number::Signed(1)),
        "uint16" => TypeSpelling::Number(Number::Unsigned(2)),
        "int16" => TypeSpelling::Number(Number::Signed(2)),
        "uint32" => TypeSpelling::Number(Number::Unsigned(4)),
        "int32" => TypeSpelling::Number(Number::Signed(4)),
        "uint64" => TypeSpelling::Number(Number::Unsigned(8)),
        "int64" => TypeSpelling::Number(Number::Signed(8)),
        "float32" => TypeSpelling::Number(Number::Float(4)),
        "float64" => TypeSpelling::Number(Number::Float(8)),
        "time" | "duration" => TypeSpelling::Time,
        _ => TypeSpelling::Named(named(package, base)?),
    };
    Some((spelled, count))
}

/// The names another type may have. A bare name means the type's own package; a bare `Header` that is not there is the
/// short form of ROS 1.
fn named(package: &str, text: &str) -> Option<Vec<String>> {
    let is_name = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_alphabetic())
            && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    if !text.split('/').all(is_name) {
        return None;
    }
    if text.contains('/') {
        return Some(vec![plain_name(text)]);
    }
    let mut names = vec![format!("{package}/{text}")];
    if text == "Header" {
        names.push("std_msgs/Header".to_owned());
    }
    Some(names)
}

/// A line for a message, shortened.
pub(super) fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain("...".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(text: &str) -> Vec<(String, TypeSpelling, Count)> {
        let read = one("acme", (1..).zip(text.lines()));
        assert_eq!(read.fault, None);
        let parts = |field: FieldSpelling| (field.name, field.spelled, field.count);
        read.fields.into_iter().map(parts).collect()
    }

    fn named(names: &[&str]) -> TypeSpelling {
        TypeSpelling::Named(names.iter().map(|name| (*name).to_owned()).collect())
    }

    #[test]
    fn constants_comments_defaults_and_bounds_are_told_apart() {
        let text = "# comment\n\n  uint8 A=1\nuint8 B = 2 # two\nstring C=\"std_msgs/Header\"\n\
            float64 x 1.5\nstring<=10 name \"a=b\"\nint16[] many\nint16[<=7] few\nuint32[3] three [1, 2, 3]\n\
            string<=5[<=2] words\n  std_msgs/Header   header # here\nOther o\nHeader h\r\nother_msgs/msg/Thing[4] t\n";
        let expected = [
            ("x", TypeSpelling::Number(Number::Float(8)), Count::One),
            ("name", TypeSpelling::Text, Count::One),
            ("many", TypeSpelling::Number(Number::Signed(2)), Count::Sequence),
            ("few", TypeSpelling::Number(Number::Signed(2)), Count::Sequence),
            ("three", TypeSpelling::Number(Number::Unsigned(4)), Count::Fixed(3)),
            ("words", TypeSpelling::Text, Count::Sequence),
            ("header", named(&["std_msgs/Header"]), Count::One),
            ("o", named(&["acme/Other"]), Count::One),
            ("h", named(&["acme/Header", "std_msgs/Header"]), Count::One),
            ("t", named(&["other_msgs/Thing"]), Count::Fixed(4)),
        ]
        .map(|(name, spelled, count)| (name.to_owned(), spelled, count));
        assert_eq!(fields(text), expected);
    }

    #[test]
    fn what_stands_before_a_fault_is_kept_and_the_fault_has_its_line() {
        let read = one("acme", (1..).zip("uint8 a\n---\nuint8 b".lines()));
        assert_eq!(
            (read.fields.len(), read.fault.as_deref()),
            (1, Some("line 2: `---` is not a field"))
        );
        for wrong in [
            "uint8",
            "uint8 9x",
            "uint8 a-b",
            "uint8[x] a",
            "uint8[ a",
            "uint8<=3 a",
            "string<= a",
            "a//b c",
            "<html> x",
            "uint8[99999999999] a",
        ] {
            assert!(one("acme", [(1, wrong)].into_iter()).fault.is_some(), "{wrong}");
        }
    }

    #[test]
    fn a_text_is_cut_into_the_types_it_holds() {
        let rule = "=".repeat(80);
        let text = format!("Sub a\n{rule}\nMSG: acme/msg/Sub\nint8 x\n{rule}\nMSG: std_msgs/Header\nstring frame_id\n");
        let bundle = bundle("acme/msg/Top", &text);
        let names: Vec<&str> = bundle.types.keys().map(String::as_str).collect();
        assert_eq!(names, ["acme/Sub", "acme/Top", "std_msgs/Header"]);
        assert!(bundle.types.values().all(|one| one.fields.len() == 1));
    }
}
