//! Motion of lidars by their own clouds: neighbouring scans matched to each other, once for all rules.
//!
//! Owns which points are compared and the chains of steps. Motions are in the plane of the ground, and only for clouds with z about
//! vertical. Must not judge.

use std::collections::BTreeMap;
use std::hash::Hasher;
use std::rc::Rc;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector2, Vector3};

use crate::analysis::ground::{Ground, Planes, SIDES, sensor_in_cloud};
use crate::analysis::scan_motion::moved::{Moment, ScanStep};
use crate::analysis::scan_motion::run::{CloudPose, Matching, RawCloud};
use crate::analysis::{
    Estimates,
    estimates::{InputHasher, hash_numbers},
    lidar::{Clouds, SCAN_SHARE},
    motion::Motion,
    motion::mount::mount,
};
use crate::math::{stats::median, support_plane::SupportPlane};
use crate::world::{World, cloud::CloudSlice};

pub(crate) mod moved;
mod run;

/// Points lower than this above the ground are left out, metres: the rings of beams on it move with the sensor.
const CLEAR_M: f64 = 0.3;
/// Cosine of the tilt up to which a planar scanner is level: 5 degrees.
const LEVEL: f64 = 0.996;
/// Why the direction of z of a cloud is unknown.
const NO_GROUND: &str = "no visible ground shows that its plane of x and y is level";

/// The steps of one topic's clouds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Steps {
    /// Whether z of the cloud points up, away from the ground; `None` if no ground is visible, or z is not vertical. For a planar
    /// scanner, by its transforms.
    pub(crate) is_up: Option<bool>,
    /// Why that is unknown.
    pub(crate) why: &'static str,
    /// Rotates the cloud's axes so that its z is normal to the ground, up or down as before.
    level_from_cloud: UnitQuaternion<f64>,
    runs: Vec<Vec<CloudPose>>,
}

impl Steps {
    /// Number of matched steps.
    pub(crate) fn count(&self) -> usize {
        self.runs.iter().map(|run| run.len() - 1).sum()
    }

    /// `from_cloud_from_to_cloud`: pose of the later sensor in the axes of the earlier one.
    pub(crate) fn in_cloud(&self, moved: &ScanStep) -> Isometry3<f64> {
        let place = moved.motion.translation.vector;
        let flat = Isometry3::from_parts(
            Translation3::new(place.x, place.y, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), moved.turned_rad()),
        );
        self.level_from_cloud.inverse() * flat * self.level_from_cloud
    }

    /// Consecutive steps, chained until they are enough.
    pub(crate) fn chained(&self, is_enough: impl Fn(&ScanStep) -> bool) -> Vec<ScanStep> {
        self.put_together(is_enough, false)
    }

    /// The same, with the rest at the end of each run.
    pub(crate) fn chained_to_the_end(&self, is_enough: impl Fn(&ScanStep) -> bool) -> Vec<ScanStep> {
        self.put_together(is_enough, true)
    }

    fn put_together(&self, is_enough: impl Fn(&ScanStep) -> bool, keeps_rest: bool) -> Vec<ScanStep> {
        let mut chained = Vec::new();
        for run in &self.runs {
            let Some((mut from, rest)) = run.split_first() else {
                continue;
            };
            let mut open = None;
            for seen in rest {
                let moved = from.moved_to(seen);
                if is_enough(&moved) {
                    chained.push(moved);
                    (from, open) = (seen, None);
                } else {
                    open = Some(moved);
                }
            }
            chained.extend(open.filter(|_| keeps_rest));
        }
        chained
    }
}

/// The steps of every lidar.
pub(crate) struct ScanMotion {
    by_topic: BTreeMap<(usize, String), Steps>,
}

impl ScanMotion {
    /// Those of a world; made once, for recordings with another stream of motion.
    pub(crate) fn of(world: &Estimates) -> Rc<Self> {
        let (motion, planes) = (Motion::of(world), Planes::of(world));
        world.once(|world| {
            let moves = |clouds: &Clouds| {
                let bag = motion.bags.get(clouds.index);
                clouds.is_of_a_lidar()
                    && bag
                        .is_some_and(|bag| !bag.imus.is_empty() || !bag.poses.is_empty() || bag.ways().next().is_some())
            };
            Self {
                by_topic: Clouds::scanners(world)
                    .filter(moves)
                    .map(|clouds| {
                        let key = (clouds.index, clouds.topic.topic.clone());
                        (key, steps(world, &clouds, &planes))
                    })
                    .collect(),
            }
        })
    }

    /// The steps of a topic.
    pub(crate) fn steps(&self, clouds: &Clouds) -> Option<&Steps> {
        self.by_topic.get(&(clouds.index, clouds.topic.topic.clone()))
    }
}

fn steps(world: &Estimates, clouds: &Clouds, planes: &Planes) -> Steps {
    match Flattening::of(world, clouds, planes) {
        Ok(level) => Steps {
            is_up: level.is_up,
            why: NO_GROUND,
            level_from_cloud: level.level_from_cloud,
            runs: timed(
                clouds,
                &world.shared(
                    |hasher| level.hash(clouds, hasher),
                    || runs(clouds, |point| level.flat(point)),
                ),
            ),
        },
        Err(why) => Steps {
            why,
            ..Steps::default()
        },
    }
}

/// Projection of a topic's clouds to the level plane.
#[derive(Default)]
struct Flattening {
    /// See [`Steps::is_up`].
    is_up: Option<bool>,
    level_from_cloud: UnitQuaternion<f64>,
    /// The ground, whose points are left out, and the sensor's position in the cloud, metres.
    ground: Option<(LidarAttitude, Vector3<f64>)>,
}

impl Flattening {
    /// `Err`: why the plane of x and y is not that of the ground.
    fn of(world: &Estimates, clouds: &Clouds, planes: &Planes) -> Result<Self, &'static str> {
        if clouds.laser.is_some() {
            return level(world, clouds).map(|is_up| Self {
                is_up: Some(is_up),
                ..Self::default()
            });
        }
        let limits = world.limits::<crate::analysis::ground::Limits>();
        let grounds = planes.grounds(clouds, &limits.is_ground());
        let side = limits.agreed(clouds, &grounds).ok().and_then(|side| SIDES.get(side));
        let is_up = match side.map(|(_, word)| *word) {
            Some("z") => Some(true),
            Some("-z") => Some(false),
            // The plane of x and y is vertical.
            Some(_) => return Err(NO_GROUND),
            None => None,
        };
        let Some((is_up, upright)) = is_up.and_then(|is_up| Some((is_up, LidarAttitude::of(&grounds, is_up)?))) else {
            return Ok(Self::default());
        };
        let sensor = sensor_in_cloud(world, clouds).unwrap_or_else(Vector3::zeros);
        Ok(Self {
            is_up: Some(is_up),
            level_from_cloud: upright.level_from_cloud,
            ground: Some((upright, sensor)),
        })
    }

    /// Everything that [`runs`] depends on: of times the differences alone.
    fn hash(&self, clouds: &Clouds, hasher: &mut InputHasher) {
        hash_numbers(hasher, self.level_from_cloud.coords.iter().copied());
        if let Some((upright, sensor)) = &self.ground {
            hash_numbers(hasher, [upright.height_m]);
            hash_numbers(hasher, upright.up.iter().chain(sensor).copied());
        }
        for run in &clouds.evidence.runs {
            hash_numbers(hasher, [run.len() as f64]);
            for slice in run {
                hash_numbers(hasher, [slice.points.len() as f64]);
                hash_numbers(hasher, slice.points.iter().flatten().chain(&slice.after).copied());
            }
        }
        let slices = clouds.evidence.runs.iter().flatten();
        let first = clouds.evidence.runs.iter().flatten().next();
        for (slice, first) in slices.zip(first.into_iter().cycle()) {
            let after_ns = slice
                .stamp_ns
                .zip(first.stamp_ns)
                .map(|(to, from)| to.wrapping_sub(from));
            hasher.write_u8(u8::from(slice.stamp_ns.is_some()));
            hasher.write_i64(after_ns.unwrap_or_default());
            hasher.write_i64(slice.log_ns.wrapping_sub(first.log_ns));
        }
    }

    /// A point in the level plane, metres; `None` for points of the ground.
    fn flat(&self, point: &Vector3<f64>) -> Option<Vector2<f64>> {
        let is_clear = self
            .ground
            .as_ref()
            .is_none_or(|(upright, sensor)| upright.height_m + upright.up.dot(&(point - sensor)) > CLEAR_M);
        is_clear.then(|| (self.level_from_cloud * point).xy())
    }
}

/// The clouds of a topic above the ground, with z up.
pub(crate) struct LevelClouds {
    /// Rotates the cloud's axes so that its z points up, away from the ground.
    pub(crate) up_from_cloud: UnitQuaternion<f64>,
    /// Times and points of the clouds of each run, as measured, without the ground, metres.
    pub(crate) runs: Vec<Vec<(Moment, Vec<Vector2<f64>>)>>,
}

impl LevelClouds {
    /// `None` if nothing shows which way is up.
    pub(crate) fn of(world: &Estimates, clouds: &Clouds) -> Option<Self> {
        let level = Flattening::of(world, clouds, &Planes::of(world)).ok()?;
        let is_up = level.is_up?;
        let start_ns = clouds.bag.start_ns.unwrap_or_default();
        let turned = |point: Vector2<f64>| Vector2::new(point.x, if is_up { point.y } else { -point.y });
        let cloud = |slice: &CloudSlice| {
            let points = slice
                .points
                .iter()
                .filter_map(|point| level.flat(&Vector3::from(*point)));
            let moment = Moment::new(slice.stamp_ns, slice.log_ns, start_ns);
            (moment, points.map(turned).collect())
        };
        let over = if is_up { 0.0 } else { std::f64::consts::PI };
        let runs = clouds.evidence.runs.iter();
        Some(Self {
            up_from_cloud: UnitQuaternion::from_axis_angle(&Vector3::x_axis(), over) * level.level_from_cloud,
            runs: runs.map(|run| run.iter().map(cloud).collect()).collect(),
        })
    }
}

/// Attitude of a lidar above the ground.
struct LidarAttitude {
    /// The normal of the ground, in the axes of the cloud.
    up: Vector3<f64>,
    /// Height of the sensor, metres.
    height_m: f64,
    level_from_cloud: UnitQuaternion<f64>,
}

impl LidarAttitude {
    /// By the grounds of its clouds, which are below or above it along z.
    fn of(grounds: &[Ground], is_up: bool) -> Option<Self> {
        let sign = if is_up { 1.0 } else { -1.0 };
        let of_that_side = || {
            grounds
                .iter()
                .map(|ground| ground.plane)
                .filter(|plane| sign * plane.normal.z > 0.0)
        };
        let middle = |of: fn(&SupportPlane) -> f64| median(&of_that_side().map(|plane| of(&plane)).collect::<Vec<_>>());
        let [x, y, z]: [fn(&SupportPlane) -> f64; 3] =
            [|plane| plane.normal.x, |plane| plane.normal.y, |plane| plane.normal.z];
        let up = Vector3::new(middle(x)?, middle(y)?, middle(z)?).try_normalize(0.5)?;
        Some(Self {
            up,
            height_m: middle(|plane| plane.height_m)?,
            level_from_cloud: UnitQuaternion::rotation_between(&up, &(Vector3::z() * sign))?,
        })
    }
}

/// Whether z of a planar scanner points up, by the transforms.
fn level(world: &World, clouds: &Clouds) -> Result<bool, &'static str> {
    let frame = clouds.frame().ok_or("the scans have no `frame_id`")?;
    let mount =
        mount(world, &frame).ok_or("the scanner is not tied to a base such as `base_link`, so its plane is unknown")?;
    let up = (mount.base_from_sensor.rotation * Vector3::z()).z;
    if up.abs() < LEVEL {
        return Err("by its transform the plane of the scanner is not level");
    }
    Ok(up > 0.0)
}

/// The times of the clouds that are kept, run by run.
fn moments(clouds: &Clouds) -> Vec<Vec<Moment>> {
    let start_ns = clouds.bag.start_ns.unwrap_or_default();
    let runs = clouds.evidence.runs.iter();
    let moments = |run: &Vec<CloudSlice>| {
        let slices = run.iter();
        slices
            .map(|slice| Moment::new(slice.stamp_ns, slice.log_ns, start_ns))
            .collect()
    };
    runs.map(moments).collect()
}

/// Matched clouds at the times of these: others with the same differences of time have the same motions.
fn timed(clouds: &Clouds, runs: &[Vec<CloudPose>]) -> Vec<Vec<CloudPose>> {
    let moments = moments(clouds).concat();
    let at = |pose: &CloudPose| Some(pose.at(*moments.get(pose.number)?));
    runs.iter().map(|run| run.iter().filter_map(at).collect()).collect()
}

/// The matched clouds of each run; `flat` projects the points that are used.
fn runs(clouds: &Clouds, flat: impl Fn(&Vector3<f64>) -> Option<Vector2<f64>>) -> Vec<Vec<CloudPose>> {
    let moments = moments(clouds);
    let second = unit_of_times(&clouds.evidence.runs, &moments);
    let mut numbers = 0..;
    let mut runs = Vec::new();
    for (run, moments) in clouds.evidence.runs.iter().zip(&moments) {
        let mut raw = run
            .iter()
            .zip(moments)
            .zip(&mut numbers)
            .map(|((slice, moment), number)| RawCloud::of((number, *moment), slice, second, &flat));
        let Some(first) = raw.next() else { continue };
        let mut matching = Matching::of(first);
        for raw in raw {
            if let Some(whole) = matching.take_in(raw) {
                runs.push(whole);
            }
        }
        runs.push(matching.seen);
    }
    runs.retain(|run| run.len() > 1);
    runs
}

/// Length of the unit of point times, seconds: a cloud takes no longer than the time to the next one. `None` if no unit fits.
fn unit_of_times(runs: &[Vec<CloudSlice>], moments: &[Vec<Moment>]) -> Option<f64> {
    let neighbours = moments.iter().flat_map(|run| run.windows(2));
    let apart_s: Vec<f64> = neighbours
        .filter_map(|pair| {
            let [from, to] = pair else { return None };
            Some(to.since(from))
        })
        .collect();
    let slices = runs.iter().flatten();
    let spans: Vec<f64> = slices
        .filter_map(|slice| slice.after.iter().copied().reduce(f64::max))
        .collect();
    let (apart_s, span) = (median(&apart_s)?, median(&spans)?);
    let seconds = [1.0, 1e-3, 1e-6, 1e-9].map(|unit| (unit, span * unit));
    let longest = seconds
        .into_iter()
        .find(|(_, lasts_s)| *lasts_s <= SCAN_SHARE.end() * apart_s);
    longest
        .filter(|(_, lasts_s)| *lasts_s >= SCAN_SHARE.start() * apart_s)
        .map(|(unit, _)| unit)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use nalgebra::Isometry2;

    fn ground(up: Vector3<f64>) -> Ground {
        let plane = SupportPlane {
            normal: up,
            height_m: 1.8,
            points: 100,
            on: 1.0,
            below: 0.0,
            above: 0.0,
            cells: 40,
            sectors: 36,
            seen: 36,
            far: 1.0,
            at_horizon: 0.0,
            spread_m: 0.0,
        };
        Ground {
            side: 0,
            score: 40.0,
            next: 0.0,
            plane,
            ceiling_cells: 0.0,
        }
    }

    /// A body that rotates by 0.2 rad and moves a metre, with a lidar that is pitched by 12 degrees, upright and upside down.
    #[test]
    fn a_motion_on_the_ground_is_expressed_in_the_axes_of_a_tilted_cloud() {
        let body = Isometry3::new(Vector3::new(1.0, 0.1, 0.0), Vector3::z() * 0.2);
        for (roll, is_up) in [(0.0, true), (std::f64::consts::PI, false)] {
            let body_from_lidar = UnitQuaternion::from_euler_angles(roll, 0.2, 0.0);
            let up = body_from_lidar.inverse() * Vector3::z();
            let upright = LidarAttitude::of(&[ground(up), ground(-up)], is_up).unwrap();
            assert!((upright.up - up).norm() < 1e-12 && (upright.height_m - 1.8).abs() < 1e-12);
            let steps = Steps {
                is_up: Some(is_up),
                level_from_cloud: upright.level_from_cloud,
                ..Steps::default()
            };
            let level = upright.level_from_cloud * body_from_lidar.inverse();
            let flat = level * body * level.inverse();
            assert!(flat.translation.z.abs() < 1e-12, "{flat}");
            let moment = Moment::new(None, 0, 0);
            let moved = ScanStep {
                from: moment,
                to: moment,
                motion: Isometry2::new(flat.translation.vector.xy(), flat.rotation.scaled_axis().z),
                sigma: [0.0; 2],
            };
            let expected = body_from_lidar.inverse() * body * body_from_lidar;
            let off = steps.in_cloud(&moved).inv_mul(&expected);
            assert!(
                off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-9,
                "{off}"
            );
        }
    }
}
