//! Reports: verdicts, worlds and pages become words. Reads no file and judges nothing.

pub mod explain;
pub mod json;
mod place;
pub mod rules_table;
#[cfg(test)]
mod samples;
mod style;
pub mod terminal;
mod text;
pub mod tree;

pub use style::Style;
