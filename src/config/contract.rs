//! The key `contract` of the configuration: what recordings of the platform hold.
//!
//! ```yaml
//! contract:
//!   topics:                       # exact names; each key but `topic` may be left out
//!     - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, tolerance_percent: 20, frame: imu_link}
//!     - {topic: /points, rings: 16, fields: [x, y, z, intensity, ring, time]}
//!     - {topic: /camera/camera_info, image: [1280, 720]}
//!     - {topic: /odom, type: nav_msgs/msg/Odometry, frame: [odom, map], child_frame: base_link, optional: true}
//!   transforms:                   # those that do not change
//!     - {parent: base_link, child: lidar, xyz_m: [0.3, 0, 1.2], rpy_deg: [0, 0, 90], tolerance_mm: 5, tolerance_deg: 0.2}
//! ```

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use crate::read::calibration::document::Node;
use crate::source::{Place, SourceId};
use crate::world::FrameId;
use crate::world::contract::{Contract, SensorTerms, TopicTerms, TransformTerms};

use super::ConfigError;
use super::reader::Reader;

const TOPIC: &[&str] = &[
    "topic",
    "type",
    "rate_hz",
    "tolerance_percent",
    "frame",
    "child_frame",
    "image",
    "rings",
    "rays",
    "fields",
    "optional",
];
const TRANSFORM: &[&str] = &["parent", "child", "xyz_m", "rpy_deg", "tolerance_mm", "tolerance_deg"];
const BOOL: &[(&str, bool)] = &[("true", true), ("false", false)];

/// From one message in a quarter of an hour to the steps of a fast IMU.
const RATE_HZ: RangeInclusive<f64> = 0.001..=100_000.0;
const TOLERANCE_PERCENT: RangeInclusive<f64> = 0.1..=1000.0;
const TOLERANCE_MM: RangeInclusive<f64> = 0.001..=1_000_000.0;
const TOLERANCE_DEG: RangeInclusive<f64> = 0.0001..=180.0;
/// Rings, rays, pixels along one side.
const COUNT: RangeInclusive<f64> = 1.0..=1_000_000.0;
/// Beyond the diameter of the Earth.
const XYZ_M: RangeInclusive<f64> = -2e7..=2e7;
const RPY_DEG: RangeInclusive<f64> = -360.0..=360.0;

impl Reader<'_> {
    /// Without the identity of its source: places are spans of it.
    pub(super) fn contract(&self, root: &Node) -> Result<Contract, ConfigError> {
        let mut contract = Contract::default();
        let Some(node) = root.get("contract") else {
            return Ok(contract);
        };
        self.keys(node, &["topics", "transforms"])?;
        for item in self.entries(node, "topics", "- {topic: /imu, type: sensor_msgs/msg/Imu}")? {
            let (name, terms) = self.topic_terms(item)?;
            self.once(
                &mut contract.topics,
                (name.clone(), terms),
                item,
                &format!("topic `{name}`"),
            )?;
        }
        let example = "- {parent: base_link, child: lidar, xyz_m: [0.3, 0, 1.2], rpy_deg: [0, 0, 90]}";
        for item in self.entries(node, "transforms", example)? {
            let (frames, terms) = self.transform_terms(item)?;
            let words = format!("transform `{}` -> `{}`", frames.0, frames.1);
            self.once(&mut contract.transforms, (frames, terms), item, &words)?;
        }
        Ok(contract)
    }

    fn entries<'n>(&self, node: &'n Node, key: &str, example: &str) -> Result<&'n [Node], ConfigError> {
        let Some(list) = node.get(key) else { return Ok(&[]) };
        list.items()
            .ok_or_else(|| self.error(list.span.start, &format!("`{key}` must be a list: `{example}`")))
    }

    fn once<K: Ord, T>(
        &self,
        known: &mut BTreeMap<K, T>,
        (key, terms): (K, T),
        item: &Node,
        words: &str,
    ) -> Result<(), ConfigError> {
        match known.insert(key, terms) {
            None => Ok(()),
            Some(_) => Err(self.error(item.span.start, &format!("the contract has {words} twice"))),
        }
    }

    fn topic_terms(&self, item: &Node) -> Result<(String, TopicTerms), ConfigError> {
        self.keys(item, TOPIC)?;
        let terms = TopicTerms {
            message_type: item.get("type").map(|node| self.name(node, "type")).transpose()?,
            rate_hz: self.number_in(item, "rate_hz", RATE_HZ)?,
            tolerance_percent: self.number_in(item, "tolerance_percent", TOLERANCE_PERCENT)?,
            frames: self.frames(item, "frame")?,
            child_frames: self.frames(item, "child_frame")?,
            sensor: SensorTerms {
                image: self.image(item)?,
                rings: self.count(item, "rings")?,
                rays: self.count(item, "rays")?,
                fields: self.field_names(item)?,
            },
            is_optional: self.word(item, "optional", BOOL)?.unwrap_or(false),
            place: Place::text(SourceId(0), item.span),
        };
        Ok((self.required_name(item, "topic")?, terms))
    }

    fn transform_terms(&self, item: &Node) -> Result<((FrameId, FrameId), TransformTerms), ConfigError> {
        self.keys(item, TRANSFORM)?;
        let [parent, child] = ["parent", "child"].map(|key| self.required_name(item, key));
        let [parent, child] = [parent?, child?].map(|name| FrameId::new(name).canonical());
        if parent == child {
            return Err(self.error(item.span.start, "`parent` and `child` are the same frame"));
        }
        let [x, y, z] = self.three(item, "xyz_m", &XYZ_M)?;
        let [roll, pitch, yaw] = self.three(item, "rpy_deg", &RPY_DEG)?.map(f64::to_radians);
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let terms = TransformTerms {
            pose: Isometry3::from_parts(Translation3::new(x, y, z), rotation),
            tolerance_mm: self.number_in(item, "tolerance_mm", TOLERANCE_MM)?,
            tolerance_deg: self.number_in(item, "tolerance_deg", TOLERANCE_DEG)?,
            place: Place::text(SourceId(0), item.span),
        };
        Ok(((parent, child), terms))
    }

    fn name(&self, node: &Node, key: &str) -> Result<String, ConfigError> {
        let name = node.text().filter(|text| !text.is_empty()).map(str::to_owned);
        name.ok_or_else(|| self.error(node.span.start, &format!("`{key}` must be a name")))
    }

    fn required_name(&self, item: &Node, key: &str) -> Result<String, ConfigError> {
        let node = item.get(key);
        let node = node.ok_or_else(|| self.error(item.span.start, &format!("`{key}` is missing")))?;
        self.name(node, key)
    }

    /// A frame, or a list of frames. An empty name is that of messages without a frame.
    fn frames(&self, item: &Node, key: &str) -> Result<Vec<FrameId>, ConfigError> {
        let Some(node) = item.get(key) else {
            return Ok(Vec::new());
        };
        let nodes = node.items().unwrap_or(std::slice::from_ref(node));
        let frame = |node: &Node| {
            let text = node.text();
            let text = text.ok_or_else(|| {
                self.error(
                    node.span.start,
                    &format!("`{key}` must be a frame, or a list of frames"),
                )
            })?;
            Ok(FrameId::new(text).canonical())
        };
        nodes.iter().map(frame).collect()
    }

    fn count(&self, item: &Node, key: &str) -> Result<Option<u32>, ConfigError> {
        let counted = |node| self.counted(node, key);
        item.get(key).map(counted).transpose()
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // in the range
    fn counted(&self, node: &Node, key: &str) -> Result<u32, ConfigError> {
        let number = self.ranged(node, key, &COUNT)?;
        if number.fract() == 0.0 {
            return Ok(number as u32);
        }
        Err(self.error(
            node.span.start,
            &format!("`{key}` must be a whole number, not {number}"),
        ))
    }

    fn image(&self, item: &Node) -> Result<Option<[u32; 2]>, ConfigError> {
        let Some(node) = item.get("image") else { return Ok(None) };
        let Some([width, height]) = node.items() else {
            return Err(self.error(node.span.start, "`image` must be [width, height] in pixels"));
        };
        Ok(Some([self.counted(width, "image")?, self.counted(height, "image")?]))
    }

    fn field_names(&self, item: &Node) -> Result<Vec<String>, ConfigError> {
        let names = self.entries(item, "fields", "[x, y, z, intensity]")?;
        names.iter().map(|node| self.name(node, "fields")).collect()
    }

    fn number_in(&self, item: &Node, key: &str, range: RangeInclusive<f64>) -> Result<Option<f64>, ConfigError> {
        let Some(node) = item.get(key) else { return Ok(None) };
        self.ranged(node, key, &range).map(Some)
    }

    fn ranged(&self, node: &Node, key: &str, range: &RangeInclusive<f64>) -> Result<f64, ConfigError> {
        let number = self.one(node, key)?;
        if range.contains(&number) {
            return Ok(number);
        }
        let what = format!(
            "`{key}` must be from {} to {}, not {number}",
            range.start(),
            range.end()
        );
        Err(self.error(node.span.start, &what))
    }

    /// Three numbers; zeros where the key is left out.
    fn three(&self, item: &Node, key: &str, range: &RangeInclusive<f64>) -> Result<[f64; 3], ConfigError> {
        let Some(node) = item.get(key) else {
            return Ok([0.0; 3]);
        };
        let Some([x, y, z]) = node.items() else {
            return Err(self.error(node.span.start, &format!("`{key}` must be a list of 3 numbers")));
        };
        Ok([
            self.ranged(x, key, range)?,
            self.ranged(y, key, range)?,
            self.ranged(z, key, range)?,
        ])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::path::Path;

    use super::super::parse;
    use super::*;

    #[test]
    fn terms_have_the_places_of_their_entries_and_later_ones_override() {
        let text = "contract:\n  topics:\n    - {topic: /imu, type: T, rate_hz: 100, frame: /imu}\n    - {topic: /odom, frame: [odom, ''], child_frame: base, optional: true}\n  \
                    transforms:\n    - {parent: base, child: imu, xyz_m: [1, 2, 3], rpy_deg: [0, 0, 90], tolerance_mm: 3}\n";
        let config = parse("c.yaml", text.to_owned(), Path::new("")).unwrap();
        assert!(config.conventions(None).contract.is_empty());
        let contract = config.conventions(Some(7)).contract;
        let imu = contract.topics.get("/imu").unwrap();
        let span = imu.place.span().unwrap();
        assert_eq!(imu.place.source.0, 7);
        assert!(text.get(span.start..).unwrap().starts_with("{topic: /imu"));
        assert_eq!((imu.rate_hz, imu.is_optional), (Some(100.0), false));
        assert_eq!(imu.frames, [FrameId::new("imu")]);
        let odom = contract.topics.get("/odom").unwrap();
        assert_eq!((odom.frames.len(), odom.is_optional), (2, true));
        let ((parent, child), mount) = contract.transforms.first_key_value().unwrap();
        assert_eq!((parent.as_str(), child.as_str()), ("base", "imu"));
        // 90 deg about z takes x to y.
        let x = mount.pose.rotation * nalgebra::Vector3::x();
        assert!((x - nalgebra::Vector3::y()).norm() < 1e-12);
        assert_eq!((mount.tolerance_mm, mount.tolerance_deg), (Some(3.0), None));
    }

    #[test]
    fn faults_have_a_place() {
        let fault = |text: &str| {
            parse("c.yaml", format!("contract:\n{text}"), Path::new(""))
                .unwrap_err()
                .0
        };
        for (text, words) in [
            (
                "  topic: []\n",
                "c.yaml:2:3: unknown key `topic`; did you mean `topics`?",
            ),
            (
                "  topics: {}\n",
                "c.yaml:2:11: `topics` must be a list: `- {topic: /imu",
            ),
            ("  topics: [{topic: /a, rate: 3}]\n", "c.yaml:2:24: unknown key `rate`"),
            ("  topics: [{type: T}]\n", "c.yaml:2:12: `topic` is missing"),
            (
                "  topics: [{topic: /a}, {topic: /a}]\n",
                "c.yaml:2:25: the contract has topic `/a` twice",
            ),
            (
                "  topics: [{topic: /a, rate_hz: .nan}]\n",
                "c.yaml:2:33: `rate_hz` must be a number",
            ),
            (
                "  topics: [{topic: /a, rate_hz: NaN}]\n",
                "c.yaml:2:33: `rate_hz` must be a number",
            ),
            (
                "  topics: [{topic: /a, rate_hz: -5}]\n",
                "`rate_hz` must be from 0.001 to 100000, not -5",
            ),
            (
                "  topics: [{topic: /a, rate_hz: 1e300}]\n",
                "`rate_hz` must be from 0.001 to 100000",
            ),
            (
                "  topics: [{topic: /a, tolerance_percent: -1}]\n",
                "c.yaml:2:43: `tolerance_percent` must be from 0.1 to 1000",
            ),
            (
                "  topics: [{topic: /a, image: [640]}]\n",
                "c.yaml:2:31: `image` must be [width, height] in pixels",
            ),
            (
                "  topics: [{topic: /a, rings: 16.5}]\n",
                "c.yaml:2:31: `rings` must be a whole number, not 16.5",
            ),
            (
                "  topics: [{topic: /a, fields: x}]\n",
                "`fields` must be a list: `[x, y, z, intensity]`",
            ),
            (
                "  topics: [{topic: /a, optional: perhaps}]\n",
                "`optional` must be one of true, false",
            ),
            (
                "  topics: [{topic: /a, frame: [[b]]}]\n",
                "`frame` must be a frame, or a list of frames",
            ),
            ("  transforms: [{parent: a}]\n", "c.yaml:2:16: `child` is missing"),
            ("  transforms: [{parent: a, child: /a}]\n", "are the same frame"),
            (
                "  transforms: [{parent: a, child: b, xyz_m: [1, 2]}]\n",
                "c.yaml:2:45: `xyz_m` must be a list of 3 numbers",
            ),
            (
                "  transforms: [{parent: a, child: b, xyz_m: [1, 2, 1e9]}]\n",
                "c.yaml:2:52: `xyz_m` must be from -20000000 to 20000000",
            ),
            (
                "  transforms: [{parent: a, child: b, rpy_deg: [0, 0, inf]}]\n",
                "`rpy_deg` must be a number",
            ),
            (
                "  transforms: [{parent: a, child: b, tolerance_mm: -3}]\n",
                "`tolerance_mm` must be from 0.001 to 1000000, not -3",
            ),
            (
                "  transforms: [{parent: a, child: b, tolerance_deg: 400}]\n",
                "`tolerance_deg` must be from 0.0001 to 180, not 400",
            ),
        ] {
            assert!(fault(text).contains(words), "{text}: {}", fault(text));
        }
    }
}
