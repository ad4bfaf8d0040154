//! How many points of a cloud lie on its lowest and on its highest surface, seen along each axis.
//!
//! Owns the cells and their size. A ground is a lowest surface with many points; what stands on it has no common height. Gives numbers and no
//! verdict. Metres.

use std::collections::BTreeMap;

use super::stats::quantile;

/// Side of a cell across the axis: a slope of 10 % rises by 0.3 in it.
const CELL: f64 = 3.0;
/// Points within this of a surface lie on it.
const NEAR: f64 = 0.3;
/// Fewer points in a cell show no surface.
const MIN_POINTS: usize = 6;
/// The quantiles of a cell that stand for its surfaces: single points beyond them are noise.
const SURFACES: [f64; 2] = [0.05, 0.95];
/// The quantiles between which a cloud extends.
const EXTENT: [f64; 2] = [0.01, 0.99];

/// Along one axis: the extent, the shares on the lowest and on the highest surface, and the cells that show one.
pub type AlongAxis = (f64, [f64; 2], usize);

/// For x, y and z.
pub fn relief(points: &[[f64; 3]]) -> [AlongAxis; 3] {
    [0, 1, 2].map(|axis| along(points, axis))
}

fn along(points: &[[f64; 3]], axis: usize) -> AlongAxis {
    let of = |point: &[f64; 3], shift: usize| point.get((axis + shift) % 3).copied().unwrap_or_default();
    let values: Vec<f64> = points.iter().map(|point| of(point, 0)).collect();
    let [low, high] = EXTENT.map(|share| quantile(&values, share).unwrap_or_default());
    let mut cells: BTreeMap<[i64; 2], Vec<f64>> = BTreeMap::new();
    for point in points {
        let cell = [1, 2].map(|shift| index(of(point, shift)));
        cells.entry(cell).or_default().push(of(point, 0));
    }
    cells.retain(|_, heights| heights.len() >= MIN_POINTS);
    let (mut on, mut count) = ([0.0; 2], 0.0);
    for heights in cells.values() {
        count += heights.len() as f64;
        for (share, on) in SURFACES.into_iter().zip(&mut on) {
            let surface = quantile(heights, share).unwrap_or_default();
            *on += heights
                .iter()
                .filter(|height| (**height - surface).abs() <= NEAR)
                .count() as f64;
        }
    }
    (high - low, on.map(|on| on / f64::max(count, 1.0)), cells.len())
}

#[allow(clippy::cast_possible_truncation)] // cut to the range
fn index(value: f64) -> i64 {
    (value / CELL).floor() as i64
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::math::tests_support::Rng;

    #[test]
    fn a_ground_is_on_the_side_that_it_is_on() {
        let mut rng = Rng::new(4);
        let points: Vec<[f64; 3]> = (0..20_000)
            .map(|index| {
                let [x, y] = [(); 2].map(|()| rng.range(-20.0, 20.0));
                let height = if index % 2 == 0 { 0.0 } else { rng.range(0.0, 9.0) };
                [x, y, height]
            })
            .collect();
        let [_, _, (extent, [low, high], cells)] = relief(&points);
        assert!((8.0..9.0).contains(&extent) && cells == 196, "{extent} {cells}");
        // Half of the points, and of the others those within 0.3 of the ground.
        assert!((low - 0.52).abs() < 0.02 && high < 0.1, "{low} {high}");
        let flipped: Vec<[f64; 3]> = points.iter().map(|[x, y, z]| [*x, -z, *y]).collect();
        let [_, (_, [low, high], _), _] = relief(&flipped);
        assert!((high - 0.52).abs() < 0.02 && low < 0.1, "{low} {high}");
    }
}
