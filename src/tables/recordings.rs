//! What rules need as input, and how to provide it.

use std::sync::LazyLock;

use serde::Deserialize;

use super::table;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    rows: Vec<Row>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    kind: String,
    what: String,
    how: String,
}

fn rows() -> &'static [Row] {
    static ROWS: LazyLock<Vec<Row>> =
        LazyLock::new(|| table!("recordings").map_or_else(|_| Vec::new(), |table: Table| table.rows));
    &ROWS
}

/// Whether a kind is known.
pub fn is_known(kind: &str) -> bool {
    rows().iter().any(|row| row.kind == kind)
}

/// What is needed of these kinds, and how to provide it, in words; `None` if no kind is known.
pub fn advice(kinds: &[&str]) -> Option<String> {
    let known = kinds
        .iter()
        .filter_map(|kind| rows().iter().find(|row| row.kind == *kind));
    let words: Vec<String> = known.map(|row| format!("{}: {}", row.what, row.how)).collect();
    (!words.is_empty()).then(|| words.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_says_how_it_is_had() {
        assert!(rows().len() > 10);
        assert!(advice(&["imu"]).unwrap().contains("sensor_msgs/msg/Imu"));
        assert_eq!(advice(&["nothing"]), None);
    }
}
