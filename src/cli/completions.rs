//! Completion in shells: the scripts that ask this program, and its answers.
//!
//! A shell asks with [`SHELL`] in the environment and the words of its line behind `--`; the answer has a line for each word that fits.
//! The library's scripts are used where they do all that is needed. Its own for bash loses what stands before a `=`, where bash
//! breaks words, and quotes no file names; that for zsh puts a space behind `json=`.

use std::ffi::{OsStr, OsString};
use std::path::{Path, absolute};

use clap::CommandFactory;
use clap_complete::Shell;
use clap_complete::engine::complete;
use clap_complete::env::{EnvCompleter, Shells};

use super::args::Cli;
use super::{Answer, Failure};

/// Names the shell that asks.
const SHELL: &str = "FRAMES_LINT_COMPLETE";
/// The number of the word that is completed, the program's name being 0; the library's name.
const INDEX: &str = "_CLAP_COMPLETE_INDEX";

/// The script that a shell reads once.
pub(super) fn script(shell: Shell, program: &OsStr) -> Result<Answer, Failure> {
    let program = Path::new(program);
    // A name alone is looked for in PATH, then as now.
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

/// The words that fit, where a shell asks for them.
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

/// What the library writes.
fn answered(write: impl FnOnce(&mut dyn std::io::Write) -> std::io::Result<()>) -> Result<String, Failure> {
    let mut out = Vec::new();
    write(&mut out).map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(String::from_utf8_lossy(&out).into_owned())
}

fn completer(shell: &str) -> std::io::Result<&'static dyn EnvCompleter> {
    let known = Shells::builtins().0.iter().copied().find(|known| known.is(shell));
    known.ok_or_else(|| std::io::Error::other(format!("{SHELL}: there are no completions for `{shell}`")))
}

/// The words with those put together that bash broke at a `=`, the number of the word that is completed, and its part that bash keeps.
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
