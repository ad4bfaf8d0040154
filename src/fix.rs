//! Applies fixes: the edits of findings, all edits of a fix or none.
//!
//! Plans on the texts that were read, then writes. A file that differs from the text that was read (changed since, UTF-16, inside a
//! recording, the expansion of a macro) is not changed, and the reason is reported.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};

use similar::TextDiff;

use crate::files;
use crate::run::Run;
use crate::source::{Source, SourceId, Span};
use crate::verdict::{Edit, Finding, Safety};

/// UTF-8 files may begin with it.
const BYTE_ORDER_MARK: &str = "\u{feff}";

/// A file with its fixes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patch {
    /// Its path.
    pub path: String,
    /// The text that was read, with a byte order mark if the file has one.
    pub before: String,
    /// The text with the fixes.
    pub after: String,
}

/// The planned changes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// The files that change, in the order of their paths.
    pub patches: Vec<Patch>,
    /// Number of fixes in them.
    pub fixed: usize,
    /// Reasons of the fixes that cannot be applied: `robot.urdf: the file has changed`.
    pub left: Vec<String>,
    /// Number of fixes that change behaviour and were not requested.
    pub not_asked: usize,
}

/// Plans the fixes of findings that are not accepted; those that change behaviour only if `all` is set. Files that are read-only, have
/// several names, or are outside of the `checked` paths are changed only if `checked` is `None`.
pub fn plan(run: &Run, all: bool, checked: Option<&[PathBuf]>) -> Plan {
    let mut plan = Plan::default();
    let mut edits: BTreeMap<SourceId, Vec<(Span, &str)>> = BTreeMap::new();
    let mut texts: BTreeMap<SourceId, Result<bool, String>> = BTreeMap::new();
    for finding in run.verdict.open() {
        let Some(fix) = &finding.fix else { continue };
        if fix.safety != Safety::Safe && !all {
            plan.not_asked += 1;
            continue;
        }
        match fits(&fix.edits, run, checked, &edits, &mut texts) {
            Ok(new) => {
                for (source, span, text) in new {
                    edits.entry(source).or_default().push((span, text));
                }
                plan.fixed += 1;
            }
            Err(why) => plan.left.push(format!("{}: {why}", about(finding))),
        }
    }
    for (id, mut edits) in edits {
        let Some(source) = run.sources.get(id.0 as usize) else {
            continue;
        };
        let mark = if matches!(texts.get(&id), Some(Ok(true))) {
            BYTE_ORDER_MARK
        } else {
            ""
        };
        edits.sort_unstable();
        plan.patches.push(Patch {
            path: source.path.clone(),
            before: format!("{mark}{}", source.text),
            after: format!("{mark}{}", applied(&source.text, &edits)),
        });
    }
    plan.patches.sort_by(|a, b| a.path.cmp(&b.path));
    plan
}

fn about(finding: &Finding) -> String {
    format!("{} on {}", finding.rule, finding.subject)
}

/// The edits of a fix that are not planned yet, if none of them conflicts with other fixes.
fn fits<'e>(
    wanted: &'e [Edit],
    run: &Run,
    checked: Option<&[PathBuf]>,
    known: &BTreeMap<SourceId, Vec<(Span, &str)>>,
    texts: &mut BTreeMap<SourceId, Result<bool, String>>,
) -> Result<Vec<(SourceId, Span, &'e str)>, String> {
    let mut new: Vec<(SourceId, Span, &str)> = Vec::new();
    for edit in wanted {
        let id = edit.place.source;
        let source = run.sources.get(id.0 as usize).ok_or("the fix is not in a file")?;
        texts.entry(id).or_insert_with(|| has_mark(source, checked)).clone()?;
        let span = edit.place.span().ok_or("the fix is not in a text file")?;
        if source.text.get(span.start..span.end).is_none() {
            return Err(format!("{}: the place is not in the text", source.path));
        }
        let others = known.get(&id).into_iter().flatten().copied();
        let own = new.iter().filter(|one| one.0 == id).map(|one| (one.1, one.2));
        let mut is_made = false;
        for (other, text) in others.chain(own) {
            if other == span && text == edit.replacement {
                is_made = true;
            } else if span.start <= other.end && other.start <= span.end {
                return Err(format!(
                    "{}: another fix changes the same place; run --fix again for this one",
                    source.path
                ));
            }
        }
        if !is_made {
            new.push((id, span, &edit.replacement));
        }
    }
    Ok(new)
}

/// Whether the file begins with a byte order mark; the error says why it cannot be changed.
fn has_mark(source: &Source, checked: Option<&[PathBuf]>) -> Result<bool, String> {
    let path = &source.path;
    if source.derived.is_some() {
        return Err(format!(
            "{path}: the text is part of a recording or a xacro expansion; edit its origin by hand"
        ));
    }
    if let Some(why) = checked.and_then(|checked| files::unmeant(Path::new(path), checked)) {
        return Err(format!("{path}: {why}; change it anyway with --force"));
    }
    if !files::may_be_replaced(Path::new(path)) {
        return Err(format!("{path}: its folder is read-only"));
    }
    let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
    let text = String::from_utf8(bytes).map_err(|_| format!("{path}: it is not UTF-8; save it as UTF-8 first"))?;
    match text.strip_prefix(BYTE_ORDER_MARK) {
        Some(rest) if rest == source.text => Ok(true),
        None if text == source.text => Ok(false),
        _ => Err(format!(
            "{path}: it is not the text that was read: it has changed since, or is not UTF-8"
        )),
    }
}

/// A text with the edits made, which are in order and do not touch.
fn applied(text: &str, edits: &[(Span, &str)]) -> String {
    let mut out = String::with_capacity(text.len());
    let mut from = 0;
    for (span, replacement) in edits {
        out.push_str(text.get(from..span.start).unwrap_or_default());
        out.push_str(replacement);
        from = span.end;
    }
    out.push_str(text.get(from..).unwrap_or_default());
    out
}

impl Plan {
    /// Writes the files, each completely or not at all. Returns the paths that could not be written, with the system's messages.
    pub fn write(&self) -> Vec<String> {
        let written = self.patches.iter().map(|patch| {
            files::write(Path::new(&patch.path), patch.after.as_bytes())
                .map_err(|error| format!("cannot write `{}`: {error}", patch.path))
        });
        written.filter_map(Result::err).collect()
    }

    /// The changes as a unified diff for `patch` and `git apply`.
    pub fn diff(&self) -> String {
        self.patches
            .iter()
            .map(|patch| {
                let path = from_here(&patch.path);
                TextDiff::from_lines(&patch.before, &patch.after)
                    .unified_diff()
                    .header(&header("a/", &path), &header("b/", &path))
                    .to_string()
            })
            .collect()
    }
}

/// A path for `patch -p1`: relative to the working directory, or to the root (`patch -p1 -d /`) if it is not below it.
fn from_here(path: &str) -> String {
    let is_plain = |path: &Path| path.components().all(|part| matches!(part, Component::Normal(_)));
    let here = std::env::current_dir().and_then(std::fs::canonicalize);
    match (std::fs::canonicalize(path), here) {
        (Ok(whole), Ok(here)) if !is_plain(Path::new(path)) => {
            let short = whole.strip_prefix(&here).or_else(|_| whole.strip_prefix("/"));
            short.unwrap_or(&whole).display().to_string()
        }
        _ => path.to_owned(),
    }
}

/// A path as `git diff` writes it: a tab ends one with a space, and one with characters that would end the line is quoted.
fn header(side: &str, path: &str) -> String {
    let is_odd = |c: char| c.is_control() || matches!(c, '"' | '\\');
    if path.contains(is_odd) {
        let mut quoted = format!("\"{side}");
        for byte in path.bytes() {
            match byte {
                b'"' | b'\\' => quoted.extend(['\\', char::from(byte)]),
                0x20..0x7f => quoted.push(char::from(byte)),
                _ => {
                    let _ = write!(quoted, "\\{byte:03o}");
                }
            }
        }
        quoted + "\""
    } else {
        let end = if path.contains(' ') { "\t" } else { "" };
        format!("{side}{path}{end}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{Place, SourceKind};

    /// A fix: how safe it is, and spans with their replacements.
    type Case<'a> = (Safety, &'a [(usize, usize, &'a str)]);

    /// A run with one file of this text and findings with these fixes: spans and replacements.
    fn run(path: &Path, text: &str, fixes: &[Case]) -> Run {
        let id = SourceId(0);
        let mut source = Source::new(id, path.display().to_string(), SourceKind::Urdf);
        source.text = text.to_owned();
        let mut run = Run {
            sources: vec![source.into()],
            ..Run::default()
        };
        for (index, (safety, edits)) in fixes.iter().enumerate() {
            let edit = |(start, end, text): &(usize, usize, &str)| Edit {
                place: Place::text(id, Span::new(*start, *end)),
                replacement: (*text).to_owned(),
            };
            let finding = Finding::error(format!("{index}"), "m", Place::whole(id));
            let edits = edits.iter().map(edit).collect();
            run.verdict.findings.push(finding.fix("t", *safety, edits));
        }
        run
    }

    fn file(text: &str) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.urdf");
        std::fs::write(&path, text).unwrap();
        (folder, path)
    }

    #[test]
    fn only_what_is_meant_changes_and_marks_and_line_ends_stay() {
        let text = "a\r\nbb\r\nccc";
        let (_folder, path) = file(&format!("{BYTE_ORDER_MARK}{text}"));
        let run = run(
            &path,
            text,
            &[
                (Safety::Safe, &[(7, 10, "C"), (0, 1, "AA")]),
                (Safety::ChangesBehaviour, &[(3, 5, "")]),
            ],
        );
        let safe = plan(&run, false, None);
        assert_eq!((safe.fixed, safe.not_asked, safe.patches.len()), (1, 1, 1));
        assert!(safe.write().is_empty());
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            format!("{BYTE_ORDER_MARK}AA\r\nbb\r\nC")
        );
    }

    #[test]
    fn a_fix_that_touches_another_waits_and_none_is_made_by_half() {
        let text = "0123456789";
        let (_folder, path) = file(text);
        let run = run(
            &path,
            text,
            &[
                (Safety::Safe, &[(2, 4, "x")]),
                (Safety::Safe, &[(3, 5, "y"), (8, 9, "z")]),
                // The same edit twice is one.
                (Safety::Safe, &[(2, 4, "x"), (6, 7, "w")]),
            ],
        );
        let plan = plan(&run, false, None);
        assert_eq!((plan.fixed, plan.left.len()), (2, 1));
        assert!(plan.left[0].contains("run --fix again"), "{:?}", plan.left);
        assert_eq!(plan.patches[0].after, "01x45w789");
    }

    #[test]
    fn what_is_not_what_was_read_stays() {
        let (_folder, path) = file("other");
        let changed = plan(&run(&path, "text", &[(Safety::Safe, &[(0, 1, "T")])]), false, None);
        assert_eq!((changed.fixed, changed.patches.len()), (0, 0));
        assert!(
            changed.left[0].contains("not the text that was read"),
            "{:?}",
            changed.left
        );
        std::fs::write(&path, [0x74, 0xe9]).unwrap();
        let latin = plan(&run(&path, "t\u{e9}", &[(Safety::Safe, &[(0, 1, "T")])]), false, None);
        assert!(latin.left[0].contains("not UTF-8"), "{:?}", latin.left);
    }

    #[test]
    fn a_diff_is_one_that_tools_take() {
        let (_folder, path) = file("a\nb\n");
        let mut plan = plan(&run(&path, "a\nb\n", &[(Safety::Safe, &[(2, 3, "c")])]), false, None);
        plan.patches[0].path = "dir/a.urdf".to_owned();
        assert_eq!(
            plan.diff(),
            "--- a/dir/a.urdf\n+++ b/dir/a.urdf\n@@ -1,2 +1,2 @@\n a\n-b\n+c\n"
        );
    }

    #[test]
    fn paths_in_a_diff_are_those_of_git() {
        assert_eq!(header("a/", "car.urdf"), "a/car.urdf");
        assert_eq!(header("a/", "my car/car.urdf"), "a/my car/car.urdf\t");
        assert_eq!(header("b/", "a\nb\"é"), "\"b/a\\012b\\\"\\303\\251\"");
    }

    #[test]
    fn waived_findings_are_left_alone() {
        let (_folder, path) = file("a");
        let mut run = run(&path, "a", &[(Safety::Safe, &[(0, 1, "b")])]);
        run.verdict.findings[0].waived = Some(crate::verdict::Acceptance {
            reason: "r".to_owned(),
            by: None,
            until: None,
            origin: "o".to_owned(),
        });
        assert_eq!(plan(&run, true, None), Plan::default());
    }
}
