//! Which field of a cloud holds the times of its points.

use crate::read::messages::cloud::{Cloud, Column};

/// Names of time fields of points, as drivers write them.
const TIMES: &[&str] = &[
    "t",
    "time",
    "timestamp",
    "time_stamp",
    "offset_time",
    "time_offset",
    "t_us",
    "timeoffset",
    "stamp",
    "ts",
];

/// The field that holds the times of the points.
pub(in crate::collect) fn time_of<'f>(cloud: &Cloud<'_>, time_fields: &'f [String]) -> Option<(&'f str, Column)> {
    let mut names = time_fields.iter().map(String::as_str).chain(TIMES.iter().copied());
    names.find_map(|name| Some((name, cloud.column(name)?)))
}
