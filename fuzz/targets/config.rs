//! Any text as a configuration: no panic, and a place for every declaration and every fault.
use frames_lint::config;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match config::parse("frames-lint.yaml", text.to_owned(), std::path::Path::new("")) {
        Ok(config) => {
            for declaration in config.conventions(Some(0)).declarations {
                let span = declaration.place.and_then(|place| place.span()).expect("a place");
                assert!(text.get(span.start..span.end).is_some());
            }
        }
        Err(error) => assert!(error.0.starts_with("frames-lint.yaml:"), "{}", error.0),
    }
}
