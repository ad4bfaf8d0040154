//! The models of Velodyne: angles and times of each, by its user manual.

use std::sync::OnceLock;

use super::turn::Direction;
use crate::tables::beams::velodyne::{HDL32E_ANGLES, VLP16_ANGLES, VLP32C_ANGLES, VLS128_ANGLES};

/// Units of a block: a distance of two bytes and an intensity of one.
pub(super) const UNITS: usize = 32;
/// Whether azimuths within a block are interpolated as the ROS driver does it (see `sweep`), or by the user manual.
pub(super) const LIKE_DRIVER: bool = true;

pub(super) struct Model {
    pub(super) id: u8,
    pub(super) name: &'static str,
    /// (elevation, azimuth offset), degrees, by laser.
    angles: &'static [(f64, f64)],
    /// Metres of one unit of distance.
    pub(super) unit: f32,
    /// Blocks that one firing of all lasers takes.
    pub(super) banks: usize,
    /// From one block (with several banks: one firing of all lasers) to the next, nanoseconds.
    pub(super) cycle_ns: i32,
    /// From the packet's time to the first firing, nanoseconds.
    pub(super) lead_ns: i32,
    /// From the begin of the cycle to the firing of a slot, nanoseconds.
    fire_ns: fn(usize) -> usize,
    /// The same as the driver has it where it turns the azimuth, if it differs.
    driver_ns: Option<fn(usize) -> usize>,
    slots: OnceLock<Vec<Slot>>,
}

/// What the units at one place of the blocks have in common.
pub(super) struct Slot {
    pub(super) elevation: Direction,
    /// Hundredths of a degree, to be subtracted from the azimuth.
    pub(super) azimuth_offset: f64,
    pub(super) fire_ns: i64,
    /// The part of the cycle's turn that is done when the slot fires.
    pub(super) part: f32,
    pub(super) ring: u16,
}

static MODELS: [Model; 4] = [
    Model {
        id: 0x22,
        name: "VLP-16",
        angles: &VLP16_ANGLES,
        unit: 0.002,
        banks: 1,
        cycle_ns: 110_592,
        lead_ns: 0,
        fire_ns: |slot| 55_296 * (slot / 16) + 2304 * (slot % 16),
        driver_ns: None,
        slots: OnceLock::new(),
    },
    Model {
        id: 0x28,
        name: "VLP-32C",
        angles: &VLP32C_ANGLES,
        unit: 0.004,
        banks: 1,
        cycle_ns: 55_296,
        lead_ns: 0,
        // The lasers fire in pairs.
        fire_ns: |slot| 2304 * (slot / 2),
        driver_ns: Some(|slot| 2304 * slot),
        slots: OnceLock::new(),
    },
    Model {
        id: 0x21,
        name: "HDL-32E",
        angles: &HDL32E_ANGLES,
        unit: 0.002,
        banks: 1,
        cycle_ns: 46_080,
        lead_ns: 0,
        fire_ns: |slot| 1152 * slot,
        driver_ns: None,
        slots: OnceLock::new(),
    },
    Model {
        id: 0xA1,
        name: "VLS-128",
        angles: &VLS128_ANGLES,
        unit: 0.004,
        banks: 4,
        cycle_ns: 53_300,
        lead_ns: -8700,
        fire_ns: |slot| 2665 * (slot / 8 + slot / 64),
        driver_ns: None,
        slots: OnceLock::new(),
    },
];

impl Model {
    /// What the units of a packet stand for, bank after bank.
    pub(super) fn slots(&self) -> &[Slot] {
        self.slots.get_or_init(|| {
            let lasers = self.angles.iter().cycle().take(UNITS * self.banks).enumerate();
            lasers
                .map(|(slot, &(elevation, offset))| self.slot(slot, elevation, offset))
                .collect()
        })
    }

    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "small numbers; radians kept in f32"
    )]
    fn slot(&self, slot: usize, elevation: f64, offset: f64) -> Slot {
        let fire_ns = (self.fire_ns)(slot);
        let turned_ns = self
            .driver_ns
            .filter(|_| LIKE_DRIVER)
            .map_or(fire_ns, |driver_ns| driver_ns(slot));
        let lower = self.angles.iter().filter(|other| other.0 < elevation).count();
        Slot {
            elevation: Direction::of(elevation),
            // The driver keeps radians in f32, which decides a few roundings.
            azimuth_offset: f64::from(offset.to_radians() as f32).to_degrees() * 100.0,
            fire_ns: i64::try_from(fire_ns).unwrap_or_default(),
            part: turned_ns as f32 / self.cycle_ns as f32,
            ring: u16::try_from(lower).unwrap_or_default(),
        }
    }
}

/// The model with an id.
pub(super) fn model_of(id: u8) -> Option<&'static Model> {
    MODELS.iter().find(|model| model.id == id)
}
