//! Whether two names in a formula mean one frame.

use crate::analysis::names;
use crate::world::FrameId;

/// A frame's name as written in a formula: `base` and `base_link` are the same there.
fn label(name: &str) -> String {
    names::without_ending(FrameId::new(name).tokens()).concat()
}

/// Whether two names mean one frame. `c`, `c0` and `cam`, `I` and `Ik`, `body`, `bodyMatch` and `last_body` do: the longer one states which, or when.
pub(crate) fn is_same(a: &str, b: &str) -> bool {
    if label(a) == label(b) {
        return true;
    }
    let words = |name: &str| names::without_ending(FrameId::new(name).tokens());
    let (a, b) = (words(a), words(b));
    let (short, long) = if a.len() <= b.len() { (&a, &b) } else { (&b, &a) };
    match (short.as_slice(), long.as_slice()) {
        ([one], [other]) => is_one_of(one, other) || is_one_of(other, one),
        (short, [first, ..]) => {
            long.starts_with(short) || long.ends_with(short) || matches!(short, [one] if is_one_of(one, first))
        }
        _ => false,
    }
}

/// Whether `long` is what the letter `short` stands for (`c` and `cam`), or `short` with a counter after it: digits, or after one letter `k`, `kp1`.
fn is_one_of(short: &str, long: &str) -> bool {
    if short.len() == 1 && long.len() > 2 && long.starts_with(short) {
        return true;
    }
    let Some(rest) = long.strip_prefix(short).filter(|rest| !rest.is_empty()) else {
        return false;
    };
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let steps = ["", "p", "m", "plus", "minus"];
    let behind_letter = rest
        .strip_prefix(['i', 'j', 'k', 'n'])
        .is_some_and(|rest| steps.iter().any(|step| rest.strip_prefix(step).is_some_and(is_digits)));
    is_digits(rest) || short.len() == 1 && behind_letter
}
