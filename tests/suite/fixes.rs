//! Fixes: a fault is put in, `--fix` takes it out, a second run has nothing to do, and nothing else in the file has changed.

#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::string_slice,
    clippy::print_stderr,
    clippy::panic
)]

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use frames_lint::engine::{self, Options};
use frames_lint::fix::{self, Plan};
use frames_lint::math::relation::Relation;
use frames_lint::page::Page;
use frames_lint::run::Run;
use frames_lint::tables::{FileTemplate, TransformTemplate, writings};
use frames_lint::verdict::Finding;
use frames_lint::world::{Claim, ClaimKind, Literal, Spelling};
use nalgebra::Isometry3;
use rayon::prelude::*;

use crate::dialects::{folder_of, truth};
use crate::support;
use crate::support::dialects::frames;

fn check(folder: &Path, select: &[&str]) -> Run {
    engine::check(&Options {
        paths: vec![folder.to_path_buf()],
        select: select.iter().map(|rule| (*rule).to_owned()).collect(),
        ..Options::default()
    })
    .unwrap()
}

/// Applies every fix until none is left, and says how many there were.
fn correct(folder: &Path, select: &[&str]) -> (Run, usize) {
    let mut fixed = 0;
    for _ in 0..8 {
        let run = check(folder, select);
        let plan = fix::plan(&run, true, None);
        if plan.patches.is_empty() {
            return (run, fixed);
        }
        fixed += plan.fixed;
        assert!(plan.write().is_empty());
    }
    panic!("fixes have no end in {}", folder.display());
}

fn with_fix(run: &Run) -> Vec<&Finding> {
    run.verdict
        .findings
        .iter()
        .filter(|finding| finding.fix.is_some())
        .collect()
}

/// What is wrong with the fixes of a bad case, which was judged: where there are any, nothing is left of them behind them.
pub(crate) fn uncorrected(page: &Page, title: &str, folder: &Path, run: &Run) -> Option<String> {
    let fixable = with_fix(run).iter().filter(|finding| finding.rule == page.code).count();
    if fixable == 0 {
        return None;
    }
    let of_rule = |run: &Run| {
        let findings = run.verdict.findings.iter();
        findings.filter(|finding| finding.rule == page.code).count()
    };
    let (after, fixed) = correct(folder, &[]);
    let left = of_rule(run) - fixable;
    if fixed > 0 && of_rule(&after) <= left && with_fix(&after).is_empty() {
        return None;
    }
    let findings = after.verdict.findings.iter();
    let told: Vec<&str> = findings.map(|finding| finding.message.as_str()).collect();
    Some(format!("{} {title}: fixed {fixed}, and then {told:?}", page.code))
}

/// Errors that can be undone.
const ERRORS: [Relation; 9] = [
    Relation::Inverse,
    Relation::Transposed,
    Relation::Wxyz,
    Relation::Xyzw,
    Relation::Millimetres,
    Relation::MirroredY,
    Relation::Optical,
    Relation::Z180,
    Relation::Degrees,
];

/// A configuration in which the user says which frames of the description a file is about: else nothing is sure.
fn declared(writing: &FileTemplate, transform: &TransformTemplate) -> String {
    let folder = folder_of(writing, transform, truth());
    let run = check(folder.path(), &["CROSS01"]);
    let (target, source) = frames(writing, transform);
    let mut text = "transforms:\n".to_owned();
    for claim in run.worlds.iter().flat_map(|world| &world.claims) {
        let (Some(pose), true) = (claim.pose, matches!(claim.kind, ClaimKind::File { .. })) else {
            continue;
        };
        let is_near = |truth: Isometry3<f64>| (truth.inverse() * pose.isometry()).translation.vector.norm() < 1e-3;
        let key = claim.label.replace('[', "[[]").replace('\'', "''");
        if is_near(truth()) {
            writeln!(text, "  - {{key: '{key}', is: '{target} from {source}'}}").unwrap();
        } else if is_near(truth().inverse()) {
            writeln!(text, "  - {{key: '{key}', is: '{source} from {target}'}}").unwrap();
        }
    }
    text + "  - {key: nothing, is: nobody from nowhere}\n"
}

#[test]
fn an_error_that_is_sure_is_taken_out_of_a_file_of_any_dialect() {
    let all: Vec<_> = writings()
        .iter()
        .flat_map(|writing| writing.transforms.iter().map(move |transform| (writing, transform)))
        .flat_map(|(writing, transform)| ERRORS.map(|error| (writing, transform, error)))
        .collect();
    let results: Vec<(String, &str, bool, Option<String>)> = all
        .par_iter()
        .map(|(writing, transform, error)| {
            let held = error.apply(&truth()).unwrap();
            let folder = folder_of(writing, transform, held);
            fs::write(folder.path().join("frames-lint.yaml"), declared(writing, transform)).unwrap();
            let run = check(folder.path(), &["CROSS01", "CROSS02"]);
            let name = format!("{} {} {}", writing.dialect, transform.key, error.word());
            let sure = run.verdict.findings.iter().find(|finding| {
                let alike = finding
                    .measured
                    .iter()
                    .find(|measured| measured.what == "known errors that explain it");
                finding.rule == "CROSS02"
                    && finding.confidence == frames_lint::source::Confidence::Certain
                    && alike.is_some_and(|alike| alike.value < 1.5)
            });
            let Some(sure) = sure else {
                return (name, "unsure", false, None);
            };
            if sure.fix.is_none() {
                return (name, "sure", false, None);
            }
            let (after, _) = correct(folder.path(), &["CROSS01", "CROSS02"]);
            let told: Vec<&str> = after
                .verdict
                .findings
                .iter()
                .map(|finding| finding.message.as_str())
                .collect();
            let agrees = after.verdict.rows.iter().any(|row| {
                row.rule == "CROSS01"
                    && row
                        .measured
                        .iter()
                        .all(|measured| measured.value.abs() < 1e-5 || measured.unit == "1")
            });
            let fault = (!told.is_empty() || !agrees).then(|| format!("{name}: {told:?}"));
            (name, "sure", true, fault)
        })
        .collect();
    let faults: Vec<&str> = results.iter().filter_map(|result| result.3.as_deref()).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let sure = results.iter().filter(|result| result.1 == "sure").count();
    let unfixed: Vec<&str> = results
        .iter()
        .filter(|result| result.1 == "sure" && !result.2)
        .map(|result| result.0.as_str())
        .collect();
    eprintln!(
        "{} errors, {sure} sure, {} of them without a fix: {unfixed:#?}",
        results.len(),
        unfixed.len()
    );
    // Degrees that were made a quaternion or a matrix have wrapped around: nothing brings them back.
    let lost: Vec<&&str> = unfixed.iter().filter(|name| !name.ends_with(" degrees")).collect();
    assert!(sure > 200 && lost.is_empty(), "{sure} sure, not fixed: {lost:#?}");
}

/// A fault in a text: what is replaced where, and the rule that says so. `None` where the text has no place for it.
type Injection = fn(&str) -> Option<(String, &'static str)>;

/// The first place between two marks behind `from`.
fn between<'t>(text: &'t str, before: &str, after: &str) -> Option<(usize, &'t str)> {
    let start = text.find(before)? + before.len();
    let end = start + text[start..].find(after)?;
    Some((start, &text[start..end]))
}

fn put(text: &str, at: usize, old: &str, new: &str) -> String {
    format!("{}{new}{}", &text[..at], &text[at + old.len()..])
}

/// The angles of the first joint to an optical frame, where they are those of REP-103 to three digits.
fn optical(text: &str) -> Option<(usize, &str)> {
    let mut from = 0;
    while let Some(at) = text[from..].find("<joint ") {
        let start = from + at;
        let end = start + text[start..].find("</joint>")?;
        from = end;
        let (_, child) = between(&text[start..end], "<child link=\"", "\"").unwrap_or_default();
        let Some((at, rpy)) = between(&text[start..end], "rpy=\"", "\"") else {
            continue;
        };
        let angles: Vec<f64> = rpy.split_whitespace().filter_map(|angle| angle.parse().ok()).collect();
        let is_near = |(angle, right): (&f64, f64)| (angle - right).abs() < 1e-2;
        let right = [-FRAC_PI_2, 0.0, -FRAC_PI_2];
        if child.ends_with("optical_frame") && angles.len() == 3 && angles.iter().zip(right).all(is_near) {
            return Some((start + at, rpy));
        }
    }
    None
}

const FAULTS: [(&str, Injection); 7] = [
    ("a blank behind a parent's name", |text| {
        let (at, name) = between(text, "<parent link=\"", "\"")?;
        Some((put(text, at, name, &format!("{name} ")), "NAME02"))
    }),
    ("a slash before a child's name", |text| {
        let (at, name) = between(text, "<child link=\"", "\"")?;
        Some((put(text, at, name, &format!("/{name}")), "NAME02"))
    }),
    ("a capital in a parent's name", |text| {
        let (at, name) = between(text, "<parent link=\"", "\"")?;
        let mut other = name.to_owned();
        let first = other.get_mut(0..1)?;
        if first.chars().all(char::is_lowercase) {
            first.make_ascii_uppercase();
        } else {
            first.make_ascii_lowercase();
        }
        (other != name).then(|| (put(text, at, name, &other), "NAME01"))
    }),
    ("pi with two digits", |text| {
        let (at, rpy) = between(text, "rpy=\"", "\"")?;
        rpy.starts_with("0 0 0")
            .then(|| (put(text, at, rpy, "0 0 1.57"), "ROT09"))
    }),
    ("degrees", |text| {
        let (at, rpy) = between(text, "rpy=\"", "\"")?;
        rpy.starts_with("0 0 0")
            .then(|| (put(text, at, rpy, "0 0 90"), "ROT08"))
    }),
    ("an optical frame that is not turned", |text| {
        let (at, rpy) = optical(text)?;
        Some((put(text, at, rpy, "0 0 0"), "NAME06"))
    }),
    ("a comma between numbers", |text| {
        let (at, xyz) = between(text, "xyz=\"", "\"")?;
        let parts: Vec<&str> = xyz.split_whitespace().collect();
        (parts.len() == 3).then(|| (put(text, at, xyz, &parts.join(", ")), "URDF10"))
    }),
];

/// What a text says, however its numbers are spelled: names as they are, numbers by value.
fn said(text: &str) -> Vec<String> {
    text.split(|c: char| c.is_whitespace() || "\"'<>=/".contains(c))
        .filter(|word| !word.is_empty())
        .map(|word| {
            word.parse::<f64>()
                .map_or_else(|_| word.to_owned(), |number| format!("{number:.9}"))
        })
        .collect()
}

/// Whether a fault in a healthy text is found and has a fix, and what is wrong where that does not give the healthy text again. Some
/// descriptions are such that the fault is none: nobody else spells the name, or the joint carries nothing.
fn corrected(healthy: &str, broken: &str, rule: &str) -> Result<bool, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let file = folder.path().join("robot.urdf");
    fs::write(&file, healthy).map_err(|error| error.to_string())?;
    if !check(folder.path(), &[rule]).verdict.findings.is_empty() {
        return Ok(false);
    }
    fs::write(&file, broken).map_err(|error| error.to_string())?;
    // Nor is a fix of a text that xacro expanded one for the file.
    if fix::plan(&check(folder.path(), &[rule]), true, None).patches.is_empty() {
        return Ok(false);
    }
    let (after, _) = correct(folder.path(), &[rule]);
    if let Some(left) = after.verdict.findings.first() {
        return Err(format!("still said: {}", left.message));
    }
    let corrected = fs::read_to_string(&file).map_err(|error| error.to_string())?;
    let is_right = match rule {
        "NAME01" | "NAME02" => corrected == healthy,
        "URDF10" => said(&corrected) == said(healthy),
        _ => {
            let (at, rpy, turned) = match rule {
                "NAME06" => optical(healthy).map(|(at, rpy)| (at, rpy, format!("-{FRAC_PI_2} 0 -{FRAC_PI_2}"))),
                _ => between(healthy, "rpy=\"", "\"").map(|(at, rpy)| (at, rpy, format!("0 0 {FRAC_PI_2}"))),
            }
            .unwrap();
            let end = at + rpy.len();
            let right = format!("{}{turned}{}", &healthy[..at], &healthy[end..]);
            said(&corrected) == said(&right)
                && corrected.starts_with(&healthy[..at])
                && corrected.ends_with(&healthy[end..])
        }
    };
    if is_right {
        Ok(true)
    } else {
        Err(format!("fixed to another text: {corrected}"))
    }
}

/// What became of one fault in one text: as [`corrected`] has it.
type Outcome = (&'static str, Result<bool, String>);

/// Puts faults into every file of the corpus with one of these endings and not more bytes. Each that has a fix must be fixed, and each
/// kind of fault so often at least.
fn over_corpus(
    (endings, max_bytes): (&[&str], usize),
    kinds: &[&str],
    least: usize,
    put: impl Fn(&Path, &str) -> Vec<Outcome> + Sync,
) {
    let Some(corpus) = support::corpus() else {
        return;
    };
    let mut files = Vec::new();
    with_ending(&corpus, endings, &mut files);
    // Faults are handed back: what a thread of the pool prints is lost.
    let results: Vec<(&PathBuf, Outcome)> = files
        .par_iter()
        .flat_map_iter(|path| {
            let text = fs::read_to_string(path).ok().filter(|text| text.len() <= max_bytes);
            let outcomes = text.map(|text| put(path, &text)).unwrap_or_default();
            outcomes.into_iter().map(move |outcome| (path, outcome))
        })
        .collect();
    let mut total: BTreeMap<&str, usize> = BTreeMap::new();
    let mut faults = Vec::new();
    for (path, (what, outcome)) in results {
        match outcome {
            Ok(true) => *total.entry(what).or_default() += 1,
            Ok(false) => {}
            Err(fault) => faults.push(format!("{}: {what}: {fault}", path.display())),
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    eprintln!("{} files, fixed: {total:#?}", files.len());
    for what in kinds {
        assert!(
            total.get(what).is_some_and(|count| *count >= least),
            "{what}: {total:?}"
        );
    }
}

#[test]
fn faults_put_into_healthy_descriptions_are_corrected_and_nothing_else_changes() {
    let kinds = FAULTS.map(|(what, _)| what);
    over_corpus((&["urdf"], 200_000), &kinds, 5, |_, healthy| {
        let broken = FAULTS
            .iter()
            .filter_map(|(what, inject)| Some((*what, inject(healthy)?)));
        broken
            .map(|(what, (broken, rule))| (what, corrected(healthy, &broken, rule)))
            .collect()
    });
}

/// A fault in the numbers of a statement: the texts of its literals, rotation first, and the rule that says so.
type Misstatement = fn(&Claim) -> Option<(Vec<String>, &'static str)>;

const MISSTATEMENTS: [(&str, Misstatement); 5] = [
    ("a quaternion that is not of length one", |claim| {
        matches!(claim.spelling, Spelling::Quaternion { .. }).then(|| (scaled(claim, 1.01, 1.0), "ROT04"))
    }),
    ("a 4x4 matrix stored transposed", |claim| {
        let moves = claim.pose.as_ref()?.isometry().translation.vector.norm() > 1e-3;
        (moves && matches!(claim.matrix()?, (4, 4, _))).then(|| (reordered(claim, |at| at % 4 * 4 + at / 4), "ROT03"))
    }),
    ("a 3x4 matrix stored column by column", |claim| {
        matches!(claim.matrix()?, (3, 4, _)).then(|| (reordered(claim, |at| at % 3 * 4 + at / 3), "ROT03"))
    }),
    ("angles in degrees", |claim| {
        matches!(claim.spelling, Spelling::Rpy { .. }).then(|| (scaled(claim, 1f64.to_degrees(), 1.0), "ROT08"))
    }),
    ("a translation in millimetres", |claim| {
        let is_matrix = claim.matrix().is_some();
        (claim.has_translation && !is_matrix).then(|| (scaled(claim, 1.0, 1000.0), "ROT06"))
    }),
];

/// Every number of a statement once: a matrix of four columns has its translation within.
fn literals(claim: &Claim) -> Vec<&Literal> {
    let is_whole = claim.matrix().is_some_and(|(_, cols, _)| cols == 4);
    let translation = if is_whole {
        &[]
    } else {
        claim.translation_literals.as_slice()
    };
    claim.rotation_literals.iter().chain(translation).collect()
}

fn scaled(claim: &Claim, rotation: f64, translation: f64) -> Vec<String> {
    let spell = |literal: &Literal, factor: f64| {
        if (factor - 1.0).abs() < f64::EPSILON {
            literal.text.to_string()
        } else {
            format!("{:?}", literal.value * factor)
        }
    };
    let rotation = claim.rotation_literals.iter().map(|literal| spell(literal, rotation));
    let translation = claim
        .translation_literals
        .iter()
        .map(|literal| spell(literal, translation));
    rotation.chain(translation).collect()
}

fn reordered(claim: &Claim, from: fn(usize) -> usize) -> Vec<String> {
    let texts: Vec<String> = literals(claim).iter().map(|literal| literal.text.to_string()).collect();
    (0..texts.len()).map(|at| texts[from(at)].clone()).collect()
}

/// A text with other words where the literals stand.
fn restated(text: &str, literals: &[&Literal], words: &[String]) -> String {
    let mut parts: Vec<(&Literal, &String)> = literals.iter().copied().zip(words).collect();
    parts.sort_by_key(|(literal, _)| literal.span.start);
    let mut restated = String::new();
    let mut end = 0;
    for (literal, word) in parts {
        restated.push_str(&text[end..literal.span.start]);
        restated.push_str(word);
        end = literal.span.end;
    }
    restated + &text[end..]
}

/// The statements of a file that stand in its text, each number at a place of its own.
fn statements(file: &Path) -> Vec<Claim> {
    let run = engine::read(&Options {
        paths: vec![file.to_path_buf()],
        without_config: true,
        ..Options::default()
    })
    .unwrap();
    let claims = run.worlds.iter().flat_map(|world| world.claims.iter().cloned());
    claims
        .filter(|claim| {
            let mut spans: Vec<_> = literals(claim).iter().map(|literal| literal.span.start).collect();
            let count = spans.len();
            spans.sort_unstable();
            spans.dedup();
            claim.pose.is_some() && count >= 3 && spans.len() == count
        })
        .collect()
}

/// As [`corrected`], for the numbers of one statement of a calibration.
fn calibration_fixed(name: &str, healthy: &str, at: usize, misstate: Misstatement) -> Result<bool, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let file = folder.path().join(name);
    let wrote = |text: &str| fs::write(&file, text).map_err(|error| error.to_string());
    wrote(healthy)?;
    let Some(claim) = statements(&file).into_iter().nth(at) else {
        return Ok(false);
    };
    let Some((words, rule)) = misstate(&claim) else {
        return Ok(false);
    };
    let own = literals(&claim);
    let is_there = own
        .iter()
        .all(|literal| healthy.get(literal.span.start..literal.span.end) == Some(&*literal.text));
    if !is_there || !check(folder.path(), &[rule]).verdict.findings.is_empty() {
        return Ok(false);
    }
    wrote(&restated(healthy, &own, &words))?;
    if fix::plan(&check(folder.path(), &[rule]), true, None).patches.is_empty() {
        return Ok(false);
    }
    let (after, _) = correct(folder.path(), &[rule]);
    if let Some(left) = after.verdict.findings.first() {
        return Err(format!("still said: {}", left.message));
    }
    let corrected = fs::read_to_string(&file).map_err(|error| error.to_string())?;
    let Some(now) = statements(&file).into_iter().nth(at) else {
        return Err("the statement is gone".to_owned());
    };
    let blank = |text: &str, claim: &Claim| {
        let own = literals(claim);
        restated(text, &own, &vec!["#".to_owned(); own.len()])
    };
    if blank(&corrected, &now) != blank(healthy, &claim) {
        return Err(format!("something else changed: {corrected}"));
    }
    // A quaternion of seven digits was itself of length one to seven digits only.
    let within = if rule == "ROT04" { 1e-6 } else { 1e-9 };
    let is_one = |(now, before): (&&Literal, &&Literal)| {
        (now.value - before.value).abs() <= within * before.value.abs().max(1.0)
    };
    if literals(&now).iter().zip(&own).all(is_one) {
        Ok(true)
    } else {
        Err(format!("fixed to other numbers: {:?}", literals(&now)))
    }
}

fn with_ending(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            with_ending(&path, endings, found);
        } else if path
            .extension()
            .is_some_and(|ending| endings.iter().any(|one| ending == *one))
        {
            found.push(path);
        }
    }
}

/// So many statements of one file are misstated.
const MOST: usize = 12;

#[test]
fn faults_put_into_healthy_calibrations_are_corrected_and_nothing_else_changes() {
    let kinds = MISSTATEMENTS.map(|(what, _)| what);
    let endings = ["yaml", "yml", "json", "txt"];
    over_corpus((&endings, 100_000), &kinds, 3, |path, healthy| {
        let name = path.file_name().unwrap().to_string_lossy();
        let each =
            |at: usize| MISSTATEMENTS.map(|(what, misstate)| (what, calibration_fixed(&name, healthy, at, misstate)));
        (0..statements(path).len().min(MOST)).flat_map(each).collect()
    });
}

#[test]
fn a_plan_of_a_healthy_platform_is_empty() {
    for robot in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/robots")).unwrap() {
        let folder = tempfile::tempdir().unwrap();
        support::copy_platform(&robot.unwrap().path(), folder.path());
        assert_eq!(fix::plan(&check(folder.path(), &[]), true, None), Plan::default());
    }
}

/// A camera frame that was never turned (changes behaviour), and pi with three digits (safe).
const ROBOT: &str = "<robot name=\"r\">\r\n  <link name=\"base_link\"/>\r\n  <link name=\"camera_link\"/>\r\n  <link name=\"camera_optical_frame\"/>\r\n  \
                     <joint name=\"a\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"camera_link\"/><origin xyz=\"1 0 1\" rpy=\"0 0 1.57\"/></joint>\r\n  \
                     <joint name=\"b\" type=\"fixed\"><parent link=\"camera_link\"/><child link=\"camera_optical_frame\"/><origin xyz=\"0 0 0\" rpy=\"0 0 0\"/></joint>\r\n</robot>\r\n";

/// The third axis is missing: the nearest rotation is a guess, though its angle to the matrix is zero.
#[test]
fn a_matrix_without_one_of_its_axes_gets_no_fix() {
    let folder = tempfile::tempdir().unwrap();
    let text = "base_link_from_camera:\n  - [1.0, 0.0, 0.0, 0.338]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 0.0, 0.99]\n  - [0.0, 0.0, 0.0, 1.0]\n";
    fs::write(folder.path().join("camera.yaml"), text).unwrap();
    let run = check(folder.path(), &["ROT02"]);
    assert_eq!(run.verdict.findings.len(), 1);
    assert!(with_fix(&run).is_empty());
}

#[test]
#[cfg(unix)]
fn the_program_shows_and_applies_fixes_by_how_safe_they_are() {
    use crate::support::program::run;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("robot.urdf");
    fs::write(&file, ROBOT).unwrap();
    let read = || fs::read_to_string(&file).unwrap();
    let shown = run(folder.path(), ["check", "--diff", "."]);
    assert_eq!((shown.code, read().as_str()), (1, ROBOT));
    let diff = shown.text();
    assert!(diff.starts_with("--- a/robot.urdf\n+++ b/robot.urdf\n@@ "), "{diff}");
    assert_eq!(diff.lines().filter(|line| line.starts_with("+ ")).count(), 1, "{diff}");
    assert!(
        shown.err.contains("would fix 1 finding in 1 file") && shown.err.contains("1 other fix changes behaviour"),
        "{}",
        shown.err
    );
    let fixed = run(folder.path(), ["check", "--fix", "."]);
    assert_eq!(read(), ROBOT.replace("1.57\"", "1.5707963267948966\""));
    assert!(
        fixed.code == 1 && fixed.err.contains("fixed 1 finding in 1 file"),
        "{}",
        fixed.err
    );
    assert!(fixed.text().contains("NAME06") && !fixed.text().contains("ROT09"));
    let all = run(folder.path(), ["check", "--unsafe-fixes", "."]);
    assert!(
        all.code == 0 && all.err.contains("fixed 1 finding in 1 file"),
        "{}{}",
        all.err,
        all.text()
    );
    let again = run(folder.path(), ["check", "--unsafe-fixes", "."]);
    assert!(
        again.code == 0 && again.err.contains("fixed 0 findings in 0 files"),
        "{}",
        again.err
    );
    assert!(read().contains("rpy=\"-1.5707963267948966 0 -1.5707963267948966\"/></joint>\r\n</robot>"));
}
