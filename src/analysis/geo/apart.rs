//! How far apart two origins are, and words for it.
//!
//! Must not judge.

use nalgebra::Vector3;

use crate::math::stats::rounded;
use crate::world::LocalOrigin;

/// Beyond it east, north and up are meaningless, metres.
const FAR_M: f64 = 1e5;

/// East, north and up from one to the other, metres; without up where one of them states no height.
pub(crate) fn between(from: &LocalOrigin, to: &LocalOrigin) -> Vector3<f64> {
    let (mut from_at, mut to_at) = (from.at, to.at);
    if from.has_height && to.has_height {
        return from_at.enu_of(&to_at);
    }
    (from_at.height_m, to_at.height_m) = (0.0, 0.0);
    let enu = from_at.enu_of(&to_at);
    // The tangent plane hides how far apart places around the Earth are.
    if enu.xy().norm() > FAR_M {
        to_at.to_ecef() - from_at.to_ecef()
    } else {
        Vector3::new(enu.x, enu.y, 0.0)
    }
}

/// A place, in degrees and metres.
pub(crate) fn position_text(origin: &LocalOrigin) -> String {
    let (latitude, longitude) = (
        origin.at.latitude_rad.to_degrees(),
        origin.at.longitude_rad.to_degrees(),
    );
    let height = if origin.has_height {
        format!(", {:.2} m", origin.at.height_m)
    } else {
        String::new()
    };
    format!("{latitude:.7}, {longitude:.7}{height}")
}

/// The offset from the first to another, as a sentence, where they are near.
pub(crate) fn direction(apart: &Vector3<f64>, to: &str) -> String {
    if apart.norm() > FAR_M {
        return String::new();
    }
    let [east, north, up] = [apart.x, apart.y, apart.z].map(|m| rounded(m, 2));
    format!(" From the first to {to}: east {east:+.2}, north {north:+.2}, up {up:+.2} m.")
}
