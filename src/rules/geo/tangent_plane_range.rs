//! GEO05: how far from its origin a tangent plane is used.

use crate::analysis::geo::curvature::{Curvature, HeightModel};
use crate::analysis::geo::overlay::{Overlay, is_way};
use crate::analysis::motion::{Motion, Stream};
use crate::analysis::{geo::earth::EarthPose, geo::plane::Plane};
use crate::math::geodesy::{Geodetic, tangent_departure_m};
use crate::rules::prelude::*;
use crate::world::motion::PoseRow;

pub(crate) struct TangentPlaneRange;

/// What to do where z is no altitude.
const CONVERT: &str = "where z is compared with altitudes (fixes, elevation maps), convert latitude, longitude and altitude together to east, north, up \
     (GeographicLib: LocalCartesian), instead of subtracting the altitude of the origin";

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_departure_m: f64,
    note_departure_m: f64,
    max_tilt_deg: f64,
    elsewhere_m: f64,
    unstated_m: f64,
    max_height_m: f64,
    sigmas: f64,
    share: f64,
    follow_scale: f64,
    follow_share: f64,
}

impl Rule for TangentPlaneRange {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let stated = EarthPose::all(world);
        for bag in &Motion::of(world).bags {
            let mut planes: Vec<Plane<'_>> = stated
                .iter()
                .filter_map(|stated| Plane::stated(stated, limits.max_height_m))
                .collect();
            for plane in &mut planes {
                plane.reach(world, bag);
                judge_plane(plane, limits, out);
            }
            for fixes in &bag.fixes {
                let is_unstated = |poses: &&Stream<PoseRow>| {
                    is_way(poses) && planes.iter().all(|plane| Some(plane.local) != poses.frame.as_ref())
                };
                for poses in bag.poses.iter().filter(is_unstated) {
                    let subject = format!("{} against {}", poses.subject, fixes.subject);
                    let fitted = Overlay::of(world, poses, fixes).and_then(|overlay| {
                        let fit = overlay.fit(limits.follow_scale, limits.follow_share)?;
                        Some((overlay.origin(&fit)?, overlay))
                    });
                    if let Some((origin, overlay)) = fitted {
                        judge_track(&subject, &poses.place(), &origin, &overlay, limits, out);
                    } else {
                        let why = "poses and fixes do not overlap in time, or the poses do not follow the fixes";
                        out.too_little(subject, why);
                    }
                }
            }
        }
    }
}

fn measured(distance_m: f64, departure_m: f64, tilt_deg: f64, limits: &Limits) -> [Measured; 3] {
    [
        Measured::new("largest distance of the positions from the origin", distance_m, "m"),
        Measured::new(
            "height of the plane above the ellipsoid at that distance",
            departure_m,
            "m",
        )
        .limit(limits.max_departure_m),
        Measured::new(
            "angle of the plane's z axis to the vertical at that distance",
            tilt_deg,
            "deg",
        )
        .limit(limits.max_tilt_deg),
    ]
}

fn judge_plane(plane: &Plane<'_>, limits: &Limits, out: &mut Judge) {
    let Some((distance_m, who)) = &plane.reach else {
        return out.missing(
            plane.subject,
            format!(
                "no poses are expressed in `{}`, and there are no fixes: record one of them",
                plane.local
            ),
        );
    };
    if *distance_m > limits.elsewhere_m {
        let why = format!(
            "{who} is {:.0} km from the origin: another place on the Earth, not a plane that is used too far out",
            distance_m / 1e3
        );
        return out.not_applicable(plane.subject, why);
    }
    let radius_m = plane.origin.gaussian_radius_m();
    let (departure_m, tilt_deg) = (
        tangent_departure_m(*distance_m, radius_m),
        (distance_m / radius_m).to_degrees(),
    );
    let measured = measured(*distance_m, departure_m, tilt_deg, limits);
    let heights = plane
        .curvature
        .as_ref()
        .map(|(curvature, who, at)| (curvature.follows(limits.sigmas, limits.share), who, at));
    let (local, km) = (plane.local, distance_m / 1e3);
    let is_open = plane.has_poses && !matches!(heights, Some((HeightModel::Plane | HeightModel::Altitude, ..)));
    let finding = match heights {
        Some((HeightModel::Altitude, poses, at)) if departure_m > limits.max_departure_m => {
            let message = format!(
                "{poses}: z is altitude, not height above the plane of `{local}`: {departure_m:.2} m too high at {km:.1} km"
            );
            Finding::warning(plane.subject, message, plane.place.clone())
                .likely()
                .relation("altitude-as-z")
                .detail(format!(
                    "By {}, x, y, z are east, north, up of a tangent plane. Far from the origin the Earth falls below this \
                     plane, so an altitude is too large for z.",
                    plane.subject
                ))
                .related(at.clone(), "poses whose z is altitude")
                .help(
                    "compute z as `up` of the conversion to east, north, up (GeographicLib: LocalCartesian), not as the altitude \
                     minus that of the origin",
                )
        }
        _ if tilt_deg > limits.max_tilt_deg => {
            let message = format!(
                "{}: used {km:.1} km from the origin, where z is {tilt_deg:.2} deg off the vertical",
                plane.subject
            );
            Finding::warning(plane.subject, message, plane.place.clone())
                .relation("far-from-origin")
                .detail(format!(
                    "The farthest positions are those of {who}. At that distance the plane is {departure_m:.1} m above the ellipsoid."
                ))
                .help(format!(
                    "put the origin of `{local}` near the place of use, or split the area into maps with an origin each"
                ))
        }
        _ if departure_m > limits.note_departure_m => {
            let (differs, detail) = if is_open {
                (
                    "may differ",
                    "The heights of the poses do not show whether their z is altitude or height over the plane.",
                )
            } else {
                (
                    "differs",
                    "At that distance the tangent plane is above the ellipsoid, so z is no altitude.",
                )
            };
            let message = format!(
                "{}: z {differs} from altitude by {departure_m:.2} m, {km:.1} km from the origin",
                plane.subject
            );
            Finding::note(plane.subject, message, plane.place.clone())
                .relation("tangent-plane")
                .detail(format!("The farthest positions are those of {who}. {detail}"))
                .help(CONVERT)
        }
        _ if departure_m > limits.max_departure_m && is_open => {
            let why = format!(
                "plane and ellipsoid are {departure_m:.2} m apart {distance_m:.0} m from the origin, and the heights of the poses in \
                 `{local}` do not show which of the two they follow: a longer drive or a receiver with corrections would"
            );
            return out.too_little(plane.subject, why);
        }
        _ => return out.pass(plane.subject, measured),
    };
    // An angle within its limit is no evidence.
    let shown = if tilt_deg > limits.max_tilt_deg { 3 } else { 2 };
    out.fail(finding.measured(measured.into_iter().take(shown)));
}

fn judge_track(subject: &str, place: &Place, origin: &Geodetic, overlay: &Overlay, limits: &Limits, out: &mut Judge) {
    let far = overlay.both.iter().map(|both| origin.enu_of(&both.fix).xy().norm());
    let distance_m = far.fold(0.0, f64::max);
    if distance_m > limits.unstated_m {
        let why = format!(
            "its origin is {:.0} km from the fixes and is stated nowhere: probably coordinates in a grid square",
            distance_m / 1e3
        );
        return out.not_applicable(subject, why);
    }
    let radius_m = origin.gaussian_radius_m();
    let (departure_m, tilt_deg) = (
        tangent_departure_m(distance_m, radius_m),
        (distance_m / radius_m).to_degrees(),
    );
    let curvature = Curvature::of(overlay, origin);
    let measured = measured(distance_m, departure_m, tilt_deg, limits);
    match curvature
        .as_ref()
        .map(|curvature| curvature.follows(limits.sigmas, limits.share))
    {
        Some(HeightModel::Altitude) => out.pass(subject, measured),
        Some(HeightModel::Plane) if departure_m <= limits.note_departure_m => out.pass(subject, measured),
        Some(HeightModel::Plane) => {
            let message = format!(
                "{subject}: z is height above a plane, {departure_m:.2} m below altitude at {:.1} km",
                distance_m / 1e3
            );
            let finding = Finding::note(subject, message, place.clone())
                .likely()
                .relation("tangent-plane")
                .detail(
                    "Height above a tangent plane is allowed (ENU, a local Cartesian frame), but its difference to altitude grows with the \
                     square of the distance from the origin.",
                )
                .help(CONVERT);
            out.fail(finding.measured(measured));
        }
        _ => {
            let why = format!(
                "plane and ellipsoid are {departure_m:.2} m apart {distance_m:.0} m from the origin, and the heights of the poses do \
                 not show which of the two they follow: a transform from `earth` would"
            );
            out.too_little(subject, why);
        }
    }
}
