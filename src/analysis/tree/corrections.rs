//! Corrections of `map` -> `odom`: how they move the vehicle, and which data they affect.
//!
//! Must not judge.

use nalgebra::Point3;

use crate::analysis::{names, tf, tf::HeaderUse};
use crate::world::{BagEvidence, FrameId, bag::TfEdge, content::StepAt};

/// A correction with what it does.
pub(crate) struct Jump<'a> {
    /// The step.
    pub(crate) at: &'a StepAt,
    /// Shift of the vehicle, metres; of the origin of `odom` where the vehicle's pose is unknown.
    pub(crate) m: f64,
    /// Rotation, degrees.
    pub(crate) deg: f64,
}

impl<'a> Jump<'a> {
    /// What a step of the correction does.
    pub(crate) fn new(bag: &BagEvidence, edge: &TfEdge, at: &'a StepAt) -> Self {
        let (before, after) = (at.before.pose.isometry(), at.after.pose.isometry());
        let vehicle = vehicle(bag, edge, at).unwrap_or_else(Point3::origin);
        Self {
            at,
            m: (after * vehicle - before * vehicle).norm(),
            deg: at.step.angle_rad.to_degrees(),
        }
    }

    /// When it is, seconds after the recording's start.
    pub(crate) fn since_s(&self, bag: &BagEvidence) -> f64 {
        bag.start_ns
            .map_or(0, |start| self.at.after.at.log_ns.saturating_sub(start)) as f64
            / 1e9
    }

    /// In words: "1.20 m and 3.0 deg at 12.3 s".
    pub(crate) fn words(&self, bag: &BagEvidence) -> String {
        format!("{:.2} m and {:.1} deg at {:.1} s", self.m, self.deg, self.since_s(bag))
    }
}

/// The vehicle's position in `odom` at the correction: the sample nearest in log time.
fn vehicle(bag: &BagEvidence, edge: &TfEdge, at: &StepAt) -> Option<Point3<f64>> {
    let odom = edge.child.canonical();
    let carried = bag
        .tf
        .iter()
        .filter(|other| !other.is_static && other.parent.canonical() == odom);
    let of_base = carried
        .filter(|other| names::is_base(&other.child))
        .flat_map(|other| &other.samples);
    let nearest = of_base.min_by_key(|sample| sample.at.log_ns.abs_diff(at.after.at.log_ns))?;
    Some(Point3::from(nearest.pose.isometry().translation.vector))
}

/// Whether someone set the pose by hand just before.
pub(crate) fn was_asked(bag: &BagEvidence, jump: &Jump, within_s: f64) -> bool {
    let at = jump.at.after.at.log_ns;
    let within = |log_ns: i64| (0.0..=within_s).contains(&(at.saturating_sub(log_ns) as f64 / 1e9));
    let asking = bag.topics.values().filter(|topic| topic.topic.ends_with("initialpose"));
    asking
        .flat_map(|topic| [topic.first_log_ns, topic.last_log_ns])
        .flatten()
        .any(within)
}

/// Topics with data that were collected or planned in the frame: they do not move with a correction.
pub(crate) fn keepers(bag: &BagEvidence, map: &FrameId) -> Vec<String> {
    const KEPT: &[&str] = &[
        "Path",
        "PointCloud2",
        "OccupancyGrid",
        "GridCells",
        "PolygonStamped",
        "Trajectory",
    ];
    let keeps = |kind: &str| KEPT.contains(&kind);
    let topics = bag.topics.values().filter(|topic| {
        let kind = topic.message_type.rsplit('/').next().unwrap_or_default();
        keeps(kind) && tf::header_use(&topic.message_type) != HeaderUse::Ignored
    });
    let in_map = topics.filter(|topic| {
        topic
            .header_frames
            .keys()
            .any(|frame| frame.canonical() == map.canonical())
    });
    in_map.map(|topic| format!("`{}`", topic.topic)).take(4).collect()
}
