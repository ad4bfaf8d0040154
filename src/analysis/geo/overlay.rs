//! Poses and fixes of one platform at the same times.
//!
//! Owns the way from the body of a pose to the antenna, where it is known. Must not judge.

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector2, Vector3};

use crate::analysis::motion::{Stream, Track};
use crate::analysis::names;
use crate::math::similarity2::{Similarity2, fit_similarities, spread};
use crate::math::{geodesy::Geodetic, stats::median};
use crate::world::World;
use crate::world::motion::{FixRow, PoseRow};

/// So many pairs determine where a track is; of more every n-th is taken. Errors of receivers last for minutes.
const MAX_MOMENTS: usize = 4096;
/// Messages of a receiver come up to this late, seconds; stamps further apart are of two clocks.
const MAX_LATENCY_S: f64 = 1.0;

/// A pose and a fix at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoseFix {
    /// Seconds after the recording's start.
    pub(crate) t_s: f64,
    /// The antenna in the frame of the poses, metres.
    pub(crate) place_m: Vector3<f64>,
    /// The position by the receiver.
    pub(crate) fix: Geodetic,
    /// The same in the tangent plane of the first fix, metres.
    pub(crate) enu_m: Vector3<f64>,
    /// The altitude over that of the first fix, metres; `None` where the receiver gives none.
    pub(crate) climb_m: Option<f64>,
    /// The horizontal standard deviation that the receiver states, metres; `None` where it states none.
    pub(crate) deviation_m: Option<f64>,
}

/// All pairs of a stream of poses and a receiver.
#[derive(Clone, Debug)]
pub(crate) struct Overlay {
    /// The first fix: where the tangent plane of `enu_m` touches.
    pub(crate) first: Geodetic,
    /// The pairs, in the order of the fixes.
    pub(crate) both: Vec<PoseFix>,
}

impl Overlay {
    /// Pairs poses with fixes; `None` where there are fewer than two pairs.
    pub(crate) fn of(world: &World, poses: &Stream<PoseRow>, fixes: &Stream<FixRow>) -> Option<Self> {
        let arm = body_from_antenna(world, poses, fixes).map(|mounting| mounting.translation.vector);
        let arm = arm.filter(|arm| *arm != Vector3::zeros());
        let track = arm.map_or_else(|| poses.track(), |arm| moved(poses, arm).track());
        let by_arrival = Self::at(&track, fixes, 0.0);
        // Streams are paired by their arrival. A receiver's messages come late, by what their stamps say if these are of the poses'
        // clock: the better fit decides.
        let late_s = fixes.stamp_offset_s.zip(poses.stamp_offset_s).map(|(a, b)| a - b);
        let late_s = late_s.filter(|late_s| *late_s != 0.0 && late_s.abs() <= MAX_LATENCY_S);
        let by_stamp = late_s.and_then(|late_s| Self::at(&track, fixes, late_s));
        [by_arrival, by_stamp]
            .into_iter()
            .flatten()
            .min_by(|a, b| a.rms_m().total_cmp(&b.rms_m()))
    }

    /// The pairs, where the poses are read so many seconds after the fixes.
    fn at(track: &Track, fixes: &Stream<FixRow>, after_s: f64) -> Option<Self> {
        let mut at = track.follow();
        let origin = fixes.rows().find_map(|timed| geodetic(&timed.row))?;
        let every = fixes.rows().count().div_ceil(MAX_MOMENTS).max(1);
        let mut beside = |t_s: f64, row: &FixRow| {
            let fix = geodetic(row)?;
            Some(PoseFix {
                t_s,
                place_m: at(t_s + after_s)?,
                fix,
                enu_m: origin.enu_of(&fix),
                climb_m: row.altitude_m.is_finite().then_some(fix.height_m - origin.height_m),
                deviation_m: row.horizontal_sd_m(),
            })
        };
        let both: Vec<PoseFix> = fixes
            .rows()
            .step_by(every)
            .filter_map(|timed| beside(timed.t_s, &timed.row))
            .collect();
        (both.len() > 1).then_some(Self { first: origin, both })
    }

    /// The residual of the poses from the fixes after rotation, scale and shift, metres.
    fn rms_m(&self) -> f64 {
        let (enu, xy) = self.planes();
        fit_similarities(&xy, &enu).map_or(f64::INFINITY, |fit| fit.proper.rms_m)
    }

    /// By how much the receiver's errors may rotate the track (radians) or scale it, one deviation. Such errors last for minutes,
    /// and one that drifts along looks like a rotation: no scatter within a drive shows it. Errors that are `errors_last_s` apart
    /// are independent; `untold_m` is the deviation of a receiver that states none.
    pub(crate) fn receiver_deviation(&self, errors_last_s: f64, untold_m: f64) -> f64 {
        let stated: Vec<f64> = self.both.iter().filter_map(|both| both.deviation_m).collect();
        let error_m = median(&stated).unwrap_or(untold_m);
        let (enu, _) = self.planes();
        let spread_m = spread(&enu).map_or(0.0, |spread| spread.major_sd_m.hypot(spread.minor_sd_m));
        let (from_s, to_s) = self.span_s();
        error_m / spread_m / ((to_s - from_s) / errors_last_s).max(1.0).sqrt()
    }

    /// East and north of the fixes, and x and y of the poses, metres.
    pub(crate) fn planes(&self) -> (Vec<Vector2<f64>>, Vec<Vector2<f64>>) {
        let both = self.both.iter();
        both.map(|both| (both.enu_m.xy(), both.place_m.xy())).unzip()
    }

    /// The longer side of the box around the fixes, metres.
    pub(crate) fn extent_m(&self) -> f64 {
        let side = |of: fn(&Vector3<f64>) -> f64| {
            let values = self.both.iter().map(|both| of(&both.enu_m));
            let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            most - least
        };
        side(|p| p.x).max(side(|p| p.y))
    }

    /// The rotation, scale and shift that take x and y of the poses to east and north; `None` where the poses do not follow the
    /// fixes: another scale by more than `scale`, or residuals of more than `share` of the extent.
    pub(crate) fn fit(&self, scale: f64, share: f64) -> Option<Similarity2> {
        let (enu, xy) = self.planes();
        let fit = fit_similarities(&xy, &enu)?.proper;
        ((fit.scale - 1.0).abs() <= scale && fit.rms_m <= share * self.extent_m()).then_some(fit)
    }

    /// The origin of the poses' frame by a fit, at the height of the first fix.
    pub(crate) fn origin(&self, fit: &Similarity2) -> Option<Geodetic> {
        self.first.at_enu(&fit.translation_m.push(0.0))
    }

    /// First and last time, seconds after the recording's start.
    pub(crate) fn span_s(&self) -> (f64, f64) {
        let ends = self.both.first().zip(self.both.last());
        ends.map_or((f64::NAN, f64::NAN), |(first, last)| (first.t_s, last.t_s))
    }
}

/// Whether poses state where the platform is in a world frame, not where one such frame is in another.
pub(crate) fn is_way(poses: &Stream<PoseRow>) -> bool {
    poses.frame.as_ref().is_some_and(names::is_world)
        && !poses.is_earth_centred()
        && !poses.child.as_ref().is_some_and(names::is_world)
}

/// The place of a fix; at height 0 where the receiver gives none.
pub(crate) fn geodetic(fix: &FixRow) -> Option<Geodetic> {
    let height_m = if fix.altitude_m.is_finite() {
        fix.altitude_m
    } else {
        0.0
    };
    Geodetic::from_degrees(fix.latitude_deg, fix.longitude_deg, height_m)
}

/// The mounting of the antenna on the body that the poses are of: `body_from_antenna`, as URDF and static TF state it.
pub(crate) fn body_from_antenna(
    world: &World,
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
) -> Option<Isometry3<f64>> {
    let (body, antenna) = (poses.child.as_ref()?, fixes.frame.as_ref()?);
    if body == antenna {
        return Some(Isometry3::identity());
    }
    let (body_from_antenna, _) = world.graph().chain(body, antenna, |edge| edge.is_rigid)?;
    Some(body_from_antenna)
}

fn moved(poses: &Stream<PoseRow>, arm: Vector3<f64>) -> Stream<PoseRow> {
    let mut poses = poses.clone();
    for timed in poses.stretches.iter_mut().flatten() {
        let [x, y, z, w] = timed.row.orientation;
        let turned = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6).map(|q| q * arm);
        timed.row.position = (Vector3::from(timed.row.position) + turned.unwrap_or_default()).into();
    }
    poses
}
