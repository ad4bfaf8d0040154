//! `frames-lint check` and `chain`.

use std::ffi::OsString;
use std::fmt::Write;
use std::io::Read;
use std::mem::ManuallyDrop;

use crate::engine;
use crate::faults::Selection;
use crate::files::Outputs;
use crate::report::{self, Format, Style, plural, terminal};
use crate::rules::codes;
use crate::run::{EXIT_USAGE, Run};
use crate::verdict::KeptOutcomes;

use super::args::{Chain, Check, Color, ReportOptions};
use super::stream::{Stream, print_json, save_json};
use super::{Answer, Failure, Surroundings, call, fixes, paths, paths_or_here, save, view};

/// Checks the inputs and writes the reports.
pub(super) fn run(
    check: Check,
    arguments: &[OsString],
    (stdin, stdout): (&mut dyn Read, &mut dyn std::io::Write),
    surroundings: Surroundings,
) -> Result<Answer, Failure> {
    let today = call::today()?;
    let mut call = call::of(arguments, &today);
    call.settings.push(("Recordings", check.reading.extent_words()));
    let fixing = check.fixing;
    // Fixes and baselines alter results after the check: a report can be streamed only without them.
    let is_final = !fixing.fix && !fixing.unsafe_fixes && !fixing.diff && check.write_baseline.is_none();
    let mut options = engine::Options {
        paths: paths_or_here(check.paths, &check.evidence, stdin)?,
        evidence: check.evidence,
        assure: check.assure.then(Selection::all),
        fit_for: check.fit_for,
        config: check.config,
        profile: check.profile,
        baseline: check.baseline,
        today: Some(today),
        fail_on: check.reporting.fail_on,
        outputs: Outputs {
            rewritten: check.write_baseline.clone(),
            ..check.reporting.outputs([&check.write_baseline, &check.views.rrd])
        },
        verdicts: engine::VerdictScope::Each,
        outcomes: match (check.reporting.verbose, check.reporting.has(Format::Html)) {
            (true, _) => KeptOutcomes::Listed,
            (false, true) => KeptOutcomes::Shown,
            (false, false) if is_final && check.views.rrd.is_none() && check.reporting.streams() => {
                KeptOutcomes::Unreported
            }
            (false, false) => KeptOutcomes::Applicable,
        },
        sights: match (&check.views.rrd, check.reporting.has(Format::Html)) {
            (Some(_), _) => engine::Retention::Everything,
            (None, true) => engine::Retention::Plots,
            (None, false) => engine::Retention::None,
        },
        select: check.select,
        ignore: check.ignore,
        timings: if check.timings {
            engine::Timings::kept()
        } else {
            engine::Timings::default()
        },
        ..check.reading.options(Vec::new(), surroundings)
    };
    // What a sample does not show may be in the rest.
    let extent = &mut options.extent;
    extent.full |= !options.fit_for.is_empty() && extent.windows.is_none() && extent.budget.is_none();
    if let Some(file) = &check.show_settings {
        let settings = engine::settings_of(&options, file)?.into_iter();
        let lines: Vec<String> = settings.map(|(name, value)| format!("{name:<13}  {value}\n")).collect();
        let out = lines.concat();
        return Ok(Answer {
            out,
            ..Answer::default()
        });
    }
    if check.views.rrd.is_some() {
        view::is_there()?;
    }
    let mut stdout = Some(stdout);
    let mut stream = if is_final {
        Stream::open(&check.reporting, &mut stdout)?
    } else {
        None
    };
    let checked = engine::check_each(&options, &mut |run, grown| {
        if let Some(stream) = &mut stream {
            stream.grown(run, grown);
        }
    });
    // The program ends after the report: freeing the memory of the run first would only cost time.
    let mut run = ManuallyDrop::new(checked?);
    if fixing.diff {
        return Ok(fixes::show(&run, &options, fixing.unsafe_fixes, &check.reporting));
    }
    let (mut said, mut is_written) = (String::new(), true);
    if fixing.fix || fixing.unsafe_fixes {
        (said, is_written) = fixes::apply(&mut run, &options, fixing.unsafe_fixes)?;
    }
    if let Some(path) = check.write_baseline {
        let count = plural(engine::write_baseline(&mut run, &path)?, "finding");
        let _ = writeln!(said, "wrote {count} to {}; accept them with --baseline", path.display());
    }
    if let Some(file) = &check.views.rrd {
        said.push_str(&view::save(&run, file, check.views.max_size)?);
    }
    let mut answer = write_reports(&mut run, &check.reporting, call, (stream, stdout), surroundings)?;
    answer.err.insert_str(0, &said);
    if !is_written {
        answer.code = EXIT_USAGE;
    }
    answer.err.push_str(&options.timings.words());
    if check.watch {
        let config = options.config.iter().chain(&options.baseline).cloned();
        answer.watched = options
            .paths
            .iter()
            .chain(&options.evidence)
            .cloned()
            .chain(config)
            .collect();
        answer.err.push_str("watching for changes; stop with Ctrl-C\n");
    }
    Ok(answer)
}

/// Checks the products of transforms in source code by the one rule for them.
pub(super) fn chain(
    chain: Chain,
    arguments: &[OsString],
    stdin: &mut dyn Read,
    surroundings: Surroundings,
) -> Result<Answer, Failure> {
    let mut run = engine::check(&engine::Options {
        paths: paths(chain.paths, stdin)?,
        wanted: engine::FileSelection::Code,
        outputs: chain.reporting.outputs([]),
        select: vec![codes::NAME08.to_string()],
        progress: surroundings.progress,
        ..engine::Options::default()
    })?;
    let call = call::of(arguments, &call::today()?);
    write_reports(&mut run, &chain.reporting, call, (None, None), surroundings)
}

/// Writes the reports of a run to their files and outputs; gives the exit code.
fn write_reports(
    run: &mut Run,
    reporting: &ReportOptions,
    mut call: report::Call,
    (stream, stdout): (Option<Stream>, Option<&mut dyn std::io::Write>),
    surroundings: Surroundings,
) -> Result<Answer, Failure> {
    let fail_on = reporting.fail_on(run);
    let options = |style: Style| {
        let color = match reporting.color {
            Color::Auto => style.color,
            Color::Always => true,
            Color::Never => false,
        };
        terminal::Options {
            style: Style { color, ..style },
            fail_on,
            verbose: reporting.verbose,
            all: reporting.all,
            parts: reporting.less.parts(),
        }
    };
    if reporting.has(Format::Html) {
        engine::hash(run);
        let origin = match (reporting.fail_on, run.fail_on) {
            (Some(_), _) => "the command line",
            (None, Some(_)) => "the configuration",
            (None, None) => "the default",
        };
        let words = format!("{} (from {origin}); hints never fail the run", fail_on.word());
        call.settings.insert(0, ("Findings count from", words));
    }
    let run = &*run;
    let mut answer = Answer {
        code: run.exit_code(fail_on),
        ..Answer::default()
    };
    let is_streamed = |format: Format| stream.is_some() && format == Format::JsonLines;
    for output in &reporting.output {
        let format = reporting.format_of(output);
        if format == Format::Json {
            save_json(run, fail_on, &output.file)?;
        } else if !is_streamed(format) {
            save(
                &output.file,
                report::render(run, format, &options(Style::PLAIN), &call)?,
            )?;
        }
    }
    if reporting.is_in_file() {
        // The report is in the file; the terminal shows how the run ended.
        let style = Style {
            color: false,
            ..surroundings.style
        };
        answer.err = terminal::render_ending(
            run,
            &terminal::Options {
                style,
                ..options(style)
            },
        );
    } else if let (Format::Json, Some(stdout)) = (reporting.format, stdout) {
        print_json(run, fail_on, stdout)?;
    } else if !is_streamed(reporting.format) {
        answer.out = report::render(run, reporting.format, &options(surroundings.style), &call)?;
    }
    if let Some(stream) = stream {
        stream.end(run, fail_on)?;
    }
    Ok(answer)
}
