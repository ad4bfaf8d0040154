//! `check --watch`: waits until something that was checked has changed.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use notify::{EventKind, RecursiveMode, Watcher};

/// Editors write in several steps: so long after the last of them the inputs are read again.
const SETTLED: Duration = Duration::from_millis(200);

/// Returns when a file among these, or in these folders, has changed and nothing more changes.
///
/// # Errors
///
/// What the system says where it can't watch them.
pub fn wait(paths: &[PathBuf]) -> Result<(), String> {
    let (sender, changes) = channel();
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
        // Reading is no change; of an error nobody knows, so it counts as one.
        let is_change = event.map_or(true, |event| !matches!(event.kind, EventKind::Access(_)));
        if is_change {
            let _ = sender.send(());
        }
    })
    .map_err(|error| error.to_string())?;
    for path in paths {
        // A file that is replaced is another file: its folder is watched.
        let (watched, mode) = if path.is_dir() {
            (path.as_path(), RecursiveMode::Recursive)
        } else {
            (folder(path), RecursiveMode::NonRecursive)
        };
        watcher
            .watch(watched, mode)
            .map_err(|error| format!("`{}` can't be watched: {error}", watched.display()))?;
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
