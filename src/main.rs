//! The program: hands the command line to the library, prints the answer, turns a panic into exit code 70.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::io::{ErrorKind, Write};
use std::panic::{PanicHookInfo, catch_unwind};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use frames_lint::cli::{self, Answer, Surroundings};
use frames_lint::run::{EXIT_CRASHED, EXIT_USAGE};

/// A run makes many small strings and lists and ends soon: mimalloc halves the time spent on them.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The last panic, for the line that is printed if it is not caught earlier.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

fn main() -> ExitCode {
    frames_lint::files::remove_on_signals();
    // A panic in a rule or a library is caught and reported; the default hook would print in the middle of a report.
    std::panic::set_hook(Box::new(remember));
    loop {
        let answer = catch_unwind(|| {
            cli::run_to(
                std::env::args_os(),
                &mut std::io::stdin().lock(),
                &mut std::io::stdout().lock(),
                Surroundings::detect(),
            )
        })
        .unwrap_or_else(|_| crash());
        let printed = print(&mut std::io::stderr().lock(), &answer.err)
            .and_then(|()| print(&mut std::io::stdout().lock(), &answer.out));
        if let Err(error) = printed {
            return refused(&format!("cannot write the report: {error}"));
        }
        if answer.watched.is_empty() {
            return ExitCode::from(answer.code);
        }
        if let Err(error) = cli::watch::wait(&answer.watched) {
            return refused(&error);
        }
    }
}

fn refused(what: &str) -> ExitCode {
    let _ = writeln!(std::io::stderr(), "error: {what}");
    ExitCode::from(EXIT_USAGE)
}

fn remember(info: &PanicHookInfo) {
    let payload = info.payload();
    let what = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message")
        .replace('\n', " ");
    let place = info
        .location()
        .map_or_else(String::new, |location| format!(" at {location}"));
    // Only if `RUST_BACKTRACE` is set.
    let backtrace = match Backtrace::capture() {
        taken if taken.status() == BacktraceStatus::Captured => format!("\n{taken}"),
        _ => String::new(),
    };
    *LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner) = format!("{what}{place}{backtrace}");
}

fn crash() -> Answer {
    let last = LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner);
    Answer {
        err: format!(
            "frames-lint: internal error: {last}\nThis is a bug in frames-lint, not a problem of your files; please report it.\n"
        ),
        code: EXIT_CRASHED,
        ..Answer::default()
    }
}

/// Writes everything. A reader that closes the pipe (`| head`) is not an error.
fn print(to: &mut dyn Write, text: &str) -> std::io::Result<()> {
    match to.write_all(text.as_bytes()).and_then(|()| to.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}
