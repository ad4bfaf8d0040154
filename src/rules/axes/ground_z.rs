//! AXES09: height and tilt of the ground below a lidar.

use nalgebra::{Isometry3, Vector3};

use crate::advice::places::with_mounting;
use crate::analysis::ground::{Ground, Planes, SIDES};
use crate::analysis::{axes::plots, ground, lidar::Clouds, motion::Motion, motion::mount::mount};
use crate::math::stats::{mad, median};
use crate::rules::prelude::*;
use crate::verdict::Plot;
use crate::world::{FrameId, World};

pub(crate) struct GroundZ;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_off_m: f64,
    sigmas: f64,
    likely_off_m: f64,
    class_off_m: f64,
    min_height_m: f64,
    max_tilt_deg: f64,
    min_way_m: f64,
    min_lasts_s: f64,
}

/// A lidar over its ground.
struct LidarMount {
    base: FrameId,
    /// `base_from_cloud`, without its place where the cloud is expressed in the base.
    mount: Isometry3<f64>,
    /// Position of the sensor in the base by TF, metres.
    sensor: Vector3<f64>,
    is_base: bool,
    /// z of the ground in the base, if a frame states it.
    expected_m: Option<f64>,
}

/// What was measured.
struct Height {
    /// z of the ground in the base, and its deviation, metres.
    ground_m: f64,
    sigma_m: f64,
    /// Height of the sensor above the ground, metres.
    sensor_m: f64,
    clouds: u64,
}

impl Rule for GroundZ {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "ground", out);
        let up = world.limits::<crate::analysis::ground::Limits>();
        for clouds in Clouds::all(world) {
            let subject = clouds.subject("ground");
            match LidarMount::of(world, &clouds) {
                Ok(over) => judge_over(world, &clouds, &over, (limits, &up), out),
                Err((reason, why)) => out.not_evaluated(subject, reason, why),
            }
        }
    }
}

impl LidarMount {
    fn of(world: &World, clouds: &Clouds) -> Result<Self, (NotEvaluated, String)> {
        if !clouds.is_of_a_lidar() {
            let why = "not recognised as raw points of a lidar by its fields, topic or frame".to_owned();
            return Err((NotEvaluated::NotApplicable, why));
        }
        let Some(frame) = clouds.frame() else {
            return Err((NotEvaluated::MissingInput, clouds.frameless().to_owned()));
        };
        let Some(mount) = mount(world, &frame) else {
            let why = format!("`{frame}` is not tied to a base such as `base_link`: add a URDF or record `/tf_static`");
            return Err((NotEvaluated::MissingInput, why));
        };
        let sensor = if mount.is_base {
            let Some(sensor) = ground::sensor_in_cloud(world, clouds) else {
                let why = format!(
                    "the cloud is expressed in `{frame}`, and no transform states where the lidar is mounted on it"
                );
                return Err((NotEvaluated::MissingInput, why));
            };
            sensor
        } else {
            mount.base_from_sensor.translation.vector
        };
        Ok(Self {
            expected_m: expected(world, &mount.base),
            mount: mount.base_from_sensor,
            is_base: mount.is_base,
            base: mount.base,
            sensor,
        })
    }

    /// z in the base of the ground under the sensor.
    fn ground_m(&self, ground: &Ground) -> Option<f64> {
        let normal = self.mount.rotation * ground.plane.normal;
        (normal.z > 0.1).then(|| (normal.dot(&self.sensor) - ground.plane.height_m) / normal.z)
    }

    /// z of the ground in each cloud that shows one, over the time of the recording.
    fn plot(&self, clouds: &Clouds, grounds: &[(usize, Ground)], side: usize, limits: &Limits) -> Option<Plot> {
        let start_ns = clouds.bag.start_ns.unwrap_or(0);
        let of_side = grounds.iter().filter(|(_, ground)| ground.side == side);
        let points = of_side.filter_map(|(index, ground)| {
            let at = &clouds.evidence.samples.get(*index)?.at;
            Some([at.log_ns.saturating_sub(start_ns) as f64 / 1e9, self.ground_m(ground)?])
        });
        let title = format!("Height of the ground in `{}`, by `{}`", self.base, clouds.topic.topic);
        plots::ground(
            title,
            points,
            self.expected_m.map(|expected_m| (expected_m, limits.max_off_m)),
        )
    }

    /// Height of the ground below the sensor by the planes, with the sensor's position by TF.
    fn height(&self, grounds: &[&Ground]) -> Option<Height> {
        let z: Vec<f64> = grounds.iter().filter_map(|ground| self.ground_m(ground)).collect();
        let heights: Vec<f64> = grounds.iter().map(|ground| ground.plane.height_m).collect();
        Some(Height {
            ground_m: median(&z)?,
            sigma_m: mad(&z)? / (z.len() as f64).sqrt(),
            sensor_m: median(&heights)?,
            clouds: z.len() as u64,
        })
    }
}

/// z of the ground in a base: zero in `base_footprint`, that frame's z by TF in others.
fn expected(world: &World, base: &FrameId) -> Option<f64> {
    let is_footprint = |frame: &&FrameId| frame.tokens().last().is_some_and(|token| token == "footprint");
    if is_footprint(&base) {
        return Some(0.0);
    }
    let graph = world.graph();
    let mut footprints = graph.frames.iter().filter(is_footprint);
    footprints.find_map(|footprint| {
        let (base_from_footprint, _) = graph.chain(base, footprint, |edge| edge.is_rigid)?;
        Some(base_from_footprint.translation.z)
    })
}

fn judge_over(
    world: &Estimates,
    clouds: &Clouds,
    over: &LidarMount,
    (limits, up): (&Limits, &crate::analysis::ground::Limits),
    out: &mut Judge,
) {
    let planes = Planes::of(world);
    let subject = clouds.subject("ground");
    let by_cloud = planes.grounds_by_cloud(clouds, &up.is_ground());
    let grounds: Vec<Ground> = by_cloud.iter().map(|(_, ground)| *ground).collect();
    let side = match up.agreed(clouds, &grounds) {
        Ok(side) => side,
        Err(why) => {
            if let Some(finding) = applied_already(world, clouds, over, &subject, (limits, up)) {
                return out.fail(clouds.once_per_lidar(world, finding));
            }
            return out.too_little(subject, why);
        }
    };
    let axis = SIDES.get(side).map_or(Vector3::z(), |(axis, _)| Vector3::from(*axis));
    let lean_deg = (over.mount.rotation * axis).angle(&Vector3::z()).to_degrees();
    // AXES10 reports it.
    if lean_deg > up.max_off_deg {
        let why = format!(
            "the ground is {lean_deg:.0} deg away from below `{}`: the axes are rotated, so neither height nor tilt is judged",
            over.base
        );
        out.not_applicable(clouds.subject("level of the ground"), why.clone());
        return out.not_applicable(subject, why);
    }
    let grounds: Vec<&Ground> = grounds.iter().filter(|ground| ground.side == side).collect();
    out.plot(&subject, || over.plot(clouds, &by_cloud, side, limits));
    let Some(height) = over.height(&grounds) else { return };
    judge_height(world, clouds, (over, &height), limits, out);
    judge_tilt(world, clouds, (over, &grounds), limits, out);
}

fn judge_height(
    world: &World,
    clouds: &Clouds,
    (over, height): (&LidarMount, &Height),
    limits: &Limits,
    out: &mut Judge,
) {
    let subject = clouds.subject("ground");
    let tolerance_m = limits.max_off_m.max(limits.sigmas * height.sigma_m);
    let measured = |off_m: f64| {
        let depth = Measured::new("depth of the ground below its expected height", -off_m, "m")
            .limit(tolerance_m)
            .spread(height.sigma_m)
            .samples(height.clouds);
        // A cloud in the base does not show where its sensor is.
        let sensor = Measured::new(
            "height of the lidar above the ground, by its own cloud",
            height.sensor_m,
            "m",
        );
        [Some(depth), (!over.is_base).then_some(sensor)].into_iter().flatten()
    };
    let Some(expected_m) = over.expected_m else {
        // The height of a base above the ground is unknown, but it is not below the ground.
        if height.ground_m > limits.likely_off_m + limits.sigmas * height.sigma_m {
            let finding = off(clouds, over, height, 0.0, limits);
            return out.fail(clouds.once_per_lidar(world, finding.measured(measured(height.ground_m))));
        }
        let why = format!(
            "the ground is at z = {:.2} m in `{}`, and no `base_footprint` states the height of that frame above the ground",
            height.ground_m, over.base
        );
        return out.missing(subject, why);
    };
    let off_m = height.ground_m - expected_m;
    if off_m.abs() <= tolerance_m {
        return out.pass(subject, measured(off_m));
    }
    let finding = off(clouds, over, height, expected_m, limits);
    out.fail(clouds.once_per_lidar(world, finding.measured(measured(off_m))));
}

/// A ground at the wrong height.
fn off(clouds: &Clouds, over: &LidarMount, height: &Height, expected_m: f64, limits: &Limits) -> Finding {
    let subject = clouds.subject("ground");
    let off_m = height.ground_m - expected_m;
    // Height of the sensor above the ground by TF.
    let stated_m = over.sensor.z - expected_m;
    let near = |a: f64, b: f64| (a - b).abs() <= limits.class_off_m;
    let is_high = height.sensor_m > limits.min_height_m;
    let (base, sensor_m) = (&over.base, height.sensor_m);
    let (relation, what, help) = if over.is_base && is_high && near(off_m, -stated_m) && stated_m > limits.min_height_m
    {
        (
            Some("not-applied"),
            format!(
                "the cloud names `{base}`, but is expressed in the axes of the lidar, which is {stated_m:.2} m above the ground by the transforms"
            ),
            format!(
                "set the `frame_id` of the cloud to the frame of the lidar, or transform the points into `{base}` before they are published"
            ),
        )
    } else if is_high && stated_m.abs() <= limits.class_off_m {
        (
            Some("not-applied"),
            format!("the lidar is {sensor_m:.2} m above the ground, but its transform has no such height"),
            format!("write the height of the lidar ({sensor_m:.2} m above the ground) into its mounting transform"),
        )
    } else if is_high && near(stated_m, -sensor_m) {
        (
            Some("z-sign"),
            format!(
                "the height of the mounting has the wrong sign: the lidar is {stated_m:.2} m above the ground by the transforms, {sensor_m:.2} m by its cloud"
            ),
            "change the sign of z in the mounting transform of the lidar".to_owned(),
        )
    } else if is_high && near(stated_m, 2.0 * sensor_m) {
        (
            Some("twice"),
            format!(
                "the height of the mounting is applied twice: the lidar is {stated_m:.2} m above the ground by the transforms, {sensor_m:.2} m by its cloud"
            ),
            "apply the height of the mounting once: remove it from the driver or from the transforms".to_owned(),
        )
    } else {
        (
            None,
            "the height of the mounting, or of the base, is wrong".to_owned(),
            format!(
                "measure the height of the lidar above the ground ({sensor_m:.2} m by the cloud, {stated_m:.2} m by the transforms), and \
                 correct its mounting transform or that of `base_footprint`"
            ),
        )
    };
    let message = format!(
        "`{}`: ground is {:.2} m too {} in `{}` (z = {:.2} m)",
        clouds.topic.topic,
        off_m.abs(),
        if off_m > 0.0 { "high" } else { "low" },
        over.base,
        height.ground_m
    );
    match relation {
        Some(relation) => Finding::error(subject, message, clouds.place())
            .likely()
            .relation(relation),
        None if off_m.abs() > limits.likely_off_m => Finding::warning(subject, message, clouds.place()).likely(),
        None => Finding::warning(subject, message, clouds.place()).hint(),
    }
    .detail(format!("Probable cause: {what}."))
    .help(help)
}

/// A finding, if the points show a ground at the height that it has once the extrinsic is applied.
fn applied_already(
    world: &Estimates,
    clouds: &Clouds,
    over: &LidarMount,
    subject: &str,
    (limits, up): (&Limits, &crate::analysis::ground::Limits),
) -> Option<Finding> {
    let stated_m = over.sensor.z - over.expected_m?;
    if over.is_base || stated_m < limits.min_height_m {
        return None;
    }
    let sides = ground::sides(world, clouds, &over.sensor);
    let grounds: Vec<Ground> = sides
        .iter()
        .filter_map(|sides| ground::ground(sides, &up.is_ground()))
        .collect();
    // z up, as in a base.
    if up.agreed(clouds, &grounds).ok()? != 0 {
        return None;
    }
    let heights: Vec<f64> = grounds.iter().map(|ground| ground.plane.height_m).collect();
    let seen_m = median(&heights)?;
    ((seen_m - stated_m).abs() <= limits.class_off_m).then(|| {
        let message = format!(
            "`{}`: mounting is applied twice (points that name `{}` are already in `{}`)",
            clouds.topic.topic,
            clouds
                .frame()
                .map_or_else(String::new, |frame| frame.as_str().to_owned()),
            over.base
        );
        Finding::error(subject, message, clouds.place())
            .likely()
            .relation("twice")
            .detail(format!(
                "The ground in the cloud is where it is in `{}`, not {stated_m:.2} m below the lidar. TF applies the mounting transform once more.",
                over.base
            ))
            .measured(
                Measured::new(
                    "height of the lidar above the ground, if the points are in the base",
                    seen_m,
                    "m",
                )
                .samples(grounds.len() as u64),
            )
            .measured(Measured::new(
                "height of the lidar above the ground, by the transforms",
                stated_m,
                "m",
            ))
            .help(format!(
                "set the `frame_id` of the cloud to `{}`, or publish the points as the lidar measured them",
                over.base
            ))
    })
}

fn judge_tilt(
    world: &Estimates,
    clouds: &Clouds,
    (over, grounds): (&LidarMount, &[&Ground]),
    limits: &Limits,
    out: &mut Judge,
) {
    let subject = clouds.subject("level of the ground");
    let way_m = way_m(&Motion::of(world), clouds);
    if way_m < limits.min_way_m {
        let why = format!(
            "the platform moved only {way_m:.0} m, {} m are needed to distinguish a sloping ground from a tilted sensor",
            limits.min_way_m
        );
        return out.too_little(subject, why);
    }
    let mut logged = clouds.evidence.samples.iter().map(|sample| sample.at.log_ns);
    let lasts_s = match (logged.next(), logged.next_back()) {
        (Some(first), Some(last)) => last.saturating_sub(first) as f64 * 1e-9,
        _ => 0.0,
    };
    if lasts_s < limits.min_lasts_s {
        let why = format!(
            "the clouds cover only {lasts_s:.0} s, {} s are needed to distinguish a banked road from a tilted sensor",
            limits.min_lasts_s
        );
        return out.too_little(subject, why);
    }
    let normals: Vec<Vector3<f64>> = grounds
        .iter()
        .map(|ground| over.mount.rotation * ground.plane.normal)
        .collect();
    let part = |axis: usize| normals.iter().map(|normal| normal[axis]).collect::<Vec<_>>();
    let ([Some(x), Some(y)], [Some(spread_x), Some(spread_y)]) = (
        [0, 1].map(|axis| median(&part(axis))),
        [0, 1].map(|axis| mad(&part(axis))),
    ) else {
        return;
    };
    let tilt_deg = x.hypot(y).asin().to_degrees();
    let sigma_deg = (spread_x.hypot(spread_y) / (normals.len() as f64).sqrt()).to_degrees();
    let measured = Measured::new("tilt of the ground", tilt_deg, "deg")
        .turn()
        .limit(limits.max_tilt_deg)
        .spread(sigma_deg)
        .samples(normals.len() as u64);
    if tilt_deg <= limits.max_tilt_deg {
        return out.pass(subject, [measured]);
    }
    if tilt_deg <= limits.max_tilt_deg + limits.sigmas * sigma_deg {
        let why = format!(
            "the ground is tilted by {tilt_deg:.1} +- {sigma_deg:.1} deg, {} deg are allowed",
            limits.max_tilt_deg
        );
        return out.too_little(subject, why);
    }
    // The rotation from the normal back to z, to first order: with r more roll than in TF, the normal is Rx(-r) z.
    let (roll_deg, pitch_deg) = (y.asin().to_degrees(), (-x).asin().to_degrees());
    let message = format!(
        "`{}`: ground is tilted by {tilt_deg:.1} deg in `{}`",
        clouds.topic.topic, over.base
    );
    let lidar = clouds.frame().unwrap_or_else(|| over.base.clone());
    let finding = Finding::warning(subject, message, clouds.place())
        .likely()
        .relation("tilted")
        .detail(format!(
            "The tilt stays throughout the recording. If the ground was level, the mounting is missing a roll of {roll_deg:+.1} deg and a pitch of {pitch_deg:+.1} deg."
        ))
        .measured(measured)
        .help(format!(
            "if ground and platform were level, rotate the mounting `{0}` -> `{lidar}` by a roll of {roll_deg:+.1} deg and a pitch of {pitch_deg:+.1} deg \
             about the axes of `{0}`, and keep the translation; if not, calibrate the mounting",
            over.base
        ));
    let finding = clouds.once_per_lidar(world, finding);
    out.fail(with_mounting(world, [&over.base, &lidar], finding));
}

/// Approximate extent of the platform's motion, metres.
fn way_m(motion: &Motion, clouds: &Clouds) -> f64 {
    let Some(bag) = motion.bags.get(clouds.index) else {
        return 0.0;
    };
    let tracks = bag.tracks(|_| false).asked;
    let extent = |places: &mut dyn Iterator<Item = Vector3<f64>>| {
        let mut bounds: Option<(Vector3<f64>, Vector3<f64>)> = None;
        for place in places {
            let (low, high) = bounds.get_or_insert((place, place));
            *low = low.inf(&place);
            *high = high.sup(&place);
        }
        bounds.map_or(0.0, |(low, high)| (high - low).xy().norm())
    };
    tracks
        .iter()
        .map(|track| extent(&mut track.stretches.iter().flatten().map(|(_, place)| *place)))
        .fold(0.0, f64::max)
}
