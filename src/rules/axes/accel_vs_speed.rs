//! AXES06: the acceleration along the base's axes compared with the change of speed.

use crate::advice::diagnosis::{explain, judge_each, unless_swapped};
use crate::analysis::axes::causes::{Aspect, Hand, Push};
use crate::analysis::axes::push::{AccelFit, Limits};
use crate::analysis::motion::Imu;
use crate::analysis::{axes::sensors::Sensor, look::TRACK};
use crate::rules::prelude::*;

pub(crate) struct AccelVsSpeed;

impl Rule for AccelVsSpeed {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let named = |imu: &str| format!("forward acceleration of {imu}");
        judge_each((world, limits), named, |sensor| &sensor.push, judge_pushed, out);
    }
}

fn judge_pushed((imu, sensor): (&Imu, &Sensor), subject: String, pushed: &AccelFit, limits: &Limits, out: &mut Judge) {
    let is_left = pushed.hand == Some(Hand::Left);
    // Left-handed axes are no yaw.
    let yaw = (!is_left).then(|| {
        Measured::new("yaw missing in the mounting", pushed.yaw_deg, "deg")
            .turn()
            .limit(limits.max_yaw_deg)
            .spread(pushed.error_deg)
    });
    let mut measured: Vec<Measured> = yaw.into_iter().collect();
    let over = [
        (pushed.speeding, "change of speed"),
        (pushed.curving, "(speed x turn rate)"),
    ];
    for (fit, track) in over {
        let Some(fit) = fit else { continue };
        let along = fit.gain.iter().zip(fit.error.iter()).zip(["x", "y"]);
        measured.extend(along.map(|((gain, error), axis)| {
            Measured::new(format!("acceleration along {axis} / {track}"), *gain, "1").spread(*error)
        }));
    }
    if pushed.class == Push::Forward && !is_left {
        if pushed.yaw_deg.abs() <= limits.max_yaw_deg {
            return out.pass(subject, measured);
        }
        let why = format!(
            "the mounting is missing a yaw of {:+.0} +- {:.0} deg: not accurate enough to decide; record more changes of speed and turns",
            pushed.yaw_deg, pushed.error_deg
        );
        return out.too_little(subject, why);
    }
    let message = format!("`{}`: {}", imu.stream.topic, wrong(pushed));
    let yaw = match sensor.diagnosis.word() {
        Some("turned-mount") => format!(" A mounting yaw of about {:+.0} deg explains it.", pushed.yaw_deg),
        _ => String::new(),
    };
    let curves = match pushed.curving {
        Some(curving) if is_left && pushed.class != Push::Forward => {
            let [along_x, along_y] = curving.gain.into();
            format!(" In curves to the left the ratio is {along_x:+.2} along x and {along_y:+.2} along y.")
        }
        _ => String::new(),
    };
    let detail = format!(
        "Compared with the motion of {}. The ratios should be +1 along x when speeding up, and +1 along y in curves to the left.{curves}{yaw} Mounting: {}.",
        pushed.track,
        imu.mounting()
    );
    let otherwise = "add the missing yaw to the mounting transform, or negate the acceleration if it is gravity instead of specific force. Nothing is wrong if \
         this was a drive in reverse";
    let finding = explain(
        &sensor.diagnosis,
        imu,
        Aspect::Push,
        Finding::warning(subject, message, imu.stream.place())
            .likely()
            .detail(detail),
        otherwise,
    );
    let finding = match sensor.diagnosis.word() {
        Some("left-handed-accelerometer") if pushed.class == Push::Forward => {
            finding.help("negate y of the acceleration: it must be positive in a curve to the left")
        }
        _ => finding,
    };
    let finding = finding.related(pushed.track_at.clone(), TRACK).measured(measured);
    out.fail(if is_left {
        unless_swapped(&pushed.track, finding)
    } else {
        finding
    });
}

/// What is wrong with the acceleration.
fn wrong(pushed: &AccelFit) -> String {
    // Forward in the sensor's axes is (cos, -sin) of its yaw, and left (sin, cos).
    let axes = match pushed.yaw_deg {
        deg if deg.abs() > 135.0 => ["-x", "-y"],
        deg if deg > 45.0 => ["-y", "x"],
        deg if deg < -45.0 => ["y", "-x"],
        _ => ["x", "y"],
    };
    let (when, should, is, fit) = match (pushed.class, pushed.speeding, pushed.curving) {
        (Push::Forward, _, Some(fit)) => ("in curves to the left", "y", "-y", fit),
        (_, Some(fit), _) => ("when speeding up", "x", axes[0], fit),
        (_, None, fit) => ("in curves to the left", "y", axes[1], fit.unwrap_or_default()),
    };
    if pushed.class == Push::Oblique {
        let side = if pushed.yaw_deg < 0.0 { "left" } else { "right" };
        return format!(
            "acceleration {when} is {:.0} deg to the {side} of {should}",
            pushed.yaw_deg.abs()
        );
    }
    let gain = if is.ends_with('x') { fit.gain.x } else { fit.gain.y };
    format!("acceleration {when} is along {is}, not along {should} (ratio {gain:+.2})")
}
