//! Poses in other coordinates of the Earth: grids, Earth-centred ones, degrees.
//!
//! Where the frame of the poses lies on the Earth is taken from the fixes of the same recording.

use nalgebra::{Rotation3, UnitQuaternion, Vector2, Vector3};

use crate::faults::{Change, Family, Subject};
use crate::math::geodesy::Geodetic;
use crate::math::similarity2::fit_similarities;
use crate::math::utm::{Utm, utm, zone};
use crate::world::World;
use crate::world::bag::TopicEvidence;
use crate::world::motion::{FixRow, PoseRow};

use super::fixes::geodetic;
use super::poses::change_poses;
use super::streams::{MovingFrame, Stream};
use super::turns::turned;

/// Pairs of a pose and a fix that the frame is placed by.
const MAX_PAIRS: usize = 2000;
/// Fixes further apart than this say nothing about what is between them, nanoseconds.
const MAX_GAP_NS: i64 = 5_000_000_000;
/// The largest error of the scale of poses that follow the fixes.
const MAX_SCALE: f64 = 0.1;
/// The largest residual of such poses, as a share of the extent of their way.
const MAX_RESIDUAL: f64 = 0.1;
/// The shortest extent of a way that places a frame, metres.
const MIN_EXTENT_M: f64 = 5.0;
/// The direction of a grid's east is measured over this distance, metres.
const GRID_STEP_M: f64 = 50.0;

/// A pose on the Earth.
pub(super) struct PlacedPose {
    /// The origin of the frame of the poses.
    pub(super) origin: Geodetic,
    /// Where the pose is.
    pub(super) there: Geodetic,
    /// Its position in the frame of the poses, metres.
    pub(super) position: Vector3<f64>,
    /// `enu_from_frame`, east, north, up being those of the origin.
    pub(super) enu_from_frame: Rotation3<f64>,
}

/// Another expression of a pose: the position, metres or as the coordinates have it, and `new_frame_from_frame`.
pub(super) type PlacedPosition = (Vector3<f64>, Rotation3<f64>);

/// A mistake in the coordinates of poses.
pub(super) struct PlaceChange(pub(super) fn(&PlacedPose) -> Option<PlacedPosition>);

impl Change for PlaceChange {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let poses = Stream::all(world).filter(|stream| stream.family == Family::Pose);
        let (corrections, streams): (Vec<Stream>, Vec<Stream>) =
            poses.partition(|stream| stream.moving == MovingFrame::World);
        // Odometry that is corrected has no place on the Earth of its own.
        let is_corrected = |stream: &Stream| corrections.iter().any(|other| other.corrects(stream));
        let is_meant = |stream: &Stream| !is_corrected(stream) && !fixes(world, stream).is_empty();
        streams.into_iter().filter(is_meant).map(Subject::from).collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let Some(stream) = Stream::of(subject) else {
            return false;
        };
        let Some(frame) = PlacedFrame::of(world, stream) else {
            return false;
        };
        change_poses(world, stream, |message, _| {
            let altered = frame.pose(message.position).and_then(|pose| (self.0)(&pose));
            if let Some((position, new_from_old)) = altered {
                message.position = position.into();
                message.orientation = turned(message.orientation, |stated| {
                    UnitQuaternion::from(new_from_old) * stated
                });
            }
        })
    }
}

impl PlacedPose {
    /// Its place in the grid of the origin's zone.
    fn grid(&self, place: &Geodetic) -> Option<Utm> {
        utm(place, zone(&self.origin))
    }

    /// In the grid: easting and northing, metres, and the altitude.
    pub(super) fn in_utm(&self) -> Option<PlacedPosition> {
        let Utm {
            easting_m, northing_m, ..
        } = self.grid(&self.there)?;
        // Where the east of the origin points in the grid.
        let enu = self.origin.enu_of(&self.there);
        let aside = |metres: f64| self.grid(&self.origin.at_enu(&(enu + Vector3::x() * metres))?);
        let (from, to) = (aside(-GRID_STEP_M)?, aside(GRID_STEP_M)?);
        let turn_rad = (to.northing_m - from.northing_m).atan2(to.easting_m - from.easting_m);
        let grid_from_enu = Rotation3::from_axis_angle(&Vector3::z_axis(), turn_rad);
        let position = Vector3::new(easting_m, northing_m, self.there.height_m);
        Some((position, grid_from_enu * self.enu_from_frame))
    }

    /// In the grid, from the origin on.
    pub(super) fn in_local_utm(&self) -> Option<PlacedPosition> {
        let origin = self.grid(&self.origin)?;
        let (position, grid_from_frame) = self.in_utm()?;
        let start = Vector3::new(origin.easting_m, origin.northing_m, self.origin.height_m);
        Some((position - start, grid_from_frame))
    }

    /// In the Earth's frame.
    pub(super) fn in_ecef(&self) -> PlacedPosition {
        let earth_from_enu = self.origin.enu_from_ecef().inverse();
        (self.there.to_ecef(), earth_from_enu * self.enu_from_frame)
    }

    /// Latitude and longitude in degrees, and the altitude.
    pub(super) fn in_degrees(&self) -> PlacedPosition {
        let degrees = [self.there.latitude_rad, self.there.longitude_rad].map(f64::to_degrees);
        let [latitude, longitude] = degrees;
        let position = Vector3::new(latitude, longitude, self.there.height_m);
        (position, self.enu_from_frame)
    }

    /// The altitude over that of the origin as z.
    pub(super) fn with_altitude(&self) -> PlacedPosition {
        let up_m = self.there.height_m - self.origin.height_m;
        (
            Vector3::new(self.position.x, self.position.y, up_m),
            Rotation3::identity(),
        )
    }

    /// In the tangent plane of another place, this many degrees to the south.
    pub(super) fn in_plane_south(&self, degrees: f64) -> PlacedPosition {
        let away = Geodetic {
            latitude_rad: self.origin.latitude_rad - degrees.to_radians(),
            ..self.origin
        };
        let away_from_enu = away.enu_from_ecef() * self.origin.enu_from_ecef().inverse();
        (away.enu_of(&self.there), away_from_enu * self.enu_from_frame)
    }
}

/// Where the frame of some poses lies on the Earth.
struct PlacedFrame {
    origin: Geodetic,
    enu_from_frame: Rotation3<f64>,
}

impl PlacedFrame {
    /// Places the frame of a stream; `None` where its poses do not follow the fixes.
    fn of(world: &World, stream: &Stream) -> Option<Self> {
        let fixes = fixes(world, stream);
        let first = fixes.iter().copied().find_map(geodetic)?;
        let rows: Vec<&PoseRow> = stream.pose_sections(world).flatten().collect();
        let step = rows.len().div_ceil(MAX_PAIRS).max(1);
        let pair = |row: &&PoseRow| Some((Vector3::from(row.position), first.enu_of(&between(&fixes, row.log_ns)?)));
        let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = rows.iter().step_by(step).filter_map(pair).collect();
        let (xy, enu): (Vec<Vector2<f64>>, Vec<Vector2<f64>>) = pairs.iter().map(|(a, b)| (a.xy(), b.xy())).unzip();
        let fit = fit_similarities(&xy, &enu)?.proper;
        let start = enu.first()?;
        let extent_m = enu.iter().map(|point| (point - start).norm()).fold(0.0, f64::max);
        let follows = (fit.scale - 1.0).abs() <= MAX_SCALE && fit.rms_m <= MAX_RESIDUAL * extent_m;
        if !follows || extent_m < MIN_EXTENT_M {
            return None;
        }
        let enu_from_frame = Rotation3::from_axis_angle(&Vector3::z_axis(), fit.angle_rad);
        let shift = pairs.iter().map(|(a, b)| b - enu_from_frame * a).sum::<Vector3<f64>>() / pairs.len() as f64;
        Some(Self {
            origin: first.at_enu(&shift)?,
            enu_from_frame,
        })
    }

    /// The pose at a position in the frame, metres.
    fn pose(&self, position: [f64; 3]) -> Option<PlacedPose> {
        let position = Vector3::from(position);
        Some(PlacedPose {
            origin: self.origin,
            there: self.origin.at_enu(&(self.enu_from_frame * position))?,
            position,
            enu_from_frame: self.enu_from_frame,
        })
    }
}

/// The fixes of a stream's recording: of several receivers those of the one with the most messages.
fn fixes<'w>(world: &'w World, stream: &Stream) -> Vec<&'w FixRow> {
    let bag = world.bags.get(stream.bag);
    let said = bag.into_iter().flat_map(|bag| bag.topics.values());
    let series = said.flat_map(TopicEvidence::contents);
    let series = series.filter_map(|said| said.content.motion.fixes.as_ref());
    let longest = series.max_by_key(|series| series.count);
    longest.map(|series| series.rows().collect()).unwrap_or_default()
}

/// The place at a log time, between the fixes before and after it.
fn between(fixes: &[&FixRow], log_ns: i64) -> Option<Geodetic> {
    let after = fixes.partition_point(|fix| fix.log_ns < log_ns);
    let (a, b) = (fixes.get(after.checked_sub(1)?)?, fixes.get(after)?);
    let gap_ns = b.log_ns.saturating_sub(a.log_ns);
    let (from, to) = (geodetic(a)?, geodetic(b)?);
    let share = log_ns.saturating_sub(a.log_ns) as f64 / gap_ns.max(1) as f64;
    let at = |a: f64, b: f64| a + (b - a) * share;
    ((0..=MAX_GAP_NS).contains(&gap_ns)).then(|| Geodetic {
        latitude_rad: at(from.latitude_rad, to.latitude_rad),
        longitude_rad: at(from.longitude_rad, to.longitude_rad),
        height_m: at(from.height_m, to.height_m),
    })
}
