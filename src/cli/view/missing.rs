//! Without the feature `rerun`: the error that says how to get a build with it.

use std::io::Read;
use std::path::Path;

use crate::cli::args::View;
use crate::cli::{Answer, Failure, Surroundings};
use crate::run::Run;

fn missing() -> Failure {
    Failure::Usage(
        "this build of frames-lint has no views: run `cargo install --path . --features rerun` in a clone of its repository"
            .to_owned(),
    )
}

pub(in crate::cli) fn is_there() -> Result<(), Failure> {
    Err(missing())
}

pub(in crate::cli) fn save(_run: &Run, _file: &Path, _max_bytes: u64) -> Result<String, Failure> {
    Err(missing())
}

pub(in crate::cli) fn run(_view: View, _stdin: &mut dyn Read, _surroundings: Surroundings) -> Result<Answer, Failure> {
    Err(missing())
}
