//! Any bytes as a feather table: no panic that gets out, no memory without bound.
#![no_main]

use frames_lint::read::feather;
use libfuzzer_sys::fuzz_target;

// The decoder's own panics are caught where it is called: the hook of the fuzzer would end the run before.
fuzz_target!(init: std::panic::set_hook(Box::new(|_| {})), |bytes: &[u8]| {
    let _ = feather::to_csv(bytes.to_vec());
});
