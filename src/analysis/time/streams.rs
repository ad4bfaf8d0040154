//! Streams of stamps: one for each topic with headers, and one for each moving TF edge.
//!
//! Latched topics and static TF are left out: their stamps are older than their log time without a fault.

use serde::Deserialize;

use crate::analysis::tf::{HeaderUse, header_use};
use crate::math::stats::{mad, median};
use crate::source::{Place, SourceId};
use crate::tables::leap_seconds;
use crate::verdict::plot::{Axis, Level, Plot, Series};
use crate::world::bag::{StampEvidence, TfEdge, TopicEvidence};
use crate::world::{BagEvidence, FrameId, World, conventions::TimeScale};

/// Stamps below this (1973-03-03) are not calendar time: the clock counts from power-up, or shows the time of day.
pub(crate) const UPTIME_BELOW_S: f64 = 1e8;

/// One stream of stamps.
pub(crate) struct Stream<'w> {
    /// The recording.
    pub(crate) source: SourceId,
    /// `topic /imu`, or `TF odom from base_link on /tf`.
    pub(crate) subject: String,
    /// The stamps.
    pub(crate) stamps: &'w StampEvidence,
    /// Log time at which the recording begins, nanoseconds.
    start_ns: i64,
    /// Whether the stream comes from one publisher, as far as the recording shows: one frame id, one writer.
    pub(crate) single_frame: bool,
    /// The scale that the user declares its stamps in.
    pub(crate) declared: Option<Scale>,
    /// What it is a stream of.
    pub(crate) of: StreamSource<'w>,
}

/// A time scale that the configuration declares.
pub(crate) struct Scale {
    /// How far it is ahead of UTC at the time of the recording, seconds.
    pub(crate) ahead_s: f64,
    /// Its name and the origin of the declaration, in words; and the place of the declaration.
    pub(crate) words: String,
    pub(crate) place: Option<Place>,
}

/// What a stream is a stream of.
#[derive(Clone, Copy)]
pub(crate) enum StreamSource<'w> {
    /// The messages of a topic.
    Topic(&'w TopicEvidence),
    /// A TF edge that is not latched.
    Edge(&'w TfEdge),
}

/// What kind of clock made a stamp or a log time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Clock {
    /// Calendar time.
    Calendar,
    /// One that counts from a start: of a machine, of a simulation, or of the day.
    Uptime,
}

impl Clock {
    pub(crate) fn of(seconds: f64) -> Self {
        if seconds < UPTIME_BELOW_S {
            Self::Uptime
        } else {
            Self::Calendar
        }
    }
}

impl Stream<'_> {
    /// Where the stream begins.
    pub(crate) fn place(&self) -> Place {
        Place::of(self.source, self.stamps.first.as_ref())
    }

    /// `stamp - log`, seconds, of every sampled stamp that is not zero. Stamps in a declared scale are converted to UTC.
    pub(crate) fn offsets_s(&self) -> Vec<f64> {
        let ahead_s = self.declared.as_ref().map_or(0.0, |scale| scale.ahead_s);
        self.stamps
            .samples
            .iter()
            .filter(|(stamp, _)| *stamp != 0)
            .map(|(stamp, log)| (*stamp as f64 - *log as f64) / 1e9 - ahead_s)
            .collect()
    }

    /// A plot of `stamp - log` over the time of the recording, with the limits that it should stay between.
    pub(crate) fn plot(&self, limits_s: &[(&str, f64)]) -> Option<Plot> {
        let ahead_s = self.declared.as_ref().map_or(0.0, |scale| scale.ahead_s);
        let samples = self.stamps.samples.iter().filter(|(stamp, _)| *stamp != 0);
        let points = samples.map(|(stamp, log)| {
            let at_s = log.saturating_sub(self.start_ns) as f64 / 1e9;
            // Subtracted as integers: a present-day stamp in a double has steps of a quarter of a microsecond.
            [at_s, stamp.saturating_sub(*log) as f64 / 1e9 - ahead_s]
        });
        let points = Series::points("stamp minus log time", points);
        (points.points.len() > 1).then(|| Plot {
            title: format!("Stamps compared with the recorder's clock: {}", self.subject),
            x: Axis::new("log time after the start", "s"),
            y: Axis::new("stamp minus log time", "s"),
            equal: false,
            series: vec![points],
            limits: limits_s
                .iter()
                .map(|(label, at)| Level {
                    label: (*label).to_owned(),
                    at: *at,
                })
                .collect(),
        })
    }

    /// The clock that its stamps show; `None` without stamps.
    pub(crate) fn clock(&self) -> Option<Clock> {
        self.median_stamp_s().map(Clock::of)
    }

    /// How many seconds the stamps advance in a second of the recorder's clock, from the first stamp to the last.
    pub(crate) fn rate(&self) -> Option<f64> {
        let mut stamped = self.stamps.samples.iter().filter(|(stamp, _)| *stamp != 0);
        let (first, last) = (stamped.next()?, stamped.next_back()?);
        let [stamp, log] = [last.0.saturating_sub(first.0), last.1.saturating_sub(first.1)].map(|ns| ns as f64 / 1e9);
        (log >= 1.0).then(|| stamp / log)
    }

    /// Whether its stamps are times of measurement, by the type of its messages. Maps, paths and markers may carry the stamp
    /// of the data that they were computed from.
    pub(crate) fn is_live(&self) -> bool {
        const STATES: &[&str] = &["Odometry", "JointState", "TwistStamped", "TwistWithCovarianceStamped"];
        let message_type = self.message_type();
        let name = message_type.rsplit('/').next().unwrap_or_default();
        header_use(message_type) == HeaderUse::Sensor
            || STATES.contains(&name)
            || self.is_gnss()
            || name.to_ascii_lowercase().contains("imu")
            || self.topic().rsplit('/').next() == Some("imu")
    }

    /// Whether many messages share each stamp, though they are measurements or moving transforms.
    pub(crate) fn is_reused(&self, limits: &Limits) -> bool {
        self.stamps.count.saturating_sub(self.stamps.zero) >= limits.min_messages
            && 1.0 - self.repeated_share() < limits.unique_share
            && (self.is_live() || self.moves(limits))
    }

    /// Whether it is an edge whose pose changes.
    pub(crate) fn moves(&self, limits: &Limits) -> bool {
        let StreamSource::Edge(edge) = self.of else {
            return false;
        };
        edge.extreme.as_ref().is_some_and(|(_, angle_rad, distance_m)| {
            angle_rad.to_degrees() > limits.moves_deg || *distance_m > limits.moves_m
        })
    }

    /// Share of the stamps that equal the previous one, among those that have a previous one.
    pub(crate) fn repeated_share(&self) -> f64 {
        let steps = self.stamps.count.saturating_sub(self.stamps.zero).saturating_sub(1);
        self.stamps.repeated as f64 / (steps as f64).max(1.0)
    }

    /// The message type; empty for TF.
    pub(crate) fn message_type(&self) -> &str {
        match self.of {
            StreamSource::Topic(topic) => &topic.message_type,
            StreamSource::Edge(_) => "",
        }
    }

    /// The topic.
    fn topic(&self) -> &str {
        match self.of {
            StreamSource::Topic(topic) => &topic.topic,
            StreamSource::Edge(edge) => &edge.topic,
        }
    }

    /// Whether its messages hold the points of a sweep, and may have the stamp of the first.
    pub(crate) fn is_of_sweeps(&self) -> bool {
        const TYPES: &[&str] = &["PointCloud2", "PointCloud", "LaserScan", "MultiEchoLaserScan"];
        TYPES.contains(&self.message_type().rsplit('/').next().unwrap_or_default())
    }

    /// Whether it comes from a GNSS receiver, by the type of its messages: receivers measure, compute and only then send.
    pub(crate) fn is_gnss(&self) -> bool {
        const WORDS: &[&str] = &[
            "navsat",
            "gps",
            "gnss",
            "nmea",
            "rtk",
            "novatel",
            "ublox",
            "timereference",
        ];
        let message_type = self.message_type().to_ascii_lowercase();
        WORDS.iter().any(|word| message_type.contains(word))
    }

    /// Median of the stamps, seconds of the stamp's own clock.
    pub(crate) fn median_stamp_s(&self) -> Option<f64> {
        let stamps: Vec<f64> = self
            .stamps
            .samples
            .iter()
            .filter(|(stamp, _)| *stamp != 0)
            .map(|(stamp, _)| *stamp as f64 / 1e9)
            .collect();
        median(&stamps)
    }

    /// Median and spread (1.4826 MAD) of `stamp - log`, seconds.
    pub(crate) fn offset_s(&self) -> Option<(f64, f64)> {
        let offsets = self.offsets_s();
        // `mad` is scaled to a standard deviation already.
        Some((median(&offsets)?, mad(&offsets)?))
    }

    /// Share of stamps that are exactly zero.
    pub(crate) fn zero_share(&self) -> f64 {
        if self.stamps.count == 0 {
            return 0.0;
        }
        self.stamps.zero as f64 / self.stamps.count as f64
    }
}

/// Topics that are published once and latched: their stamp is the time of creation, not of sending.
fn is_latched(topic: &str, message_type: &str) -> bool {
    let last = topic.rsplit('/').next().unwrap_or(topic);
    let latched_name = matches!(
        last,
        "tf_static" | "map" | "map_metadata" | "costmap" | "robot_description"
    );
    latched_name || message_type.ends_with("/OccupancyGrid") || message_type.ends_with("/MapMetaData")
}

/// Messages of programs about themselves: stamped by many nodes, in the order of arrival, and used in no look-up.
fn is_talk(message_type: &str) -> bool {
    const PACKAGES: &[&str] = &[
        "diagnostic_msgs",
        "actionlib_msgs",
        "action_msgs",
        "bond",
        "lifecycle_msgs",
    ];
    message_type.ends_with("/Log") || PACKAGES.contains(&message_type.split('/').next().unwrap_or_default())
}

/// All streams of one recording, topics first, in order of name.
pub(crate) fn streams(bag: &BagEvidence) -> Vec<Stream<'_>> {
    let mut streams: Vec<Stream<'_>> = bag
        .topics
        .values()
        .filter(|topic| topic.stamps.count > 0 && !is_tf(&topic.topic, &topic.message_type))
        .filter(|topic| !is_latched(&topic.topic, &topic.message_type) && !is_talk(&topic.message_type))
        .map(|topic| Stream {
            source: bag.source,
            subject: format!("topic `{}`", topic.topic),
            stamps: &topic.stamps,
            start_ns: bag.start_ns.unwrap_or(0),
            single_frame: topic.header_frames.len() <= 1 && topic.writers.len() <= 1,
            declared: None,
            of: StreamSource::Topic(topic),
        })
        .collect();
    streams.extend(bag.tf.iter().filter(|edge| !edge.is_static).map(|edge| Stream {
        source: bag.source,
        subject: format!("TF `{}` from `{}` on `{}`", edge.parent, edge.child, edge.topic),
        stamps: &edge.stamps,
        start_ns: bag.start_ns.unwrap_or(0),
        single_frame: true,
        declared: None,
        of: StreamSource::Edge(edge),
    }));
    streams
}

/// All streams of one recording, with their stamps in the scale that the user declares: for rules that compare them with
/// UTC. tf2 look-ups take stamps as they are.
pub(crate) fn declared_streams<'w>(world: &World, bag: &'w BagEvidence) -> Vec<Stream<'w>> {
    let mut streams = streams(bag);
    for stream in &mut streams {
        stream.declared = scale(world, bag, stream);
    }
    streams
}

/// The scale that the user declares a stream's stamps in.
fn scale(world: &World, bag: &BagEvidence, stream: &Stream<'_>) -> Option<Scale> {
    let frames: Vec<&FrameId> = match stream.of {
        StreamSource::Topic(topic) => topic.header_frames.keys().collect(),
        StreamSource::Edge(edge) => vec![&edge.parent, &edge.child],
    };
    let declared = world.declared(bag.source, stream.topic(), &frames)?;
    let (at_s, table) = (log_start_s(bag), leap_seconds());
    let scale = declared.convention.time?;
    let ahead_s = match scale {
        TimeScale::Utc => 0.0,
        TimeScale::Gps => table.gps_minus_utc_s(at_s),
        TimeScale::Tai => table.tai_minus_utc_s(at_s),
    };
    Some(Scale {
        ahead_s,
        words: format!("{}, as `{}` declares", scale.word().to_uppercase(), declared.origin),
        place: declared.place,
    })
}

fn is_tf(topic: &str, message_type: &str) -> bool {
    let last = topic.rsplit('/').next().unwrap_or(topic);
    message_type.ends_with("/TFMessage") || matches!(last, "tf" | "tf_static")
}

/// Log time at the start, Unix seconds where the recorder's clock shows calendar time.
pub(crate) fn log_start_s(bag: &BagEvidence) -> f64 {
    bag.start_ns.unwrap_or(0) as f64 / 1e9
}

/// The recorder's clock.
pub(crate) fn log_clock(bag: &BagEvidence) -> Clock {
    Clock::of(log_start_s(bag))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_messages: u64,
    pub(crate) lead_s: f64,
    pub(crate) lag_s: f64,
    pub(crate) unique_share: f64,
    pub(crate) moves_deg: f64,
    pub(crate) moves_m: f64,
}
