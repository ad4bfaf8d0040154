//! How lidars moved by their own clouds: neighbouring scans matched to each other, once for all rules.
//!
//! Owns which points are compared and the chains of steps. Motions are in the plane of the cloud's x and y, and only sought where
//! that plane is level. Must not judge.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Isometry2, Vector2, Vector3};

use crate::math::scan_match::{Matched, Scan, matched};
use crate::math::stats::median;
use crate::rules::axes::up_axis_flip::UpAxisFlip;
use crate::rules::ground::{Planes, SIDES};
use crate::rules::lidar::Clouds;
use crate::rules::limits_of;
use crate::rules::motion::{Motion, mount};
use crate::world::World;
use crate::world::cloud::CloudSlice;

/// Points lower than this over the ground are left out, metres: the rings of beams on it move with the sensor.
const CLEAR_M: f64 = 0.3;
/// Cosine of the tilt up to which a planar scanner is level: 5 degrees.
const LEVEL: f64 = 0.996;
/// Why it is not known which way z of a cloud points.
const NO_GROUND: &str = "no ground shows that the plane of its x and y is level";
/// Stamps of one clock differ from log times by less than this, seconds.
const SAME_CLOCK_S: f64 = 1.0;
/// Where a first scan may have come from, metres in x and y.
const GUESSES: [[f64; 2]; 5] = [[0.0, 0.0], [0.8, 0.0], [-0.8, 0.0], [0.0, 0.8], [0.0, -0.8]];

/// When a cloud was made, seconds after the recording's start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    stamp_s: Option<f64>,
    log_s: f64,
}

impl Moment {
    /// Of a message with such a stamp, where it has one, and such a log time.
    pub(crate) fn new(stamp_ns: Option<i64>, log_ns: i64, start_ns: i64) -> Self {
        let seconds = |ns: i64| ns.saturating_sub(start_ns) as f64 * 1e-9;
        Self {
            stamp_s: stamp_ns.map(seconds),
            log_s: seconds(log_ns),
        }
    }

    /// The same moment on the clock of a stream whose stamps are so much later than its log times.
    pub(crate) fn on(&self, stamp_offset_s: Option<f64>) -> f64 {
        let by_stamps = self
            .stamp_s
            .zip(stamp_offset_s)
            .map(|(stamp_s, offset_s)| stamp_s - offset_s);
        by_stamps
            .filter(|t_s| (t_s - self.log_s).abs() < SAME_CLOCK_S)
            .unwrap_or(self.log_s)
    }
}

/// The motion of a lidar between two of its clouds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moved {
    pub(crate) from: Moment,
    pub(crate) to: Moment,
    /// `from_cloud_from_to_cloud`: where the later sensor is in the axes of the earlier one.
    pub(crate) motion: Isometry2<f64>,
    /// Standard errors of the angle and of the place, radians and metres.
    pub(crate) sigma: [f64; 2],
}

impl Moved {
    /// How far it went, metres.
    pub(crate) fn way_m(&self) -> f64 {
        self.motion.translation.vector.norm()
    }

    /// How far it turned about the cloud's z, radians.
    pub(crate) fn turned_rad(&self) -> f64 {
        self.motion.rotation.angle()
    }

    fn then(&self, next: &Self) -> Self {
        let [a, b] = [self.sigma, next.sigma];
        Self {
            from: self.from,
            to: next.to,
            motion: self.motion * next.motion,
            sigma: [a[0].hypot(b[0]), a[1].hypot(b[1]).hypot(a[0] * next.way_m())],
        }
    }
}

/// The steps of one topic's clouds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Steps {
    /// Whether the ground lies beneath z of the cloud; `None` where none shows, or z is not upright. A planar scanner sees no ground:
    /// its transforms tell it.
    pub(crate) is_up: Option<bool>,
    /// Why that is not known.
    pub(crate) why: &'static str,
    runs: Vec<Vec<Moved>>,
}

impl Steps {
    /// How many steps were matched.
    pub(crate) fn count(&self) -> usize {
        self.runs.iter().map(Vec::len).sum()
    }

    /// Steps that follow each other put together until they are enough, one after the other.
    pub(crate) fn chained(&self, is_enough: impl Fn(&Moved) -> bool) -> Vec<Moved> {
        self.put_together(is_enough, false)
    }

    /// The same, with what is left at the end of each run.
    pub(crate) fn chained_to_the_end(&self, is_enough: impl Fn(&Moved) -> bool) -> Vec<Moved> {
        self.put_together(is_enough, true)
    }

    fn put_together(&self, is_enough: impl Fn(&Moved) -> bool, keeps_rest: bool) -> Vec<Moved> {
        let mut chained = Vec::new();
        for run in &self.runs {
            let mut open: Option<Moved> = None;
            for step in run {
                let moved = open.map_or(*step, |open| open.then(step));
                open = if is_enough(&moved) {
                    chained.push(moved);
                    None
                } else {
                    Some(moved)
                };
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
    /// Those of a world; worked out once, for recordings in which something else moves as well.
    pub(crate) fn of(world: &World) -> Arc<Self> {
        let (motion, planes) = (Motion::of(world), Planes::of(world));
        world.derived(|world| {
            let moves = |clouds: &Clouds| {
                let bag = motion.bags.get(clouds.index);
                clouds.is_of_a_lidar() && bag.is_some_and(|bag| !bag.imus.is_empty() || !bag.poses.is_empty())
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

fn steps(world: &World, clouds: &Clouds, planes: &Planes) -> Steps {
    if clouds.laser.is_some() {
        return match level(world, clouds) {
            Ok(is_up) => Steps {
                is_up: Some(is_up),
                why: "",
                runs: runs(clouds, |_| true),
            },
            Err(why) => Steps {
                why,
                ..Steps::default()
            },
        };
    }
    let Some(limits) = limits_of::<UpAxisFlip>() else {
        return Steps::default();
    };
    let grounds = planes.grounds(clouds, &limits.is_ground());
    let side = limits.agreed(clouds, &grounds).ok().and_then(|side| SIDES.get(side));
    let is_up = match side.map(|(_, word)| *word) {
        Some("z") => Some(true),
        Some("-z") => Some(false),
        // The plane that was cut stands upright.
        Some(_) => {
            return Steps {
                why: NO_GROUND,
                ..Steps::default()
            };
        }
        None => None,
    };
    let height_m = is_up.and_then(|_| median(&grounds.iter().map(|ground| ground.plane.height_m).collect::<Vec<_>>()));
    let sign = if is_up == Some(false) { -1.0 } else { 1.0 };
    let is_clear = |z: f64| height_m.is_none_or(|height_m| sign * z > CLEAR_M - height_m);
    Steps {
        is_up,
        why: NO_GROUND,
        runs: runs(clouds, is_clear),
    }
}

/// Whether z of a planar scanner points up, as the transforms say.
fn level(world: &World, clouds: &Clouds) -> Result<bool, &'static str> {
    let frame = clouds.frame().ok_or("the scans name no frame")?;
    let mount =
        mount(world, &frame).ok_or("nothing ties the scanner to a base, so that its plane may lie in any way")?;
    let up = (mount.base_from_sensor.rotation * Vector3::z()).z;
    if up.abs() < LEVEL {
        return Err("by its transform the plane of the scanner is not level");
    }
    Ok(up > 0.0)
}

/// The steps of each run, of the points that count.
fn runs(clouds: &Clouds, is_clear: impl Fn(f64) -> bool) -> Vec<Vec<Moved>> {
    let scan = |slice: &CloudSlice| {
        let points = slice.points.iter().filter(|point| is_clear(point[2]));
        Scan::new(points.map(|[x, y, _]| Vector2::new(*x, *y)))
    };
    let start_ns = clouds.bag.start_ns.unwrap_or_default();
    let mut runs = Vec::new();
    for run in &clouds.evidence.runs {
        let scans: Vec<(Moment, Scan)> = run
            .iter()
            .map(|slice| (Moment::new(slice.stamp_ns, slice.log_ns, start_ns), scan(slice)))
            .collect();
        let mut steps: Vec<Moved> = Vec::new();
        for pair in scans.windows(2) {
            let [(from, target), (to, source)] = pair else { continue };
            let known = steps.last().filter(|last| last.to == *from).map(|last| last.motion);
            let Some(found) = step(target, source, known) else {
                runs.push(std::mem::take(&mut steps));
                continue;
            };
            steps.push(Moved {
                from: *from,
                to: *to,
                motion: found.motion,
                sigma: [found.sigma_rad, found.sigma_m],
            });
        }
        runs.push(steps);
    }
    runs.retain(|run| !run.is_empty());
    runs
}

/// One step: about as the last one, else from the best of several guesses.
fn step(target: &Scan, source: &Scan, known: Option<Isometry2<f64>>) -> Option<Matched> {
    if let Some(known) = known {
        return matched(target, source, &known);
    }
    let tried = GUESSES.map(|[x, y]| matched(target, source, &Isometry2::new(Vector2::new(x, y), 0.0)));
    let of = |found: &Matched| found.overlap / (found.residual_m + 0.01);
    tried.into_iter().flatten().max_by(|a, b| of(a).total_cmp(&of(b)))
}

/// A motion in the plane of the cloud as one in its three axes.
pub(crate) fn in_space(motion: &Isometry2<f64>) -> nalgebra::Isometry3<f64> {
    let place = motion.translation.vector;
    nalgebra::Isometry3::new(
        Vector3::new(place.x, place.y, 0.0),
        Vector3::z() * motion.rotation.angle(),
    )
}
