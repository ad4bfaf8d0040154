//! A shell at a terminal, as a person types in it.

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use nix::pty::{Winsize, openpty};

use super::at_hand::left_out;

/// A shell that needs longer for one line hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running shell, killed in the end.
pub struct Shell {
    child: Child,
    keys: File,
    screen: Receiver<Vec<u8>>,
}

/// Where a program is installed; `None`, and a note, where it is not.
#[track_caller]
pub fn installed(program: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&folders)
        .map(|folder| folder.join(program))
        .find(|path| path.is_file());
    if found.is_none() {
        left_out(&format!("no {program}"));
    }
    found
}

impl Shell {
    /// Starts a program in `folder` with a terminal of its own.
    pub fn start(program: &Path, arguments: &[&str], folder: &Path) -> Self {
        // Nothing is broken over lines.
        let size = Winsize {
            ws_row: 50,
            ws_col: 9000,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        let terminal = openpty(Some(&size), None).expect("a terminal");
        let side = || Stdio::from(terminal.slave.try_clone().expect("a handle"));
        let child = Command::new(program)
            .args(arguments)
            .current_dir(folder)
            .env("HOME", folder)
            .env("ZDOTDIR", folder)
            .env("TERM", "xterm")
            .env("LC_ALL", "C.UTF-8")
            .stdin(side())
            .stdout(side())
            .stderr(side())
            .spawn()
            .expect("the shell starts");
        let keys = File::from(terminal.master);
        let mut shown = keys.try_clone().expect("a handle");
        let (sender, screen) = channel();
        std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count) = shown.read(&mut bytes) {
                if count == 0 || sender.send(bytes.get(..count).unwrap_or_default().to_vec()).is_err() {
                    break;
                }
            }
        });
        Self { child, keys, screen }
    }

    /// Types, and reads until `end` is shown: what was shown, with it.
    pub fn types(&mut self, keys: &str, end: &str) -> String {
        self.keys.write_all(keys.as_bytes()).expect("the terminal is open");
        let mut shown = Vec::new();
        loop {
            let text = String::from_utf8_lossy(&shown).into_owned();
            if text.contains(end) {
                return text;
            }
            match self.screen.recv_timeout(PATIENCE) {
                Ok(more) => shown.extend(more),
                Err(error) => panic!("{error} before `{end}`: {text}"),
            }
        }
    }
}

impl Drop for Shell {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
