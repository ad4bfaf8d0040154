//! Messages with poses and twists, the transforms that carry the same motion, and mistakes in them.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::faults::{Change, Family, Subject};
use crate::world::World;
use crate::world::bag::TfEdge;
use crate::world::claim::Pose;
use crate::world::content::{ContentEvidence, OdometryEvidence, StepAt, StepEvidence};
use crate::world::motion::{PoseRow, Series, Twist};

use super::covariances::{change_covariances, is_stated, join_constant, rotate6, spread_constant};
use super::streams::{MovingFrame, Stream};
use super::turns::{Oriented, diagonal, distance, is_same_orientation, is_same_vector, mirrored, rotation, turned};

/// Rows of a stream that two mistakes are compared on.
const COMPARED_ROWS: usize = 32;
/// The least root mean square of a velocity to the side, as a share of the speed: less is noise.
const ASIDE_SHARE: f64 = 0.03;
/// Lengths of a way that differ by less than this share are the same.
const SAME_LENGTH: f64 = 1e-3;

/// What a message with a pose states (`nav_msgs/Odometry`, `geometry_msgs/PoseStamped`, a transform of TF).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseMessage {
    /// Position of the child in the parent, metres.
    pub position: [f64; 3],
    /// The four slots `x y z w` of `parent_from_child`.
    pub orientation: [f64; 4],
    /// m/s, in the child; zeros where there is no twist.
    pub linear: [f64; 3],
    /// rad/s, in the child.
    pub angular: [f64; 3],
    /// Of position and rotation in the parent's axes, m² and rad², row-major.
    pub covariance: [f64; 36],
    /// Of the twist in the child's axes, row-major.
    pub twist_covariance: [f64; 36],
}

impl PoseMessage {
    fn of_row(row: &PoseRow, covariance: &[f64; 36]) -> Self {
        let twist = row.twist.unwrap_or(Twist {
            linear: [0.0; 3],
            angular: [0.0; 3],
        });
        Self {
            position: row.position,
            orientation: row.orientation,
            linear: twist.linear,
            angular: twist.angular,
            covariance: *covariance,
            twist_covariance: *covariance,
        }
    }

    /// The position multiplied by a matrix, the orientation left as it is.
    pub(super) fn change_position(&mut self, new_from_old: &Matrix3<f64>) {
        self.position = (new_from_old * Vector3::from(self.position)).into();
    }

    /// The velocity multiplied by a matrix.
    pub(super) fn change_linear(&mut self, new_from_old: &Matrix3<f64>) {
        self.linear = (new_from_old * Vector3::from(self.linear)).into();
    }

    /// The angular velocity multiplied by a matrix.
    pub(super) fn change_angular(&mut self, new_from_old: &Matrix3<f64>) {
        self.angular = (new_from_old * Vector3::from(self.angular)).into();
    }

    /// The pose of the parent in the child.
    pub(super) fn invert(&mut self) {
        let position = Translation3::from(Vector3::from(self.position));
        let altered = Isometry3::from_parts(position, rotation(self.orientation)).inverse();
        self.position = altered.translation.vector.into();
        self.orientation = turned(self.orientation, |stated| stated.inverse());
    }

    /// The velocity in the axes of the parent.
    pub(super) fn linear_in_parent(&mut self) {
        let parent_from_child = rotation(self.orientation).to_rotation_matrix();
        self.change_linear(parent_from_child.matrix());
    }

    /// The covariance of the pose in the axes of the child.
    pub(super) fn covariance_in_child(&mut self) {
        let child_from_parent = rotation(self.orientation).inverse().to_rotation_matrix();
        rotate6(
            &mut self.covariance,
            child_from_parent.matrix(),
            child_from_parent.matrix(),
        );
    }

    /// The covariance of the twist in the axes of the parent.
    pub(super) fn twist_covariance_in_parent(&mut self) {
        let parent_from_child = rotation(self.orientation).to_rotation_matrix();
        rotate6(
            &mut self.twist_covariance,
            parent_from_child.matrix(),
            parent_from_child.matrix(),
        );
    }

    /// Whether two messages state the same.
    fn is_same(&self, other: &Self) -> bool {
        is_same_orientation(self.orientation, other.orientation)
            && is_same_vector(self.position, other.position)
            && is_same_vector(self.linear, other.linear)
            && is_same_vector(self.angular, other.angular)
    }
}

impl Oriented for PoseMessage {
    fn orientation(&mut self) -> &mut [f64; 4] {
        &mut self.orientation
    }

    fn change_world(&mut self, new_from_old: &Rotation3<f64>) {
        self.change_position(new_from_old.matrix());
        self.orientation = turned(self.orientation, |stated| UnitQuaternion::from(*new_from_old) * stated);
        rotate6(&mut self.covariance, new_from_old.matrix(), new_from_old.matrix());
    }

    fn change_body(&mut self, old_from_new: &Rotation3<f64>) {
        self.orientation = turned(self.orientation, |stated| stated * UnitQuaternion::from(*old_from_new));
        let new_from_old = old_from_new.inverse();
        self.change_linear(new_from_old.matrix());
        self.change_angular(new_from_old.matrix());
        rotate6(&mut self.twist_covariance, new_from_old.matrix(), new_from_old.matrix());
    }

    fn mirror(&mut self) {
        let (polar, axial) = (diagonal(1.0, -1.0, 1.0), diagonal(-1.0, 1.0, -1.0));
        self.change_position(&polar);
        self.orientation = mirrored(self.orientation);
        self.change_linear(&polar);
        self.change_angular(&axial);
        rotate6(&mut self.covariance, &polar, &axial);
        rotate6(&mut self.twist_covariance, &polar, &axial);
    }
}

/// What the messages must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PoseNeed {
    /// Nothing.
    Anything,
    /// An orientation of the base, or of a frame that is not named, that changes.
    Orientation,
    /// An orientation of the base that changes.
    Base,
    /// A twist.
    Twist,
    /// A velocity to the side.
    Aside,
    /// A covariance of the pose.
    Covariance,
    /// A covariance of the twist.
    TwistCovariance,
}

/// A relation, and what the mistake of that name does to a message.
pub(super) type KnownPoseMistake = (&'static str, fn(&mut PoseMessage));

/// A mistake in poses or twists.
pub(super) struct PoseChange {
    /// What the messages must have.
    pub(super) needs: PoseNeed,
    /// What it does to a message. Rows are means of messages, number by number.
    pub(super) change: fn(&mut PoseMessage),
    /// Mistakes that may change the same messages in the same way.
    pub(super) known: &'static [KnownPoseMistake],
}

impl Change for PoseChange {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        moving_bodies(world)
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let Some(stream) = Stream::of(subject) else {
            return false;
        };
        self.needs.is_met(world, stream) && change_poses(world, stream, |message, _| (self.change)(message))
    }

    fn same_as(&self, world: &World, subject: &Subject) -> Vec<&'static str> {
        let Some(stream) = Stream::of(subject) else {
            return Vec::new();
        };
        let rows: Vec<&PoseRow> = stream.pose_sections(world).flatten().collect();
        let step = rows.len().div_ceil(COMPARED_ROWS).max(1);
        let with = |change: fn(&mut PoseMessage)| {
            rows.iter().step_by(step).map(move |row| {
                let mut message = PoseMessage::of_row(row, &[0.0; 36]);
                change(&mut message);
                message
            })
        };
        let is_same = |other: fn(&mut PoseMessage)| with(self.change).zip(with(other)).all(|(a, b)| a.is_same(&b));
        if is_same(|_| {}) {
            return Vec::new();
        }
        let same = self.known.iter().filter(|(_, other)| is_same(*other));
        same.map(|(relation, _)| *relation).collect()
    }
}

/// Ways, from the first pose on, and velocities are longer by so many percent; shorter if that is negative.
pub(in crate::faults) struct ScaleChange {
    /// Of the length.
    pub(in crate::faults) percent: f64,
}

impl Change for ScaleChange {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        moving_bodies(world)
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let Some(stream) = Stream::of(subject) else {
            return false;
        };
        let longer = 1.0 + self.percent.abs() / 100.0;
        let factor = if self.percent < 0.0 { 1.0 / longer } else { longer };
        let first = stream.pose_sections(world).flatten().next();
        let Some(first) = first.map(|row| Vector3::from(row.position)) else {
            return false;
        };
        change_poses(world, stream, |message, _| {
            message.position = (first + (Vector3::from(message.position) - first) * factor).into();
            message.linear = message.linear.map(|value| value * factor);
        })
    }
}

/// The streams with poses of what moves, not of corrections between frames of the world.
fn moving_bodies(world: &World) -> Vec<Subject> {
    let streams =
        Stream::all(world).filter(|stream| stream.family == Family::Pose && stream.moving != MovingFrame::World);
    streams.map(Subject::from).collect()
}

impl PoseNeed {
    fn is_met(self, world: &World, stream: &Stream) -> bool {
        let is_stated = |field: &str| {
            stream
                .contents(world)
                .into_iter()
                .any(|content| is_stated(content, field))
        };
        let rows = || stream.pose_sections(world).flatten();
        let twists = || rows().filter_map(|row| row.twist);
        let turns = || {
            let first = rows().next().map(|row| row.orientation.map(f64::to_bits));
            rows().any(|row| Some(row.orientation.map(f64::to_bits)) != first)
        };
        match self {
            Self::Anything => true,
            Self::Orientation => turns() && matches!(stream.moving, MovingFrame::Base | MovingFrame::Unnamed),
            Self::Base => turns() && stream.moving == MovingFrame::Base,
            Self::Twist => twists().any(|twist| {
                let mut numbers = twist.linear.into_iter().chain(twist.angular);
                numbers.any(|value| value.is_finite() && value != 0.0)
            }),
            Self::Aside => {
                let squares = twists().map(|twist| twist.linear.map(|value| value * value));
                let [ahead, aside] = squares.fold([0.0, 0.0], |[a, b], [x, y, _]| [a + x, b + y]);
                aside > 0.0 && aside >= ASIDE_SHARE * ASIDE_SHARE * (ahead + aside)
            }
            Self::Covariance => is_stated("pose.covariance"),
            Self::TwistCovariance => is_stated("twist.covariance"),
        }
    }
}

/// Changes the poses and twists of a stream on topics and TF, as far as evidence has them. The second argument of the change is the log
/// time, nanoseconds. False if none of them changes.
pub fn change_poses(world: &mut World, stream: &Stream, mut change: impl FnMut(&mut PoseMessage, i64)) -> bool {
    let mut is_changed = false;
    stream.change_contents(world, |content| is_changed |= change_content(content, &mut change));
    for edge in stream.edges_mut(world) {
        is_changed |= change_edge(edge, &mut change);
    }
    is_changed
}

fn change_content(content: &mut ContentEvidence, change: &mut impl FnMut(&mut PoseMessage, i64)) -> bool {
    let mut is_changed = false;
    let before: Vec<PoseRow> = content.motion.poses.iter().flat_map(Series::rows).copied().collect();
    for (field, covariance_of) in [
        (
            "pose.covariance",
            (|altered: PoseMessage| altered.covariance) as fn(PoseMessage) -> [f64; 36],
        ),
        ("twist.covariance", |altered| altered.twist_covariance),
    ] {
        let moments = before.iter().map(|row| [row.stamp_ns, row.log_ns]);
        let only = spread_constant(content, field, moments);
        change_covariances::<36>(content, field, |sample, values| {
            let near = before.iter().min_by_key(|row| row.log_ns.abs_diff(sample.at.log_ns));
            let Some(near) = near else { return values };
            let mut message = PoseMessage::of_row(near, &values);
            change(&mut message, sample.at.log_ns);
            let new = covariance_of(message);
            is_changed |= !is_same_vector(new, values);
            new
        });
        if let Some(only) = only {
            join_constant(content, field, only);
        }
    }
    let Some(poses) = &mut content.motion.poses else {
        return is_changed;
    };
    let scale = change_series(poses, change);
    is_changed |= scale.is_changed;
    if let Some(OdometryEvidence {
        samples,
        steps,
        largest_speed_m_s,
        largest_turn_rad_s,
    }) = &mut content.odometry
    {
        for at in samples {
            change_pose(&mut at.pose, at.at.log_ns, change);
        }
        change_steps(steps, scale.way, change);
        *largest_speed_m_s *= scale.speed;
        *largest_turn_rad_s *= scale.turn;
    }
    is_changed
}

/// What a change did to a series of rows.
struct SeriesScale {
    is_changed: bool,
    /// Length of the way, after over before.
    way: f64,
    /// The largest speed, after over before.
    speed: f64,
    /// The largest angular speed, after over before.
    turn: f64,
}

fn change_series(series: &mut Series<PoseRow>, change: &mut impl FnMut(&mut PoseMessage, i64)) -> SeriesScale {
    let before = sizes(series);
    let mut is_changed = false;
    for row in series.stretches.iter_mut().flatten() {
        let message = PoseMessage::of_row(row, &[0.0; 36]);
        let mut altered = message;
        change(&mut altered, row.log_ns);
        (row.position, row.orientation) = (altered.position, altered.orientation);
        if row.twist.is_none() {
            (altered.linear, altered.angular) = (message.linear, message.angular);
        }
        row.twist = row.twist.map(|_| Twist {
            linear: altered.linear,
            angular: altered.angular,
        });
        is_changed |= !altered.is_same(&message);
    }
    let after = sizes(series);
    let ratio = |after: f64, before: f64| if before > 0.0 { after / before } else { 1.0 };
    SeriesScale {
        is_changed,
        way: ratio(after.0, before.0),
        speed: ratio(after.1, before.1),
        turn: ratio(after.2, before.2),
    }
}

/// Length of the way, metres, and the largest speed and angular speed, m/s and rad/s.
fn sizes(series: &Series<PoseRow>) -> (f64, f64, f64) {
    let pairs = series
        .stretches
        .iter()
        .flat_map(|rows| rows.iter().zip(rows.iter().skip(1)));
    let way = pairs
        .map(|(a, b)| distance(a.position, b.position))
        .filter(|step| step.is_finite());
    let largest = |of: fn(&Twist) -> [f64; 3]| {
        let twists = series.rows().filter_map(|row| row.twist);
        twists.map(|twist| Vector3::from(of(&twist)).norm()).fold(0.0, f64::max)
    };
    (way.sum(), largest(|twist| twist.linear), largest(|twist| twist.angular))
}

/// Changes a pose of evidence as the message that it is of.
fn change_pose(pose: &mut Pose, log_ns: i64, change: &mut impl FnMut(&mut PoseMessage, i64)) {
    let row = PoseRow {
        stamp_ns: 0,
        log_ns,
        position: pose.translation_m,
        orientation: pose.rotation_xyzw,
        twist: None,
    };
    let mut message = PoseMessage::of_row(&row, &[0.0; 36]);
    change(&mut message, log_ns);
    (pose.translation_m, pose.rotation_xyzw) = (message.position, message.orientation);
}

/// Changes the poses of conspicuous steps, and lengths where the way has another one.
fn change_steps(steps: &mut StepEvidence, way: f64, change: &mut impl FnMut(&mut PoseMessage, i64)) {
    let way = if (way - 1.0).abs() < SAME_LENGTH { 1.0 } else { way };
    for step in &mut steps.sample {
        step.distance_m *= way;
        step.surprise_m *= way;
    }
    let largest = steps.farthest.iter_mut().chain(&mut steps.widest);
    let largest = largest.chain(&mut steps.most_surprising).chain(&mut steps.first_undone);
    for StepAt { step, before, after } in largest {
        step.distance_m *= way;
        step.surprise_m *= way;
        for at in [before, after] {
            change_pose(&mut at.pose, at.at.log_ns, change);
        }
    }
}

fn change_edge(edge: &mut TfEdge, change: &mut impl FnMut(&mut PoseMessage, i64)) -> bool {
    let Some(motion) = &mut edge.motion else { return false };
    let scale = change_series(motion, change);
    for at in &mut edge.samples {
        change_pose(&mut at.pose, at.at.log_ns, change);
    }
    change_steps(&mut edge.steps, scale.way, change);
    let first = edge.samples.first().map(|sample| sample.pose);
    if let Some((sample, angle_rad, distance_m)) = &mut edge.extreme {
        change_pose(&mut sample.pose, sample.at.log_ns, change);
        if let Some(first) = first {
            *distance_m = distance(first.translation_m, sample.pose.translation_m);
            *angle_rad = rotation(first.rotation_xyzw).angle_to(&rotation(sample.pose.rotation_xyzw));
        }
    }
    scale.is_changed
}
