//! What single precision makes of a number.

#[allow(clippy::cast_possible_truncation)] // what is lost is what is asked
pub(crate) fn single(value: f64) -> f32 {
    value as f32
}

/// From a number of float32 to the next: `2^(floor(log2 M) - 23)`.
pub(crate) fn step_of_single(value: f64) -> f64 {
    if value < f64::from(f32::MIN_POSITIVE) {
        return 0.0;
    }
    (value.log2().floor() - 23.0).exp2()
}
