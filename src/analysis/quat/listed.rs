//! Quaternions as four numbers in the order of a file.

use crate::analysis::places::cover;
use crate::source::Place;
use crate::world::{Claim, FrameId, World};

/// Position that looks like the scalar of a small rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    /// As in `w x y z`.
    First,
    /// As in `x y z w`.
    Last,
    /// Not a small rotation in either order.
    Elsewhere,
}

/// Four numbers of a file.
#[derive(Debug)]
pub(crate) struct QuaternionList<'a> {
    /// The claim with this spelling.
    pub claim: &'a Claim,
    /// In the order of the file.
    pub written: [f64; 4],
    /// Position that looks like the scalar.
    pub slot: Slot,
}

impl<'a> QuaternionList<'a> {
    /// The four numbers of a claim; from the magnitude `scalar` on, one looks like the scalar of a small rotation.
    pub(crate) fn of(claim: &'a Claim, xyzw: [f64; 4], scalar: f64) -> Self {
        let mut written = xyzw;
        if claim.rotation_literals.len() == 4 {
            for (slot, literal) in written.iter_mut().zip(&claim.rotation_literals) {
                *slot = literal.value;
            }
        }
        let [first, _, _, last] = written;
        let slot = match (first.abs() >= scalar, last.abs() >= scalar) {
            (true, false) => Slot::First,
            (false, true) => Slot::Last,
            _ => Slot::Elsewhere,
        };
        Self { claim, written, slot }
    }

    /// As a list.
    pub(crate) fn text(&self) -> String {
        let [a, b, c, d] = self.written;
        format!("[{a}, {b}, {c}, {d}]")
    }

    /// Its subject in outcomes.
    pub(crate) fn subject(&self, world: &World) -> String {
        format!(
            "order of `{}` of {}",
            self.claim.label,
            world.path(self.claim.place.source)
        )
    }

    /// Place of the four numbers.
    pub(crate) fn place(&self) -> Place {
        cover(&self.claim.rotation_literals, &self.claim.place)
    }
}

/// The order that a key names: `rotation_wxyz`, `q_xyzw`.
pub(crate) fn said_by_key(label: &str) -> Option<Slot> {
    let key = FrameId::new(label.rsplit('/').next().unwrap_or(label));
    match (key.has_token("wxyz"), key.has_token("xyzw")) {
        (true, false) => Some(Slot::First),
        (false, true) => Some(Slot::Last),
        _ => None,
    }
}
