//! One stream of motion on the common clock.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use nalgebra::{Isometry3, Translation3, Vector3};

use crate::analysis::geo::kinds::{Limits, is_earth_centred};
use crate::analysis::motion::convention::{Convert, MovingFrame, StreamConvention};
use crate::analysis::{motion::clock::Clock, motion::mount::mount, motion::track::Track, names};
use crate::math::{circular::wrapped, geodesy::Geodetic, readings::Reading};
use crate::source::{MessageRef, Place, SourceId};
use crate::world::bag::{HeaderFrame, TfEdge, TopicContent};
use crate::world::motion::{FixRow, PoseRow, Row, Series};
use crate::world::{BagEvidence, FrameId, World};

/// A row with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimedRow<R> {
    /// Seconds after the recording's start.
    pub(crate) t_s: f64,
    /// The row.
    pub(crate) row: R,
}

impl TimedRow<PoseRow> {
    /// `parent_from_child` as published; `None` if the orientation is invalid.
    pub(crate) fn isometry(&self) -> Option<Isometry3<f64>> {
        let turned = Reading::Xyzw.world_from_body(self.row.orientation)?;
        Some(Isometry3::from_parts(Translation3::from(self.row.position), turned))
    }
}

/// A stream of rows.
#[derive(Clone, Debug)]
pub(crate) struct Stream<R> {
    /// The recording.
    pub(crate) source: SourceId,
    /// Topic of the messages.
    pub(crate) topic: String,
    /// Type of the messages; empty if the stream is a member of them, or of TF.
    pub(crate) message_type: String,
    /// Name of the stream in reports: `topic /imu`, `topic /imu (field imu)`, `TF odom -> base_link on /tf`.
    pub(crate) subject: String,
    /// Whether only the names of plain fields identify it.
    pub(crate) guessed: bool,
    /// Whether it is a moving transform of TF.
    pub(crate) is_transform: bool,
    /// The frame that the data are expressed in (header frame, or parent), canonical; `None` if the headers name none or
    /// several.
    pub(crate) frame: Option<FrameId>,
    /// The frame that moves, canonical, if the stream names it.
    pub(crate) child: Option<FrameId>,
    /// Median of stamp minus log time, seconds, which is subtracted from the times; `None` if they are log times.
    pub(crate) stamp_offset_s: Option<f64>,
    /// First message.
    first: Option<MessageRef>,
    /// The declared convention of the rows; here they are in that of ROS.
    pub(crate) expressed_in: StreamConvention,
    /// Runs of rows without a gap, with increasing times.
    pub(crate) stretches: Vec<Vec<TimedRow<R>>>,
    is_earth_centred: bool,
    made: Cache,
}

/// Derived from the rows of a stream on first use. A copy, which may be altered, starts without.
#[derive(Debug, Default)]
struct Cache {
    track: OnceLock<Arc<Track>>,
}

impl Clone for Cache {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<R: Row> Stream<R> {
    /// The stream of a topic, or of a member of its messages; `None` if it has no rows.
    pub(crate) fn of(bag: &BagEvidence, said: &TopicContent<'_>, series: Option<&Series<R>>) -> Option<Self> {
        let series = series?;
        let (stretches, stamp_offset_s) = on_clock(bag, series)?;
        Some(Self {
            source: bag.source,
            topic: said.topic.topic.clone(),
            message_type: said
                .field
                .map_or_else(|| said.topic.message_type.clone(), |_| String::new()),
            subject: said.subject(),
            guessed: said.guessed,
            is_transform: false,
            frame: only(said.header_frames),
            child: only(said.child_frames),
            stamp_offset_s,
            first: said.first.cloned(),
            expressed_in: StreamConvention::default(),
            stretches,
            is_earth_centred: false,
            made: Cache::default(),
        })
    }

    /// Every row of all stretches.
    pub(crate) fn rows(&self) -> impl Iterator<Item = &TimedRow<R>> {
        self.stretches.iter().flatten()
    }

    /// The name of the frame that the data are expressed in, for reports.
    pub(crate) fn frame_name(&self) -> String {
        let frame = self.frame.as_ref();
        frame.map_or_else(|| "the header's frame".to_owned(), |frame| format!("`{frame}`"))
    }

    /// The name of the frame that moves, for reports.
    pub(crate) fn child_name(&self) -> String {
        let child = self.child.as_ref();
        child.map_or_else(|| "the child frame".to_owned(), |child| format!("`{child}`"))
    }

    /// Length of all stretches together, seconds.
    pub(crate) fn seconds(&self) -> f64 {
        let length = |stretch: &Vec<TimedRow<R>>| Some(stretch.last()?.t_s - stretch.first()?.t_s);
        self.stretches.iter().filter_map(length).sum()
    }

    /// Runs of neighbouring rows that last `seconds` each, one after the other, without a step longer than `max_step_s`.
    pub(crate) fn windows(&self, seconds: f64, max_step_s: f64) -> Vec<&[TimedRow<R>]> {
        let mut windows = Vec::new();
        let apart = |a: &TimedRow<R>, b: &TimedRow<R>| b.t_s - a.t_s <= max_step_s;
        for run in self.stretches.iter().flat_map(|stretch| stretch.chunk_by(apart)) {
            let mut rest = run;
            while let Some(first) = rest.first() {
                // However short a window is, it ends behind its first row.
                let end = rest.partition_point(|row| row.t_s < first.t_s + seconds).max(1);
                // The row that ends a window begins the next one.
                let (Some(window), Some(next)) = (rest.get(..=end), rest.get(end..)) else {
                    break;
                };
                windows.push(window);
                rest = next;
            }
        }
        windows
    }

    fn track_of(&self, is_geodetic: bool, place: impl Fn(&R) -> Option<Vector3<f64>>) -> Arc<Track> {
        let place = &place;
        let stretches = self.stretches.iter();
        let places = stretches.map(|rows| rows.iter().filter_map(|timed| Some((timed.t_s, place(&timed.row)?))));
        let track = || Track::of(self.subject.clone(), self.place(), is_geodetic, places);
        Arc::clone(self.made.track.get_or_init(|| Arc::new(track())))
    }

    /// Whether it is expressed in a world frame, or in none that is named: joints move as well, but are no track of the
    /// platform.
    pub(crate) fn is_of_world(&self) -> bool {
        self.frame.as_ref().is_none_or(names::is_world)
    }

    /// The same stream with times relative to a recording that starts `by_s` earlier.
    pub(crate) fn later(&self, by_s: f64) -> Self {
        let mut later = self.clone();
        for timed in later.stretches.iter_mut().flatten() {
            timed.t_s += by_s;
        }
        later
    }

    /// First message of the stream.
    pub(crate) fn place(&self) -> Place {
        Place::of(self.source, self.first.as_ref())
    }
}

impl<R: Row + Convert> Stream<R> {
    /// The stream in the convention of ROS, converted from what the configuration or names declare.
    pub(crate) fn in_ros(self, world: &World) -> Self {
        let expressed_in = self.convention(world);
        let child = self.child.as_ref();
        let mount = child
            .filter(|_| !R::IS_SENSOR && expressed_in.convention.body.is_some())
            .and_then(|child| mount(world, child));
        self.converted(expressed_in.without_turn_of(mount.as_ref()))
    }

    /// The convention that the configuration or names declare.
    pub(crate) fn convention(&self, world: &World) -> StreamConvention {
        let moving = if R::IS_SENSOR {
            MovingFrame::Frame
        } else {
            MovingFrame::Child(self.child.as_ref())
        };
        StreamConvention::of(world, self.source, &self.topic, self.frame.as_ref(), moving)
    }

    /// The stream in the convention of ROS.
    pub(crate) fn converted(mut self, expressed_in: StreamConvention) -> Self {
        if expressed_in.converts() {
            let frame = self.frame.clone();
            for timed in self.stretches.iter_mut().flatten() {
                timed.row.convert(&expressed_in, frame.as_ref());
            }
        }
        self.expressed_in = expressed_in;
        self
    }
}

impl Stream<FixRow> {
    /// Track of the receiver in the tangent plane at its first fix: x east, y north, z up.
    pub(crate) fn track(&self) -> Arc<Track> {
        let origin = self.rows().next().map(|timed| timed.row);
        self.track_of(true, |row| Some(local(&origin?, row)))
    }
}

impl Stream<PoseRow> {
    /// Whether its positions are Earth-centred: x and y are then not horizontal, z is no height, and south of the equator the track
    /// is mirrored.
    pub(crate) fn is_earth_centred(&self) -> bool {
        self.is_earth_centred
    }

    /// With [`Stream::is_earth_centred`] decided.
    pub(crate) fn on_earth(mut self, limits: &Limits) -> Self {
        let places = self.rows().map(|timed| Vector3::from(timed.row.position));
        let mut places = places.filter(|place| place.norm().is_finite() && *place != Vector3::zeros());
        let is_centred = places.next().is_some_and(|place| is_earth_centred(&place, limits));
        drop(places);
        self.is_earth_centred = is_centred;
        self
    }

    /// Whether it is the track of the platform: not the pose of one world frame in another, and no plan.
    pub(crate) fn is_way(&self) -> bool {
        self.is_of_world()
            && !self.is_earth_centred()
            && !self.child.as_ref().is_some_and(names::is_world)
            && !names::is_wish(&self.topic)
    }

    /// Track of the poses in their own frame.
    pub(crate) fn track(&self) -> Arc<Track> {
        self.track_of(false, |row| Some(Vector3::from(row.position)))
    }

    /// The stream of a moving transform.
    pub(crate) fn of_edge(bag: &BagEvidence, edge: &TfEdge) -> Option<Self> {
        let series = edge.motion.as_ref()?;
        let (stretches, stamp_offset_s) = on_clock(bag, series)?;
        let (parent, child) = (edge.parent.canonical(), edge.child.canonical());
        Some(Self {
            source: bag.source,
            topic: edge.topic.clone(),
            message_type: String::new(),
            subject: edge_subject(edge),
            guessed: false,
            is_transform: true,
            frame: Some(parent),
            child: Some(child),
            stamp_offset_s,
            first: Some(edge.first_at.clone()),
            expressed_in: StreamConvention::default(),
            stretches,
            is_earth_centred: false,
            made: Cache::default(),
        })
    }
}

/// Name of the stream of a moving transform in reports.
pub(crate) fn edge_subject(edge: &TfEdge) -> String {
    let (parent, child) = (edge.parent.canonical(), edge.child.canonical());
    format!("TF `{parent}` -> `{child}` on {}", edge.topic)
}

/// East and north of a fix about another, along the ellipsoid, and its altitude over the other's, metres.
///
/// The radius of the parallel is that of the origin: at latitude φ a place d east and d north is off by d² tan φ / R,
/// 0.2 m for a kilometre at 48 degrees. [`Geodetic::enu_of`] is exact, but has no places beyond the poles, which wrong
/// numbers may have.
fn local(origin: &FixRow, fix: &FixRow) -> Vector3<f64> {
    let [east, north] = [
        wrapped((fix.longitude_deg - origin.longitude_deg).to_radians()),
        (fix.latitude_deg - origin.latitude_deg).to_radians(),
    ];
    let place = Geodetic {
        latitude_rad: origin.latitude_deg.to_radians(),
        longitude_rad: origin.longitude_deg.to_radians(),
        height_m: if origin.altitude_m.is_finite() {
            origin.altitude_m
        } else {
            0.0
        },
    };
    let up = fix.altitude_m - origin.altitude_m;
    Vector3::new(
        east * (place.prime_vertical_radius_m() + place.height_m) * place.latitude_rad.cos(),
        north * (place.meridian_radius_m() + place.height_m),
        if up.is_finite() { up } else { 0.0 },
    )
}

type Stretches<R> = Vec<Vec<TimedRow<R>>>;

fn on_clock<R: Row>(bag: &BagEvidence, series: &Series<R>) -> Option<(Stretches<R>, Option<f64>)> {
    let start_ns = bag.start_ns?;
    let clock = Clock::of(series);
    let mut stretches: Stretches<R> = Vec::new();
    for rows in &series.stretches {
        let mut kept: Vec<TimedRow<R>> = Vec::with_capacity(rows.len());
        for row in rows {
            let t_s = clock.time_s(row, start_ns);
            // Two messages of one log time count once.
            if kept.last().is_none_or(|last| t_s > last.t_s) {
                kept.push(TimedRow { t_s, row: row.clone() });
            }
        }
        stretches.push(kept);
    }
    stretches.retain(|stretch| !stretch.is_empty());
    (!stretches.is_empty()).then_some((stretches, clock.stamp_offset_s()))
}

/// The only frame that is named, canonical; the empty name counts as none.
fn only(frames: &BTreeMap<FrameId, HeaderFrame>) -> Option<FrameId> {
    let mut names = frames.keys();
    let first = names.next().filter(|_| names.next().is_none())?.canonical();
    (!first.as_str().is_empty()).then_some(first)
}
