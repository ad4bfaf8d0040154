//! Completion as people meet it: in the shells themselves, at a terminal, with the script that the program writes.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fs;
use std::path::Path;
use std::process::Command;

use frames_lint::config::PROFILES;
use frames_lint::rules::RULES;

use crate::support::program;
use crate::support::terminal::{Shell, installed};

/// Shows the line as it is, between marks: C-g in bash and zsh.
const SHOW: &str = "\u{7}";
/// Empties the line.
const EMPTY: &str = "\u{15}";

/// Files to complete, and the script of a shell.
fn folder(shell: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["robot.urdf", "report.json", "two words.urdf"] {
        fs::write(folder.path().join(name), "").unwrap();
    }
    fs::create_dir(folder.path().join("rosbags")).unwrap();
    let ran = program::run(folder.path(), ["completions", shell]);
    assert_eq!((ran.code, ran.err.as_str()), (0, ""));
    fs::write(folder.path().join("script"), ran.text()).unwrap();
    folder
}

/// What all three shells must offer for the line before the cursor: the last words, of which each stands for itself.
fn holds(offered: &mut dyn FnMut(&str) -> Vec<String>) {
    let codes = |begins: &str| -> Vec<String> {
        let codes = RULES.iter().map(|entry| entry.page.code.to_owned());
        codes.filter(|code| code.starts_with(begins)).collect()
    };
    let profiles: Vec<String> = PROFILES.iter().map(|(name, _)| (*name).to_owned()).collect();
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    for (line, expected) in [
        ("frames-lint co", words(&["collect", "completions", "convert"])),
        ("frames-lint explain TI", codes("TI")),
        ("frames-lint explain orphan-s", words(&["orphan-subtree"])),
        ("frames-lint check --select TIME0", codes("TIME0")),
        (
            "frames-lint check --select=CO",
            [words(&["CONFIG", "CONTRACT", "COV"]), codes("CO")].concat(),
        ),
        ("frames-lint check --format js", words(&["json", "json-lines"])),
        ("frames-lint check --format=ju", words(&["junit"])),
        ("frames-lint check --output js", words(&["json=", "json-lines="])),
        ("frames-lint check --output json=rep", words(&["report.json"])),
        ("frames-lint check --profile ", profiles),
        ("frames-lint check --fail", words(&["--fail-on"])),
        (
            "frames-lint check --select TREE01 ro",
            words(&["robot.urdf", "rosbags/"]),
        ),
        ("frames-lint convert --to kal", words(&["kalibr", "kalibr-imu"])),
        ("frames-lint man di", words(&["diff"])),
        ("frames-lint completions fi", words(&["fish"])),
    ] {
        let mut found = offered(line);
        let mut expected = expected;
        found.sort();
        expected.sort();
        assert_eq!(found, expected, "`{line}`");
    }
    // Behind a comma, the codes before it are kept.
    let found = offered("frames-lint check --ignore TREE01,TIME0");
    let kept: Vec<String> = codes("TIME0").iter().map(|code| format!("TREE01,{code}")).collect();
    assert!(found == kept || found == codes("TIME0"), "{found:?}");
}

/// The words that a shell puts where the last word of a line stood.
fn inserted(shell: &mut Shell, line: &str, every: &str) -> Vec<String> {
    let shown = shell.types(&format!("{EMPTY}{line}{every}{SHOW}"), "}}");
    let (_, shown) = shown.split_once("{{").unwrap();
    let (whole, _) = shown.split_once("}}").unwrap();
    let before = line.rfind(' ').unwrap() + 1;
    let words = whole.get(before..).unwrap_or_default();
    // bash and zsh complete the part behind a `=`, and keep what stands before it.
    let typed = line.get(before..).unwrap_or_default();
    let kept = typed.rfind('=').map_or(0, |at| at + 1);
    let kept = typed.get(..kept).unwrap_or_default();
    words
        .split_whitespace()
        .map(|word| word.strip_prefix(kept).unwrap_or(word).to_owned())
        .collect()
}

/// What a tab makes of a line: a name with a space is quoted, and a folder is only the beginning of a word.
fn finishes(shell: &mut Shell) {
    for (line, whole) in [
        ("frames-lint check tw", "frames-lint check two\\ words.urdf "),
        ("frames-lint check ros", "frames-lint check rosbags/"),
        ("frames-lint check -o htm", "frames-lint check -o html="),
        ("frames-lint explain orphan-s", "frames-lint explain orphan-subtree "),
    ] {
        let shown = shell.types(&format!("{EMPTY}{line}\t{SHOW}"), "}}");
        assert!(shown.contains(&format!("{{{{{whole}}}}}")), "`{line}`: {shown}");
    }
}

#[test]
fn bash_completes_what_is_typed() {
    let Some(bash) = installed("bash") else { return };
    let folder = folder("bash");
    let rc = "source ./script\nPS1='ready> '\nbind 'set enable-bracketed-paste off'\n\
              bind -x '\"\\C-g\": printf \"{%s%s%s}\" \"{\" \"$READLINE_LINE\" \"}\"'\n";
    fs::write(folder.path().join("rc"), rc).unwrap();
    let mut shell = Shell::start(&bash, &["--noprofile", "--rcfile", "rc", "-i"], folder.path());
    shell.types("", "ready> ");
    // M-* puts every word that fits into the line.
    holds(&mut |line| inserted(&mut shell, line, "\u{1b}*"));
    finishes(&mut shell);
}

#[test]
fn zsh_completes_what_is_typed() {
    let Some(zsh) = installed("zsh") else { return };
    let folder = folder("zsh");
    // C-x puts every word that fits into the line.
    let rc = "PS1='ready> '\nzle_bracketed_paste=()\nautoload -Uz compinit\ncompinit -u -D\n\
              source ./script\nshow() { printf '{%s%s%s}' '{' \"$BUFFER\" '}' }\nzle -N show\nbindkey '^G' show\nbindkey '^U' kill-whole-line\n\
              zstyle ':completion:every:*' completer _all_matches _complete\nzstyle ':completion:every:*' insert true\n\
              zle -C every complete-word _generic\nbindkey '^X' every\n";
    fs::write(folder.path().join(".zshrc"), rc).unwrap();
    let mut shell = Shell::start(&zsh, &["-d", "-i"], folder.path());
    shell.types("", "ready> ");
    holds(&mut |line| inserted(&mut shell, line, "\u{18}"));
    finishes(&mut shell);
}

#[test]
fn fish_completes_what_is_typed() {
    let Some(fish) = installed("fish") else { return };
    let folder = folder("fish");
    holds(&mut |line| offered_by_fish(&fish, folder.path(), line));
}

/// fish tells what it would offer: a word a line, and behind a tab what it means.
fn offered_by_fish(fish: &Path, folder: &Path, line: &str) -> Vec<String> {
    let asked = format!("source script; complete --do-complete '{line}'");
    let said = Command::new(fish)
        .args(["--no-config", "-c", &asked])
        .current_dir(folder)
        .env("HOME", folder)
        .output()
        .unwrap();
    let text = String::from_utf8(said.stdout).unwrap();
    let kept = line.split(' ').next_back().unwrap_or_default();
    let kept = kept.rfind('=').map_or("", |at| kept.get(..=at).unwrap_or_default());
    text.lines()
        .map(|offer| offer.split('\t').next().unwrap_or_default())
        .map(|word| word.strip_prefix(kept).unwrap_or(word).to_owned())
        .collect()
}

#[test]
fn a_shell_that_is_not_known_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let ran = program::run_with(
        folder.path(),
        ["--", "frames-lint", ""],
        &[("FRAMES_LINT_COMPLETE", "ksh")],
    );
    assert_eq!(ran.code, 2);
    assert!(
        ran.err.contains("completions for `ksh` are not supported"),
        "{}",
        ran.err
    );
}
