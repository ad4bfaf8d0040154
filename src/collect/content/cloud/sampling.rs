//! Which points of a cloud are looked at.

use std::collections::BTreeSet;

use crate::read::messages::cloud::{Cloud, Column};
use crate::world::cloud::RING_FIELDS;

/// Points of a cloud whose rings are counted, about.
const POINTS_OF_RINGS: u64 = 2048;
/// No lidar has more rings; clouds with more rows are those of a depth camera.
pub(super) const MAX_RINGS: u32 = 256;

/// Steps over rows and columns that keep about so many points: columns first, for rows are few and apart where they are beams. Beams take turns in a
/// cloud of one row: a step that shares no factor with their number meets them all.
pub(super) fn strides(cloud: &Cloud<'_>, most: usize) -> (u32, u32) {
    let enough = (most as u64).div_ceil(u64::from(cloud.width).max(1));
    let rows = u64::from(cloud.height).min(enough.max(64));
    let row_step = u64::from(cloud.height).div_ceil(rows.max(1));
    let column_step = (u64::from(cloud.width) * rows).div_ceil(most.max(1) as u64);
    let step = |step: u64, is_one_row: bool| match u32::try_from(step).unwrap_or(u32::MAX).max(1) {
        step if is_one_row && step > 1 => prime(step.max(7)),
        step => step,
    };
    (step(row_step, cloud.width == 1), step(column_step, cloud.height == 1))
}

/// The least prime from a number on; the number where there is none.
fn prime(from: u32) -> u32 {
    let is_prime = |number: &u32| {
        let mut factors = (2..).take_while(|factor| u64::from(*factor) * u64::from(*factor) <= u64::from(*number));
        factors.all(|factor| !number.is_multiple_of(factor))
    };
    (from..=u32::MAX).find(is_prime).unwrap_or(from)
}

/// Whether a point is one: rays without a return are NaN or zero.
pub(in crate::collect) fn is_return(xyz: [f64; 3]) -> bool {
    xyz.iter().all(|value| value.is_finite()) && xyz.iter().any(|value| *value != 0.0)
}

/// The number of rings with a point; `None` without a field for them. The step over the points shares no factor with the rows and columns: steps that
/// do leave out whole rings.
pub(super) fn rings(cloud: &Cloud<'_>, axes: [Column; 3]) -> Option<u32> {
    let ring = RING_FIELDS.iter().find_map(|name| cloud.column(name))?;
    let in_data = cloud.data.len() as u64 / u64::from(cloud.point_step.max(1));
    let all = in_data.min(cloud.points());
    let mut step = match all / POINTS_OF_RINGS {
        0 | 1 => 1,
        step => prime(u32::try_from(step).unwrap_or(u32::MAX)),
    };
    while step > 1 && (cloud.width.is_multiple_of(step) || cloud.height.is_multiple_of(step)) {
        step = prime(step + 1);
    }
    let width = u64::from(cloud.width);
    let cells = (0..all).step_by(usize::try_from(step).unwrap_or(usize::MAX));
    let mut values = BTreeSet::new();
    for cell in cells {
        let [row, column] = [cell / width, cell % width].map(|index| u32::try_from(index).unwrap_or(u32::MAX));
        let Some(bytes) = cloud.point(row, column) else {
            continue;
        };
        let Some(ring) = ring.of(bytes).filter(|ring| ring.is_finite()) else {
            continue;
        };
        let xyz = || axes.map(|axis| axis.of(bytes).unwrap_or(f64::NAN));
        if !values.contains(&ring.to_bits()) && is_return(xyz()) {
            values.insert(ring.to_bits());
        }
    }
    // More are no rings.
    (1..=MAX_RINGS).find(|count| *count as usize == values.len())
}

#[cfg(test)]
mod tests {
    use super::super::tests::cloud;
    use super::*;

    #[test]
    fn a_step_is_a_prime_that_meets_every_beam() {
        assert_eq!([2, 7, 8, 9, 62, 90].map(prime), [2, 7, 11, 11, 67, 97]);
        assert_eq!(prime(u32::MAX), u32::MAX);
        let cloud = |height, width| cloud([height, width], &[]);
        assert_eq!(strides(&cloud(1, 262_144), 4096), (1, 67));
        assert_eq!(strides(&cloud(1, 4096), 4096), (1, 1));
        assert_eq!(strides(&cloud(128, 2048), 4096), (2, 32));
        // Some drivers write an unorganised cloud as one column.
        assert_eq!(strides(&cloud(262_144, 1), 4096), (67, 1));
        assert_eq!(strides(&cloud(0, 0), 4096), (1, 1));
    }
}
