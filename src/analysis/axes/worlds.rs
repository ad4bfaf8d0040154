//! Direction of up by gravity and by altitude, in the frames that poses are expressed in.
//!
//! Made once: other rules leave frames whose z does not point up to AXES14. Must not report.

use std::cell::OnceCell;
use std::rc::Rc;

use nalgebra::{UnitQuaternion, Vector3};
use serde::Deserialize;

use crate::analysis::motion::{BagMotion, Imu, Motion, Orientations, Stream, StreamConvention};
use crate::analysis::{
    Estimates, axes::base_up, axes::causes::Base, axes::turns_with::turns_with, look::Estimate, names,
};
use crate::math::stats::median;
use crate::source::Place;
use crate::verdict::NotEvaluated;
use crate::world::motion::{FixRow, PoseRow};
use crate::world::{FrameId, World};

/// Gravity in a frame.
pub(crate) struct Gravity {
    /// Mean direction of the specific force: up.
    pub(crate) up: Vector3<f64>,
    /// Length of the mean of the directions: 1 where all agree.
    pub(crate) concentration: f64,
    /// Largest tilt of the body by the poses, radians.
    pub(crate) tilt_rad: f64,
    /// Mean tilt of the body, by the sensor and by the poses, radians.
    pub(crate) leans_rad: [f64; 2],
    pub(crate) seconds: f64,
    pub(crate) rows: u64,
    /// The sensor that measures it.
    pub(crate) sensor: String,
    /// Whether the sensor is right in its base; `None` if it has none.
    pub(crate) sensor_is_right: Option<bool>,
    /// Whether the pose rotates with the sensor's gyro, so that both use the same axes of the body.
    pub(crate) turns_with: bool,
}

impl Gravity {
    pub(crate) fn angle_deg(&self) -> f64 {
        self.up.xy().norm().atan2(self.up.z).to_degrees()
    }
}

/// Heights by poses compared with altitudes.
pub(crate) struct Heights {
    pub(crate) slope: f64,
    pub(crate) correlation: f64,
    /// Root mean squares about the means, of the altitude and of z, metres.
    pub(crate) rms_m: [f64; 2],
    pub(crate) points: usize,
    pub(crate) receiver: String,
}

/// A frame that poses are expressed in.
pub(crate) struct Frame {
    pub(crate) name: FrameId,
    pub(crate) stream: String,
    pub(crate) place: Place,
    /// The declared convention of its poses; here they are converted to that of ROS.
    pub(crate) expressed_in: StreamConvention,
    pub(crate) gravity: Estimate<Gravity>,
    pub(crate) heights: Estimate<Heights>,
}

impl Frame {
    /// Whether z does not point up, so that x and y are not horizontal: by gravity, with a correct sensor, or by altitude.
    pub(crate) fn is_off(&self, limits: &Limits) -> bool {
        let by_gravity = self
            .gravity
            .as_ref()
            .is_ok_and(|gravity| gravity.sensor_is_right != Some(false) && gravity.angle_deg() > limits.error_deg);
        by_gravity || self.heights.as_ref().is_ok_and(|heights| heights.slope < 0.0)
    }
}

/// The frames of each recording, in the order of [`Motion`].
pub(crate) struct Worlds {
    bags: Vec<Vec<(Frame, bool)>>,
}

impl Worlds {
    /// The frames of a world; made once.
    pub(crate) fn of(world: &Estimates) -> Rc<Self> {
        let motion = Motion::of(world);
        world.once(|world| Self {
            bags: motion.bags.iter().map(|bag| frames(world, bag)).collect(),
        })
    }

    /// Every frame.
    pub(crate) fn frames(&self) -> impl Iterator<Item = &Frame> {
        self.bags.iter().flatten().map(|(frame, _)| frame)
    }

    /// Whether z of a frame in the recording with this number does not point up.
    pub(crate) fn is_off(&self, bag: usize, frame: Option<&FrameId>) -> bool {
        let known = self.bags.get(bag).into_iter().flatten();
        known
            .into_iter()
            .any(|(known, is_off)| *is_off && Some(&known.name) == frame)
    }
}

/// The frames of a recording, and whether z of each is off.
fn frames(world: &Estimates, bag: &BagMotion) -> Vec<(Frame, bool)> {
    let (limits, sign) = (world.limits::<Limits>(), world.limits::<base_up::Limits>());
    let mut found: Vec<Frame> = Vec::new();
    for stream in &bag.poses {
        let Some(frame) = stream.frame.clone().filter(is_level) else {
            continue;
        };
        if stream.is_earth_centred()
            || names::is_wish(&stream.topic)
            || stream.child.as_ref().is_some_and(names::is_world)
        {
            continue;
        }
        // The first stream with enough evidence decides for its frame.
        let is_known = |known: &Frame| known.name == frame && (known.gravity.is_ok() || known.heights.is_ok());
        if found.iter().any(is_known) {
            continue;
        }
        let turned = OnceCell::new();
        let turned = || turned.get_or_init(|| Orientations::of(stream));
        let gravity = first(
            bag.imus
                .iter()
                .map(|imu| gravity(world, stream, &turned, imu, &sign, &limits)),
            || "no inertial sensor: gravity is not measured".to_owned(),
        );
        let heights = first(bag.fixes.iter().map(|fixes| heights(stream, fixes, &limits)), || {
            "no GNSS fixes: the altitude is not measured".to_owned()
        });
        let next = Frame {
            stream: stream.subject.clone(),
            place: stream.place(),
            expressed_in: stream.expressed_in.clone(),
            gravity,
            heights,
            name: frame,
        };
        match found.iter_mut().find(|known| known.name == next.name) {
            None => found.push(next),
            Some(known) if next.gravity.is_ok() || next.heights.is_ok() => *known = next,
            Some(_) => {}
        }
    }
    let with_sense = |frame: Frame| {
        let is_off = frame.is_off(&limits);
        (frame, is_off)
    };
    found.into_iter().map(with_sense).collect()
}

/// Whether z of a frame should point up: not for Earth-fixed frames.
fn is_level(frame: &FrameId) -> bool {
    names::is_world(frame) && !frame.has_token("earth") && !frame.has_token("ecef")
}

fn first<T>(looks: impl Iterator<Item = Estimate<T>>, none: impl Fn() -> String) -> Estimate<T> {
    let mut why = None;
    for look in looks {
        match look {
            Ok(found) => return Ok(found),
            Err(reason) => {
                why.get_or_insert(reason);
            }
        }
    }
    Err(why.unwrap_or_else(|| (NotEvaluated::MissingInput, none())))
}

/// The specific force of a sensor on the moving body, rotated into the frame.
fn gravity<'t>(
    world: &World,
    stream: &Stream<PoseRow>,
    turned: &impl Fn() -> &'t Orientations,
    imu: &Imu,
    sign: &crate::analysis::axes::base_up::Limits,
    limits: &Limits,
) -> Estimate<Gravity> {
    let missing = |why: String| Err((NotEvaluated::MissingInput, why));
    let (Some(child), Some(sensor)) = (&stream.child, &imu.stream.frame) else {
        return missing(format!(
            "{} or {} does not name its body frame",
            stream.subject, imu.stream.subject
        ));
    };
    let chain = world.graph().chain(child, sensor, |edge| edge.is_rigid);
    let child_from_imu = match chain {
        _ if child == sensor => UnitQuaternion::identity(),
        Some((child_from_imu, _)) => child_from_imu.rotation,
        None => {
            return missing(format!(
                "`{sensor}` is not tied to `{child}`: add a URDF or record `/tf_static`"
            ));
        }
    };
    let turned = turned();
    let sensor_is_right = base_up::look(imu, sign).ok().map(|up| up.class == Base::Up);
    let turns_with = turns_with(turned, imu, &child_from_imu, limits.max_step_s);
    if sensor_is_right != Some(false) && turns_with == Some(false) {
        let why = format!(
            "{} rotates opposite to the gyro of {}: they use different axes of `{child}`, so gravity cannot verify the frame",
            stream.subject, imu.stream.subject
        );
        return Err((NotEvaluated::NotApplicable, why));
    }
    let (mut sum, mut count, mut lengths, mut tilt_rad) = (Vector3::zeros(), 0_u64, Vec::new(), 0.0_f64);
    let mut ups = [Vector3::zeros(); 2];
    let mut times: Option<(f64, f64)> = None;
    for timed in imu.stream.rows() {
        let force = Vector3::from(timed.row.linear_acceleration);
        let Some(here) = turned
            .at(timed.t_s, limits.max_step_s)
            .filter(|_| force.norm().is_finite() && force.norm() > 0.0)
        else {
            continue;
        };
        sum += here * child_from_imu * force;
        let in_body = [child_from_imu * force.normalize(), here.inverse() * Vector3::z()];
        ups.iter_mut().zip(in_body).for_each(|(sum, up)| *sum += up);
        lengths.push(force.norm());
        tilt_rad = tilt_rad.max((here * Vector3::z()).xy().norm());
        count += 1;
        times = Some((times.map_or(timed.t_s, |(from, _)| from), timed.t_s));
    }
    let seconds = times.map_or(0.0, |(from, to)| to - from);
    let length = median(&lengths).unwrap_or(0.0);
    let is_gravity = [limits.gravity, 1.0]
        .iter()
        .any(|unit| (length / unit - 1.0).abs() <= limits.gravity_share);
    let concentration = sum.norm() / lengths.iter().sum::<f64>().max(1e-9);
    if seconds < limits.min_s || count < limits.min_rows || !is_gravity {
        let why = format!(
            "only {seconds:.1} s and {count} samples of {} with a pose, median magnitude {length:.2}; {} s, {} and gravity are needed",
            imu.stream.subject, limits.min_s, limits.min_rows
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    if concentration < limits.min_concentration {
        let why = format!(
            "gravity by {} has no steady direction in it (agreement {concentration:.2})",
            imu.stream.subject
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    Ok(Gravity {
        up: sum.normalize(),
        concentration,
        tilt_rad,
        leans_rad: ups.map(|up| up.xy().norm().atan2(up.z)),
        seconds,
        rows: count,
        sensor: imu.stream.subject.clone(),
        sensor_is_right,
        turns_with: turns_with == Some(true),
    })
}

/// Heights compared with altitudes at the times of fixes.
fn heights(stream: &Stream<PoseRow>, fixes: &Stream<FixRow>, limits: &Limits) -> Estimate<Heights> {
    let (poses, satellites) = (stream.track(), fixes.track());
    let (points, mut at) = (satellites.stretches.iter().flatten(), poses.follow());
    let both: Vec<(f64, f64)> = points.filter_map(|(t_s, place)| Some((place.z, at(*t_s)?.z))).collect();
    let count = both.len().max(1) as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| both.iter().map(of).sum::<f64>() / count;
    let (altitude, z) = (mean(|pair| pair.0), mean(|pair| pair.1));
    let (mut aa, mut zz, mut az) = (0.0, 0.0, 0.0);
    for pair in &both {
        let (a, b) = (pair.0 - altitude, pair.1 - z);
        (aa, zz, az) = (aa + a * a, zz + b * b, az + a * b);
    }
    let rms_m = [(aa / count).sqrt(), (zz / count).sqrt()];
    let sigmas: Vec<f64> = fixes.rows().filter_map(|timed| timed.row.vertical_sd_m()).collect();
    let needed_m = limits.min_rms_m.max(limits.sigmas * median(&sigmas).unwrap_or(0.0));
    let correlation = az / (aa * zz).sqrt();
    let slope = az / aa;
    let is_enough = rms_m[1] >= limits.min_rms_m && rms_m[0] >= needed_m && correlation.abs() >= limits.min_correlation;
    if !is_enough || both.len() < limits.min_points {
        let why = format!(
            "the altitude on {} changes by only {:.1} m and z by {:.1} m (rms of {} points, correlation {:.2}); {needed_m:.1} m and {} are needed",
            fixes.topic,
            rms_m[0],
            rms_m[1],
            both.len(),
            if correlation.is_finite() { correlation } else { 0.0 },
            limits.min_correlation
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    if !(1.0 / limits.max_slope..=limits.max_slope).contains(&slope.abs()) {
        let why = format!(
            "z changes {slope:.1} times as much as the altitude on {}: a tilt or a drift",
            fixes.topic
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    Ok(Heights {
        slope,
        correlation,
        rms_m,
        points: both.len(),
        receiver: fixes.subject.clone(),
    })
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) warning_deg: f64,
    pub(crate) error_deg: f64,
    pub(crate) min_s: f64,
    pub(crate) min_rows: u64,
    pub(crate) steady_s: f64,
    pub(crate) planar_deg: f64,
    pub(crate) max_step_s: f64,
    pub(crate) min_concentration: f64,
    pub(crate) gravity: f64,
    pub(crate) gravity_share: f64,
    pub(crate) min_rms_m: f64,
    pub(crate) sigmas: f64,
    pub(crate) min_points: usize,
    pub(crate) min_correlation: f64,
    pub(crate) max_slope: f64,
}
