//! Who may use whom: reads the `crate::` paths of every file and fails on an arrow that points the wrong way.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use frames_lint::rules::RULES;

use crate::support::files;

/// For each room of the house, the rooms it may use besides itself.
fn allowed() -> BTreeMap<&'static str, &'static [&'static str]> {
    BTreeMap::from([
        ("math", &[] as &[&str]),
        ("source", &[]),
        ("files", &[]),
        ("visible", &[]),
        ("tables", &[]),
        // What is known of devices is part of a world, for the user may add to it.
        ("world", &["source", "math", "tables"]),
        ("verdict", &["source"]),
        ("page", &["source", "verdict"]),
        ("read", &["source", "world", "math", "tables", "files"]),
        ("collect", &["source", "world", "read", "math"]),
        ("analysis", &["source", "world", "verdict", "math", "tables", "visible"]),
        (
            "advice",
            &["source", "world", "verdict", "math", "tables", "analysis", "rules"],
        ),
        (
            "rules",
            &[
                "source", "world", "verdict", "page", "math", "tables", "analysis", "advice",
            ],
        ),
        // The catalogue of mistakes names relations and the rules that should see them.
        ("faults", &["source", "world", "verdict", "math", "tables"]),
        ("assure", &["source", "world", "verdict", "faults", "progress"]),
        // What makes a recording fit, and what the rules say about it.
        (
            "fitness",
            &["source", "world", "verdict", "math", "analysis", "advice", "rules"],
        ),
        ("run", &["source", "world", "verdict", "page", "assure", "fitness"]),
        (
            "report",
            &[
                "source", "world", "verdict", "page", "run", "compare", "view", "tables", "visible", "assure",
                "faults", "fitness",
            ],
        ),
        ("compare", &["source", "world", "verdict", "run", "math", "tables"]),
        ("progress", &[]),
        // A fault in the configuration has a place, and the reader of documents knows places.
        (
            "config",
            &["source", "world", "read", "tables", "verdict", "run", "policy"],
        ),
        ("fix", &["source", "verdict", "run", "files"]),
        (
            "policy",
            &["source", "world", "verdict", "page", "run", "assure", "faults"],
        ),
        ("view", &["source", "world", "verdict", "run", "math", "tables"]),
        (
            "engine",
            &[
                "source", "world", "verdict", "page", "rules", "analysis", "read", "collect", "config", "run",
                "progress", "policy", "tables", "files", "visible", "assure", "faults", "fitness",
            ],
        ),
        ("convert", &["run", "world", "source", "tables", "math"]),
        (
            "cli",
            &[
                "engine", "report", "run", "verdict", "page", "rules", "convert", "tables", "config", "fix", "compare",
                "view", "files", "visible", "faults", "fitness",
            ],
        ),
    ])
}

/// A file of `src`, as what is read of it here: without comments and tests.
struct Module {
    file: String,
    /// `analysis::motion::stream`, by its parts.
    path: Vec<String>,
    text: String,
}

impl Module {
    /// Every module of `src`, in a fixed order.
    fn all() -> Vec<Self> {
        let src = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src");
        let files = files(&src, ".rs");
        let of = |file: PathBuf| {
            let file = file.strip_prefix(&src).unwrap().to_string_lossy().into_owned();
            let text = fs::read_to_string(src.join(&file)).unwrap();
            let names = file.trim_end_matches(".rs").split('/').map(str::to_owned);
            Self {
                path: names
                    .filter(|name| !["mod", "lib", "main"].contains(&name.as_str()))
                    .collect(),
                text: production(&text),
                file,
            }
        };
        files.into_iter().map(of).collect()
    }

    /// The room of the house that it is of.
    fn room(&self) -> &str {
        self.path.first().map_or("", String::as_str)
    }

    fn is_of_tests(&self) -> bool {
        self.path.iter().any(|name| name == "tests" || name == "samples")
    }
}

/// A text without its comments and what stands behind `mod tests {`; lines keep their numbers.
fn production(text: &str) -> String {
    let text = text.split("\nmod tests {").next().unwrap_or(text);
    let lines = text.lines().map(|line| {
        let is_comment = line.trim_start().starts_with("//");
        if is_comment {
            ""
        } else {
            line.split(" // ").next().unwrap_or("")
        }
    });
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// Paths that a text names, from the crate's root, with line numbers: those of `use`, and those written out.
fn used_paths(text: &str, own: &[String]) -> Vec<(usize, Vec<String>)> {
    let mut used = Vec::new();
    let mut rest = text;
    let starts = ["crate::", "super::", "self::"];
    while let Some(at) = starts.iter().filter_map(|start| rest.find(start)).min() {
        let (before, here) = rest.split_at(at);
        let is_word = before.ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
        let line = text.len() - here.len();
        let line = text.get(..line).unwrap().matches('\n').count() + 1;
        let end = tree_end(here);
        if !is_word {
            let trees = branches(here.get(..end).unwrap());
            used.extend(trees.into_iter().map(|path| (line, from_root(&path, own))));
        }
        rest = here.get(end.max(1)..).unwrap();
    }
    used
}

/// How long the path or tree of paths at the start of a text is.
fn tree_end(text: &str) -> usize {
    let mut depth = 0_usize;
    for (at, letter) in text.char_indices() {
        match letter {
            '{' if depth > 0 || text.get(..at).unwrap().ends_with("::") => depth += 1,
            '}' if depth == 1 => return at + 1,
            '}' if depth > 0 => depth -= 1,
            _ if depth > 0 || letter.is_alphanumeric() || matches!(letter, '_' | ':') => {}
            _ => return at,
        }
    }
    text.len()
}

/// `a::{b, c::d}` as `a::b` and `a::c::d`.
fn branches(tree: &str) -> Vec<Vec<String>> {
    let tree = tree.trim();
    let Some((before, inner)) = tree.split_once('{') else {
        let path = tree
            .split(" as ")
            .next()
            .unwrap_or("")
            .split("::")
            .map(|name| name.trim().to_owned());
        return vec![path.filter(|name| !name.is_empty()).collect()];
    };
    let inner = inner.strip_suffix('}').unwrap_or(inner);
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for letter in inner.chars() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if letter == ',' && depth == 0 {
            parts.push(String::new());
        } else {
            parts.last_mut().unwrap().push(letter);
        }
    }
    let before: Vec<String> = before
        .split("::")
        .map(str::to_owned)
        .filter(|name| !name.is_empty())
        .collect();
    let inner = parts
        .iter()
        .filter(|part| !part.trim().is_empty())
        .flat_map(|part| branches(part));
    inner.map(|path| [before.clone(), path].concat()).collect()
}

fn from_root(path: &[String], own: &[String]) -> Vec<String> {
    let mut base = own.to_vec();
    let mut path = path.iter().peekable();
    while let Some(name) = path.next_if(|name| ["crate", "super", "self"].contains(&name.as_str())) {
        match name.as_str() {
            "crate" => base.clear(),
            "super" => drop(base.pop()),
            _ => {}
        }
    }
    base.extend(path.cloned());
    base
}

#[test]
fn arrows_point_one_way() {
    let allowed = allowed();
    let mut wrong = Vec::new();
    for module in Module::all().iter().filter(|module| !module.path.is_empty()) {
        let room = module.room();
        let Some(may_use) = allowed.get(room) else {
            wrong.push(format!("{}: `{room}` is no room of the house", module.file));
            continue;
        };
        for (line, used) in used_paths(&module.text, &module.path) {
            let Some(used) = used.first().filter(|used| *used != room) else {
                continue;
            };
            if !may_use.contains(&used.as_str()) {
                wrong.push(format!("{}:{line}: `{room}` uses `{used}`", module.file));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Files that use each other, over others or not. That a file uses the module that it is part of is no circle.
#[test]
fn no_import_runs_in_a_circle() {
    let modules = Module::all();
    let number: BTreeMap<&[String], usize> = (0..).zip(&modules).map(|(at, one)| (one.path.as_slice(), at)).collect();
    let uses = |module: &Module| {
        let paths = used_paths(&module.text, &module.path);
        let mut used: Vec<usize> = paths
            .iter()
            .filter_map(|(_, path)| {
                let lengths = (1..=path.len()).rev();
                let file = lengths
                    .filter_map(|length| path.get(..length))
                    .find(|path| number.contains_key(path))?;
                (!module.path.starts_with(file)).then(|| number[file])
            })
            .collect();
        used.sort_unstable();
        used.dedup();
        used
    };
    let uses: Vec<Vec<usize>> = modules.iter().map(uses).collect();
    assert!(
        uses.iter().map(Vec::len).sum::<usize>() > 1000,
        "the imports are not seen"
    );
    let reached = |from: usize| {
        let (mut reached, mut open) = (vec![false; modules.len()], uses[from].clone());
        while let Some(at) = open.pop() {
            if !std::mem::replace(&mut reached[at], true) {
                open.extend(&uses[at]);
            }
        }
        reached
    };
    let circles: Vec<&str> = (0..modules.len())
        .filter(|at| reached(*at)[*at])
        .map(|at| modules[at].file.as_str())
        .collect();
    assert!(circles.is_empty(), "in circles: {circles:#?}");
}

#[test]
fn rules_use_no_other_rule_and_analyses_name_none() {
    let codes: Vec<&str> = RULES.iter().map(|entry| entry.code.as_str()).collect();
    let mut wrong = Vec::new();
    for module in Module::all().iter().filter(|module| !module.is_of_tests()) {
        if module.file == "rules/registry.rs" {
            continue;
        }
        let room = module.room();
        for (number, line) in module.text.lines().enumerate() {
            // What a configuration may look like is shown to the user, with a rule for an example.
            let is_example = matches!(room, "config" | "faults") || module.file == "report/init.rs";
            for code in codes.iter().filter(|code| line.contains(**code)) {
                let is_quoted = line.split(code).next().unwrap_or("").matches('"').count() % 2 == 1;
                if room == "analysis" || is_quoted && !is_example {
                    wrong.push(format!("{}:{}: names {code}", module.file, number + 1));
                }
            }
        }
        for (line, used) in used_paths(&module.text, &module.path) {
            let is_finding =
                used.first().is_some_and(|room| room == "verdict") && used.iter().any(|name| name == "Finding");
            if room == "analysis" && is_finding {
                wrong.push(format!("{}:{line}: makes findings", module.file));
            }
            if let ([_, family, rule, ..], ["rules", own_family, own_rule, ..]) = (
                used.as_slice(),
                &*module.path.iter().map(String::as_str).collect::<Vec<_>>(),
            ) && used.first().is_some_and(|room| room == "rules")
                && family != "prelude"
                && (family, rule) != (&(*own_family).to_owned(), &(*own_rule).to_owned())
            {
                wrong.push(format!("{}:{line}: uses the rule `{family}/{rule}`", module.file));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A rule is read in one sitting.
#[test]
fn the_median_rule_has_120_lines_or_fewer() {
    let src = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src/rules");
    let files = files(&src, ".rs");
    let lines_of = |entry: &frames_lint::rules::Entry| {
        let name = entry.page.name.replace('-', "_");
        let file = files
            .iter()
            .find(|file| file.file_stem().is_some_and(|stem| *stem == *name));
        file.map_or(0, |file| fs::read_to_string(file).unwrap().lines().count())
    };
    let mut lines: Vec<usize> = RULES.iter().map(lines_of).filter(|lines| *lines > 0).collect();
    lines.sort_unstable();
    assert!(
        lines.len() > RULES.len() * 9 / 10,
        "rules have the names of their pages"
    );
    assert!(
        lines[lines.len() / 2] <= 120,
        "the median rule has {} lines",
        lines[lines.len() / 2]
    );
}

#[test]
fn the_tests_see_an_arrow() {
    let own = ["analysis", "motion"].map(str::to_owned);
    let paths = |text: &str| {
        let used = used_paths(&production(text), &own);
        used.into_iter()
            .map(|(line, path)| format!("{line} {}", path.join("::")))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        paths("use crate::{read, world::{Claim, bag::TfEdge as Edge}};\n"),
        ["1 read", "1 world::Claim", "1 world::bag::TfEdge"]
    );
    assert_eq!(
        paths("// crate::read\nlet x = crate::math::f(super::names::is_world);"),
        ["2 math::f", "2 analysis::names::is_world"]
    );
}

#[test]
fn only_one_file_knows_the_terminal_renderer() {
    let src = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src");
    let files = files(&src, ".rs");
    let knowing: Vec<String> = files
        .iter()
        .filter(|file| fs::read_to_string(file).unwrap().contains("miette::"))
        .map(|file| file.strip_prefix(&src).unwrap().display().to_string())
        .collect();
    assert_eq!(knowing, ["report/terminal/snippet.rs"]);
}
