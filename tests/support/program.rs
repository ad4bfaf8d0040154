//! The real program as a child process: what it says, how it ends, and how much memory it takes.

use std::ffi::{OsStr, OsString};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// Peak resident memory that no input may make the program exceed, MB.
pub const MOST_MB: u64 = 500;

/// A child that needs longer hangs.
const PATIENCE: Duration = Duration::from_secs(180);

/// What became of one call.
#[derive(Debug)]
pub struct CallResult {
    /// The exit code; -1 where a signal ended it.
    pub code: i32,
    /// Standard output.
    pub out: Vec<u8>,
    /// Standard error, as text.
    pub err: String,
    /// Largest resident memory that was seen, MB; 0 where the system does not say.
    pub peak_mb: u64,
}

impl CallResult {
    /// Standard output as text.
    pub fn text(&self) -> String {
        String::from_utf8(self.out.clone()).expect("a report is UTF-8")
    }

    /// Standard output as a report that is valid by the schema.
    pub fn report(&self) -> Value {
        let report: Value = serde_json::from_slice(&self.out).expect("a report is JSON");
        let schema = include_str!("../../schema/frames-lint-1.json");
        let schema: Value = serde_json::from_str(schema).expect("the schema is JSON");
        let validator = jsonschema::draft202012::new(&schema).expect("the schema is one");
        let errors: Vec<String> = validator.iter_errors(&report).map(|error| error.to_string()).collect();
        assert!(errors.is_empty(), "by the schema: {errors:#?}");
        report
    }
}

/// Runs `frames-lint` in `folder`.
pub fn run<S: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = S>) -> CallResult {
    run_with(folder, arguments, &[])
}

/// [`run`] with these variables in its environment. The outputs go to files, so that a long one cannot block the child.
pub fn run_with<S: AsRef<OsStr>>(
    folder: &Path,
    arguments: impl IntoIterator<Item = S>,
    environment: &[(&str, &str)],
) -> CallResult {
    let mut out = tempfile::tempfile().expect("a temporary file");
    let mut err = tempfile::tempfile().expect("a temporary file");
    let mut child = Command::new(env!("CARGO_BIN_EXE_frames-lint"))
        .args(arguments)
        .current_dir(folder)
        .env_remove("RUST_BACKTRACE")
        .env_remove("SOURCE_DATE_EPOCH")
        .envs(environment.iter().copied())
        .stdin(Stdio::null())
        .stdout(out.try_clone().expect("a handle"))
        .stderr(err.try_clone().expect("a handle"))
        .spawn()
        .expect("the program starts");
    let begin = Instant::now();
    let mut peak_mb = 0;
    let status = loop {
        peak_mb = peak_mb.max(resident_mb(child.id()));
        if let Some(status) = child.try_wait().expect("the child is ours") {
            break status;
        }
        if begin.elapsed() > PATIENCE {
            child.kill().expect("the child is ours");
            panic!("the program does not end");
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    let bytes = |file: &mut std::fs::File| {
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(0)).expect("a file is seekable");
        file.read_to_end(&mut bytes).expect("a file is readable");
        bytes
    };
    CallResult {
        code: status.code().unwrap_or(-1),
        out: bytes(&mut out),
        err: String::from_utf8_lossy(&bytes(&mut err)).into_owned(),
        peak_mb,
    }
}

/// The peak so far, which the system keeps: only the last millisecond before the end can be missed. Until a child has become the program,
/// its memory is that of these tests, and does not count.
fn resident_mb(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    if !status.starts_with("Name:\tframes-lint\n") {
        return 0;
    }
    let line = status
        .lines()
        .find(|line| line.starts_with("VmHWM:"))
        .unwrap_or_default();
    let kb = line.split_whitespace().nth(1).and_then(|kb| kb.parse::<u64>().ok());
    kb.unwrap_or(0) / 1024
}

/// What holds of every run.
pub fn is_sound(ran: &CallResult, what: &str) {
    let err = &ran.err;
    assert!(
        !err.contains("panicked") && !err.contains("internal error"),
        "{what}: {err}"
    );
    assert!([0, 1, 3].contains(&ran.code), "{what}: exit code {}: {err}", ran.code);
    assert!(ran.peak_mb < MOST_MB, "{what}: {} MB", ran.peak_mb);
}

/// Checks `names` for people and twice for programs. Both answers hold every one of `says`; the name of a file is told.
pub fn check_all<S: AsRef<OsStr>>(folder: &Path, names: &[S], code: i32, says: &[&str]) -> Value {
    let what = names
        .iter()
        .map(|name| name.as_ref().to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ");
    let ask = |format: &str| {
        let verb = ["check", "--format", format].map(OsString::from);
        let arguments = verb
            .into_iter()
            .chain(names.iter().map(|name| name.as_ref().to_owned()));
        let ran = run(folder, arguments);
        is_sound(&ran, &what);
        assert_eq!(ran.code, code, "{what}: {}", String::from_utf8_lossy(&ran.out));
        ran
    };
    let (human, json, again) = (ask("human"), ask("json"), ask("json"));
    assert!(json.out == again.out, "{what}: two runs differ");
    let (text, report) = (human.text(), json.report());
    let peak = human.peak_mb.max(json.peak_mb).max(again.peak_mb);
    eprintln!("{what}: exit {code}, peak {peak} MB");
    let document = report["inputs"].to_string().replace("\\\"", "\"");
    for word in says {
        assert!(text.contains(word), "{what}: `{word}` is not in:\n{text}");
        assert!(document.contains(word), "{what}: `{word}` is not in:\n{document}");
    }
    let summary = &report["summary"];
    if code == 0 {
        assert!(
            summary["passed"].as_u64().expect("a report") > 0,
            "{what}: nothing was checked: {summary}"
        );
    }
    report
}

/// [`check_all`] of one file with these bytes, which must be named.
pub fn check(name: &str, bytes: impl AsRef<[u8]>, code: i32, says: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join(name), bytes).expect("a report");
    let report = check_all(folder.path(), &[name], code, says);
    assert_eq!(report["inputs"][0]["path"], name);
    report
}

/// The line of the first problem of the first input.
pub fn line(report: &Value) -> Option<u64> {
    report["inputs"][0]["problems"][0]["line"].as_u64()
}
