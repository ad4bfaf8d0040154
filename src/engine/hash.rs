//! Hashes of the inputs of a run, for reports to be signed.
//!
//! Reads the files again, as a stream. A file that can no longer be read has no hash.

use std::fmt::Write;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::run::Run;
use crate::source::{FileHash, ReadStatus, Source, SourceKind};

use super::parallel;

/// Bytes that are read at once.
const CHUNK: usize = 1 << 20;

/// Fills in [`Source::hashes`] of every input that was read from files here.
pub fn hash(run: &mut Run) {
    parallel::map(run.sources.iter_mut().collect(), |source| {
        let hashes = of(source);
        Arc::make_mut(source).hashes = hashes;
    });
}

fn of(source: &Source) -> Vec<FileHash> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    // A configuration is hashed as it was read; a built-in profile is not a file.
    if source.kind == SourceKind::Configuration {
        return vec![FileHash {
            name: name(Path::new(&source.path)),
            sha256: Some(hex(&Sha256::digest(source.text.as_bytes()))),
        }];
    }
    if source.kind == SourceKind::Unsupported && source.status != ReadStatus::Read {
        return Vec::new();
    }
    // A file that is not regular may be endless.
    let is_other = |path: &Path| std::fs::metadata(path).is_ok_and(|about| !about.is_file());
    let files = source.files.iter().filter(|path| !is_other(path));
    files
        .map(|path| FileHash {
            name: name(path),
            sha256: of_file(path),
        })
        .collect()
}

fn of_file(path: &Path) -> Option<String> {
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
        let said = |source: &Source| -> Vec<(String, Option<String>)> {
            of(source).into_iter().map(|hash| (hash.name, hash.sha256)).collect()
        };
        let expected = |name: &str, digest: &str| (name.to_owned(), Some(digest.to_owned()));
        let mut source = Source::new(SourceId(0), "a", SourceKind::Yaml);
        assert_eq!(said(&source), [], "read from no file here");
        source.files = vec![a, b, folder.path().join("gone"), folder.path().to_path_buf()];
        let both = [expected("a", abc), expected("b", nothing), ("gone".to_owned(), None)];
        assert_eq!(said(&source), both, "a folder has none");
        let mut config = Source::new(SourceId(0), "profile ci", SourceKind::Configuration);
        config.text = "abc".to_owned();
        assert_eq!(said(&config), [expected("profile ci", abc)]);
    }
}
