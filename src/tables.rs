//! Tables of published facts, as data in `rules/tables/`, read once and typed; users add rows of their own to those of devices.
//!
//! Owns their reading. Must not know rules or worlds. A table of this program that cannot be read is a bug here: the tests read
//! every one. At run time such a table is empty.

pub mod beams;
mod clouds;
mod dataset;
mod dialects;
mod named;
mod ouster;
pub mod recordings;
mod rows;
pub mod views;
mod writing;

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use serde::Deserialize;

pub use clouds::{CloudDriver, PointTime, Sweep, TimeOrigin};
pub use dataset::{Axes, Dataset, DatasetFrame, QuaternionWord};
pub use dialects::{Angle, Dialect, KeyedTransform, Length};
pub use named::{Forward, InsDriver, Lidar, LidarImu, Offset, Simulator};
pub use ouster::{OusterPart, OusterPlace};
pub use rows::{RowFault, Rows};
pub use writing::{FileTemplate, TransformTemplate, writings};

use rows::Row;

/// A table that comes with the program: `build.rs` converts each in `rules/tables/` to JSON.
macro_rules! table {
    ($name:literal) => {
        serde_json::from_str(include_str!(concat!(env!("OUT_DIR"), "/", $name, ".json")))
    };
}
use table;

/// The rows of such a table, read at first use.
macro_rules! rows {
    ($row:ty, $name:literal) => {{
        static ROWS: LazyLock<Vec<Arc<$row>>> = LazyLock::new(|| rows::built_in(table!($name)));
        Rows::of(&ROWS)
    }};
}

/// The tables of devices, drivers and datasets.
#[derive(Clone, Debug)]
pub struct Tables {
    lidar_clouds: Rows<CloudDriver>,
    lidars: Rows<Lidar>,
    ouster: Rows<OusterPlace>,
    lidar_imus: Rows<LidarImu>,
    driver_frames: Rows<Driver>,
    ins_drivers: Rows<InsDriver>,
    simulators: Rows<Simulator>,
    datasets: Rows<Dataset>,
    dialects: Rows<Dialect>,
}

impl Default for Tables {
    /// Those that come with the program.
    fn default() -> Self {
        Self {
            lidar_clouds: rows!(CloudDriver, "lidar-clouds"),
            lidars: rows!(Lidar, "lidars"),
            ouster: rows!(OusterPlace, "ouster"),
            lidar_imus: rows!(LidarImu, "lidar-imus"),
            driver_frames: rows!(Driver, "driver-frames"),
            ins_drivers: rows!(InsDriver, "ins-drivers"),
            simulators: rows!(Simulator, "simulators"),
            datasets: rows!(Dataset, "datasets"),
            dialects: rows!(Dialect, "calibration-dialects"),
        }
    }
}

impl Tables {
    /// Their names, as the files in `rules/tables/`.
    pub const NAMES: [&str; 9] = [
        "lidar-clouds",
        "lidars",
        "ouster",
        "lidar-imus",
        "driver-frames",
        "ins-drivers",
        "simulators",
        "datasets",
        "calibration-dialects",
    ];

    /// Adds a row of the user's to a table; `origin` is its place.
    pub fn add(&mut self, table: &str, row: &serde_yaml::Value, origin: &str) -> Result<(), RowFault> {
        match table {
            "lidar-clouds" => self.lidar_clouds.add(row, origin),
            "lidars" => self.lidars.add(row, origin),
            "ouster" => self.ouster.add(row, origin),
            "lidar-imus" => self.lidar_imus.add(row, origin),
            "driver-frames" => self.driver_frames.add(row, origin),
            "ins-drivers" => self.ins_drivers.add(row, origin),
            "simulators" => self.simulators.add(row, origin),
            "datasets" => self.datasets.add(row, origin),
            "calibration-dialects" => self.dialects.add(row, origin),
            _ => Err(RowFault {
                keys: Vec::new(),
                message: format!("there is no table `{table}`; known tables: {}", Self::NAMES.join(", ")),
            }),
        }
    }

    /// The driver whose points have these fields, each with its type.
    pub fn cloud_driver<'f>(&self, fields: impl Iterator<Item = (&'f str, &'f str)>) -> Option<&CloudDriver> {
        let known: BTreeMap<&str, &str> = fields.collect();
        self.lidar_clouds.iter().map(Arc::as_ref).find(|row| row.fits(&known))
    }

    /// Fields in which the user's drivers of lidars have the times of points.
    pub fn own_time_fields(&self) -> impl Iterator<Item = &str> {
        let times = self.lidar_clouds.own().iter().filter_map(|row| row.time.as_ref());
        times.map(|time| time.field.as_str())
    }

    /// The lidar that one of these lower-case words names.
    pub fn lidar(&self, words: &[String]) -> Option<Arc<Lidar>> {
        named::named(&self.lidars, words)
    }

    /// Every lidar.
    pub fn lidars(&self) -> impl Iterator<Item = &Lidar> {
        self.lidars.iter().map(Arc::as_ref)
    }

    /// Every known position of a part of an Ouster.
    pub fn ouster_places(&self, part: OusterPart) -> impl Iterator<Item = &OusterPlace> {
        self.ouster.iter().map(Arc::as_ref).filter(move |row| row.part == part)
    }

    /// The lidar with an inertial sensor that one of these lower-case words names.
    pub fn lidar_imu(&self, words: &[String]) -> Option<Arc<LidarImu>> {
        named::named(&self.lidar_imus, words)
    }

    /// The driver that publishes this edge itself.
    pub fn driver_of_edge(&self, parent: &str, child: &str) -> Option<&str> {
        let found = self.driver_frames.iter().find(|driver| driver.has(parent, child));
        found.map(|driver| driver.driver.as_str())
    }

    /// The driver of an inertial navigation system that one of these lower-case words names.
    pub fn ins_driver(&self, words: &[String]) -> Option<Arc<InsDriver>> {
        named::named(&self.ins_drivers, words)
    }

    /// The simulator that one of these lower-case words names.
    pub fn simulator(&self, words: &[String]) -> Option<Arc<Simulator>> {
        named::named(&self.simulators, words)
    }

    /// The dataset with this name in the configuration.
    pub fn dataset(&self, word: &str) -> Option<Arc<Dataset>> {
        self.datasets.iter().find(|row| row.is_called(word)).cloned()
    }

    /// Dialects of calibration files; the first one whose marks a file has is used.
    pub fn dialects(&self) -> &Rows<Dialect> {
        &self.dialects
    }

    /// The names of the datasets.
    pub fn dataset_names(&self) -> Vec<&str> {
        self.datasets.iter().map(|row| row.name.as_str()).collect()
    }
}

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
            return Err(format!("`{text}` is not a date of the form 2017-01-01"));
        };
        // Days from civil (Hinnant): years begin in March, so that the leap day is the last.
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
    /// The day from whose start the value applies.
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

    /// `GPS - UTC` at a Unix time, seconds: TAI is always 19 s ahead of GPS time.
    pub fn gps_minus_utc_s(&self, unix_s: f64) -> f64 {
        self.tai_minus_utc_s(unix_s) - 19.0
    }
}

/// The table of leap seconds.
pub fn leap_seconds() -> &'static LeapSeconds {
    static TABLE: LazyLock<LeapSeconds> = LazyLock::new(|| {
        table!("leap-seconds").unwrap_or_else(|_| LeapSeconds {
            source: String::new(),
            expires: Day { unix_s: 0 },
            steps: Vec::new(),
        })
    });
    &TABLE
}

/// Transforms that a driver publishes inside its own device.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Driver {
    /// The driver.
    pub driver: String,
    /// Patterns of parent and child; `*` is any text, the same in both.
    edges: Vec<(String, String)>,
    /// Whether the source was checked.
    #[serde(default)]
    pub verified: bool,
    /// The source.
    #[serde(default)]
    pub source: String,
}

/// The text for `*` if `name` matches `pattern`; empty for a pattern without one.
fn captured<'n>(pattern: &str, name: &'n str) -> Option<&'n str> {
    match pattern.split_once('*') {
        Some((before, after)) => name.strip_prefix(before)?.strip_suffix(after),
        None => (pattern == name).then_some(""),
    }
}

impl Driver {
    /// Whether this edge is one of its own.
    fn has(&self, parent: &str, child: &str) -> bool {
        self.edges.iter().any(|(of_parent, of_child)| {
            let stem = captured(of_parent, parent);
            stem.is_some() && stem == captured(of_child, child)
        })
    }
}

impl Row for Driver {
    fn source_mut(&mut self) -> &mut String {
        &mut self.source
    }

    fn fault(&self) -> Option<(&'static str, &'static str)> {
        let is_empty = |(parent, child): &(String, String)| parent.is_empty() || child.is_empty();
        let is_faulty = self.edges.is_empty() || self.edges.iter().any(is_empty);
        is_faulty.then_some(("edges", "at least one pair of a parent and a child is required"))
    }
}

/// A form in which files state the origin of a local frame on the Earth.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OriginFormat {
    /// Its name.
    pub format: String,
    /// The program that reads it.
    pub source: String,
    /// The key above it; without one, its keys are among others.
    pub key: Option<String>,
    /// What the numbers of a list are: `latitude`, `longitude`, `altitude`, or another word.
    #[serde(default)]
    pub list: Vec<String>,
    /// The keys of latitude, longitude and, where it is used, altitude.
    #[serde(default)]
    pub keys: Vec<String>,
    /// A neighbouring key that must be true.
    pub only_if: Option<String>,
    /// A neighbouring key that names one of a list of origins.
    pub chosen_by: Option<String>,
    /// A neighbouring key that names the projection.
    pub projection: Option<String>,
}

/// The table of origins on the Earth.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EarthOrigins {
    /// Its formats.
    pub formats: Vec<OriginFormat>,
    /// Words of keys above that mark an origin as one of a simulated receiver.
    pub pretended: Vec<String>,
}

/// The table of origins on the Earth.
pub fn earth_origins() -> &'static EarthOrigins {
    static TABLE: LazyLock<EarthOrigins> = LazyLock::new(|| table!("earth-origins").unwrap_or_default());
    &TABLE
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
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
        let table = Tables::default();
        assert_eq!(table.driver_of_edge("os_sensor", "os_lidar"), Some("ouster-ros"));
        assert_eq!(
            table.driver_of_edge("front/os_sensor", "front/os_imu"),
            Some("ouster-ros")
        );
        assert_eq!(
            table.driver_of_edge("camera_link", "camera_depth_frame"),
            Some("realsense2_camera")
        );
        assert_eq!(table.driver_of_edge("cam", "cam_optical_frame"), Some("any camera"));
        assert_eq!(table.driver_of_edge("left_link", "right_depth_frame"), None);
        assert_eq!(table.driver_of_edge("base_link", "camera_link"), None);
        assert_eq!(table.driver_of_edge("base_link", "os_sensor"), None);
    }

    /// The files of the tables that users may add to.
    const FILES: [(&str, &str); 9] = [
        ("lidar-clouds", include_str!("../rules/tables/lidar-clouds.yaml")),
        ("lidars", include_str!("../rules/tables/lidars.yaml")),
        ("ouster", include_str!("../rules/tables/ouster.yaml")),
        ("lidar-imus", include_str!("../rules/tables/lidar-imus.yaml")),
        ("driver-frames", include_str!("../rules/tables/driver-frames.yaml")),
        ("ins-drivers", include_str!("../rules/tables/ins-drivers.yaml")),
        ("simulators", include_str!("../rules/tables/simulators.yaml")),
        ("datasets", include_str!("../rules/tables/datasets.yaml")),
        (
            "calibration-dialects",
            include_str!("../rules/tables/calibration-dialects.yaml"),
        ),
    ];

    #[test]
    fn every_row_reads_as_a_users_row_would_and_has_a_source_and_says_whether_it_was_verified() {
        assert_eq!(FILES.map(|(name, _)| name), Tables::NAMES);
        let mut tables = Tables::default();
        for (name, text) in FILES {
            let file: serde_yaml::Value = serde_yaml::from_str(text).unwrap();
            let rows = file.get("rows").and_then(serde_yaml::Value::as_sequence).unwrap();
            assert!(!rows.is_empty(), "{name}");
            for row in rows {
                let has = |key: &str| row.get(key).is_some();
                assert!(has("source") && has("verified"), "{name}: {row:?}");
                assert_eq!(tables.add(name, row, "here"), Ok(()), "{name}: {row:?}");
            }
        }
        assert_eq!(tables.lidar_clouds.own().len() * 2, tables.lidar_clouds.iter().count());
    }

    #[test]
    fn the_users_rows_win() {
        let mut tables = Tables::default();
        let row = "{name: ours, fields: {time: float32, ring: uint16}, time: {field: time, unit_s: 1e-3, counts_from: header}}";
        tables
            .add("lidar-clouds", &serde_yaml::from_str(row).unwrap(), "ours.yaml:1")
            .unwrap();
        let fields = [("time", "float32"), ("ring", "uint16")];
        let driver = tables.cloud_driver(fields.into_iter()).unwrap();
        assert_eq!(
            (driver.name.as_str(), driver.source.as_str(), driver.verified),
            ("ours", "ours.yaml:1", false)
        );
        assert_eq!(tables.own_time_fields().collect::<Vec<_>>(), ["time"]);
        assert!(
            tables
                .add("planets", &serde_yaml::Value::Null, "")
                .unwrap_err()
                .message
                .contains("known tables")
        );
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
