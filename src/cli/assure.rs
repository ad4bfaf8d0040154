//! `frames-lint assure`.

use std::io::Read;

use crate::assure::assure;
use crate::engine;
use crate::faults::{Fault, catalogue};
use crate::files::Outputs;
use crate::progress::Progress;
use crate::report::{Style, assure as report, terminal};
use crate::run::{EXIT_CLEAN, EXIT_INCOMPLETE};

use super::args::{Assure, AssureFormat};
use super::{Answer, Failure, Surroundings, nearest, paths, save};

/// Tries known mistakes on the inputs. 0: tried; 3: nothing could be tried, or an input was not read in full; 70: internal error.
pub(super) fn run(asked: Assure, stdin: &mut dyn Read, surroundings: Surroundings) -> Result<Answer, Failure> {
    let faults = selected(&asked.select)?;
    if asked.list {
        return Ok(Answer {
            out: report::list_text(&faults, surroundings.style),
            ..Answer::default()
        });
    }
    let given = match (asked.paths.is_empty(), asked.evidence.is_empty()) {
        (true, true) => vec![".".into()],
        (true, false) => Vec::new(),
        (false, _) => paths(asked.paths, stdin)?,
    };
    let (run, worlds) = engine::check_worlds(&engine::Options {
        config: asked.config,
        evidence: asked.evidence,
        outputs: Outputs {
            files: asked.output.iter().cloned().collect(),
            force: asked.force,
            ..Outputs::default()
        },
        ..asked.reading.options(given, surroundings)
    })?;
    let assurance = assure(&worlds, &faults, &Progress::of_trials(surroundings.progress));
    let style = if asked.output.is_some() {
        Style::PLAIN
    } else {
        surroundings.style
    };
    let mut out = match asked.format {
        AssureFormat::Text => report::text(&assurance, asked.all, style),
        AssureFormat::Json => report::json(&assurance)?,
        AssureFormat::Markdown => report::markdown(&assurance),
    };
    if let Some(file) = asked.output {
        save(&file, std::mem::take(&mut out))?;
    }
    let plain = Style {
        color: false,
        ..surroundings.style
    };
    let is_incomplete = assurance.trials.is_empty() || run.unread().next().is_some();
    Ok(Answer {
        out,
        err: terminal::render_unread(&run, plain),
        code: if is_incomplete { EXIT_INCOMPLETE } else { EXIT_CLEAN },
        ..Answer::default()
    })
}

/// The mistakes with these names or of these families; all if there are none.
fn selected(select: &[String]) -> Result<Vec<&'static Fault>, Failure> {
    let is_meant = |fault: &Fault, word: &str| {
        let names = [fault.name, fault.family.word()];
        names.iter().any(|name| name.eq_ignore_ascii_case(word))
    };
    for word in select {
        if !catalogue().any(|fault| is_meant(fault, word)) {
            let known: Vec<&str> = catalogue()
                .flat_map(|fault| [fault.name, fault.family.word()])
                .collect();
            let meant = nearest(word, &known).map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
            return Err(Failure::Usage(format!(
                "no mistake and no family is called `{word}`{meant}\n`frames-lint assure --list` lists all mistakes"
            )));
        }
    }
    let is_selected = |fault: &&Fault| select.is_empty() || select.iter().any(|word| is_meant(fault, word));
    Ok(catalogue().filter(is_selected).collect())
}
