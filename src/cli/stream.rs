//! `--format json-lines`: written during the run, one recording after the other.

use std::io::{ErrorKind, Write};
use std::path::Path;

use crate::files::Draft;
use crate::report::{Format, ReportError, json, json_lines};
use crate::run::{FailOn, Run, RunUpdate};

use super::Failure;
use super::args::ReportOptions;

/// Where the lines go, and the error that stopped them.
pub(super) struct Stream<'w> {
    sinks: Vec<Sink<'w>>,
    failed: Option<Failure>,
}

enum Sink<'w> {
    Stdout(&'w mut dyn Write),
    /// A file, by its name. It appears in its place when all lines are written.
    File(String, Draft),
}

impl Sink<'_> {
    fn write(&mut self, lines: &str) -> std::io::Result<()> {
        let to: &mut dyn Write = match self {
            Self::Stdout(stdout) => stdout,
            Self::File(_, draft) => draft,
        };
        to.write_all(lines.as_bytes()).and_then(|()| to.flush())
    }
}

fn unwritten(name: &str, error: &std::io::Error) -> Failure {
    Failure::Usage(format!("cannot write `{name}`: {error}"))
}

/// Writes the JSON document of a run to a file.
pub(super) fn save_json(run: &Run, fail_on: FailOn, file: &Path) -> Result<(), Failure> {
    let written = Draft::of(file).and_then(|mut draft| {
        json::write(run, fail_on, &mut draft)?;
        draft.keep()
    });
    written.map_err(|error| unwritten(&file.display().to_string(), &error))
}

/// Writes it to standard output.
pub(super) fn print_json(run: &Run, fail_on: FailOn, stdout: &mut dyn Write) -> Result<(), Failure> {
    match json::write(run, fail_on, stdout).map_err(std::io::Error::from) {
        // The reader has closed the pipe (`| head`).
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|error| unwritten("standard output", &error)),
    }
}

impl<'w> Stream<'w> {
    /// Opens every file and output that gets lines; `None` if none does.
    pub(super) fn open(
        reporting: &ReportOptions,
        stdout: &mut Option<&'w mut dyn Write>,
    ) -> Result<Option<Self>, Failure> {
        let mut sinks: Vec<Sink<'w>> = Vec::new();
        for output in &reporting.output {
            if reporting.format_of(output) == Format::JsonLines {
                let name = output.file.display().to_string();
                let draft = Draft::of(&output.file).map_err(|error| unwritten(&name, &error))?;
                sinks.push(Sink::File(name, draft));
            }
        }
        if reporting.format == Format::JsonLines && !reporting.is_in_file() {
            sinks.extend(stdout.take().map(Sink::Stdout));
        }
        let mut stream = Self { sinks, failed: None };
        stream.pass_on(json_lines::start());
        Ok((!stream.sinks.is_empty()).then_some(stream))
    }

    /// Writes what was added to the run.
    pub(super) fn grown(&mut self, run: &Run, grown: &RunUpdate) {
        let written = json_lines::grown(run, grown, &mut |lines| self.write(lines));
        self.pass_on(written.map(|()| String::new()));
    }

    /// Writes the last lines; gives the error if something could not be written.
    pub(super) fn end(mut self, run: &Run, fail_on: FailOn) -> Result<(), Failure> {
        self.pass_on(json_lines::end(run, fail_on));
        if let Some(failed) = self.failed {
            return Err(failed);
        }
        for sink in self.sinks {
            if let Sink::File(name, draft) = sink {
                draft.keep().map_err(|error| unwritten(&name, &error))?;
            }
        }
        Ok(())
    }

    fn pass_on(&mut self, lines: Result<String, serde_json::Error>) {
        match lines {
            Ok(lines) => self.write(&lines),
            Err(error) => self.failed = Some(ReportError::from(error).into()),
        }
    }

    fn write(&mut self, lines: &str) {
        if self.failed.is_some() || lines.is_empty() {
            return;
        }
        let mut failed = None;
        self.sinks.retain_mut(|sink| match (sink.write(lines), sink) {
            (Ok(()), _) => true,
            // The reader has closed the pipe (`| head`).
            (Err(error), Sink::Stdout(_)) if error.kind() == ErrorKind::BrokenPipe => false,
            (Err(error), sink) => {
                let name = match sink {
                    Sink::Stdout(_) => "standard output",
                    Sink::File(name, _) => name,
                };
                failed = Some(unwritten(name, &error));
                false
            }
        });
        self.failed = failed;
    }
}
