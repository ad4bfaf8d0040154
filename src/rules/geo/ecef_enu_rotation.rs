//! GEO02: the rotation between the Earth's frame and a local one.

use crate::analysis::geo::earth::EarthPose;
use crate::analysis::geo::level::{EarthAttitude, Limits, expected, see};
use crate::math::earth_turns::{EarthTurn, shown};
use crate::math::rotation::xyzw_in_words;
use crate::rules::prelude::*;

pub(crate) struct EcefEnuRotation;

impl Rule for EcefEnuRotation {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for stated in EarthPose::all(world) {
            judge_one(&stated, limits, out);
        }
    }
}

fn judge_one(stated: &EarthPose, limits: &Limits, out: &mut Judge) {
    let subject = stated.subject.as_str();
    let (earth, local) = (&stated.earth, &stated.local);
    if !stated.is_local() {
        let why = format!("`{local}` is not fixed to the Earth by its name, so it need not be level");
        return out.not_applicable(subject, why);
    }
    if stated.has != (true, true) {
        let part = if stated.has.0 { "position" } else { "rotation" };
        let why = format!("it states no {part}: both are needed, since the position determines the correct rotation");
        return out.missing(subject, why);
    }
    let seen = stated
        .poses
        .iter()
        .filter_map(|(place, pose)| see(stated, place, pose, limits));
    let Some(worst) = seen.max_by(|a, b| a.tilt_deg.total_cmp(&b.tilt_deg)) else {
        let first = stated.poses.first();
        let far = first.map_or(f64::NAN, |(_, pose)| pose.translation.vector.norm());
        let why = format!(
            "the origin of `{local}` is {:.0} km from that of `{earth}`, not near the ellipsoid (6357 to 6378 km): `{earth}` is not \
             the Earth's frame here",
            far / 1e3
        );
        return out.not_applicable(subject, why);
    };
    let excused = stated.rounding_rad.to_degrees();
    let after = if worst.is_inverse { ", after inversion" } else { "" };
    let measured = [
        Measured::new("tilt from east, north, up", worst.written_tilt_deg, "deg")
            .turn()
            .limit(limits.warning_deg.max(excused)),
        Measured::new(
            format!("angle of x from east towards north{after}"),
            worst.yaw_deg,
            "deg",
        ),
    ];
    if worst.tilt_deg <= limits.warning_deg.max(excused) && !worst.is_inverse {
        return out.pass(subject, measured);
    }
    let inverted = worst.is_inverse.then(|| {
        let moved = worst.pose.translation.vector - worst.pose.inverse().translation.vector;
        [
            Measured::new("tilt from east, north, up, after inversion", worst.tilt_deg, "deg"),
            Measured::new(
                "distance of the origin as written from its place after inversion",
                moved.norm(),
                "m",
            ),
        ]
    });
    let finding = wrong(stated, &worst, limits).measured(measured);
    out.fail(finding.measured(inverted.into_iter().flatten()));
}

fn wrong(stated: &EarthPose, seen: &EarthAttitude<'_>, limits: &Limits) -> Finding {
    let (earth, local) = (&stated.earth, &stated.local);
    let (latitude, longitude) = (
        seen.origin.latitude_rad.to_degrees(),
        seen.origin.longitude_rad.to_degrees(),
    );
    let within = limits.relation_deg.to_radians().max(stated.rounding_rad);
    let errors = if seen.is_inverse {
        Vec::new()
    } else {
        shown(&seen.origin, &seen.rotation, within)
    };
    let is_ned = stated.local.has_token("ned");
    let (relation, because) = match errors.first() {
        _ if seen.is_inverse => (
            Some("inverse"),
            format!("inverted, `{local}` and `{earth}` are exchanged"),
        ),
        Some(EarthTurn::Ned) if is_ned => (Some("ned-enu"), "the axes are east, north, up".to_owned()),
        Some(error) => (Some(error.word()), error.describe().to_owned()),
        None => (None, "no known error explains that".to_owned()),
    };
    let others: Vec<&str> = errors.iter().skip(1).map(|error| error.describe()).collect();
    let class = if others.is_empty() {
        String::new()
    } else {
        format!(" Other errors that give the same rotation here: {}.", others.join("; "))
    };
    let (axes, short) = if is_ned {
        ("north, east, down", "NED")
    } else {
        ("east, north, up", "ENU")
    };
    let heights = if seen.tilt_deg < 90.0 {
        let wrong_m = 1e3 * seen.tilt_deg.to_radians().sin();
        format!(" At 1 km from the origin, heights are wrong by up to {wrong_m:.1} m.")
    } else {
        String::new()
    };
    let (message, detail) = if seen.is_inverse {
        (
            format!("{}: {because}", stated.subject),
            format!(
                "As written, the origin of `{local}` is near the south pole. Inverted, the origin is at latitude {latitude:.5}, longitude \
                 {longitude:.5}."
            ),
        )
    } else {
        (
            format!(
                "{}: tilted {:.2} deg from {short}: {because}",
                stated.subject, seen.tilt_deg
            ),
            format!("The origin of `{local}` is at latitude {latitude:.5}, longitude {longitude:.5}.{heights}{class}"),
        )
    };
    let severity = if seen.tilt_deg > limits.error_deg || seen.is_inverse {
        Severity::Error
    } else {
        Severity::Warning
    };
    let help = if seen.is_inverse {
        let (t, rotation) = (seen.pose.translation, xyzw_in_words(&seen.pose.rotation, 9));
        format!(
            "invert the whole transform: publish `{earth}` -> `{local}` with the translation [{:.3}, {:.3}, {:.3}] m and the quaternion x y z w = \
             {rotation}; or keep the numbers, and write `{local}` as the parent and `{earth}` as the child",
            t.x, t.y, t.z
        )
    } else {
        let rotation = xyzw_in_words(&expected(&seen.origin, is_ned), 9);
        format!(
            "correct the rotation: `{earth}` -> `{local}` has the quaternion x y z w = {rotation} with the axes {axes}"
        )
    };
    let rotation = stated.rotation_place.as_ref().filter(|_| !seen.is_inverse);
    let place = rotation.unwrap_or(seen.place).clone();
    let mut finding = Finding::new(severity, &stated.subject, message, place)
        .detail(detail)
        .help(help);
    // A tilt that no error explains may have been measured: the map itself is tilted.
    finding = if relation.is_some() { finding } else { finding.likely() };
    if let Some(word) = relation {
        finding = finding.relation(word);
    }
    finding.confidence(stated.reading)
}
