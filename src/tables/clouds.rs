//! Drivers of lidars by the layout of their points.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::rows::Row;

/// How a driver lays out its points.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CloudDriver {
    /// Its name in reports.
    pub name: String,
    /// Fields that a point must have, with their types; `any` for any.
    fields: BTreeMap<String, String>,
    /// Words in the names around a topic by which it is known where others write the same fields; empty where none do.
    #[serde(default)]
    words: Vec<String>,
    /// The times of its points; `None` if it publishes none.
    #[serde(default)]
    pub time: Option<PointTime>,
    /// Its direction of rotation, seen from above with z up.
    #[serde(default)]
    pub sweep: Option<Sweep>,
    /// Whether the source was checked.
    #[serde(default)]
    pub verified: bool,
    /// The source.
    #[serde(default)]
    pub source: String,
}

/// The meaning of the times of points.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointTime {
    /// The field.
    pub field: String,
    /// Its unit, seconds.
    pub unit_s: f64,
    /// The time from which it counts.
    pub counts_from: TimeOrigin,
}

/// The time from which the times of points count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeOrigin {
    /// The beginning of the scan.
    ScanStart,
    /// The stamp of the header, before or after.
    Header,
    /// 1970.
    Epoch,
}

/// The direction of rotation of a lidar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sweep {
    /// Clockwise.
    Clockwise,
    /// Counter-clockwise.
    CounterClockwise,
}

impl Sweep {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Clockwise => "clockwise",
            Self::CounterClockwise => "counter-clockwise",
        }
    }
}

/// Types of numbers of a point, as `PointField` has them.
const DATATYPES: [&str; 9] = [
    "any", "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64",
];

impl CloudDriver {
    /// Whether the words around a topic name it, or its fields are its alone.
    pub fn is_among(&self, words: &[String]) -> bool {
        self.words.is_empty() || self.words.iter().any(|word| words.contains(word))
    }

    /// Whether points with these fields, each with its type, are its.
    pub(super) fn fits(&self, known: &BTreeMap<&str, &str>) -> bool {
        let has = |(name, datatype): (&String, &String)| {
            let known = known.get(name.as_str());
            known.is_some_and(|known| datatype == "any" || known == datatype)
        };
        self.fields.iter().all(has)
    }
}

impl Row for CloudDriver {
    fn source_mut(&mut self) -> &mut String {
        &mut self.source
    }

    fn fault(&self) -> Option<(&'static str, &'static str)> {
        let is_type = |datatype: &String| DATATYPES.contains(&datatype.as_str());
        if self.fields.is_empty() || !self.fields.values().all(is_type) {
            return Some((
                "fields",
                "at least one name with its type is required: any, int8, uint8, int16, uint16, int32, uint32, float32, float64",
            ));
        }
        let time = self.time.as_ref()?;
        if !(time.unit_s.is_finite() && time.unit_s > 0.0) {
            return Some((
                "time",
                "`unit_s` must be the length of its unit in seconds, more than 0",
            ));
        }
        let is_known = self.fields.contains_key(&time.field);
        (!is_known).then_some(("time", "its `field` must be one of `fields`"))
    }
}

#[cfg(test)]
mod tests {
    use crate::tables::Tables;

    #[test]
    fn drivers_are_known_by_their_fields_and_types() {
        let tables = Tables::default();
        let name = |fields: &[(&'static str, &'static str)]| {
            let driver = tables.cloud_driver(fields.iter().copied());
            driver.map(|driver| driver.name.as_str())
        };
        let xyz = [("x", "float32"), ("y", "float32"), ("z", "float32")];
        assert_eq!(name(&xyz), None);
        assert_eq!(name(&[("time", "float32"), ("ring", "uint16")]), Some("Velodyne"));
        assert_eq!(name(&[("time", "float64"), ("ring", "uint16")]), None);
        let livox = [("timestamp", "float64"), ("tag", "uint8"), ("line", "uint8")];
        assert_eq!(name(&livox), Some("Livox (PointCloud2)"));
        assert_eq!(name(&livox[1..]), Some("Livox (PointCloud2 without times)"));
        let ouster = [
            ("t", "uint32"),
            ("ring", "uint16"),
            ("range", "uint32"),
            ("reflectivity", "uint8"),
            ("near_ir", "uint16"),
        ];
        assert_eq!(name(&ouster), Some("Ouster"));
        let nebula = [("time_stamp", "uint32"), ("channel", "uint16"), ("azimuth", "float32")];
        assert_eq!(name(&nebula), Some("Nebula"));
        assert_eq!(
            name(&[("timestamp", "float64"), ("ring", "uint16")]),
            Some("Hesai or RoboSense")
        );
    }
}
