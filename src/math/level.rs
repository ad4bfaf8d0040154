//! How far from level an orientation is, under two orders of its four numbers.
//!
//! Owns the tilt and what follows from many of them. Gives numbers and no verdict. Up and down are equal here: a body whose
//! z points down is level. Must not know which message held the numbers. Radians. Source: `rules/quat/quaternion-order-static.md`.

use nalgebra::UnitQuaternion;

use super::circular::difference;
use super::readings::Reading;
use super::stats::quantile;

/// The angle between the body's z and the vertical, 0..=pi/2: that to the nearer of up and down.
pub fn tilt(world_from_body: &UnitQuaternion<f64>) -> f64 {
    let q = world_from_body;
    // cos = 1 - 2 (x^2 + y^2), sin = 2 |(x, y)| |(z, w)|: by atan2, exact near level.
    let (across, along) = (q.i.hypot(q.j), q.k.hypot(q.w));
    (2.0 * across * along).atan2((along * along - across * across).abs())
}

/// The tilts of many orientations under one reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Nine tenths of them are tilted by no more than this, radians.
    pub tilt_rad: f64,
    /// One tenth of them is tilted by no more than this, radians.
    pub least_rad: f64,
    /// From the leftmost to the rightmost yaw, as far as they are within half a turn of the first, radians.
    pub turned_rad: f64,
    /// How many orientations counted.
    pub rows: usize,
}

/// The tilts of `world_from_sensor` quaternions in the slots x, y, z, w, of a body on which the sensor is rotated by
/// `body_from_sensor`. `None` where none of them is a rotation.
pub fn level(
    slots: impl IntoIterator<Item = [f64; 4]>,
    body_from_sensor: &UnitQuaternion<f64>,
    reading: Reading,
) -> Option<Level> {
    let (mut tilts, mut first, mut least, mut most) = (Vec::new(), None, 0.0_f64, 0.0_f64);
    for world_from_sensor in slots.into_iter().filter_map(|slots| reading.world_from_body(slots)) {
        let q = world_from_sensor * body_from_sensor.inverse();
        tilts.push(tilt(&q));
        // The twist about z alone, of a sensor that is upside down, rotated by half a turn about x: there z and w hold noise.
        let yaw = if q.i.hypot(q.j) > q.k.hypot(q.w) {
            2.0 * q.j.atan2(q.i)
        } else {
            2.0 * q.k.atan2(q.w)
        };
        let turned = difference(yaw, *first.get_or_insert(yaw));
        (least, most) = (least.min(turned), most.max(turned));
    }
    Some(Level {
        tilt_rad: quantile(&tilts, 0.9)?,
        least_rad: quantile(&tilts, 0.1)?,
        turned_rad: most - least,
        rows: tilts.len(),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::rotation::from_rpy;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn tilts_of_the_closed_form() {
        for (roll, pitch, expected) in [
            (0.0, 0.0, 0.0),
            (0.3, 0.0, 0.3),
            (0.0, -0.2, 0.2),
            (PI, 0.0, 0.0),
            (FRAC_PI_2, 0.0, FRAC_PI_2),
            (2.0, 0.0, PI - 2.0),
            (0.3, 0.4, (0.3_f64.cos() * 0.4_f64.cos()).acos()),
        ] {
            assert!(
                (tilt(&from_rpy(roll, pitch, 1.1)) - expected).abs() < 1e-9,
                "{roll} {pitch}"
            );
        }
    }

    #[test]
    fn a_level_drive_read_in_the_other_order_rolls_by_its_yaw() {
        // wxyz in the slots of xyzw, yaw y: a roll of 180 - y.
        let wrong = |yaw: f64| {
            let q = from_rpy(0.0, 0.0, yaw);
            [q.w, q.i, q.j, q.k]
        };
        let slots = || (0..100).map(|step| wrong(f64::from(step) * 0.015));
        let straight = UnitQuaternion::identity();
        let published = level(slots(), &straight, Reading::Xyzw).unwrap();
        assert!((published.tilt_rad - 0.9 * 1.485).abs() < 0.02, "{published:?}");
        let right = level(slots(), &straight, Reading::Wxyz).unwrap();
        assert!(right.tilt_rad < 1e-7 && (right.turned_rad - 1.485).abs() < 1e-9);
        assert_eq!(right.rows, 100);
        assert_eq!(level([[0.0; 4]], &straight, Reading::Xyzw), None);
    }
}
