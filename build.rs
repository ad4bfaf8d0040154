//! Makes constants of the catalogue: every page's front matter in Rust, every table of `rules/tables/` in JSON, which is read many times
//! as fast as YAML. A page or a table that does not read fails the build.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use serde::Deserialize;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// The front matter of a page, as `frames_lint::page::Page` describes it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Front {
    code: String,
    name: String,
    summary: String,
    since: String,
    status: String,
    severity: String,
    confidence: String,
    subject: String,
    view: String,
    #[serde(default)]
    evidence: Vec<String>,
    #[serde(default)]
    limits: BTreeMap<String, Limit>,
    #[serde(default)]
    references: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Limit {
    value: serde_yaml::Number,
    unit: String,
    reason: String,
}

/// A word of a closed list as the name of its variant.
fn variant(word: &str) -> String {
    let mut letters = word.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}

fn page(path: &Path, out: &mut String) -> Outcome<()> {
    let text = fs::read_to_string(path)?;
    let front = text.strip_prefix("---\n").and_then(|rest| rest.split_once("\n---\n"));
    let (front, body) = front.ok_or("a page opens with front matter between two lines of ---")?;
    let front: Front = serde_yaml::from_str(front)?;
    writeln!(out, "pub static {0}: Page = Page {{ code: {0:?},", front.code)?;
    for (field, value) in [
        ("name", &front.name),
        ("summary", &front.summary),
        ("since", &front.since),
        ("subject", &front.subject),
        ("view", &front.view),
    ] {
        writeln!(out, "    {field}: {value:?},")?;
    }
    for (field, of, word) in [
        ("status", "Status", &front.status),
        ("severity", "Severity", &front.severity),
        ("confidence", "Confidence", &front.confidence),
    ] {
        writeln!(out, "    {field}: {of}::{},", variant(word))?;
    }
    writeln!(out, "    evidence: &{:?}, limits: &[", front.evidence)?;
    for (name, limit) in &front.limits {
        let number = match limit.value.as_i64() {
            Some(whole) => format!("Number::Whole({whole})"),
            None => format!("Number::Real({:?})", limit.value.as_f64().ok_or("a limit is a number")?),
        };
        let (unit, reason) = (&limit.unit, &limit.reason);
        writeln!(
            out,
            "        Limit {{ name: {name:?}, value: {number}, unit: {unit:?}, reason: {reason:?} }},"
        )?;
    }
    writeln!(out, "    ], references: &{:?},", front.references)?;
    writeln!(out, "    body: {body:?} }};")?;
    Ok(())
}

/// What lies in a folder, by name.
fn listed(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let entries: Result<Vec<_>, _> = fs::read_dir(folder)?.collect();
    let mut paths: Vec<PathBuf> = entries?.into_iter().map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths)
}

fn constants(rules: &Path, out: &Path) -> Outcome<()> {
    let mut pages = String::new();
    for path in listed(rules)?.iter().filter(|path| path.is_dir()) {
        for file in listed(path)? {
            let kind = file.extension().and_then(|extension| extension.to_str());
            let made = match kind {
                Some("md") => page(&file, &mut pages),
                Some("yaml") if path.ends_with("tables") => table(&file, out),
                _ => Ok(()),
            };
            made.map_err(|error| format!("{}: {error}", file.display()))?;
        }
    }
    fs::write(out.join("pages.rs"), pages)?;
    Ok(())
}

fn table(file: &Path, out: &Path) -> Outcome<()> {
    let table: serde_yaml::Value = serde_yaml::from_str(&fs::read_to_string(file)?)?;
    let name = file.with_extension("json");
    fs::write(
        out.join(name.file_name().ok_or("a file has a name")?),
        serde_json::to_string(&table)?,
    )?;
    Ok(())
}

fn main() -> Outcome<()> {
    println!("cargo::rerun-if-changed=rules");
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    constants(&root.join("rules"), &PathBuf::from(env::var("OUT_DIR")?))
}
