//! Outcomes for calibrations that cannot be used.

use crate::analysis::camera::published::Intrinsics;
use crate::verdict::Judge;

impl Intrinsics<'_> {
    /// Whether K can be used: finite, with positive focal lengths. Else reports `subject` as not applicable.
    pub(crate) fn is_usable(&self, subject: &str, out: &mut Judge) -> bool {
        let [fx, fy, cx, cy] = self.pinhole();
        if self.is_uncalibrated() {
            out.not_applicable(subject, "K is all zeros: the camera is not calibrated");
            return false;
        }
        if ![fx, fy, cx, cy].iter().all(|value| value.is_finite()) || fx <= 0.0 || fy <= 0.0 {
            out.not_applicable(subject, "K has no positive focal lengths");
            return false;
        }
        true
    }
}
