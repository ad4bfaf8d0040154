//! Identifies a finding from run to run: not by its lines, which move, nor by its numbers, which vary.

use std::collections::BTreeMap;

use sha2::{Digest, Sha256};

use crate::run::Run;
use crate::verdict::waiver::Identity;

use super::place::Locator;

/// For each finding of a run, in order; equal findings are numbered.
pub(super) fn fingerprints(run: &Run, locator: &Locator) -> Vec<String> {
    let mut seen: BTreeMap<Identity, usize> = BTreeMap::new();
    run.verdict
        .findings
        .iter()
        .map(|finding| {
            let identity = Identity::of(finding, &run.platforms, |place| {
                let path = locator.path_of(place).to_owned();
                Some((path.clone(), path))
            });
            let number = seen.entry(identity.clone()).or_default();
            *number += 1;
            let Identity {
                rule,
                subject,
                path,
                relation,
            } = identity;
            let number = number.to_string();
            let text = [rule, subject, path, relation, number].join("\0");
            hex(&Sha256::digest(text.as_bytes()))
        })
        .collect()
}

/// Bytes in hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write;
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
