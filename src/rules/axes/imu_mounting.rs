//! AXES16: the rotation of an inertial sensor's mounting, compared with the turns of the platform's poses.

mod findings;

use nalgebra::UnitQuaternion;

use crate::analysis::axes::imu_mounting::{ImuMounting, Limits};
use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{Imu, Motion};
use crate::rules::prelude::*;

pub(crate) struct ImuMountingRotation;

impl Rule for ImuMountingRotation {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let known = Sensors::of(world);
        for (index, bag) in Motion::of(world).bags.iter().enumerate() {
            let of = |imu| (imu, ImuMounting::of(world, bag, imu, limits));
            let sensors: Vec<_> = bag.imus.iter().map(of).collect();
            for ((imu, found), sensor) in sensors.iter().zip(known.of_bag(index)) {
                let subject = format!("mounting rotation of {}", imu.stream.subject);
                match found {
                    Ok(found) => {
                        let others = sensors
                            .iter()
                            .filter_map(|(other, of)| Some((*other, of.as_ref().ok()?)));
                        let mut exchanged = others
                            .filter(|(_, of)| is_exchanged(found, of, limits))
                            .map(|(other, _)| other);
                        let seen = Seen {
                            imu,
                            sensor,
                            found,
                            exchanged: exchanged.next(),
                        };
                        seen.judge(subject, limits, out);
                    }
                    Err((why, reason)) => out.not_evaluated(subject, *why, reason),
                }
            }
        }
    }
}

/// Whether each of two sensors turns as the other one is mounted.
fn is_exchanged(a: &ImuMounting, b: &ImuMounting, limits: &Limits) -> bool {
    let is_near = |a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>| a.angle_to(b).to_degrees() <= limits.max_off_deg;
    a.body == b.body && is_near(&a.fitted, &b.stated) && is_near(&b.fitted, &a.stated)
}

/// What is known of one sensor.
struct Seen<'m> {
    imu: &'m Imu,
    sensor: &'m Sensor,
    found: &'m ImuMounting,
    /// The sensor that it is exchanged with.
    exchanged: Option<&'m Imu>,
}

impl Seen<'_> {
    fn judge(&self, subject: String, limits: &Limits, out: &mut Judge) {
        let Self { imu, found, .. } = self;
        let [as_stated, as_fitted] = found.residuals;
        let sigma_deg = found.sigma_rad.to_degrees();
        let off_deg = found.stated.angle_to(&found.fitted).to_degrees();
        let measured = [
            Measured::new("rotation missing in the mounting", off_deg, "deg")
                .limit(limits.max_off_deg)
                .spread(sigma_deg)
                .samples(found.windows as u64),
            Measured::new("unexplained share of the turns, as stated", as_stated, "1"),
            Measured::new(
                "unexplained share of the turns, with the fitted mounting",
                as_fitted,
                "1",
            )
            .limit(limits.max_residual),
        ];
        if !(1.0 / limits.max_gain..=limits.max_gain).contains(&found.gain) {
            let why = format!(
                "the gyro turns {:.2} times as far as {}: another unit, or another body",
                found.gain, found.poses.0
            );
            return out.too_little(subject, why);
        }
        if as_fitted > limits.max_residual {
            let why = format!(
                "no rotation of the axes makes the gyro turn as {}: {:.0} % is unexplained",
                found.poses.0,
                100.0 * as_fitted
            );
            return out.too_little(subject, why);
        }
        let uncertain_deg = limits.sigmas * sigma_deg;
        if off_deg <= limits.max_off_deg && uncertain_deg <= limits.max_off_deg {
            return out.pass(subject, measured);
        }
        if off_deg <= limits.max_off_deg.max(uncertain_deg) || uncertain_deg > limits.max_off_deg {
            let why = format!(
                "{off_deg:.0} +- {sigma_deg:.0} deg from the stated rotation: not accurate enough to decide; record turns about several axes"
            );
            return out.too_little(subject, why);
        }
        let finding = if self.contradicts_gravity() {
            self.wrong_poses(subject)
        } else {
            self.wrong_mounting(subject, limits)
        };
        out.fail(imu.stream.expressed_in.annotate(finding).measured(measured));
    }
}
