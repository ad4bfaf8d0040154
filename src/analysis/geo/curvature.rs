//! Whether the heights of poses are those over a tangent plane, or altitudes over a curved Earth.
//!
//! Must not judge.

use crate::analysis::geo::overlay::Overlay;
use crate::math::regress::{LineForm, fit};
use crate::math::{effective::effective_count, geodesy::Geodetic};

/// How much of the Earth's curvature is in the heights of poses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curvature {
    /// 1 where z is the height over the plane that touches at the origin, 0 where it is the altitude.
    pub(crate) share: f64,
    /// Its standard deviation.
    pub(crate) deviation: f64,
}

impl Curvature {
    /// Measures it; `origin` is where the plane touches. `None` where the receiver gives no altitude, or everything is
    /// equally far from the origin.
    pub(crate) fn of(overlay: &Overlay, origin: &Geodetic) -> Option<Self> {
        let pair = |both: &crate::analysis::geo::overlay::PoseFix| {
            let climb = both.climb_m?;
            // Below the plane by d^2 / 2R, compared with how far the poses are below their altitude.
            Some((origin.enu_of(&both.fix).z - climb, both.place_m.z - climb))
        };
        let pairs: Vec<(f64, f64)> = overlay.both.iter().filter_map(pair).collect();
        let line = fit(&pairs, LineForm::Anywhere, pairs.len() as f64)?;
        let residuals: Vec<f64> = pairs.iter().map(|(x, y)| y - line.slope * x).collect();
        let curve: Vec<f64> = pairs.iter().map(|(x, _)| *x).collect();
        let n_eff = effective_count(&[(curve, residuals)]).unwrap_or(pairs.len() as f64);
        Some(Self {
            share: line.slope,
            deviation: fit(&pairs, LineForm::Anywhere, n_eff)?.standard_error?,
        })
    }

    /// What the heights follow: `sigmas` deviations must be within `share`, and so must the distance from one or the other.
    pub(crate) fn follows(&self, sigmas: f64, share: f64) -> HeightModel {
        let sure = sigmas * self.deviation <= share;
        if sure && (self.share - 1.0).abs() <= share {
            HeightModel::Plane
        } else if sure && self.share.abs() <= share {
            HeightModel::Altitude
        } else {
            HeightModel::Unknown
        }
    }
}

/// What the heights follow, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum HeightModel {
    /// The height over a plane.
    Plane,
    /// The altitude.
    Altitude,
    /// One or the other, or neither.
    Unknown,
}
