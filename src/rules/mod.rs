//! The rules: each judges a world and reports what it measured. Mirrors `rules/` one to one.
//!
//! Rules are pure: no I/O, no clock, no randomness. They read worlds and estimates, and know nothing of reading,
//! collecting, configuration or reports, nor of each other.

pub mod codes;
mod list;
mod need;
pub mod pages;
pub(crate) mod prelude;
mod registry;
mod rule;

pub use list::RULES;
pub use need::Need;
pub use rule::{Entry, Kind, SampleSize};
pub(crate) use rule::{NoLimits, PolicyRule, Review, Rule};

/// The modules of the rules, a folder for each family.
macro_rules! modules {
    ($($(#[$doc:meta])* $family:ident { $($code:ident => $module:ident :: $rule:ident $(as $kind:ident)?,)* })*) => {
        $($(#[$doc])* pub(crate) mod $family { $(pub(crate) mod $module;)* })*
    };
}
registry::registry!(modules);
