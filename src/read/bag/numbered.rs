//! The numbers in the names of the files that recorders split a recording into.

use std::path::Path;

/// The parts of a file's name: the name without number (and date), the ending, and the number. `None` where it has no number.
pub(in crate::read) fn numbered(path: &Path) -> Option<(String, String, u64)> {
    let name = path.file_name()?.to_str()?;
    let endings = [".mcap.zstd", ".db3.zstd", ".mcap", ".db3", ".bag"];
    let ending = endings
        .into_iter()
        .find(|ending| name.to_lowercase().ends_with(ending))?;
    let stem = name.get(..name.len() - ending.len())?;
    let (stem, number) = stem.rsplit_once('_')?;
    if number.is_empty() || number.len() > 9 || !number.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let stem = if ending == ".bag" { without_date(stem) } else { stem };
    Some((stem.to_owned(), ending.to_owned(), number.parse().ok()?))
}

/// Leaves out `2020-01-31-23-59-59` at the end, which differs between the files of one recording.
fn without_date(stem: &str) -> &str {
    const PATTERN: &[u8] = b"0000-00-00-00-00-00";
    let Some(at) = stem.len().checked_sub(PATTERN.len()) else {
        return stem;
    };
    let fits = |(byte, pattern): (u8, &u8)| {
        if *pattern == b'0' {
            byte.is_ascii_digit()
        } else {
            byte == *pattern
        }
    };
    match stem.get(at..) {
        Some(date) if date.bytes().zip(PATTERN).all(fits) => stem.get(..at).unwrap_or(stem),
        _ => stem,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_their_number() {
        let of = |name: &str| numbered(Path::new(name)).map(|(stem, _, number)| (stem, number));
        assert_eq!(of("a/drive_0.mcap"), Some(("drive".to_owned(), 0)));
        assert_eq!(
            of("rosbag2_2025_10_01-23_25_08_12.db3"),
            Some(("rosbag2_2025_10_01-23_25_08".to_owned(), 12))
        );
        assert_eq!(of("drive_3.mcap.zstd"), Some(("drive".to_owned(), 3)));
        assert_eq!(of("d_2020-01-31-23-59-59_1.bag"), Some(("d_".to_owned(), 1)));
        assert_eq!(of("2020-01-31-23-59-59_1.bag"), Some((String::new(), 1)));
        assert_eq!(of("drive.mcap"), None);
        assert_eq!(of("drive_a.mcap"), None);
        assert_eq!(of("drive_1.yaml"), None);
    }
}
