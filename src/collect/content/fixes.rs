//! GNSS fixes of one topic.

use crate::read::messages::content::Fix;
use crate::world::content::{FixAt, FixEvidence};

use super::super::point::{Point, PointOwner};
use super::super::thin::{SampleBudget, ThinnedSeries};

/// Takes in fixes in recording order.
pub(super) struct Fixes {
    bound: usize,
    count: u64,
    no_fix: u64,
    samples: ThinnedSeries<KeptFix>,
    non_finite: FixExamples,
    out_of_range: FixExamples,
    null_island: FixExamples,
}

#[derive(Clone, Copy)]
struct KeptFix {
    point: Point,
    latitude_deg: f64,
    longitude_deg: f64,
    altitude_m: f64,
    status: i8,
}

/// A count and the first few.
#[derive(Default)]
struct FixExamples(u64, Vec<KeptFix>);

impl Fixes {
    pub(super) fn new(share: SampleBudget) -> Self {
        Self {
            bound: share.examples,
            count: 0,
            no_fix: 0,
            samples: ThinnedSeries::new(share.poses),
            non_finite: FixExamples::default(),
            out_of_range: FixExamples::default(),
            null_island: FixExamples::default(),
        }
    }

    pub(super) fn push(&mut self, point: Point, fix: &Fix) {
        self.count += 1;
        let kept = KeptFix {
            point,
            latitude_deg: fix.latitude,
            longitude_deg: fix.longitude,
            altitude_m: fix.altitude,
            status: fix.status,
        };
        self.samples.push(kept);
        if fix.status < 0 {
            self.no_fix += 1;
            return;
        }
        let (latitude, longitude) = (fix.latitude, fix.longitude);
        let fault = if !latitude.is_finite() || !longitude.is_finite() {
            &mut self.non_finite
        } else if latitude.abs() > 90.0 || longitude.abs() > 180.0 {
            &mut self.out_of_range
        } else if latitude == 0.0 && longitude == 0.0 {
            &mut self.null_island
        } else {
            return;
        };
        fault.0 += 1;
        if fault.1.len() < self.bound {
            fault.1.push(kept);
        }
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> FixEvidence {
        let at = |kept: KeptFix| FixAt {
            at: kept.point.on(on),
            latitude_deg: kept.latitude_deg,
            longitude_deg: kept.longitude_deg,
            altitude_m: kept.altitude_m,
            status: kept.status,
        };
        let counted = |counted: FixExamples| (counted.0, counted.1.into_iter().map(at).collect());
        FixEvidence {
            count: self.count,
            no_fix: self.no_fix,
            samples: self.samples.finish().into_iter().map(at).collect(),
            non_finite: counted(self.non_finite),
            out_of_range: counted(self.out_of_range),
            null_island: counted(self.null_island),
        }
    }
}
