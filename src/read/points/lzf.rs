//! The compression LZF of Marc Lehmann, as PCD files have it. Source: liblzf, `lzf_d.c`.

/// The first `wanted` bytes; `None` if the data are damaged or end before.
pub(super) fn unpack(packed: &[u8], wanted: usize) -> Option<Vec<u8>> {
    // An instruction of three bytes makes 264 at most.
    if wanted / 264 > packed.len() {
        return None;
    }
    let mut out = Vec::with_capacity(wanted);
    let mut at = 0;
    let mut next = || {
        at += 1;
        packed.get(at - 1).map(|byte| usize::from(*byte))
    };
    while out.len() < wanted {
        let control = next()?;
        if control < 32 {
            // A run of bytes as they are.
            for _ in 0..=control {
                out.push(u8::try_from(next()?).ok()?);
            }
            continue;
        }
        let mut length = control >> 5;
        if length == 7 {
            length += next()?;
        }
        let back = ((control & 31) << 8) + next()? + 1;
        let from = out.len().checked_sub(back)?;
        // The copy may reach into what it makes.
        for at in from..from + length + 2 {
            out.push(*out.get(at)?);
        }
    }
    out.truncate(wanted);
    Some(out)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn runs_and_copies_are_unpacked() {
        // Three bytes as they are, then six from three back: `abcabcabc`.
        let packed = [2, b'a', b'b', b'c', 4 << 5, 2];
        assert_eq!(unpack(&packed, 9).unwrap(), b"abcabcabc");
        assert_eq!(unpack(&packed, 4).unwrap(), b"abca");
        // A long copy: 7 and 3 more, and 2.
        assert_eq!(unpack(&[0, b'x', 7 << 5, 3, 0], 13).unwrap(), [b'x'; 13]);
        for damaged in [&[][..], &[5, b'a'], &[1 << 5, 0], &[0, b'a', 1 << 5, 9]] {
            assert_eq!(unpack(damaged, 9), None);
        }
    }
}
