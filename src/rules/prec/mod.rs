//! Rules of precision: what the types of numbers lose.

pub mod float32_ulp;
pub mod local_origin;
pub mod point_time_precision;
