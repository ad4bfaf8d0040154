//! The constants against published numbers and closed forms. Only compiled for tests.
#![allow(clippy::unwrap_used, clippy::float_cmp, clippy::approx_constant)]

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Rotation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;

use super::constants::{AxisTurn, flu_frd, ned_enu, optical, optical_inverse, z180};
use super::rotation::{det, from_rpy, orthogonality_error, rotation_angle_between, to_rpy};

fn close(a: &Rotation3<f64>, b: &Rotation3<f64>) -> bool {
    (a.matrix() - b.matrix()).norm() < 1e-15
}

fn of(q: &UnitQuaternion<f64>) -> Rotation3<f64> {
    q.to_rotation_matrix()
}

#[test]
fn all_are_proper_and_their_two_forms_agree() {
    for &turn in AxisTurn::all() {
        let r = turn.rotation();
        assert!(
            orthogonality_error(r.matrix()) == 0.0 && det(r.matrix()) == 1.0,
            "{turn:?}"
        );
        assert!(close(&r, &of(&turn.quaternion())), "{turn:?}");
        assert!((turn.quaternion().norm() - 1.0).abs() < 1e-15);
    }
    for involution in [ned_enu(), flu_frd(), z180(), AxisTurn::Y180.rotation()] {
        assert_eq!(involution * involution, Rotation3::identity());
    }
    assert_eq!(optical() * optical_inverse(), Rotation3::identity());
    assert_eq!(optical() * optical() * optical(), Rotation3::identity());
}

#[test]
fn ned_enu_is_mavros_rpy_and_half_a_turn_about_the_diagonal() {
    // mavros ftf_frame_conversions.cpp: quaternion_from_rpy(M_PI, 0.0, M_PI_2).
    assert!(close(&ned_enu(), &of(&from_rpy(PI, 0.0, FRAC_PI_2))));
    let diagonal = Unit::new_normalize(Vector3::new(1.0, 1.0, 0.0));
    assert!(close(&ned_enu(), &Rotation3::from_axis_angle(&diagonal, PI)));
    let q = AxisTurn::NedEnu.quaternion();
    assert!((q.i - 0.7071).abs() < 1e-4 && (q.j - 0.7071).abs() < 1e-4 && q.k == 0.0 && q.w == 0.0);
    // North in NED is the second axis of ENU; down is minus the third.
    assert_eq!(ned_enu() * Vector3::x(), Vector3::y());
    assert_eq!(ned_enu() * Vector3::z(), -Vector3::z());
}

#[test]
fn optical_is_rep_103_and_a_third_of_a_turn() {
    assert!(close(&optical(), &of(&from_rpy(-FRAC_PI_2, 0.0, -FRAC_PI_2))));
    let q = AxisTurn::Optical.quaternion();
    assert_eq!([q.i, q.j, q.k, q.w], [-0.5, 0.5, -0.5, 0.5]);
    let axis = Unit::new_normalize(Vector3::new(-1.0, 1.0, -1.0));
    assert!(close(&optical(), &Rotation3::from_axis_angle(&axis, TAU / 3.0)));
    // What the camera looks at (optical z) is forward (x); image right (x) is -left; image down (y) is -up.
    assert_eq!(optical() * Vector3::z(), Vector3::x());
    assert_eq!(optical() * Vector3::x(), -Vector3::y());
    assert_eq!(optical() * Vector3::y(), -Vector3::z());
}

#[test]
fn the_quarter_and_half_turns_are_what_they_say() {
    let turns = [
        (AxisTurn::Z180, Vector3::z() * PI),
        (AxisTurn::Z90, Vector3::z() * FRAC_PI_2),
        (AxisTurn::ZMinus90, Vector3::z() * -FRAC_PI_2),
        (AxisTurn::FluFrd, Vector3::x() * PI),
        (AxisTurn::Y180, Vector3::y() * PI),
        (AxisTurn::X90, Vector3::x() * FRAC_PI_2),
        (AxisTurn::XMinus90, Vector3::x() * -FRAC_PI_2),
        (AxisTurn::Y90, Vector3::y() * FRAC_PI_2),
        (AxisTurn::YMinus90, Vector3::y() * -FRAC_PI_2),
    ];
    for (turn, vector) in turns {
        assert!(close(&turn.rotation(), &Rotation3::new(vector)), "{turn:?}");
    }
}

proptest! {
    /// Catalogue section 0: R_ENU<-FLU = P R_NED<-FRD F has yaw pi/2 - yaw, pitch -pitch, roll roll.
    #[test]
    fn attitude_from_ned_to_enu(roll in -3.1f64..3.1, pitch in -1.5f64..1.5, yaw in -3.1f64..3.1) {
        let ned_from_frd = from_rpy(roll, pitch, yaw);
        let enu_from_flu = AxisTurn::NedEnu.quaternion() * ned_from_frd * AxisTurn::FluFrd.quaternion();
        let expected = from_rpy(roll, -pitch, FRAC_PI_2 - yaw);
        prop_assert!(rotation_angle_between(&enu_from_flu, &expected) < 1e-12);
        let (r, p, y) = to_rpy(&enu_from_flu);
        prop_assert!((r - roll).abs() < 1e-9 && (p + pitch).abs() < 1e-9);
        prop_assert!((y - (FRAC_PI_2 - yaw)).rem_euclid(TAU).min((FRAC_PI_2 - yaw - y).rem_euclid(TAU)) < 1e-9);
    }
}
