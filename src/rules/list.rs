//! The list of rules.

use super::registry::registry;
use super::rule::Entry;

macro_rules! list {
    ($($(#[$doc:meta])* $family:ident { $($code:ident => $module:ident :: $rule:ident $(as $kind:ident)?,)* })*) => {
        /// Every rule, in the order of the registry.
        pub static RULES: &[Entry] = &[$($(
            entry!(super::$family::$module::$rule, $code $(, $kind)?),
        )*)*];
    };
}

macro_rules! entry {
    ($rule:path, $code:ident) => {
        entry!($rule, $code, world)
    };
    ($rule:path, $code:ident, $kind:ident) => {
        Entry::$kind::<$rule>(super::codes::$code, &super::pages::$code)
    };
}
registry!(list);
