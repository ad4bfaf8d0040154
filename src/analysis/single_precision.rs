//! How single precision (float32) rounds a number.

#[allow(clippy::cast_possible_truncation)] // the loss is what is measured
pub(crate) fn single(value: f64) -> f32 {
    value as f32
}

/// The step from a float32 number to the next: `2^(floor(log2 M) - 23)`.
pub(crate) fn step_of_single(value: f64) -> f64 {
    if value < f64::from(f32::MIN_POSITIVE) {
        return 0.0;
    }
    (value.log2().floor() - 23.0).exp2()
}
