//! The list of rules.

use super::registry::registry;
use super::rule::Entry;

macro_rules! list {
    ($($(#[$doc:meta])* $family:ident { $($code:ident => $module:ident :: $rule:ident $(as $kind:ident)?,)* })*) => {
        /// Every rule, in the order of the registry.
        pub static RULES: &[Entry] = &[$($(
            entry!(super::$family::$module::$rule, super::codes::$code $(, $kind)?),
        )*)*];
    };
}

macro_rules! entry {
    ($rule:path, $code:path) => {
        entry!($rule, $code, world)
    };
    ($rule:path, $code:path, $kind:ident) => {
        Entry::$kind::<$rule>($code)
    };
}
registry!(list);
