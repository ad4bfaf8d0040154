//! CAMERA06: the direction of a camera's extrinsics in a file, compared with the transforms of the robot.

use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::analysis::names;
use crate::rules::prelude::*;
use crate::source::Confidence;
use crate::world::{Claim, ClaimKind, FrameId, World};

pub(crate) struct CameraExtrinsicDirection;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    off_m: f64,
    off_deg: f64,
    away_m: f64,
    upright_deg: f64,
    tilted_deg: f64,
}

/// What a name in a file can mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Camera,
    Lidar,
    Imu,
    Base,
}

/// Further words for lidars in calibration files.
const LIDARS: &[&str] = &["velo", "lid", "livox", "hesai", "pandar", "os"];

impl Kind {
    fn of(name: &FrameId) -> Option<Self> {
        if name.has_token("optical") || names::has_word(name, names::CAMERAS) {
            Some(Self::Camera)
        } else if names::has_word_of(name, &[names::LIDARS, names::LIDAR_MAKERS, LIDARS]) {
            Some(Self::Lidar)
        } else if names::has_word(name, &["imu"]) {
            Some(Self::Imu)
        } else if names::is_base(name) {
            Some(Self::Base)
        } else {
            None
        }
    }
}

impl Rule for CameraExtrinsicDirection {
    const NEEDS: &'static [Need] = &[Need::Calibration];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let of_robot = LazyCell::new(|| RobotFrames::new(world));
        for claim in &world.claims {
            let ClaimKind::File { .. } = claim.kind else { continue };
            if !(claim.has_rotation && claim.has_translation) {
                continue;
            }
            if let (Some(pose), Some((target, source))) = (claim.pose, sides(world, claim)) {
                judge_claim(
                    (world, &of_robot),
                    claim,
                    &pose.isometry(),
                    (&target, &source),
                    limits,
                    out,
                );
            }
        }
    }
}

/// The two names that a claim is about, one of them a camera's: those of its frames, or, where it has none, those in its keys or in
/// the name of its file.
fn sides(world: &World, claim: &Claim) -> Option<(FrameId, FrameId)> {
    if let Some((target, source)) = &claim.frames {
        let is_camera = [target, source].map(|name| Kind::of(name) == Some(Kind::Camera));
        return is_camera
            .contains(&true)
            .then(|| (target.canonical(), source.canonical()));
    }
    let path = world.path(claim.place.source);
    let file = path.rsplit('/').next().unwrap_or_default();
    let stem = file.split('.').next().unwrap_or_default();
    let tokens = [FrameId::new(&claim.label).tokens(), FrameId::new(stem).tokens()].concat();
    let of = |wanted: Kind| {
        let mut known = tokens.iter().map(FrameId::new);
        known.find(|name| Kind::of(name) == Some(wanted))
    };
    let camera = of(Kind::Camera)?;
    let other = [Kind::Lidar, Kind::Imu, Kind::Base].into_iter().find_map(of)?;
    Some((camera, other))
}

/// The robot's frames by what names in files can mean.
struct RobotFrames<'w> {
    frames: &'w BTreeSet<FrameId>,
    of_kind: BTreeMap<Kind, Vec<&'w FrameId>>,
    numbered: BTreeMap<(Kind, String), Vec<&'w FrameId>>,
}

impl<'w> RobotFrames<'w> {
    fn new(world: &'w World) -> Self {
        let frames = &world.graph().frames;
        let (mut of_kind, mut numbered) = (BTreeMap::new(), BTreeMap::new());
        for frame in frames {
            let named = Kind::of(frame).filter(|kind| matches!(kind, Kind::Lidar | Kind::Imu));
            let is_camera = names::optical_stem(frame).is_some();
            let is_base = names::standard(frame).is_some_and(|(_, kind)| kind == names::Standard::Base);
            let kinds = [named, is_camera.then_some(Kind::Camera), is_base.then_some(Kind::Base)];
            for kind in kinds.into_iter().flatten() {
                of_kind.entry(kind).or_insert_with(Vec::new).push(frame);
                if let Some(digits) = digits(frame) {
                    numbered.entry((kind, digits)).or_insert_with(Vec::new).push(frame);
                }
            }
        }
        Self {
            frames,
            of_kind,
            numbered,
        }
    }

    /// The one frame that a name in a file can mean.
    fn meant(&self, name: &FrameId) -> Result<FrameId, String> {
        if self.frames.contains(name) {
            return Ok(name.clone());
        }
        let Some(kind) = Kind::of(name) else {
            return Err(format!(
                "`{name}` is no frame of the robot, and its name does not show what it is: name it with `aliases:` in frames-lint.yaml"
            ));
        };
        match self.of_kind.get(&kind).map_or(&[][..], Vec::as_slice) {
            [one] => Ok((*one).clone()),
            [] => Err(format!(
                "`{name}` is no frame of the robot, which has none of this kind either"
            )),
            several => match digits(name)
                .and_then(|digits| self.numbered.get(&(kind, digits)))
                .map(Vec::as_slice)
            {
                Some([one]) => Ok((*one).clone()),
                _ => Err(format!(
                    "`{name}` is no frame of the robot, and may be any of {}: name it with `aliases:` in frames-lint.yaml",
                    several.len()
                )),
            },
        }
    }
}

/// The number in a name: 0 of `cam0`, `camera_0_optical_frame`.
fn digits(name: &FrameId) -> Option<String> {
    let digits: String = name.as_str().chars().filter(char::is_ascii_digit).collect();
    (!digits.is_empty()).then_some(digits)
}

/// How far y of a camera's image is from down in a lidar's axes (z up), as written and after inversion, degrees. `None` for other pairs: axes
/// of IMUs vary, a body may be one (`T_B_C`), and links of cameras have no optical axes.
fn tilts_deg((target, source): (&FrameId, &FrameId), stated: &Isometry3<f64>) -> Option<[f64; 2]> {
    let is_link = |name: &FrameId| name.has_token("link");
    let is_target = match [target, source].map(Kind::of) {
        [Some(Kind::Camera), Some(Kind::Lidar)] if !is_link(target) => true,
        [Some(Kind::Lidar), Some(Kind::Camera)] if !is_link(source) => false,
        _ => return None,
    };
    let other_from_camera = if is_target {
        stated.rotation.inverse()
    } else {
        stated.rotation
    };
    let tilt = |other_from_camera: UnitQuaternion<f64>| {
        let y = other_from_camera * Vector3::y();
        y.angle(&-Vector3::z()).to_degrees()
    };
    Some([tilt(other_from_camera), tilt(other_from_camera.inverse())])
}

/// Without a robot, by what is up: a camera stands upright as written, or only after inversion.
fn judge_tilt(
    claim: &Claim,
    subject: String,
    (target, source): (&FrameId, &FrameId),
    [as_read, inverse]: [f64; 2],
    limits: &Limits,
    out: &mut Judge,
) {
    let measured = [
        Measured::new("tilt as written", as_read, "deg").limit(limits.upright_deg),
        Measured::new("tilt after inversion", inverse, "deg").limit(limits.upright_deg),
    ];
    if as_read <= limits.upright_deg {
        return out.pass(subject, measured);
    }
    if inverse > limits.upright_deg || as_read < limits.tilted_deg {
        let why = format!(
            "no robot is described, and the camera is tilted by {as_read:.0} deg as written, {inverse:.0} deg inverted (at most {} deg needed)",
            limits.upright_deg
        );
        return out.too_little(subject, why);
    }
    let message = format!(
        "`{}` is inverted: as written the camera is tilted by {as_read:.0} deg, inverted it stands upright",
        claim.label
    );
    let upright = if Kind::of(target) == Some(Kind::Camera) {
        source
    } else {
        target
    };
    let detail = format!("y of a camera's image points down, z of `{upright}` up.");
    out.fail(
        inverted(claim, subject, message, (target, source))
            .detail(detail)
            .measured(measured),
    );
}

/// The finding that a stated transform takes points the other way.
fn inverted(claim: &Claim, subject: String, message: String, (target, source): (&FrameId, &FrameId)) -> Finding {
    Finding::warning(subject, message, claim.place.clone())
        .confidence(claim.reading.min(Confidence::Likely))
        .relation("inverse")
        .unless_relation(codes::CROSS02)
        .unless_relation(codes::CROSS07)
        .help(format!(
            "invert the transform, so that points are taken from `{source}` to `{target}`; or exchange the names of the two frames"
        ))
}

fn judge_claim(
    (world, of_robot): (&World, &RobotFrames),
    claim: &Claim,
    stated: &Isometry3<f64>,
    (target, source): (&FrameId, &FrameId),
    limits: &Limits,
    out: &mut Judge,
) {
    let subject = format!("direction of `{}` in {}", claim.label, world.path(claim.place.source));
    let is_named = claim.frames.is_some();
    let graph = world.graph();
    if is_named && graph.rigid().between(target, source).is_some() {
        let why = "both names are frames of the robot: their transforms are compared as stated";
        return out.not_applicable(subject, why);
    }
    let (of_target, of_source) = match (of_robot.meant(target), of_robot.meant(source)) {
        (Ok(target), Ok(source)) => (target, source),
        (Err(why), _) | (_, Err(why)) => {
            let is_alone = is_named && of_robot.frames.is_empty();
            return match tilts_deg((target, source), stated).filter(|_| is_alone) {
                Some(tilts) => judge_tilt(claim, subject, (target, source), tilts, limits, out),
                None => out.missing(subject, why),
            };
        }
    };
    let Some(known) = graph.rigid().between(&of_target, &of_source) else {
        return out.missing(
            subject,
            format!("no rigid chain of transforms connects `{of_source}` and `{of_target}`"),
        );
    };
    let off = |reading: &Isometry3<f64>| {
        let off_m = (reading.translation.vector - known.translation.vector).norm();
        (off_m, reading.rotation.angle_to(&known.rotation).to_degrees())
    };
    let (as_read, inverse) = (off(stated), off(&stated.inverse()));
    let fits = |(off_m, off_deg): (f64, f64)| off_m <= limits.off_m && off_deg <= limits.off_deg;
    let measured = [
        Measured::new("translation difference as written", as_read.0, "m").limit(limits.off_m),
        Measured::new("rotation difference as written", as_read.1, "deg").limit(limits.off_deg),
        Measured::new("translation difference after inversion", inverse.0, "m").limit(limits.off_m),
        Measured::new("rotation difference after inversion", inverse.1, "deg").limit(limits.off_deg),
    ];
    let pair = format!("`{of_target}` from `{of_source}`");
    match (fits(as_read), fits(inverse)) {
        (true, false) => out.pass(subject, measured),
        // A file that does not say its direction has none that is wrong.
        (false, true) if !is_named => out.pass(subject, measured),
        (true, true) => {
            out.too_little(
                subject,
                format!("as read and inverted it is near {pair} of the robot: they cannot be distinguished"),
            );
        }
        (false, false) => {
            let far = if stated.translation.vector.norm() > limits.away_m {
                ", and outside of the vehicle"
            } else {
                ""
            };
            let why = format!(
                "it is {:.2} m and {:.0} deg off {pair} of the robot as read, {:.2} m and {:.0} deg inverted{far}: neither matches",
                as_read.0, as_read.1, inverse.0, inverse.1
            );
            out.too_little(subject, why);
        }
        (false, true) => {
            let message = format!(
                "`{}` is inverted: takes points from `{target}` to `{source}` ({:.2} m and {:.0} deg off)",
                claim.label, as_read.0, as_read.1
            );
            let named = |frame: &FrameId, name: &FrameId| {
                if frame == name {
                    format!("`{frame}`")
                } else {
                    format!("`{frame}` (`{name}` in the file)")
                }
            };
            let detail = format!(
                "URDF and TF of the robot take points from {} to {} by a transform that is {:.2} m and {:.1} deg from the inverse of \
                 the stated one.",
                named(&of_source, source),
                named(&of_target, target),
                inverse.0,
                inverse.1
            );
            out.fail(
                inverted(claim, subject, message, (target, source))
                    .detail(detail)
                    .measured(measured),
            );
        }
    }
}
