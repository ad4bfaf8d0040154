//! Tables of published facts, as data in `rules/tables/`, read once and typed.
//!
//! Owns their reading. Must not know rules or worlds. A table that does not read is a fault of ours: the tests hold
//! every one, and without it a table is empty and answers nothing.

mod clouds;
mod named;
mod ouster;

use std::sync::OnceLock;

use serde::Deserialize;

pub use clouds::{CloudDriver, CountsFrom, PointTime, Sweep, cloud_driver};
pub use named::{InsDriver, Known, LidarImu, Offset, Simulator, ins_driver, lidar_imu, simulator};
pub use ouster::{OusterPart, OusterPlace, ouster_places};

/// A day of the calendar, as seconds since 1970-01-01T00:00:00 UTC (leap seconds not counted: Unix time).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(try_from = "String")]
pub struct Day {
    /// Unix seconds at the start of the day.
    pub unix_s: i64,
}

impl TryFrom<String> for Day {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let parts: Vec<i64> = text.split('-').filter_map(|part| part.parse().ok()).collect();
        let [year, month @ 1..=12, day @ 1..=31] = parts[..] else {
            return Err(format!("`{text}` is no day of the form 2017-01-01"));
        };
        // Days from civil (Hinnant): years begin in March, so that the leap day is their last.
        let year = if month <= 2 { year - 1 } else { year };
        let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
        let days =
            365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + day_of_year - 719_468;
        Ok(Self { unix_s: days * 86_400 })
    }
}

/// A step of `TAI - UTC`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeapStep {
    /// The day from whose start the value holds.
    pub from: Day,
    /// `TAI - UTC`, seconds.
    pub tai_minus_utc_s: i32,
}

/// The table of leap seconds.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeapSeconds {
    /// Who published it.
    pub source: String,
    /// From this day on it may lack a leap second.
    pub expires: Day,
    /// Its steps, oldest first.
    pub steps: Vec<LeapStep>,
}

impl LeapSeconds {
    /// `TAI - UTC` at a Unix time, seconds; before 1972 that of 1972.
    pub fn tai_minus_utc_s(&self, unix_s: f64) -> f64 {
        let after = self.steps.partition_point(|step| step.from.unix_s as f64 <= unix_s);
        let step = self.steps.get(after.saturating_sub(1));
        step.map_or(0.0, |step| f64::from(step.tai_minus_utc_s))
    }

    /// `GPS - UTC` at a Unix time, seconds: TAI runs 19 s ahead of GPS time always.
    pub fn gps_minus_utc_s(&self, unix_s: f64) -> f64 {
        self.tai_minus_utc_s(unix_s) - 19.0
    }
}

/// The table of leap seconds.
pub fn leap_seconds() -> &'static LeapSeconds {
    static TABLE: OnceLock<LeapSeconds> = OnceLock::new();
    TABLE.get_or_init(|| {
        let text = include_str!("../rules/tables/leap-seconds.yaml");
        serde_yaml::from_str(text).unwrap_or_else(|_| LeapSeconds {
            source: String::new(),
            expires: Day { unix_s: 0 },
            steps: Vec::new(),
        })
    })
}

/// Transforms that a driver publishes inside its own device.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Driver {
    /// The driver.
    pub driver: String,
    /// Where that is written.
    pub source: String,
    /// Patterns of parent and child; `*` stands for any text, the same in both.
    pub edges: Vec<(String, String)>,
}

/// The table of drivers' own frames.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriverFrames {
    /// Its drivers.
    pub drivers: Vec<Driver>,
}

/// What `*` stands for where `name` fits `pattern`; empty for a pattern without one.
fn captured<'n>(pattern: &str, name: &'n str) -> Option<&'n str> {
    match pattern.split_once('*') {
        Some((before, after)) => name.strip_prefix(before)?.strip_suffix(after),
        None => (pattern == name).then_some(""),
    }
}

impl DriverFrames {
    /// The driver whose own edge this is.
    pub fn driver(&self, parent: &str, child: &str) -> Option<&str> {
        let fits = |(of_parent, of_child): &(String, String)| {
            let stem = captured(of_parent, parent);
            stem.is_some() && stem == captured(of_child, child)
        };
        let found = self.drivers.iter().find(|driver| driver.edges.iter().any(fits));
        found.map(|driver| driver.driver.as_str())
    }
}

/// The table of drivers' own frames.
pub fn driver_frames() -> &'static DriverFrames {
    static TABLE: OnceLock<DriverFrames> = OnceLock::new();
    TABLE.get_or_init(|| serde_yaml::from_str(include_str!("../rules/tables/driver-frames.yaml")).unwrap_or_default())
}

/// A way in which files state where the origin of a local frame lies on the Earth.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OriginFormat {
    /// What it is called.
    pub format: String,
    /// Who reads it.
    pub source: String,
    /// The key that it stands under; without one, the keys stand beside others.
    pub key: Option<String>,
    /// What the numbers of a list are: `latitude`, `longitude`, `altitude`, or another word.
    #[serde(default)]
    pub list: Vec<String>,
    /// The keys of latitude, longitude and, where it is used, altitude.
    #[serde(default)]
    pub keys: Vec<String>,
    /// A key beside that must be true.
    pub only_if: Option<String>,
    /// A key beside that names one of a list of origins.
    pub chosen_by: Option<String>,
    /// A key beside that names the projection.
    pub projection: Option<String>,
}

/// The table of origins on the Earth.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EarthOrigins {
    /// Its formats.
    pub formats: Vec<OriginFormat>,
    /// Words of keys above that make an origin one of a pretended receiver.
    pub pretended: Vec<String>,
}

/// The table of origins on the Earth.
pub fn earth_origins() -> &'static EarthOrigins {
    static TABLE: OnceLock<EarthOrigins> = OnceLock::new();
    TABLE.get_or_init(|| serde_yaml::from_str(include_str!("../rules/tables/earth-origins.yaml")).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_of_an_origin_says_where_latitude_and_longitude_stand() {
        let table = earth_origins();
        assert!(table.formats.len() > 10 && !table.pretended.is_empty());
        for format in &table.formats {
            let listed = ["latitude", "longitude"]
                .iter()
                .all(|word| format.list.iter().any(|at| at == word));
            assert!(listed || matches!(format.keys.len(), 2 | 3), "{}", format.format);
            assert!(!format.source.is_empty() && (format.key.is_some() || format.list.is_empty()));
        }
    }

    #[test]
    fn a_driver_knows_its_own_edges_and_no_mounting() {
        let table = driver_frames();
        assert_eq!(table.driver("os_sensor", "os_lidar"), Some("ouster-ros"));
        assert_eq!(table.driver("front/os_sensor", "front/os_imu"), Some("ouster-ros"));
        assert_eq!(
            table.driver("camera_link", "camera_depth_frame"),
            Some("realsense2_camera")
        );
        assert_eq!(table.driver("cam", "cam_optical_frame"), Some("any camera"));
        assert_eq!(table.driver("left_link", "right_depth_frame"), None);
        assert_eq!(table.driver("base_link", "camera_link"), None);
        assert_eq!(table.driver("base_link", "os_sensor"), None);
        assert!(table.drivers.iter().all(|driver| !driver.source.is_empty()));
    }

    /// `leap-seconds.list` of NIST: seconds since 1900, and `TAI - UTC` from then on.
    const NIST: &[(i64, i32)] = &[
        (2_272_060_800, 10),
        (2_287_785_600, 11),
        (2_303_683_200, 12),
        (2_335_219_200, 13),
        (2_366_755_200, 14),
        (2_398_291_200, 15),
        (2_429_913_600, 16),
        (2_461_449_600, 17),
        (2_492_985_600, 18),
        (2_524_521_600, 19),
        (2_571_782_400, 20),
        (2_603_318_400, 21),
        (2_634_854_400, 22),
        (2_698_012_800, 23),
        (2_776_982_400, 24),
        (2_840_140_800, 25),
        (2_871_676_800, 26),
        (2_918_937_600, 27),
        (2_950_473_600, 28),
        (2_982_009_600, 29),
        (3_029_443_200, 30),
        (3_076_704_000, 31),
        (3_124_137_600, 32),
        (3_345_062_400, 33),
        (3_439_756_800, 34),
        (3_550_089_600, 35),
        (3_644_697_600, 36),
        (3_692_217_600, 37),
    ];

    #[test]
    fn the_table_is_that_of_the_other_institute() {
        let table = leap_seconds();
        let steps: Vec<(i64, i32)> = table
            .steps
            .iter()
            .map(|step| (step.from.unix_s + 2_208_988_800, step.tai_minus_utc_s))
            .collect();
        assert_eq!(steps, NIST);
        assert_eq!(table.expires.unix_s, 1_798_416_000);
        assert!(!table.source.is_empty());
    }

    #[test]
    fn a_step_holds_from_its_own_second() {
        let table = leap_seconds();
        for (unix, gps) in [
            (1_483_228_799.9, 17.0),
            (1_483_228_800.0, 18.0),
            (1_435_708_799.0, 16.0),
            (1_435_708_800.0, 17.0),
            (1_180_000_000.0, 14.0),
            (1_280_000_000.0, 15.0),
            (9e9, 18.0),
            (0.0, -9.0),
        ] {
            assert!((table.gps_minus_utc_s(unix) - gps).abs() < f64::EPSILON, "{unix}");
        }
    }

    #[test]
    fn days_are_days() {
        let day = |text: &str| Day::try_from(text.to_owned()).map(|day| day.unix_s / 86_400);
        assert_eq!(day("1970-01-01"), Ok(0));
        assert_eq!(day("2000-02-29"), Ok(11_016));
        assert_eq!(day("2000-03-01"), Ok(11_017));
        assert!(day("2017-13-01").is_err());
        assert!(day("2017").is_err());
    }
}
