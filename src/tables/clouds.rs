//! Drivers of lidars by the layout of their points.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde::Deserialize;

/// How a driver lays out its points.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CloudDriver {
    /// Its name in reports.
    pub name: String,
    /// Fields that a point must have, with their types; `any` for any.
    fields: BTreeMap<String, String>,
    /// The times of its points.
    pub time: PointTime,
    /// Which way it sweeps, seen from above with z up.
    #[serde(default)]
    pub sweep: Option<Sweep>,
    /// Whether somebody looked into the source.
    pub verified: bool,
    /// Where it is written.
    pub source: String,
}

/// What the times of points mean.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointTime {
    /// The field.
    pub field: String,
    /// Its unit, seconds.
    pub unit_s: f64,
    /// From when it counts.
    pub counts_from: CountsFrom,
}

/// From when the times of points count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CountsFrom {
    /// The beginning of the scan.
    ScanStart,
    /// The stamp of the header, before or after.
    Header,
    /// 1970.
    Epoch,
}

/// Which way a lidar sweeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sweep {
    /// As a clock.
    Clockwise,
    /// Against it.
    CounterClockwise,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    rows: Vec<CloudDriver>,
}

fn table() -> &'static [CloudDriver] {
    static TABLE: OnceLock<Table> = OnceLock::new();
    &TABLE
        .get_or_init(|| serde_yaml::from_str(include_str!("../../rules/tables/lidar-clouds.yaml")).unwrap_or_default())
        .rows
}

/// The driver whose points have these fields, each with its type.
pub fn cloud_driver<'f>(fields: impl Iterator<Item = (&'f str, &'f str)>) -> Option<&'static CloudDriver> {
    let known: BTreeMap<&str, &str> = fields.collect();
    let has = |name: &String, datatype: &String| {
        known
            .get(name.as_str())
            .is_some_and(|known| datatype == "any" || known == datatype)
    };
    table()
        .iter()
        .find(|row| row.fields.iter().all(|(name, datatype)| has(name, datatype)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_reads_and_every_row_has_a_source() {
        assert!(!table().is_empty());
        assert!(
            table()
                .iter()
                .all(|row| !row.source.is_empty() && !row.fields.is_empty())
        );
    }

    #[test]
    fn drivers_are_known_by_their_fields_and_types() {
        let name = |fields: &[(&'static str, &'static str)]| {
            cloud_driver(fields.iter().copied()).map(|driver| driver.name.as_str())
        };
        let xyz = [("x", "float32"), ("y", "float32"), ("z", "float32")];
        assert_eq!(name(&xyz), None);
        assert_eq!(name(&[("time", "float32"), ("ring", "uint16")]), Some("Velodyne"));
        assert_eq!(name(&[("time", "float64"), ("ring", "uint16")]), None);
        let livox = [("timestamp", "float64"), ("tag", "uint8"), ("line", "uint8")];
        assert_eq!(name(&livox), Some("Livox (PointCloud2)"));
    }
}
