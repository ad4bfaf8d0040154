//! `frames-lint init`.

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::engine;
use crate::faults::Selection;
use crate::files::Outputs;
use crate::report::init;

use super::args::Init;
use super::{Answer, Failure, Surroundings, paths, save};

/// The file name of a configuration.
const NAME: &str = "frames-lint.yaml";

/// Checks the inputs and writes a configuration from the results. An existing configuration is not applied.
pub(super) fn run(init: Init, stdin: &mut dyn Read, surroundings: Surroundings) -> Result<Answer, Failure> {
    let given = init.paths.into_iter().chain(init.from.clone()).collect();
    let inputs = paths(given, stdin)?;
    let target = match init.output {
        Some(path) if path.as_os_str() == "-" => None,
        Some(path) => Some(path),
        None => Some(beside(inputs.first().map_or(Path::new("."), PathBuf::as_path))),
    };
    if let Some(path) = target.as_ref().filter(|path| path.exists() && !init.force) {
        let shown = path.display();
        return Err(Failure::Usage(format!(
            "`{shown}` exists; overwrite it with --force, or print a new one with `-o -`"
        )));
    }
    let run = engine::check(&engine::Options {
        without_config: true,
        outputs: Outputs {
            files: target.iter().cloned().collect(),
            force: init.force,
            ..Outputs::default()
        },
        verdicts: engine::VerdictScope::One,
        assure: init.from.is_some().then(|| Selection {
            sizes: Vec::new(),
            // What the good drive shows by a hair, the next one may not.
            is_steady: true,
            ..Selection::all()
        }),
        ..init.reading.options(inputs, surroundings)
    })?;
    let good = init.from.as_deref();
    let contract = good.map(|good| engine::contract(&run, good)).transpose()?;
    let text = init::configuration(&run, contract.as_ref());
    let mut answer = Answer::of_reading(&run, surroundings);
    match target {
        None => answer.out = text,
        Some(path) => {
            save(&path, text)?;
            answer.out = format!("wrote {}; review it, and delete what is not correct\n", path.display());
        }
    }
    Ok(answer)
}

/// The configuration of a folder, or of the folder of a file or of a recording.
fn beside(input: &Path) -> PathBuf {
    let folder = if input.is_dir() && !input.join("metadata.yaml").is_file() {
        input
    } else {
        input.parent().unwrap_or(Path::new(""))
    };
    folder.join(NAME)
}
