//! Readers: files become facts with a place. One reader a format; none of them judges.

pub mod calibration;
