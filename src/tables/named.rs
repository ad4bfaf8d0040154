//! Devices, drivers and simulators that a recording names by a word.

use std::sync::Arc;

use serde::Deserialize;

use super::rows::{Row, Rows};

/// Something that is identified by a word.
pub(super) trait KeywordRow: Row {
    /// Lower-case words that identify it.
    fn words(&self) -> &[String];
}

/// The first row that one of these words names.
pub(super) fn named<T: KeywordRow>(rows: &Rows<T>, words: &[String]) -> Option<Arc<T>> {
    let names = |row: &&Arc<T>| words.iter().any(|word| row.words().contains(word));
    rows.iter().find(names).cloned()
}

/// What is wrong with the words of a row.
fn words_fault(words: &[String]) -> Option<(&'static str, &'static str)> {
    let is_word = |word: &String| {
        !word.is_empty()
            && word
                .chars()
                .all(|letter| letter.is_alphanumeric() && !letter.is_uppercase())
    };
    let is_well = !words.is_empty() && words.iter().all(is_word);
    (!is_well).then_some((
        "words",
        "at least one whole word in lower-case letters and digits is required",
    ))
}

macro_rules! named {
    ($row:ty) => {
        impl Row for $row {
            fn source_mut(&mut self) -> &mut String {
                &mut self.source
            }

            fn fault(&self) -> Option<(&'static str, &'static str)> {
                words_fault(&self.words)
            }
        }

        impl KeywordRow for $row {
            fn words(&self) -> &[String] {
                &self.words
            }
        }
    };
}

named!(InsDriver);
named!(LidarImu);
named!(Simulator);
named!(Lidar);

/// An inertial navigation system with its driver.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InsDriver {
    /// Its name in reports.
    pub name: String,
    words: Vec<String>,
    /// The axes in which the system itself measures.
    pub native: String,
    /// What to set, so that the convention of ROS is published.
    pub setting: String,
    /// Headings that result from wrong settings.
    #[serde(default)]
    pub offsets: Vec<Offset>,
    /// Whether the source was checked.
    #[serde(default)]
    pub verified: bool,
    /// The source.
    #[serde(default)]
    pub source: String,
}

/// The angle of yaw minus course with a wrong setting.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Offset {
    /// Degrees, counter-clockwise.
    pub deg: f64,
    /// The cause.
    pub what: String,
    /// What to set.
    pub setting: String,
}

/// A lidar with an inertial sensor inside.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LidarImu {
    /// Its name in reports.
    pub name: String,
    words: Vec<String>,
    /// Position of the inertial sensor in the frame of the cloud, millimetres, where it is published.
    #[serde(default)]
    pub lever_mm: Option<[f64; 3]>,
    /// Whether the source was checked.
    #[serde(default)]
    pub verified: bool,
    /// The source.
    #[serde(default)]
    pub source: String,
}

/// A simulator.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simulator {
    /// Its name in reports.
    pub name: String,
    words: Vec<String>,
    /// Axes of its world.
    pub axes: String,
    /// The conversion to those of ROS.
    pub conversion: String,
    /// Whether the source was checked.
    #[serde(default)]
    pub verified: bool,
    /// The source.
    #[serde(default)]
    pub source: String,
}

/// A lidar with the driver that publishes its clouds.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lidar {
    /// Its name in reports.
    pub name: String,
    words: Vec<String>,
    /// The axis of the sensor itself that points forward.
    pub sensor: Forward,
    /// That of the clouds that its driver for ROS publishes.
    pub driver: Forward,
    /// Its direction of rotation, seen from above with z up.
    #[serde(default)]
    pub sweep: Option<super::Sweep>,
    /// Keys of its driver's configuration for a transform that the driver itself applies to every point.
    #[serde(default)]
    pub transform_keys: Vec<String>,
    /// Whether it does so only if that is switched on.
    #[serde(default)]
    pub transform_by_setting: bool,
    /// The frame of the clouds of its driver, by the driver's default, if packets state none.
    #[serde(default)]
    pub frame: Option<String>,
    /// That of its own IMU.
    #[serde(default)]
    pub imu_frame: Option<String>,
    /// Message types of packets with its points.
    #[serde(default)]
    pub packets: Vec<String>,
    /// Whether the source was checked.
    #[serde(default)]
    pub verified: bool,
    /// The source.
    #[serde(default)]
    pub source: String,
}

impl Lidar {
    /// Whether one of these lower-case words names it.
    pub fn is_named_by(&self, words: &[String]) -> bool {
        words.iter().any(|word| self.words.contains(word))
    }
}

/// The axis that points forward, in axes with z up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Forward {
    /// x forward, y left.
    X,
    /// y forward, x right.
    Y,
    /// Either x or -x, by a setting of the driver.
    XOrBack,
}

#[cfg(test)]
mod tests {
    use crate::tables::Tables;

    fn words(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn whole_words_name_and_parts_of_words_do_not() {
        let tables = Tables::default();
        let ins = |text: &str| tables.ins_driver(&words(text)).map(|row| row.name.clone());
        assert_eq!(ins("vn driver vectornav").as_deref(), Some("VectorNav"));
        assert_eq!(ins("imu data"), None);
        let simulator = |text: &str| tables.simulator(&words(text)).map(|row| row.name.clone());
        assert_eq!(simulator("carla ego").as_deref(), Some("CARLA"));
        assert_eq!(simulator("car community"), None);
        let lever = |text: &str| tables.lidar_imu(&words(text)).and_then(|row| row.lever_mm);
        assert_eq!(lever("livox avia").map(|[x, ..]| x), Some(-41.65));
        assert_eq!(lever("livox"), None);
    }
}
