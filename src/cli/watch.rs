//! `check --watch`: waits until something that was checked has changed.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use notify::{EventKind, RecursiveMode, Watcher};

/// Editors write in several steps: the inputs are read again this long after the last change.
const SETTLED: Duration = Duration::from_millis(200);

/// Returns after one of these files, or a file in one of these folders, has changed and no further change follows.
///
/// # Errors
///
/// The system's message if it cannot watch them.
pub fn wait(paths: &[PathBuf]) -> Result<(), String> {
    let (sender, changes) = channel();
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
        // Reading is not a change; an error may hide one, so it counts as a change.
        let is_change = event.map_or(true, |event| !matches!(event.kind, EventKind::Access(_)));
        if is_change {
            let _ = sender.send(());
        }
    })
    .map_err(|error| error.to_string())?;
    for path in paths {
        // A replaced file is a new file: its folder is watched instead.
        let (watched, mode) = if path.is_dir() {
            (path.as_path(), RecursiveMode::Recursive)
        } else {
            (folder(path), RecursiveMode::NonRecursive)
        };
        watcher
            .watch(watched, mode)
            .map_err(|error| format!("cannot watch `{}`: {error}", watched.display()))?;
    }
    changes.recv().map_err(|error| error.to_string())?;
    loop {
        match changes.recv_timeout(SETTLED) {
            Ok(()) => {}
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
}

fn folder(path: &Path) -> &Path {
    path.parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}
