//! Makes the source of the documentation site: `docs/src`, and beside it what is written elsewhere once: a page for each rule, tables of the
//! JSON schemas, the program's own output, and the documents of the repository.
//!
//! `docs/build` runs it, and mdBook on what it writes.

use std::error::Error;
use std::ffi::OsString;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use frames_lint::cli::{self, Surroundings};
use frames_lint::page::{self, Page};
use frames_lint::report::{Style, explain};
use frames_lint::rules::RULES;
use serde_json::Value;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Documents of the repository that are pages of the site.
const DOCUMENTS: &[(&str, &str)] = &[
    ("ARCHITECTURE.md", "architecture.md"),
    ("CHANGELOG.md", "changelog.md"),
    ("CONTRIBUTING.md", "contributing.md"),
    ("SECURITY.md", "security.md"),
    ("README.md", "index.md"),
    ("rules/README.md", "rules.md"),
];

fn main() -> Outcome<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let out = PathBuf::from(std::env::args_os().nth(1).ok_or("usage: site FOLDER")?);
    // The outputs name paths as a user in the repository sees them.
    std::env::set_current_dir(root)?;
    copied(&root.join("docs/src"), &out.join("src"))?;
    fs::copy(root.join("docs/book.toml"), out.join("book.toml"))?;
    fs::create_dir_all(out.join("src/pictures"))?;
    for picture in fs::read_dir(root.join("docs/pictures"))? {
        let path = picture?.path();
        if let (Some(name), Some("webp")) = (path.file_name(), path.extension().and_then(|ending| ending.to_str())) {
            fs::copy(&path, out.join("src/pictures").join(name))?;
        }
    }
    copied(&root.join("schema"), &out.join("src/schema"))?;
    fs::create_dir_all(out.join("src/rules"))?;
    for entry in RULES {
        let file = out.join("src/rules").join(file_of(entry.page));
        fs::write(file, rule(entry.page))?;
    }
    Ok(())
}

/// Copies a folder; Markdown is completed on the way.
fn copied(from: &Path, to: &Path) -> Outcome<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let path = entry?.path();
        let target = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() {
            copied(&path, &target)?;
        } else if path.extension().is_some_and(|ending| ending == "md") {
            let completed =
                completed(&fs::read_to_string(&path)?).map_err(|error| format!("{}: {error}", path.display()))?;
            fs::write(&target, completed)?;
        } else {
            fs::copy(&path, &target)?;
        }
    }
    Ok(())
}

/// The text of a page with its marks replaced by what they stand for.
fn completed(text: &str) -> Outcome<String> {
    let mut out = String::new();
    for line in text.lines() {
        let mark = |open: &str, close: &str| Some(line.trim().strip_prefix(open)?.strip_suffix(close)?.trim());
        if let Some(call) = mark("<!-- run:", "-->") {
            let _ = writeln!(out, "```text\n$ {call}\n{}```", output(call)?);
        } else if let Some(file) = mark("<!-- schema:", "-->") {
            let text = fs::read_to_string(Path::new("schema").join(file))?;
            let _ = writeln!(out, "The schema as a file: [{file}](schema/{file}).\n");
            schema(&serde_json::from_str(&text)?, &mut out);
        } else if let Some(file) = mark("{{#include ../../", "}}") {
            out.push_str(&linked(&fs::read_to_string(file)?, file));
        } else if line == "<!-- rules -->" {
            table_of_rules(&mut out);
        } else if line.trim() == "<!-- rules -->" {
            for page in RULES.iter().map(|entry| entry.page) {
                let _ = writeln!(out, "    - [{} {}](rules/{})", page.code, page.name, file_of(page));
            }
        } else {
            let _ = writeln!(out, "{line}");
        }
    }
    Ok(out)
}

/// What the program answers to a call, as a file gets it.
fn output(call: &str) -> Outcome<String> {
    let mut words = call.split_whitespace();
    if words.next() != Some("frames-lint") {
        return Err(format!("`{call}` is no call of frames-lint").into());
    }
    let surroundings = Surroundings {
        style: Style {
            width: Some(100),
            ..Style::PLAIN
        },
        progress: false,
        is_program: false,
    };
    let arguments = std::iter::once("frames-lint").chain(words).map(OsString::from);
    let answer = cli::run(arguments, &mut std::io::empty(), surroundings);
    if answer.out.is_empty() {
        return Err(format!("`{call}`: {}", answer.err).into());
    }
    Ok(answer.out)
}

/// A document of the repository whose links lead to pages of the site, or to the repository online.
fn linked(text: &str, file: &str) -> String {
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, behind)) = rest.split_once("](") {
        let (target, after) = behind.split_once(')').unwrap_or((behind, ""));
        let _ = write!(out, "{before}]({})", target_of(target, folder));
        rest = after;
    }
    out + rest
}

fn target_of(target: &str, folder: &Path) -> String {
    if target.contains("://") || target.starts_with('#') {
        return target.to_owned();
    }
    let path = folder.join(target);
    let path = path.strip_prefix("../").unwrap_or(&path).to_string_lossy().into_owned();
    let page = DOCUMENTS.iter().find(|(document, _)| *document == path);
    let of_rule = RULES
        .iter()
        .map(|entry| entry.page)
        .find(|page| path.ends_with(&format!("/{}.md", page.name)));
    match (page, of_rule) {
        (Some((_, page)), _) => (*page).to_owned(),
        (_, Some(page)) => format!("rules/{}", file_of(page)),
        _ => format!("{}/blob/main/{path}", env!("CARGO_PKG_REPOSITORY")),
    }
}

fn file_of(page: &Page) -> String {
    format!("{}.md", page.code.to_lowercase())
}

fn table_of_rules(out: &mut String) {
    let mut family = "";
    for page in RULES.iter().map(|entry| entry.page) {
        if page.family() != family {
            family = page.family();
            let _ = writeln!(
                out,
                "\n## {family}\n\n| rule | severity | confidence | a finding says |\n|---|---|---|---|"
            );
        }
        let _ = writeln!(
            out,
            "| [{} {}](rules/{}) | {} | {} | {} |",
            page.code,
            page.name,
            file_of(page),
            page.severity.word(),
            page.confidence.word(),
            cell(page.summary)
        );
    }
}

/// A rule's page: its facts, its sections, its limits behind the section that uses them.
fn rule(page: &Page) -> String {
    let mut summary = page.summary.to_owned();
    if let Some(first) = summary.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    let mut out = format!(
        "# {} {}\n\n{summary}.\n\n| property | value |\n|---|---|\n",
        page.code, page.name
    );
    for (name, value) in page.facts() {
        let _ = writeln!(out, "| {name} | {} |", cell(value));
    }
    for section in page::sections(page.body) {
        let _ = writeln!(out, "\n## {}\n", section.title);
        blocks(section.text, &mut out);
        if section.title == "How it decides" && !page.limits.is_empty() {
            out.push_str("\n### Limits\n\n| limit | value | reason |\n|---|---|---|\n");
            for limit in page.limits {
                let _ = writeln!(out, "| `{}` | {} | {} |", limit.name, limit.words(), cell(limit.reason));
            }
        }
    }
    if let Some(sight) = explain::sight(page.view) {
        let _ = writeln!(out, "\n## In the viewer\n\n{sight}");
    }
    let mistakes = explain::mistakes(page.code);
    if !mistakes.is_empty() {
        let _ = writeln!(out, "\n## {}\n", explain::MISTAKES);
        for mistake in mistakes {
            let _ = writeln!(out, "- {mistake}");
        }
    }
    if !page.references.is_empty() {
        out.push_str("\n## References\n\n");
        for reference in page.references {
            let _ = writeln!(out, "- {reference}");
        }
    }
    out
}

/// The text of a section; a fenced block with a file name has the name in front of it.
fn blocks(text: &str, out: &mut String) {
    let mut is_open = false;
    for line in text.trim().lines() {
        let Some(info) = line.strip_prefix("```") else {
            let _ = writeln!(out, "{line}");
            continue;
        };
        is_open = !is_open;
        let (language, name) = info.trim().split_once(' ').unwrap_or((info.trim(), ""));
        match (is_open, language) {
            (false, _) => out.push_str("```\n"),
            (true, "expect") => out.push_str("The rule answers:\n\n```text\n"),
            (true, "recipe") => {
                let _ = writeln!(out, "`{name}`, a recording described in YAML:\n\n```yaml");
            }
            (true, _) if name.is_empty() => {
                let _ = writeln!(out, "```{language}");
            }
            (true, _) => {
                let _ = writeln!(out, "`{name}`:\n\n```{language}");
            }
        }
    }
}

/// Tables of the keys of a JSON schema: one for the top, one for each object below it.
fn schema(schema: &Value, out: &mut String) {
    if let Some(text) = schema["description"].as_str() {
        let _ = writeln!(out, "{text}\n");
    }
    object(schema, "", out);
    let definitions = schema["$defs"].as_object();
    for (name, definition) in definitions.into_iter().flatten() {
        let _ = writeln!(out, "\n### `{name}`\n");
        if definition["properties"].is_object() {
            object(definition, "", out);
        } else {
            let text = definition["description"].as_str().unwrap_or("");
            let _ = writeln!(out, "{}. {text}", kind(definition));
        }
    }
}

fn object(schema: &Value, path: &str, out: &mut String) {
    let Some(properties) = schema["properties"].as_object() else {
        return;
    };
    if !path.is_empty() {
        let _ = writeln!(out, "\n### `{path}`\n");
    }
    out.push_str("| key | type | meaning |\n|---|---|---|\n");
    for (key, value) in properties {
        let text = value["description"].as_str().unwrap_or("");
        let _ = writeln!(out, "| `{key}` | {} | {} |", cell(&kind(value)), cell(text));
    }
    for (key, value) in properties {
        let path = if path.is_empty() {
            key.clone()
        } else {
            format!("{path}.{key}")
        };
        object(value, &path, out);
        object(&value["items"], &format!("{path}[]"), out);
    }
}

/// The type of a value in words.
fn kind(value: &Value) -> String {
    let words = |values: &Value| -> Option<String> {
        let each: Vec<String> = values
            .as_array()?
            .iter()
            .map(|value| format!("`{}`", value.to_string().trim_matches('"')))
            .collect();
        Some(each.join(", "))
    };
    if let Some(name) = value["$ref"].as_str().and_then(|name| name.rsplit('/').next()) {
        return format!("[`{name}`](#{name})");
    }
    if let Some(choices) = words(&value["enum"]) {
        return format!("one of {choices}");
    }
    if !value["const"].is_null() {
        return format!("`{}`", value["const"].to_string().trim_matches('"'));
    }
    if let Some(either) = value["oneOf"].as_array().or_else(|| value["anyOf"].as_array()) {
        return either.iter().map(kind).collect::<Vec<_>>().join(" or ");
    }
    let of = match &value["type"] {
        Value::String(name) => name.clone(),
        Value::Array(names) => names.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(" or "),
        _ => "any".to_owned(),
    };
    match &value["items"] {
        Value::Null => of,
        items => format!("{of} of {}", kind(items)),
    }
}

/// A text in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
