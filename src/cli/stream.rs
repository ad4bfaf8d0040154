//! `--format json-lines`: written while the run goes on, a recording after the other.

use std::fs::File;
use std::io::{ErrorKind, Write};

use crate::report::{Format, ReportError, json_lines};
use crate::run::{FailOn, Grown, Run};

use super::Failure;
use super::args::Reporting;

/// Where the lines go, and why they no longer do.
pub(super) struct Stream<'w> {
    sinks: Vec<(String, Box<dyn Write + 'w>)>,
    failed: Option<Failure>,
}

impl<'w> Stream<'w> {
    /// Opens everything that lines are wanted in. `None` where they are wanted nowhere.
    pub(super) fn open(reporting: &Reporting, stdout: &'w mut dyn Write) -> Result<Option<Self>, Failure> {
        let mut sinks: Vec<(String, Box<dyn Write + 'w>)> = Vec::new();
        for output in &reporting.output {
            if reporting.format_of(output) == Format::JsonLines {
                let name = output.file.display().to_string();
                let file = File::create(&output.file)
                    .map_err(|error| Failure::Usage(format!("cannot write `{name}`: {error}")))?;
                sinks.push((name, Box::new(file)));
            }
        }
        if reporting.format == Format::JsonLines && !reporting.is_in_file() {
            sinks.push((String::new(), Box::new(stdout)));
        }
        let mut stream = Self { sinks, failed: None };
        stream.write(json_lines::start());
        Ok((!stream.sinks.is_empty()).then_some(stream))
    }

    /// What came to the run.
    pub(super) fn grown(&mut self, run: &Run, grown: &Grown) {
        self.write(json_lines::grown(run, grown));
    }

    /// The last lines; the error, where something could not be written.
    pub(super) fn end(mut self, run: &Run, fail_on: FailOn) -> Result<(), Failure> {
        self.write(json_lines::end(run, fail_on));
        self.failed.map_or(Ok(()), Err)
    }

    fn write(&mut self, lines: Result<String, serde_json::Error>) {
        let lines = match lines {
            Ok(lines) if self.failed.is_none() => lines,
            Ok(_) => return,
            Err(error) => {
                self.failed = Some(ReportError::from(error).into());
                return;
            }
        };
        let mut failed = None;
        self.sinks.retain_mut(
            |(name, sink)| match sink.write_all(lines.as_bytes()).and_then(|()| sink.flush()) {
                Ok(()) => true,
                // Whoever reads has seen enough.
                Err(error) if name.is_empty() && error.kind() == ErrorKind::BrokenPipe => false,
                Err(error) => {
                    let name = if name.is_empty() { "standard output" } else { name };
                    failed = Some(Failure::Usage(format!("cannot write `{name}`: {error}")));
                    false
                }
            },
        );
        self.failed = failed;
    }
}
