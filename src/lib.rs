//! frames-lint: reads files as facts with their places, applies rules to the facts, and reports what each rule measured.
//!
//! ```text
//! files --read--> world <--collect-- recordings
//!                   |
//!                analysis (estimates)
//!                   |
//!                 rules (judge)
//!                   v
//!                verdict --policy--> gate --report--> words
//! ```

#![cfg_attr(
    test,
    allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)
)]

pub(crate) mod advice;
pub mod analysis;
pub mod assure;
pub mod cli;
pub mod collect;
pub mod compare;
pub mod config;
pub mod convert;
pub mod engine;
pub mod faults;
pub mod files;
pub mod fitness;
pub mod fix;
pub mod math;
pub mod page;
pub mod policy;
pub mod progress;
pub mod read;
pub mod report;
pub mod rules;
pub mod run;
pub mod source;
pub mod tables;
pub mod verdict;
pub mod view;
mod visible;
pub mod world;
