//! Writes scenes for the Rerun viewer.

use std::fmt::Write;
use std::io::Read;
use std::path::Path;

use crate::cli::args::View;
use crate::cli::{Answer, Failure, Surroundings, paths};
use crate::engine;
use crate::files::{Draft, Outputs};
use crate::report::rerun::{Sink, write};
use crate::run::Run;
use crate::view::{Omission, estimate, fit, scene};

/// Checks the inputs and shows the views. The exit code is that of reading.
pub(in crate::cli) fn run(view: View, stdin: &mut dyn Read, surroundings: Surroundings) -> Result<Answer, Failure> {
    let run = engine::check(&engine::Options {
        config: view.config,
        outputs: Outputs {
            files: view.output.iter().cloned().collect(),
            force: view.force,
            ..Outputs::default()
        },
        verdicts: engine::VerdictScope::One,
        sights: engine::Retention::Everything,
        ..view
            .input
            .reading
            .options(paths(view.input.paths, stdin)?, surroundings)
    })?;
    let mut answer = Answer::of_reading(&run, surroundings);
    if let Some(file) = &view.output {
        answer.out.push_str(&save(&run, file, view.max_size)?);
    }
    if view.spawn {
        answer
            .out
            .push_str(&send(&run, Sink::Spawn, "the viewer", view.max_size)?);
    }
    if let Some(url) = &view.connect {
        answer
            .out
            .push_str(&send(&run, Sink::Connect(url), url, view.max_size)?);
    }
    Ok(answer)
}

/// A file larger than the limit is written again with less content, at most this often.
const ROUNDS: usize = 6;

#[allow(clippy::unnecessary_wraps)] // there is a build without views
pub(in crate::cli) fn is_there() -> Result<(), Failure> {
    Ok(())
}

/// Writes the views to a file. Returns a line that states what was left out, if anything was.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a share of a size
pub(in crate::cli) fn save(run: &Run, file: &Path, max_bytes: u64) -> Result<String, Failure> {
    let mut scene = scene(run);
    let mut aim = usize::try_from(max_bytes).unwrap_or(usize::MAX);
    let (mut left_out, mut size) = (Omission::NOTHING, 0);
    let shown = file.display().to_string();
    let draft = Draft::of(file).map_err(|error| failed(&shown, &error.to_string()))?;
    let path = draft.path().unwrap_or(file);
    for round in 0..ROUNDS {
        let more = fit(&mut scene, aim);
        left_out = left_out.and(more);
        write(&scene, &name(run), Sink::File(path)).map_err(|error| failed(&shown, &error))?;
        size = std::fs::metadata(path).map_or(0, |meta| meta.len());
        if size <= max_bytes || round > 0 && more == Omission::NOTHING {
            break;
        }
        // The file is larger than estimated: aim lower by the same factor, and a little more.
        let share = max_bytes as f64 / size as f64 * 0.95;
        aim = (estimate(&scene) as f64 * share) as usize;
    }
    draft.keep().map_err(|error| failed(&shown, &error.to_string()))?;
    let mut text = summary(&shown, left_out);
    if size > max_bytes {
        let _ = writeln!(
            text,
            "the views take {} kB, more than --max-size; nothing more can be left out",
            size / 1000
        );
    }
    Ok(text)
}

/// Sends the views to a viewer, which is called `words`.
fn send(run: &Run, sink: Sink, words: &str, max_bytes: u64) -> Result<String, Failure> {
    let mut scene = scene(run);
    let left_out = fit(&mut scene, usize::try_from(max_bytes).unwrap_or(usize::MAX));
    write(&scene, &name(run), sink).map_err(|error| failed(words, &error))?;
    Ok(summary(words, left_out))
}

fn failed(words: &str, error: &str) -> Failure {
    Failure::Usage(format!("cannot write the views to {words}: {error}"))
}

fn summary(words: &str, left_out: Omission) -> String {
    let Omission {
        moments,
        points,
        meshes,
    } = left_out;
    let mut text = format!("wrote views to {words}");
    if moments > 1 || points > 1 {
        let _ = write!(
            text,
            "; to stay below --max-size, only one in {moments} samples and one in {points} cloud points is shown"
        );
    }
    if meshes > 0 {
        let _ = write!(
            text,
            "; to stay below --max-size, the {meshes} largest meshes are left out"
        );
    }
    text.push('\n');
    text
}

/// The title of the views: the first input, and the number of others.
fn name(run: &Run) -> String {
    let mut inputs = run.sources.iter().filter(|source| source.derived.is_none());
    let first = inputs.next().map_or("nothing", |source| source.path.as_str());
    match inputs.count() {
        0 => first.to_owned(),
        more => format!("{first} and {more} more"),
    }
}
