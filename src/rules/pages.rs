//! The pages of the rules, which `build.rs` makes from the files in `rules/`.

#![allow(missing_docs)] // each is documented by its page
#![allow(clippy::unreadable_literal)] // numbers are copied

use crate::page::{Limit, Number, Page, Status};
use crate::source::Confidence;
use crate::verdict::Severity;

include!(concat!(env!("OUT_DIR"), "/pages.rs"));
