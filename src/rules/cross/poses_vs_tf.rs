//! CROSS08: poses on a topic compared with the moving transforms of TF, by how both move.

use nalgebra::{Isometry3, Translation3, Vector3};

use crate::analysis::cross::common_motion::{CommonMotion, Limits, Way, apart_m};
use crate::analysis::motion::{BagMotion, Motion, Stream};
use crate::analysis::names;
use crate::math::constants::AxisTurn;
use crate::rules::prelude::*;
use crate::world::motion::PoseRow;
use crate::world::{FrameId, World};

pub(crate) struct PosesVsTf;

impl Rule for PosesVsTf {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &Motion::of(world).bags {
            let topics = bag.poses.iter().filter(|poses| !poses.is_transform);
            for poses in topics.filter(|poses| !poses.guessed && !names::is_wish(&poses.topic)) {
                judge_poses(world, bag, poses, limits, out);
            }
        }
    }
}

fn judge_poses(world: &World, bag: &BagMotion, poses: &Stream<PoseRow>, limits: &Limits, out: &mut Judge) {
    let subject = format!("{} and TF", poses.subject);
    let moving = bag.poses.iter().filter(|tf| tf.is_transform && tf.is_way());
    let compared = moving.filter_map(|tf| Compared::of((world, bag), subject.clone(), poses, tf, limits));
    let Some(compared) = compared.max_by_key(|compared| compared.motion.count()) else {
        return out.missing(subject, "TF moves no frame that the poses can be of");
    };
    let count = compared.motion.count();
    if count < limits.min_motions {
        let least = limits.min_motions;
        let why = format!("both show {count} motions at the same times (at least {least} needed)");
        return out.too_little(compared.subject, why);
    }
    if compared.is_in_body() {
        compared.judge_in_body(limits, out);
    } else {
        compared.judge_in_world(limits, out);
    }
}

/// Poses of a topic beside the transform that moves the platform.
struct Compared<'m> {
    subject: String,
    poses: &'m Stream<PoseRow>,
    tf: &'m Stream<PoseRow>,
    bag: &'m BagMotion,
    motion: CommonMotion,
    /// The frames on the body that TF moves, with `body_from_frame`: the body first.
    frames: Vec<(FrameId, Isometry3<f64>)>,
}

/// One reading of the poses, with the share of the motion that it does not explain.
struct Reading {
    way: Way,
    /// The frame that moves.
    frame: FrameId,
    /// The axes that the poses have instead of those of the frame.
    turn: Option<AxisTurn>,
    body_from_frame: Isometry3<f64>,
    residual: f64,
}

/// Of frames and axes that explain the motion nearly alike, the frames of the platform come first.
const LEVER_ARM: f64 = 0.05;

impl Reading {
    fn rank(&self) -> f64 {
        self.residual + if self.turn.is_some() { LEVER_ARM } else { 0.0 }
    }

    fn words(&self) -> String {
        match (self.way, self.turn) {
            (Way::Inverse, _) => "the inverse".to_owned(),
            (Way::Mirrored, _) => "the mirror image".to_owned(),
            (Way::Direct, Some(turn)) => format!("axes rotated by {}", turn.word()),
            (Way::Direct, None) => format!("poses of `{}`", self.frame),
        }
    }
}

impl<'m> Compared<'m> {
    /// `None` where what the topic names is not on the body that this transform moves.
    fn of(
        (world, bag): (&World, &'m BagMotion),
        subject: String,
        poses: &'m Stream<PoseRow>,
        tf: &'m Stream<PoseRow>,
        limits: &Limits,
    ) -> Option<Self> {
        let body = tf.child.as_ref()?;
        let mut frames = vec![(body.clone(), Isometry3::identity())];
        let others = world.graph().reach(body, |edge| edge.is_rigid).into_iter();
        let others = others.filter(|(frame, _)| *frame != body);
        frames.extend(others.map(|(frame, body_from_frame)| (frame.clone(), body_from_frame)));
        let is_on_body = |name: &FrameId| frames.iter().any(|(frame, _)| frame == name);
        let is_expressed = |name: &FrameId| names::is_world(name) || is_on_body(name);
        let is_of_body = poses.child.as_ref().map_or(names::is_base(body), is_on_body);
        (is_of_body && poses.frame.as_ref().is_none_or(is_expressed)).then(|| Self {
            motion: CommonMotion::of(poses, tf, limits),
            subject,
            poses,
            tf,
            bag,
            frames,
        })
    }

    /// Whether the poses are expressed in a frame that the platform carries.
    fn is_in_body(&self) -> bool {
        let expressed = self.poses.frame.as_ref();
        expressed.is_some_and(|name| self.frames.iter().any(|(frame, _)| frame == name))
    }

    fn read(&self, way: Way, (frame, body_from_frame): &(FrameId, Isometry3<f64>), turn: Option<AxisTurn>) -> Reading {
        let axes = turn.map_or_else(Isometry3::identity, |turn| {
            Isometry3::from_parts(Translation3::identity(), turn.quaternion())
        });
        let body_from_frame = body_from_frame * axes;
        Reading {
            residual: self.motion.residual(way, &body_from_frame),
            way,
            frame: frame.clone(),
            turn,
            body_from_frame,
        }
    }

    /// The frame on the body with the smallest residual.
    fn best_frame(&self, way: Way) -> Option<Reading> {
        least(self.frames.iter().map(|frame| self.read(way, frame, None)))
    }

    /// The best of the other axes that a frame may have.
    fn best_axes(&self, frame: &(FrameId, Isometry3<f64>)) -> Option<Reading> {
        let turns = AxisTurn::all().iter();
        least(turns.map(|turn| self.read(Way::Direct, frame, Some(*turn))))
    }

    /// What is measured of a reading.
    fn measured(&self, what: &str, reading: &Reading, limits: &Limits) -> Measured {
        Measured::new(
            format!("unexplained share of the motion, {what}"),
            reading.residual,
            "1",
        )
        .limit(limits.equal)
        .samples(self.motion.count() as u64)
    }

    fn finding(&self, message: String, relation: &str) -> Finding {
        Finding::warning(&self.subject, message, self.poses.place())
            .likely()
            .relation(relation)
            .related(self.tf.place(), "the transform that moves")
    }

    /// Poses of the platform are expressed in no frame that it carries; those of other things are.
    fn judge_in_body(self, limits: &Limits, out: &mut Judge) {
        let expressed = self.poses.frame_name();
        let of_things = format!("poses in {expressed}, which the platform carries, of something that TF does not move");
        let [direct, inverse] = [Way::Direct, Way::Inverse].map(|way| self.best_frame(way));
        let Some(direct) = direct.filter(|direct| direct.residual <= limits.equal) else {
            return out.not_applicable(self.subject, of_things);
        };
        let seen = inverse.map_or(f64::INFINITY, |inverse| inverse.residual);
        if seen < limits.times_better * direct.residual {
            return out.not_applicable(self.subject, of_things);
        }
        let message = format!(
            "poses on `{}` are expressed in {expressed}, but move like poses in a world frame",
            self.poses.topic
        );
        let finding = self
            .finding(message, "header-frame")
            .detail(format!(
                "The platform carries {expressed}: a pose of the platform in it would not move."
            ))
            .help(format!(
                "set `header.frame_id` to the world frame of these poses, such as {}",
                self.tf.frame_name()
            ))
            .measured([self.measured("as poses in a world frame", &direct, limits)]);
        out.fail(finding);
    }

    fn judge_in_world(self, limits: &Limits, out: &mut Judge) {
        let stated = self.poses.child.as_ref();
        let stated = stated.and_then(|child| self.frames.iter().find(|(frame, _)| frame == child));
        let Some(body) = stated.or(self.frames.first()) else {
            return;
        };
        let named = match stated {
            Some(frame) => Some(self.read(Way::Direct, frame, None)),
            None => least(
                [self.best_frame(Way::Direct), self.best_axes(body)]
                    .into_iter()
                    .flatten(),
            ),
        };
        let Some(named) = named else { return };
        let measured = self.measured("as named", &named, limits);
        if named.residual <= limits.equal {
            return self.judge_up(&named, measured, limits, out);
        }
        let mut others = vec![
            self.read(Way::Inverse, body, None),
            self.read(Way::Mirrored, body, None),
        ];
        others.extend(stated.and_then(|_| self.best_frame(Way::Direct)));
        others.extend(stated.and_then(|frame| self.best_axes(frame)));
        others.sort_by(|a, b| a.rank().total_cmp(&b.rank()));
        let fits =
            |other: &&Reading| other.residual <= limits.equal && limits.times_better * other.residual <= named.residual;
        let mut fitting = others.iter().filter(fits);
        let Some(best) = fitting.next().filter(|_| named.residual >= limits.different) else {
            let why = format!(
                "{:.0} % of the motion is not that of TF, and neither the inverse, the mirror image nor other axes explain it",
                100.0 * named.residual
            );
            return out.too_little(self.subject, why);
        };
        let mut finding = self.wrong(&named, best);
        let alike: Vec<String> = fitting.map(Reading::words).collect();
        if !alike.is_empty() {
            finding = finding.detail(format!("These motions fit as well: {}.", alike.join(", ")));
        }
        out.fail(finding.measured([measured, self.measured("as in the message", best, limits)]));
    }

    /// Equal motions in worlds that do not agree what is up.
    fn judge_up(self, named: &Reading, measured: Measured, limits: &Limits, out: &mut Judge) {
        let up = self.motion.up(&named.body_from_frame.rotation);
        let tilt_deg = up.angle(&Vector3::z()).to_degrees();
        let tilt = Measured::new("angle between z of the two world frames", tilt_deg, "deg").limit(limits.tilted_deg);
        if tilt_deg <= limits.tilted_deg {
            return match self.inverted_correction(named, limits) {
                Some(finding) => out.fail(finding),
                None => out.pass(self.subject, [measured, tilt]),
            };
        }
        let (expressed, of_tf) = (self.poses.frame_name(), self.tf.frame_name());
        let is_camera = up.angle(&-Vector3::y()).to_degrees() <= limits.tilted_deg;
        let (axes, help) = if is_camera {
            (
                ", as of a camera (y down)",
                "rotate position and orientation from the axes of a camera: world_from_body = R * pose with R = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]",
            )
        } else {
            ("", "express position and orientation in a world frame with z up")
        };
        let message = format!(
            "poses on `{}`: z of {expressed} is {tilt_deg:.0} deg from z of TF's {of_tf}{axes}",
            self.poses.topic
        );
        let finding = self
            .finding(message, if is_camera { "optical" } else { "world-axes" })
            .detail("Both move alike in the axes of what moves; only their world frames differ.")
            .help(help);
        out.fail(finding.measured([tilt, measured]));
    }

    /// A finding, if TF in the frame of the poses is far from them, and near with the correction inverted.
    fn inverted_correction(&self, named: &Reading, limits: &Limits) -> Option<Finding> {
        let (world, moved) = (self.poses.frame.as_ref()?, self.tf.frame.as_ref()?);
        let correction = self.bag.transform(world, Some(moved))?;
        let [published_m, inverted_m] = apart_m(self.poses, [correction, self.tf], &named.body_from_frame)?;
        if published_m <= limits.apart_m || inverted_m * limits.times_better > published_m {
            return None;
        }
        let message = format!(
            "{} is inverted: TF is {published_m:.1} m from the poses on `{}`",
            correction.subject, self.poses.topic
        );
        let detail = format!(
            "In {}; with the inverse it would be {inverted_m:.1} m.",
            self.poses.frame_name()
        );
        let finding = self.finding(message, "inverse").detail(detail).help(format!(
            "publish the inverse: the transform of {} -> {} is the pose of {1} in {0}, world_from_body * odom_from_body^-1",
            correction.frame_name(),
            correction.child_name()
        ));
        let off = Measured::new("distance of TF from the poses", published_m, "m").limit(limits.apart_m);
        Some(finding.related(correction.place(), "the correction").measured([off]))
    }

    /// The finding that another reading explains the motion.
    fn wrong(&self, named: &Reading, best: &Reading) -> Finding {
        let (topic, tf) = (&self.poses.topic, &self.tf.subject);
        let name = &named.frame;
        let finding = match (best.way, best.turn) {
            (Way::Inverse, _) => self.inverse(),
            (Way::Mirrored, _) => self
                .finding(format!("poses on `{topic}` are the mirror image of {tf}"), "mirrored")
                .help("find which of the two has left-handed axes (compare with a map or GNSS), and negate y, roll and yaw there"),
            (Way::Direct, None) => self
                .finding(format!("poses on `{topic}` move like `{}`, not like `{name}`", best.frame), "other-frame")
                .help(format!(
                    "set `child_frame_id` to `{0}`, or convert the poses: world_from_{name} = world_from_{0} * {0}_from_{name}",
                    best.frame
                )),
            (Way::Direct, Some(turn)) => self
                .finding(
                    format!("poses on `{topic}` have other axes for `{name}` than TF ({})", turn.word()),
                    turn.word(),
                )
                .help(format!("rotate the orientations: world_from_{name} = pose * R^T, with R the rotation {}", turn.word())),
        };
        let severity = if best.way == Way::Direct && best.turn.is_none() {
            Severity::Warning
        } else {
            Severity::Error
        };
        Finding { severity, ..finding }
    }

    /// The finding that one of the two is the inverse: the velocity of the topic says which.
    fn inverse(&self) -> Finding {
        let (topic, tf) = (&self.poses.topic, &self.tf.subject);
        let [frame, child] = [self.tf.frame_name(), self.tf.child_name()];
        let in_tf = format!(
            "publish the transform with `header.frame_id` {frame} and `child_frame_id` {child} from the pose of {child} in {frame}, without inverting it"
        );
        let in_topic = "invert the poses of the topic: position -R^T t, orientation q^-1";
        let (help, which) = match self.motion.along_velocity() {
            Some([direct, inverse]) if direct > inverse.abs() => (
                in_tf,
                "The velocity on the topic agrees with its poses: TF is inverted.",
            ),
            Some([direct, inverse]) if inverse > direct.abs() => (
                in_topic.to_owned(),
                "The velocity on the topic contradicts its poses: these are inverted.",
            ),
            _ => (
                format!(
                    "if the poses of the topic move as the platform does (forward: x grows), {in_tf}; otherwise {in_topic}"
                ),
                "Which of the two is right, these data do not show.",
            ),
        };
        self.finding(format!("poses on `{topic}` are the inverse of {tf}"), "inverse")
            .detail(which)
            .help(help)
    }
}

/// The first with the smallest residual.
fn least(readings: impl Iterator<Item = Reading>) -> Option<Reading> {
    readings.min_by(|a, b| a.residual.total_cmp(&b.residual))
}
