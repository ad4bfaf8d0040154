//! Calibrations and images of one topic.

use crate::read::messages::content::{CameraInfo, Image};
use crate::world::camera::{
    Calibration, CalibrationEvidence, CameraModel, ImageEvidence, ImageForm, MAX_CALIBRATIONS, MAX_FORMS,
};

use super::super::point::{Point, PointOwner};

/// The first different values of a topic, each with how often it came.
#[derive(Debug)]
pub(super) struct DistinctValues<T> {
    most: usize,
    pub(super) kept: Vec<(Point, u64, T)>,
    pub(super) others: u64,
}

impl<T> DistinctValues<T> {
    pub(super) fn new(most: usize) -> Self {
        Self {
            most,
            kept: Vec::new(),
            others: 0,
        }
    }

    pub(super) fn push(&mut self, point: Point, is_it: impl Fn(&T) -> bool, make: impl FnOnce() -> T) {
        // Most topics repeat their last value.
        let known = self.kept.iter_mut().rev().find(|(_, _, kept)| is_it(kept));
        if let Some((_, count, _)) = known {
            *count += 1;
        } else if self.kept.len() < self.most {
            self.kept.push((point, 1, make()));
        } else {
            self.others += 1;
        }
    }

    pub(super) fn count(&self) -> u64 {
        self.kept.iter().map(|(_, count, _)| count).sum::<u64>() + self.others
    }
}

/// Takes in calibrations in recording order.
#[derive(Debug)]
pub(super) struct Calibrations(DistinctValues<CameraInfo<'static>>);

impl Calibrations {
    pub(super) fn new() -> Self {
        Self(DistinctValues::new(MAX_CALIBRATIONS))
    }

    pub(super) fn push(&mut self, point: Point, info: &CameraInfo<'_>) {
        self.0.push(point, |kept| same(kept, info), || owned(info));
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> CalibrationEvidence {
        let count = self.0.count();
        let made = |(point, count, info): (Point, u64, CameraInfo<'static>)| Calibration {
            at: point.on(on),
            count,
            camera: CameraModel {
                size: [info.width, info.height],
                model: info.model.into_owned(),
                d: info.d,
                k: info.k,
                r: info.r,
                p: info.p,
                binning: info.binning,
                roi: [info.roi.x, info.roi.y, info.roi.width, info.roi.height],
            },
        };
        CalibrationEvidence {
            count,
            calibrations: self.0.kept.into_iter().map(made).collect(),
            others: self.0.others,
        }
    }
}

/// Whether two calibrations are the same bit by bit: NaN equals NaN.
fn same(a: &CameraInfo<'_>, b: &CameraInfo<'_>) -> bool {
    let bits = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
    (a.height, a.width, &a.model, a.binning, a.roi) == (b.height, b.width, &b.model, b.binning, b.roi)
        && bits(&a.d, &b.d)
        && bits(&a.k, &b.k)
        && bits(&a.r, &b.r)
        && bits(&a.p, &b.p)
}

fn owned(info: &CameraInfo<'_>) -> CameraInfo<'static> {
    CameraInfo {
        model: info.model.clone().into_owned().into(),
        d: info.d.clone(),
        ..*info
    }
}

/// Takes in images in recording order.
#[derive(Debug)]
pub(super) struct Images(DistinctValues<Image<'static>>);

impl Images {
    pub(super) fn new() -> Self {
        Self(DistinctValues::new(MAX_FORMS))
    }

    pub(super) fn push(&mut self, point: Point, image: &Image<'_>) {
        let owned = || Image {
            encoding: image.encoding.clone().into_owned().into(),
            ..*image
        };
        self.0.push(point, |kept| kept == image, owned);
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> ImageEvidence {
        let count = self.0.count();
        let made = |(point, count, image): (Point, u64, Image<'static>)| ImageForm {
            at: point.on(on),
            count,
            size: [image.width, image.height],
            encoding: image.encoding.into_owned(),
        };
        ImageEvidence {
            count,
            forms: self.0.kept.into_iter().map(made).collect(),
            others: self.0.others,
        }
    }
}
