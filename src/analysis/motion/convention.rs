//! The convention that a stream is expressed in, by the configuration or by frame names, and its conversion to that of ROS.
//!
//! Rows are converted before anything is measured: data that follow their declared convention are healthy, and others show
//! their fault. Must not judge.
//!
//! Sources: REP-103 (ENU, FLU; suffix `_ned`), REP-145 (`imu_link_ned`).

use nalgebra::{Matrix6, Quaternion, UnitQuaternion, Vector3};

use crate::analysis::names;
use crate::math::constants::AxisTurn;
use crate::source::{Place, SourceId};
use crate::world::conventions::{
    AppliedConvention, BodyAxes, Convention, QuaternionAlgebra, QuaternionOrder, WorldAxes,
};
use crate::world::motion::{InertialRow, OrientationRow, PoseRow, Twist, TwistRow};
use crate::world::{FrameId, World};

use super::mount::Mount;

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(crate) enum MovingFrame<'a> {
    /// The frame in the header: a sensor's.
    Frame,
    /// The child, if one is named; the header's frame is a world.
    Child(Option<&'a FrameId>),
}

/// The convention of a stream, and its source.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct StreamConvention {
    /// The declared convention; empty for a stream in that of ROS.
    pub(crate) convention: Convention,
    /// Its source: `` `frames-lint.yaml:4` declares `` or `` the name of `odom_ned` says ``.
    pub(crate) says: String,
    /// Whether the configuration declares it.
    pub(crate) is_declared: bool,
    /// Where.
    pub(crate) place: Option<Place>,
}

impl StreamConvention {
    /// The convention of the stream of a topic, or of TF. The configuration has precedence over names.
    pub(crate) fn of(
        world: &World,
        source: SourceId,
        topic: &str,
        frame: Option<&FrameId>,
        moving: MovingFrame<'_>,
    ) -> Self {
        let child = match moving {
            MovingFrame::Frame => None,
            MovingFrame::Child(child) => child,
        };
        let frames: Vec<&FrameId> = frame.into_iter().chain(child).collect();
        match world.declared(source, topic, &frames) {
            Some(AppliedConvention {
                convention,
                origin,
                place,
            }) => Self {
                convention,
                says: format!("`{origin}` declares"),
                is_declared: true,
                place,
            },
            None => Self::by_names(frame, moving),
        }
    }

    /// The convention by frame names.
    fn by_names(frame: Option<&FrameId>, moving: MovingFrame<'_>) -> Self {
        let has = |frame: Option<&FrameId>, word: &str| frame.is_some_and(|frame| frame.has_token(word));
        let is_frd = |frame: Option<&FrameId>| has(frame, "frd") || has(frame, "ned");
        let world = (has(frame, "ned").then_some(WorldAxes::Ned)).or(has(frame, "nwu").then_some(WorldAxes::Nwu));
        let moving = match moving {
            MovingFrame::Frame => frame,
            MovingFrame::Child(child) => child,
        };
        let body = is_frd(moving).then_some(BodyAxes::Frd);
        let named = if world.is_some() { frame } else { moving };
        match (world.is_some() || body.is_some(), named) {
            (true, Some(named)) => Self {
                convention: Convention {
                    world,
                    body,
                    ..Convention::default()
                },
                says: format!("the name of `{named}` says"),
                ..Self::default()
            },
            _ => Self::default(),
        }
    }

    /// Ignores the body's axes if TF itself rotates the moving frame: the data are expressed in that frame as it is.
    pub(crate) fn without_turn_of(mut self, mount: Option<&Mount>) -> Self {
        if mount.is_some_and(Mount::is_upside_down) {
            self.convention.body = None;
        }
        self
    }

    /// With a NED world, for a body that alone is declared as FRD.
    pub(crate) fn with_ned(mut self) -> Self {
        self.convention.world = Some(WorldAxes::Ned);
        self
    }

    /// Whether the body is declared as FRD, and the world is not declared.
    pub(crate) fn is_of_body_alone(&self) -> bool {
        self.convention.body == Some(BodyAxes::Frd) && self.convention.world.is_none()
    }

    /// Whether the data are converted.
    pub(crate) fn converts(&self) -> bool {
        let convention = &self.convention;
        !self
            .turn_of_world()
            .is_none_or(|turn| turn == UnitQuaternion::identity())
            || convention.body == Some(BodyAxes::Frd)
            || convention.order == Some(QuaternionOrder::Wxyz)
            || convention.algebra == Some(QuaternionAlgebra::Jpl)
    }

    /// Whether the world is NED: the fault `ned-frd` would undo the conversion.
    pub(crate) fn is_ned(&self) -> bool {
        self.convention.world == Some(WorldAxes::Ned)
    }

    /// Whether the configuration itself declares the world, and so the zero of yaw.
    pub(crate) fn declares_world(&self) -> bool {
        self.is_declared && self.convention.world.is_some()
    }

    /// A covariance of position and orientation, of a pose or of a twist, in the axes of ROS: row-major 6x6, `M C Mᵀ` block by
    /// block. Of another length it stays as it is.
    pub(crate) fn covariance(&self, values: &[f64], is_twist: bool) -> Vec<f64> {
        let turn = if is_twist {
            self.turn_of_body()
        } else {
            self.turn_of_world()
        };
        let (Some(turn), 36) = (turn, values.len()) else {
            return values.to_vec();
        };
        let m = *turn.to_rotation_matrix().matrix();
        let mut both = Matrix6::zeros();
        both.fixed_view_mut::<3, 3>(0, 0).copy_from(&m);
        both.fixed_view_mut::<3, 3>(3, 3).copy_from(&m);
        let turned = both * Matrix6::from_row_slice(values) * both.transpose();
        turned.transpose().as_slice().to_vec()
    }

    /// `enu_from_world`.
    fn turn_of_world(&self) -> Option<UnitQuaternion<f64>> {
        Some(match self.convention.world? {
            WorldAxes::Enu => UnitQuaternion::identity(),
            WorldAxes::Ned => AxisTurn::NedEnu.quaternion(),
            WorldAxes::Nwu => AxisTurn::Z90.quaternion(),
        })
    }

    /// `flu_from_body`.
    fn turn_of_body(&self) -> Option<UnitQuaternion<f64>> {
        (self.convention.body == Some(BodyAxes::Frd)).then(|| AxisTurn::FluFrd.quaternion())
    }

    /// Slots `x y z w` of `enu_from_flu`; the norm is kept.
    fn orientation(&self, slots: [f64; 4]) -> [f64; 4] {
        let [a, b, c, d] = slots;
        let mut q = match self.convention.order {
            Some(QuaternionOrder::Wxyz) => Quaternion::new(a, b, c, d),
            _ => Quaternion::new(d, a, b, c),
        };
        if self.convention.algebra == Some(QuaternionAlgebra::Jpl) {
            q = q.conjugate();
        }
        if let Some(turn) = self.turn_of_world() {
            q = *turn.quaternion() * q;
        }
        if let Some(turn) = self.turn_of_body() {
            // `body_from_flu` and `flu_from_body` are equal.
            q *= *turn.quaternion();
        }
        [q.i, q.j, q.k, q.w]
    }

    fn in_world(&self, vector: [f64; 3]) -> [f64; 3] {
        turned(self.turn_of_world(), vector)
    }

    fn in_body(&self, vector: [f64; 3]) -> [f64; 3] {
        turned(self.turn_of_body(), vector)
    }
}

fn turned(turn: Option<UnitQuaternion<f64>>, vector: [f64; 3]) -> [f64; 3] {
    turn.map_or(vector, |turn| (turn * Vector3::from(vector)).into())
}

/// A row that can be converted to another convention.
pub(crate) trait Convert {
    /// Whether the header's frame is the moving one, not the world's.
    const IS_SENSOR: bool;

    /// Converts the row to the convention of ROS. `frame` is the one in its header.
    fn convert(&mut self, expressed_in: &StreamConvention, frame: Option<&FrameId>);
}

impl Convert for InertialRow {
    const IS_SENSOR: bool = true;

    fn convert(&mut self, expressed_in: &StreamConvention, _: Option<&FrameId>) {
        self.orientation = expressed_in.orientation(self.orientation);
        self.angular_velocity = expressed_in.in_body(self.angular_velocity);
        self.linear_acceleration = expressed_in.in_body(self.linear_acceleration);
    }
}

impl Convert for OrientationRow {
    const IS_SENSOR: bool = true;

    fn convert(&mut self, expressed_in: &StreamConvention, _: Option<&FrameId>) {
        self.orientation = expressed_in.orientation(self.orientation);
    }
}

impl Convert for PoseRow {
    const IS_SENSOR: bool = false;

    fn convert(&mut self, expressed_in: &StreamConvention, _: Option<&FrameId>) {
        self.position = expressed_in.in_world(self.position);
        self.orientation = expressed_in.orientation(self.orientation);
        self.twist = self.twist.map(|twist| Twist {
            linear: expressed_in.in_body(twist.linear),
            angular: expressed_in.in_body(twist.angular),
        });
    }
}

impl Convert for TwistRow {
    const IS_SENSOR: bool = true;

    fn convert(&mut self, expressed_in: &StreamConvention, frame: Option<&FrameId>) {
        // A velocity is expressed in the header's frame.
        let is_of_world = frame.is_some_and(names::is_world) || expressed_in.turn_of_body().is_none();
        let turn = if is_of_world {
            expressed_in.turn_of_world()
        } else {
            expressed_in.turn_of_body()
        };
        self.twist = Twist {
            linear: turned(turn, self.twist.linear),
            angular: turned(turn, self.twist.angular),
        };
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::indexing_slicing)]
    use super::*;
    use crate::math::rotation::from_rpy;

    fn expressed_in(world: Option<WorldAxes>, body: Option<BodyAxes>) -> StreamConvention {
        StreamConvention {
            convention: Convention {
                world,
                body,
                ..Convention::default()
            },
            ..StreamConvention::default()
        }
    }

    fn slots(q: UnitQuaternion<f64>) -> [f64; 4] {
        [q.i, q.j, q.k, q.w]
    }

    fn same(a: [f64; 4], b: [f64; 4]) -> bool {
        let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        (dot.abs() - 1.0).abs() < 1e-12
    }

    /// For Euler angles ZYX, `yaw_enu = pi/2 - yaw_ned`, `pitch_enu = -pitch_ned`, `roll_enu = roll_ned`.
    #[test]
    fn angles_of_ned_and_frd_become_those_of_enu_and_flu() {
        let (roll, pitch, yaw) = (0.2, -0.1, 0.7);
        let ned = from_rpy(roll, pitch, yaw);
        let enu = from_rpy(roll, -pitch, std::f64::consts::FRAC_PI_2 - yaw);
        let both = expressed_in(Some(WorldAxes::Ned), Some(BodyAxes::Frd));
        assert!(same(both.orientation(slots(ned)), slots(enu)));
    }

    #[test]
    fn north_and_west_become_the_second_and_the_negative_first_axis() {
        let nwu = expressed_in(Some(WorldAxes::Nwu), None);
        let [east, north, up] = nwu.in_world([5.0, 2.0, 1.0]);
        assert!((east + 2.0).abs() < 1e-12 && (north - 5.0).abs() < 1e-12 && (up - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_covariance_is_converted_to_the_axes_of_ros() {
        let mut values = vec![0.0; 36];
        // North, east, down; roll, pitch, yaw; north with east.
        for (at, value) in [
            (0, 4.0),
            (7, 1.0),
            (14, 9.0),
            (21, 0.1),
            (28, 0.2),
            (35, 0.3),
            (1, 0.5),
            (6, 0.5),
            (2, 0.7),
            (12, 0.7),
        ] {
            values[at] = value;
        }
        let ned = expressed_in(Some(WorldAxes::Ned), None);
        let enu = ned.covariance(&values, false);
        let near = |at: usize, value: f64| assert!((enu[at] - value).abs() < 1e-12, "{at}: {}", enu[at]);
        for (at, value) in [
            (0, 1.0),
            (7, 4.0),
            (14, 9.0),
            (21, 0.2),
            (28, 0.1),
            (35, 0.3),
            (1, 0.5),
            (8, -0.7),
        ] {
            near(at, value);
        }
        assert_eq!(ned.covariance(&values, true), values);
    }

    #[test]
    fn names_declare_the_world_and_the_body() {
        let of = |frame: &str, child: Option<&str>| {
            let child = child.map(FrameId::new);
            let moving = child
                .as_ref()
                .map_or(MovingFrame::Frame, |child| MovingFrame::Child(Some(child)));
            StreamConvention::by_names(Some(&FrameId::new(frame)), moving)
                .convention
                .words()
        };
        assert_eq!(of("odom_ned", Some("base_link_frd")), "world NED, body FRD");
        assert_eq!(of("odom_ned", Some("base_link")), "world NED");
        assert_eq!(of("imu_link_ned", None), "world NED, body FRD");
        assert_eq!(of("base_link_frd", None), "body FRD");
        assert_eq!(of("odom_combined", Some("base_link")), "");
    }
}
