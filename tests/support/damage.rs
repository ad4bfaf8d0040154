//! Recordings that are spoilt: cut off, with other bytes in them, and where to put those.

/// So many percent of a file.
pub fn cut(bytes: &[u8], percent: usize) -> &[u8] {
    &bytes[..bytes.len() * percent / 100]
}

/// A file with other bytes from `at` on.
pub fn patched(bytes: &[u8], at: usize, value: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + value.len()].copy_from_slice(value);
    bytes
}

/// Byte of the first chunk of an MCAP.
pub fn first_chunk(bytes: &[u8]) -> usize {
    let mut at = 8;
    while bytes[at] != 6 {
        at = behind(bytes, at);
    }
    at
}

/// Byte behind a record of an MCAP.
pub fn behind(bytes: &[u8], record: usize) -> usize {
    record + 9 + u64::from_le_bytes(bytes[record + 1..record + 9].try_into().unwrap()) as usize
}
