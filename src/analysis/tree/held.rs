//! A correction `map` -> `odom` that stands still from some time on, while poses in `map` move on without it.
//!
//! Must not judge.

use nalgebra::Point3;

use crate::analysis::motion::{BagMotion, Stream};
use crate::analysis::names;
use crate::math::{rotation::is_near, stats::median};
use crate::world::{FrameId, motion::PoseRow};

/// The correction at the end of a recording.
pub(crate) struct Held {
    /// From when on it is the same, seconds after the recording's start.
    pub(crate) since_s: f64,
    /// How long, seconds.
    pub(crate) lasts_s: f64,
    /// The poses in `map`.
    pub(crate) against: String,
    /// How far TF is from them in the first and in the last quarter of that time, metres: medians.
    pub(crate) apart_m: [f64; 2],
}

impl Held {
    /// The longest at the end of the recording, beside poses in `map`; `None` if the correction moves to the end, or never moved.
    pub(crate) fn of(motion: &BagMotion, odom: &FrameId, map: &FrameId, same: [f64; 2]) -> Option<Self> {
        let (correction, odometry) = (motion.transform(map, Some(odom))?, motion.transform(odom, None)?);
        let rows = || {
            correction
                .rows()
                .filter_map(|timed| Some((timed.t_s, timed.isometry()?)))
        };
        let (until_s, last) = rows().last()?;
        let mut since_s = None;
        for (t_s, pose) in rows() {
            match (is_near(&pose, &last, same), since_s) {
                (true, None) => since_s = Some(t_s),
                (true, Some(_)) => {}
                (false, _) => since_s = None,
            }
        }
        let first_s = correction.rows().next()?.t_s;
        let since_s = since_s.filter(|since_s| *since_s > first_s)?;
        let track = odometry.track();
        let in_map = motion.poses.iter().filter(|poses| {
            let is_of_body = poses.child.is_none() || poses.child == odometry.child;
            !poses.is_transform && is_of_body && poses.frame.as_ref() == Some(map) && !names::is_wish(&poses.topic)
        });
        let apart = |poses: &Stream<PoseRow>| {
            let apart_m: Vec<f64> = poses
                .rows()
                .filter(|timed| (since_s..=until_s).contains(&timed.t_s))
                .filter_map(|timed| {
                    let by_tf = last * Point3::from(track.at(timed.t_s)?);
                    Some((Point3::from(timed.row.position) - by_tf).norm())
                })
                .collect();
            let quarter = apart_m.len().div_ceil(4);
            Some(Self {
                since_s,
                lasts_s: until_s - since_s,
                against: poses.subject.clone(),
                apart_m: [
                    median(apart_m.get(..quarter)?)?,
                    median(apart_m.get(apart_m.len() - quarter..)?)?,
                ],
            })
        };
        in_map
            .filter_map(apart)
            .max_by(|a, b| a.apart_m[1].total_cmp(&b.apart_m[1]))
    }
}
