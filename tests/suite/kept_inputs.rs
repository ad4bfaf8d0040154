//! Every input that is kept of the fuzzers, and damaged copies of it: each target runs through.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic, clippy::print_stdout)]

use std::fs;
use std::path::Path;

use rayon::prelude::*;

use crate::targets::TARGETS;

#[test]
fn every_kept_input_passes_its_target() {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds");
    let folders = crate::support::files(&seeds, "");
    let known = |path: &Path| TARGETS.iter().find(|(name, _)| path.starts_with(seeds.join(name)));
    let ran: Vec<&str> = folders
        .par_iter()
        .map(|path| {
            let (name, target) = known(path).unwrap_or_else(|| panic!("{}: no target", path.display()));
            println!("{}", path.display());
            let bytes = fs::read(path).unwrap();
            target(&bytes);
            for percent in [30, 70, 95] {
                target(&bytes[..bytes.len() * percent / 100]);
            }
            *name
        })
        .collect();
    for (name, _) in TARGETS {
        assert!(ran.contains(name), "no input of {name} is kept");
    }
}
