//! The pages of the rules, as `build.rs` makes them of the files in `rules/`.

#![allow(missing_docs)] // what each says is its page
#![allow(clippy::unreadable_literal)] // numbers are copied

use crate::page::{Limit, Number, Page, Status};
use crate::source::Confidence;
use crate::verdict::Severity;

include!(concat!(env!("OUT_DIR"), "/pages.rs"));
