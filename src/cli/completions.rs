//! Completion in shells: the scripts that call this program, and its answers.
//!
//! A shell calls with [`SHELL`] in the environment and the words of its line after `--`; the answer has one line per matching word.
//! The library's scripts are used except for bash and zsh: its script for bash loses the text before a `=`, where bash breaks words,
//! and does not quote file names; its script for zsh puts a space after `json=`.

use std::ffi::{OsStr, OsString};
use std::path::{Path, absolute};

use clap::CommandFactory;
use clap_complete::Shell;
use clap_complete::engine::complete;
use clap_complete::env::{EnvCompleter, Shells};

use super::args::Cli;
use super::{Answer, Failure};

/// Names the shell that calls.
const SHELL: &str = "FRAMES_LINT_COMPLETE";
/// The index of the word to complete, 0 for the program's name; the library's name of the variable.
const INDEX: &str = "_CLAP_COMPLETE_INDEX";

/// The script that a shell reads at its start.
pub(super) fn script(shell: Shell, program: &OsStr) -> Result<Answer, Failure> {
    let program = Path::new(program);
    // A name without a folder is found in PATH.
    let program = match program.components().count() {
        0 | 1 => program.to_owned(),
        _ => absolute(program).map_err(|error| Failure::Ours(error.to_string()))?,
    };
    let program = program.to_string_lossy();
    let quoted = format!("'{}'", program.replace('\'', r"'\''"));
    let out = match shell {
        Shell::Bash => include_str!("completions/bash.sh").replace("PROGRAM", &quoted),
        Shell::Zsh => include_str!("completions/zsh.sh").replace("PROGRAM", &quoted),
        other => answered(|out| {
            completer(&other.to_string())?.write_registration(SHELL, "frames_lint", "frames-lint", &program, out)
        })?,
    };
    Ok(Answer {
        out,
        ..Answer::default()
    })
}

/// The matching words, if a shell calls for them.
pub(super) fn asked(arguments: &[OsString]) -> Option<Result<Answer, Failure>> {
    let shell = std::env::var(SHELL).ok().filter(|shell| !shell.is_empty())?;
    let words = arguments.iter().skip_while(|word| *word != "--").skip(1);
    Some(words_that_fit(&shell, words.cloned().collect()).map(|out| Answer {
        out,
        ..Answer::default()
    }))
}

fn words_that_fit(shell: &str, words: Vec<OsString>) -> Result<String, Failure> {
    if words.is_empty() {
        return Ok(String::new());
    }
    let folder = std::env::current_dir().ok();
    let mut command = Cli::command();
    answered(|out| {
        if shell != "bash" {
            return completer(shell)?.write_complete(&mut command, words, folder.as_deref(), out);
        }
        let index = std::env::var(INDEX).ok().and_then(|index| index.parse().ok());
        let (words, index, begun) = joined(words, index.unwrap_or_default());
        for word in complete(&mut command, words, index, folder.as_deref())? {
            let word = word.get_value().to_string_lossy();
            if let Some(rest) = word.strip_prefix(&begun) {
                writeln!(out, "{rest}")?;
            }
        }
        Ok(())
    })
}

/// The library's completer of a shell.
fn answered(write: impl FnOnce(&mut dyn std::io::Write) -> std::io::Result<()>) -> Result<String, Failure> {
    let mut out = Vec::new();
    write(&mut out).map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(String::from_utf8_lossy(&out).into_owned())
}

fn completer(shell: &str) -> std::io::Result<&'static dyn EnvCompleter> {
    let known = Shells::builtins().0.iter().copied().find(|known| known.is(shell));
    known.ok_or_else(|| std::io::Error::other(format!("{SHELL}: completions for `{shell}` are not supported")))
}

/// Rejoins the words that bash broke at a `=`; gives them, the index of the word to complete, and its part that bash keeps.
fn joined(words: Vec<OsString>, index: usize) -> (Vec<OsString>, usize, String) {
    let mut whole: Vec<OsString> = Vec::new();
    let (mut number, mut begun, mut is_open) = (0, String::new(), false);
    for (at, word) in words.into_iter().enumerate() {
        let breaks = word == "=";
        let continues = breaks || is_open;
        is_open = breaks;
        match whole.last_mut().filter(|_| continues) {
            Some(last) => last.push(&word),
            None => whole.push(word),
        }
        if at == index {
            number = whole.len() - 1;
            let last = whole.last().map(|last| last.to_string_lossy()).unwrap_or_default();
            let kept = last.rsplit_once('=').filter(|_| continues);
            begun = kept.map_or_else(String::new, |(kept, _)| format!("{kept}="));
        }
    }
    (whole, number, begun)
}

#[cfg(test)]
#[allow(clippy::indexing_slicing)]
mod tests {
    use super::*;

    #[test]
    fn words_that_bash_broke_are_put_together() {
        for (words, index, expected) in [
            ("frames-lint check --format js", 3, ("js", 3, "")),
            (
                "frames-lint check --format = js --all",
                4,
                ("--format=js", 2, "--format="),
            ),
            ("frames-lint check --output json =", 4, ("json=", 3, "json=")),
            ("frames-lint check -o json = a b", 6, ("b", 4, "")),
            (
                "frames-lint check --output = json = a",
                6,
                ("--output=json=a", 2, "--output=json="),
            ),
        ] {
            let (whole, number, begun) = joined(words.split(' ').map(OsString::from).collect(), index);
            let word = whole[number].to_string_lossy();
            assert_eq!((&*word, number, begun.as_str()), expected, "{words}");
        }
    }
}
