//! Where one scan ends and the next begins, in the packets of one sensor, as the ROS drivers cut by default: where its azimuth passes zero,
//! where the places of its packets start again (RoboSense's M1, each mirror of Hesai's AT128), after a tenth of a second (Livox), or where the
//! packets say that another turn begins (Ouster).

use super::turn::TURN;
use super::{Maker, at128, hesai, livox, ouster, robosense, robosense_solid, velodyne};

/// Hundredths of a degree that packets are apart at most, however they are lost or swapped on the way, for the direction of turning to be
/// read from them. Packets of known sensors cover up to 4 degrees.
const NEAR: u16 = 1000;
/// Steps in one direction that make it the direction of turning; a swapped packet makes one or two against it.
const STEADY: i8 = 3;
/// How long a scan of a Livox lasts, nanoseconds: its driver publishes ten a second.
const LIVOX_NS: i64 = 100_000_000;

/// Tells where scans begin, packet after packet of one sensor.
pub trait Boundary {
    /// Whether a scan begins with this packet; `None` where the packet does not show it.
    fn begins(&mut self, bytes: &[u8]) -> Option<bool>;
}

/// The boundaries of a maker's scans.
pub fn boundary(maker: Maker) -> Box<dyn Boundary> {
    match maker {
        Maker::Velodyne => Box::new(Sweep::of(velodyne::azimuth)),
        Maker::Hesai => Box::new(Turning::of(hesai::azimuth, at128::place)),
        Maker::RoboSense => Box::new(Turning::of(robosense::azimuth, robosense_solid::number)),
        Maker::Livox => Box::new(Livox { begun_ns: None }),
        Maker::Ouster => Box::new(Ouster { turns: [None; 2] }),
    }
}

/// A sensor of a maker that has models which do not turn as a whole.
struct Turning {
    sweep: Sweep,
    /// The place of a packet in a scan, of those models; `None` for packets of the others.
    place_of: fn(&[u8]) -> Option<u16>,
    /// Of the packet before.
    place: Option<u16>,
}

impl Turning {
    fn of(azimuth_of: fn(&[u8]) -> Option<u16>, place_of: fn(&[u8]) -> Option<u16>) -> Self {
        Self {
            sweep: Sweep::of(azimuth_of),
            place_of,
            place: None,
        }
    }
}

impl Boundary for Turning {
    fn begins(&mut self, bytes: &[u8]) -> Option<bool> {
        let Some(place) = (self.place_of)(bytes) else {
            return self.sweep.begins(bytes);
        };
        let before = self.place.replace(place);
        Some(before.is_some_and(|before| place < before))
    }
}

/// An Ouster, whose packets say to which turn they belong.
struct Ouster {
    /// The turn before the last packet's, and that one.
    turns: [Option<u64>; 2],
}

impl Boundary for Ouster {
    fn begins(&mut self, bytes: &[u8]) -> Option<bool> {
        let turn = ouster::turn(bytes)?;
        let [before, now] = self.turns;
        // A packet that was overtaken on the way is of the turn before.
        if now == Some(turn) || before == Some(turn) {
            return Some(false);
        }
        self.turns = [now, Some(turn)];
        Some(now.is_some())
    }
}

/// A Livox.
struct Livox {
    /// When the scan began, nanoseconds by the sensor's clock.
    begun_ns: Option<i64>,
}

impl Boundary for Livox {
    fn begins(&mut self, bytes: &[u8]) -> Option<bool> {
        let now_ns = livox::time_ns(bytes)?;
        let begun_ns = *self.begun_ns.get_or_insert(now_ns);
        // Also where the clock was set back.
        let begins = now_ns < begun_ns || now_ns.saturating_sub(begun_ns) >= LIVOX_NS;
        if begins {
            self.begun_ns = Some(now_ns);
        }
        Some(begins)
    }
}

/// A sensor that turns.
struct Sweep {
    azimuth_of: fn(&[u8]) -> Option<u16>,
    /// The azimuth of the packet before.
    before: Option<u16>,
    /// The farthest azimuth of this turn, counted in the direction of turning.
    farthest: Option<u16>,
    /// Above zero where azimuths rise, below where they fall.
    direction: i8,
}

impl Sweep {
    fn of(azimuth_of: fn(&[u8]) -> Option<u16>) -> Self {
        Self {
            azimuth_of,
            before: None,
            farthest: None,
            direction: 0,
        }
    }

    /// Whether azimuths are known to fall: some sensors can be set to turn the other way.
    fn is_falling(&self) -> bool {
        self.direction <= -STEADY
    }

    /// Counts a step towards the direction of turning; gives whether that changed.
    fn step(&mut self, azimuth: u16) -> bool {
        let was_falling = self.is_falling();
        if let Some(before) = self.before.replace(azimuth) {
            match (forward(before, azimuth), forward(azimuth, before)) {
                (1..=NEAR, _) => self.direction = (self.direction + 1).min(STEADY),
                (_, 1..=NEAR) => self.direction = (self.direction - 1).max(-STEADY),
                _ => {}
            }
        }
        was_falling != self.is_falling()
    }
}

impl Boundary for Sweep {
    fn begins(&mut self, bytes: &[u8]) -> Option<bool> {
        let azimuth = (self.azimuth_of)(bytes)?;
        if self.step(azimuth) {
            self.farthest = None;
        }
        let turned = if self.is_falling() { TURN - 1 - azimuth } else { azimuth };
        let Some(farthest) = self.farthest else {
            self.farthest = Some(turned);
            return Some(false);
        };
        // A packet that was overtaken on the way belongs to what is being gathered.
        if (1..=NEAR).contains(&forward(turned, farthest)) {
            return Some(false);
        }
        self.farthest = Some(turned);
        Some(turned < farthest)
    }
}

/// From one azimuth to another in the direction of rising ones, hundredths of a degree.
fn forward(from: u16, to: u16) -> u16 {
    if to >= from { to - from } else { TURN - from + to }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The azimuths, in degrees, at which a scan begins.
    fn begins(azimuths: impl IntoIterator<Item = i32>) -> Vec<i32> {
        let mut sweep = Sweep::of(|bytes| Some(u16::from_be_bytes(*bytes.first_chunk().unwrap())));
        let mut begun = Vec::new();
        for azimuth in azimuths {
            let sent = u16::try_from(azimuth.rem_euclid(360) * 100).unwrap();
            if sweep.begins(&sent.to_be_bytes()) == Some(true) {
                begun.push(azimuth);
            }
        }
        begun
    }

    #[test]
    fn scans_begin_where_the_azimuth_passes_zero() {
        assert_eq!(begins((90..1200).step_by(2)), [360, 720, 1080]);
        let falling: Vec<i32> = (-1200..-90).rev().step_by(2).collect();
        assert_eq!(begins(falling), [-361, -721, -1081]);
    }

    #[test]
    fn a_part_of_the_turn_is_one_scan() {
        let part =
            |from: i32, to: i32| (0..4).flat_map(move |turn| (from..to).map(move |azimuth| 360 * turn + azimuth));
        assert_eq!(begins(part(60, 120)), [420, 780, 1140]);
        assert_eq!(begins(part(330, 390)), [360, 720, 1080, 1440]);
    }

    #[test]
    fn lost_and_swapped_packets_begin_no_scan() {
        let lossy = (0..1000).filter(|azimuth| !(100..240).contains(azimuth));
        assert_eq!(begins(lossy), [360, 720]);
        let swapped = (0..1000).map(|azimuth| azimuth ^ 1);
        assert_eq!(begins(swapped), [361, 721]);
    }
}
