//! The heights that a recording states, and how far one is above another at the same times.
//!
//! Owns what each height is counted from by definition. Metres. Must not judge.

use nalgebra::{Point3, Vector3};
use serde::Deserialize;

use crate::analysis::motion::{BagMotion, Stream, TimedRow, around};
use crate::analysis::{names, names::Standard};
use crate::math::stats::{mad, median};
use crate::math::{geodesy::Geodetic, geoid::undulation_m};
use crate::source::Place;
use crate::world::motion::{FixRow, NmeaRow, PoseRow, Row};
use crate::world::{FrameId, World};

/// What a height is counted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Datum {
    /// The ellipsoid: the sentence itself states the height above mean sea level and the geoid separation.
    Known,
    /// The ellipsoid, by the definition of the message.
    Claimed,
    /// The ellipsoid, by the frames `earth` and `map`: right if the origin of the map is.
    Map,
    /// Not stated.
    Unknown,
}

/// A height over time.
#[derive(Clone, Debug)]
pub(crate) struct Heights {
    pub(crate) topic: String,
    pub(crate) subject: String,
    pub(crate) place: Place,
    pub(crate) datum: Datum,
    /// The standard deviation that it states, metres.
    pub(crate) sd_m: Option<f64>,
    /// Where the first height is; `None` where that is no place on Earth.
    first: Option<Geodetic>,
    /// Seconds, and degrees of latitude and longitude and metres of height.
    runs: Vec<Vec<(f64, Vector3<f64>)>>,
}

/// One height minus another at the same times.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeightGap {
    /// The median, metres.
    pub(crate) median_m: f64,
    /// Median absolute deviation from that, metres.
    pub(crate) spread_m: f64,
    /// The horizontal distance of the two places, the median, metres.
    pub(crate) aside_m: f64,
    pub(crate) samples: usize,
}

/// Longest step that a height is interpolated over, seconds.
const MAX_STEP_S: f64 = 5.0;

impl Heights {
    /// Every height of a recording, the best known datum first.
    pub(crate) fn all(world: &World, bag: &BagMotion, limits: &Limits) -> Vec<Self> {
        let is_nmea = |fixes: &&Stream<FixRow>| bag.nmea.iter().any(|nmea| nmea.subject == fixes.subject);
        let sentences = bag.nmea.iter().filter_map(|stream| Self::of_sentences(stream, limits));
        let fixes = bag.fixes.iter().filter(|fixes| !is_nmea(fixes));
        let poses = bag.poses.iter().filter_map(|stream| Self::of_poses(world, stream));
        let mut all: Vec<Self> = sentences.chain(fixes.filter_map(Self::of_fixes)).chain(poses).collect();
        all.sort_by_key(|heights| heights.datum);
        all
    }

    /// The undulation of the geoid where the heights begin, metres.
    pub(crate) fn undulation_m(&self) -> Option<f64> {
        undulation_m(self.first.as_ref()?)
    }

    /// How far these heights are above others.
    pub(crate) fn above(&self, other: &Self) -> Option<HeightGap> {
        let apart = |(t_s, here): &(f64, Vector3<f64>)| {
            let there = other.at(*t_s)?;
            Some((here.z - there.z, self.aside_m(here, &there)))
        };
        let all = self.runs.iter().flatten().filter_map(apart);
        let (heights, aside): (Vec<f64>, Vec<f64>) = all.unzip();
        Some(HeightGap {
            median_m: median(&heights)?,
            spread_m: mad(&heights)?,
            aside_m: median(&aside)?,
            samples: heights.len(),
        })
    }

    /// The horizontal distance of two places near the first one, metres; NaN where there is no such place.
    fn aside_m(&self, here: &Vector3<f64>, there: &Vector3<f64>) -> f64 {
        let [north_rad, east_rad] = [here.x - there.x, here.y - there.y].map(f64::to_radians);
        self.first.as_ref().map_or(f64::NAN, |first| {
            let east_m = east_rad * first.prime_vertical_radius_m() * first.latitude_rad.cos();
            east_m.hypot(north_rad * first.meridian_radius_m())
        })
    }

    fn at(&self, t_s: f64) -> Option<Vector3<f64>> {
        self.runs.iter().find_map(|run| {
            let ([(t0, a), (t1, b)], share) = around(run, t_s)?;
            (t1 - t0 <= MAX_STEP_S).then(|| a + (b - a) * share)
        })
    }

    fn of<R: Row>(stream: &Stream<R>, datum: Datum, place: impl Fn(&R) -> Option<(f64, f64, f64)>) -> Option<Self> {
        let mut first = None;
        let mut height = |timed: &TimedRow<R>| {
            let (latitude, longitude, height) = place(&timed.row)?;
            let is_place = latitude.is_finite() && longitude.is_finite() && height.is_finite();
            is_place.then(|| {
                first.get_or_insert((latitude, longitude));
                (timed.t_s, Vector3::new(latitude, longitude, height))
            })
        };
        let stretches = stream.stretches.iter();
        let mut runs: Vec<Vec<_>> = stretches
            .map(|rows| rows.iter().filter_map(&mut height).collect())
            .collect();
        runs.retain(|run| !run.is_empty());
        let (latitude, longitude) = first?;
        Some(Self {
            topic: stream.topic.clone(),
            subject: stream.subject.clone(),
            place: stream.place(),
            datum,
            sd_m: None,
            first: Geodetic::from_degrees(latitude, longitude, 0.0),
            runs,
        })
    }

    fn of_fixes(stream: &Stream<FixRow>) -> Option<Self> {
        // `GPSFix` and others leave it open what their altitude is counted from.
        let name = stream.message_type.rsplit('/').next();
        let is_claimed = matches!(name, Some("NavSatFix" | "GeoPointStamped" | "GeoPoseStamped"));
        let datum = if is_claimed { Datum::Claimed } else { Datum::Unknown };
        let stated: Vec<f64> = stream.rows().filter_map(|timed| timed.row.vertical_sd_m()).collect();
        let heights = Self::of(stream, datum, |fix| {
            Some((fix.latitude_deg, fix.longitude_deg, fix.altitude_m))
        });
        heights.map(|heights| Self {
            sd_m: median(&stated),
            ..heights
        })
    }

    /// Height above mean sea level plus the geoid separation by the receiver, which must be near the model's. Where the receiver
    /// states no separation, the height counts as above mean sea level, as the sentence defines it.
    fn of_sentences(stream: &Stream<NmeaRow>, limits: &Limits) -> Option<Self> {
        let placed = stream.rows().find(|timed| timed.row.latitude_deg.is_finite())?;
        let place = Geodetic::from_degrees(placed.row.latitude_deg, placed.row.longitude_deg, 0.0)?;
        let undulation_m = undulation_m(&place)?;
        Self::of(stream, Datum::Known, |row| {
            let separation = if row.geoid_separation_m.is_nan() {
                undulation_m
            } else {
                row.geoid_separation_m
            };
            let is_sound = (separation - undulation_m).abs() <= limits.max_off_m;
            is_sound.then_some((row.latitude_deg, row.longitude_deg, row.altitude_m + separation))
        })
    }

    /// Poses of the platform in a frame that is rigidly connected to `earth`.
    fn of_poses(world: &World, stream: &Stream<PoseRow>) -> Option<Self> {
        let frame = stream.frame.as_ref()?;
        // TF ties the frame itself to `earth`; rows that were brought to ENU are no longer expressed in it.
        if stream.expressed_in.converts() || stream.child.as_ref().is_some_and(|child| !names::is_base(child)) {
            return None;
        }
        let graph = world.graph();
        let is_earth = |frame: &&FrameId| names::standard(frame).is_some_and(|(_, kind)| kind == Standard::Earth);
        let (earth_from_frame, _) = graph
            .frames
            .iter()
            .filter(is_earth)
            .find_map(|earth| graph.chain(earth, frame, |edge| edge.is_rigid))?;
        Self::of(stream, Datum::Map, |pose| {
            let position = Point3::from(Vector3::from(pose.position));
            let place = Geodetic::from_ecef(&(earth_from_frame * position).coords)?;
            Some((
                place.latitude_rad.to_degrees(),
                place.longitude_rad.to_degrees(),
                place.height_m,
            ))
        })
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_undulation_m: f64,
    pub(crate) max_off_m: f64,
    pub(crate) max_spread_m: f64,
    pub(crate) min_samples: usize,
    pub(crate) untold_m: f64,
    pub(crate) sigmas: f64,
    pub(crate) same_m: f64,
}

impl Limits {
    /// The least undulation at which the difference of two heights distinguishes mean sea level from the ellipsoid, metres. Two
    /// heights of one receiver have one error.
    pub(crate) fn needed_m(&self, heights: &Heights, other: &Heights, apart: HeightGap) -> f64 {
        if apart.aside_m <= self.same_m {
            return self.min_undulation_m;
        }
        let [one, two] = [heights, other].map(|heights| heights.sd_m.unwrap_or(self.untold_m));
        self.min_undulation_m.max(self.max_off_m + self.sigmas * one.hypot(two))
    }
}
