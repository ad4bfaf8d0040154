//! Errors that need more than a row: poses at the places of the recording's fixes, and stamps.

use frames_lint::world::World;
use frames_lint::world::bag::TopicEvidence;
use frames_lint::world::claim::Pose;
use frames_lint::world::motion::{FixRow, PoseRow, Series};

use crate::errors::edges;
use crate::streams::{Stream, StreamPlace};

pub use crate::support::drive::earth::Place;

/// Changes a pose of evidence as a row would be.
pub fn as_row(pose: &mut Pose, change: impl Fn(&mut PoseRow)) {
    let mut row = PoseRow {
        stamp_ns: 0,
        log_ns: 0,
        position: pose.translation_m,
        orientation: pose.rotation_xyzw,
        twist: None,
    };
    change(&mut row);
    (pose.translation_m, pose.rotation_xyzw) = (row.position, row.orientation);
}

/// Puts poses where the fixes of the recording are, expressed in another kind of coordinates; false where there are no fixes.
pub fn put(world: &mut World, stream: &Stream, tell: fn(Place, &Place) -> [f64; 3]) -> bool {
    let said = world.bags[stream.bag].topics.values().flat_map(TopicEvidence::contents);
    let fixes: Vec<FixRow> = said
        .filter_map(|said| said.content.motion.fixes.as_ref())
        .max_by_key(|series| series.count)
        .map(|series| series.rows().copied().collect())
        .unwrap_or_default();
    let place = |fix: &FixRow| Place {
        latitude: fix.latitude_deg,
        longitude: fix.longitude_deg,
        altitude: fix.altitude_m,
    };
    let Some(origin) = fixes.first().map(place) else {
        return false;
    };
    let there = |log_ns: i64| {
        let after = fixes
            .partition_point(|fix| fix.log_ns < log_ns)
            .clamp(1, fixes.len() - 1);
        let [a, b] = [&fixes[after - 1], &fixes[after]];
        let share = (log_ns - a.log_ns) as f64 / (b.log_ns - a.log_ns).max(1) as f64;
        let between = |a: f64, b: f64| a + (b - a) * share.clamp(0.0, 1.0);
        let fix = FixRow {
            latitude_deg: between(a.latitude_deg, b.latitude_deg),
            longitude_deg: between(a.longitude_deg, b.longitude_deg),
            altitude_m: between(a.altitude_m, b.altitude_m),
            ..*a
        };
        tell(place(&fix), &origin)
    };
    let moved = |series: &mut Series<PoseRow>| {
        for row in series.stretches.iter_mut().flatten() {
            row.position = there(row.log_ns);
        }
    };
    if fixes.len() < 2 {
        return false;
    }
    stream.contents(world, |content| {
        content.motion.poses.iter_mut().for_each(moved);
        for at in content.odometry.iter_mut().flat_map(|odometry| &mut odometry.samples) {
            at.pose.translation_m = there(at.at.log_ns);
        }
    });
    for edge in edges(world, stream) {
        edge.motion.iter_mut().for_each(moved);
        for at in &mut edge.samples {
            at.pose.translation_m = there(at.at.log_ns);
        }
    }
    true
}

/// Stamps a topic's messages later by this; false where they have no stamps.
pub fn restamp(world: &mut World, stream: &Stream, seconds: f64) -> bool {
    let by_ns = (seconds * 1e9) as i64;
    let mut stamped = false;
    stream.contents(world, |content| {
        for row in content
            .motion
            .inertial
            .iter_mut()
            .flat_map(|series| series.stretches.iter_mut().flatten())
        {
            if row.stamp_ns != 0 {
                row.stamp_ns += by_ns;
                stamped = true;
            }
        }
    });
    for at in &stream.at {
        let StreamPlace::Topic(topic, _) = at else { continue };
        let stamps = &mut world.bags[stream.bag].topics.get_mut(topic).unwrap().stamps;
        stamps.samples.iter_mut().for_each(|(stamp_ns, _)| *stamp_ns += by_ns);
        let known = [&mut stamps.first, &mut stamps.last];
        for stamp_ns in known.into_iter().flatten().filter_map(|at| at.stamp_ns.as_mut()) {
            *stamp_ns += by_ns;
        }
    }
    stamped
}
