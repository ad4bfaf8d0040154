//! Where the parts of an Ouster are in its Sensor frame.

use std::sync::OnceLock;

use serde::Deserialize;

/// A part of the sensor with a frame of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OusterPart {
    /// The beams: turned by 180 degrees about z.
    Lidar,
    /// The inertial sensor: not turned.
    Imu,
}

/// A part as the firmware of some models states it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OusterPlace {
    /// The part.
    pub part: OusterPart,
    /// The models.
    pub models: String,
    /// Its place in the Sensor frame, millimetres.
    pub xyz_mm: [f64; 3],
    /// Whether somebody read it in metadata that a sensor wrote.
    pub verified: bool,
    /// Where.
    pub source: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    rows: Vec<OusterPlace>,
}

/// Every place that is known of a part.
pub fn ouster_places(part: OusterPart) -> impl Iterator<Item = &'static OusterPlace> {
    static TABLE: OnceLock<Table> = OnceLock::new();
    let table =
        TABLE.get_or_init(|| serde_yaml::from_str(include_str!("../../rules/tables/ouster.yaml")).unwrap_or_default());
    table.rows.iter().filter(move |row| row.part == part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_reads_and_every_row_has_a_source() {
        let rows: Vec<_> = [OusterPart::Lidar, OusterPart::Imu]
            .into_iter()
            .flat_map(ouster_places)
            .collect();
        assert_eq!(rows.len(), 8);
        assert!(rows.iter().all(|row| !row.source.is_empty() && !row.models.is_empty()));
    }
}
