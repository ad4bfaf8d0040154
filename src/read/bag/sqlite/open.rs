//! Opening a database for reading and for nothing else.
//!
//! Owns what keeps SQLite from writing next to the file, from trusting it and from working without end. Must not know
//! tables.

use std::ffi::OsString;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use rusqlite::config::DbConfig;
use rusqlite::limits::Limit;
use rusqlite::{Connection, OpenFlags};

use crate::source::{Place, ReadStatus, Source};

use super::super::MAX_MESSAGE;

/// Bytes of a write-ahead log before its first entry.
const LOG_HEADER: u64 = 32;
/// Steps of SQLite's machine between two looks at the bound.
const STEPS_A_LOOK: i32 = 1 << 20;
/// Steps that every database may cost. A row costs about ten and fills at least twelve bytes.
const STEPS: u64 = 64 << 20;
/// Steps that a database may cost for each of its bytes: several whole passes.
const STEPS_A_BYTE: u64 = 8;

/// Opens the database at `path` so that nothing is written and no lock is taken: folders that cannot be written to are
/// fine, and so is a recorder that still runs. The content of a write-ahead log next to it is read too.
pub(super) fn open(path: &Path, total: u64, source: &mut Source) -> Result<Connection, String> {
    let log = beside(path, "-wal");
    let has_log = fs::metadata(&log).is_ok_and(|meta| meta.is_file() && meta.len() > LOG_HEADER);
    if fs::metadata(beside(path, "-journal")).is_ok_and(|meta| meta.is_file() && meta.len() > 0) {
        let message = "a rollback journal is next to it: the recorder was stopped while writing, and the last messages may \
                       be wrong";
        source.problem(ReadStatus::Partial, Place::whole(source.id), message);
    }
    if has_log {
        match connect(path, "mode=ro&vfs=unix-none", total) {
            Ok(connection) if cfg!(unix) => return Ok(connection),
            _ => {
                let message =
                    "the write-ahead log next to it (`-wal`) could not be used: the last messages are missing";
                source.problem_with_help(
                    ReadStatus::Partial,
                    Place::whole(source.id),
                    message,
                    Some("close the recorder, or open the file once with `sqlite3` to merge the log".to_owned()),
                );
            }
        }
    }
    connect(path, "mode=ro&immutable=1", total)
}

fn connect(path: &Path, options: &str, total: u64) -> Result<Connection, String> {
    let uri = uri(path, options)?;
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    Connection::open_with_flags(uri, flags)
        .and_then(|connection| prepare(connection, total))
        .map_err(|error| error.to_string())
}

fn prepare(mut connection: Connection, total: u64) -> rusqlite::Result<Connection> {
    // Without this, closing would write the log into the database.
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, true)?;
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false)?;
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_VIEW, false)?;
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_TRIGGER, false)?;
    // Lets a file be read whose end is missing; otherwise SQLite refuses it as a whole.
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_WRITABLE_SCHEMA, true)?;
    // The rest is for the row's other columns.
    let largest = i32::try_from(MAX_MESSAGE + (1 << 16)).unwrap_or(i32::MAX);
    connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, largest)?;
    connection.set_limit(Limit::SQLITE_LIMIT_ATTACHED, 0)?;
    let mut left = (STEPS + total.saturating_mul(STEPS_A_BYTE)) / u64::from(STEPS_A_LOOK.unsigned_abs());
    let tired = move || {
        left = left.saturating_sub(1);
        left == 0
    };
    connection.progress_handler(STEPS_A_LOOK, Some(tired))?;
    // In exclusive mode the index of a write-ahead log is kept in memory instead of a file next to the database.
    connection.execute_batch(
        "PRAGMA locking_mode = EXCLUSIVE; PRAGMA query_only = ON; PRAGMA mmap_size = 0; PRAGMA cell_size_check = ON;",
    )?;
    // Everything up to here is done without looking at the file.
    connection.query_row("SELECT count(*) FROM (SELECT 1 FROM sqlite_schema LIMIT 1)", [], |_| {
        Ok(())
    })?;
    Ok(connection)
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(ending);
    PathBuf::from(name)
}

/// `file:` URI of a path; every byte that could mean something in a URI is escaped.
fn uri(path: &Path, options: &str) -> Result<String, String> {
    let path = fs::canonicalize(path).map_err(|error| format!("cannot be opened: {error}"))?;
    let mut uri = "file:".to_owned();
    // The drive of a Windows path follows an empty host.
    uri.push_str(if cfg!(windows) { "///" } else { "" });
    for byte in path.as_os_str().as_encoded_bytes() {
        match byte {
            b'/' | b'.' | b'-' | b'_' | b':' => uri.push(char::from(*byte)),
            b'\\' if cfg!(windows) => uri.push('/'),
            letter if letter.is_ascii_alphanumeric() => uri.push(char::from(*letter)),
            other => {
                let _ = write!(uri, "%{other:02X}");
            }
        }
    }
    let _ = write!(uri, "?{options}");
    Ok(uri)
}
