//! The real program as a child process: what it says, how it ends, and how much memory it takes.

use std::ffi::OsStr;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// A child that needs longer hangs.
const PATIENCE: Duration = Duration::from_secs(180);

/// What became of one call.
#[derive(Debug)]
pub struct Ran {
    /// The exit code; -1 where a signal ended it.
    pub code: i32,
    /// Standard output.
    pub out: Vec<u8>,
    /// Standard error, as text.
    pub err: String,
    /// Largest resident memory that was seen, MB; 0 where the system does not say.
    pub peak_mb: u64,
}

impl Ran {
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

/// Runs `frames-lint` in `folder`. The outputs go to files, so that a long one cannot block the child.
pub fn run<S: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = S>) -> Ran {
    let mut out = tempfile::tempfile().expect("a temporary file");
    let mut err = tempfile::tempfile().expect("a temporary file");
    let mut child = Command::new(env!("CARGO_BIN_EXE_frames-lint"))
        .args(arguments)
        .current_dir(folder)
        .env_remove("RUST_BACKTRACE")
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
    let mut bytes = |file: &mut std::fs::File| {
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(0)).expect("a file is seekable");
        file.read_to_end(&mut bytes).expect("a file is readable");
        bytes
    };
    Ran {
        code: status.code().unwrap_or(-1),
        out: bytes(&mut out),
        err: String::from_utf8_lossy(&bytes(&mut err)).into_owned(),
        peak_mb,
    }
}

/// The peak so far, which the system keeps: only the last millisecond before the end can be missed.
fn resident_mb(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmHWM:"))
        .unwrap_or_default();
    let kb = line.split_whitespace().nth(1).and_then(|kb| kb.parse::<u64>().ok());
    kb.unwrap_or(0) / 1024
}
