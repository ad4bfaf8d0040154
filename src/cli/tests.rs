//! The command line, as far as it needs no engine.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::PathBuf;

use clap::CommandFactory;

use super::args::Cli;
use super::{Answer, Surroundings, listed, paths, rules, run};
use crate::report::Style;

fn answer(arguments: &[&str]) -> Answer {
    let arguments = std::iter::once("frames-lint")
        .chain(arguments.iter().copied())
        .map(OsString::from);
    let surroundings = Surroundings {
        style: Style::PLAIN,
        progress: false,
        is_program: false,
    };
    run(arguments, &mut std::io::empty(), surroundings)
}

#[test]
fn the_arguments_fit_together() {
    Cli::command().debug_assert();
}

#[test]
fn wrong_calls_have_exit_code_2_and_say_so_on_stderr() {
    for arguments in [
        &[][..],
        &["check", "--quiet", "--verbose", "a"],
        &["check", "--fail-on", "fatal", "a"],
        &["check", "--xacro-arg", "no", "a"],
        &["check", "-"],
        &["robot.urdf"],
        &["explain", "XYZ99"],
        &["man", "dance"],
    ] {
        let answer = answer(arguments);
        assert_eq!(answer.code, 2, "{arguments:?}: {answer:?}");
        assert!(answer.out.is_empty() && !answer.err.is_empty(), "{arguments:?}");
    }
}

#[test]
fn a_path_without_a_verb_gets_a_hint() {
    assert!(
        answer(&["robot.urdf"])
            .err
            .ends_with("\nTo check files, use: frames-lint check robot.urdf\n")
    );
}

#[test]
fn help_version_pages_and_scripts_are_answers() {
    for (arguments, part) in [
        (&["--help"][..], "Exit codes:"),
        (&["check", "--help"], "--fail-on <SEVERITY>"),
        (&["--version"], env!("CARGO_PKG_VERSION")),
        (&["explain", "tree01"], "What it checks"),
        (&["explain", "orphan-subtree"], "What it checks"),
        (&["rules"], "TREE01      orphan-subtree"),
        (&["rules", "--format", "json"], "\"code\": \"TREE01\""),
        (&["rules", "--format", "markdown"], "| TREE01 | [orphan-subtree](https:"),
        (&["completions", "bash"], "-F _frames_lint frames-lint"),
        (&["man"], ".TH frames-lint 1"),
        (&["man", "check"], "fail"),
    ] {
        let answer = answer(arguments);
        assert_eq!((answer.code, answer.err.as_str()), (0, ""), "{arguments:?}");
        assert!(answer.out.contains(part), "{arguments:?}: {}", answer.out);
    }
}

#[test]
fn a_misspelt_rule_is_met_with_a_suggestion() {
    for (word, meant) in [("orphan-subtre", "`orphan-subtree`"), ("TREE1", "`TREE01`")] {
        let err = answer(&["explain", word]).err;
        assert!(err.contains(&format!("did you mean {meant}?")), "{err}");
    }
    assert!(!answer(&["explain", "qqqqqqqq"]).err.contains("did you mean"));
}

#[test]
fn paths_come_from_arguments_and_from_standard_input() {
    let given = ["a.urdf", "-", "b", "-"].map(PathBuf::from).to_vec();
    let Ok(found) = paths(given, &mut &b"c d.yaml\r\ne\n\n"[..]) else {
        panic!()
    };
    assert_eq!(found, ["a.urdf", "c d.yaml", "e", "b"].map(PathBuf::from));
    let Ok(found) = listed(b"with\nnewline\0b\0") else {
        panic!()
    };
    assert_eq!(found, ["with\nnewline", "b"].map(PathBuf::from));
}

#[test]
fn rules_have_different_codes_and_names() {
    let rules = rules();
    let codes: BTreeSet<&str> = rules.iter().map(|rule| rule.code).collect();
    let names: BTreeSet<&str> = rules.iter().map(|rule| rule.name).collect();
    assert_eq!((codes.len(), names.len()), (rules.len(), rules.len()));
}

#[test]
fn what_is_not_there_is_one_line() {
    let answer = answer(&["check", "no/such/place"]);
    let line = "no/such/place: cannot be opened: No such file or directory (os error 2). Nothing was checked; this is not a pass.\n";
    assert_eq!((answer.code, answer.out.as_str()), (3, line));
}

#[test]
fn without_a_path_the_folder_is_checked() {
    let here = answer(&["check", "--select", "TREE01", "--format", "json"]);
    assert_eq!(
        here.out,
        answer(&["check", "--select", "TREE01", "--format", "json", "."]).out
    );
}

#[test]
fn a_report_has_the_form_that_its_name_ends_in() {
    let folder = tempfile::tempdir().unwrap();
    for (name, begins) in [
        ("a.sarif", "{"),
        ("a.html", "<!DOCTYPE html>"),
        ("a.xml", "<?xml"),
        ("a.txt", "error[CROSS02"),
    ] {
        let file = folder.path().join(name);
        let answer = answer(&["check", "fixtures/first-finding", "-o", file.to_str().unwrap()]);
        assert!(answer.out.is_empty() && answer.err.contains("Not clean"), "{answer:?}");
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(
            text.starts_with(begins),
            "{name}: {}",
            text.lines().next().unwrap_or_default()
        );
    }
}

#[test]
fn quiet_and_statistics_say_less() {
    let quiet = answer(&["check", "--quiet", "fixtures/first-finding"]).out;
    assert!(
        quiet.starts_with("error[CROSS02") && !quiet.contains("Not evaluated") && !quiet.contains("Not clean"),
        "{quiet}"
    );
    let clean = answer(&["check", "-q", "fixtures/first-finding/car.urdf", "--select", "TREE"]);
    assert_eq!((clean.code, clean.out.as_str()), (0, ""));
    let counted = answer(&["check", "--statistics", "fixtures/first-finding"]).out;
    assert!(
        counted.contains("     1  CROSS02  extrinsic-relation (error)\n"),
        "{counted}"
    );
    assert!(
        counted.contains("Not clean") && !counted.contains("measured:"),
        "{counted}"
    );
}
