//! A fuzzer of one target, which `FUZZ_TARGET` names. Built without `--cfg fuzzing`, it runs the target on the given files.
#![cfg_attr(fuzzing, no_main)]

use targets::{TARGETS, Target};

mod support;
#[path = "../targets/mod.rs"]
mod targets;

/// The requested target.
fn target() -> Target {
    let name = std::env::var("FUZZ_TARGET").unwrap_or_default();
    let known = TARGETS.iter().find(|(known, _)| *known == name);
    let names: Vec<&str> = TARGETS.iter().map(|(name, _)| *name).collect();
    let (_, target) = known.unwrap_or_else(|| panic!("FUZZ_TARGET must be one of {}", names.join(", ")));
    *target
}

#[cfg(fuzzing)]
mod fuzzer {
    use std::panic::Location;
    use std::sync::OnceLock;

    use super::{Target, target};

    static TARGET: OnceLock<Target> = OnceLock::new();

    /// Panics of the MCAP and Arrow decoders are caught by their callers. The fuzzer's hook would end the process before that.
    fn init() {
        let ending = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            let is_caught = |at: &Location<'_>| at.file().contains("/mcap-") || at.file().contains("/arrow-");
            if !panic.location().is_some_and(is_caught) {
                ending(panic);
            }
        }));
        let _ = TARGET.set(target());
    }

    libfuzzer_sys::fuzz_target!(init: init(), |bytes: &[u8]| {
        if let Some(target) = TARGET.get() {
            target(bytes);
        }
    });
}

#[cfg(not(fuzzing))]
fn main() {
    let target = target();
    for file in std::env::args_os().skip(1) {
        target(&std::fs::read(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display())));
    }
}
