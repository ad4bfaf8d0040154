//! Runs of neighbouring clouds of one topic, each cut near the plane of its x and y.

use std::sync::Arc;

use crate::read::messages::cloud::{Cloud, Column};
use crate::world::cloud::{CloudSlice, PlaneCut, PlanePoints, RUN_CLOUDS, optical};

use super::super::point::Point;
use super::runs::Runs;
use super::times::time_of;

/// Takes in clouds in recording order.
pub(super) struct Slices {
    runs: Runs<CloudSlice>,
    has_optical: bool,
}

impl Slices {
    pub(super) fn new(most: usize, has_optical: bool) -> Self {
        Self {
            runs: Runs::new(most, RUN_CLOUDS),
            has_optical,
        }
    }

    /// Clouds were left out here.
    pub(super) fn seam(&mut self) {
        self.runs.seam();
    }

    /// Takes in a cloud, which is made only where it is kept.
    pub(super) fn push<'c>(
        &mut self,
        point: Point,
        cloud: impl FnOnce() -> Option<&'c Cloud<'c>>,
        time_fields: &[String],
    ) {
        let has_optical = self.has_optical;
        self.runs.push(|| {
            let cloud = cloud();
            let cut = |expressed| {
                cloud
                    .and_then(|cloud| slice(cloud, time_fields, expressed))
                    .unwrap_or_default()
            };
            let (points, after) = cut(|point| point);
            CloudSlice {
                stamp_ns: point.stamp_ns.filter(|stamp| *stamp != 0),
                log_ns: point.log_ns,
                points,
                after,
                optical: has_optical.then(|| Arc::new(cut(optical))),
            }
        });
    }

    pub(super) fn finish(self) -> Vec<Vec<CloudSlice>> {
        self.runs.finish(2)
    }
}

/// The nearest points of a cloud in each direction, in other axes, and their times; `None` where its points have no coordinates.
fn slice(cloud: &Cloud<'_>, time_fields: &[String], expressed: fn([f64; 3]) -> [f64; 3]) -> Option<PlanePoints> {
    let axes: [Column; 3] = [cloud.column("x")?, cloud.column("y")?, cloud.column("z")?];
    let time = time_of(cloud, time_fields).map(|(_, column)| column);
    let mut cut = PlaneCut::default();
    for row in 0..cloud.rows() {
        for column in 0..cloud.width {
            let Some(bytes) = cloud.point(row, column) else { break };
            let [Some(x), Some(y), Some(z)] = axes.map(|axis| axis.of(bytes)) else {
                break;
            };
            cut.push(expressed([x, y, z]), || {
                time.and_then(|time| time.of(bytes)).unwrap_or(f64::NAN)
            });
        }
    }
    Some(cut.finish())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::read::messages::cloud::Field;

    fn cloud(data: &[u8], count: u32) -> Cloud<'_> {
        let field = |(index, name): (u32, &'static str)| Field {
            name: name.into(),
            offset: 4 * index,
            datatype: 7,
            count: 1,
        };
        Cloud {
            height: 1,
            width: count,
            fields: [(0, "x"), (1, "y"), (2, "z")].map(field).into(),
            is_bigendian: false,
            point_step: 12,
            row_step: 12 * count,
            data: data.into(),
            timebase_ns: None,
        }
    }

    fn bytes(points: &[[f32; 3]]) -> Vec<u8> {
        points.iter().flatten().flat_map(|value| value.to_le_bytes()).collect()
    }

    fn at(index: u64) -> Point {
        Point {
            index,
            stamp_ns: Some(i64::try_from(index).unwrap() * 100),
            log_ns: 0,
            transform: None,
        }
    }

    #[test]
    fn the_nearest_above_and_beneath_are_kept_of_each_direction() {
        let points = [
            [5.0, 0.0, 0.1],
            [3.0, 0.0, 0.1],
            [2.0, 0.0, -0.1],
            [1.0, 0.0, 0.5],
            [0.0, 0.0, 0.0],
            [f32::NAN, 0.0, 0.0],
            [f32::INFINITY, 0.0, 0.0],
            [0.0, -4.0, 0.0],
        ];
        let data = bytes(&points);
        let (kept, after) = slice(&cloud(&data, 8), &[], |point| point).unwrap();
        assert!(after.is_empty());
        let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
        assert_eq!(kept.len(), 3);
        assert!(
            near(kept[0][1], -4.0) && near(kept[1][0], 2.0) && near(kept[2][0], 3.0),
            "{kept:?}"
        );
    }

    #[test]
    fn runs_follow_each_other_and_are_thinned_evenly() {
        let data = bytes(&[[3.0, 0.0, 0.0]]);
        let cloud = cloud(&data, 1);
        let mut slices = Slices::new(4, false);
        for index in 0..100 {
            slices.push(at(index), || Some(&cloud), &[]);
        }
        let runs = slices.finish();
        assert!((2..=4).contains(&runs.len()), "{}", runs.len());
        for run in &runs {
            let stamps: Vec<i64> = run.iter().filter_map(|slice| slice.stamp_ns).collect();
            assert!(stamps.windows(2).all(|pair| pair[1] - pair[0] == 100), "{stamps:?}");
        }
    }

    #[test]
    fn a_seam_ends_a_run() {
        let data = bytes(&[[3.0, 0.0, 0.0]]);
        let cloud = cloud(&data, 1);
        let mut slices = Slices::new(4, false);
        for index in [0, 1, 2, 50, 51, 52] {
            if index == 50 {
                slices.seam();
            }
            slices.push(at(index), || Some(&cloud), &[]);
        }
        let lengths: Vec<usize> = slices.finish().iter().map(Vec::len).collect();
        assert_eq!(lengths, [3, 3]);
    }
}
