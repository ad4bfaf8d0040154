//! Whether a track is expressed in east, north, up or on a UTM grid.
//!
//! Must not judge.

use nalgebra::Vector2;

use crate::analysis::geo::overlay::Overlay;
use crate::math::similarity2::{Similarity2, deviations, fit_similarities};
use crate::math::utm::{Utm, utm, zone};
use crate::math::{circular::difference, stats::median};

/// Side of the squares of the military grid, metres: positions in a square are eastings and northings without the
/// leading digits.
const SQUARE_M: f64 = 100_000.0;

/// A track compared with east and north.
#[derive(Clone, Debug)]
pub(crate) struct GridFit {
    /// What takes east and north to x and y.
    pub(crate) fit: Similarity2,
    /// Standard deviations of its angle, radians, and of its scale.
    pub(crate) deviations: (f64, f64),
    /// The grids of the place's zone and of its neighbours, in this order.
    pub(crate) grids: Vec<Grid>,
}

/// A grid compared with east and north, over the same fixes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// The zone.
    pub(crate) zone: u8,
    /// What takes east and north to easting and northing.
    pub(crate) fit: Similarity2,
    /// Median distance of the poses from eastings and northings, metres.
    pub(crate) off_m: f64,
    /// The same, without whole hundreds of kilometres.
    pub(crate) off_in_square_m: f64,
}

impl GridFit {
    /// Fits poses to fixes; `None` where the fixes are in no zone or do not spread.
    pub(crate) fn of(overlay: &Overlay, blocks: usize) -> Option<Self> {
        let (enu, xy) = overlay.planes();
        let own = zone(&overlay.both.first()?.fix)?;
        let neighbour = |step: u8| (own + 59 + step - 1) % 60 + 1;
        let grids = [own, neighbour(0), neighbour(2)];
        Some(Self {
            fit: fit_similarities(&enu, &xy)?.proper,
            deviations: deviations(&enu, &xy, blocks)?,
            grids: grids.into_iter().filter_map(|zone| grid(overlay, &enu, zone)).collect(),
        })
    }

    /// The angle of the track minus that of the grid, and the same of their scales.
    pub(crate) fn beside(&self, grid: &Grid) -> (f64, f64) {
        (
            difference(self.fit.angle_rad, grid.fit.angle_rad),
            self.fit.scale - grid.fit.scale,
        )
    }
}

fn grid(overlay: &Overlay, enu: &[Vector2<f64>], zone: u8) -> Option<Grid> {
    let both = overlay.both.iter();
    let places: Vec<Utm> = both.map(|both| utm(&both.fix, Some(zone))).collect::<Option<_>>()?;
    let on_grid: Vec<Vector2<f64>> = places.iter().map(|p| Vector2::new(p.easting_m, p.northing_m)).collect();
    let off = |in_square: bool| {
        let rest = |metres: f64| {
            if in_square {
                metres - (metres / SQUARE_M).round() * SQUARE_M
            } else {
                metres
            }
        };
        let pairs = overlay.both.iter().zip(&on_grid);
        let distances: Vec<f64> = pairs
            .map(|(both, grid)| rest(both.place_m.x - grid.x).hypot(rest(both.place_m.y - grid.y)))
            .collect();
        median(&distances)
    };
    Some(Grid {
        zone,
        fit: fit_similarities(enu, &on_grid)?.proper,
        off_m: off(false)?,
        off_in_square_m: off(true)?,
    })
}
