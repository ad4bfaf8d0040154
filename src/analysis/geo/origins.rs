//! Everything that states where the origin of a local frame is on the Earth.
//!
//! Must not judge.

use std::collections::BTreeSet;

use nalgebra::Vector2;
use serde::Deserialize;

use crate::analysis::geo::overlay::{Overlay, is_way};
use crate::analysis::motion::{BagMotion, Motion, Stream, TimedRow};
use crate::analysis::{Estimates, geo::earth::EarthPose, names, names::Standard};
use crate::math::{geodesy::Geodetic, similarity2::deviations};
use crate::source::{Confidence, Place, SourceId};
use crate::world::{
    BagEvidence, EarthOrigin, FrameId, LocalOrigin, OriginSource, World, bag::TopicEvidence, content::FixAt,
    motion::PoseRow,
};

/// Metres of a degree of latitude, for the digits of a file.
const DEGREE_M: f64 = 111_320.0;
/// From so many decimals on, degrees are taken to be rounded.
const ROUNDED_DECIMALS: u32 = 5;

/// Every origin of a world, by how far it is trusted, and why others were left out.
pub(crate) fn origins(world: &Estimates, limits: &Limits) -> (Vec<LocalOrigin>, Vec<String>) {
    let mut left_out = Vec::new();
    let mut all = of_transforms(world, limits, &mut left_out);
    all.extend(world.origins.iter().filter_map(of_file));
    all.extend(of_bags(world, limits));
    all.extend(world.bag_origins.iter().cloned());
    all.sort_by(|a, b| (&a.by, a.bag, &a.place).cmp(&(&b.by, b.bag, &b.place)));
    (all, left_out)
}

/// Every origin that comes from topics and tracks of recordings. Those of transforms are not among them: which local frame is meant depends on
/// all transforms of the world.
pub(crate) fn of_bags(world: &Estimates, limits: &Limits) -> Vec<LocalOrigin> {
    let mut all = Vec::new();
    let motion = Motion::of(world);
    for (bag, streams) in world.bags.iter().zip(&motion.bags) {
        all.extend(bag.topics.values().filter_map(|topic| of_topic(bag, topic)));
        all.extend(streams.poses.iter().filter_map(|poses| of_local_xy(bag.source, poses)));
        // One for each drive: a wrong origin is wrong for all of its tracks.
        let tracks = of_tracks(world, bag.source, streams, limits);
        all.extend(tracks.min_by(|a, b| a.within_m.total_cmp(&b.within_m)));
    }
    all
}

/// The transforms of `map`, or of the only local frame there is.
fn of_transforms(world: &World, limits: &Limits, left_out: &mut Vec<String>) -> Vec<LocalOrigin> {
    let is_map = |frame: &FrameId| matches!(names::standard(frame), Some((_, Standard::Map)));
    let mut stated = EarthPose::all(world);
    stated.retain(|stated| stated.is_local() && stated.has.1 && !names::has_word(&stated.local, &["odom"]));
    if stated.iter().any(|stated| is_map(&stated.local)) {
        stated.retain(|stated| is_map(&stated.local));
    }
    let frames: BTreeSet<&FrameId> = stated.iter().map(|stated| &stated.local).collect();
    if frames.len() > 1 {
        let names: Vec<String> = frames.iter().map(|frame| format!("`{frame}`")).collect();
        left_out.push(format!(
            "{} each have an origin on the Earth: call the one to compare `map`",
            names.join(" and ")
        ));
        return Vec::new();
    }
    let made = |stated: &EarthPose| {
        let (place, pose) = stated.poses.first()?;
        let at = Geodetic::from_ecef(&pose.translation.vector)?;
        let later = stated.poses.iter().skip(1);
        let later = later.filter_map(|(_, pose)| Geodetic::from_ecef(&pose.translation.vector));
        (at.height_m.abs() <= limits.max_height_m).then(|| LocalOrigin {
            later: farthest(&at, later),
            turned_rad: None,
            who: stated.subject.clone(),
            by: OriginSource::Transform,
            bag: Some(place.source).filter(|id| world.bags.iter().any(|bag| bag.source == *id)),
            at,
            has_height: true,
            within_m: 0.0,
            place: place.clone(),
            reading: stated.reading,
        })
    };
    stated.iter().filter_map(made).collect()
}

fn of_file(stated: &EarthOrigin) -> Option<LocalOrigin> {
    let [latitude, longitude] = stated.latitude_longitude_deg?;
    // An altitude of exactly 0 was not filled in.
    let altitude_m = stated.altitude_m.filter(|altitude| *altitude != 0.0);
    let rounding = if stated.decimals >= ROUNDED_DECIMALS {
        DEGREE_M * 10f64.powi(-i32::try_from(stated.decimals).unwrap_or(i32::MAX))
    } else {
        0.0
    };
    Some(LocalOrigin {
        who: format!("`{}`", stated.label),
        by: OriginSource::File(stated.format.clone()),
        bag: None,
        at: Geodetic::from_degrees(latitude, longitude, altitude_m.unwrap_or(0.0))?,
        has_height: altitude_m.is_some(),
        within_m: rounding,
        later: None,
        turned_rad: None,
        place: stated.place.clone(),
        reading: Confidence::Certain,
    })
}

/// The place that is farthest from another.
fn farthest(from: &Geodetic, places: impl Iterator<Item = Geodetic>) -> Option<Geodetic> {
    let distance = |place: &Geodetic| from.enu_of(place).norm();
    places.max_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Whether a topic states an origin, by the last part of its name.
pub(crate) fn states_origin(topic: &str) -> bool {
    let last = FrameId::new(topic.rsplit('/').next().unwrap_or(topic));
    last.has_token("origin") || last.has_token("datum")
}

/// A point or a fix on a topic of an origin.
fn of_topic(bag: &BagEvidence, topic: &TopicEvidence) -> Option<LocalOrigin> {
    let fixes = topic.content.fixes.as_ref().filter(|_| states_origin(&topic.topic))?;
    let mut valid = fixes.samples.iter().filter(|fix| fix.status >= 0);
    let first = valid.next()?;
    let has_height = first.altitude_m.is_finite() && first.altitude_m != 0.0;
    let height_m = |fix: &FixAt| if has_height { fix.altitude_m } else { 0.0 };
    let of = |fix: &FixAt| Geodetic::from_degrees(fix.latitude_deg, fix.longitude_deg, height_m(fix));
    let at = of(first)?;
    Some(LocalOrigin {
        who: format!("topic `{}`", topic.topic),
        by: OriginSource::Topic,
        bag: Some(bag.source),
        at,
        has_height,
        within_m: 0.0,
        later: farthest(&at, valid.filter_map(of)),
        turned_rad: None,
        place: Place::message(bag.source, first.at.clone()),
        reading: Confidence::Certain,
    })
}

/// A pose on `local_xy_origin`: x is the longitude, y the latitude (swri_transform_util).
fn of_local_xy(bag: SourceId, poses: &Stream<PoseRow>) -> Option<LocalOrigin> {
    let is_one = poses.topic.rsplit('/').next() == Some("local_xy_origin");
    let of = |timed: &TimedRow<PoseRow>| {
        let [longitude, latitude, altitude] = timed.row.position;
        Geodetic::from_degrees(latitude, longitude, altitude)
    };
    let at = of(poses.rows().next().filter(|_| is_one)?)?;
    Some(LocalOrigin {
        who: poses.subject.clone(),
        by: OriginSource::Topic,
        bag: Some(bag),
        at,
        has_height: at.height_m != 0.0,
        within_m: 0.0,
        later: farthest(&at, poses.rows().skip(1).filter_map(of)),
        turned_rad: None,
        place: poses.place(),
        reading: Confidence::Certain,
    })
}

/// Where the poses of a map, laid over fixes, put its origin.
fn of_tracks<'m>(
    world: &'m World,
    bag: SourceId,
    streams: &'m BagMotion,
    limits: &'m Limits,
) -> impl Iterator<Item = LocalOrigin> + 'm {
    let in_map = |poses: &&Stream<PoseRow>| {
        let kind = poses.frame.as_ref().and_then(names::standard);
        matches!(kind, Some((_, Standard::Map)))
    };
    let tracks = streams.poses.iter().filter(in_map).filter(|poses| is_way(poses));
    let receivers = || streams.fixes.iter().filter(|fixes| !states_origin(&fixes.topic));
    tracks
        .flat_map(move |poses| receivers().map(move |fixes| (poses, fixes)))
        .filter_map(move |(poses, fixes)| {
            let overlay = Overlay::of(world, poses, fixes)?;
            let (at, within_m, turned_rad) = origin_of_track(&overlay, limits)?;
            Some(LocalOrigin {
                who: format!("{} laid over {}", poses.subject, fixes.subject),
                by: OriginSource::Track,
                bag: Some(bag),
                at,
                has_height: false,
                within_m,
                later: None,
                turned_rad: Some(turned_rad),
                place: poses.place(),
                reading: Confidence::Likely,
            })
        })
}

/// The origin, its uncertainty in metres, and the rotation of the axes with its deviation in radians; `None` for a track that does
/// not follow the fixes or is not local.
fn origin_of_track(overlay: &Overlay, limits: &Limits) -> Option<(Geodetic, f64, (f64, f64))> {
    let (enu, xy) = overlay.planes();
    let fit = overlay.fit(limits.max_scale, 1.0)?;
    let (angle_sd, scale_sd) = deviations(&xy, &enu, limits.blocks)?;
    let far_m = xy.iter().map(Vector2::norm).fold(0.0, f64::max);
    let receiver_rad = overlay.receiver_deviation(limits.errors_last_s, limits.untold_m);
    let is_sound = overlay.extent_m() >= limits.min_extent_m
        && far_m * receiver_rad <= limits.track_m
        && overlay.both.len() >= limits.min_points
        && far_m <= limits.local_m
        && fit.rms_m <= limits.track_m;
    let within_m = limits.sigmas * (fit.rms_m + far_m * angle_sd.hypot(scale_sd));
    (is_sound && within_m <= limits.track_m).then_some((
        overlay.origin(&fit)?,
        within_m,
        (fit.angle_rad, angle_sd.hypot(receiver_rad)),
    ))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) warning_m: f64,
    pub(crate) error_m: f64,
    pub(crate) track_m: f64,
    pub(crate) site_m: f64,
    pub(crate) geoid_m: f64,
    pub(crate) min_geoid_m: f64,
    pub(crate) max_height_m: f64,
    pub(crate) local_m: f64,
    pub(crate) min_extent_m: f64,
    pub(crate) min_points: usize,
    pub(crate) blocks: usize,
    pub(crate) max_scale: f64,
    pub(crate) sigmas: f64,
    pub(crate) copied_m: f64,
    pub(crate) aligned_deg: f64,
    pub(crate) errors_last_s: f64,
    pub(crate) untold_m: f64,
}
