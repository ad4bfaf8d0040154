//! Poses on a topic and a moving transform of TF: pairs of motions over the same intervals, in the axes of what moves.
//!
//! Motions do not depend on where the two worlds have their origins, nor on slow drift. Must not judge.

use std::sync::Arc;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use serde::Deserialize;

use crate::analysis::hand_eye::pose_at;
use crate::analysis::motion::{Orientations, Stream, Track};
use crate::math::stats::median;
use crate::world::motion::PoseRow;

/// Metres that count like a rotation by one radian: about the size of a robot.
const M_PER_RAD: f64 = 1.0;

/// How the motions of a topic follow from those of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// They are those of a frame on the body.
    Direct,
    /// Those of the inverse poses are.
    Inverse,
    /// They are the mirror image: y, roll and yaw are negated.
    Mirrored,
}

/// One interval by both: the later pose in the axes of the earlier.
struct Pair {
    /// Of the topic, as published.
    topic: Isometry3<f64>,
    /// Of the inverse poses of the topic.
    inverse: Isometry3<f64>,
    /// Of the body, by TF.
    body: Isometry3<f64>,
    /// The two poses at its end: topic, TF.
    ends: [UnitQuaternion<f64>; 2],
    /// The velocity that the topic states, m/s in the axes of what moves.
    velocity: Option<Vector3<f64>>,
}

/// The motions of a topic and of a body by TF.
pub(crate) struct CommonMotion {
    pairs: Vec<Pair>,
}

impl CommonMotion {
    /// Of poses and a moving transform; intervals end at poses of the topic, once the body has moved far enough.
    pub(crate) fn of(poses: &Stream<PoseRow>, tf: &Stream<PoseRow>, limits: &Limits) -> Self {
        let known = PosesOverTime::of(tf);
        let mut body_at = known.follow();
        let mut pairs = Vec::new();
        for stretch in &poses.stretches {
            let mut from: Option<(f64, Isometry3<f64>, Isometry3<f64>)> = None;
            for timed in stretch {
                let Some(pose) = timed.isometry() else { continue };
                let Some(body) = body_at(timed.t_s) else { continue };
                let Some((from_s, from_pose, from_body)) = from else {
                    from = Some((timed.t_s, pose, body));
                    continue;
                };
                let moved = from_body.inv_mul(&body);
                let is_far = size_m(&moved) >= limits.step_m;
                if is_far {
                    pairs.push(Pair {
                        topic: from_pose.inv_mul(&pose),
                        inverse: from_pose * pose.inverse(),
                        body: moved,
                        ends: [pose.rotation, body.rotation],
                        velocity: timed.row.twist.map(|twist| Vector3::from(twist.linear)),
                    });
                }
                if is_far || timed.t_s - from_s > limits.longest_s {
                    from = Some((timed.t_s, pose, body));
                }
            }
        }
        Self { pairs }
    }

    /// How many motions were compared.
    pub(crate) fn count(&self) -> usize {
        self.pairs.len()
    }

    /// The unexplained share of the motions, if those of the topic are of a frame at `body_from_frame` in this way: the median.
    pub(crate) fn residual(&self, way: Way, body_from_frame: &Isometry3<f64>) -> f64 {
        let shares = self.pairs.iter().map(|pair| {
            let frame = body_from_frame.inv_mul(&(pair.body * body_from_frame));
            let (read, expected) = match way {
                Way::Direct => (&pair.topic, frame),
                Way::Inverse => (&pair.inverse, frame),
                Way::Mirrored => (&pair.topic, mirrored(&frame)),
            };
            size_m(&read.inv_mul(&expected)) / size_m(&frame)
        });
        median(&shares.collect::<Vec<_>>()).unwrap_or(f64::INFINITY)
    }

    /// Cosine between the velocity that the topic states and the motion of its poses, of their inverse; `None` without velocities.
    pub(crate) fn along_velocity(&self) -> Option<[f64; 2]> {
        let cosines = |of: fn(&Pair) -> Vector3<f64>| {
            let each = self.pairs.iter().filter_map(|pair| {
                let (velocity, moved) = (pair.velocity?, of(pair));
                let cosine = velocity.dot(&moved) / (velocity.norm() * moved.norm());
                cosine.is_finite().then_some(cosine)
            });
            median(&each.collect::<Vec<_>>())
        };
        Some([
            cosines(|pair| pair.topic.translation.vector)?,
            cosines(|pair| pair.inverse.translation.vector)?,
        ])
    }

    /// z of TF's world in the axes of the topic's, if the poses are those of a frame with this rotation on the body: the mean.
    pub(crate) fn up(&self, body_from_frame: &UnitQuaternion<f64>) -> Vector3<f64> {
        let ups = self.pairs.iter().map(|pair| {
            let [topic, body] = pair.ends;
            topic * (body * body_from_frame).inverse() * Vector3::z()
        });
        ups.sum::<Vector3<f64>>() / self.pairs.len().max(1) as f64
    }
}

/// How far poses are from those that TF composes in their world frame, by a correction and the transform that moves the body, metres: the
/// medians with the correction as published, and with its inverse. `None` where the three have no time in common.
pub(crate) fn apart_m(
    poses: &Stream<PoseRow>,
    [correction, tf]: [&Stream<PoseRow>; 2],
    body_from_frame: &Isometry3<f64>,
) -> Option<[f64; 2]> {
    let known = [correction, tf].map(PosesOverTime::of);
    let [mut world_at, mut body_at] = known.each_ref().map(PosesOverTime::follow);
    let each = poses.rows().filter_map(|timed| {
        let (correction, body) = (world_at(timed.t_s)?, body_at(timed.t_s)? * body_from_frame);
        let off =
            |world: Isometry3<f64>| ((world * body).translation.vector - Vector3::from(timed.row.position)).norm();
        Some([off(correction), off(correction.inverse())])
    });
    let each: Vec<[f64; 2]> = each.collect();
    let of = |reading: usize| {
        median(
            &each
                .iter()
                .filter_map(|off| off.get(reading).copied())
                .collect::<Vec<_>>(),
        )
    };
    Some([of(0)?, of(1)?])
}

/// The poses of a stream at any time.
struct PosesOverTime {
    turned: Orientations,
    track: Arc<Track>,
}

impl PosesOverTime {
    fn of(stream: &Stream<PoseRow>) -> Self {
        Self {
            turned: Orientations::of(stream),
            track: stream.track(),
        }
    }

    /// At times that mostly increase.
    fn follow(&self) -> impl FnMut(f64) -> Option<Isometry3<f64>> + '_ {
        let mut places = self.track.follow();
        move |t_s| pose_at(&self.turned, &places(t_s)?, t_s)
    }
}

/// Translation and rotation as one length, metres.
fn size_m(motion: &Isometry3<f64>) -> f64 {
    motion.translation.vector.norm() + M_PER_RAD * motion.rotation.angle()
}

/// A motion with y to the other side.
fn mirrored(motion: &Isometry3<f64>) -> Isometry3<f64> {
    let (place, turned) = (motion.translation.vector, motion.rotation.coords);
    Isometry3::from_parts(
        Translation3::new(place.x, -place.y, place.z),
        UnitQuaternion::new_unchecked(Quaternion::new(turned.w, -turned.x, turned.y, -turned.z)),
    )
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Motion of an interval, metres plus radians.
    step_m: f64,
    /// Longest interval, seconds.
    longest_s: f64,
    /// Intervals needed.
    pub min_motions: usize,
    /// Unexplained share up to which motions are equal.
    pub equal: f64,
    /// Unexplained share from which on they differ.
    pub different: f64,
    /// So many times better another reading is.
    pub times_better: f64,
    /// How far poses may be from TF in one world frame, metres: localizers differ.
    pub apart_m: f64,
    /// Angle between the two z axes of the worlds, degrees.
    pub tilted_deg: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirrored_motion_is_that_of_mirrored_points() {
        let motion = Isometry3::new(Vector3::new(0.3, 0.7, -0.2), Vector3::new(0.2, -0.4, 0.9));
        let mirror = |point: nalgebra::Point3<f64>| nalgebra::Point3::new(point.x, -point.y, point.z);
        let point = nalgebra::Point3::new(1.0, 2.0, 3.0);
        let apart = mirrored(&motion) * mirror(point) - mirror(motion * point);
        assert!(apart.norm() < 1e-12);
    }
}
