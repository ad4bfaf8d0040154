//! The codes of the rules, as values.

use crate::verdict::RuleCode;

use super::registry::registry;

macro_rules! codes {
    ($($(#[$doc:meta])* $family:ident { $($code:ident => $module:ident :: $rule:ident $(as $kind:ident)?,)* })*) => {
        $($(
            #[doc = concat!("The code of the rule in `", stringify!($family), "/", stringify!($module), ".rs`.")]
            pub const $code: RuleCode = RuleCode::new(stringify!($code));
        )*)*
    };
}
registry!(codes);
