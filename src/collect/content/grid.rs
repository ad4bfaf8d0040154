//! Grids of one topic.

use crate::read::messages::content::Grid;
use crate::world::projection::{GridAt, GridEvidence, MAX_GRIDS};

use super::super::point::{Point, PointOwner};
use super::camera::DistinctValues;

/// Takes in grids in recording order.
#[derive(Debug)]
pub(super) struct Grids(DistinctValues<Grid>);

impl Grids {
    pub(super) fn new() -> Self {
        Self(DistinctValues::new(MAX_GRIDS))
    }

    pub(super) fn push(&mut self, point: Point, grid: &Grid) {
        self.0.push(point, |kept| kept.is_same(grid), || grid.clone());
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> GridEvidence {
        let count = self.0.count();
        let made = |(point, count, grid): (Point, u64, Grid)| GridAt {
            at: point.on(on),
            count,
            resolution_m: grid.resolution_m,
            cells: grid.cells,
            position: grid.position,
            orientation: grid.orientation,
            data: grid.data,
        };
        GridEvidence {
            count,
            grids: self.0.kept.into_iter().map(made).collect(),
            others: self.0.others,
        }
    }
}
