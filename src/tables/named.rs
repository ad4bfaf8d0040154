//! Devices, drivers and simulators that a recording names by a word.

use std::sync::OnceLock;

use serde::Deserialize;
use serde::de::DeserializeOwned;

/// What holds for everything that is known by a word.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
struct Row<T> {
    /// Its name in reports.
    name: String,
    /// Lower-case words by which it is known.
    words: Vec<String>,
    /// Where what follows is written.
    source: String,
    /// What is known of it.
    #[serde(flatten)]
    facts: T,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table<T> {
    rows: Vec<Row<T>>,
}

impl<T: DeserializeOwned> Table<T> {
    fn read(text: &str) -> Self {
        serde_yaml::from_str(text).unwrap_or(Self { rows: Vec::new() })
    }

    /// The first row that one of these words names.
    fn named(&'static self, words: &[String]) -> Option<Known<T>> {
        let names = |row: &&Row<T>| words.iter().any(|word| row.words.contains(word));
        let row = self.rows.iter().find(names)?;
        Some(Known {
            name: &row.name,
            facts: &row.facts,
        })
    }
}

/// Something that a word names, and what is known of it.
#[derive(Debug, PartialEq)]
pub struct Known<T: 'static> {
    /// Its name in reports.
    pub name: &'static str,
    /// What is known of it.
    pub facts: &'static T,
}

impl<T> Clone for Known<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Known<T> {}

/// An inertial navigation system with its driver.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct InsDriver {
    /// What the system itself measures in.
    pub native: String,
    /// What to set, so that the convention of ROS is published.
    pub setting: String,
    /// Headings that wrong settings give.
    #[serde(default)]
    pub offsets: Vec<Offset>,
}

/// An angle that yaw minus course takes where a setting is wrong.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Offset {
    /// Degrees, counter-clockwise.
    pub deg: f64,
    /// What it is then.
    pub what: String,
    /// What to set.
    pub setting: String,
}

/// A lidar with an inertial sensor inside.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct LidarImu {
    /// Position of the inertial sensor in the frame of the cloud, millimetres, where it is published.
    #[serde(default)]
    pub lever_mm: Option<[f64; 3]>,
}

/// A simulator.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct Simulator {
    /// Axes of its world.
    pub axes: String,
    /// The way to those of ROS.
    pub conversion: String,
}

fn ins_drivers() -> &'static Table<InsDriver> {
    static TABLE: OnceLock<Table<InsDriver>> = OnceLock::new();
    TABLE.get_or_init(|| Table::read(include_str!("../../rules/tables/ins-drivers.yaml")))
}

fn lidar_imus() -> &'static Table<LidarImu> {
    static TABLE: OnceLock<Table<LidarImu>> = OnceLock::new();
    TABLE.get_or_init(|| Table::read(include_str!("../../rules/tables/lidar-imus.yaml")))
}

fn simulators() -> &'static Table<Simulator> {
    static TABLE: OnceLock<Table<Simulator>> = OnceLock::new();
    TABLE.get_or_init(|| Table::read(include_str!("../../rules/tables/simulators.yaml")))
}

/// The inertial navigation system that one of these lower-case words names.
pub fn ins_driver(words: &[String]) -> Option<Known<InsDriver>> {
    ins_drivers().named(words)
}

/// The lidar with an inertial sensor that one of these lower-case words names.
pub fn lidar_imu(words: &[String]) -> Option<Known<LidarImu>> {
    lidar_imus().named(words)
}

/// The simulator that one of these lower-case words names.
pub fn simulator(words: &[String]) -> Option<Known<Simulator>> {
    simulators().named(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    fn is_whole<T>(table: &Table<T>) -> bool {
        !table.rows.is_empty()
            && table
                .rows
                .iter()
                .all(|row| !row.source.is_empty() && !row.words.is_empty())
    }

    #[test]
    fn every_table_reads_and_every_row_has_a_source() {
        assert!(is_whole(ins_drivers()));
        assert!(is_whole(lidar_imus()));
        assert!(is_whole(simulators()));
    }

    #[test]
    fn whole_words_name_and_parts_of_words_do_not() {
        assert_eq!(
            ins_driver(&words("vn driver vectornav")).map(|known| known.name),
            Some("VectorNav")
        );
        assert_eq!(ins_driver(&words("imu data")), None);
        assert_eq!(simulator(&words("carla ego")).map(|known| known.name), Some("CARLA"));
        assert_eq!(simulator(&words("car community")), None);
        let lever = |text: &str| lidar_imu(&words(text)).and_then(|known| known.facts.lever_mm);
        assert_eq!(lever("livox avia").map(|[x, ..]| x), Some(-41.65));
        assert_eq!(lever("livox"), None);
    }
}
