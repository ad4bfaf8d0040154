//! Planes that touch the Earth, as files and TF state them, and how far they are used.
//!
//! Must not judge.

use crate::analysis::geo::overlay::{Overlay, geodetic};
use crate::analysis::{geo::curvature::Curvature, geo::earth::EarthPose, motion::BagMotion};
use crate::math::geodesy::Geodetic;
use crate::source::Place;
use crate::world::{FrameId, World};

/// A plane that touches the Earth at the origin of a local frame, and how far its use reaches.
pub(crate) struct Plane<'s> {
    /// The local frame.
    pub(crate) local: &'s FrameId,
    /// What reports call the statement.
    pub(crate) subject: &'s str,
    /// Where it is stated.
    pub(crate) place: &'s Place,
    /// Where the plane touches.
    pub(crate) origin: Geodetic,
    /// Largest distance, metres, and who is there.
    pub(crate) reach: Option<(f64, String)>,
    /// Whether poses are expressed in the frame.
    pub(crate) has_poses: bool,
    /// The curvature in the heights of poses, of which poses, and where.
    pub(crate) curvature: Option<(Curvature, String, Place)>,
}

impl<'s> Plane<'s> {
    /// The plane of a statement; `None` where it has no origin near the ellipsoid.
    pub(crate) fn stated(stated: &'s EarthPose, max_height_m: f64) -> Option<Self> {
        let (place, pose) = stated.poses.first().filter(|_| stated.has.1 && stated.is_local())?;
        let origin = Geodetic::from_ecef(&pose.translation.vector)?;
        (origin.height_m.abs() <= max_height_m).then_some(Self {
            local: &stated.local,
            subject: &stated.subject,
            place,
            origin,
            reach: None,
            has_poses: false,
            curvature: None,
        })
    }

    /// Looks how far poses in the frame go, or, without any, the fixes.
    pub(crate) fn reach(&mut self, world: &World, bag: &BagMotion) {
        let farthest =
            |distances: &mut dyn Iterator<Item = f64>| distances.filter(|d| d.is_finite()).fold(0.0, f64::max);
        let in_frame = || {
            bag.poses
                .iter()
                .filter(|poses| poses.frame.as_ref() == Some(self.local))
        };
        let by_poses = in_frame().map(|poses| {
            let mut far = poses
                .rows()
                .map(|timed| timed.row.position[0].hypot(timed.row.position[1]));
            (farthest(&mut far), poses.subject.clone())
        });
        let by_fixes = bag.fixes.iter().map(|fixes| {
            let places = fixes.rows().filter_map(|timed| geodetic(&timed.row));
            let mut far = places.map(|place| self.origin.enu_of(&place).xy().norm());
            (farthest(&mut far), fixes.subject.clone())
        });
        let most = |a: &(f64, String), b: &(f64, String)| a.0.total_cmp(&b.0);
        self.reach = by_poses.max_by(most).or_else(|| by_fixes.max_by(most));
        self.has_poses = in_frame().next().is_some();
        let pairs = in_frame().flat_map(|poses| bag.fixes.iter().map(move |fixes| (poses, fixes)));
        let mut curvatures = pairs.filter_map(|(poses, fixes)| {
            let overlay = Overlay::of(world, poses, fixes)?;
            let curvature = Curvature::of(&overlay, &self.origin)?;
            Some((curvature, poses.subject.clone(), poses.place()))
        });
        self.curvature = curvatures.next();
    }
}
