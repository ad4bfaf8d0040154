//! Any bytes as a feather table: no panic that gets out, no memory without bound.
#![no_main]

use frames_lint::read::feather;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = feather::to_csv(bytes.to_vec());
});
