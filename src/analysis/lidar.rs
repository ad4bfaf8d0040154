//! The clouds of a world, each with the driver that its fields identify, and planar laser scans as clouds. Must not judge.

use std::ops::RangeInclusive;

use crate::analysis::{names, radar};
use crate::source::Place;
use crate::tables::CloudDriver;
use crate::world::cloud::RING_FIELDS;
use crate::world::cloud::{CloudEvidence, CloudSample, PointTimes};
use crate::world::{BagEvidence, FrameId, World, bag::TopicEvidence, laser::LaserEvidence};

/// Units of point times, seconds.
const UNITS_S: [(f64, &str); 4] = [
    (1.0, "seconds"),
    (1e-3, "milliseconds"),
    (1e-6, "microseconds"),
    (1e-9, "nanoseconds"),
];

/// Longest scan, seconds: if nearly all clouds are dropped, the times would match another unit.
const LONGEST_S: f64 = 20.0;
/// Shortest and longest duration of a cloud, as a share of the time to the next one.
pub(crate) const SCAN_SHARE: RangeInclusive<f64> = 0.02..=1.1;

/// Fields that only the points of a lidar have, beside those of rings.
const OF_A_LIDAR: [&str; 5] = ["azimuth", "reflectivity", "tag", "return_type", "column"];

/// Words in topics and frames of lidars.
const LIDARS: [&str; 16] = [
    "lidar",
    "laser",
    "velodyne",
    "ouster",
    "os",
    "livox",
    "hesai",
    "pandar",
    "robosense",
    "rslidar",
    "seyond",
    "innoviz",
    "aeva",
    "luminar",
    "vlp",
    "vlp16",
];

/// The clouds of one topic.
#[derive(Clone, Copy)]
pub(crate) struct Clouds<'w> {
    pub(crate) bag: &'w BagEvidence,
    /// Index of the recording in the world.
    pub(crate) index: usize,
    pub(crate) topic: &'w TopicEvidence,
    pub(crate) evidence: &'w CloudEvidence,
    /// The planar scans, if these are no clouds: the evidence then has only their runs.
    pub(crate) laser: Option<&'w LaserEvidence>,
    /// The driver that its fields identify.
    pub(crate) driver: Option<&'w CloudDriver>,
}

impl<'w> Clouds<'w> {
    /// Those of a world that have points with x, y and z.
    pub(crate) fn all(world: &'w World) -> impl Iterator<Item = Self> {
        world.bags.iter().enumerate().flat_map(move |(index, bag)| {
            bag.topics.values().filter_map(move |topic| {
                let evidence = topic.content.clouds.as_ref()?;
                let layout = evidence.layouts.first()?;
                let has = |name: &str| layout.fields.iter().any(|field| field.name == name);
                if !(has("x") && has("y") && has("z")) {
                    return None;
                }
                let fields = layout.fields.iter();
                Some(Self {
                    bag,
                    index,
                    topic,
                    evidence,
                    laser: None,
                    driver: world
                        .tables
                        .cloud_driver(fields.map(|field| (field.name.as_str(), field.datatype.as_str()))),
                })
            })
        })
    }

    /// Those that a driver published: not those that were decoded from packets here, whose layout and origin of times are ours.
    pub(crate) fn published(world: &'w World) -> impl Iterator<Item = Self> {
        Self::all(world).filter(|clouds| clouds.evidence.packets.is_none())
    }

    /// The planar laser scans of a world.
    pub(crate) fn lasers(world: &'w World) -> impl Iterator<Item = Self> {
        world.bags.iter().enumerate().flat_map(|(index, bag)| {
            bag.topics.values().filter_map(move |topic| {
                let laser = topic.content.lasers.as_deref()?;
                Some(Self {
                    bag,
                    index,
                    topic,
                    evidence: &laser.projected,
                    laser: Some(laser),
                    driver: None,
                })
            })
        })
    }

    /// Both, for rules on motion in the plane of x and y.
    pub(crate) fn scanners(world: &'w World) -> impl Iterator<Item = Self> {
        Self::all(world).chain(Self::lasers(world))
    }

    /// Its subject in outcomes.
    pub(crate) fn subject(&self, of: &str) -> String {
        format!("{of} of topic `{}`", self.topic.topic)
    }

    /// The first cloud.
    pub(crate) fn place(&self) -> Place {
        let of_cloud = self.evidence.layouts.first().map(|layout| &layout.at);
        let first = self.laser.map(|laser| &laser.first).or(of_cloud);
        Place::of(self.bag.source, first)
    }

    /// The frame of the first cloud that names one.
    pub(crate) fn frame(&self) -> Option<FrameId> {
        let frames = self.topic.header_frames.keys().map(FrameId::canonical);
        frames.into_iter().find(|frame| !frame.as_str().is_empty())
    }

    /// Why there is no frame, where there is none.
    pub(crate) fn frameless(&self) -> &'static str {
        if self.topic.header_frames.is_empty() {
            "a capture, or a topic of single packets, does not state the frame of its lidar"
        } else {
            "the clouds have no `frame_id`"
        }
    }

    /// The type of a field of the points.
    pub(crate) fn datatype(&self, name: &str) -> Option<&'w str> {
        let layout = self.evidence.layouts.first()?;
        let field = layout.fields.iter().find(|field| field.name == name)?;
        Some(&field.datatype)
    }

    /// Whether these are raw points of a lidar: not of a depth camera, and not of a map.
    pub(crate) fn is_of_a_lidar(&self) -> bool {
        let is_registered = self.frame().is_some_and(|frame| names::is_world(&frame));
        let has_field = OF_A_LIDAR
            .iter()
            .chain(&RING_FIELDS)
            .any(|name| self.datatype(name).is_some());
        let words = self.topic.words();
        let has_word = words.iter().any(|word| LIDARS.contains(&word.as_str()));
        let has_colour = ["rgb", "rgba"].iter().any(|name| self.datatype(name).is_some());
        let is_lidar =
            self.laser.is_some() || self.evidence.packets.is_some() || self.driver.is_some() || has_field || has_word;
        is_lidar && !is_registered && !has_colour && !radar::is_of_a_radar(self.topic)
    }

    /// Time between clouds, seconds.
    pub(crate) fn period_s(&self) -> Option<f64> {
        let step_ns = self.topic.stamps.median_step_ns?;
        (step_ns > 0).then_some(step_ns as f64 * 1e-9)
    }

    /// Clouds with the times of their points.
    pub(crate) fn timed(&self) -> impl Iterator<Item = (&'w CloudSample, &'w PointTimes)> {
        let samples = self.evidence.samples.iter();
        samples.filter_map(|sample| Some((sample, sample.times.as_ref()?)))
    }

    /// The unit in which the times of a cloud span a scan, seconds, and its name; the period must be known. Of a throttled topic only every
    /// tenth scan or so is recorded.
    pub(crate) fn unit(&self, times: &PointTimes) -> Option<(f64, &'static str)> {
        let period_s = self.period_s().filter(|period_s| *period_s <= LONGEST_S)?;
        let [low, high] = times.quantiles;
        let fits = |(unit_s, _): &(f64, &str)| SCAN_SHARE.contains(&((high - low) * unit_s / period_s));
        UNITS_S.into_iter().find(fits)
    }

    /// The name of a unit.
    pub(crate) fn unit_word(unit_s: f64) -> &'static str {
        let near = |(known, _): &(f64, &str)| (known / unit_s - 1.0).abs() < 0.5;
        UNITS_S.into_iter().find(near).map_or("another unit", |(_, word)| word)
    }
}
