//! What the inputs of a run are known by: their hashes, for reports that somebody signs.
//!
//! Reads files again that were read before, as a stream. A file that cannot be read any more has no hash.

use std::fmt::Write;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::run::Run;
use crate::source::{ReadStatus, Source, SourceKind};

use super::parallel;

/// Bytes that are read at once.
const CHUNK: usize = 1 << 20;

/// Fills in [`Source::sha256`] of every input that was read from files here.
pub fn hash(run: &mut Run) {
    parallel::map(run.sources.iter_mut().collect(), |source| {
        source.sha256 = of(source);
    });
}

fn of(source: &Source) -> Option<String> {
    // A configuration is known as it was read; a profile of the tool is no file.
    if source.kind == SourceKind::Configuration {
        return Some(hex(&Sha256::digest(source.text.as_bytes())));
    }
    // What is no regular file may have no end.
    let is_known = source.kind != SourceKind::Unsupported || source.status == ReadStatus::Read;
    match source.files.as_slice() {
        _ if !is_known => None,
        [] => None,
        [only] => of_file(only),
        several => {
            let mut lines = String::new();
            for file in several {
                let name = file.file_name().unwrap_or_default().to_string_lossy();
                let _ = writeln!(lines, "{}  {name}", of_file(file)?);
            }
            Some(lines.trim_end().to_owned())
        }
    }
}

fn of_file(path: &Path) -> Option<String> {
    if !std::fs::metadata(path).ok()?.is_file() {
        return None;
    }
    let mut file = File::open(path).ok()?;
    let mut chunk = vec![0; CHUNK];
    let mut hasher = Sha256::new();
    loop {
        let read = file.read(&mut chunk).ok()?;
        if read == 0 {
            return Some(hex(&hasher.finalize()));
        }
        hasher.update(chunk.get(..read)?);
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::source::SourceId;

    #[test]
    fn hashes_are_those_that_sha256sum_says() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        std::fs::write(&a, "abc").unwrap();
        std::fs::write(&b, "").unwrap();
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        let nothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
        let mut source = Source::new(SourceId(0), "a", SourceKind::Yaml);
        assert_eq!(of(&source), None, "read from no file here");
        source.files = vec![a.clone()];
        assert_eq!(of(&source).as_deref(), Some(abc));
        source.files = vec![a, b];
        assert_eq!(of(&source), Some(format!("{abc}  a\n{nothing}  b")));
        source.files.push(folder.path().join("gone"));
        assert_eq!(of(&source), None);
        source.files = vec![folder.path().to_path_buf()];
        assert_eq!(of(&source), None, "a folder has none");
        let mut config = Source::new(SourceId(0), "profile ci", SourceKind::Configuration);
        config.text = "abc".to_owned();
        assert_eq!(of(&config).as_deref(), Some(abc));
    }
}
