//! ROT08: degrees where radians are read.

use std::f64::consts::{FRAC_PI_4, TAU};

use nalgebra::UnitQuaternion;

use crate::advice::literal::{rewrite_values, with_fix};
use crate::advice::tally::Tally;
use crate::analysis::pairs::{Pairs, Statement};
use crate::analysis::rot::angles::{Angles, stated};
use crate::math::rotation::{from_rpy, rotation_angle_between};
use crate::rules::prelude::*;
use crate::verdict::Safety;
use crate::world::World;

pub(crate) struct AngleUnit;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// How far over a full turn an angle in radians may be, radians.
    pub over_full_turn_rad: f64,
    /// How near to a multiple of 45 degrees an angle over a full turn counts as meant in radians, radians.
    pub eighth_rad: f64,
    /// Share of its angle by which a rotation in degrees may differ from another source's.
    pub share: f64,
    /// Smallest rotation that is compared with another source's, degrees.
    pub least_deg: f64,
}

impl Rule for AngleUnit {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let pairs = Pairs::new(world);
        let mut right = Tally::new("roll, pitch, yaw");
        for angles in stated(world) {
            let largest = angles
                .rpy
                .iter()
                .fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
            let measured = Measured::new("largest angle, read as radians", largest, "rad").limit(TAU);
            if let Some(other) = in_degrees_of(&angles, &pairs, limits) {
                let finding = finding(
                    world,
                    &angles,
                    format!("Read as degrees they are the rotation in {}.", world.path(other.source)),
                );
                let [as_read, in_degrees] =
                    readings(angles.rpy).map(|read| rotation_angle_between(&read, &other.pose.rotation).to_degrees());
                let measured = [
                    Measured::new("difference from that rotation, read as radians", as_read, "deg"),
                    Measured::new("difference from that rotation, read as degrees", in_degrees, "deg"),
                ];
                out.fail(finding.measured(measured).related(other.place, "the same rotation"));
            } else if angles.rpy.iter().any(|angle| is_over_a_turn(*angle, limits)) {
                out.fail(
                    finding(
                        world,
                        &angles,
                        "An angle is larger than a full turn (6.2832 rad).".to_owned(),
                    )
                    .likely()
                    .measured(measured),
                );
            } else {
                right.pass(angles.place.source, measured);
            }
        }
        right.report(world, out);
    }
}

/// Over a full turn, and no multiple of 45 degrees in radians.
fn is_over_a_turn(angle: f64, limits: &Limits) -> bool {
    let from_eighth = (angle / FRAC_PI_4 - (angle / FRAC_PI_4).round()).abs() * FRAC_PI_4;
    let counted = angle.abs() < 4.0 * TAU && angle.fract() != 0.0 && from_eighth <= limits.eighth_rad;
    angle.abs() > TAU + limits.over_full_turn_rad && !counted
}

/// The rotations of roll, pitch, yaw in radians and in degrees.
fn readings(rpy: [f64; 3]) -> [UnitQuaternion<f64>; 2] {
    [rpy, rpy.map(f64::to_radians)].map(|[roll, pitch, yaw]| from_rpy(roll, pitch, yaw))
}

/// The statement of another source that these angles repeat when they are read as degrees, and do not otherwise.
fn in_degrees_of(angles: &Angles, pairs: &Pairs, limits: &Limits) -> Option<Statement> {
    let (target, source) = angles.frames.as_ref().filter(|_| angles.is_rigid)?;
    let [as_read, in_degrees] = readings(angles.rpy);
    pairs
        .others(target, source, angles.place.source)
        .into_iter()
        .find(|other| {
            let angle = other.pose.rotation.angle();
            let tolerance = limits.share * angle;
            let off = |rotation: &UnitQuaternion<f64>| rotation_angle_between(rotation, &other.pose.rotation);
            other.has_rotation
                && angle >= limits.least_deg.to_radians()
                && off(&in_degrees) <= tolerance
                && off(&as_read) > 10.0 * tolerance
        })
}

fn finding(world: &World, angles: &Angles, detail: String) -> Finding {
    let [roll, pitch, yaw] = angles.rpy.map(|angle| (angle * 1e4).round() / 1e4);
    let message = format!(
        "the angles {roll} {pitch} {yaw} of {} are probably degrees, read as radians",
        angles.name
    );
    let finding = Finding::error(angles.subject(world), message, angles.place.clone())
        .label("degrees?")
        .detail(detail)
        .help("write radians, degrees times pi/180 (90 degrees are 1.5707963267948966); in xacro `${radians(90)}`")
        .relation("degrees");
    let literals = angles.radian_literals().iter();
    let radians = literals.map(|literal| (literal, literal.value.to_radians()));
    let edits = rewrite_values(world, angles.place.source, radians);
    with_fix(
        finding,
        "convert the angles to radians",
        Safety::ChangesBehaviour,
        edits,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        over_full_turn_rad: 0.01,
        eighth_rad: 2e-4,
        share: 0.005,
        least_deg: 0.5,
    };

    #[test]
    fn whole_degrees_are_over_a_turn_and_radians_are_not() {
        for degrees in [30.0, -45.0, 90.0, 180.0, -270.0, 360.0, 22.0, 7.5, 719.0] {
            assert!(is_over_a_turn(degrees, &LIMITS), "{degrees}");
        }
        for eighths in [0.0, 2.0, -4.0, 6.0, 8.0, -8.0, 10.0] {
            let radians = (eighths * FRAC_PI_4 * 1e5_f64).round() / 1e5;
            assert!(!is_over_a_turn(radians, &LIMITS), "{radians}");
        }
    }
}
