//! How crisp a map is: the number of grid cells that its points occupy. Correctly registered scans coincide; wrongly registered, every
//! wall appears as often as it was scanned.

use std::collections::BTreeSet;

/// Coordinates beyond this have no cell, metres.
const FAR_M: f64 = 1e6;

/// How many square cells of this size hold points; x and y in metres, in any one frame. Points that are not finite or further off than
/// 1000 km are left out; 0 where the size is no length.
pub fn occupied_cells(points: impl IntoIterator<Item = [f64; 2]>, cell_m: f64) -> usize {
    if !(cell_m.is_finite() && cell_m > 0.0) {
        return 0;
    }
    let cell = |value: f64| {
        let is_near = value.abs() <= FAR_M;
        #[expect(
            clippy::cast_possible_truncation,
            reason = "bounded by FAR_M; cells of nanometres saturate"
        )]
        is_near.then(|| (value / cell_m).floor() as i64)
    };
    let cells: BTreeSet<(i64, i64)> = points
        .into_iter()
        .filter_map(|[x, y]| Some((cell(x)?, cell(y)?)))
        .collect();
    cells.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_share_cells() {
        assert_eq!(
            occupied_cells([[0.05, 0.05], [0.15, 0.15], [0.25, 0.05], [-0.05, 0.05]], 0.2),
            3
        );
        assert_eq!(occupied_cells([], 0.2), 0);
        assert_eq!(
            occupied_cells([[f64::NAN, 0.0], [0.0, f64::INFINITY], [1e9, 0.0], [1.0, 1.0]], 0.2),
            1
        );
        assert_eq!(occupied_cells([[0.0, 0.0]], 0.0), 0);
        assert_eq!(occupied_cells([[0.0, 0.0]], f64::NAN), 0);
    }

    #[test]
    fn a_wall_that_is_mapped_twice_in_another_place_takes_twice_the_cells() {
        let wall = |x: f64| (0..100).map(move |step| [x, 0.1 * f64::from(step) + 0.05]);
        let once = occupied_cells(wall(3.1), 0.2);
        assert_eq!(once, 50);
        assert_eq!(occupied_cells(wall(3.1).chain(wall(3.12)), 0.2), once);
        assert_eq!(occupied_cells(wall(3.1).chain(wall(4.1)), 0.2), 2 * once);
    }
}
