//! Any bytes as an MCAP file: no panic, bounded memory, and a status that says what was read.
#![no_main]

use std::io::Write;
use std::sync::Once;

use frames_lint::collect::{How, collect};
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};
use libfuzzer_sys::fuzz_target;

static HOOK: Once = Once::new();

/// The mcap crate subtracts with overflow on some chunks; the reader catches that and says so. The fuzzer's own hook
/// would end the process at any panic, caught or not: panics of that crate are let through to the reader.
fn let_the_reader_catch() {
    HOOK.call_once(|| {
        let ending = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            let is_theirs = panic.location().is_some_and(|at| at.file().contains("/mcap-"));
            if !is_theirs {
                ending(panic);
            }
        }));
    });
}

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

fuzz_target!(|bytes: &[u8]| {
    let_the_reader_catch();
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    // The magic is given: the interesting bytes come after it.
    file.write_all(MAGIC).expect("writable");
    file.write_all(bytes).expect("writable");
    let mut source = Source::new(SourceId(0), "fuzz.mcap", SourceKind::Mcap);
    let collected = collect(file.path(), &How::default(), &mut source, &|_, _| {});
    assert!(source.status == ReadStatus::Read || !source.problems.is_empty());
    drop(collected);
});
